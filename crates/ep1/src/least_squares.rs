//! The least squares of the 1996 paper, for any number of probes.
//!
//! With `g = (−Δθ_y, Δθ_x)` and `B = (K₁ + K₂)⁻¹` the model is `Δp = B g`. On a flat object
//! `B = I/K₁ = R₁ I`, and `K₂ = B⁻¹ − K₁` loses its digits by cancellation. Therefore the fit estimates `D`, the
//! deviation from rolling on a plane, `Δp − R₁ g = D g`. The formula
//!
//! ```text
//! K₂ = −K₁ (I + K₁ D)⁻¹ K₁ D
//! ```
//!
//! does not cancel: readings of a flat object give exactly zero. If rotations are measured with a stated error, their
//! squares are reduced by its variance. Otherwise the contact would seem to move less.
//!
//! Exact readings of probes that turn alike in all directions give curvatures with a relative error of at most
//! `1e-15 (2 + K₁/|k| + |k|/K₁)`. The term `K₁/|k|` comes from the rounding of the readings. The term `|k|/K₁` is the
//! price of the accuracy on flat objects: the curvature of an object a million times as sharp as the probe has nine
//! correct digits.

use nalgebra::{Matrix3, SymmetricEigen, Vector2};
use palpate_geometry::CurvatureForm;

use crate::batch::BATCH_SIZE;
use crate::symmetric::{SMALLEST_SPREAD, Symmetric, Symmetric3};
use crate::{
    BatchEstimates, BatchMoments, Ep1Error, Estimate, Measured, Moments, ProbeReading, ReadingNoise,
};

/// Smallest travel of a contact, relative to that on a plane, that is not a rounding error.
const MIN_TRAVEL: f64 = 1e-12;

/// Largest share of the squared rotations, in any direction, that may come from errors of the measured rotations. A
/// scene is checked with its true rotations. This is stricter, because errors make measured rotations larger.
const MAX_NOISE_SHARE: f64 = 0.5;

/// Standard deviation of the rounding errors in the entries of `K₁ B`, from the last digits of readings and sums.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// The part of the least squares that depends only on the rotations, not on the shifts.
///
/// Many sets of shifts can be fitted for one set of rotations; see [`Moments`].
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
///
/// // Probes of radius 1 on a ball of radius 3: the contact moves by 1/(1/1 + 1/3) per radian.
/// let readings = [
///     ProbeReading { rotation: Vector2::new(0.0, -0.1), shift: Vector2::new(0.075, 0.0) },
///     ProbeReading { rotation: Vector2::new(0.1, 0.0), shift: Vector2::new(0.0, 0.075) },
/// ];
/// let estimate = LeastSquares::of(1.0, ReadingNoise::default(), &readings)?;
/// assert!((estimate.mean_curvature.value - 1.0 / 3.0).abs() < 1e-13);
/// assert!(estimate.amplification(0.0).is_some_and(|growth| (growth - 4.0).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquares {
    radius: f64,
    noise: ReadingNoise,
    rotations: Vec<Vector2<f64>>,
    pub(crate) law: Law,
}

/// Linear map from shifts to estimates. It is copied for batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    radius: f64,
    probe_curvature: f64,
    per_probe: f64,
    /// Inverse of the normal equations for the entries `uu`, `vv`, `uv` of `K₁ D`.
    inverse: Symmetric3,
    /// Mean amount by which errors of measured rotations reduce the sum of `g d`, `d = Δp − R₁ g`, length.
    added: f64,
    /// Covariance of the entries of `K₁ D` due to the shifts' noise and to rounding.
    from_shifts: Symmetric3,
    /// Their covariance due to the rotations' noise, per entry `uu`, `vv`, `uv` of `(K₁ B)²`.
    from_rotations: [Symmetric3; 3],
}

/// Standard deviation (1/length) of a normal curvature (1/length) that is estimated with probes of `radius`, due to
/// rounding of the readings alone.
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

