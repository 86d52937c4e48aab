//! The image circle: the part of a frame that shows the sensor, and the rim of that part.

use crate::TrackingError;
use crate::binning::BinnedFrame;

/// The image circle of a camera. A pixel shows the sensor if its middle is inside the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mask {
    /// Column and row of the circle's centre, px; the middle of the first pixel is (0, 0).
    pub centre_px: [f64; 2],
    /// Radius of the image circle, px.
    pub radius_px: f64,
}

/// The rim of the sensor is accepted as a circle only if at least this share of the rim's points lies on one circle.
const MIN_POINTS_ON_CIRCLE: f64 = 0.5;
/// The rim of the sensor is accepted as a circle only if it is visible along more than this share of the circle. Parts
/// of the circle outside of the frame do not count.
const MIN_VISIBLE: f64 = 0.8;
/// Length of the arcs into which the image circle is divided, in bins of pixels. The rim is visible along an arc if a
/// point of the rim lies on this arc.
const STEP: f64 = 4.0;
/// Largest accepted distance of a rim point from the fitted circle, in bins (squares of pixels): the first number, plus
/// the second number times the circle's radius.
const MAX_DISTANCE: [f64; 2] = [1.5, 0.01];
/// Number of circles that are tried in the search for the rim. Each circle passes through three points of the rim.
const TRIES: usize = 64;
const MAX_POINTS: usize = 256;

impl Mask {
    pub(crate) fn whole(width: u32, height: u32) -> Self {
        let [x, y] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
        Self {
            centre_px: [x, y],
            radius_px: libm::hypot(x, y) + 1.0,
        }
    }

    /// Checks that the circle's centre is in a frame of `width` columns and `height` rows, and that its radius is
    /// positive and finite.
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

    /// Columns of the pixels that are inside the circle, in the row `row` of a frame with `width` columns: the first
    /// column, and the column after the last. The radius of the circle is reduced by `less` px.
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

    /// This circle in the coordinates of a frame at lower resolution, whose points are bins (squares) of `bin` pixels a
    /// side.
    pub(crate) fn coarse(&self, bin: usize) -> Self {
        let bin = bin as f64;
        Self {
            centre_px: self.centre_px.map(|at| (at - 0.5 * (bin - 1.0)) / bin),
            radius_px: self.radius_px / bin,
        }
    }

    /// Marks in `inside` the pixels that are inside the circle. `size` contains the frame's number of columns and
    /// number of rows. The radius of the circle is reduced by `less` px.
    pub(crate) fn fill(&self, less: f64, size: [usize; 2], inside: &mut Vec<bool>) {
        inside.clear();
        inside.resize(size[0] * size[1], false);
        for (row, line) in inside.chunks_exact_mut(size[0]).enumerate() {
            let (first, end) = self.columns(row as f64, less, size[0]);
            line[first..end].fill(true);
        }
    }

