//! The points of a fit, with the values of the B-splines at these points.

use super::mesh::Mesh;
use super::triangle::{Block, Triangle};
use crate::knots::{Basis, Knots};

/// A point (u, v) with a measured height w and a weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WeightedPoint {
    pub(crate) u: f64,
    pub(crate) v: f64,
    pub(crate) w: f64,
    /// Weight that multiplies the residual: an inverse standard deviation. If the weight of one point is smaller than
    /// that of another by a factor of 10^n, the spline fits the first point with n fewer correct digits. From n = 15
    /// on, the first point has no influence.
    pub(crate) weight: f64,
}

/// Points with the values of the B-splines at these points.
pub(super) struct Observations<'a> {
    points: &'a [WeightedPoint],
    /// Two units of the computation, powers of two: the heights are divided by the first, the weights by the second.
    units: [f64; 2],
    /// For each point, the B-splines in u and in v that are not zero there.
    bases: Vec<[LocalBasis; 2]>,
    /// Indices of the points, sorted by panel. A panel is a rectangle between knots.
    order: Vec<usize>,
}

/// The B-splines of one variable that are not zero at a point.
#[derive(Clone, Copy, Default)]
struct LocalBasis {
    first: usize,
    values: Basis,
}

impl LocalBasis {
    #[inline]
    fn of(knots: &Knots, x: f64) -> Self {
        let first = knots.first_function(x);
        let values = knots.values(first, x);
        Self { first, values }
    }
}

/// Sums over all points whose coordinate along an axis is in the same knot interval.
#[derive(Clone, Copy, Default)]
pub(super) struct IntervalSums {
    pub(super) squares: f64,
    /// Sum, over the points in the interval, of the squared residual times the point's coordinate along the axis.
    pub(super) moments: f64,
}

impl<'a> Observations<'a> {
    pub(super) fn new(points: &'a [WeightedPoint], mesh: &Mesh) -> Self {
        let largest = |number: fn(&WeightedPoint) -> f64| {
            let largest = points.iter().map(number).fold(0.0, f64::max);
            power_of_two_below(largest)
        };
        let [u, v] = &mesh.knots;
        let bases = points
            .iter()
            .map(|point| [LocalBasis::of(u, point.u), LocalBasis::of(v, point.v)])
            .collect();
        Self {
            points,
            units: [
                largest(|point| point.w.abs()),
                largest(|point| point.weight),
            ],
            bases,
            order: (0..points.len()).collect(),
        }
    }

    /// The unit of weighted residuals: the unit of heights times the unit of weights.
    pub(super) fn residual_unit(&self) -> f64 {
        self.units[0] * self.units[1]
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn height_sum(&self) -> f64 {
        (0..self.len())
            .map(|index| {
                let (height, weight) = self.height_and_weight(index);
                (height * weight).powi(2)
            })
            .sum()
    }

    pub(super) fn refresh(&mut self, mesh: &Mesh, axis: usize) {
        let knots = &mesh.knots[axis];
        for (bases, point) in self.bases.iter_mut().zip(self.points) {
            let place = if axis == 0 { point.u } else { point.v };
            bases[axis] = LocalBasis::of(knots, place);
        }
        let bases = &self.bases;
        self.order.sort_by_key(|&index| panel(mesh, &bases[index]));
    }

    #[inline]
    fn height_and_weight(&self, index: usize) -> (f64, f64) {
        let point = &self.points[index];
        (point.w / self.units[0], point.weight / self.units[1])
    }

    pub(super) fn triangle(&self, mesh: &Mesh) -> Triangle {
        let band = mesh.band();
        let mut triangle = Triangle::new(mesh.coefficients(), band);
        let mut block = Block::new(band, self.len());
        let (slow, fast) = (mesh.slow(), mesh.fast());
        let (slow_degree, fast_degree) = (mesh.knots[slow].degree(), mesh.knots[fast].degree());
        let mut start = 0;
        for &index in &self.order {
            let bases = &self.bases[index];
            let panel = panel(mesh, bases);
            if panel != start || block.is_full() {
                triangle.absorb(start, &mut block);
                start = panel;
            }
            let (height, weight) = self.height_and_weight(index);
            let row = block.push(height * weight);
            for (along, value) in bases[slow].values[..=slow_degree].iter().enumerate() {
                let value = value * weight;
                let column = mesh.index(along, 0);
                for (across, other) in bases[fast].values[..=fast_degree].iter().enumerate() {
                    block.set(row, column + across, value * other);
                }
            }
        }
        triangle.absorb(start, &mut block);
        triangle
    }

    fn residuals<'b>(
        &'b self,
        mesh: &'b Mesh,
        coefficients: &'b [f64],
    ) -> impl Iterator<Item = f64> + 'b {
        let (slow, fast) = (mesh.slow(), mesh.fast());
        let (slow_degree, fast_degree) = (mesh.knots[slow].degree(), mesh.knots[fast].degree());
        self.bases.iter().enumerate().map(move |(index, bases)| {
            let start = panel(mesh, bases);
            let mut value = 0.0;
            for (along, share) in bases[slow].values[..=slow_degree].iter().enumerate() {
                let row = &coefficients[start + mesh.index(along, 0)..][..=fast_degree];
                let across: f64 = row
                    .iter()
                    .zip(&bases[fast].values)
                    .map(|(c, b)| c * b)
                    .sum();
                value += share * across;
            }
            let (height, weight) = self.height_and_weight(index);
            weight * (height - value)
        })
    }

    pub(super) fn residual_sum(&self, mesh: &Mesh, coefficients: &[f64]) -> f64 {
        self.residuals(mesh, coefficients)
            .map(|residual| residual * residual)
            .sum()
    }

    /// Sums of squared residuals, for each knot interval along u and for each knot interval along v.
    pub(super) fn interval_sums(
        &self,
        mesh: &Mesh,
        coefficients: &[f64],
    ) -> [Vec<IntervalSums>; 2] {
        let mut sums = [0, 1].map(|axis| {
            let intervals = mesh.knots[axis].interior().len() + 1;
            vec![IntervalSums::default(); intervals]
        });
        let residuals = self.residuals(mesh, coefficients);
        for ((residual, bases), point) in residuals.zip(&self.bases).zip(self.points) {
            let square = residual * residual;
            for (axis, place) in [point.u, point.v].into_iter().enumerate() {
                let interval = &mut sums[axis][bases[axis].first];
                interval.squares += square;
                interval.moments += square * place;
            }
        }
        sums
    }

    pub(super) fn in_heights(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        for coefficient in &mut coefficients {
            *coefficient *= self.units[0];
        }
        coefficients
    }
}

/// Index of the first coefficient on which the height of the spline at a point depends. It is the same for all points
/// of a panel (rectangle between knots).
#[inline]
fn panel(mesh: &Mesh, bases: &[LocalBasis; 2]) -> usize {
    mesh.index(bases[mesh.slow()].first, bases[mesh.fast()].first)
}

/// The largest power of two that is at most `number`; 1 if `number` is 0. Division by a power of two is exact.
fn power_of_two_below(number: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if number < f64::MIN_POSITIVE {
        1.0
    } else {
        f64::from_bits(number.to_bits() & EXPONENT)
    }
}
