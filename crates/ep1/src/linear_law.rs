//! The formula that computes an estimate and its standard errors from the sums over the probes. It has no branches, so
//! that several estimates can be computed together with vector instructions.

use crate::batch::BATCH_SIZE;
use crate::symmetric::{Symmetric, Symmetric3};
use crate::{BatchEstimates, BatchMoments, Moments};

/// A contact counts as moving only if it moves at least this share of the distance that it would move on a plane. A
/// shorter movement may be only a rounding error.
pub(crate) const MIN_TRAVEL: f64 = 1e-12;

/// Standard deviation of the rounding errors in the entries of `K₁ B`, which come from the last digits of the readings
/// and sums. K₁ is the probe's curvature and B the mobility of the contact (its travel per radian).
pub(crate) const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// The constants of the fit. Estimates are computed from these constants and from sums over the probes. The type is
/// `Copy`, so that a loop over a batch can use its own copy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    pub(crate) radius: f64,
    pub(crate) probe_curvature: f64,
    pub(crate) per_probe: f64,
    /// Inverse of the matrix of the normal equations. The unknowns are the entries `uu`, `vv`, `uv` of `K₁ D`: the
    /// probe's curvature K₁ times the deviation D of the mobility (contact travel per radian) from the mobility on a
    /// plane.
    pub(crate) inverse: Symmetric3,
    /// Correction that is added to the sums of `g₁ d₁` and `g₂ d₂` (length). On average, the errors of the measured
    /// rotations decrease both sums by this value. Here `g` is the rotation vector of a probe, turned by 90°.
    /// `d = Δp − R₁ g` is the deviation of the probe's shift from the shift on a plane.
    pub(crate) added: f64,
    /// Contributions of the shift noise and of rounding to the covariance of the entries of `K₁ D`. K₁ is the probe's
    /// curvature, and D the deviation of the mobility (contact travel per radian) from the mobility on a plane.
    pub(crate) from_shifts: Symmetric3,
    /// Contributions of the rotation noise to the covariance of the entries of `K₁ B`, where K₁ is the probe's
    /// curvature and B the mobility (contact travel per radian). There is one matrix for each of the entries `uu`, `vv`
    /// and `uv` of `(K₁ B)²`. The contribution is the sum of the three matrices, each multiplied by the entry to which
    /// it belongs.
    pub(crate) from_rotations: [Symmetric3; 3],
}

/// Standard error of a normal curvature that is due to the rounding of the readings alone (1/length). `curvature` is
/// the normal curvature (1/length), and `radius` is the radius of the probes.
///
/// ```
/// // Rounding errors exceed the curvature of an object 10¹⁷ times as flat as the probe.
/// let curvature = 1e-17 / 10.0;
/// assert!(palpate_ep1::rounding_std(10.0, curvature) > 10.0 * curvature);
/// ```
pub fn rounding_std(radius: f64, curvature: f64) -> f64 {
    let relative = 1.0 + (radius * curvature).abs();
    ROUNDING * relative * relative / radius
}

impl Law {
    #[inline(always)]
    pub(crate) fn solve_batch<const IS_STATED: bool, const IS_MEASURED: bool>(
        self,
        moments: &BatchMoments,
        count: usize,
        estimates: &mut BatchEstimates,
    ) {
        for place in 0..count.min(BATCH_SIZE) {
            let moments = moments.at(place);
            let solution = self.solve::<IS_STATED, IS_MEASURED>(&moments);
            estimates.put::<IS_STATED>(
                place,
                solution.moved & solution.in_range,
                solution.curvatures,
                solution.stds,
                self.arc_length(&moments),
            );
        }
    }

    #[inline(always)]
    pub(crate) fn arc_length(self, moments: &Moments) -> f64 {
        moments.lengths * self.per_probe
    }

