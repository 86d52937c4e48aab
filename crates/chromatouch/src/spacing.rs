//! Points that lie too close together.

use std::collections::HashMap;

/// Two points nearer to each other than they may be.
pub(crate) struct TooClose {
    /// Which, from 0; the first such pair in the order of the second.
    pub(crate) first: usize,
    pub(crate) second: usize,
    /// Distance from one to the other.
    pub(crate) distance: f64,
}

/// Two points less than `reach` apart, if there are any. Cells as wide as the reach hold few that are not; narrower
/// ones than `narrowest` could not be counted.
pub(crate) fn too_close<const D: usize>(
    points: &[[f64; D]],
    reach: f64,
    narrowest: f64,
) -> Option<TooClose> {
    let width = reach.max(narrowest);
    let mut cells: HashMap<[i64; D], Vec<usize>> = HashMap::new();
    for (second, point) in points.iter().enumerate() {
        let cell = point.map(|coordinate| (coordinate / width).floor() as i64);
        for around in 0..3_usize.pow(D as u32) {
            let neighbour = std::array::from_fn(|axis| {
                let step = around / 3_usize.pow(axis as u32) % 3;
                cell[axis] + step as i64 - 1
            });
            for &first in cells.get(&neighbour).into_iter().flatten() {
                let distance = distance(&points[first], point);
                if distance < reach {
                    return Some(TooClose {
                        first,
                        second,
                        distance,
                    });
                }
            }
        }
        cells.entry(cell).or_default().push(second);
    }
    None
}

fn distance<const D: usize>(one: &[f64; D], other: &[f64; D]) -> f64 {
    let steps = one.iter().zip(other).map(|(one, other)| one - other);
    steps.fold(0.0, libm::hypot)
}
