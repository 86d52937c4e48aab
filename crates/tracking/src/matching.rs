//! Markers of a rest frame found again in a pressed one.

use crate::{Marker, Track};

/// Draft.
pub fn match_markers(_rest: &[Marker], _pressed: &[Marker]) -> Vec<Track> {
    Vec::new()
}
