//! Displacements in an elastic half-space under a Hertz contact, at any depth, computed by formulas.
//!
//! The pressure under a paraboloid of radius R is p₀ √(1 − r²/a²), where a is the contact's radius. Its Hankel
//! transform is (p₀/a) (sin ka − ka cos ka)/k³. The displacements below the surface of the half-space are
//!
//! ```text
//! u_z = c [2(1−ν) Q₃⁰ + z Q₂⁰]      u_r = −c [(1−2ν) Q₃¹ − z Q₂¹]      c = 2/(π(1−ν)R)
//! Q_jᵐ = ∫ (sin ka − ka cos ka) k^{−j} e^{−kz} J_m(kr) dk
//! ```
//!
//! The integrals are functions of the complex distance √(r² + (z + ia)²) = X + iY (Huber 1904; Hanson and Johnson
//! 1993). With l₂² = X² + a² and θ = asin(a/l₂), they are
//!
//! ```text
//! Q₃⁰ = ¼ [(2a² − r² + 2z²) θ + (a² − 3Y²) X/a]     Q₂⁰ = Y − zθ     Q₁⁰ = θ − aX/(X² + Y²)
//! Q₃¹ = r [a²(a² + aY + Y²)/(3 l₂² (a + Y)) + X²Y/(2 l₂²) − zθ/2]     Q₂¹ = (r/2) [θ − aX/l₂²]
//! ```
//!
//! Derivatives follow from J₀' = −J₁, J₁' = J₀ − J₁/x and ∂(sin ka − ka cos ka)/∂a = k² a sin ka. If a is small
//! relative to the distance, these formulas suffer from cancellation, and a series in powers of a/√(r² + z²) is used
//! instead.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::body::Field;

/// Limit of the ratio of the contact's radius to the distance of a point from the middle of the contact. Below this
/// limit, the series for points far from the contact is used. The series is then exact to rounding errors.
const SERIES_RATIO: f64 = 1.0 / 12.0;

const TERMS: usize = 7;

const ORDERS: usize = 2 * TERMS + 2;

/// Number of integrals that are computed by series: Q₃⁰, Q₂⁰ and Q₁⁰ (order 0), Q₃¹, Q₂¹ and Q₁¹ (order 1), and S₁ and
/// S₀ for both orders. The fields of [`Moments`] describe these integrals.
const SERIES: usize = 10;

/// Factors in the recurrence for the Legendre polynomial P_{m+1} at z/ρ: the factor of (z/ρ) P_m and the factor of
/// P_{m−1}. Here z is the depth of the point and ρ its distance from the middle of the contact.
const RECURRENCE: [[f64; 2]; ORDERS] = {
    let mut factors = [[0.0; 2]; ORDERS];
    let mut m = 0;
    while m < ORDERS {
        let order = m as f64;
        factors[m] = [(2.0 * order + 1.0) / (order + 1.0), order / (order + 1.0)];
        m += 1;
    }
    factors
};

/// Factors of the terms of each series, without the powers of −s². Here s is the ratio of the contact's radius to the
/// distance of the point. The factors are the coefficients of sin x − x cos x = Σ (−1)ⁿ (2n+2) x^{2n+3}/(2n+3)! or of
/// sin x = Σ (−1)ⁿ x^{2n+1}/(2n+1)!, multiplied by m! or (m−1)!. In the integral, the wavenumber k has the power m.
const FACTORS: [[f64; SERIES]; TERMS] = {
    let mut factors = [[0.0; SERIES]; TERMS];
    let mut n = 0;
    while n < TERMS {
        let even = 2.0 * n as f64;
        let (first, second, third) = (even + 1.0, even + 2.0, even + 3.0);
        // Integrals with the Bessel function J₁ have the factor (m−1)! instead of m!, where m is the power of the
        // wavenumber k. Therefore divide by m = 2n, but by 1 if m is 0.
        let lower = if n == 0 { 1.0 } else { even };
        factors[n] = [
            1.0 / (first * third),
            1.0 / third,
            second / third,
            1.0 / (first * third * lower),
            1.0 / (first * third),
            1.0 / third,
            1.0 / first,
            1.0,
            1.0 / (first * lower),
            1.0 / first,
        ];
        n += 1;
    }
    factors
};

