//! Shapes that are two markers grown together.

use crate::shapes::{Run, Shape, join};

/// Share of its height above which a shape is more than the shade it stands in.
const STEEP: f64 = 0.6;

/// Cuts a shape in pieces where a higher limit does: each piece of at least `least` pixels. The pixels between the pieces
/// go to the nearest. The shape alone, if no limit parts it.
pub(crate) fn split(
    shape: Shape,
    plane: &[u8],
    width: usize,
    limit: u8,
    least: usize,
) -> Vec<Shape> {
    let greatest = shape
        .runs
        .iter()
        .flat_map(|run| &plane[run.row * width + run.first..=run.row * width + run.last])
        .fold(0, |greatest, &value| value.max(greatest));
    let step = (greatest.saturating_sub(limit) / 16).max(1);
    let mut higher = limit.saturating_add(step);
    while higher < greatest {
        let runs = above(&shape, plane, width, higher);
        let pieces = join(&runs, usize::MAX).unwrap_or_default();
        let pieces: Vec<Shape> = pieces
            .into_iter()
            .filter(|piece| piece.area() >= least)
            .collect();
        if pieces.len() > 1 {
            return shared_out(&shape, &pieces);
        }
        higher = higher.saturating_add(step);
    }
    vec![shape]
}

/// The pieces of a shape that lie above a share of its own height, which nine tenths of it do not exceed: what it is
/// without the shade that it stands in.
pub(crate) fn steep(shape: &Shape, plane: &[u8], width: usize) -> Vec<Shape> {
    let mut values: Vec<u8> = shape
        .runs
        .iter()
        .flat_map(|run| &plane[run.row * width + run.first..=run.row * width + run.last])
        .copied()
        .collect();
    let high = values.len() * 9 / 10;
    let (_, &mut height, _) = values.select_nth_unstable(high);
    let limit = (STEEP * f64::from(height)) as u8;
    join(&above(shape, plane, width, limit), usize::MAX).unwrap_or_default()
}

fn above(shape: &Shape, plane: &[u8], width: usize, limit: u8) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for run in &shape.runs {
        for column in run.first..=run.last {
            if plane[run.row * width + column] > limit {
                match runs.last_mut() {
                    Some(last) if last.row == run.row && last.last + 1 == column => {
                        last.last = column
                    }
                    _ => runs.push(Run {
                        row: run.row,
                        first: column,
                        last: column,
                    }),
                }
            }
        }
    }
    runs
}

/// Every pixel of the shape to the piece with the nearest middle, in that piece's radii.
fn shared_out(shape: &Shape, pieces: &[Shape]) -> Vec<Shape> {
    let middles: Vec<([f64; 2], f64)> = pieces
        .iter()
        .map(|piece| (piece.form().middle, piece.area() as f64))
        .collect();
    let mut shared = vec![Shape::default(); pieces.len()];
    for run in &shape.runs {
        for column in run.first..=run.last {
            let away = |&([x, y], area): &([f64; 2], f64)| {
                ((column as f64 - x).powi(2) + (run.row as f64 - y).powi(2)) / area
            };
            let nearest = (0..pieces.len())
                .min_by(|&a, &b| away(&middles[a]).total_cmp(&away(&middles[b])))
                .unwrap_or(0);
            match shared[nearest].runs.last_mut() {
                Some(last) if last.row == run.row && last.last + 1 == column => last.last = column,
                _ => shared[nearest].runs.push(Run {
                    row: run.row,
                    first: column,
                    last: column,
                }),
            }
        }
    }
    shared.retain(|piece| !piece.runs.is_empty());
    shared
}