    /// Fits one set of readings without branches, so that many sets can be fitted together. If `IS_STATED`, the noise
    /// is stated, and standard errors are computed. If `IS_MEASURED`, the relative errors of the rotations are errors
    /// of the measured values; otherwise they are deviations of the motion from the command, which cause no bias.
    #[inline(always)]
    pub(crate) fn solve<const IS_STATED: bool, const IS_MEASURED: bool>(
        self,
        moments: &Moments,
    ) -> Solution {
        // K₁ is the probe's curvature, and K_rel = K₁ + K₂ is the relative curvature. The matrix D maps the rotation
        // vector of a roll, turned by 90°, to the deviation of its shift from the shift on a plane. `deviation` is the
        // matrix K₁ D. `travel` is the matrix I + K₁ D, which is the inverse of K_rel / K₁.
        let [along_u, along_v, mixed] = moments.deviations;
        let deviation = match IS_STATED {
            true => self
                .inverse
                .times(&[along_u + self.added, along_v + self.added, mixed]),
            false => self.inverse.times(&moments.deviations),
        };
        let travel = Symmetric {
            uu: deviation.uu + 1.0,
            vv: deviation.vv + 1.0,
            uv: deviation.uv,
        };
        let determinant = travel.determinant();
        let trace = travel.uu + travel.vv;
        let moved = (0.0 < travel.uu) & (0.0 < travel.vv) & (trace * MIN_TRAVEL < determinant);
        let scale = self.probe_curvature / determinant;
        // The object's curvature is −K₁ (I + K₁ D)⁻¹ K₁ D. This matrix is symmetric, because K₁ is a multiple of the
        // identity I and both other factors are functions of the symmetric matrix D.
        let mixed = deviation.uv * deviation.uv;
        let mut curvature = Symmetric {
            uu: scale * (mixed - travel.vv * deviation.uu),
            uv: -scale * deviation.uv,
            vv: scale * (mixed - travel.uu * deviation.vv),
        };
        if IS_MEASURED {
            curvature.add(&self.bias(&travel), scale / (determinant * determinant));
        }
        let gaussian = curvature.determinant();
        let mean = curvature.uu * 0.5 + curvature.vv * 0.5;
        let arc_length = self.arc_length(moments);
        // From here on, standard deviations are in units of K₁ / det², where K₁ is the probe's curvature and det the
        // determinant of `travel`.
        let unit = scale / determinant;
        let mut all = gaussian + mean + arc_length + trace * self.radius + unit;
        let mut stds = [0.0; 4];
        if IS_STATED {
            let [u, v, of_gaussian, of_mean] = self.stds(&curvature, &travel, unit);
            stds = [unit * u, unit * v, unit * of_gaussian, unit * of_mean];
            all += stds[0] + stds[1] + stds[2] + stds[3];
        }
        Solution {
            travel,
            curvature,
            curvatures: [curvature.uu, curvature.vv, gaussian, mean],
            stds,
            moved,
            in_range: all.abs() < f64::INFINITY,
        }
    }

    /// Covariance of the entries of `K₁ B`, where K₁ is the probe's curvature and B the mobility (contact travel per
    /// radian). `travel` is the estimate of `K₁ B`.
    #[inline(always)]
    pub(crate) fn of_mobility(self, travel: &Symmetric) -> Symmetric3 {
        self.from_shifts
            .plus(&self.from_rotations, &travel.square())
    }

    /// Bias of the estimated curvature, with the opposite sign: the errors of the measured rotations decrease the
    /// curvature by this matrix, to second order. The result is in units of `K₁ / det³`, where `det` is the determinant
    /// of `travel` = `K₁ B`, K₁ the probe's curvature and B the mobility (contact travel per radian).
    ///
    /// An error δB of the mobility changes `K_rel = B⁻¹` by `K_rel δB K_rel δB K_rel` to second order. Errors of the
    /// rotations are also errors of the matrix of the normal equations, which are correlated with δB. In a star of
    /// rolls, they change the mean of B by twice the mean of `δB K_rel δB`. The result is the difference of both.
    #[inline(always)]
    fn bias(self, travel: &Symmetric) -> Symmetric {
        let w = relative(travel);
        let covariance = Symmetric3::default().plus(&self.from_rotations, &travel.square());
        let [of_uu, of_vv, of_uv] = covariance.rows();
        let inner = Symmetric {
            uu: w.uu * of_uu[0] + 2.0 * w.uv * of_uu[2] + w.vv * of_uv[2],
            vv: w.uu * of_uv[2] + 2.0 * w.uv * of_vv[2] + w.vv * of_vv[1],
            uv: w.uu * of_uu[2] + w.uv * (of_uu[1] + of_uv[2]) + w.vv * of_vv[2],
        };
        let product = w.matrix() * inner.matrix() * w.matrix();
        Symmetric {
            uu: product[(0, 0)],
            vv: product[(1, 1)],
            uv: product[(0, 1)],
        }
    }