/// Lower limit of the squared distance from the contact's edge, relative to the squared contact radius. Without this
/// limit, derivatives at the edge on the surface would be infinite.
const EDGE: f64 = 1e-20;

/// Displacements of a point under a contact of radius `a > 0`, and their derivatives with respect to `r` and `a`. The
/// point is at the distance `r >= 0` from the axis and at the depth `z >= 0`.
///
/// At the edge of the contact on the surface (z = 0, r = a), the derivatives have a jump. At the edge, the result is
/// the limit from inside the contact.
#[inline(always)]
pub(crate) fn field(poisson: f64, z: f64, a: f64, r: f64) -> Field {
    let moments = if a * a < SERIES_RATIO * SERIES_RATIO * (r * r + z * z) {
        Moments::far(z, a, r)
    } else {
        Moments::near(z, a, r)
    };
    moments.field(poisson, z, a)
}

/// The integrals Q and S from which the displacements of the half-space are computed. The formula of Q is in the
/// description of this module; the fields `ring_even` and `ring_odd` state the formula of S. Integrals with the Bessel
/// function J₁ are divided by the distance r from the axis.
struct Moments {
    /// The integrals Q₃⁰, Q₂⁰ and Q₁⁰, which contain the Bessel function J₀. The description of this module contains
    /// their formula.
    even: [f64; 3],
    /// The integrals Q₃¹, Q₂¹ and Q₁¹, which contain the Bessel function J₁, divided by the distance r from the axis.
    /// The description of this module contains their formula.
    odd: [f64; 3],
    /// The integrals S₁ and S₀ of order 0: ∫ sin(ka) k^{−j} e^{−kz} J₀(kr) dk for j = 1 and j = 0.
    ring_even: [f64; 2],
    /// The integrals S₁ and S₀ of order 1, divided by r: ∫ sin(ka) k^{−j} e^{−kz} J₁(kr) dk for j = 1 and j = 0.
    ring_odd: [f64; 2],
    r: f64,
}

impl Moments {
    // Inline this function, so that the compiler removes the derivatives that a caller does not use.
    #[inline(always)]
    fn near(z: f64, a: f64, r: f64) -> Self {
        let difference = (r - a) * (r + a) + z * z;
        // `size` is X² + Y², where X + iY = √(r² + (z + ia)²) is a complex distance. The point is at the depth z and at
        // the distance r from the axis, and a is the contact's radius. X² + Y² is the product of the distances from the
        // point to both ends of the contact's diameter.
        let near = (r - a) * (r - a) + z * z;
        let far = (r + a) * (r + a) + z * z;
        let size = (near * far).sqrt().max(EDGE * a * a);
        let (x, y) = if difference >= 0.0 {
            let x = (0.5 * (size + difference)).sqrt();
            (x, z * a / x)
        } else {
            let y = (0.5 * (size - difference)).sqrt();
            (z * a / y, y)
        };
        let l2 = x * x + a * a;
        let theta = if a <= x {
            libm::atan(a / x)
        } else {
            FRAC_PI_2 - libm::atan(x / a)
        };
        // `ratio` is X²/(X + z), where X is the real part of the complex distance √(r² + (z + ia)²) and z is the depth.
        // X and the ratio are 0 at the surface within the contact.
        let ratio = if x > 0.0 { x * x / (x + z) } else { 0.0 };
        let ring_odd_1 = a * a / (l2 * (a + y));
        let cosine_odd_0 = (x * ratio - y * a * a / (a + y)) / (l2 * size);
        Self {
            even: [
                0.25 * ((2.0 * (a * a + z * z) - r * r) * theta + (a * a - 3.0 * y * y) * x / a),
                y - z * theta,
                theta - a * x / size,
            ],
            odd: [
                a * a * (a * a + a * y + y * y) / (3.0 * l2 * (a + y)) + 0.5 * x * x * y / l2
                    - 0.5 * z * theta,
                0.5 * (theta - a * x / l2),
                ring_odd_1 - a * cosine_odd_0,
            ],
            ring_even: [theta, y / size],
            ring_odd: [ring_odd_1, a * x / (l2 * size)],
            r,
        }
    }

