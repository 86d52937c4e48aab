//! Markers of a frame, by where those of a layout are expected.

use palpate_tracking::{Found, Marker};

/// Number of the marker of a frame nearest to where each of the layout's is expected, if that one is the nearest to it too.
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

/// Number of the expected marker that is nearest to one of a frame, and its distance, px.
pub(super) fn closest(expected: &[Option<[f64; 2]>], marker: &Marker) -> Option<(usize, f64)> {
    let [x, y] = marker.centroid_px;
    let all = expected.iter().enumerate().filter_map(|(at, centroid)| {
        let [column, row] = (*centroid)?;
        Some((at, libm::hypot(column - x, row - y)))
    });
    all.min_by(|one, other| one.1.total_cmp(&other.1))
}
