//! Curvature at a point of a surface: the curvature form, its invariants and the classes of surface points.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use nalgebra::{Matrix2, Vector2};
use palpate_statistics::{NORMAL_95, Number};
use strum::IntoStaticStr;
use thiserror::Error;

/// The curvature form of a surface in an orthonormal tangent basis `(u, v)`, 1/length.
///
/// The form is symmetric, and positive where the solid is convex. The form of a sphere of radius `R` is `I/R`, the form
/// of a dish is `−I/R`. Derived quantities are finite if every component is finite and at most 1e150 in absolute value.
///
/// ```
/// use palpate_geometry::CurvatureForm;
///
/// // A cylinder of radius 2 whose axis lies along v.
/// let form = CurvatureForm { k_uu: 0.5, k_uv: 0.0, k_vv: 0.0 };
/// assert_eq!(form.gaussian_curvature(), 0.0);
/// assert_eq!(form.mean_curvature(), 0.25);
/// assert_eq!((form.principal().k_min, form.principal().k_max), (0.0, 0.5));
/// // The shape index of a ridge.
/// assert!(form.principal().shape_index().is_some_and(|index| (index - 0.5).abs() < 1e-15));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurvatureForm {
    /// Normal curvature along `u`.
    pub k_uu: f64,
    /// Rotation of the surface normal towards `v` per unit length along `u`.
    pub k_uv: f64,
    /// Normal curvature along `v`.
    pub k_vv: f64,
}

/// Two estimated principal curvatures differ significantly if half of their difference exceeds this number of standard
/// errors. If the true curvatures are equal, noise causes such a difference with a probability of 5 %. The number is
/// the square root of the 95 % quantile of χ² with 2 degrees of freedom.
const SIGNIFICANT_SPREAD: f64 = 2.447_746_830_680_816;
/// Standard deviation (rad) of an undetermined direction: π/√12, because the direction is uniformly distributed over
/// half a turn.
pub const UNKNOWN_DIRECTION_STD: f64 = 0.906_899_682_117_089_3;

/// The two principal curvatures at a point of a surface, ordered by signed value, and their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalCurvatures {
    /// Smallest normal curvature (1/length).
    pub k_min: f64,
    /// Largest normal curvature (1/length).
    pub k_max: f64,
    /// Direction of `k_max`: angle from `u` towards `v`, in (−π/2, π/2]. The direction of `k_min` is perpendicular to
    /// it. At an umbilic, where both curvatures are equal, every direction is principal; the angle is then 0.
    pub angle_of_max_rad: f64,
}

impl PrincipalCurvatures {
    /// Shape index `(2/π) atan((k_max + k_min)/(k_max − k_min))` in [−1, 1]: +1 for a convex cap, 0 for a symmetric
    /// saddle, −1 for a cup. Its error is at most 1e-15. `None` at a flat point, where the index is undefined, or if a
    /// curvature is not finite.
    pub fn shape_index(&self) -> Option<f64> {
        let Self { k_min, k_max, .. } = *self;
        if k_min == 0.0 && k_max == 0.0 {
            return None;
        }
        let index = FRAC_2_PI * libm::atan2(k_max + k_min, k_max - k_min);
        index.is_finite().then_some(index)
    }
}

impl CurvatureForm {
    /// The curvature form `curvature · I` of a sphere (or of a plane if `curvature` is 0).
    pub(crate) const fn isotropic(curvature: f64) -> Self {
        Self {
            k_uu: curvature,
            k_uv: 0.0,
            k_vv: curvature,
        }
    }

