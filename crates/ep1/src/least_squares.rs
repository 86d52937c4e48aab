//! The least squares of the 1996 paper, for any number of probes.
//!
//! With `g = (−Δθ_y, Δθ_x)` and `B = (K₁ + K₂)⁻¹` the model is `Δp = B g`. On a flat object
//! `B = I/K₁ = R₁ I`, and `K₂ = B⁻¹ − K₁` cancels. Fitted instead is the deviation from rolling on
//! a plane, `Δp − R₁ g = D g`, from which
//!
//! ```text
//! K₂ = −K₁ (I + K₁ D)⁻¹ K₁ D
//! ```
//!
//! loses nothing: readings of a flat object give exactly zero.

use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use palpate_geometry::CurvatureForm;

use crate::{Ep1Error, Estimate, Measured, ProbeReading, ReadingNoise};

/// Rotations whose spread across their main axis is below this are taken as parallel.
const SMALLEST_SPREAD: f64 = 1e-6;
/// A contact that moves less than this times what it would on a plane did not move.
const SMALLEST_TRAVEL: f64 = 1e-12;

/// Sums over probes, from which the curvature follows.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    radius: f64,
    noise: ReadingNoise,
    probes: usize,
    first_not_finite: Option<usize>,
    shift_lengths: f64,
    /// Sums of `g₁²`, `g₁ g₂`, `g₂²`.
    gram: Gram,
    /// The same, each probe weighted by the variance of its rotation.
    weighted_gram: Gram,
    /// Sums of `g₁ d₁`, `g₂ d₂`, `g₂ d₁ + g₁ d₂` with the deviations `d = Δp − R₁ g`.
    moments: [f64; 3],
}

#[derive(Clone, Copy, Debug, Default)]
struct Gram {
    uu: f64,
    uv: f64,
    vv: f64,
}

/// A symmetric 2×2 matrix by its three entries.
#[derive(Clone, Copy)]
struct Symmetric {
    uu: f64,
    vv: f64,
    uv: f64,
}

impl LeastSquares {
    /// No probes yet, of a probe of `radius` (which must be finite and positive), with readings as
    /// noisy as `noise` says.
    pub fn new(radius: f64, noise: ReadingNoise) -> Self {
        Self {
            radius,
            noise,
            probes: 0,
            first_not_finite: None,
            shift_lengths: 0.0,
            gram: Gram::default(),
            weighted_gram: Gram::default(),
            moments: [0.0; 3],
        }
    }

    /// The sums over `readings`.
    pub fn of(radius: f64, noise: ReadingNoise, readings: &[ProbeReading]) -> Self {
        let mut sums = Self::new(radius, noise);
        readings.iter().for_each(|reading| sums.add(reading));
        sums
    }

    /// Takes one more probe into account.
    #[inline]
    pub fn add(&mut self, reading: &ProbeReading) {
        let (g1, g2) = (-reading.rotation.y, reading.rotation.x);
        let (d1, d2) = (
            reading.shift.x - self.radius * g1,
            reading.shift.y - self.radius * g2,
        );
        if !(g1 + g2 + d1 + d2).is_finite() {
            self.first_not_finite.get_or_insert(self.probes);
        }
        self.probes += 1;
        self.shift_lengths += reading.shift.norm();
        let (uu, uv, vv) = (g1 * g1, g1 * g2, g2 * g2);
        self.gram.add(uu, uv, vv, 1.0);
        self.weighted_gram
            .add(uu, uv, vv, self.noise.rotation_variance(uu + vv));
        self.moments[0] += g1 * d1;
        self.moments[1] += g2 * d2;
        self.moments[2] += g2 * d1 + g1 * d2;
    }

    /// The object's curvature, with the uncertainty that the stated noise gives it.
    ///
    /// # Errors
    /// [`Ep1Error`] where there are too few probes, where they do not span the tangent plane, where
    /// the contact did not move or moved backwards in some direction, and where a reading is not
    /// finite.
    #[inline]
    pub fn estimate(&self) -> Result<Estimate, Ep1Error> {
        self.check()?;
        let probe_curvature = 1.0 / self.radius;
        let deviation = self.gram.solve(self.moments);
        // I + K₁ D, whose inverse is K_rel / K₁.
        let travel = Symmetric {
            uu: 1.0 + probe_curvature * deviation.uu,
            vv: 1.0 + probe_curvature * deviation.vv,
            uv: probe_curvature * deviation.uv,
        };
        let determinant = travel.determinant();
        if !(travel.uu > 0.0 && determinant > SMALLEST_TRAVEL * (travel.uu + travel.vv)) {
            return Err(self.not_moving(&travel));
        }
        let scale = 1.0 / determinant;
        // −K₁ (I + K₁ D)⁻¹ K₁ D; the product of two functions of D is symmetric.
        let factor = -probe_curvature * probe_curvature * scale;
        let curvature = CurvatureForm {
            k_uu: factor * (travel.vv * deviation.uu - travel.uv * deviation.uv),
            k_uv: factor * deviation.uv,
            k_vv: factor * (travel.uu * deviation.vv - travel.uv * deviation.uv),
        };
        let relative = Symmetric {
            uu: probe_curvature * scale * travel.vv,
            vv: probe_curvature * scale * travel.uu,
            uv: -probe_curvature * scale * travel.uv,
        };
        let mobility = Symmetric {
            uu: self.radius * travel.uu,
            vv: self.radius * travel.vv,
            uv: self.radius * travel.uv,
        };
        self.finish(curvature, &relative, &mobility)
    }

