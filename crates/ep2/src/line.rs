//! The fitted surface along a line: its jets, and how far they are off, at many places.

use std::ops::Range;

use crate::posterior::PosteriorLine;
use crate::spline::{Lanes, Local};
use crate::{Fit, Jet};

/// The surface along a line of constant v: what is the same for all its places.
pub(crate) struct Line {
    /// The first B-spline in u that the line knows.
    first: usize,
    /// Per B-spline in u, the sums over those in v of coefficient times value, first and second
    /// derivative.
    heights: Vec<[f64; 3]>,
    pub(crate) posterior: Option<PosteriorLine>,
}

impl Line {
    /// The surface along the line of constant `v`, for some of the B-splines in u.
    pub(crate) fn of(fit: &Fit, v: f64, functions: Range<usize>) -> Self {
        let spline = &fit.spline;
        let local = Local::of(&spline.v, v);
        let width = spline.v.functions();
        let support = spline.v.degree() + 1;
        let first = functions.start;
        let heights = functions
            .map(|function| {
                let start = function * width + local.first;
                let row = &spline.coefficients[start..start + support];
                local.jets.map(|basis| dot(row, &basis))
            })
            .collect();
        Self {
            first,
            heights,
            posterior: fit.posterior.as_ref().map(|posterior| posterior.line(v)),
        }
    }

    /// Height and derivatives at places on the line.
    #[inline(always)]
    pub(crate) fn jet(&self, u: &Local<Lanes>, fit: &Fit) -> Jet<Lanes> {
        let start = u.first - self.first;
        Jet::of_sums(u, &self.heights[start..=start + fit.spline.u.degree()])
    }
}

#[inline(always)]
fn dot(row: &[f64], basis: &[f64]) -> f64 {
    row.iter().zip(basis).map(|(one, other)| one * other).sum()
}
