//! Tail probabilities and quantiles of the normal, chi-squared, F and Student's t distributions.

use std::f64::consts::PI;

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

/// Probability that a chi-squared variable with `freedom` degrees of freedom is larger than `chi_squared` (Abramowitz
/// and Stegun 26.4.4 and 26.4.5). The result is 1 without degrees of freedom, and 0 if `chi_squared` is NaN. The
/// relative error of the probability is at most 1e-12 for up to 100 degrees of freedom, and at most 2e-9 for more.
///
/// ```
/// assert!((palpate_statistics::chi_squared_tail(3.841459, 1) - 0.05).abs() < 1e-7);
/// ```
pub fn chi_squared_tail(chi_squared: f64, freedom: usize) -> f64 {
    let half = 0.5 * chi_squared;
    if freedom == 0 || half <= 0.0 {
        return 1.0;
    }
    if !half.is_finite() {
        return 0.0;
    }
    if freedom > MOST_TERMS {
        return many_squares_tail(half, 0.5 * freedom as f64);
    }
    let is_odd = freedom % 2 == 1;
    let first = if is_odd { libm::erfc(half.sqrt()) } else { 0.0 };
    let power = |place: usize| place as f64 + if is_odd { 0.5 } else { 0.0 };
    let count = freedom / 2;
    let Some(last) = count.checked_sub(1) else {
        return first;
    };
    // Compute the largest term from logarithms, because its powers and exponentials may overflow although their product
    // does not. The other terms follow from the ratios of successive terms.
    let largest = last.min(half as usize);
    let peak = power(largest) * libm::log(half) - half - libm::lgamma(power(largest) + 1.0);
    let sum = |ratios: &mut dyn Iterator<Item = f64>| -> f64 {
        let terms = ratios.scan(1.0, |term, ratio| {
            *term *= ratio;
            Some(*term)
        });
        terms.take_while(|term| *term > NEGLIGIBLE).sum()
    };
    let below = sum(&mut (1..=largest).rev().map(|place| power(place) / half));
    let above = sum(&mut (largest + 1..count).map(|place| half / power(place)));
    let rest = libm::exp(peak) * (1.0 + below + above);
    (first + rest).min(1.0)
}

/// Largest number of degrees of freedom for which the exact series of the chi-squared tail is summed. For more degrees
/// of freedom, an asymptotic expansion is used.
const MOST_TERMS: usize = 1_000_000;

/// Limit for the terms of the series, as a share of the largest term. Smaller terms are omitted.
const NEGLIGIBLE: f64 = 1e-18;

/// Tail probability of chi-squared for many degrees of freedom. `half` is half of chi-squared, and `a` is half of the
/// degrees of freedom. The result is the regularised upper incomplete gamma function Q(a, half), computed by Temme's
/// uniform expansion for large `a` (DLMF 8.12.4).
fn many_squares_tail(half: f64, a: f64) -> f64 {
    let beyond = (half - a) / a;
    let square = 2.0 * (beyond - libm::log1p(beyond)).max(0.0);
    let eta = square.sqrt().copysign(beyond);
    let density = libm::exp(-0.5 * a * square);
    if density == 0.0 {
        return if beyond < 0.0 { 1.0 } else { 0.0 };
    }
    let first = -1.0 / 3.0 + eta * (1.0 / 12.0 - eta * (2.0 / 135.0 - eta / 864.0));
    let rest = (first - 1.0 / (540.0 * a)) / (2.0 * PI * a).sqrt();
    (normal_tail(eta * a.sqrt()) + density * rest).clamp(0.0, 1.0)
}

/// Tail probability of the F distribution. `above` and `below` are sums of squares with `of_above` and `of_below`
/// degrees of freedom. The result is the probability that the ratio of two chi-squared variables with these degrees of
/// freedom is larger than `above / below`. It is 1 if a number of degrees of freedom is 0. The error is at most 1e-10
/// for up to 10,000 degrees of freedom. For more degrees of freedom, the error is at most 1e-14 times the number of
/// degrees of freedom. More than 1e9 degrees of freedom are treated as 1e9.
///
/// ```
/// // 5 % of ratios with 2 and 12 degrees of freedom are above 3.8853.
/// assert!((palpate_statistics::ratio_tail(2.0 * 3.885294, 2, 12.0, 12) - 0.05).abs() < 1e-7);
/// ```
pub fn ratio_tail(above: f64, of_above: usize, below: f64, of_below: usize) -> f64 {
    if of_above == 0 || of_below == 0 || above <= 0.0 {
        return 1.0;
    }
    let [many_above, many_below] = [of_above, of_below].map(|freedom| freedom.min(MOST_FREEDOM));
    let mut ratio = above / below;
    if many_above < of_above || many_below < of_below {
        let [counted, given] = [[many_above, many_below], [of_above, of_below]]
            .map(|[above, below]| above as f64 / below as f64);
        ratio *= counted / given;
    }
    if !ratio.is_finite() {
        return 0.0;
    }
    // `share` is the sum of squares `above`, divided by the total `above + below`. Such a share has a beta
    // distribution.
    let (share, rest) = (ratio / (1.0 + ratio), 1.0 / (1.0 + ratio));
    let [a, b] = [many_below, many_above].map(|freedom| 0.5 * freedom as f64);
    // Two equivalent continued fractions give the probability. Use the fraction that converges faster.
    if rest < (a + 1.0) / (a + b + 2.0) {
        incomplete_beta([rest, share], a, b)
    } else {
        1.0 - incomplete_beta([share, rest], b, a)
    }
    .clamp(0.0, 1.0)
}

