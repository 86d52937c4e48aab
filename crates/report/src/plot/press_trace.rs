//! Pictures of one press: how its markers moved, and what the sensor reads of it.

mod contact;
mod profile;
mod quiver;
mod table;

use super::drawing::Figure;
use crate::{Files, ReportError};

/// Draws a press from `trace.csv` and `readings.csv`, as `palpate trace` writes them: `quiver` shows the markers from
/// above at their places on the skin, their displacements along it as arrows, true and read, and the normal displacement
/// as a shade; `trace-profile` shows the normal displacement against the distance from the contact, and below it the
/// component along the skin away from the contact, if it was read. A reading belongs to the marker at its place; markers
/// without one are marked.
///
/// # Errors
/// A table is absent or malformed, its lengths are in several units, or a reading is at no marker's place.
pub fn press_figures(files: &Files) -> Result<Vec<Figure>, ReportError> {
    let trace = table::read(files)?;
    Ok(vec![quiver::figure(&trace)?, profile::figure(&trace)?])
}