    /// Standard errors of K_uu, K_vv, the Gaussian and the mean curvature. The results are in units of `unit` = `K₁ /
    /// det²`, where `det` is the determinant of `travel` = `K₁ B`.
    ///
    /// The residual of a probe is `e − B δg` for the shift error `e` and the rotation error `δg`. Therefore the
    /// covariance of the mobility B is linear in `B²`. The object's curvature K₂ changes by `δK₂ = −K_rel δB K_rel`,
    /// where `K_rel = K₁ + K₂`. A quantity with the gradient `G` with respect to K₂ changes by `−tr(S δB)` with `S =
    /// K_rel G K_rel`. The variance of the Gaussian curvature also contains the second-order term, because the
    /// first-order terms are zero on a flat object.
    #[inline(always)]
    fn stds(self, curvature: &Symmetric, travel: &Symmetric, unit: f64) -> [f64; 4] {
        let covariance = self.of_mobility(travel);
        let [along_u, along_v, mixed] = gradients(travel);
        // Use a function and not a closure here. A closure that is not inlined would be compiled without the vector
        // instructions of the caller.
        let (from_u, from_v, from_t) = (
            covariance.times(&along_u),
            covariance.times(&along_v),
            covariance.times(&mixed),
        );
        let (u, v, t) = (
            from_u.dot(&along_u),
            from_v.dot(&along_v),
            from_t.dot(&mixed),
        );
        let (uv, ut, vt) = (from_u.dot(&along_v), from_u.dot(&mixed), from_v.dot(&mixed));
        let mean = (u + v + uv + uv) * 0.25;
        let Symmetric {
            uu: k_uu,
            uv: k_uv,
            vv: k_vv,
        } = *curvature;
        let twice_uv = k_uv + k_uv;
        let aside = twice_uv * t - (k_vv * ut + k_uu * vt) * 2.0;
        let first_order = k_vv * (k_vv * u + k_uu * (uv + uv)) + k_uu * k_uu * v + twice_uv * aside;
        let second_order = u * v + uv * uv + (t * t - (ut + ut) * vt) * 2.0;
        let gaussian = first_order + unit * unit * second_order;
        [root(u), root(v), root(gaussian), root(mean)]
    }
}

/// Derivatives of the object's curvatures K_uu, K_vv and K_uv with respect to the entries `uu`, `vv`, `uv` of `K₁ B`.
/// Here K₁ is the probe's curvature and B the mobility (contact travel per radian). The results are the derivatives
/// multiplied by `−det²/K₁`, where `det` is the determinant of `K₁ B`.
#[inline(always)]
pub(crate) fn gradients(travel: &Symmetric) -> [[f64; 3]; 3] {
    let w = relative(travel);
    let (uu_uv, uv_vv, uv_uv) = (w.uu * w.uv, w.uv * w.vv, w.uv * w.uv);
    [
        [w.uu * w.uu, uv_uv, uu_uv + uu_uv],
        [uv_uv, w.vv * w.vv, uv_vv + uv_vv],
        [uu_uv, uv_vv, w.uu * w.vv + uv_uv],
    ]
}

/// The relative curvature of object and probe, in units of K₁ / det. K₁ is the probe's curvature, and det the
/// determinant of `travel`.
#[inline(always)]
fn relative(travel: &Symmetric) -> Symmetric {
    Symmetric {
        uu: travel.vv,
        vv: travel.uu,
        uv: -travel.uv,
    }
}

/// Square root of a variance. A variance that is negative due to rounding counts as 0.
#[inline(always)]
fn root(variance: f64) -> f64 {
    let variance = if variance < 0.0 { 0.0 } else { variance };
    variance.sqrt()
}

/// The result of a fit. The curvatures and standard errors are valid only if `moved` and `in_range` are true.
pub(crate) struct Solution {
    /// Travel of the contact per radian (mobility B), divided by its travel on a plane: `K₁ B` with the probe's
    /// curvature K₁.
    pub(crate) travel: Symmetric,
    /// The object's curvature form.
    pub(crate) curvature: Symmetric,
    /// Normal curvature along u and along v, Gaussian curvature and mean curvature.
    pub(crate) curvatures: [f64; 4],
    /// Standard errors of the curvatures; 0 if no noise was stated.
    pub(crate) stds: [f64; 4],
    /// Whether the contact moves forwards in every direction of rolling.
    pub(crate) moved: bool,
    /// Whether all computed curvatures and standard errors are finite.
    pub(crate) in_range: bool,
}
