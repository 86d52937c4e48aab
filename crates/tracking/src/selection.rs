//! Which shapes may be markers: of a marker's size and form, whole or cut off by the rim.

use crate::shapes::Shape;
use crate::split::{split, steep};

/// Shapes that may be markers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selection {
    /// Shapes that are seen whole.
    pub(crate) whole: Vec<Shape>,
    /// Shapes that are cut off by the circle or the frame.
    pub(crate) cut: Vec<Shape>,
    /// Diameter of a typical marker, in squares.
    pub(crate) diameter: f64,
}

/// The least area of a shape, squares.
const LEAST_AREA: usize = 9;
/// Least and largest area of a whole marker, as multiples of a typical one's.
const AREAS: [f64; 2] = [0.3, 3.0];
/// The least area of what is left of a cut one, in typical ones.
const LEAST_CUT: f64 = 0.1;
/// Larger ones, in typical ones, are cut in pieces where they can be.
const OVERSIZED: f64 = 1.6;
/// Largest length of a marker, in breadths.
const LONGEST: f64 = 3.0;
/// The least share of its ellipse that a marker fills.
const LEAST_FILL: f64 = 0.7;

impl Selection {
    /// All shapes, the whole ones first.
    pub(crate) fn shapes(&self) -> impl Iterator<Item = &Shape> {
        self.whole.iter().chain(&self.cut)
    }
}

/// Chooses among the shapes of `top_hat` above `limit`.
pub(crate) fn select(
    shapes: Vec<Shape>,
    top_hat: &[u8],
    limit: u8,
    width: usize,
    inside: &[bool],
) -> Selection {
    let sized = |shape: &Shape| shape.area() >= LEAST_AREA;
    let (dim, mut whole): (Vec<Shape>, Vec<Shape>) = shapes
        .into_iter()
        .filter(sized)
        .partition(|shape| is_cut(shape, width, inside));
    // Towards the rim light often falls steeply: the shade there joins what stands in it.
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
        if shape.area() as f64 > OVERSIZED * typical {
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
        let form = shape.form();
        (AREAS[0] * typical..AREAS[1] * typical).contains(&(shape.area() as f64))
            && form.elongation < LONGEST
            && form.fill > LEAST_FILL
    });
    Selection {
        whole,
        cut: cut
            .into_iter()
            .filter(|shape| {
                (LEAST_CUT * typical..AREAS[1] * typical).contains(&(shape.area() as f64))
            })
            .collect(),
        diameter: (4.0 / std::f64::consts::PI * typical).sqrt(),
    }
}

/// The area up to which shapes that might be markers hold half of all their pixels: specks do not count for much.
fn typical_area(shapes: &[Shape]) -> Option<f64> {
    let mut areas: Vec<usize> = shapes
        .iter()
        .filter(|shape| {
            let form = shape.form();
            form.elongation < LONGEST && form.fill > LEAST_FILL
        })
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

/// Whether a shape reaches the rim of the circle or the border of the frame.
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
