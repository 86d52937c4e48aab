//! Makes the contents of the files that a run writes: `cells.csv`, `failures.csv`, the table of trials, and
//! `run.toml`.

use std::fmt::{Display, Write};

use palpate_scene::map_table_of;
use palpate_study::config::{LengthUnit, SceneConfig, Study, to_toml};
use palpate_study::number::Shortest;
use palpate_study::{Column, Quantity, Statistic, Table, push_row};

use palpate_sweep::{CellStatistics, Summary, TrialObservations};

use crate::columns::swept_column;
use crate::simulation::CellTruth;

pub(crate) fn failure_columns() -> Vec<Column> {
    let counts = ["count", "first_trial"].map(Column::count);
    let first = [Column::count("cell"), Column::text("kind")];
    first.into_iter().chain(counts).collect()
}

/// Columns of all tables that a run may write: the tables of cells, failures and trials, and the map if the scene has
/// one.
pub fn result_columns(study: &Study) -> Vec<Column> {
    let map = map_table_of(&study.config.scene, study.config.length_unit);
    let map = map.map_or_else(|_| Vec::new(), |map| map.columns);
    [
        columns(study, true),
        failure_columns(),
        trial_columns(),
        map,
    ]
    .concat()
}

pub(crate) struct Row<'a> {
    pub(crate) cell: usize,
    pub(crate) truth: &'a CellTruth,
    pub(crate) statistics: &'a CellStatistics,
}

/// Whether `cells.csv` has a column for the lower bound on the standard deviation of the estimates. It has this column
/// if at least one cell is a press.
pub(crate) fn states_bounds(study: &Study) -> bool {
    let is_press = |scene: &SceneConfig| matches!(scene, SceneConfig::Press(_));
    // A sweep of one of these two fields may change the kind of the scene. No other field can.
    let sets_kind = |path: &String| path == "scene" || path == "scene.kind";
    let mut sample = study.sample.iter();
    is_press(&study.config.scene)
        || study.paths.iter().any(sets_kind)
            && sample.any(|&number| {
                let cell = study.cell(number);
                cell.is_ok_and(|cell| is_press(&cell.config.scene))
            })
}

/// Indices of the swept fields that have their own column in the tables. A swept number of trials has no own column,
/// because the column `trials` already contains this number.
fn swept(study: &Study) -> impl Iterator<Item = usize> + '_ {
    (0..study.paths.len()).filter(|&place| Statistic::named(&study.paths[place]).is_none())
}

pub(crate) fn columns(study: &Study, states_bounds: bool) -> Vec<Column> {
    let statistic = |name| match name {
        Statistic::Trials | Statistic::Failures => Column::count(name.name()),
        share if share.is_number() => Column::number(share.name(), "1"),
        other => in_unit_of_row(other.name()),
    };
    [Column::count("cell")]
        .into_iter()
        .chain(swept(study).map(|place| swept_column(study, place)))
        .chain(["quantity", "unit"].map(Column::text))
        .chain(Statistic::ALL.map(statistic))
        .chain(states_bounds.then(|| in_unit_of_row(Statistic::StdBound.name())))
        .collect()
}

/// Column of numbers with different units. The unit of each number is in the column `unit` of the same row.
fn in_unit_of_row(name: &str) -> Column {
    Column::number(name, Column::UNIT_OF_ROW)
}

