//! `cells.csv` and `failures.csv`.

use palpate_study::config::{STATISTICS, STD_BOUND, Study};
use palpate_study::{Table, number};
use palpate_sweep::{CellStatistics, Summary};

use crate::facts::Facts;

/// Cell that was run: its number in the study, facts about its scene and what came out.
pub(crate) struct Row<'a> {
    pub(crate) cell: usize,
    pub(crate) facts: &'a Facts,
    pub(crate) statistics: &'a CellStatistics,
}

/// Table with one row per cell and quantity. Presses have a bound on the standard deviation behind the
/// statistics.
///
/// Where the number of trials is swept, the statistic of that name is its column.
pub(crate) fn cells(study: &Study, ran: &[Row<'_>]) -> Table {
    let swept: Vec<usize> = (0..study.paths.len())
        .filter(|&place| !STATISTICS.contains(&study.paths[place].as_str()))
        .collect();
    let columns = swept.iter().map(|&place| study.columns[place].as_str());
    let states_bounds = ran.iter().any(|ran| ran.facts.states_bounds);
    let header = ["cell"]
        .into_iter()
        .chain(columns)
        .chain(["quantity", "unit"])
        .chain(STATISTICS)
        .chain(states_bounds.then_some(STD_BOUND));
    let mut table = Table::new(header.map(str::to_owned));
    for Row {
        cell,
        facts,
        statistics,
    } in ran
    {
        let quantities = facts.quantities.iter().zip(&statistics.quantities);
        for (place, (quantity, summary)) in quantities.enumerate() {
            // Where every trial failed, the scene still knows.
            let truth = summary.truth.or(facts.truths[place]);
            let statistics = statistics_of(statistics, &Summary { truth, ..*summary });
            let mut row = vec![cell.to_string()];
            row.extend(swept.iter().map(|&place| facts.coordinates[place].clone()));
            let unit = quantity.unit.of(study.config.length_unit);
            row.extend([quantity.name.to_owned(), unit.to_string()]);
            row.extend(statistics);
            row.extend(states_bounds.then(|| optional(facts.std_bounds[place])));
            table.rows.push(row);
        }
    }
    table
}

/// Text of a number; empty where there is none.
fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// The statistics of a quantity, in the order of [`STATISTICS`].
fn statistics_of(cell: &CellStatistics, summary: &Summary) -> Vec<String> {
    let Summary {
        observations: _,
        truth,
        mean,
        std,
        bias,
        rms_error,
        mean_abs_error,
        relative_rms_error,
        relative_mean_abs_error,
        q05,
        q50,
        q95,
        mean_reported_std,
        coverage95,
    } = *summary;
    let mut texts = vec![
        optional(truth),
        cell.trials.to_string(),
        cell.failed().to_string(),
    ];
    // Without a spread they are the one estimate that there was.
    let quantile = |value| match q05 == q95 {
        true => value,
        false => with_digits(value, truth),
    };
    texts.extend(
        [
            mean,
            std,
            bias,
            rms_error,
            mean_abs_error,
            relative_rms_error,
            relative_mean_abs_error,
            quantile(q05),
            quantile(q50),
            quantile(q95),
            mean_reported_std,
            coverage95,
        ]
        .map(optional),
    );
    texts
}

/// Quantile with the digits that it has: its distance to the truth is right to one part in 256, and the last digit is that
/// in which such a part begins.
fn with_digits(quantile: Option<f64>, truth: Option<f64>) -> Option<f64> {
    let (value, error) = (quantile?, (quantile? - truth?).abs());
    if value == 0.0 || error == 0.0 {
        return quantile;
    }
    let place = |number: f64| {
        let text = format!("{number:e}");
        text.split_once('e')
            .and_then(|(_, place)| place.parse::<i32>().ok())
    };
    let digits = place(value)? - place(error / 256.0)?;
    match usize::try_from(digits) {
        Ok(digits) => format!("{value:.digits$e}").parse().ok(),
        Err(_) => Some(0.0),
    }
}

/// Table with one row per cell and kind of failure.
pub(crate) fn failures(ran: &[Row<'_>]) -> Table {
    let mut table = Table::new(["cell", "kind", "count", "first_trial"].map(str::to_owned));
    for Row {
        cell, statistics, ..
    } in ran
    {
        let rows = statistics.failures.iter().map(|failure| {
            let [count, first] = [failure.count, failure.first_trial].map(|n| n.to_string());
            vec![cell.to_string(), failure.kind.to_owned(), count, first]
        });
        table.rows.extend(rows);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::with_digits;

    #[test]
    fn quantiles_have_the_digits_that_their_histogram_tells() {
        for (quantile, truth, shown) in [
            // A part in 256 of 0.0023456 is 9e-6.
            (0.0356789, 0.0333333, 0.035679),
            (-755.306_709, -80.0, -755.0),
            (1234.5678, 1234.5, 1234.5678),
            (0.001, 80.0, 0.0),
            (80.0, 80.0, 80.0),
            (0.0, 80.0, 0.0),
        ] {
            assert_eq!(with_digits(Some(quantile), Some(truth)), Some(shown));
        }
        assert_eq!(with_digits(None, Some(1.0)), None);
        assert_eq!(with_digits(Some(1.0), None), None);
    }
}