    /// Root mean square of the readings' residuals `Δp − B g` per component, length, and how many
    /// degrees of freedom they have (two per probe, less three).
    pub fn residual(&self, estimate: &Estimate, readings: &[ProbeReading]) -> (f64, usize) {
        let freedom = (2 * readings.len()).saturating_sub(3);
        if freedom == 0 {
            return (0.0, 0);
        }
        let square: f64 = readings
            .iter()
            .map(|reading| {
                let drive = Vector2::new(-reading.rotation.y, reading.rotation.x);
                (reading.shift - estimate.mobility * drive).norm_squared()
            })
            .sum();
        ((square / freedom as f64).sqrt(), freedom)
    }

    #[inline]
    fn check(&self) -> Result<(), Ep1Error> {
        if let Some(probe) = self.first_not_finite {
            return Err(Ep1Error::NotFinite { probe });
        }
        let probes = self.probes;
        if probes < 2 {
            return Err(Ep1Error::TooFewProbes { probes });
        }
        // det/trace² is between λ_min/λ_max and a quarter.
        let Gram { uu, uv, vv } = self.gram;
        let trace = uu + vv;
        let determinant = uu * vv - uv * uv;
        if determinant > SMALLEST_SPREAD * SMALLEST_SPREAD * trace * trace {
            return Ok(());
        }
        if !trace.is_finite() || (trace > 0.0 && trace < 1e-140) {
            return Err(Ep1Error::OutOfRange);
        }
        let spread = (determinant.max(0.0).sqrt() / trace).min(1.0);
        let spread = if spread.is_finite() { spread } else { 0.0 };
        Err(Ep1Error::Unresolvable { probes, spread })
    }

