//! Sines and cosines, computed with polynomials.

const TERMS: usize = 9;

/// Coefficients of the powers of x² in cos x, starting with the constant.
const COSINE: [f64; TERMS] = series(0);

/// Coefficients of the powers of x² in sin x / x, starting with the constant.
const SINC: [f64; TERMS] = series(1);

/// Coefficients (−1)^k / (2k + odd)! of the power series of cos x (`odd` is 0) and of sin x / x (`odd` is 1).
const fn series(odd: usize) -> [f64; TERMS] {
    let mut coefficients = [1.0; TERMS];
    let mut term = 1;
    while term < TERMS {
        let last = 2 * term + odd;
        coefficients[term] = -coefficients[term - 1] / ((last - 1) * last) as f64;
        term += 1;
    }
    coefficients
}

/// sin θ / θ and cos θ for an angle θ up to half a turn, computed from θ². Both results are even functions of θ, so no
/// square root is needed. The power series are evaluated at θ/2. The first omitted term of each series is below 1e-12.
#[inline]
pub(super) fn sinc_and_cosine(angle_squared: f64) -> (f64, f64) {
    let half_squared = 0.25 * angle_squared;
    let (mut sinc, mut cosine) = (SINC[TERMS - 1], COSINE[TERMS - 1]);
    for term in (0..TERMS - 1).rev() {
        sinc = sinc * half_squared + SINC[term];
        cosine = cosine * half_squared + COSINE[term];
    }
    // Use the formulas for twice an angle: sin θ = 2 sin(θ/2) cos(θ/2), cos θ = 1 − 2 sin²(θ/2).
    (sinc * cosine, 1.0 - 2.0 * half_squared * sinc * sinc)
}

/// Arcsine of a number between −0.1 and 0.1 by its power series; the truncation error is below 1e-15.
#[inline]
pub(super) fn small_angle(sine: f64) -> f64 {
    let square = sine * sine;
    // The coefficients of the arcsine series are (2k)! / (4^k k!² (2k + 1)).
    let series = [
        1.0,
        1.0 / 6.0,
        3.0 / 40.0,
        5.0 / 112.0,
        35.0 / 1152.0,
        63.0 / 2816.0,
        231.0 / 13312.0,
    ];
    let sum = |sum, coefficient| sum * square + coefficient;
    sine * series.into_iter().rev().fold(0.0, sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_sine_and_cosine_up_to_half_a_turn() {
        for step in 1..=1000 {
            let angle = f64::from(step) * 1e-3 * std::f64::consts::PI;
            let (sinc, cosine) = sinc_and_cosine(angle * angle);
            assert!((sinc * angle - libm::sin(angle)).abs() < 2e-12, "{angle}");
            assert!((cosine - libm::cos(angle)).abs() < 2e-12, "{angle}");
        }
        assert_eq!(sinc_and_cosine(0.0), (1.0, 1.0));
    }

    #[test]
    fn small_angles_are_inverse_sines() {
        for step in -100..=100 {
            let sine = f64::from(step) * 1e-3;
            assert!(
                (small_angle(sine) - libm::asin(sine)).abs() < 1e-15,
                "{sine}"
            );
        }
    }
}
