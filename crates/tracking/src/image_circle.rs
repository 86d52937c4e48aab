//! The image circle: where a frame shows the sensor.

use crate::TrackingError;
use crate::binned::Binned;

/// The image circle of a camera. Pixels with their middle in it show the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mask {
    /// Column and row of its centre, px; the middle of the first pixel is (0, 0).
    pub centre_px: [f64; 2],
    /// Its radius, px.
    pub radius_px: f64,
}

/// Share of the corners' points that must lie on one circle for it to be the image circle.
const ON_CIRCLE: f64 = 0.5;
/// How far from a circle its points may lie, squares.
const NEAR: f64 = 1.5;
/// Circles through three points that are tried.
const TRIES: usize = 256;

impl Mask {
    /// The circle that holds a whole frame.
    pub(crate) fn whole(width: u32, height: u32) -> Self {
        let [x, y] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
        Self {
            centre_px: [x, y],
            radius_px: x.hypot(y) + 1.0,
        }
    }

    /// Fails unless the centre lies in a frame of this size and the radius is positive and finite.
    pub(crate) fn check(self, width: u32, height: u32) -> Result<Self, TrackingError> {
        let [x, y] = self.centre_px;
        let within = (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y);
        if within && self.radius_px > 0.0 && self.radius_px.is_finite() {
            Ok(self)
        } else {
            Err(TrackingError::MaskOutside {
                x_px: x,
                y_px: y,
                radius_px: self.radius_px,
            })
        }
    }

    /// The columns, first and one past the last, of the pixels of row `row` in the circle made smaller by `less` px, in a
    /// frame of `width` columns.
    pub(crate) fn columns(&self, row: f64, less: f64, width: usize) -> (usize, usize) {
        let radius = self.radius_px - less;
        let across = radius * radius - (row - self.centre_px[1]).powi(2);
        if radius <= 0.0 || across < 0.0 {
            return (0, 0);
        }
        let half = across.sqrt();
        let first = (self.centre_px[0] - half).ceil().max(0.0);
        let last = (self.centre_px[0] + half).floor().min(width as f64 - 1.0);
        if last < first {
            (0, 0)
        } else {
            (first as usize, last as usize + 1)
        }
    }

    /// Finds the circle: the corners of the frame show one colour, and where that colour ends lies on a circle.
    pub(crate) fn find(binned: &Binned) -> Option<Self> {
        let outside = Outside::of(binned)?;
        let edge = outside.edge(binned);
        let circle = Circle::through_most(&edge)?;
        let [x, y] = circle.centre;
        let (width, height) = (binned.width as f64, binned.height as f64);
        let fits = (0.0..width).contains(&x)
            && (0.0..height).contains(&y)
            && circle.radius > 0.2 * width.min(height)
            && circle.radius < 0.75 * width.max(height);
        let bin = binned.bin as f64;
        fits.then(|| Self {
            centre_px: circle.centre.map(|at| at * bin + (bin - 1.0) / 2.0),
            radius_px: circle.radius * bin,
        })
    }
}

/// The colour outside the circle, in sums over squares, and how far it strays.
struct Outside {
    colour: [f64; 3],
    tolerance: f64,
}

impl Outside {
    /// The corners' colour, when at least three of the four are alike.
    fn of(binned: &Binned) -> Option<Self> {
        let (width, height) = (binned.width, binned.height);
        let side = (width.min(height) / 40).max(2);
        let corners = [
            (0, 0),
            (width - side, 0),
            (0, height - side),
            (width - side, height - side),
        ]
        .map(|(x, y)| {
            let mut corner: Vec<[u16; 3]> = Vec::with_capacity(side * side);
            for row in y..y + side {
                corner.extend_from_slice(&binned.sums[row * width + x..][..side]);
            }
            corner
        });
        let means = corners.each_ref().map(|corner| mean(corner));
        let grey = binned.pixels() as f64;
        let (like, colour) = means
            .iter()
            .map(|colour| {
                let like = [0, 1, 2, 3].map(|other| away(colour, &means[other]) < 16.0 * grey);
                (like, colour)
            })
            .max_by_key(|(like, _)| like.iter().filter(|&&like| like).count())?;
        if like.iter().filter(|&&like| like).count() < 3 {
            return None;
        }
        let (mut square, mut count) = (0.0, 0.0);
        for value in corners
            .iter()
            .zip(like)
            .filter(|(_, like)| *like)
            .flat_map(|(corner, _)| corner)
        {
            square += away(colour, &value.map(f64::from)).powi(2);
            count += 1.0;
        }
        Some(Self {
            colour: *colour,
            tolerance: (4.0 * (square / count).sqrt()).max(8.0 * grey),
        })
    }