impl LeastSquares {
    /// The fit for probes of `radius` that turned by `rotations`, with readings of this noise.
    ///
    /// # Errors
    /// [`Ep1Error`] if there are too few probes, if they do not span the tangent plane, or if a rotation is not finite;
    /// [`Ep1Error::OutOfRange`] if the radius is not finite and positive, if a size of the noise is not finite and at least 0,
    /// or if the rotations are below 1e-50 or above 1e50 rad.
    pub fn new(
        radius: f64,
        noise: ReadingNoise,
        rotations: &[Vector2<f64>],
    ) -> Result<Self, Ep1Error> {
        let is_bad = |rotation: &Vector2<f64>| !(rotation.x.is_finite() && rotation.y.is_finite());
        if let Some(probe) = rotations.iter().position(is_bad) {
            return Err(Ep1Error::NotFinite { probe });
        }
        let (mut gram, mut weighted) = (Symmetric::default(), Symmetric::default());
        for rotation in rotations {
            let square = Symmetric {
                uu: rotation.y * rotation.y,
                uv: -rotation.x * rotation.y,
                vv: rotation.x * rotation.x,
            };
            gram.add(&square, 1.0);
            weighted.add(&square, noise.rotation_variance(square.uu + square.vv));
        }
        let sizes = [
            noise.relative_rotation_std,
            noise.rotation_std_rad,
            noise.shift_std,
            noise.shift_resolution,
        ];
        let are_sizes = sizes.iter().all(|size| (0.0..f64::INFINITY).contains(size));
        if !(are_sizes && radius > 0.0 && radius.is_finite()) {
            return Err(Ep1Error::OutOfRange);
        }
        spans(rotations.len(), &gram)?;
        // Measurement errors add their variance to the squared rotations.
        let added = noise.rotation_std_rad * noise.rotation_std_rad * rotations.len() as f64;
        let share = added / gram.least();
        if share > MAX_NOISE_SHARE {
            return Err(Ep1Error::NoisyRotations { share });
        }
        gram.uu -= added;
        gram.vv -= added;
        let inverse = normal_equations(&gram)
            .try_inverse()
            .ok_or(Ep1Error::OutOfRange)?;
        let probe_curvature = 1.0 / radius;
        if !inverse
            .iter()
            .all(|entry| (entry * probe_curvature).is_finite())
        {
            return Err(Ep1Error::OutOfRange);
        }
        let relative_shift_std = noise.shift_std * probe_curvature;
        let through = |middle: &Matrix3<f64>| Symmetric3::of(&(inverse * middle * inverse));
        let shift_variance = relative_shift_std * relative_shift_std;
        let from_shifts = match noise.shared_errors(radius, rotations) {
            None => Symmetric3::of(&(inverse * shift_variance)),
            Some(shared) => through(&(shared * shift_variance)),
        };
        let unit = |uu, vv, uv| through(&weighted_equations(&weighted, &Symmetric { uu, uv, vv }));
        Ok(Self {
            radius,
            noise,
            rotations: rotations.to_vec(),
            law: Law {
                radius,
                probe_curvature,
                per_probe: 1.0 / rotations.len() as f64,
                inverse: Symmetric3::of(&(inverse * probe_curvature)),
                added: radius * added,
                from_shifts: from_shifts.with_diagonal(ROUNDING * ROUNDING),
                from_rotations: match weighted == Symmetric::default() {
                    true => [Symmetric3::default(); 3],
                    false => [
                        unit(1.0, 0.0, 0.0),
                        unit(0.0, 1.0, 0.0),
                        unit(0.0, 0.0, 1.0),
                    ],
                },
            },
        })
    }

    /// The estimate from recorded readings of probes of `radius`: fit and estimate in one.
    ///
    /// # Errors
    /// As [`LeastSquares::new`] and [`LeastSquares::estimate`].
    pub fn of(
        radius: f64,
        noise: ReadingNoise,
        readings: &[ProbeReading],
    ) -> Result<Estimate, Ep1Error> {
        Self::fitted(radius, noise, readings).map(|(_, estimate)| estimate)
    }

