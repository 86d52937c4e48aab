//! The least-squares estimator of Charlebois, Gupta and Payandeh (1996), for any number of probes.
//!
//! The drive `g = (−Δθ_y, Δθ_x)` is the rotation vector, turned by 90°. The mobility `B = (K₁ + K₂)⁻¹` is the contact's
//! travel per radian, where K₁ and K₂ are the curvatures of probe and object. The model of a shift is `Δp = B g`. On a
//! flat object, `B` is `I/K₁ = R₁ I`, where R₁ is the probe's radius. There, the formula `K₂ = B⁻¹ − K₁` would lose its
//! digits by cancellation. Therefore the fit estimates `D`, which describes the deviation from rolling on a plane:
//! `Δp − R₁ g = D g`. The formula
//!
//! ```text
//! K₂ = −K₁ (I + K₁ D)⁻¹ K₁ D
//! ```
//!
//! has no cancellation: readings of a flat object give exactly zero curvature. If the error of the measured rotations
//! is stated, its variance is subtracted from the sum of the squared rotations. Without this correction, the contact
//! would seem to move less per radian than it does. A relative error is subtracted only if
//! [`ReadingNoise::is_rotation_measured`] is true; then the bias of second order is subtracted too.
//!
//! If the readings are exact and the probes roll equally in all directions, the curvatures `k` have a relative error of
//! at most `1e-15 (2 + K₁/|k| + |k|/K₁)`. The term `K₁/|k|` comes from the rounding of the readings. The term `|k|/K₁`
//! comes from the formula above, which is accurate for flat objects but less accurate for sharp ones. If the object's
//! curvature is a million times the probe's curvature, the estimate has nine correct digits.

use nalgebra::{Matrix3, SymmetricEigen, Vector2};
use palpate_geometry::CurvatureForm;

use crate::linear_law::{Law, MIN_TRAVEL, ROUNDING, Solution, gradients};
use crate::symmetric::{SMALLEST_SPREAD, Symmetric, Symmetric3};
use crate::{
    BatchEstimates, BatchMoments, Ep1Error, Estimate, Measured, Moments, PadCell, ProbeReading,
    ReadingNoise,
};

/// A least-squares fit for given rotations of the probes. The fit is prepared once, because only the rotations
/// determine the matrices of the fit.
///
/// The prepared fit computes an estimate for each set of shifts; see [`Moments`].
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

impl LeastSquares {
    /// The fit for probes of `radius` that have rotated by `rotations`. `noise` is the noise of the readings.
    ///
    /// # Errors
    /// [`Ep1Error`] if there are too few probes, if their rotations do not span the tangent plane, or if a rotation is
    /// not finite; [`Ep1Error::OutOfRange`] if the radius is not finite and positive, if a number in `noise` is
    /// negative or not finite, or if the rotations are below 1e-50 or above 1e50 rad.
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
        // `added` is the part of the sum of squared rotations that comes from errors of the measured rotations. It is
        // subtracted, because it would bias the estimate.
        let added = noise.squared_errors(rotations.len(), gram.uu + gram.vv, gram.least())?;
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

    /// The estimate from recorded readings of probes of `radius`: [`LeastSquares::new`] and [`LeastSquares::estimate`]
    /// in one call.
    ///
    /// # Errors
    /// Errors of [`LeastSquares::new`] and [`LeastSquares::estimate`].
    pub fn of(
        radius: f64,
        noise: ReadingNoise,
        readings: &[ProbeReading],
    ) -> Result<Estimate, Ep1Error> {
        Self::fitted(radius, noise, readings).map(|(_, estimate)| estimate)
    }

    /// Two results for recorded readings of probes of `radius`: the prepared fit, and the estimate from these readings.
    ///
    /// # Errors
    /// Errors of [`LeastSquares::of`].
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

