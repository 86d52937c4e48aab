//! Placement of the next knot.

use super::mesh::Mesh;
use super::observations::IntervalSums;

/// A knot splits its interval at worst one to this.
const MOST_UNEVEN: f64 = 10.0;

/// The variable and the place of the next knot, if there is one.
///
/// Of all intervals along the slow and then along the fast variable it is the one with the largest
/// sum of squared residuals, split at their centroid; intervals that this would split too unevenly
/// are passed over, as are variables with `most_knots` interior knots.
pub(super) fn next_knot(
    mesh: &Mesh,
    sums: &[Vec<IntervalSums>; 2],
    most_knots: [usize; 2],
) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for axis in [mesh.slow(), mesh.fast()] {
        let knots = &mesh.knots[axis];
        let interior = knots.interior();
        if interior.len() >= most_knots[axis] {
            continue;
        }
        let (start, end) = knots.domain();
        let below = std::iter::once(start).chain(interior.iter().copied());
        let above = interior.iter().copied().chain(std::iter::once(end));
        for ((below, above), interval) in below.zip(above).zip(&sums[axis]) {
            if interval.squares <= best.map_or(0.0, |(largest, ..)| largest) {
                continue;
            }
            let centroid = interval.moments / interval.squares;
            if splits(below, centroid, above) {
                best = Some((interval.squares, axis, centroid));
            }
        }
    }
    best.map(|(_, axis, centroid)| (axis, centroid))
}

fn splits(below: f64, knot: f64, above: f64) -> bool {
    let (left, right) = (knot - below, above - knot);
    left > 0.0 && right > 0.0 && left <= MOST_UNEVEN * right && right <= MOST_UNEVEN * left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(of: &[(f64, f64)]) -> Vec<IntervalSums> {
        of.iter()
            .map(|&(squares, centroid)| IntervalSums {
                squares,
                moments: squares * centroid,
            })
            .collect()
    }

    #[test]
    fn the_largest_sum_that_can_be_split() {
        let mut mesh = Mesh::new([2, 2], [[0.0, 2.0], [0.0, 1.0]]);
        mesh.insert(0, 1.0);
        let unlimited = [usize::MAX; 2];
        let along_v = sums(&[(4.0, 0.25)]);
        let all = [sums(&[(2.0, 0.5), (9.0, 1.25)]), along_v.clone()];
        assert_eq!(next_knot(&mesh, &all, unlimited), Some((0, 1.25)));
        assert_eq!(next_knot(&mesh, &all, [1, 9]), Some((1, 0.25)));
        assert_eq!(next_knot(&mesh, &all, [1, 0]), None);
        // The largest sum stands at its interval's edge.
        let all = [sums(&[(2.0, 0.5), (9.0, 1.01)]), along_v];
        assert_eq!(next_knot(&mesh, &all, unlimited), Some((1, 0.25)));
    }
}
