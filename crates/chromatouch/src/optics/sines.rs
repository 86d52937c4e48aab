//! Sines and cosines as polynomials.

/// Terms of the series of sine and cosine.
const TERMS: usize = 9;

/// sin θ / θ and cos θ of an angle up to half a turn, from θ². Even functions: no root is needed. From the power
/// series at θ/2, whose first term left out is below 1e-12.
#[inline]
pub(super) fn sinc_and_cosine(angle_squared: f64) -> (f64, f64) {
    let half_squared = 0.25 * angle_squared;
    let (mut sinc, mut cosine) = (1.0, 1.0);
    for term in (1..TERMS).rev() {
        let even = 2.0 * term as f64;
        cosine = 1.0 - cosine * half_squared * (1.0 / ((even - 1.0) * even));
        sinc = 1.0 - sinc * half_squared * (1.0 / (even * (even + 1.0)));
    }
    // Double angle: sin θ = 2 sin(θ/2) cos(θ/2), cos θ = 1 − 2 sin²(θ/2).
    (sinc * cosine, 1.0 - 2.0 * half_squared * sinc * sinc)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_sine_and_cosine_up_to_half_a_turn() {
        for step in 1..=1000 {
            let angle = f64::from(step) * 1e-3 * std::f64::consts::PI;
            let (sinc, cosine) = sinc_and_cosine(angle * angle);
            assert!((sinc * angle - angle.sin()).abs() < 2e-12, "{angle}");
            assert!((cosine - angle.cos()).abs() < 2e-12, "{angle}");
        }
        assert_eq!(sinc_and_cosine(0.0), (1.0, 1.0));
    }
}