    #[cold]
    fn not_moving(&self, travel: &Symmetric) -> Ep1Error {
        let matrix = Matrix2::new(travel.uu, travel.uv, travel.uv, travel.vv);
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return Ep1Error::OutOfRange;
        }
        let eigen = SymmetricEigen::new(matrix);
        let (index, smallest) = eigen.eigenvalues.argmin();
        let direction = eigen.eigenvectors.column(index);
        let (direction_rad, sign) = {
            // Of the two opposite directions, the one in (−π/2, π/2].
            let backward = direction.x < -1e-9 || (direction.x < 1e-9 && direction.y < 0.0);
            let sign = if backward { -1.0 } else { 1.0 };
            ((sign * direction.y).atan2(sign * direction.x), sign)
        };
        let largest = eigen.eigenvalues.max();
        if smallest < -SMALLEST_TRAVEL * largest.max(1.0) {
            let travel_per_radian = smallest * self.radius;
            return Ep1Error::NotRolling {
                direction_rad,
                travel_per_radian,
            };
        }
        // The longest rotation in that direction that moved the contact less than the resolution.
        let along = direction * sign;
        let Gram { uu, uv, vv } = self.gram;
        let square = uu * along.x * along.x + 2.0 * uv * along.x * along.y + vv * along.y * along.y;
        let rotation = (square / self.probes as f64).sqrt();
        let relative_above = rotation / self.noise.shift_resolution;
        let radius_below = 1.0 / (relative_above - 1.0 / self.radius);
        let known = radius_below > 0.0 && radius_below.is_finite();
        Ep1Error::Unresolved {
            direction_rad,
            radius_below: known.then_some(radius_below),
        }
    }

    #[inline]
    fn finish(
        &self,
        curvature: CurvatureForm,
        relative: &Symmetric,
        mobility: &Symmetric,
    ) -> Result<Estimate, Ep1Error> {
        let gaussian = curvature.gaussian_curvature();
        let mean = curvature.mean_curvature();
        if !(gaussian + mean + mobility.uu + mobility.vv).is_finite() {
            return Err(Ep1Error::OutOfRange);
        }
        let [u, v, k, h] = if self.noise.is_stated() {
            self.stds(&curvature, relative, mobility).map(Some)
        } else {
            [None; 4]
        };
        Ok(Estimate {
            curvature,
            normal_curvature_u: Measured {
                value: curvature.k_uu,
                std: u,
            },
            normal_curvature_v: Measured {
                value: curvature.k_vv,
                std: v,
            },
            gaussian_curvature: Measured {
                value: gaussian,
                std: k,
            },
            mean_curvature: Measured {
                value: mean,
                std: h,
            },
            arc_length: self.shift_lengths / self.probes as f64,
            probe_curvature: 1.0 / self.radius,
            mobility: Matrix2::new(mobility.uu, mobility.uv, mobility.uv, mobility.vv),
        })
    }

    /// Standard deviations of K_uu, K_vv, Gaussian and mean curvature.
    ///
    /// A probe's residual is `e − B δg` for shift error `e` and rotation error `δg`; fitted, it
    /// changes B by the `δB` of the normal equations, and `δK₂ = −K_rel δB K_rel`. A quantity `q`
    /// with gradient `G` in K₂ changes by `−tr(S δB)` with `S = K_rel G K_rel`; with `H` the solution
    /// of the normal equations for S, `δq = −Σ g·(H residual)`.
    #[inline]
    fn stds(&self, curvature: &CurvatureForm, w: &Symmetric, b: &Symmetric) -> [f64; 4] {
        let solve = |s: Symmetric| self.gram.solve([s.uu, s.vv, 2.0 * s.uv]);
        let along_u = solve(Symmetric {
            uu: w.uu * w.uu,
            vv: w.uv * w.uv,
            uv: w.uu * w.uv,
        });
        let along_v = solve(Symmetric {
            uu: w.uv * w.uv,
            vv: w.vv * w.vv,
            uv: w.uv * w.vv,
        });
        let mixed = solve(Symmetric {
            uu: w.uu * w.uv,
            vv: w.uv * w.vv,
            uv: 0.5 * (w.uu * w.vv + w.uv * w.uv),
        });
        let combined = |u: f64, v: f64, m: f64| Symmetric {
            uu: u * along_u.uu + v * along_v.uu + m * mixed.uu,
            vv: u * along_u.vv + v * along_v.vv + m * mixed.vv,
            uv: u * along_u.uv + v * along_v.uv + m * mixed.uv,
        };
        let gaussian = combined(curvature.k_vv, curvature.k_uu, -2.0 * curvature.k_uv);
        let mean = combined(0.5, 0.5, 0.0);
        [along_u, along_v, gaussian, mean].map(|h| self.std(&h, b))
    }

    /// `√(Σ σ_s² |H g|² + σ_θ² |B H g|²)` over the probes.
    #[inline]
    fn std(&self, h: &Symmetric, b: &Symmetric) -> f64 {
        let columns = |t11: f64, t12: f64, t21: f64, t22: f64, gram: &Gram| {
            (t11 * t11 + t21 * t21) * gram.uu
                + 2.0 * (t11 * t12 + t21 * t22) * gram.uv
                + (t12 * t12 + t22 * t22) * gram.vv
        };
        let from_shift = columns(h.uu, h.uv, h.uv, h.vv, &self.gram);
        let from_rotation = columns(
            b.uu * h.uu + b.uv * h.uv,
            b.uu * h.uv + b.uv * h.vv,
            b.uv * h.uu + b.vv * h.uv,
            b.uv * h.uv + b.vv * h.vv,
            &self.weighted_gram,
        );
        let shift_variance = self.noise.shift_std * self.noise.shift_std;
        (shift_variance * from_shift + from_rotation).sqrt()
    }
}

impl Gram {
    #[inline]
    fn add(&mut self, uu: f64, uv: f64, vv: f64, weight: f64) {
        self.uu += weight * uu;
        self.uv += weight * uv;
        self.vv += weight * vv;
    }

    /// Solves the normal equations `[[uu, 0, uv], [0, vv, uv], [uv, uv, uu + vv]] (k₁, k₂, k₃) = r`
    /// by eliminating k₁ and k₂.
    #[inline]
    fn solve(&self, [r1, r2, r3]: [f64; 3]) -> Symmetric {
        let Self { uu, uv, vv } = *self;
        // uu·vv·(Schur complement) / (uu + vv) = uu·vv − uv², positive for probes that span.
        let products = uu * vv;
        let uv_k = (products * r3 - uv * (vv * r1 + uu * r2)) / ((uu + vv) * (products - uv * uv));
        Symmetric {
            uu: (r1 - uv * uv_k) / uu,
            vv: (r2 - uv * uv_k) / vv,
            uv: uv_k,
        }
    }
}

impl Symmetric {
    #[inline]
    fn determinant(&self) -> f64 {
        self.uu * self.vv - self.uv * self.uv
    }
}
