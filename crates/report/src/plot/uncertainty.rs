//! 95 % intervals of statistics. They are computed from the Monte Carlo error: the standard error that is due to the
//! limited number of trials.

use crate::Table;
use palpate_study::{Quantity, QuantityKind, Statistic};

pub(crate) const BARS: &str =
    "Bars: 95 % intervals of the Monte Carlo error. Bars shorter than their marker are not drawn.";
const HALF_WIDTH: f64 = 1.96;

pub(crate) fn normal(value: f64, error: f64) -> [f64; 2] {
    [value - HALF_WIDTH * error, value + HALF_WIDTH * error]
}

/// Ends of the 95 % interval of the statistic `name` in `row`, in the unit of the table. The interval comes from the
/// Monte Carlo error of the trials. `None` for fewer than two trials, for a statistic without Monte Carlo error, and
/// for the mean of the reported standard deviations, because the table does not contain their scatter.
///
/// If a trial observes several points of a patch, the errors at these points are not independent. Therefore the
/// intervals of rms errors, mean absolute errors and shares of points count each trial once. The intervals of other
/// statistics are too wide: they are computed as if all points of a trial had the same error.
pub(crate) fn interval(table: &Table, row: usize, name: &str) -> Option<[f64; 2]> {
    let statistic = Statistic::named(name)?;
    let of = |statistic: Statistic| table.statistic(row, statistic.name());
    let value = of(statistic)?;
    let trials = of(Statistic::Trials)?;
    let successes = trials - of(Statistic::Failures)?;
    if successes < 2.0 {
        return None;
    }
    let is_share = Quantity::named(table.quantity(row))
        .is_some_and(|quantity| quantity.kind == QuantityKind::Share);
    let error = match statistic {
        Statistic::RmsError => of(Statistic::RmsErrorStd)?,
        Statistic::RelativeRmsError => {
            value * ratio(of(Statistic::RmsErrorStd)?, of(Statistic::RmsError)?)
        }
        Statistic::MeanAbsError => of_mean_size(of(Statistic::RmsError)?, value, successes),
        Statistic::RelativeMeanAbsError => {
            let mean = of(Statistic::MeanAbsError)?;
            value
                * ratio(
                    of_mean_size(of(Statistic::RmsError)?, mean, successes),
                    mean,
                )
        }
        // For a share of correctly classified points, the squared error at a point is 0 or 1. So the mean square error
        // is the share of wrong points, and has the same standard error as the share of correct points.
        Statistic::Mean | Statistic::Bias if is_share => {
            2.0 * of(Statistic::RmsError)? * of(Statistic::RmsErrorStd)?
        }
        Statistic::Mean | Statistic::Bias => of(Statistic::Std)? / successes.sqrt(),
        Statistic::Std => of_std(value, of(Statistic::Bias)?, &of, successes)?,
        Statistic::Q05 | Statistic::Q50 | Statistic::Q95 => {
            let spread = of(Statistic::Q95)? - of(Statistic::Q05)?;
            let per_spread = match statistic {
                Statistic::Q50 => MEDIAN_PER_SPREAD,
                _ => TAIL_PER_SPREAD,
            };
            per_spread * spread / successes.sqrt()
        }
        Statistic::Coverage50 | Statistic::Coverage80 | Statistic::Coverage95 => {
            return of_share(value, successes);
        }
        Statistic::Failures => {
            return of_share(value / trials, trials).map(|ends| ends.map(|share| share * trials));
        }
        Statistic::Truth
        | Statistic::Trials
        | Statistic::RmsErrorStd
        | Statistic::MeanReportedStd
        | Statistic::StdBound => return None,
    };
    let ends = normal(value, error);
    ends.iter().all(|end| end.is_finite()).then_some(ends)
}

/// Factor in the standard error of the median of n normally distributed numbers. The standard error is this factor
/// times s/√n, where s is the distance between the 5 % and the 95 % quantile.
const MEDIAN_PER_SPREAD: f64 = 0.381;
/// Factor in the standard error of the 5 % or 95 % quantile of n normally distributed numbers. The standard error is
/// this factor times s/√n, where s is the distance between these two quantiles.
const TAIL_PER_SPREAD: f64 = 0.642;

fn ratio(error: f64, of: f64) -> f64 {
    if of > 0.0 { error / of } else { 0.0 }
}

/// Standard error of the mean of the absolute values of `count` errors. `mean` is the mean absolute value, and `rms` is
/// the root mean square of the errors.
fn of_mean_size(rms: f64, mean: f64, count: f64) -> f64 {
    ((rms * rms - mean * mean).max(0.0) / count).sqrt()
}

/// Standard error of a standard deviation. If the bias of the estimates is at most half of `std`, the result is
/// computed from the standard error of their rms error. Otherwise, the result is computed as if the estimates were
/// normally distributed. `None` if the table lacks the rms error or its standard error.
fn of_std(std: f64, bias: f64, of: &impl Fn(Statistic) -> Option<f64>, count: f64) -> Option<f64> {
    if bias.abs() > 0.5 * std || std == 0.0 {
        return Some(std / (2.0 * (count - 1.0)).sqrt());
    }
    let of_square = 2.0 * of(Statistic::RmsError)? * of(Statistic::RmsErrorStd)?;
    let of_bias = 4.0 * bias * bias * std * std / count;
    Some((of_square * of_square - of_bias).max(0.0).sqrt() / (2.0 * std))
}