/// Table with one row per cell and quantity. If `states_bounds` is true, the last column is the lower bound on the
/// standard deviation of the estimates.
pub(crate) fn cells(study: &Study, ran: &[Row<'_>], states_bounds: bool) -> Table {
    let mut table = Table::new(columns(study, states_bounds));
    let mut add = |fields: &[String]| table.rows.push(fields.to_vec());
    for row in ran {
        cell_rows(study, row, states_bounds, &mut add);
    }
    table
}

pub(crate) fn cells_csv(study: &Study, ran: &Row<'_>, states_bounds: bool) -> String {
    let mut text = String::new();
    cell_rows(study, ran, states_bounds, &mut |fields| {
        push_row(&mut text, fields)
    });
    text
}

/// Fields of the current row of a table. The next row uses the memory of these fields again.
#[derive(Default)]
struct Fields {
    fields: Vec<String>,
    used: usize,
}

impl Fields {
    fn text(&mut self, text: impl Display) {
        if self.used == self.fields.len() {
            self.fields.push(String::new());
        }
        let field = &mut self.fields[self.used];
        field.clear();
        // Ignore the result, because writing to a string cannot fail.
        let _ = write!(field, "{text}");
        self.used += 1;
    }

    /// Adds a number as text; `None` becomes an empty field.
    fn number(&mut self, value: Option<f64>) {
        match value {
            Some(value) => self.text(Shortest(value)),
            None => self.text(""),
        }
    }
}

/// Makes the rows of a cell, one for each quantity, and passes each row to `take`.
fn cell_rows(study: &Study, ran: &Row<'_>, states_bounds: bool, take: &mut dyn FnMut(&[String])) {
    let (cell_truth, statistics) = (&ran.truth, &ran.statistics);
    let mut row = Fields::default();
    let quantities = cell_truth.quantities.iter().zip(&statistics.quantities);
    for (place, (quantity, summary)) in quantities.enumerate() {
        row.used = 0;
        row.text(ran.cell);
        swept(study).for_each(|place| row.text(&cell_truth.coordinates[place]));
        row.text(quantity.name);
        row.text(quantity.unit.of(study.config.length_unit));
        // If every trial failed, no trial has a true value. Then use the true value that was computed for the cell.
        let truth = summary.truth.or(cell_truth.truths[place]);
        push_statistics(&mut row, statistics, &Summary { truth, ..*summary });
        if states_bounds {
            row.number(cell_truth.std_bounds[place]);
        }
        take(&row.fields[..row.used]);
    }
}

/// Adds the statistics of a quantity to a row, in the order of [`Statistic::ALL`].
fn push_statistics(row: &mut Fields, cell: &CellStatistics, summary: &Summary) {
    row.number(summary.truth);
    row.text(cell.trials);
    row.text(cell.failed());
    // Quantiles are rounded to the resolution of their histogram. They are also limited to the range from the smallest
    // to the largest estimate. If all estimates are equal, all quantiles are therefore equal and exact, so keep all
    // digits.
    let quantile = |value| match summary.q05 == summary.q95 {
        true => value,
        false => with_digits(value, summary.truth),
    };
    for value in [
        summary.mean,
        summary.std,
        summary.bias,
        summary.rms_error,
        summary.rms_error_std,
        summary.mean_abs_error,
        summary.relative_rms_error,
        summary.relative_mean_abs_error,
        quantile(summary.q05),
        quantile(summary.q50),
        quantile(summary.q95),
        summary.mean_reported_std,
        summary.coverage50,
        summary.coverage80,
        summary.coverage95,
    ] {
        row.number(value);
    }
}

/// Rounds a quantile to the digits that are significant. Quantiles come from a histogram. Its resolution at a quantile
/// is 1/256 of the distance between the quantile and the true value. The last kept digit has the decimal place of the
/// first digit of this resolution.
fn with_digits(quantile: Option<f64>, truth: Option<f64>) -> Option<f64> {
    let (value, error) = (quantile?, (quantile? - truth?).abs());
    if value == 0.0 || error == 0.0 {
        return quantile;
    }
    let digits = decimal_place(value)? - decimal_place(error / 256.0)?;
    match usize::try_from(digits) {
        Ok(digits) => format!("{value:.digits$e}").parse().ok(),
        Err(_) => Some(0.0),
    }
}

pub(crate) fn trial_columns() -> Vec<Column> {
    let counts = ["cell", "trial"].map(Column::count);
    (counts.into_iter())
        .chain(["quantity", "unit"].map(Column::text))
        .chain(["estimate", "truth", "std"].map(in_unit_of_row))
        .chain([Column::text("failure")])
        .collect()
}

/// Adds the rows of a trial to a CSV text: one row per estimate or, if the trial failed, one row with the kind of the
/// failure.
pub(crate) fn push_trial(
    text: &mut String,
    (cell, trial): (usize, u64),
    quantities: &[Quantity],
    length_unit: LengthUnit,
    observed: Result<&TrialObservations<'_>, &'static str>,
) {
    // Names and units contain no characters that need quotation marks. The results of writing to a string are ignored,
    // because they cannot be errors.
    let observed = match observed {
        Ok(observed) => observed,
        Err(kind) => {
            let _ = writeln!(text, "{cell},{trial},,,,,,{kind}");
            return;
        }
    };
    for (place, quantity) in quantities.iter().enumerate() {
        for observation in observed.of(place) {
            let (name, unit) = (quantity.name, quantity.unit.of(length_unit));
            let [estimate, truth] = [observation.estimate, observation.truth].map(Shortest);
            let _ = write!(text, "{cell},{trial},{name},{unit},{estimate},{truth},");
            if let Some(std) = observation.std {
                let _ = write!(text, "{}", Shortest(std));
            }
            text.push_str(",\n");
        }
    }
}

/// Power of ten of the first digit of a number: −2 for 0.0345. `None` for 0.
fn decimal_place(number: f64) -> Option<i32> {
    // Compare the number with powers of ten, because this is fast. If it is very close to one of them, use its decimal
    // text instead.
    const POWERS: [f64; 19] = [
        1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6,
        1e7, 1e8, 1e9,
    ];
    const CLOSE: f64 = 1e-12;
    let magnitude = number.abs();
    let above = POWERS.partition_point(|&power| power <= magnitude);
    if (1..POWERS.len()).contains(&above)
        && magnitude < POWERS[above] * (1.0 - CLOSE)
        && magnitude > POWERS[above - 1] * (1.0 + CLOSE)
    {
        return Some(above as i32 - 10);
    }
    let text = format!("{number:e}");
    let (_, place) = text.split_once('e')?;
    place.parse().ok().filter(|_| number != 0.0)
}

pub(crate) fn failures(ran: &[Row<'_>]) -> Table {
    let mut table = Table::new(failure_columns());
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

/// Contents of `run.toml`: the config of a study with all defaults, and the version of palpate. If `run.toml` is used
/// as the config of a new run, this run writes the same tables, byte for byte.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let resolved = palpate::resolved(&palpate::parse("a-ball.toml", text)?);
/// assert!(resolved.contains("seed = 0") && resolved.contains("crate_version"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resolved(study: &Study) -> String {
    let mut config = study.config.clone();
    config.crate_version = Some(env!("CARGO_PKG_VERSION").to_owned());
    to_toml(&config)
}

#[cfg(test)]
mod tests {
    use super::with_digits;

    #[test]
    fn quantiles_have_the_digits_that_their_histogram_resolves() {
        let shown = |quantile, truth| with_digits(Some(quantile), Some(truth));
        // The histogram resolves 1/256 of the distance from the true value. Here, the distance is 0.0023456, and
        // 1/256 of it is 9e-6, so six decimals remain.
        assert_eq!(shown(0.0356789, 0.0333333), Some(0.035679));
        assert_eq!(shown(-755.306_709, -80.0), Some(-755.0));
        assert_eq!(shown(1234.5678, 1234.5), Some(1234.5678));
        assert_eq!(shown(0.001, 80.0), Some(0.0));
        assert_eq!(shown(80.0, 80.0), Some(80.0));
        assert_eq!(shown(0.0, 80.0), Some(0.0));
        assert_eq!(with_digits(None, Some(1.0)), None);
        assert_eq!(with_digits(Some(1.0), None), None);
    }
}
