//! The image circle: where a frame shows the sensor.

use crate::TrackingError;
use crate::binned::Binned;
use crate::rim::Rim;

/// The image circle of a camera. Pixels with their middle in it show the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mask {
    /// Column and row of its centre, px; the middle of the first pixel is (0, 0).
    pub centre_px: [f64; 2],
    /// Its radius, px.
    pub radius_px: f64,
}

/// Share of a rim's points that must lie on one circle for it to be the image circle.
const ON_CIRCLE: f64 = 0.5;
/// Share of the circle, as far as it lies in the frame, along which its rim must be seen.
const ALL_AROUND: f64 = 0.8;
/// Squares along the circle within which a point of the rim must lie.
const STEP: f64 = 4.0;
/// How far from a circle its points may lie: squares, and shares of its radius.
const NEAR: [f64; 2] = [1.5, 0.01];
/// Circles through three points that are tried.
const TRIES: usize = 64;
/// Points that are tried at most.
const POINTS: usize = 256;

impl Mask {
    /// The circle that holds a whole frame.
    pub(crate) fn whole(width: u32, height: u32) -> Self {
        let [x, y] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
        Self {
            centre_px: [x, y],
            radius_px: libm::hypot(x, y) + 1.0,
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

    /// The circle in squares of `bin` pixels a side.
    pub(crate) fn coarse(&self, bin: usize) -> Self {
        let bin = bin as f64;
        Self {
            centre_px: self.centre_px.map(|at| (at - 0.5 * (bin - 1.0)) / bin),
            radius_px: self.radius_px / bin,
        }
    }

    /// Marks, for each pixel of a frame of `size` columns and rows, whether it lies in the circle made smaller by
    /// `less` px.
    pub(crate) fn fill(&self, less: f64, size: [usize; 2], inside: &mut Vec<bool>) {
        inside.clear();
        inside.resize(size[0] * size[1], false);
        for (row, line) in inside.chunks_exact_mut(size[0]).enumerate() {
            let (first, end) = self.columns(row as f64, less, size[0]);
            line[first..end].fill(true);
        }
    }

    /// The circle of at least `least_px` radius that a rim lies on, if it does and is seen nearly all around: the edges
    /// of a ring of markers have gaps between them.
    pub(crate) fn of(rim: &Rim, binned: &Binned, least_px: f64) -> Option<Self> {
        let points = rim.points();
        let circle = Circle::through_most(&points)?;
        let [x, y] = circle.centre;
        let (width, height) = (binned.width as f64, binned.height as f64);
        let bin = binned.bin as f64;
        let fits = (0.0..width).contains(&x)
            && (0.0..height).contains(&y)
            && circle.radius > 0.2 * width.min(height)
            && circle.radius * bin > least_px
            && circle.radius < 0.75 * width.max(height)
            && circle.seen(&points, [width, height]) > ALL_AROUND;
        fits.then(|| Self {
            centre_px: circle.centre.map(|at| at * bin + (bin - 1.0) / 2.0),
            radius_px: circle.radius * bin,
        })
    }
}

#[derive(Clone, Copy)]
struct Circle {
    centre: [f64; 2],
    radius: f64,
}

impl Circle {
    /// The circle that most points lie on, if at least half do; then fitted to those by least squares.
    fn through_most(points: &[[f64; 2]]) -> Option<Self> {
        let points: Vec<[f64; 2]> = points
            .iter()
            .copied()
            .step_by(points.len().div_ceil(POINTS).max(1))
            .collect();
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
        ((x * x + y * y).sqrt() - self.radius).abs() < NEAR[0] + NEAR[1] * self.radius
    }

    /// Share of the circle within a frame of this size along which points lie on it.
    fn seen(&self, points: &[[f64; 2]], size: [f64; 2]) -> f64 {
        use std::f64::consts::TAU;
        let steps = (TAU * self.radius / STEP).ceil().max(8.0);
        let mut seen = vec![false; steps as usize];
        for point in points.iter().filter(|point| self.holds(point)) {
            let turn = libm::atan2(point[1] - self.centre[1], point[0] - self.centre[0]) / TAU;
            let step = (turn.rem_euclid(1.0) * steps) as usize % seen.len();
            seen[step] = true;
        }
        let (mut within, mut count) = (0.0, 0.0);
        for (step, &seen) in seen.iter().enumerate() {
            let (sine, cosine) = libm::sincos(TAU * (step as f64 + 0.5) / steps);
            let at = [
                self.centre[0] + self.radius * cosine,
                self.centre[1] + self.radius * sine,
            ];
            if (0..2).all(|axis| at[axis] > NEAR[0] && at[axis] < size[axis] - 1.0 - NEAR[0]) {
                within += 1.0;
                count += f64::from(u8::from(seen));
            }
        }
        if within > 0.0 { count / within } else { 0.0 }
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