    /// The first squares of another colour, seen along rows and columns from all four sides.
    fn edge(&self, binned: &Binned) -> Vec<[f64; 2]> {
        let (width, height) = (binned.width, binned.height);
        let differs = |x: usize, y: usize| {
            away(&self.colour, &binned.sums[y * width + x].map(f64::from)) > self.tolerance
        };
        let mut edge = Vec::with_capacity(2 * (width + height));
        for y in 0..height {
            if let Some(left) = (0..width).find(|&x| differs(x, y)) {
                let right = (left..width).rfind(|&x| differs(x, y)).unwrap_or(left);
                edge.push([left as f64 - 0.5, y as f64]);
                edge.push([right as f64 + 0.5, y as f64]);
            }
        }
        for x in 0..width {
            if let Some(top) = (0..height).find(|&y| differs(x, y)) {
                let bottom = (top..height).rfind(|&y| differs(x, y)).unwrap_or(top);
                edge.push([x as f64, top as f64 - 0.5]);
                edge.push([x as f64, bottom as f64 + 0.5]);
            }
        }
        // Where another colour reaches the frame's own border the circle is cut off: no point of it is seen there.
        let (right, bottom) = (width as f64 - 1.0, height as f64 - 1.0);
        edge.retain(|[x, y]| *x > 0.5 && *y > 0.5 && *x < right - 0.5 && *y < bottom - 0.5);
        edge
    }
}

fn mean(values: &[[u16; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for value in values {
        for (sum, &value) in sum.iter_mut().zip(value) {
            *sum += f64::from(value);
        }
    }
    sum.map(|sum| sum / values.len() as f64)
}

/// The largest difference of the three colours.
fn away(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[derive(Clone, Copy)]
struct Circle {
    centre: [f64; 2],
    radius: f64,
}

impl Circle {
    /// The circle that most points lie on, if at least half do; then fitted to those by least squares.
    fn through_most(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len();
        if count < 16 {
            return None;
        }
        let near = |circle: &Self| points.iter().filter(|point| circle.holds(point)).count();
        // Points far from one another along the list, stepped through evenly: the same ones in every run.
        let (_, best) = (0..TRIES)
            .filter_map(|attempt| {
                let at = |share: f64| points[((share * count as f64) as usize) % count];
                let turn = (attempt as f64 * 0.618_033_988_749_895).fract();
                let wide = 0.2 + 0.15 * (attempt as f64 * 0.754_877_666_246_693).fract();
                Self::through([at(turn), at(turn + wide), at(turn + 2.0 * wide)])
            })
            .map(|circle| (near(&circle), circle))
            .max_by_key(|(near, _)| *near)?;
        let mut circle = best;
        for _ in 0..3 {
            let held: Vec<[f64; 2]> = points
                .iter()
                .copied()
                .filter(|point| circle.holds(point))
                .collect();
            circle = Self::fitted(&held)?;
        }
        (near(&circle) as f64 >= ON_CIRCLE * count as f64).then_some(circle)
    }

    fn holds(&self, point: &[f64; 2]) -> bool {
        let [x, y] = [0, 1].map(|axis| point[axis] - self.centre[axis]);
        (x.hypot(y) - self.radius).abs() < NEAR
    }

    fn through(points: [[f64; 2]; 3]) -> Option<Self> {
        Self::fitted(&points)
    }

    /// Least squares of `x² + y² = 2 a x + 2 b y + c`: the algebraic fit, exact through three points.
    fn fitted(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len() as f64;
        let middle = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
        let (mut xx, mut xy, mut yy, mut xs, mut ys, mut squares) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for point in points {
            let [x, y] = [0, 1].map(|axis| point[axis] - middle[axis]);
            let square = x * x + y * y;
            xx += x * x;
            xy += x * y;
            yy += y * y;
            xs += x * square;
            ys += y * square;
            squares += square;
        }
        let area = xx * yy - xy * xy;
        let offset = [
            (yy * xs - xy * ys) / (2.0 * area),
            (xx * ys - xy * xs) / (2.0 * area),
        ];
        let radius = (offset[0].powi(2) + offset[1].powi(2) + squares / count).sqrt();
        radius.is_finite().then_some(Self {
            centre: [0, 1].map(|axis| middle[axis] + offset[axis]),
            radius,
        })
    }
}
