//! Scores of statements such as "the estimated quantity is at most the limit". A score z expresses a probability: the
//! statement is true with the probability Φ(z), where Φ is the distribution function of the standard normal
//! distribution.

use palpate_statistics::{CERTAIN, NORMAL_95};

/// Score of the statement that an estimate meets its limit. `margin` is the distance of the estimate from the limit; it
/// is negative if the estimate misses the limit. `std` is the standard error of the estimate, with `degrees` degrees of
/// freedom.
///
/// Wallace's approximation (1959) converts Student's t to the normal score with the same probability. Its error is at
/// most 1 % for at least 5 degrees of freedom. If `std` is 0, the score is the largest possible one, with the sign of
/// the margin; a margin of 0 counts as positive.
pub(crate) fn student(margin: f64, std: f64, degrees: f64) -> f64 {
    let side = if margin >= 0.0 { 1.0 } else { -1.0 };
    let t = margin.abs() / std;
    if std == 0.0 || t == f64::INFINITY {
        return side * CERTAIN;
    }
    if t.is_nan() {
        return 0.0;
    }
    let shrunk = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0);
    // `grown` is ln(1 + t²/ν), where t is the margin in standard errors and ν the degrees of freedom. For large t it is
    // computed without t², which may overflow.
    let grown = match t < 1e150 {
        true => libm::log1p(t * t / degrees),
        false => 2.0 * libm::log(t) - libm::log(degrees),
    };
    side * (shrunk * (degrees * grown).sqrt()).min(CERTAIN)
}

/// Score of the statement that an event has at most the probability `limit`, which is in (0, 1). The event occurred in
/// `count` of `of` independent trials. The score is the square root of the deviance (twice the log-likelihood ratio),
/// with a continuity correction of half a trial. It is negative if the event was more frequent than `limit`. Without
/// trials, the score is 0.
///
/// ```
/// // No failure in 256 trials: P = 0.95²⁵⁶ = 2.0e-6, which is a score of 4.6.
/// assert!((palpate_sweep::share_at_most(0, 256, 0.05) - 4.7).abs() < 0.1);
/// assert!(palpate_sweep::share_at_most(30, 256, 0.05) < -4.0);
/// ```
pub fn share_at_most(count: u64, of: u64, limit: f64) -> f64 {
    let (all, expected) = (of as f64, limit * of as f64);
    let side = if count as f64 <= expected { 1.0 } else { -1.0 };
    let corrected = count as f64 + 0.5 * side;
    // If `count` differs from the expected count by less than half a trial, the trials do not show whether the
    // probability of the event is above or below `limit`. Then the score is 0.
    if of == 0 || (corrected - expected) * side >= 0.0 {
        return 0.0;
    }
    let share = corrected / all;
    let term = |share: f64, limit: f64| match share > 0.0 {
        true => share * libm::log(share / limit),
        false => 0.0,
    };
    let deviance = term(share, limit) + term(1.0 - share, 1.0 - limit);
    side * (2.0 * all * deviance.max(0.0)).sqrt().min(CERTAIN)
}

/// Wilson's 95 % interval (1927) of the probability of an event. The event occurred in the share `share` of `of`
/// independent trials. Without trials, the interval is from 0 to 1.
pub(crate) fn wilson(share: f64, of: f64) -> (f64, f64) {
    if !(of > 0.0 && share.is_finite()) {
        return (0.0, 1.0);
    }
    let squared = NORMAL_95 * NORMAL_95;
    let about = (share + squared / (2.0 * of)) / (1.0 + squared / of);
    let spread = share * (1.0 - share) / of + squared / (4.0 * of * of);
    let half = NORMAL_95 * spread.max(0.0).sqrt() / (1.0 + squared / of);
    // Rounding errors could move an end of the interval beyond `share`. Clamp the ends, so that the interval contains
    // `share`.
    (
        (about - half).clamp(0.0, share),
        (about + half).clamp(share, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use palpate_statistics::score_of_tail;

    use super::*;

    #[test]
    fn students_t_has_the_normal_score_of_its_probability() {
        // Each entry contains the degrees of freedom, a number t, and the probability P(T > t) for a variable T with
        // Student's distribution. The probabilities are from published tables.
        for (degrees, t, probability) in [
            (31.0, 1.695_519, 0.05),
            (31.0, 2.039_513, 0.025),
            (31.0, 2.452_824, 0.01),
            (31.0, 3.374_900, 0.001),
            (5.0, 4.032_143, 0.005),
        ] {
            let score = student(t, 1.0, degrees);
            assert!(
                (score - score_of_tail(probability)).abs() < 0.012,
                "{degrees} {t}: {score}"
            );
            assert_eq!(student(-t, 1.0, degrees), -score);
        }
        assert_eq!(student(0.0, 0.0, 31.0), CERTAIN);
        assert_eq!(student(-1e-300, 0.0, 31.0), -CERTAIN);
        assert!(student(1e300, 1e-300, 31.0) > 30.0);
        assert_eq!(student(f64::NAN, 1.0, 31.0), 0.0);
    }

    /// P(X ≤ count) for a binomial variable X, computed as a sum. X is the number of successes in `of` trials that
    /// succeed with the probability `share`.
    fn binomial(count: u64, of: u64, share: f64) -> f64 {
        let (n, mut term, mut sum) = (of as f64, libm::pow(1.0 - share, of as f64), 0.0);
        for k in 0..=count {
            sum += term;
            let k = k as f64;
            term *= (n - k) / (k + 1.0) * share / (1.0 - share);
        }
        sum
    }

    #[test]
    fn scores_of_shares_are_those_of_binomial_sums() {
        for (of, limit) in [
            (64, 0.05),
            (256, 0.05),
            (4096, 0.05),
            (256, 0.5),
            (256, 0.01),
        ] {
            for count in 0..of {
                let score = share_at_most(count, of, limit);
                let exact = match (count as f64) <= limit * of as f64 {
                    true => score_of_tail(binomial(count, of, limit)),
                    false => -score_of_tail(1.0 - binomial(count - 1, of, limit)),
                };
                if exact.abs() < 6.0 && exact.abs() > 1.0 {
                    assert!(
                        (score - exact).abs() < 0.2,
                        "{count} of {of}: {score} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn intervals_hold_the_share_and_stay_within_0_and_1() {
        for share in [0.0, 1e-9, 0.3, 0.999, 1.0] {
            for of in [1e-3, 1.0, 7.0, 1e6, 1e300] {
                let (low, high) = wilson(share, of);
                assert!(
                    0.0 <= low && low <= share && share <= high && high <= 1.0,
                    "{share} {of}"
                );
            }
        }
        assert_eq!(wilson(f64::NAN, 5.0), (0.0, 1.0));
    }
}
