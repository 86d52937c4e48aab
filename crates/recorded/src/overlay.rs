//! Picture of a pressed frame with the tracking status of each marker drawn on it.

use image::RgbImage;
use palpate_tracking::{Marker, Status};

use super::drawing::{Canvas, Colour};
use super::frame_pair::FramePair;

/// Side to which smaller frames are enlarged, px, so that numbers can be read.
const SIDE: u32 = 1000;

/// Factor by which arrows are longer than the shifts they show.
const ARROW_SCALE: f64 = 5.0;

/// Smallest diameter of a marker that gets a number, in pixels of the canvas.
const LEGIBLE: f64 = 12.0;

const CUT: Colour = [120, 120, 120];
const ARROW: Colour = [0, 0, 0];

const fn colour(status: Status) -> Colour {
    match status {
        Status::Tracked => [0, 70, 220],
        Status::Lost => [220, 0, 0],
        Status::Merged => [255, 120, 0],
        Status::Split => [140, 0, 200],
        Status::New => [0, 150, 150],
    }
}

/// The pressed frame with a circle and a number at each marker, and an arrow along its shift from rest, drawn 5 times
/// as long. The circle's colour is the marker's status: blue tracked, red lost, orange merged, violet split, cyan
/// new, grey cut by the rim at rest. Small frames are enlarged by a whole factor.
pub fn overlay(pressed: &RgbImage, frames: &FramePair) -> RgbImage {
    let mut canvas = Canvas::new(pressed, SIDE);
    for marker in &frames.cut {
        canvas.circle(marker.centroid_px, radius(marker), CUT);
    }
    for (number, track) in frames.tracks.iter().enumerate() {
        let Some(marker) = track.pressed.or(track.rest) else {
            continue;
        };
        let radius = radius(&marker);
        canvas.circle(marker.centroid_px, radius, colour(track.status));
        let across = 2.0 * radius * f64::from(SIDE) / f64::from(pressed.width().max(1));
        if across.max(2.0 * radius) >= LEGIBLE {
            let above = [marker.centroid_px[0], marker.centroid_px[1] - radius];
            canvas.number(number, above, 10, colour(track.status));
        }
        if let (Some(rest), Some(change)) = (track.rest, track.change()) {
            let shift = change.shift_px.map(|shift| ARROW_SCALE * shift);
            canvas.arrow(rest.centroid_px, shift, ARROW);
        }
    }
    canvas.into_picture()
}

/// Radius of a circle a little larger than a round marker, px.
fn radius(marker: &Marker) -> f64 {
    let area = f64::from(marker.pixels).max(4.0);
    1.2 * (area / std::f64::consts::PI).sqrt()
}
