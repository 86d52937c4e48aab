//! The rectangle of a patch, stretched to a square, and the equations that its contacts give there.

use crate::quadric::SquareQuadric;
use crate::{Knots, Patch};

/// The square [−1, 1]² over the rectangle of a patch, in which fits are made: how much longer than
/// wide a patch is does not spoil their condition.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    centre: [f64; 2],
    half: [f64; 2],
}

/// The equations of a contact for the surface over the square: its height and, if it has a normal, its
/// slopes along a and b. Each equation has a weight, relative to the inverse variance of its kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) height: f64,
    pub(crate) height_weight: f64,
    pub(crate) slopes: [f64; 2],
    pub(crate) slope_weights: [f64; 2],
}

/// A pair of values, one for the heights and one for the slopes, whose errors differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Kinds<T> {
    pub(crate) heights: T,
    pub(crate) slopes: T,
}

impl Square {
    pub(crate) fn of(patch: &Patch) -> Self {
        Self {
            centre: patch.domain.map(|[low, high]| 0.5 * low + 0.5 * high),
            half: patch.domain.map(|[low, high]| 0.5 * high - 0.5 * low),
        }
    }

    /// Half the sides of the rectangle, in the patch's unit.
    pub(crate) const fn half(&self) -> [f64; 2] {
        self.half
    }

    /// Knots over the square as knots over the rectangle.
    pub(crate) fn knots(&self, axis: usize, square: &Knots) -> Knots {
        let place = |knot: f64| self.centre[axis] + self.half[axis] * knot;
        let (start, end) = square.domain();
        let interior: Vec<f64> = square.interior().iter().map(|&knot| place(knot)).collect();
        Knots::new(square.degree(), place(start), place(end), &interior)
    }

    /// The observations of a patch that is nearly `quadric`, of its deviation from it.
    ///
    /// Errors of a contact's place across the normal look like errors of its height, larger by
    /// √D, D = 1 + p² + q²; a tilt of the normal by a small angle turns the slope p along u by
    /// √(D(1 + p²)) times as much.
    pub(crate) fn observations<'a>(
        &'a self,
        patch: &'a Patch,
        quadric: &'a SquareQuadric,
    ) -> impl Iterator<Item = Observation> + 'a {
        let [half_u, half_v] = self.half;
        patch.samples.iter().map(move |sample| {
            let a = (sample.u - self.centre[0]) / half_u;
            let b = (sample.v - self.centre[1]) / half_v;
            let [height, slope_a, slope_b] = quadric.value_and_slopes(a, b);
            let (p, q) = (slope_a / half_u, slope_b / half_v);
            let steepness = 1.0 + p * p + q * q;
            let height_weight = sample.weight / steepness;
            let (slopes, slope_weights) = match sample.slopes {
                Some([along_u, along_v]) => (
                    [along_u * half_u - slope_a, along_v * half_v - slope_b],
                    [
                        height_weight / (half_u * half_u * (1.0 + p * p)),
                        height_weight / (half_v * half_v * (1.0 + q * q)),
                    ],
                ),
                None => ([0.0; 2], [0.0; 2]),
            };
            Observation {
                a,
                b,
                height: sample.w - height,
                height_weight,
                slopes,
                slope_weights,
            }
        })
    }
}
