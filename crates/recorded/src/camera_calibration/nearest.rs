//! Matches markers of a frame with the expected positions of a layout's markers.

use palpate_tracking::{Found, Marker};

/// For each expected position: index of the nearest marker, among the markers that have no nearer expected position.
pub(super) fn nearest(expected: &[Option<[f64; 2]>], found: &Found) -> Vec<Option<usize>> {
    let mut nearest = vec![None; expected.len()];
    let mut distances = vec![f64::INFINITY; expected.len()];
    for (number, marker) in found.markers.iter().enumerate() {
        if let Some((at, distance)) = closest(expected, marker)
            && distance < distances[at]
        {
            distances[at] = distance;
            nearest[at] = Some(number);
        }
    }
    nearest
}

/// Index of the expected position that is nearest to a marker of a frame, and its distance, px.
pub(super) fn closest(expected: &[Option<[f64; 2]>], marker: &Marker) -> Option<(usize, f64)> {
    let [x, y] = marker.centroid_px;
    let all = expected.iter().enumerate().filter_map(|(at, centroid)| {
        let [column, row] = (*centroid)?;
        Some((at, libm::hypot(column - x, row - y)))
    });
    all.min_by(|one, other| one.1.total_cmp(&other.1))
}
