//! The normal distribution.

/// Largest value, in standard deviations of the normal distribution, that [`score_of_tail`] returns. A statement with
/// such a score is practically certain.
pub const CERTAIN: f64 = 40.0;

/// Half-widths of the 50, 80 and 95 % intervals of the normal distribution, in standard deviations.
pub const HALF_WIDTHS: [f64; 3] = [0.674_489_750_196_081_7, 1.281_551_565_544_600_4, NORMAL_95];

/// Half-width of the 95 % interval of the normal distribution, in standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Probability that a standard normal variable exceeds `score`.
///
/// ```
/// assert!((palpate_statistics::normal_tail(1.959964) - 0.025).abs() < 1e-8);
/// assert_eq!(palpate_statistics::normal_tail(0.0), 0.5);
/// ```
pub fn normal_tail(score: f64) -> f64 {
    0.5 * libm::erfc(score * std::f64::consts::FRAC_1_SQRT_2)
}

/// The number (score) that a standard normal variable exceeds with this probability. The absolute error of the score is
/// at most 1e-12. The score is at most [`CERTAIN`]. For a probability that rounds to 1, and for NaN, the score is
/// −[`CERTAIN`].
///
/// ```
/// assert!((palpate_statistics::score_of_tail(0.025) - 1.959964).abs() < 1e-6);
/// assert!(palpate_statistics::score_of_tail(0.0) > 38.0);
/// ```
pub fn score_of_tail(probability: f64) -> f64 {
    let (mut low, mut high) = (-CERTAIN, CERTAIN);
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if normal_tail(middle) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_and_scores_are_inverse() {
        for score in [-3.0, -1.0, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 30.0] {
            let found = score_of_tail(normal_tail(score));
            assert!((found - score).abs() < 1e-8, "{score}");
        }
    }

    #[test]
    fn far_tails_keep_their_digits_and_no_probabilities_have_the_last_scores() {
        for (score, due) in [
            (1e-9, 0.499_999_999_601_057_73),
            (-1e-3, 0.500_398_942_213_911),
            (12.0, 1.776_482_112_077_679e-33),
            (37.0, 5.725_571_222_524_577e-300),
            (f64::INFINITY, 0.0),
            (f64::MIN, 1.0),
        ] {
            let found = normal_tail(score);
            assert!((found - due).abs() <= 1e-13 * due, "{score}: {found:e}");
        }
        for (probability, due, bound) in [
            (f64::NAN, -CERTAIN, 1e-12),
            (1.0, -CERTAIN, 1e-12),
            (-1.0, CERTAIN, 1e-12),
            (0.0, 39.0, 1.0),
        ] {
            let found = score_of_tail(probability);
            assert!((found - due).abs() <= bound, "{probability}: {found}");
        }
    }

    #[test]
    fn half_widths_leave_half_of_the_rest_above() {
        for (half_width, share) in HALF_WIDTHS.into_iter().zip([0.5, 0.8, 0.95]) {
            let above = normal_tail(half_width);
            assert!((1.0 - 2.0 * above - share).abs() < 1e-15, "{share}");
        }
    }
}