    /// The circle on which the rim of the sensor lies; `None` unless the rim is visible along most of this circle.
    /// Therefore a ring of markers, which has gaps, is not accepted as a rim.
    pub(crate) fn fit(rim: &Rim, binned: &BinnedFrame) -> Option<Self> {
        let points = rim.points();
        let circle = Circle::through_most(&points)?;
        let [x, y] = circle.centre;
        let (width, height) = (binned.width as f64, binned.height as f64);
        let bin = binned.bin as f64;
        let fits = (0.0..width).contains(&x)
            && (0.0..height).contains(&y)
            && circle.radius > 0.2 * width.min(height)
            && circle.radius < 0.75 * width.max(height)
            && circle.visible_share(&points, [width, height]) > MIN_VISIBLE;
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
    /// The circle on which most of the points lie, fitted to these points by least squares. `None` if fewer than half
    /// of the points lie on one circle.
    fn through_most(points: &[[f64; 2]]) -> Option<Self> {
        let points: Vec<[f64; 2]> = points
            .iter()
            .copied()
            .step_by(points.len().div_ceil(MAX_POINTS).max(1))
            .collect();
        let count = points.len();
        if count < 16 {
            return None;
        }
        let near = |circle: &Self| points.iter().filter(|point| circle.holds(point)).count();
        // Each attempt uses three points that are far apart on the rim. A fixed sequence selects them instead of a
        // random one, so that the same frame always gives the same result.
        let (_, best) = (0..TRIES)
            .filter_map(|attempt| {
                let at = |share: f64| points[((share * count as f64) as usize) % count];
                let turn = (attempt as f64 * 0.618_033_988_749_895).fract();
                let wide = 0.2 + 0.15 * (attempt as f64 * 0.754_877_666_246_693).fract();
                Self::fit(&[at(turn), at(turn + wide), at(turn + 2.0 * wide)])
            })
            .map(|circle| (near(&circle), circle))
            .max_by_key(|(near, _)| *near)?;
        let mut circle = best;
        for _ in 0..3 {
            let near = points.iter().copied().filter(|point| circle.holds(point));
            circle = Self::fit(&near.collect::<Vec<_>>())?;
        }
        (near(&circle) as f64 >= MIN_POINTS_ON_CIRCLE * count as f64).then_some(circle)
    }

    fn holds(&self, point: &[f64; 2]) -> bool {
        let [x, y] = [0, 1].map(|axis| point[axis] - self.centre[axis]);
        ((x * x + y * y).sqrt() - self.radius).abs()
            < MAX_DISTANCE[0] + MAX_DISTANCE[1] * self.radius
    }

    /// Share of the circle (0 to 1) along which there are points of the rim. Parts of the circle outside of the frame
    /// do not count; `size` is the width and the height of the frame.
    fn visible_share(&self, points: &[[f64; 2]], size: [f64; 2]) -> f64 {
        use std::f64::consts::TAU;
        let steps = (TAU * self.radius / STEP).ceil().max(8.0);
        let mut visible = vec![false; steps as usize];
        for point in points.iter().filter(|point| self.holds(point)) {
            let turn = libm::atan2(point[1] - self.centre[1], point[0] - self.centre[0]) / TAU;
            let step = (turn.rem_euclid(1.0) * steps) as usize % visible.len();
            visible[step] = true;
        }
        let (mut within, mut count) = (0.0, 0.0);
        for (step, &visible) in visible.iter().enumerate() {
            let (sine, cosine) = libm::sincos(TAU * (step as f64 + 0.5) / steps);
            let at = [
                self.centre[0] + self.radius * cosine,
                self.centre[1] + self.radius * sine,
            ];
            if (0..2).all(|axis| {
                at[axis] > MAX_DISTANCE[0] && at[axis] < size[axis] - 1.0 - MAX_DISTANCE[0]
            }) {
                within += 1.0;
                count += f64::from(u8::from(visible));
            }
        }
        if within > 0.0 { count / within } else { 0.0 }
    }

    /// Fits a circle with the centre (a, b) to points (x, y), by least squares of `x² + y² - 2 a x - 2 b y - c`
    /// (algebraic circle fit). If there are only three points, the circle passes exactly through them. `None` if the
    /// points do not determine a circle.
    fn fit(points: &[[f64; 2]]) -> Option<Self> {
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

/// The rim of the sensor in a frame: for each row and each column of bins, the first and the last bin whose colour
/// differs from the colour of the frame's corners.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rim {
    rows: Vec<Option<[usize; 2]>>,
    columns: Vec<Option<[usize; 2]>>,
}

/// The colours of two corners of the frame count as equal if they differ by less than this number of levels (0 to 255).
const MAX_CORNER_DIFFERENCE: f64 = 16.0;
/// A bin can count as part of the sensor only if its colour differs from the colour of the frame's corners by more than
/// this number of levels (0 to 255).
const MIN_DIFFERENCE: f64 = 8.0;

impl Rim {
    /// Finds the rim of the sensor. The result is `None` unless at least three of the frame's four corners have the
    /// same colour.
    pub(crate) fn find(binned: &BinnedFrame) -> Option<Self> {
        let (colour, tolerance) = corner_colour(binned)?;
        let (width, height) = (binned.width, binned.height);
        let differs = |x: usize, y: usize| {
            away(&colour, &binned.sums[y * width + x].map(f64::from)) > tolerance
        };
        let ends = |count: usize, differs: &dyn Fn(usize) -> bool| {
            let first = (0..count).find(|&at| differs(at))?;
            let last = (first..count).rfind(|&at| differs(at))?;
            Some([first, last])
        };
        Some(Self {
            rows: (0..height)
                .map(|y| ends(width, &|x| differs(x, y)))
                .collect(),
            columns: (0..width)
                .map(|x| ends(height, &|y| differs(x, y)))
                .collect(),
        })
    }

    /// Whether the bin (x, y) lies outside of the rim of the sensor: before the first or after the last rim bin of row
    /// y or of column x.
    pub(crate) fn excludes(&self, x: usize, y: usize) -> bool {
        let beyond = |ends: &Option<[usize; 2]>, at: usize| {
            ends.is_none_or(|[first, last]| at < first || at > last)
        };
        beyond(&self.rows[y], x) || beyond(&self.columns[x], y)
    }

    /// Points of the rim, in the coordinates of bins. There are no points where the border of the frame cuts off the
    /// sensor.
    pub(crate) fn points(&self) -> Vec<[f64; 2]> {
        let across = self.rows.iter().enumerate().filter_map(|(y, ends)| {
            let [left, right] = ends.as_ref()?;
            Some([
                [*left as f64 - 0.5, y as f64],
                [*right as f64 + 0.5, y as f64],
            ])
        });
        let down = self.columns.iter().enumerate().filter_map(|(x, ends)| {
            let [top, bottom] = ends.as_ref()?;
            Some([
                [x as f64, *top as f64 - 0.5],
                [x as f64, *bottom as f64 + 0.5],
            ])
        });
        let (right, bottom) = (
            self.columns.len() as f64 - 1.0,
            self.rows.len() as f64 - 1.0,
        );
        across
            .chain(down)
            .flatten()
            .filter(|[x, y]| *x > 0.0 && *y > 0.0 && *x < right && *y < bottom)
            .collect()
    }
}

/// The colour of the frame's corners, and a threshold. A bin counts as outside of the sensor if its colour differs from
/// the colour of the corners by at most the threshold. The threshold is 1.25 times the 98 % quantile of this difference
/// for the bins in the corners, but at least [`MIN_DIFFERENCE`]. Colour and threshold are sums over the pixels of a
/// bin. `None` unless at least three corners have the same colour.
fn corner_colour(binned: &BinnedFrame) -> Option<([f64; 3], f64)> {
    let (width, height) = (binned.width, binned.height);
    let side = (width.min(height) / 40).max(2);
    let places = [
        (0, 0),
        (width - side, 0),
        (0, height - side),
        (width - side, height - side),
    ];
    let corners = places.map(|(x, y)| -> Vec<[f64; 3]> {
        (y..y + side)
            .flat_map(|row| &binned.sums[row * width + x..][..side])
            .map(|colour| colour.map(f64::from))
            .collect()
    });
    let means = corners.each_ref().map(|corner| mean(corner));
    let grey = binned.pixels() as f64;
    let alike = |colour: &[f64; 3]| {
        means
            .each_ref()
            .map(|other| away(colour, other) < MAX_CORNER_DIFFERENCE * grey)
    };
    let count = |alike: &[bool; 4]| alike.iter().filter(|&&alike| alike).count();
    let (alike, colour) = means
        .iter()
        .map(|colour| (alike(colour), *colour))
        .max_by_key(|(alike, _)| count(alike))?;
    if count(&alike) < 3 {
        return None;
    }
    let mut strays: Vec<f64> = corners
        .iter()
        .zip(alike)
        .filter(|(_, alike)| *alike)
        .flat_map(|(corner, _)| corner)
        .map(|value| away(&colour, value))
        .collect();
    strays.sort_by(f64::total_cmp);
    let most = strays[strays.len() * 98 / 100];
    Some((colour, (1.25 * most).max(MIN_DIFFERENCE * grey)))
}

fn mean(values: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2]
        .map(|colour| values.iter().map(|value| value[colour]).sum::<f64>() / values.len() as f64)
}

fn away(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
