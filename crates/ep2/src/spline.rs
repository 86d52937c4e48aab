//! Tensor-product splines, which represent a height over a rectangle.

use std::ops::{AddAssign, Mul};

use crate::knots::{Knots, MAX_DEGREE};

/// Values of one quantity at several places, which are processed together (SIMD).
pub(crate) type Lanes = wide::f64x2;
pub(crate) const LANES: usize = 2;

/// Height w, slopes and second derivatives of a graph at one place (or, with `Lanes`, at several places).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jet<T = f64> {
    pub(crate) w: T,
    pub(crate) u: T,
    pub(crate) v: T,
    pub(crate) uu: T,
    pub(crate) uv: T,
    pub(crate) vv: T,
}

/// The B-splines of one variable that are not zero at one place (or at several places), with their first two
/// derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local<T = f64> {
    /// Index of the first B-spline that is not zero at this place.
    pub(crate) first: usize,
    pub(crate) jets: [[T; MAX_DEGREE + 1]; 3],
}

impl Local<Lanes> {
    /// Packs the values of the B-splines at several places, which must be within the same knot interval.
    #[inline]
    pub(crate) fn side_by_side(places: [&Local; LANES]) -> Self {
        let jets = std::array::from_fn(|order| {
            std::array::from_fn(|function| {
                Lanes::from(places.map(|place| place.jets[order][function]))
            })
        });
        let first = places[0].first;
        Self { first, jets }
    }
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

impl Jet<Lanes> {
    pub(crate) fn side_by_side(jets: &[Jet; LANES]) -> Self {
        let all =
            |part: fn(&Jet) -> f64| Lanes::from(std::array::from_fn(|lane| part(&jets[lane])));
        Self {
            w: all(|jet| jet.w),
            u: all(|jet| jet.u),
            v: all(|jet| jet.v),
            uu: all(|jet| jet.uu),
            uv: all(|jet| jet.uv),
            vv: all(|jet| jet.vv),
        }
    }

    #[inline(always)]
    pub(crate) fn lanes(&self) -> [Jet; LANES] {
        let [w, u, v, uu, uv, vv] =
            [self.w, self.u, self.v, self.uu, self.uv, self.vv].map(Lanes::to_array);
        std::array::from_fn(|lane| Jet {
            w: w[lane],
            u: u[lane],
            v: v[lane],
            uu: uu[lane],
            uv: uv[lane],
            vv: vv[lane],
        })
    }
}

impl<T: Copy + Default + AddAssign + Mul<f64, Output = T>> Jet<T> {
    /// Height, slopes and second derivatives at a point. `u` contains the B-splines in u at this point.
    ///
    /// For each B-spline in u, `sums` contains three coefficients: for the height and for its first and second
    /// derivatives along v. Each is a sum over the B-splines in v.
    #[inline(always)]
    pub(crate) fn from_sums(u: &Local<T>, sums: &[[f64; 3]]) -> Self {
        let mut jet = Self::default();
        let [values, firsts, seconds] = &u.jets;
        for (place, &[w, dv, dvv]) in sums.iter().enumerate().take(MAX_DEGREE + 1) {
            let (value, first, second) = (values[place], firsts[place], seconds[place]);
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

/// The spline `w(u, v) = Σ c_ij B_i(u) B_j(v)`, where `B_i` and `B_j` are B-splines.
///
/// Outside of the rectangle of the knots, the spline continues with the polynomials at the edge of the rectangle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TensorSpline {
    pub(crate) u: Knots,
    pub(crate) v: Knots,
    /// Coefficients c_ij, grouped by the B-spline in u. Their number is `u.functions() · v.functions()`.
    pub(crate) coefficients: Vec<f64>,
}

impl TensorSpline {
    #[inline]
    pub(crate) fn jet(&self, u: f64, v: f64) -> Jet {
        self.jet_in(&Local::of(&self.u, u), &Local::of(&self.v, v))
    }

    #[inline]
    fn jet_in(&self, u: &Local, v: &Local) -> Jet {
        let width = self.v.functions();
        let mut sums = [[0.0; 3]; MAX_DEGREE + 1];
        let sums = &mut sums[..=self.u.degree()];
        for (place, sums) in sums.iter_mut().enumerate() {
            let start = (u.first + place) * width + v.first;
            let row = &self.coefficients[start..=start + self.v.degree()];
            *sums = v
                .jets
                .map(|basis| row.iter().zip(&basis).map(|(c, b)| c * b).sum());
        }
        Jet::from_sums(u, sums)
    }

    #[inline]
    pub(crate) fn value(&self, u: f64, v: f64) -> f64 {
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
