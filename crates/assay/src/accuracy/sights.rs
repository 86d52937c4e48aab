//! Errors of the markers that the tracker finds in a frame.

use anyhow::{Context, Result};
use palpate_tracking::Marker;

use super::figure::{Figure, rms};
use crate::hot::camera;

const SIZE: usize = 640;

pub(super) fn figures() -> Result<Vec<Figure>> {
    let (frame, discs) = camera::frame(SIZE);
    let found = camera::finder(SIZE)?.find(&frame)?.markers;
    let (mut off_px, mut off_turns) = (Vec::new(), Vec::new());
    for disc in &discs {
        let marker = nearest(&found, disc.centroid_px)?;
        off_px.push(away(marker, disc.centroid_px));
        let turn = marker.hue_turns - disc.hue_turns;
        off_turns.push(turn - turn.round());
    }
    let mut figures = vec![
        Figure::new("find, dark, centroid, px", rms(off_px)),
        Figure::new("find, dark, hue, turns", rms(off_turns)),
    ];

    let (optics, motions) = (camera::optics(SIZE as u32)?, camera::motions());
    let frame = optics.rendered(&motions, None)?;
    let found = palpate_tracking::Finder::new(palpate_tracking::FinderSettings::default())?;
    let found = { found }.find(&frame)?.markers;
    let (mut off_px, mut off_turns) = (Vec::new(), Vec::new());
    for seen in optics.projected(&motions)?.iter().flatten() {
        let marker = nearest(&found, seen.centroid_px)?;
        off_px.push(away(marker, seen.centroid_px));
        let turn = marker.hue_turns - seen.hue_turns;
        off_turns.push(turn - turn.round());
    }
    figures.push(Figure::new("find, rendered, centroid, px", rms(off_px)));
    figures.push(Figure::new("find, rendered, hue, turns", rms(off_turns)));
    Ok(figures)
}

fn away(marker: &Marker, place: [f64; 2]) -> f64 {
    let [dx, dy] = [0, 1].map(|axis| marker.centroid_px[axis] - place[axis]);
    libm::hypot(dx, dy)
}

fn nearest(found: &[Marker], place: [f64; 2]) -> Result<&Marker> {
    found
        .iter()
        .min_by(|a, b| away(a, place).total_cmp(&away(b, place)))
        .context("no marker is found")
}