    /// The curvature form as a symmetric matrix.
    pub fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.k_uu, self.k_uv, self.k_uv, self.k_vv)
    }

    /// Gaussian curvature `k_min k_max` (1/length²).
    pub fn gaussian_curvature(&self) -> f64 {
        self.k_uu * self.k_vv - self.k_uv * self.k_uv
    }

    /// Mean curvature `(k_min + k_max)/2` (1/length).
    pub fn mean_curvature(&self) -> f64 {
        0.5 * self.k_uu + 0.5 * self.k_vv
    }

    /// Principal curvatures and their directions. The error of each curvature is at most 1e-15 times the larger
    /// magnitude of the two.
    pub fn principal(&self) -> PrincipalCurvatures {
        let mean = self.mean_curvature();
        let (half_difference, mixed) = (0.5 * self.k_uu - 0.5 * self.k_vv, self.k_uv);
        let spread = libm::hypot(half_difference, mixed);
        let angle = 0.5 * libm::atan2(mixed, half_difference);
        // The angles −π/2 and π/2 are the same direction. Replace −π/2 by π/2 to stay in the range (−π/2, π/2].
        let angle = if angle <= -FRAC_PI_2 {
            FRAC_PI_2
        } else {
            angle
        };
        PrincipalCurvatures {
            k_min: mean - spread,
            k_max: mean + spread,
            angle_of_max_rad: if spread == 0.0 { 0.0 } else { angle },
        }
    }

    /// Standard errors of `k_min`, `k_max` and the angle (rad) in [`CurvatureForm::principal`], to first order, from
    /// the covariance of `k_uu`, `k_vv` and `k_uv`.
    ///
    /// If the two curvatures do not differ significantly, the direction is undetermined, and the difference between the
    /// two estimates is only noise. In this case, the standard errors of both curvatures are enlarged so that their 95
    /// % intervals contain the mean curvature.
    ///
    /// ```
    /// use palpate_geometry::CurvatureForm;
    ///
    /// let variances = [[1e-4, 0.0, 0.0], [0.0, 1e-4, 0.0], [0.0, 0.0, 1e-4]];
    /// let ridge = CurvatureForm { k_uu: 0.5, k_uv: 0.0, k_vv: 0.0 };
    /// let [min, max, angle] = ridge.principal_stds(&variances);
    /// assert!((min - 0.01).abs() < 1e-15 && (max - 0.01).abs() < 1e-15 && (angle - 0.02).abs() < 1e-15);
    /// // Every direction of a ball is principal.
    /// let ball = CurvatureForm { k_uu: 0.5, k_uv: 0.0, k_vv: 0.5 };
    /// let [.., angle] = ball.principal_stds(&variances);
    /// assert!((angle.to_degrees() - 52.0).abs() < 0.1);
    /// ```
    pub fn principal_stds(&self, covariance: &[[f64; 3]; 3]) -> [f64; 3] {
        let std = |gradient: [f64; 3]| {
            let along = covariance.map(|row| (0..3).map(|at| row[at] * gradient[at]).sum::<f64>());
            let variance: f64 = (0..3).map(|at| along[at] * gradient[at]).sum();
            variance.max(0.0).sqrt()
        };
        let (half_difference, mixed) = (0.5 * self.k_uu - 0.5 * self.k_vv, self.k_uv);
        let spread = libm::hypot(half_difference, mixed);
        let [cos, sin] = match spread > 0.0 {
            true => [half_difference / spread, mixed / spread],
            false => [1.0, 0.0],
        };
        let [min, max] =
            [-0.5, 0.5].map(|half| std([0.5 + half * cos, 0.5 - half * cos, 2.0 * half * sin]));
        let across = std([-0.5 * sin, 0.5 * sin, cos]);
        if spread > SIGNIFICANT_SPREAD * across {
            return [min, max, 0.5 * across / spread];
        }
        let beyond_mean = std([0.5, 0.5, 0.0]) + spread / NORMAL_95;
        [
            min.max(beyond_mean),
            max.max(beyond_mean),
            UNKNOWN_DIRECTION_STD,
        ]
    }

    /// Normal curvature (1/length) in the tangent direction at `angle_rad` from `u` towards `v`.
    pub fn normal_curvature(&self, angle_rad: f64) -> f64 {
        let (sin, cos) = libm::sincos(angle_rad);
        self.along(&Vector2::new(cos, sin))
    }

    pub(crate) fn along(&self, unit: &Vector2<f64>) -> f64 {
        self.k_uu * unit.x * unit.x
            + 2.0 * self.k_uv * unit.x * unit.y
            + self.k_vv * unit.y * unit.y
    }
}

/// The eight classes of surface points, defined by the signs of Gaussian curvature K and mean curvature H.
///
/// |        | K > 0 | K = 0  | K < 0         |
/// |--------|-------|--------|---------------|
/// | H > 0  | peak  | ridge  | saddle ridge  |
/// | H = 0  |       | flat   | minimal       |
/// | H < 0  | pit   | valley | saddle valley |
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, Ord, PartialEq, PartialOrd)]
#[strum(serialize_all = "kebab-case")]
pub enum ShapeClass {
    /// Convex in all directions: K > 0, H > 0.
    Peak,
    /// Convex in one direction and straight across it: K = 0, H > 0.
    Ridge,
    /// More convex than concave: K < 0, H > 0.
    SaddleRidge,
    /// Without curvature: K = 0, H = 0.
    Flat,
    /// As convex as concave: K < 0, H = 0.
    Minimal,
    /// Concave in all directions: K > 0, H < 0.
    Pit,
    /// Concave in one direction and straight across it: K = 0, H < 0.
    Valley,
    /// More concave than convex: K < 0, H < 0.
    SaddleValley,
}

