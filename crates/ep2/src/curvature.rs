//! The curvature of a graph, and the standard errors of the curvature.

use nalgebra::SMatrix;
use palpate_geometry::CurvatureForm;

use crate::Ep2Error;
use crate::spline::{Jet, Lanes};

/// Number of derivatives that determine the curvature of a graph: the slopes p, q along u, v, and the second
/// derivatives r, s, t along u², uv, v² (Monge's letters).
pub(crate) const DERIVATIVES: usize = 5;

/// Covariance of the slopes (p, q) and the second derivatives (r, s, t) at several places that are processed together.
pub(crate) type JetCovariance = [[Lanes; DERIVATIVES]; DERIVATIVES];

/// Gaussian and mean curvature at a place. The mean curvature is positive where the surface is convex.
///
/// ```
/// use palpate_ep2::{Curvature, SignClass};
/// use palpate_geometry::{ShapeClass, ShapeThresholds};
///
/// // A place on a ball of radius 5.
/// let ball = Curvature { gaussian: 0.04, mean: 0.2, uncertainty: None };
/// assert_eq!(ShapeThresholds::new(0.01, 0.1)?.classify(ball.gaussian, ball.mean), ShapeClass::Peak);
/// assert_eq!(ball.sign_class(), SignClass::Convex);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// Gaussian curvature at the place, 1/length².
    pub gaussian: f64,
    /// Mean curvature at the place, 1/length.
    pub mean: f64,
    /// Standard errors of Gaussian and mean curvature, if the method computes them.
    pub uncertainty: Option<Uncertainty>,
}

/// Gaussian and mean curvature at several ([`LANES`](crate::spline::LANES)) places. The mean curvature is positive
/// where the surface is convex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvatures {
    gaussian: Lanes,
    mean: Lanes,
    /// Standard errors of the Gaussian and the mean curvature, and their correlation; `None` if the method does not
    /// compute them.
    uncertainty: Option<[Lanes; 3]>,
}

impl Curvatures {
    /// Curvatures of a graph at several places. `jet` contains the slopes and second derivatives of the graph's height.
    /// `scale` is the graph's unit of length, expressed in the unit of length of the result.
    ///
    /// With the slopes p, q, the second derivatives r, s, t, D = 1 + p² + q² and the normal upwards: K = (rt − s²)/D²,
    /// H = −((1 + q²) r − 2pqs + (1 + p²) t)/(2 D^{3/2}).
    ///
    /// # Errors
    /// [`Ep2Error::OutOfRange`] if a curvature is beyond the range of doubles.
    #[inline(always)]
    pub(crate) fn of_graph(
        jet: &Jet<Lanes>,
        covariance: Option<&JetCovariance>,
        scale: f64,
    ) -> Result<Self, Ep2Error> {
        let [p, q, r, s, t] = derivatives(jet);
        let (per_d, per_scale) = (per_d(p, q), 1.0 / scale);
        let trace = (q * q + 1.0) * r - p * q * s * 2.0 + (p * p + 1.0) * t;
        let gaussian = (r * t - s * s) * per_d * per_d;
        let mean = per_d * per_d.sqrt() * trace * -0.5;
        let uncertainty =
            covariance.map(|covariance| uncertainty(jet, [gaussian, mean], covariance, per_scale));
        let (gaussian, mean) = (gaussian * per_scale * per_scale, mean * per_scale);
        let stds = uncertainty.map_or(Lanes::ZERO, |[one, other, _]| one + other);
        let size = (gaussian + mean + stds).abs();
        if size.simd_lt(Lanes::splat(f64::INFINITY)).all() {
            Ok(Self {
                gaussian,
                mean,
                uncertainty,
            })
        } else {
            Err(Ep2Error::OutOfRange)
        }
    }

    #[inline(always)]
    pub(crate) fn at(&self, lane: usize) -> Curvature {
        let at = |lanes: Lanes| lanes.to_array()[lane];
        Curvature {
            gaussian: at(self.gaussian),
            mean: at(self.mean),
            uncertainty: self
                .uncertainty
                .map(|[gaussian, mean, correlation]| Uncertainty {
                    gaussian_std: at(gaussian),
                    mean_std: at(mean),
                    correlation: at(correlation),
                }),
        }
    }
}