/// Wilson's 95 % interval of a share; `None` if `share` is not between 0 and 1.
fn of_share(share: f64, count: f64) -> Option<[f64; 2]> {
    if !(0.0..=1.0).contains(&share) {
        return None;
    }
    let squared = HALF_WIDTH * HALF_WIDTH / count;
    let middle = share + 0.5 * squared;
    let half = (squared * (share * (1.0 - share) + 0.25 * squared))
        .max(0.0)
        .sqrt();
    let [low, high] = [middle - half, middle + half].map(|end| end / (1.0 + squared));
    // Rounding errors could move an end of the interval beyond the share itself. Clamp the ends, so that the interval
    // contains the share.
    Some([low.clamp(0.0, share), high.clamp(share, 1.0)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Files;

    /// The interval of the statistic `of` in a table with one row; `None` if the statistic has no interval. `columns`
    /// are the statistics in this row, with their values. If they do not contain the number of trials, the row has 100
    /// trials.
    fn found(quantity: &str, columns: &[(Statistic, f64)], of: Statistic) -> Option<[f64; 2]> {
        let names = Statistic::ALL.map(Statistic::name).join(",");
        let texts = Statistic::ALL.map(|statistic| {
            let given = columns.iter().find(|(one, _)| *one == statistic);
            match (given, statistic) {
                (Some((_, value)), _) => value.to_string(),
                (None, Statistic::Trials) => "100".to_owned(),
                (None, Statistic::Failures) => "0".to_owned(),
                _ => String::new(),
            }
        });
        let text = format!(
            "cell,quantity,unit,{names}\n0,{quantity},1/mm,{}\n",
            texts.join(",")
        );
        let table = Table::read(&Files::in_memory([("cells.csv", text)])).unwrap();
        interval(&table, 0, of.name())
    }

    fn is(found: Option<[f64; 2]>, middle: f64, half: f64) {
        let [low, high] = found.unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(
            close(low, middle - half) && close(high, middle + half),
            "{low} {high}"
        );
    }

    #[test]
    fn errors_have_the_intervals_of_their_formulas() {
        use Statistic as S;
        let errors = [
            (S::RmsError, 0.5),
            (S::RmsErrorStd, 0.02),
            (S::RelativeRmsError, 5.0),
            (S::MeanAbsError, 0.4),
            (S::RelativeMeanAbsError, 4.0),
            (S::Std, 0.5),
            (S::Bias, 0.0),
            (S::Mean, 2.0),
        ];
        let found = |statistic| found("mean_curvature", &errors, statistic);
        is(found(S::RmsError), 0.5, 1.96 * 0.02);
        is(found(S::RelativeRmsError), 5.0, 1.96 * 0.2);
        // For 100 trials with the rms error 0.5 and the mean absolute error 0.4, the standard error of the mean
        // absolute error is √(0.5² − 0.4²)/√100 = 0.03.
        is(found(S::MeanAbsError), 0.4, 1.96 * 0.03);
        is(found(S::RelativeMeanAbsError), 4.0, 1.96 * 0.3);
        is(found(S::Mean), 2.0, 1.96 * 0.05);
        // Without a bias, the standard deviation equals the rms error, and their standard errors are equal too.
        is(found(S::Std), 0.5, 1.96 * 0.02);
        for none in [S::Truth, S::MeanReportedStd, S::Coverage95] {
            assert_eq!(found(none), None);
        }
    }

    #[test]
    fn shares_stay_shares() {
        use Statistic as S;
        // If p is the share of correctly classified points, the mean square error is 1 − p. The standard error of the
        // mean square error is twice the rms error times the standard error of the rms error.
        let right = [(S::Mean, 0.91), (S::RmsError, 0.3), (S::RmsErrorStd, 0.01)];
        is(found("class", &right, S::Mean), 0.91, 1.96 * 0.006);
        let all = found("class", &[(S::Coverage95, 1.0)], S::Coverage95).unwrap();
        assert!(all[0] > 0.96 && all[0] < 0.97 && all[1] == 1.0, "{all:?}");
        let failures = found("class", &[(S::Failures, 50.0)], S::Failures).unwrap();
        assert!((failures[0] - 40.4).abs() < 0.1 && (failures[1] - 59.6).abs() < 0.1);
    }

    #[test]
    fn impossible_numbers_have_no_interval() {
        use Statistic as S;
        for share in [4.0, -0.1, 1e300] {
            assert_eq!(
                found("class", &[(S::Coverage80, share)], S::Coverage80),
                None
            );
            assert_eq!(
                found("class", &[(S::Failures, -share.abs())], S::Failures),
                None
            );
        }
        // A standard error needs at least two trials.
        for gone in [99.0, 100.0] {
            let columns = [
                (S::Failures, gone),
                (S::RmsError, 1.0),
                (S::RmsErrorStd, 1.0),
            ];
            assert_eq!(found("class", &columns, S::RmsError), None);
        }
        let huge = [(S::RmsError, 1e308), (S::RmsErrorStd, 1e308)];
        assert_eq!(found("mean_curvature", &huge, S::RmsError), None);
        let zero = [
            (S::RmsError, 0.0),
            (S::RmsErrorStd, 0.0),
            (S::RelativeRmsError, 0.0),
        ];
        is(
            found("mean_curvature", &zero, S::RelativeRmsError),
            0.0,
            0.0,
        );
    }
}
