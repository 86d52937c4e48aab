//! Compares the distances and the normals of contacts along strokes. The noise of positions and the noise of normals are
//! independent of each other. If the distances change along a stroke as the normals tilt, both come from a surface of
//! another shape.

use nalgebra::Vector3;
use palpate_statistics::ratio_tail;

use super::pose::{Cloud, Pose};
use crate::patch::FingerMap;

/// Smallest number of pairs of blocks from which the agreement is computed.
const MIN_PAIRS: usize = 6;

/// P-value of the agreement: the probability that independent noise of positions and normals agrees at least as well.
/// `fingers` contains the number of the finger of each contact.
pub(super) fn p_value(pose: &Pose, cloud: &Cloud, fingers: &[usize]) -> f64 {
    // For each contact of a stroke: its distance from the shape, and its height above the shape according to the
    // normals. This height is the integral of the normals' tilt along the stroke.
    let mut strokes: FingerMap<Vec<[f64; 2]>> = FingerMap::default();
    let mut last: FingerMap<Option<[Vector3<f64>; 2]>> = FingerMap::default();
    for ((place, normal), &finger) in cloud.places.iter().zip(&cloud.normals).zip(fingers) {
        let tilt = normal - pose.normal_at(place);
        let stroke = strokes.entry(finger);
        let before = last.entry(finger).replace([*place, tilt]);
        let height = before
            .zip(stroke.last())
            .map(|([from, other], [_, height])| height - 0.5 * (tilt + other).dot(&(place - from)));
        stroke.push([pose.distance(place), height.unwrap_or(0.0)]);
    }
    let (mut smallest, mut scales) = (1.0_f64, 0.0);
    for size in (0..).map(|power| 1 << power) {
        let (mut sums, mut pairs) = ([0.0; 3], 0);
        for stroke in strokes.iter() {
            let mean = |block: &[[f64; 2]]| {
                [0, 1].map(|kind| block.iter().map(|one| one[kind]).sum::<f64>() / size as f64)
            };
            let means: Vec<[f64; 2]> = stroke.chunks_exact(size).map(mean).collect();
            for pair in means.windows(2) {
                let [x, y] = [0, 1].map(|kind| pair[1][kind] - pair[0][kind]);
                sums = [sums[0] + x * x, sums[1] + x * y, sums[2] + y * y];
                pairs += 1;
            }
        }
        if pairs < MIN_PAIRS {
            break;
        }
        scales += 1.0;
        let [squares, products, of_normals] = sums;
        if products > 0.0 {
            let explained = products * products / of_normals;
            let left = (squares - explained).max(0.0);
            smallest = smallest.min(0.5 * ratio_tail(explained, 1, left, pairs - 1));
        }
    }
    (scales * smallest).clamp(0.0, 1.0)
}