/// Largest number of degrees of freedom that is used in a computation; larger numbers are replaced by this number. With
/// more degrees of freedom, the factor xᵃ (1 − x)ᵇ of the beta distribution would lose too many digits. Its exponents a
/// and b are half the two numbers of degrees of freedom.
const MOST_FREEDOM: usize = 1_000_000_000;

/// Half-width, in standard errors, of the interval that contains the true value with the probability `probability`. The
/// standard error must be estimated from residuals with `freedom` degrees of freedom, so the half-width is a quantile
/// of Student's t distribution. The relative error of the half-width is at most 1e-9, or 1e-8 for more than 1e6 degrees
/// of freedom. The half-width is 0 for a probability of 0 or less. It is infinite if the probability is NaN or at least
/// 1, or if `freedom` is 0.
///
/// ```
/// let half_width = palpate_statistics::student_half_width(0.95, 5);
/// assert!((half_width - 2.570582).abs() < 1e-6);
/// ```
pub fn student_half_width(probability: f64, freedom: usize) -> f64 {
    let is_finite = freedom > 0 && probability < 1.0;
    if !is_finite {
        return f64::INFINITY;
    }
    if probability <= 0.0 {
        return 0.0;
    }
    if probability < STRAIGHT {
        let count = freedom.min(MOST_FREEDOM) as f64;
        let per_probability = 0.5 * count.sqrt() * libm::exp(log_beta(0.5, 0.5 * count));
        return probability * per_probability;
    }
    // The square of Student's t has an F distribution with one degree of freedom in the numerator. Therefore, the tail
    // probability of F gives the probability outside the interval.
    let is_inside =
        |width: f64| ratio_tail(width * width, 1, freedom as f64, freedom) > 1.0 - probability;
    let mut high = 1.0;
    while high < f64::MAX.sqrt() && is_inside(high) {
        high *= 2.0;
    }
    let mut low = 0.0;
    while high - low > 1e-10 * high {
        let middle = 0.5 * (low + high);
        if is_inside(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// If the probability of an interval is below this value, the density of Student's t distribution is treated as
/// constant over the interval. The relative error of the half-width is then at most 1e-11.
const STRAIGHT: f64 = 1e-6;

/// Tolerance for the continued fraction of the beta function. Each step multiplies the result by a factor. The
/// evaluation ends when this factor differs from 1 by less than the tolerance.
const CONVERGED: f64 = 1e-13;
/// Largest number of steps in which the continued fraction of the beta function is evaluated.
const MOST_FACTORS: usize = 20_000;

/// Regularised incomplete beta function I_x(a, b), computed by Lentz's algorithm (DLMF 8.17.22). The first argument is
/// the pair of x and 1 − x, because the difference 1 − x would lose digits if x is close to 1.
fn incomplete_beta([x, rest]: [f64; 2], a: f64, b: f64) -> f64 {
    let log = a * libm::log(x) + b * libm::log(rest) - log_beta(a, b);
    let front = libm::exp(log) / a;
    if front == 0.0 {
        return 0.0;
    }
    let not_zero = |number: f64| match number.abs() < f64::MIN_POSITIVE {
        true => f64::MIN_POSITIVE,
        false => number,
    };
    let mut above = 1.0;
    let mut below = not_zero(1.0 - (a + b) * x / (a + 1.0)).recip();
    let mut value = below;
    for count in 1..MOST_FACTORS {
        let m = count as f64;
        let twice = a + 2.0 * m;
        let even = m * (b - m) * x / ((twice - 1.0) * twice);
        let odd = -(a + m) * (a + b + m) * x / (twice * (twice + 1.0));
        let mut factor = 1.0;
        for coefficient in [even, odd] {
            below = not_zero(1.0 + coefficient * below).recip();
            above = not_zero(1.0 + coefficient / above);
            factor = above * below;
            value *= factor;
        }
        if (factor - 1.0).abs() < CONVERGED {
            break;
        }
    }
    front * value
}

/// For arguments x of at least this value, ln Γ(x) is computed with Stirling's series. The difference of large values
/// of `lgamma` would lose digits.
const LARGE: f64 = 20.0;

fn log_beta(a: f64, b: f64) -> f64 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if large < LARGE {
        return libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    }
    // `of_large - growth` equals ln Γ(large) − ln Γ(large + small), with an error of 1e-15.
    let sum = large + small;
    let growth = (large - 0.5) * libm::log1p(small / large) + small * libm::log(sum) - small;
    let of_large = rest_of_stirling(large) - rest_of_stirling(sum);
    if small < LARGE {
        return libm::lgamma(small) + of_large - growth;
    }
    let of_small = (small - 0.5) * libm::log(small) - small + 0.5 * libm::log(2.0 * PI);
    of_small + rest_of_stirling(small) + of_large - growth
}

/// Stirling's series for ln Γ(x), without its leading terms (x − ½) ln x − x + ½ ln 2π.
fn rest_of_stirling(x: f64) -> f64 {
    let square = 1.0 / (x * x);
    (1.0 / 12.0 - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square / 1680.0))) / x
}