    /// Estimates the object's curvature from the sums over the probes. The standard errors are due to the stated noise.
    ///
    /// # Errors
    /// [`Ep1Error`] if the contact did not move or moved backwards in some direction, or if the numbers are out of
    /// range.
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
        } = match (is_stated, self.noise.is_rotation_measured) {
            (true, true) => self.law.solve::<true, true>(moments),
            (true, false) => self.law.solve::<true, false>(moments),
            (false, _) => self.law.solve::<false, false>(moments),
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

    /// Covariance (1/length²) of three estimated components of the curvature: the normal curvatures along u and v, and
    /// the twist `k_uv`. It is computed to first order from the stated noise; `None` if no noise was stated.
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

    /// Computes the estimates of the first `count` sets of `moments`. These estimates equal the results of
    /// [`LeastSquares::estimate`] to the last bit. Returns the number of sets before the first set that does not
    /// determine a curvature.
    ///
    /// The function is always inlined, so that it is compiled for the vector instructions of its caller.
    #[inline(always)]
    pub fn estimate_batch(
        &self,
        moments: &BatchMoments,
        count: usize,
        estimates: &mut BatchEstimates,
    ) -> usize {
        estimates.have_stds = self.noise.is_stated();
        let law = self.law;
        match (estimates.have_stds, self.noise.is_rotation_measured) {
            (true, true) => law.solve_batch::<true, true>(moments, count, estimates),
            (true, false) => law.solve_batch::<true, false>(moments, count, estimates),
            (false, _) => law.solve_batch::<false, false>(moments, count, estimates),
        }
        estimates.determined(count)
    }

    /// The error for a contact that did not move, or that moved backwards, in some direction. `travel` is a matrix: the
    /// contact's travel per radian, divided by its travel per radian on a plane.
    #[cold]
    fn not_moving(&self, travel: &Symmetric) -> Ep1Error {
        let matrix = travel.matrix();
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return Ep1Error::OutOfRange;
        }
        let eigen = SymmetricEigen::new(matrix);
        let (index, smallest) = eigen.eigenvalues.argmin();
        let direction = eigen.eigenvectors.column(index);
        // Two opposite directions describe the same movement, so use the direction whose angle is in (−π/2, π/2].
        let backward = direction.x < -1e-9 || (direction.x < 1e-9 && direction.y < 0.0);
        let along = direction * if backward { -1.0 } else { 1.0 };
        let direction_rad = libm::atan2(along.y, along.x);
        if smallest < -MIN_TRAVEL * eigen.eigenvalues.max().max(1.0) {
            let travel_per_radian = smallest * self.radius;
            return Ep1Error::NotRolling {
                direction_rad,
                travel_per_radian,
            };
        }
        // In the direction of least motion, even the longest rotation moved the contact by less than the resolution.
        // This gives an upper bound on the object's radius of curvature.
        let rotations = self.rotations.iter();
        let rotations = rotations.map(|one| (one.x * along.y - one.y * along.x).abs());
        let rotation = rotations.fold(0.0, f64::max);
        // On square pads, the contact can move furthest along a diagonal.
        let square = PadCell {
            pitch: self.noise.shift_resolution,
            is_hexagonal: false,
        };
        let resolution = square.chord(&along);
        let relative_above = rotation / resolution;
        let radius_below = 1.0 / (relative_above - 1.0 / self.radius);
        let known = radius_below > 0.0 && radius_below.is_finite();
        Ep1Error::Unresolved {
            direction_rad,
            radius_below: known.then_some(radius_below),
        }
    }
}

impl Estimate {
    /// Root mean square of the components of the residuals `Δp − B g` (length). Δp is the shift of a probe, B the
    /// mobility (contact travel per radian), and g the rotation vector, turned by 90°. The second result is the number
    /// of degrees of freedom: two per probe, minus three.
    pub fn residual(&self, readings: &[ProbeReading]) -> (f64, usize) {
        let freedom = (2 * readings.len()).saturating_sub(3);
        if freedom == 0 {
            return (0.0, 0);
        }
        let apart = |one: &ProbeReading| one.shift - self.shift(&one.rotation);
        let squares = readings.iter().map(|one| apart(one).norm_squared());
        let square: f64 = squares.sum();
        ((square / freedom as f64).sqrt(), freedom)
    }
}

/// Checks that the rotations of `probes` probes span the tangent plane. `gram` is the sum of the outer products of
/// their rotation vectors, turned by 90°.
fn spans(probes: usize, gram: &Symmetric) -> Result<(), Ep1Error> {
    if probes < 2 {
        return Err(Ep1Error::TooFewProbes { probes });
    }
    // Let q be the ratio of the smaller to the larger eigenvalue of the matrix `gram`. q is between det/trace² and four
    // times det/trace². Therefore compare det/trace² with the limit, which needs no eigenvalues.
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

/// Matrix of the normal equations, `Σ AᵀA`, where the sum is over the rolls. For a roll with the rotation vector g,
/// turned by 90°, `A = [[g₁, 0, g₂], [0, g₂, g₁]]`.
fn normal_equations(gram: &Symmetric) -> Matrix3<f64> {
    let Symmetric { uu, uv, vv } = *gram;
    Matrix3::new(uu, 0.0, uv, 0.0, vv, uv, uv, uv, uu + vv)
}

/// Returns the sum `Σ σ² Aᵀ C A` over the rolls, with the matrix `A` of each roll as in [`normal_equations`]. `C` is
/// the covariance of a residual if the rotation has unit variance. `gram` is the Gram matrix of the rotation vectors,
/// turned by 90°. Each roll has the variance σ² of its rotation as weight in this matrix.
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