/// The standard errors of Gaussian and mean curvature at a place, and their correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Standard error of the Gaussian curvature, 1/length². It also contains terms of second order in the errors of the
    /// second derivatives. Without these terms, it would be 0 on a plane.
    pub gaussian_std: f64,
    /// Standard error of the mean curvature, 1/length.
    pub mean_std: f64,
    /// Correlation of the errors of Gaussian and mean curvature, in [−1, 1].
    pub correlation: f64,
}

/// Standard errors of Gaussian and mean curvature, and the correlation of their errors, at several places. `covariance`
/// is the covariance of the slopes and second derivatives in `jet`. The covariance and the curvatures are in the unit
/// of `jet`.
#[inline(always)]
fn uncertainty(
    jet: &Jet<Lanes>,
    [gaussian, mean]: [Lanes; 2],
    covariance: &JetCovariance,
    per_scale: f64,
) -> [Lanes; 3] {
    let [p, q, r, s, t] = derivatives(jet);
    let per_d = per_d(p, q);
    let per_square = per_d * per_d;
    let steep = gaussian * per_d * -4.0;
    let gaussian_gradient = [
        steep * p,
        steep * q,
        t * per_square,
        s * per_square * -2.0,
        r * per_square,
    ];
    let to_mean = per_d * per_d.sqrt() * -0.5;
    let flatter = mean * per_d * 3.0;
    let mean_gradient = [
        to_mean * (p * t - q * s) * 2.0 - flatter * p,
        to_mean * (q * r - p * s) * 2.0 - flatter * q,
        to_mean * (q * q + 1.0),
        to_mean * p * q * -2.0,
        to_mean * (p * p + 1.0),
    ];
    let along = |gradient: &[Lanes; DERIVATIVES]| covariance.map(|row| dot(&row, gradient));
    let along_gaussian = along(&gaussian_gradient);
    let first_order = dot(&gaussian_gradient, &along_gaussian);
    let mixed = dot(&mean_gradient, &along_gaussian);
    let mean_variance = dot(&mean_gradient, &along(&mean_gradient)).max(Lanes::ZERO);
    let c = covariance;
    let second_order =
        c[2][2] * c[4][4] + c[2][4] * c[2][4] + c[3][3] * c[3][3] * 2.0 - c[2][3] * c[3][4] * 4.0;
    let gaussian_variance = (first_order + second_order * per_square * per_square).max(Lanes::ZERO);
    let (gaussian_std, mean_std) = (gaussian_variance.sqrt(), mean_variance.sqrt());
    let both = gaussian_std * mean_std;
    let correlation = (mixed / both).max(-Lanes::ONE).min(Lanes::ONE);
    [
        gaussian_std * (per_scale * per_scale),
        mean_std * per_scale,
        both.simd_gt(Lanes::ZERO).select(correlation, Lanes::ZERO),
    ]
}

#[inline(always)]
const fn derivatives<T: Copy>(jet: &Jet<T>) -> [T; DERIVATIVES] {
    [jet.u, jet.v, jet.uu, jet.uv, jet.vv]
}

#[inline(always)]
fn per_d(p: Lanes, q: Lanes) -> Lanes {
    Lanes::ONE / (p * p + q * q + 1.0)
}

#[inline(always)]
fn dot(one: &[Lanes; DERIVATIVES], other: &[Lanes; DERIVATIVES]) -> Lanes {
    one.iter()
        .zip(other)
        .fold(Lanes::ZERO, |sum, (one, other)| sum + *one * *other)
}

impl Curvature {
    pub(crate) fn is_finite(&self) -> bool {
        let stds = self
            .uncertainty
            .map_or(0.0, |one| one.gaussian_std + one.mean_std);
        (self.gaussian + self.mean + stds).is_finite()
    }
}

/// The curvature form of a graph, and the orthonormal tangent basis in which it is expressed. The basis is the tangent
/// along u and the tangent perpendicular to it. The form is in the graph's unit.
pub(crate) fn form_and_basis(jet: &Jet) -> (CurvatureForm, [nalgebra::Vector3<f64>; 2]) {
    let Jet {
        u: p,
        v: q,
        uu: r,
        uv: s,
        vv: t,
        ..
    } = *jet;
    let d = 1.0 + p * p + q * q;
    let e = 1.0 + p * p;
    // Orthonormal tangents by Gram–Schmidt: along = ∂u/√E and across = (∂v − (F/E) ∂u) √E/√D. Here E = 1 + p², F = pq
    // and D = 1 + p² + q², so q − (F/E) p = q/E.
    let share = p * q / e;
    let along = nalgebra::Vector3::new(1.0, 0.0, p) / e.sqrt();
    let across = nalgebra::Vector3::new(-share, 1.0, q / e) * (e / d).sqrt();
    let bend = -1.0 / d.sqrt();
    let form = CurvatureForm {
        k_uu: bend * r / e,
        k_uv: bend * (s - share * r) / d.sqrt(),
        k_vv: bend * (t - 2.0 * share * s + share * share * r) * e / d,
    };
    (form, [along, across])
}

