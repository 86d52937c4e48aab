//! Goodness of fit: how likely chance alone leaves as much unexplained.

/// Chi-squared of a fit against what noise of the stated size leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum of the squares of what the fit leaves of the readings and of prior knowledge, in standard deviations.
    pub chi_squared: f64,
    /// Degrees of freedom: readings that count and priors, less unknowns.
    pub freedom: usize,
    /// Probability that normally distributed noise of the stated size leaves a chi-squared at least as large where the
    /// model holds: uniform from 0 to 1 there, and small where the readings contradict the model or the noise. 1 without
    /// degrees of freedom.
    pub p_value: f64,
}

impl GoodnessOfFit {
    pub(crate) fn new(chi_squared: f64, freedom: usize) -> Self {
        Self {
            chi_squared,
            freedom,
            p_value: tail(chi_squared, freedom),
        }
    }
}

/// Probability that chi-squared with `freedom` degrees of freedom is larger (Abramowitz and Stegun 26.4.4 and 26.4.5).
pub(crate) fn tail(chi_squared: f64, freedom: usize) -> f64 {
    let half = 0.5 * chi_squared;
    if freedom == 0 || half <= 0.0 {
        return 1.0;
    }
    let is_odd = freedom % 2 == 1;
    let first = if is_odd { libm::erfc(half.sqrt()) } else { 0.0 };
    let log = libm::log(half);
    // Logarithms, since powers and exponentials overflow where their products do not.
    let term = |count: usize| {
        let power = count as f64 + if is_odd { 0.5 } else { 0.0 };
        libm::exp(power * log - half - libm::lgamma(power + 1.0))
    };
    let rest: f64 = (0..freedom / 2).map(term).sum();
    (first + rest).min(1.0)
}

/// Probability that a ratio of two chi-squared, each over its degrees of freedom, is larger (Paulson 1942: cube roots of
/// chi-squared are nearly normal; within 2e-3 from 8 degrees of freedom below).
pub(crate) fn tail_of_ratio(above: f64, of_above: usize, below: f64, of_below: usize) -> f64 {
    if of_above == 0 || of_below == 0 || above <= 0.0 {
        return 1.0;
    }
    let (m, n) = (of_above as f64, of_below as f64);
    let root = libm::cbrt((above / m) / (below / n));
    if !root.is_finite() {
        return 0.0;
    }
    let [of_m, of_n] = [m, n].map(|freedom| 2.0 / (9.0 * freedom));
    let off = (1.0 - of_n) * root - (1.0 - of_m);
    0.5 * libm::erfc(off / (2.0 * (of_n * root * root + of_m)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::tail;

    /// Percentage points of chi-squared, as tables print them (Abramowitz and Stegun, table 26.8).
    const POINTS: [(usize, f64, f64); 7] = [
        (1, 3.841_459, 0.05),
        (2, 9.210_340, 0.01),
        (5, 11.070_50, 0.05),
        (10, 29.588_30, 0.001),
        (30, 18.492_66, 0.95),
        (75, 96.216_67, 0.05),
        (100, 135.806_72, 0.01),
    ];

    #[test]
    fn tails_are_those_of_tables() {
        for (freedom, chi_squared, probability) in POINTS {
            let found = tail(chi_squared, freedom);
            assert!(
                (found / probability - 1.0).abs() < 1e-4,
                "{found} with {freedom}"
            );
        }
    }

    #[test]
    fn tails_of_any_numbers_are_probabilities() {
        for freedom in [0, 1, 2, 77, 100_000] {
            for chi_squared in [0.0, 1e-300, 1.0, 1e5, 1e300, f64::INFINITY] {
                let found = tail(chi_squared, freedom);
                assert!((0.0..=1.0).contains(&found), "{found}");
            }
        }
    }
}
