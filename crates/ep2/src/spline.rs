//! Tensor-product splines: a height over a rectangle.

use crate::knots::{Basis, Knots};

/// Height, slopes and second derivatives of a graph at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// Height.
    pub w: f64,
    /// ∂w/∂u.
    pub u: f64,
    /// ∂w/∂v.
    pub v: f64,
    /// ∂²w/∂u².
    pub uu: f64,
    /// ∂²w/∂u∂v.
    pub uv: f64,
    /// ∂²w/∂v².
    pub vv: f64,
}

/// The B-splines of one variable that do not vanish at a place, with two derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local {
    /// Index of the first of them.
    pub(crate) first: usize,
    /// Values, first and second derivatives.
    pub(crate) jets: [Basis; 3],
}

impl Local {
    #[inline]
    pub(crate) fn of(knots: &Knots, x: f64) -> Self {
        let first = knots.first_function(x);
        Self {
            first,
            jets: knots.derivatives(first, x),
        }
    }
}

impl Jet {
    /// From the B-splines in u at a place, and for each the sums over those in v of coefficient
    /// times value, first and second derivative.
    #[inline]
    pub(crate) fn of_sums(u: &Local, sums: impl Fn(usize) -> [f64; 3], degree: usize) -> Self {
        let mut jet = Self::default();
        for place in 0..=degree {
            let [w, dv, dvv] = sums(place);
            let [value, first, second] = u.jets.map(|basis| basis[place]);
            jet.w += value * w;
            jet.u += first * w;
            jet.v += value * dv;
            jet.uu += second * w;
            jet.uv += first * dv;
            jet.vv += value * dvv;
        }
        jet
    }
}

/// `w(u, v) = Σ c_ij B_i(u) B_j(v)`.
///
/// Outside of the rectangle the polynomials of its edge go on.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorSpline {
    /// Knots along u.
    pub u: Knots,
    /// Knots along v.
    pub v: Knots,
    /// Coefficients, those of one B-spline in u after the other: `u.functions() · v.functions()`.
    pub coefficients: Vec<f64>,
}

impl TensorSpline {
    /// Height, slopes and second derivatives at `(u, v)`.
    #[inline]
    pub fn jet(&self, u: f64, v: f64) -> Jet {
        self.jet_in(&Local::of(&self.u, u), &Local::of(&self.v, v))
    }

    #[inline]
    fn jet_in(&self, u: &Local, v: &Local) -> Jet {
        let width = self.v.functions();
        Jet::of_sums(
            u,
            |place| {
                let start = (u.first + place) * width + v.first;
                let row = &self.coefficients[start..=start + self.v.degree()];
                v.jets
                    .map(|basis| row.iter().zip(&basis).map(|(c, b)| c * b).sum())
            },
            self.u.degree(),
        )
    }

    /// Height at `(u, v)`.
    #[inline]
    pub fn value(&self, u: f64, v: f64) -> f64 {
        let (first_u, first_v) = (self.u.first_function(u), self.v.first_function(v));
        let (basis_u, basis_v) = (self.u.values(first_u, u), self.v.values(first_v, v));
        let width = self.v.functions();
        let mut sum = 0.0;
        for (place, weight) in basis_u[..=self.u.degree()].iter().enumerate() {
            let start = (first_u + place) * width + first_v;
            let row = &self.coefficients[start..=start + self.v.degree()];
            let inner: f64 = row.iter().zip(&basis_v).map(|(c, b)| c * b).sum();
            sum += weight * inner;
        }
        sum
    }
}