    /// Computes the integrals by a series in s = a/ρ, where ρ is the distance of the point from the middle of the
    /// contact. The series uses ∫ kᵐ e^{−kz} J₀(kr) dk = m! P_m(z/ρ)/ρ^{m+1}. With J₁ instead of J₀, the integral is
    /// (m−1)! (r/ρ) P'_m(z/ρ)/ρ^{m+1}, and for m = 0 it is r/(ρ (ρ + z)).
    fn far(z: f64, a: f64, r: f64) -> Self {
        let distance = (r * r + z * z).sqrt();
        let (cosine, s) = (z / distance, a / distance);
        // `legendre` and `slope` are the Legendre polynomials P_m and their derivatives P'_m, computed by recurrences.
        let (mut legendre, mut slope) = ([0.0; ORDERS], [0.0; ORDERS]);
        legendre[0] = 1.0;
        legendre[1] = cosine;
        slope[1] = 1.0;
        for m in 1..ORDERS - 1 {
            let [last, before] = RECURRENCE[m];
            legendre[m + 1] = last * cosine * legendre[m] - before * legendre[m - 1];
            slope[m + 1] = slope[m - 1] + (2 * m + 1) as f64 * legendre[m];
        }
        slope[0] = 1.0 / (1.0 + cosine);
        // Horner's scheme evaluates the series in powers of −s², where s is the contact radius divided by the distance.
        let mut sums = [0.0; SERIES];
        for (n, factors) in FACTORS.iter().enumerate().rev() {
            let ([p_0, p_1, p_2], [q_0, q_1, q_2]) = (
                [0, 1, 2].map(|more| legendre[2 * n + more]),
                [0, 1, 2].map(|more| slope[2 * n + more]),
            );
            let terms = [p_0, p_1, p_2, q_0, q_1, q_2, p_0, p_1, q_0, q_1];
            for (sum, (factor, term)) in sums.iter_mut().zip(factors.iter().zip(terms)) {
                *sum = factor * term - s * s * *sum;
            }
        }
        let (d, cube) = (distance, s * s * s);
        Self {
            even: [cube * d * d * sums[0], cube * d * sums[1], cube * sums[2]],
            odd: [cube * d * sums[3], cube * sums[4], cube / d * sums[5]],
            ring_even: [s * sums[6], s / d * sums[7]],
            ring_odd: [s / d * sums[8], s / (d * d) * sums[9]],
            r,
        }
    }

    #[inline(always)]
    fn field(&self, poisson: f64, z: f64, a: f64) -> Field {
        let Self {
            even,
            odd,
            ring_even,
            ring_odd,
            r,
        } = *self;
        let scale = 2.0 / (PI * (1.0 - poisson));
        let (normal, radial) = (2.0 * (1.0 - poisson), 1.0 - 2.0 * poisson);
        Field {
            normal: scale * (normal * even[0] + z * even[1]),
            normal_per_r: -scale * r * (normal * odd[1] + z * odd[2]),
            normal_per_a: scale * a * (normal * ring_even[0] + z * ring_even[1]),
            radial: -scale * r * (radial * odd[0] - z * odd[1]),
            radial_per_r: -scale * (radial * (even[1] - odd[0]) - z * (even[2] - odd[1])),
            radial_per_a: -scale * r * a * (radial * ring_odd[0] - z * ring_odd[1]),
        }
    }
}

/// Oblate spheroidal coordinates ξ and η of a point under a contact of radius a. The depth is z = aξη, and the distance
/// from the axis is r = a √((1 + ξ²)(1 − η²)). The coordinate ξ is 0 on the contact and increases with the distance
/// from the contact. The coordinate η is 0 on the surface around the contact and 1 on the axis.
///
/// The complex distance √(r² + (z + ia)²) is a(ξ + iη).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spheroidal {
    pub(crate) xi: f64,
    pub(crate) eta: f64,
    /// The number 1 − η². It is stored separately, because its computation from η near 1 would suffer from
    /// cancellation.
    pub(crate) off_axis: f64,
    pub(crate) r: f64,
    /// The sum ξ² + η² of the squared coordinates. It is 0 at the edge of the contact.
    pub(crate) edge: f64,
}