    /// The fit of recorded readings of probes of `radius`, and its estimate.
    ///
    /// # Errors
    /// As [`LeastSquares::of`].
    pub fn fitted(
        radius: f64,
        noise: ReadingNoise,
        readings: &[ProbeReading],
    ) -> Result<(Self, Estimate), Ep1Error> {
        let rotations: Vec<_> = readings.iter().map(|reading| reading.rotation).collect();
        let fit = Self::new(radius, noise, &rotations)?;
        let is_bad = |reading: &ProbeReading| !reading.shift.iter().all(|shift| shift.is_finite());
        if let Some(probe) = readings.iter().position(is_bad) {
            return Err(Ep1Error::NotFinite { probe });
        }
        let mut moments = Moments::default();
        readings
            .iter()
            .for_each(|reading| moments.add(radius, reading));
        let estimate = fit.estimate(&moments)?;
        Ok((fit, estimate))
    }

    /// The object's curvature from the shifts of the probes, with the uncertainty due to the stated noise.
    ///
    /// # Errors
    /// [`Ep1Error`] if the contact did not move or moved backwards in some direction, or if the numbers are out of range.
    #[inline]
    pub fn estimate(&self, moments: &Moments) -> Result<Estimate, Ep1Error> {
        let is_stated = self.noise.is_stated();
        let Solution {
            travel,
            curvature: Symmetric { uu, uv, vv },
            curvatures,
            stds,
            moved,
            in_range,
        } = match is_stated {
            true => self.law.solve::<true>(moments),
            false => self.law.solve::<false>(moments),
        };
        if !moved {
            return Err(self.not_moving(&travel));
        }
        if !in_range {
            return Err(Ep1Error::OutOfRange);
        }
        let measured = |quantity: usize| Measured {
            value: curvatures[quantity],
            std: is_stated.then_some(stds[quantity]),
        };
        Ok(Estimate {
            curvature: CurvatureForm {
                k_uu: uu,
                k_uv: uv,
                k_vv: vv,
            },
            normal_curvature_u: measured(0),
            normal_curvature_v: measured(1),
            gaussian_curvature: measured(2),
            mean_curvature: measured(3),
            arc_length: self.law.arc_length(moments),
            probe_curvature: self.law.probe_curvature,
            mobility: self.radius * travel.matrix(),
        })
    }

    /// Covariance of the normal curvatures along u and v and of the twist `k_uv` of an estimate of this fit, to first
    /// order, 1/length²; `None` if no noise was stated.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
    ///
    /// let readings = [
    ///     ProbeReading { rotation: Vector2::new(0.0, -0.1), shift: Vector2::new(0.2, 0.0) },
    ///     ProbeReading { rotation: Vector2::new(0.1, 0.0), shift: Vector2::new(0.0, 0.2) },
    /// ];
    /// let noise = ReadingNoise { shift_std: 0.01, ..ReadingNoise::default() };
    /// let (fit, estimate) = LeastSquares::fitted(2.0, noise, &readings)?;
    /// let covariance = fit.covariance(&estimate).ok_or("noise is stated")?;
    /// let std = estimate.normal_curvature_u.std.ok_or("noise is stated")?;
    /// assert!((covariance[0][0] - std * std).abs() < 1e-12 * std * std);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn covariance(&self, estimate: &Estimate) -> Option<[[f64; 3]; 3]> {
        if !self.noise.is_stated() {
            return None;
        }
        let matrix = estimate.mobility * self.law.probe_curvature;
        let travel = Symmetric {
            uu: matrix[(0, 0)],
            uv: matrix[(0, 1)],
            vv: matrix[(1, 1)],
        };
        let determinant = travel.determinant();
        let unit = self.law.probe_curvature / (determinant * determinant);
        let of_mobility = self.law.of_mobility(&travel);
        let gradients = gradients(&travel);
        let entry = |one: usize, other: usize| {
            let covariance = of_mobility.times(&gradients[one]).dot(&gradients[other]);
            unit * covariance * unit
        };
        Some(std::array::from_fn(|one| {
            std::array::from_fn(|other| entry(one, other))
        }))
    }

    /// Estimates from the first `count` of `moments`. They equal those of [`LeastSquares::estimate`] to the last bit. Returns
    /// the number of estimates before the first one that is not determined.
    ///
    /// It is compiled for the vector instructions of its caller.
    #[inline(always)]
    pub fn estimate_batch(
        &self,
        moments: &BatchMoments,
        count: usize,
        estimates: &mut BatchEstimates,
    ) -> usize {
        estimates.have_stds = self.noise.is_stated();
        match estimates.have_stds {
            true => self.law.solve_batch::<true>(moments, count, estimates),
            false => self.law.solve_batch::<false>(moments, count, estimates),
        }
        estimates.determined(count)
    }

    /// The error if the contact did not move, or moved backwards, in some direction.
    #[cold]
    fn not_moving(&self, travel: &Symmetric) -> Ep1Error {
        let matrix = travel.matrix();
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return Ep1Error::OutOfRange;
        }
        let eigen = SymmetricEigen::new(matrix);
        let (index, smallest) = eigen.eigenvalues.argmin();
        let direction = eigen.eigenvectors.column(index);
        // Of the two opposite directions, the one in (−π/2, π/2].
        let backward = direction.x < -1e-9 || (direction.x < 1e-9 && direction.y < 0.0);
        let along = if backward {
            -direction
        } else {
            direction.into_owned()
        };
        let direction_rad = libm::atan2(along.y, along.x);
        if smallest < -MIN_TRAVEL * eigen.eigenvalues.max().max(1.0) {
            let travel_per_radian = smallest * self.radius;
            return Ep1Error::NotRolling {
                direction_rad,
                travel_per_radian,
            };
        }
        // The longest rotation in that direction moved the contact less than the resolution.
        let rotation = self
            .rotations
            .iter()
            .map(|rotation| (rotation.x * along.y - rotation.y * along.x).abs())
            .fold(0.0, f64::max);
        let relative_above = rotation / self.noise.shift_resolution;
        let radius_below = 1.0 / (relative_above - 1.0 / self.radius);
        let known = radius_below > 0.0 && radius_below.is_finite();
        Ep1Error::Unresolved {
            direction_rad,
            radius_below: known.then_some(radius_below),
        }
    }
}