impl ShapeClass {
    /// All eight classes: row by row, as in the table of [`ShapeClass`].
    pub const ALL: [Self; 8] = [
        Self::Peak,
        Self::Ridge,
        Self::SaddleRidge,
        Self::Flat,
        Self::Minimal,
        Self::Pit,
        Self::Valley,
        Self::SaddleValley,
    ];

    /// The kebab-case name of the class in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Thresholds below which Gaussian curvature K and mean curvature H count as zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeThresholds {
    gaussian: f64,
    mean: f64,
}

/// Errors of thresholds that [`ShapeThresholds::new`] rejects.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum InvalidThresholds {
    /// A threshold is negative or not finite.
    #[error(
        "{name} threshold is {value}; it must be finite and at least 0",
        value = Number(*value)
    )]
    OutOfRange {
        /// Name of the threshold: `gaussian` or `mean`.
        name: &'static str,
        /// Value of the threshold.
        value: f64,
    },
    /// With these thresholds, some points would belong to the class `K > 0`, `H = 0`, which no surface point can have.
    #[error(
        "gaussian threshold {gaussian} is below the square of the mean threshold {mean}{}; \
         then the impossible class K > 0, H = 0 appears",
        square(*mean),
        gaussian = Number(*gaussian),
        mean = Number(*mean)
    )]
    ImpossibleClass {
        /// Threshold (1/length²) of the Gaussian curvature.
        gaussian: f64,
        /// Threshold (1/length) of the mean curvature.
        mean: f64,
    },
}

/// The square of `number` as the text ` ({number²})` for a message; empty if it overflows.
fn square(number: f64) -> String {
    let square = number * number;
    match square.is_finite() {
        true => format!(" ({})", Number(square)),
        false => String::new(),
    }
}

impl ShapeThresholds {
    /// Thresholds up to which curvatures count as zero: Gaussian curvatures K with `|K| <= gaussian` (1/length²), and
    /// mean curvatures H with `|H| <= mean` (1/length).
    ///
    /// # Errors
    /// [`InvalidThresholds`] unless both are finite, at least 0, and `gaussian >= mean²`. The last condition is needed
    /// because `K <= H²` on a surface: a smaller Gaussian threshold would allow points with `K > 0` and `H = 0`.
    pub fn new(gaussian: f64, mean: f64) -> Result<Self, InvalidThresholds> {
        for (name, value) in [("gaussian", gaussian), ("mean", mean)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(InvalidThresholds::OutOfRange { name, value });
            }
        }
        // The tolerance is needed because of rounding errors: in doubles, 0.1² is not exactly 0.01.
        if gaussian < mean * mean * (1.0 - 4.0 * f64::EPSILON) {
            return Err(InvalidThresholds::ImpossibleClass { gaussian, mean });
        }
        Ok(Self { gaussian, mean })
    }

    /// Largest absolute Gaussian curvature (1/length²) that counts as zero.
    pub const fn gaussian(&self) -> f64 {
        self.gaussian
    }

    /// Largest absolute mean curvature (1/length) that counts as zero.
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// The class of a point from its Gaussian curvature (1/length²) and mean curvature (1/length), both finite. Noise
    /// can make `K` larger than `H²`, which is impossible on a surface. In this case, `H²` is used instead of `K`.
    ///
    /// ```
    /// use palpate_geometry::{ShapeClass, ShapeThresholds};
    ///
    /// let thresholds = ShapeThresholds::new(0.01, 0.1)?;
    /// // Outside of a sphere of radius 2, inside of a cylinder of radius 2, a sphere of radius 100.
    /// assert_eq!(thresholds.classify(0.25, 0.5), ShapeClass::Peak);
    /// assert_eq!(thresholds.classify(0.0, -0.25), ShapeClass::Valley);
    /// assert_eq!(thresholds.classify(1e-4, 0.01), ShapeClass::Flat);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn classify(&self, gaussian_curvature: f64, mean_curvature: f64) -> ShapeClass {
        let gaussian = gaussian_curvature.min(mean_curvature * mean_curvature);
        let sign =
            |value: f64, threshold: f64| i8::from(value > threshold) - i8::from(value < -threshold);
        match (
            sign(mean_curvature, self.mean),
            sign(gaussian, self.gaussian),
        ) {
            (1, 1) => ShapeClass::Peak,
            (1, 0) => ShapeClass::Ridge,
            (1, _) => ShapeClass::SaddleRidge,
            (0, -1) => ShapeClass::Minimal,
            (0, _) => ShapeClass::Flat,
            (_, 1) => ShapeClass::Pit,
            (_, 0) => ShapeClass::Valley,
            (_, _) => ShapeClass::SaddleValley,
        }
    }
}