impl Spheroidal {
    /// The coordinates of the point at the depth `z` and the distance `r` from the axis. The squares of the ratios of
    /// the three lengths must be finite.
    pub(crate) fn new(a: f64, z: f64, r: f64) -> Self {
        let (z, r) = (z / a, r / a);
        let difference = (r - 1.0) * (r + 1.0) + z * z;
        let square = |offset: f64| offset * offset + z * z;
        let edge = square(r + 1.0).sqrt() * square(r - 1.0).sqrt();
        let (xi, eta) = if difference >= 0.0 {
            let xi = (0.5 * (edge + difference)).sqrt();
            (xi, if xi > 0.0 { z / xi } else { 0.0 })
        } else {
            let eta = (0.5 * (edge - difference)).sqrt();
            (z / eta, eta)
        };
        Self {
            xi,
            eta,
            off_axis: r * r / (1.0 + xi * xi),
            r,
            edge,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// The six values of a [`Field`] as an array: first the values whose unit is length², then the values whose unit is
    /// length.
    fn parts(field: &Field) -> [f64; 6] {
        [
            field.normal,
            field.radial,
            field.normal_per_r,
            field.normal_per_a,
            field.radial_per_r,
            field.radial_per_a,
        ]
    }

    #[test]
    fn series_and_closed_form_agree_where_they_meet() {
        for poisson in [0.0, 0.3, 0.5] {
            for angle in [0.0_f64, 0.01, 0.7, 1.5, 1.57] {
                let (a, distance) = (SERIES_RATIO, 1.0);
                let (z, r) = (distance * libm::cos(angle), distance * libm::sin(angle));
                let near = Moments::near(z, a, r).field(poisson, z, a);
                let far = Moments::far(z, a, r).field(poisson, z, a);
                for (near, far) in parts(&near).into_iter().zip(parts(&far)) {
                    assert_relative_eq!(near, far, epsilon = 1e-14, max_relative = 2e-11);
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_field() {
        let step = 1e-5;
        for poisson in [0.0, 0.3, 0.5] {
            for (z, a, r) in [
                (2.0, 4.5, 0.3),
                (2.0, 4.5, 4.5),
                (0.0, 3.0, 1.0),
                (0.0, 3.0, 4.0),
                (0.5, 1.0, 30.0),
                (2.0, 0.01, 1.0),
            ] {
                let at = |a, r| field(poisson, z, a, r);
                let exact = at(a, r);
                let by_r = (at(a, r + step), at(a, r - step));
                let step_a = step * a;
                let by_a = (at(a + step_a, r), at(a - step_a, r));
                let slope = |high: f64, low: f64, step: f64| (high - low) / (2.0 * step);
                for (exact, found) in [
                    (
                        exact.normal_per_r,
                        slope(by_r.0.normal, by_r.1.normal, step),
                    ),
                    (
                        exact.radial_per_r,
                        slope(by_r.0.radial, by_r.1.radial, step),
                    ),
                    (
                        exact.normal_per_a,
                        slope(by_a.0.normal, by_a.1.normal, step_a),
                    ),
                    (
                        exact.radial_per_a,
                        slope(by_a.0.radial, by_a.1.radial, step_a),
                    ),
                ] {
                    assert_relative_eq!(exact, found, epsilon = 1e-9, max_relative = 1e-6);
                }
            }
        }
    }

    #[test]
    fn numbers_stay_numbers_at_the_extremes() {
        let sizes = [0.0, f64::MIN_POSITIVE, 1e-50, 1e-9, 1.0, 1e9, 1e50];
        for z in sizes {
            for a in &sizes[2..] {
                for r in sizes {
                    let found = field(0.5, z, *a, r);
                    let sound = parts(&found).iter().all(|part| part.is_finite());
                    assert!(sound, "z {z:e} a {a:e} r {r:e}: {found:?}");
                }
            }
        }
    }
}