impl Law {
    #[inline(always)]
    fn solve_batch<const IS_STATED: bool>(
        self,
        moments: &BatchMoments,
        count: usize,
        estimates: &mut BatchEstimates,
    ) {
        for place in 0..count.min(BATCH_SIZE) {
            let moments = moments.at(place);
            let solution = self.solve::<IS_STATED>(&moments);
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

    /// The fit, without branches, so that many can be done side by side.
    #[inline(always)]
    pub(crate) fn solve<const IS_STATED: bool>(self, moments: &Moments) -> Solution {
        // K₁ D, and I + K₁ D whose inverse is K_rel / K₁.
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
        // −K₁ (I + K₁ D)⁻¹ K₁ D; the product of two functions of D is symmetric.
        let mixed = deviation.uv * deviation.uv;
        let curvature = Symmetric {
            uu: scale * (mixed - travel.vv * deviation.uu),
            uv: -scale * deviation.uv,
            vv: scale * (mixed - travel.uu * deviation.vv),
        };
        let gaussian = curvature.determinant();
        let mean = curvature.uu * 0.5 + curvature.vv * 0.5;
        let arc_length = self.arc_length(moments);
        // Standard deviations are in units of K₁ / det².
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

    /// Covariance of the entries of `K₁ B`; `travel` is `K₁ B`.
    #[inline(always)]
    fn of_mobility(self, travel: &Symmetric) -> Symmetric3 {
        self.from_shifts
            .plus(&self.from_rotations, &travel.square())
    }

    /// Standard deviations of K_uu, K_vv, Gaussian and mean curvature, in units of `unit` = `K₁ / det²`, where `det`
    /// is the determinant of `travel` = `K₁ B`.
    ///
    /// A probe's residual is `e − B δg` for shift error `e` and rotation error `δg`. Therefore the covariance of B is
    /// linear in `B²`, and `δK₂ = −K_rel δB K_rel`: a quantity with gradient `G` in K₂ changes by `−tr(S δB)` with
    /// `S = K_rel G K_rel`. The variance of the Gaussian curvature includes the term of second order, the only one
    /// that is not zero on a flat object.
    #[inline(always)]
    fn stds(self, curvature: &Symmetric, travel: &Symmetric, unit: f64) -> [f64; 4] {
        let covariance = self.of_mobility(travel);
        let [along_u, along_v, mixed] = gradients(travel);
        // No closure: one that is not inlined lacks the vector instructions of what calls it.
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

/// Change of K_uu, K_vv and K_uv per entry `uu`, `vv`, `uv` of `K₁ δB`, with the sign turned, in units of `K₁ / det²`.
#[inline(always)]
fn gradients(travel: &Symmetric) -> [[f64; 3]; 3] {
    // K_rel in units of K₁ / det.
    let w = Symmetric {
        uu: travel.vv,
        vv: travel.uu,
        uv: -travel.uv,
    };
    let (uu_uv, uv_vv, uv_uv) = (w.uu * w.uv, w.uv * w.vv, w.uv * w.uv);
    [
        [w.uu * w.uu, uv_uv, uu_uv + uu_uv],
        [uv_uv, w.vv * w.vv, uv_vv + uv_vv],
        [uu_uv, uv_vv, w.uu * w.vv + uv_uv],
    ]
}

/// Square root of a variance that rounding may have made negative.
#[inline(always)]
fn root(variance: f64) -> f64 {
    let variance = if variance < 0.0 { 0.0 } else { variance };
    variance.sqrt()
}

/// The result of the fit, not yet checked to be that of a rolling contact.
pub(crate) struct Solution {
    /// `K₁ B`.
    pub(crate) travel: Symmetric,
    /// The object's curvature form.
    pub(crate) curvature: Symmetric,
    /// Normal curvature along u and along v, Gaussian curvature and mean curvature.
    pub(crate) curvatures: [f64; 4],
    /// Their standard deviations; 0 if no noise was stated.
    pub(crate) stds: [f64; 4],
    /// Whether the contact moved along with the roll, in every direction.
    pub(crate) moved: bool,
    /// Whether the numbers are finite.
    pub(crate) in_range: bool,
}

impl Estimate {
    /// Root mean square of the residuals `Δp − B g` per component, length, and their degrees of
    /// freedom (two per probe, less three).
    pub fn residual(&self, readings: &[ProbeReading]) -> (f64, usize) {
        let freedom = (2 * readings.len()).saturating_sub(3);
        if freedom == 0 {
            return (0.0, 0);
        }
        let square: f64 = readings
            .iter()
            .map(|reading| {
                let drive = Vector2::new(-reading.rotation.y, reading.rotation.x);
                (reading.shift - self.mobility * drive).norm_squared()
            })
            .sum();
        ((square / freedom as f64).sqrt(), freedom)
    }
}

/// Whether `probes` rotations with this Gram matrix span the tangent plane.
fn spans(probes: usize, gram: &Symmetric) -> Result<(), Ep1Error> {
    if probes < 2 {
        return Err(Ep1Error::TooFewProbes { probes });
    }
    // det/trace² is between λ_min/λ_max and a quarter of that.
    let trace = gram.uu + gram.vv;
    let determinant = gram.determinant();
    if determinant > SMALLEST_SPREAD * SMALLEST_SPREAD * trace * trace {
        return Ok(());
    }
    if !(trace.is_finite() && trace > 1e-140) && trace != 0.0 {
        return Err(Ep1Error::OutOfRange);
    }
    let spread = determinant.max(0.0).sqrt() / trace;
    Err(Ep1Error::Unresolvable {
        probes,
        spread: if spread.is_finite() { spread } else { 0.0 },
    })
}

/// `Σ AᵀA` with `A = [[g₁, 0, g₂], [0, g₂, g₁]]`.
fn normal_equations(gram: &Symmetric) -> Matrix3<f64> {
    let Symmetric { uu, uv, vv } = *gram;
    Matrix3::new(uu, 0.0, uv, 0.0, vv, uv, uv, uv, uu + vv)
}

/// `Σ σ² Aᵀ C A` for the covariance `C` of a residual per variance of a rotation, with the Gram
/// matrix weighted by the variances σ².
fn weighted_equations(gram: &Symmetric, c: &Symmetric) -> Matrix3<f64> {
    let Symmetric { uu, uv, vv } = *gram;
    let (u_mixed, v_mixed) = (c.uu * uv + c.uv * uu, c.uv * vv + c.vv * uv);
    Matrix3::new(
        c.uu * uu,
        c.uv * uv,
        u_mixed,
        c.uv * uv,
        c.vv * vv,
        v_mixed,
        u_mixed,
        v_mixed,
        c.uu * vv + 2.0 * c.uv * uv + c.vv * uu,
    )
}
