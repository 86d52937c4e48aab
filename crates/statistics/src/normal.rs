//! The normal distribution.

/// Largest score that [`score_of_tail`] returns, in standard deviations of the normal distribution. The probability
/// that a normal variable exceeds this score is below 1e-300, practically 0.
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

/// The score (a number of standard deviations) that a standard normal variable exceeds with the probability
/// `probability`. The absolute error of the score is at most 1e-12. The score is between −[`CERTAIN`] and [`CERTAIN`].
/// For a probability that rounds to 1, and for NaN, it is −[`CERTAIN`].
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
