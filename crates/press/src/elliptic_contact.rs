//! Frictionless contact between a rigid object with two different principal curvatures and an elastic half-space, with
//! displacements at any depth.
//!
//! The gap between the bodies is A x² + B y², where A ≤ B are half the relative principal curvatures. The contact is an
//! ellipse with the semi-axes a ≥ b under the pressure p₀ √(1 − x²/a² − y²/b²) (Johnson 1985, §4.2). In terms of
//! Carlson's integrals,
//!
//! ```text
//! δ = P ab R_F(0, a², b²)     A = P ab R_D(0, b², a²)/3     B = P ab R_D(0, a², b²)/3     P = p₀/E*
//! ```
//!
//! which are also exact for a round contact. The displacements follow from Boussinesq's potentials ψ = ∫ p/ρ and χ = ∫
//! p ln(ρ + z):
//!
//! ```text
//! u_z = [2(1−ν)ψ − z ψ_z]/(2π(1−ν)E*)      u_x = −[z ψ_x + (1−2ν) χ_x]/(2π(1−ν)E*)
//! ψ = (π ab p₀/2) ∫_λ^∞ [1 − x²/(a²+s) − y²/(b²+s) − z²/s] ds/√((a²+s)(b²+s)s)
//! ```
//!
//! λ is the largest root of x²/(a²+λ) + y²/(b²+λ) + z²/λ = 1. χ_x is −∫_z^∞ ψ_x dz. After exchanging the order of the
//! integrals, and with the substitution s = m + 1/v + h²v, which makes the square root rational, it is the integral of
//! a rational function of v.

use std::num::NonZeroUsize;
use std::sync::LazyLock;

use gauss_quad::GaussLegendre;

use crate::{MarkerDisplacement, PressError};

/// Largest ratio of the relative principal curvatures. If the ratio is larger, the contact is practically a line, and
/// the indentation depends on the unknown length of the line.
const MAX_CURVATURE_RATIO: f64 = 1e6;

/// Displacements are set to 0 if the distance from the contact exceeds this multiple of the contact's longer semi-axis.
const MAX_DISTANCE: f64 = 1e50;

/// Number of panels (intervals) into which the quadrature of the integral χ_x is divided; the module's description
/// defines χ_x. Each panel is half as long as the previous panel, because the integrand may have a peak at the end of
/// the last panel.
const PANELS: i32 = 12;

/// Number of Gauss quadrature nodes in each panel.
const NODES: NonZeroUsize = NonZeroUsize::new(12).expect("not 0");

static PANEL: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let rule = GaussLegendre::new(NODES);
    rule.iter().map(|(node, weight)| [*node, *weight]).collect()
});

/// An elliptic contact. Its x axis is the longer axis of the ellipse, which is the direction of the smaller relative
/// curvature.
///
/// ```
/// use palpate_press::EllipticContact;
///
/// // Equal curvatures: the radius of Hertz's contact is √(δ/C).
/// let contact = EllipticContact::new(0.5, [0.25, 0.25], 1.0)?;
/// assert!((contact.semi_axes[0] - 2.0).abs() < 1e-12);
/// assert!((contact.displacement(1.0, 0.0, 0.0).normal - 0.875).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipticContact {
    /// Relative principal curvatures (1/length), the smaller one first.
    pub relative_curvatures: [f64; 2],
    /// Distance (length) by which the bodies have approached each other since they first touched.
    pub indentation: f64,
    /// Semi-axes (length) of the contact area, the longer one first.
    pub semi_axes: [f64; 2],
    /// Pressure in the middle of the contact, divided by the effective modulus E/(1 − ν²).
    pub peak_pressure: f64,
    poisson: f64,
}

impl EllipticContact {
    /// The elliptic contact for given relative principal curvatures and a given indentation. A relative principal
    /// curvature is 1/R_s + κ (1/length), where R_s is the sensor's radius and κ a principal curvature of the object.
    /// The smaller one comes first.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] if Poisson's ratio `poisson` is outside [0, 0.5]. The same error if the curvatures
    /// are not in order, not between 1e-50 and 1e50, or have a ratio above 1e6. [`PressError::NoIndentation`] if the
    /// indentation is not positive.
    pub fn new(
        poisson: f64,
        relative_curvatures: [f64; 2],
        indentation: f64,
    ) -> Result<Self, PressError> {
        let good = (0.0..=0.5).contains(&poisson);
        PressError::unless_good("poisson", poisson, good, "from 0 to 0.5")?;
        let [smaller, larger] = relative_curvatures;
        let good = (1e-50..=1e50).contains(&smaller);
        PressError::unless_good("relative_curvature", smaller, good, "from 1e-50 to 1e50")?;
        let good = (smaller..=(MAX_CURVATURE_RATIO * smaller).min(1e50)).contains(&larger);
        let right = "at least the smaller one and at most 1e6 times it";
        PressError::unless_good("larger_relative_curvature", larger, good, right)?;
        if !(indentation > 0.0 && indentation <= 1e50) {
            return Err(PressError::NoIndentation { indentation });
        }
        let ratio = axis_ratio(larger / smaller);
        let square = ratio * ratio;
        // The longer semi-axis a follows from A/δ = R_D(0, b², a²)/(3 R_F(0, a², b²)). Here A is half of the smaller
        // curvature, δ the indentation and b the shorter semi-axis. R_D and R_F are Carlson's elliptic integrals,
        // computed with a as the unit of length.
        let [first, size] = [carlson_d(0.0, square, 1.0), carlson_f(0.0, 1.0, square)];
        let a = (indentation / (0.5 * smaller) * first / (3.0 * size)).sqrt();
        Ok(Self {
            relative_curvatures,
            indentation,
            semi_axes: [a, ratio * a],
            peak_pressure: indentation / (ratio * a * size),
            poisson,
        })
    }

