//! Selects the shapes that may be markers, by their size and form, and separates markers that touch.

use crate::shapes::{Run, Shape, join};

#[derive(Clone, Debug, Default)]
pub(crate) struct Selection {
    pub(crate) whole: Vec<Shape>,
    pub(crate) cut: Vec<Shape>,
    /// Diameter of a typical marker, in bins.
    pub(crate) diameter: f64,
}

/// Smallest area of a shape, in bins. A bin is a square of pixels.
const MIN_AREA: usize = 9;
/// Smallest and largest area of a complete marker, relative to the area of a typical marker.
const AREAS: [f64; 2] = [0.3, 3.0];
/// Smallest visible area of a cut-off marker, relative to the area of a typical marker.
const MIN_CUT_AREA: f64 = 0.1;
/// Area above which a shape may be several markers, relative to the area of a typical marker. A larger shape is split
/// if possible.
const SPLIT_AREA: f64 = 1.6;
/// Largest accepted ratio of a marker's length to its width.
const MAX_ELONGATION: f64 = 3.0;
/// Smallest accepted ratio of a marker's area to the area of the ellipse with the same second moments. The ratio is 1
/// for a disc.
const MIN_FILL: f64 = 0.7;
/// Limit of the grey value, relative to the 90 % quantile of the grey values in a marker's shape. Pixels below
/// the limit are removed from shapes at the rim of the image, because they may belong to shade around the marker.
const STEEP: f64 = 0.6;

impl Selection {
    pub(crate) fn shapes(&self) -> impl Iterator<Item = &Shape> {
        self.whole.iter().chain(&self.cut)
    }
}

/// Selects the shapes that may be markers. `shapes` contains all connected shapes of pixels whose value in `top_hat` is
/// above `limit`.
pub(crate) fn select(
    shapes: Vec<Shape>,
    top_hat: &[u8],
    limit: u8,
    width: usize,
    inside: &[bool],
) -> Selection {
    let sized = |shape: &Shape| shape.area() >= MIN_AREA;
    let (dim, mut whole): (Vec<Shape>, Vec<Shape>) = shapes
        .into_iter()
        .filter(sized)
        .partition(|shape| is_cut(shape, width, inside));
    // Near the rim of the sensor, the light often decreases steeply, and the shade connects several markers to one
    // shape. Therefore use only the parts of these shapes with large grey values.
    let steep: Vec<Shape> = dim
        .iter()
        .flat_map(|shape| steep(shape, top_hat, width))
        .filter(sized)
        .collect();
    let Some(typical) = typical_area(&whole).or_else(|| typical_area(&steep)) else {
        return Selection::default();
    };
    let least = (AREAS[0] * typical) as usize;
    let parted = |shape: Shape| {
        if shape.area() as f64 > SPLIT_AREA * typical {
            split(shape, top_hat, width, limit, least)
        } else {
            vec![shape]
        }
    };
    let (cut, freed): (Vec<Shape>, Vec<Shape>) = steep
        .into_iter()
        .flat_map(parted)
        .partition(|shape| is_cut(shape, width, inside));
    whole = whole.into_iter().flat_map(parted).chain(freed).collect();
    whole.retain(|shape| {
        let sizes = AREAS[0] * typical..AREAS[1] * typical;
        sizes.contains(&(shape.area() as f64)) && has_marker_form(shape)
    });
    Selection {
        whole,
        cut: cut
            .into_iter()
            .filter(|shape| {
                (MIN_CUT_AREA * typical..AREAS[1] * typical).contains(&(shape.area() as f64))
            })
            .collect(),
        diameter: (4.0 / std::f64::consts::PI * typical).sqrt(),
    }
}

/// Typical area of a marker: the median area of the shapes that may be markers; `None` if there are none. In the
/// median, each shape is weighted by its area, so that small specks have little influence.
fn typical_area(shapes: &[Shape]) -> Option<f64> {
    let mut areas: Vec<usize> = shapes
        .iter()
        .filter(|shape| has_marker_form(shape))
        .map(Shape::area)
        .collect();
    areas.sort_unstable();
    let half = areas.iter().sum::<usize>() / 2;
    let mut sum = 0;
    areas
        .into_iter()
        .find(|area| {
            sum += area;
            sum >= half
        })
        .map(|area| area as f64)
}

fn has_marker_form(shape: &Shape) -> bool {
    let form = shape.form();
    form.elongation < MAX_ELONGATION && form.fill > MIN_FILL
}

/// Whether a shape reaches the rim of the sensor or the border of the frame.
fn is_cut(shape: &Shape, width: usize, inside: &[bool]) -> bool {
    let height = inside.len() / width;
    shape.runs.iter().any(|run| {
        let border =
            run.first == 0 || run.row == 0 || run.last + 1 == width || run.row + 1 == height;
        border
            || (run.row - 1..=run.row + 1).any(|row| {
                let line = &inside[row * width..][..width];
                line[run.first - 1..=run.last + 1].contains(&false)
            })
    })
}

/// Splits a shape into pieces. Raises the smallest accepted grey value until the remaining pixels form several pieces
/// of at least `least` pixels. Then assigns all other pixels of the shape to the nearest piece. If this is impossible,
/// returns the shape itself.
fn split(shape: Shape, plane: &[u8], width: usize, limit: u8, least: usize) -> Vec<Shape> {
    let greatest = shape.values(plane, width).max().unwrap_or(0);
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
            return assign_pixels(&shape, &pieces);
        }
        higher = higher.saturating_add(step);
    }
    vec![shape]
}

/// The parts of a shape in which the grey values are above [`STEEP`] times the shape's 90 % quantile of grey values.
/// This removes the shade around a marker.
fn steep(shape: &Shape, plane: &[u8], width: usize) -> Vec<Shape> {
    let mut values: Vec<u8> = shape.values(plane, width).collect();
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
                push_pixel(&mut runs, run.row, column);
            }
        }
    }
    runs
}

fn push_pixel(runs: &mut Vec<Run>, row: usize, column: usize) {
    match runs.last_mut() {
        Some(last) if last.row == row && last.last + 1 == column => last.last = column,
        _ => runs.push(Run {
            row,
            first: column,
            last: column,
        }),
    }
}

/// Assigns every pixel of the shape to the nearest piece. For this comparison, the distance from the middle of a piece
/// is divided by the piece's radius.
fn assign_pixels(shape: &Shape, pieces: &[Shape]) -> Vec<Shape> {
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
            push_pixel(&mut shared[nearest].runs, run.row, column);
        }
    }
    shared.retain(|piece| !piece.runs.is_empty());
    shared
}
