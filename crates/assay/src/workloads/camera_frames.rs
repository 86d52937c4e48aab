//! Workloads with frames of a camera and 77 markers: projection, rendering, detection and matching.

use std::hint::black_box;

use anyhow::Result;
use image::RgbImage;
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, Layout, Lens, MarkerArray,
    MarkerMotion, Optics,
};
use palpate_tracking::{Finder, Marker, Mask, match_markers};

use super::marker_presses::SKIN;
use crate::accuracy::rms;
use crate::timing::Evaluation;

const FRAME: u64 = 11;

/// The published sensor, whose camera images have no defects such as blur. Its discs are misaligned by up to 0.3 of
/// their diameter.
///
/// # Errors
/// An error if the sensor is invalid.
pub fn optics(size_px: u32) -> Result<Optics> {
    let discs = Discs {
        magenta: 2.0,
        yellow: 2.0,
    };
    let depths = DiscDepths {
        magenta: 3.0,
        yellow: 1.0,
    };
    let places = Layout::published().places(SKIN)?;
    let array = MarkerArray::new(SKIN, &places, discs, depths)?.misaligned(0.3, 1, 0)?;
    let camera = Camera::new(Lens::Fisheye, size_px, 70.0)?;
    Ok(Optics::new(
        array,
        camera,
        Colours::default(),
        Blemishes::default(),
    )?)
}

/// Displacements of the 77 markers. All displacements differ: the first marker moves most, the last marker least.
pub fn motions() -> Vec<Option<MarkerMotion>> {
    let disc = |normal, along| DiscMotion {
        normal,
        tangential: [along, -0.5 * along],
        ..DiscMotion::default()
    };
    let motion = |marker: i32| MarkerMotion {
        magenta: disc(0.4 / f64::from(1 + marker), 0.05),
        yellow: disc(0.6 / f64::from(1 + marker), 0.1),
    };
    (0..77).map(|marker| Some(motion(marker))).collect()
}

/// A disc in a frame.
pub struct Disc {
    /// Centroid of the disc in the frame, px.
    pub centroid_px: [f64; 2],
    /// Hue of the disc, turns.
    pub hue_turns: f64,
}

/// A frame with 77 discs of random hues on a dark background.
pub fn frame(size_px: usize) -> (RgbImage, Vec<Disc>) {
    let (frame, truth) = palpate_testkit::dark(size_px, FRAME);
    let discs = truth.into_iter().map(|one| Disc {
        centroid_px: one.centroid_px,
        hue_turns: one.hue_turns,
    });
    (frame, discs.collect())
}

/// A marker finder for the frames from [`frame`]. It searches within the image circle of these frames.
pub fn finder(size_px: usize) -> Finder {
    let mask = Mask {
        centre_px: [0.5 * size_px as f64; 2],
        radius_px: 0.48 * size_px as f64,
    };
    Finder::new(Some(mask), None)
}

/// Root-mean-square errors of the centroids (px) and of the hues (turns). Each disc of the frame is compared with the
/// nearest of the detected markers `found`. If `found` is empty, the errors are infinite.
pub fn errors(found: &[Marker], discs: &[Disc]) -> [f64; 2] {
    let off = |disc: &Disc| {
        let off_px = |marker: &Marker| {
            let [dx, dy] = [0, 1].map(|axis| disc.centroid_px[axis] - marker.centroid_px[axis]);
            libm::hypot(dx, dy)
        };
        let nearest = found.iter().min_by(|a, b| off_px(a).total_cmp(&off_px(b)));
        nearest.map_or([f64::INFINITY; 2], |marker| {
            let turn = marker.hue_turns - disc.hue_turns;
            [off_px(marker), turn - turn.round()]
        })
    };
    let off: Vec<[f64; 2]> = discs.iter().map(off).collect();
    [0, 1].map(|which| rms(off.iter().map(|one| one[which])))
}

/// The workload that projects 77 markers.
///
/// # Errors
/// An error if the sensor is invalid.
pub fn projection(name: &str) -> Result<Evaluation> {
    let (optics, motions) = (optics(640)?, motions());
    optics.project(&motions)?;
    Ok(Evaluation::new(name, move || {
        optics.project(black_box(&motions))
    }))
}

/// The workload that renders a frame of 77 markers.
///
/// # Errors
/// An error if the sensor is invalid.
pub fn rendering(name: &str, size_px: u32) -> Result<Evaluation> {
    let (optics, motions) = (optics(size_px)?, motions());
    optics.render(&motions, None)?;
    Ok(Evaluation::new(name, move || {
        optics.render(black_box(&motions), None)
    }))
}

/// The workload that detects the markers in a frame.
///
/// # Errors
/// An error if the markers are not found.
pub fn detection(name: &str, size_px: usize) -> Result<Evaluation> {
    let (frame, _) = frame(size_px);
    let mut finder = finder(size_px);
    finder.find(&frame)?;
    Ok(Evaluation::new(name, move || {
        finder.find(black_box(&frame))
    }))
}

/// The workload that matches the markers of two equal frames.
///
/// # Errors
/// An error if the markers are not found.
pub fn matching(name: &str, size_px: usize) -> Result<Evaluation> {
    let found = finder(size_px).find(&frame(size_px).0)?.markers;
    Ok(Evaluation::new(name, move || {
        match_markers(black_box(&found), black_box(&found))
    }))
}