    /// Geometric mean (length) of the contact's semi-axes.
    pub(crate) fn radius(&self) -> f64 {
        let [long, short] = self.semi_axes;
        long.sqrt() * short.sqrt()
    }

    /// Force between the bodies: 2π a b p₀/3, with the semi-axes a and b and the peak pressure p₀. `young` is the
    /// Young's modulus of the soft body. The unit of the force is the unit of `young` times length².
    pub fn force(&self, young: f64) -> f64 {
        let [long, short] = self.semi_axes;
        2.0 / 3.0 * std::f64::consts::PI * long * short * self.pressure(young)
    }

    /// Pressure in the middle of the contact, in the unit of `young`, the Young's modulus of the soft body.
    pub fn pressure(&self, young: f64) -> f64 {
        young * self.peak_pressure / (1.0 - self.poisson * self.poisson)
    }

    /// The displacement of the point (x, y) at the depth `z` ≥ 0. The x axis is the longer axis of the ellipse, and the
    /// tangential displacement is along x and y. All lengths must be below 1e50.
    pub fn displacement(&self, x: f64, y: f64, z: f64) -> MarkerDisplacement {
        let [a, b] = self.semi_axes;
        // From here on, lengths are in units of the longer semi-axis.
        let [x, y, z, b] = [x / a, y / a, z / a, b / a];
        let distance = x.abs() + y.abs() + z;
        if distance.is_nan() || distance > MAX_DISTANCE {
            return MarkerDisplacement::default();
        }
        let (square_x, square_y, square_z) = (x * x, y * y, z * z);
        let lambda = confocal(b * b, square_x, square_y, square_z);
        let (long, short) = (1.0 + lambda, b * b + lambda);
        // `by_x`, `by_y` and `by_z` are 2/3 of Carlson's integral R_D for each axis. They give the derivatives of the
        // pressure's potential ψ. For example, ∂ψ/∂x is −π P a b x `by_x`, with the peak pressure P and the semi-axes a
        // and b.
        let by_x = 2.0 / 3.0 * carlson_d(short, lambda, long);
        let by_y = 2.0 / 3.0 * carlson_d(long, lambda, short);
        let by_z = if lambda > 0.0 {
            2.0 / 3.0 * carlson_d(long, short, lambda)
        } else {
            0.0
        };
        let potential = carlson_f(long, short, lambda)
            - 0.5 * (square_x * by_x + square_y * by_y + square_z * by_z);
        let (normal, radial) = (2.0 * (1.0 - self.poisson), 1.0 - 2.0 * self.poisson);
        let [mut along_x, mut along_y] = [z * by_x, z * by_y];
        if radial > 0.0 {
            let edge = if lambda > 0.0 {
                z * (long * short / lambda).sqrt()
            } else {
                (b * b - b * b * square_x - square_y).max(0.0).sqrt()
            };
            let [first, second] = rational_integrals(b * b, square_x, square_y, lambda, edge);
            along_x -= radial * (first - z * by_x);
            along_y -= radial * (second - z * by_y);
        }
        let scale = self.peak_pressure * a * b / (2.0 * (1.0 - self.poisson));
        MarkerDisplacement {
            normal: scale * (normal * potential + square_z * by_z),
            tangential: [scale * x * along_x, scale * y * along_y],
        }
    }
}

/// The ratio b/a of the contact's semi-axes, computed from the ratio (≥ 1) of the relative principal curvatures. The
/// equation is solved for the logarithm of b/a, first by bisection and then by secant steps.
fn axis_ratio(curvatures: f64) -> f64 {
    if curvatures <= 1.0 {
        return 1.0;
    }
    let target = libm::log(curvatures);
    let excess = |log_ratio: f64| {
        let square = libm::exp(2.0 * log_ratio);
        libm::log(carlson_d(0.0, 1.0, square) / carlson_d(0.0, square, 1.0)) - target
    };
    // If k ≥ 1 is the ratio of the relative principal curvatures, the ratio of the semi-axes lies between 1/k and 1/√k.
    let (mut low, mut high) = (-target, -0.5 * target);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    libm::exp(0.5 * (low + high))
}

