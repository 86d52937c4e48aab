//! Markers of frames.

use std::hint::black_box;

use anyhow::Result;
use palpate_tracking::Marker;

use super::figure::{FRAMES, Figure};
use crate::accuracy::rms;
use crate::hot::camera::{self, Disc};

/// The markers of a dark frame.
pub(super) fn frames() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for size in FRAMES {
        let (frame, discs) = camera::frame(size);
        let mut finder = camera::finder(size)?;
        let error = centroid_error(&finder.find(&frame)?.markers, &discs);
        let task = format!("image, {size} px, 77 markers");
        figures.push(Figure::measured(task, "find", error, 1, move || {
            finder.find(black_box(&frame))
        }));
    }
    Ok(figures)
}

/// Root of the mean square distance from each disc to the nearest marker, px; infinite unless each is found once.
fn centroid_error(found: &[Marker], discs: &[Disc]) -> f64 {
    let away = |disc: &Disc, marker: &Marker| {
        let [dx, dy] = [0, 1].map(|axis| disc.centroid_px[axis] - marker.centroid_px[axis]);
        libm::hypot(dx, dy)
    };
    let nearest = |disc| {
        found
            .iter()
            .map(|marker| away(disc, marker))
            .fold(f64::INFINITY, f64::min)
    };
    if found.len() != discs.len() {
        return f64::INFINITY;
    }
    rms(discs.iter().map(nearest))
}
