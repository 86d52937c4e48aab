//! Pictures of one press: how its markers moved, and what the sensor reads of it.

mod contact;
mod profile;
mod quiver;
mod table;

use super::picture::Picture;
use super::write;
use crate::{ReportError, words};
use std::path::{Path, PathBuf};
use table::Trace;

pub(crate) use quiver::Quiver;

/// Draws a press from `trace.csv` and `readings.csv` in `dir`, as `palpate trace` writes them, into the same folder:
/// `quiver.svg` and `.png` show the markers from above at their places on the skin, their displacements along it as
/// arrows, true and read, and the normal displacement as a shade; `trace-profile.svg` and `.png` show the normal
/// displacement against the distance from the contact, and below it the component along the skin away from the contact,
/// if it was read. A reading belongs to the marker at its place; markers without one are marked. Returns the files in
/// that order.
///
/// # Errors
/// A table is absent or malformed, its lengths are in several units, a reading is at no marker's place; or a picture
/// cannot be written. Nothing is half-written.
pub fn draw_press_trace(dir: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let trace = table::read(dir)?;
    let pictures = [
        Picture::Stack(profile::stack(&trace)),
        Picture::Quiver(Box::new(Quiver::of(trace))),
    ];
    let [profile, quiver] = pictures;
    let mut written = Vec::new();
    for picture in [quiver, profile] {
        written.extend(write(&picture, dir)?);
    }
    Ok(written)
}

/// How many markers there are, how many are lost, and how well the others are read.
fn subtitle(trace: &Trace) -> String {
    let count = trace.markers.len();
    let mut markers = format!("{count} marker{}", if count == 1 { "" } else { "s" });
    if trace.lost() > 0 {
        markers += &format!(", {} without a reading", trace.lost());
    }
    let (normal, tangential) = trace.off();
    let told = |off: Option<f64>, of: &str| {
        let unit = words::unit(&trace.unit);
        let off = format!("{} {unit}", words::significant(off?, 3));
        Some(format!("{} {of}", off.trim_end()))
    };
    let off = [told(normal, "inward"), told(tangential, "along the skin")];
    let off: Vec<String> = off.into_iter().flatten().collect();
    if off.is_empty() {
        markers
    } else {
        format!("{markers} · rms error {}", off.join(", "))
    }
}