/// The largest root λ of x²/(1 + λ) + y²/(b² + λ) + z²/λ = 1, where b is the shorter semi-axis. In the contact area, λ
/// is 0. Lengths are in units of the longer semi-axis.
fn confocal(square_b: f64, x: f64, y: f64, z: f64) -> f64 {
    if z == 0.0 && x + y / square_b <= 1.0 {
        return 0.0;
    }
    // The left side of the equation x²/(1 + λ) + y²/(b² + λ) + z²/λ = 1 is convex and decreases with λ. Therefore
    // Newton steps from below never go beyond the root.
    let mut lambda = z
        .max(x + y + z - 1.0)
        .max(y - square_b)
        .max(x - 1.0)
        .max(0.0);
    for _ in 0..200 {
        let [u, v] = [x / (1.0 + lambda), y / (square_b + lambda)];
        let w = if z > 0.0 { z / lambda } else { 0.0 };
        let slope =
            u / (1.0 + lambda) + v / (square_b + lambda) + if z > 0.0 { w / lambda } else { 0.0 };
        let step = (u + v + w - 1.0) / slope;
        if step.is_nan() || step <= 1e-16 * lambda {
            break;
        }
        lambda += step;
    }
    lambda
}

/// Returns two integrals over s from λ to ∞. Let A = 1, B = b² (`square_b`) and Q(s) = (A+s)(B+s) − x²(B+s) − y²(A+s).
/// The first integrand is √Q/((A+s)²(B+s)), and the second is √Q/((A+s)(B+s)²). In this function, the arguments `x` and
/// `y` are the squares x² and y². `edge` is √Q(λ).
fn rational_integrals(square_b: f64, x: f64, y: f64, lambda: f64, edge: f64) -> [f64; 2] {
    let middle = 0.5 * (x + y - 1.0 - square_b);
    let product = square_b - square_b * x - y;
    let h = (0.25 * (middle * middle - product)).max(0.0);
    let [alpha, beta] = [1.0 + middle, square_b + middle];
    let end = 2.0 / (lambda - middle + edge);
    let integrand = |v: f64| {
        let square = h * v * v;
        let [first, second] = [1.0 + alpha * v + square, 1.0 + beta * v + square];
        let shared = (1.0 - square) * (1.0 - square) / (first * second);
        [shared / first, shared / second]
    };
    let mut sums = [0.0; 2];
    let mut start = 0.0;
    for panel in 1..=PANELS {
        let stop = if panel == PANELS {
            end
        } else {
            end * (1.0 - libm::exp2(f64::from(-panel)))
        };
        let half = 0.5 * (stop - start);
        for [node, weight] in PANEL.iter() {
            let [first, second] = integrand(start + half * (1.0 + node));
            sums[0] += half * weight * first;
            sums[1] += half * weight * second;
        }
        start = stop;
    }
    sums
}

/// Limit of the relative deviations of the three arguments of Carlson's integrals from their mean. Below this limit,
/// the integrals are computed by series, which are then exact to rounding errors.
const DUPLICATED: f64 = 2e-3;

/// Carlson's R_F(x, y, z) by duplication (Carlson 1979). The arguments must be ≥ 0, and at most one of them may be 0.
fn carlson_f(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    loop {
        let mean = (x + y + z) / 3.0;
        let [dx, dy, dz] = [1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean];
        if dx.abs().max(dy.abs()).max(dz.abs()) < DUPLICATED {
            let [second, third] = [dx * dy - dz * dz, dx * dy * dz];
            let series = (second / 24.0 - 0.1 - 3.0 / 44.0 * third) * second + third / 14.0;
            return (1.0 + series) / mean.sqrt();
        }
        let shift = (x * y).sqrt() + (y * z).sqrt() + (z * x).sqrt();
        [x, y, z] = [x, y, z].map(|argument| 0.25 * (argument + shift));
    }
}

/// Carlson's R_D(x, y, z) by duplication. z must be > 0, x and y ≥ 0, and at most one of x and y may be 0.
fn carlson_d(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    let (mut sum, mut factor) = (0.0, 1.0);
    loop {
        let mean = 0.2 * (x + y + 3.0 * z);
        let [dx, dy, dz] = [1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean];
        if dx.abs().max(dy.abs()).max(dz.abs()) < DUPLICATED {
            let [product, square] = [dx * dy, dz * dz];
            let [difference, sixth] = [product - square, product - 6.0 * square];
            let last = sixth + 2.0 * difference;
            let series = sixth * (-3.0 / 14.0 + 9.0 / 88.0 * sixth - 4.5 / 26.0 * dz * last)
                + dz * (last / 6.0 + dz * (-9.0 / 22.0 * difference + 3.0 / 26.0 * dz * product));
            return 3.0 * sum + factor * (1.0 + series) / (mean * mean.sqrt());
        }
        let shift = (x * y).sqrt() + (y * z).sqrt() + (z * x).sqrt();
        sum += factor / (z.sqrt() * (z + shift));
        factor *= 0.25;
        [x, y, z] = [x, y, z].map(|argument| 0.25 * (argument + shift));
    }
}