/// Standard errors of k_min and k_max (in the graph's unit), and of the angle of their directions (rad). They are
/// computed from the covariance of the graph's slopes and second derivatives, and have the properties of
/// [`CurvatureForm::principal_stds`].
pub(crate) fn principal_stds(
    jet: &Jet,
    covariance: &SMatrix<f64, DERIVATIVES, DERIVATIVES>,
) -> [f64; 3] {
    const STEP: f64 = 1e-5;
    let form = |derivative: usize, step: f64| {
        let mut jet = *jet;
        let Jet {
            u, v, uu, uv, vv, ..
        } = &mut jet;
        *[u, v, uu, uv, vv][derivative] += step;
        let form = form_and_basis(&jet).0;
        [form.k_uu, form.k_vv, form.k_uv]
    };
    let gradients = SMatrix::<f64, 3, DERIVATIVES>::from_fn(|entry, derivative| {
        let [low, high] = [-STEP, STEP].map(|step| form(derivative, step)[entry]);
        (high - low) / (2.0 * STEP)
    });
    let covariance = gradients * covariance * gradients.transpose();
    form_and_basis(jet).0.principal_stds(&covariance.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Height of a graph, its slopes u and v, and its second derivatives uu, uv and vv.
    const JET: [f64; 6] = [0.3, 0.4, -0.7, 0.9, 0.2, -0.5];

    fn curvature(jet: [f64; 6], covariance: Option<&JetCovariance>, scale: f64) -> Curvature {
        let [w, u, v, uu, uv, vv] = jet.map(Lanes::splat);
        let jet = Jet {
            w,
            u,
            v,
            uu,
            uv,
            vv,
        };
        let curvatures = Curvatures::of_graph(&jet, covariance, scale).unwrap();
        assert_eq!(curvatures.at(0), curvatures.at(1));
        curvatures.at(0)
    }

    #[test]
    fn a_small_covariance_is_carried_by_the_true_gradients() {
        let step = 1e-6;
        for index in 0..DERIVATIVES {
            let moved = |step: f64| {
                let mut jet = JET;
                jet[1 + index] += step;
                curvature(jet, None, 1.0)
            };
            let (high, low) = (moved(step), moved(-step));
            let mut covariance = JetCovariance::default();
            covariance[index][index] = Lanes::splat(1e-12);
            let told = curvature(JET, Some(&covariance), 1.0).uncertainty.unwrap();
            let gaussian = 0.5 * (high.gaussian - low.gaussian);
            let mean = 0.5 * (high.mean - low.mean);
            assert_relative_eq!(told.gaussian_std, gaussian.abs(), max_relative = 1e-5);
            assert_relative_eq!(told.mean_std, mean.abs(), max_relative = 1e-5);
            assert_relative_eq!(told.correlation, (gaussian * mean).signum(), epsilon = 1e-5);
        }
    }

    #[test]
    fn a_plane_has_an_uncertain_gaussian_curvature() {
        let mut covariance = JetCovariance::default();
        (0..DERIVATIVES).for_each(|index| covariance[index][index] = Lanes::splat(0.01));
        let plane = curvature([0.0; 6], Some(&covariance), 2.0);
        // On a plane, K has the variance Var(rt − s²) = σ⁴ + 2σ⁴. Here r, s and t are the second derivatives, with
        // independent errors of variance σ².
        let told = plane.uncertainty.unwrap();
        let expected = 3.0_f64.sqrt() * 0.01 / 4.0;
        assert_relative_eq!(told.gaussian_std, expected, epsilon = 1e-15);
        // The mean curvature of a plane is −(r + t)/2, so its variance is Var(r + t)/4. Here r and t are second
        // derivatives.
        assert_relative_eq!(told.mean_std, 0.5_f64.sqrt() * 0.1 / 2.0, epsilon = 1e-15);
    }
}
