//! `cells.csv` and `failures.csv`.

use anyhow::Error;
use palpate_scene::Scene;
use palpate_scene::config::{STATISTICS, STD_BOUND, Study};
use palpate_sweep::{CellStatistics, Summary};

/// A cell that was run: its number in the study, its scene and what came out.
pub(crate) struct Ran<'a> {
    pub(crate) cell: usize,
    pub(crate) scene: &'a Scene,
    pub(crate) statistics: &'a CellStatistics,
}

/// One row per cell and quantity. Presses have a bound on the standard deviation behind the
/// statistics.
///
/// Where the number of trials is swept, the statistic of that name is its column.
pub(crate) fn cells(study: &Study, ran: &[Ran<'_>]) -> Result<String, Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let fixed = ["quantity", "unit"];
    let swept: Vec<usize> = (0..study.paths.len())
        .filter(|&place| !STATISTICS.contains(&study.paths[place].as_str()))
        .collect();
    let columns = swept.iter().map(|&place| study.columns[place].as_str());
    let of_presses = ran.iter().any(|ran| matches!(ran.scene, Scene::Press(_)));
    writer.write_record(
        ["cell"]
            .into_iter()
            .chain(columns)
            .chain(fixed)
            .chain(STATISTICS)
            .chain(of_presses.then_some(STD_BOUND)),
    )?;
    for Ran {
        cell,
        scene,
        statistics,
    } in ran
    {
        let quantities = scene.quantities().iter().zip(&statistics.quantities);
        for (place, (quantity, summary)) in quantities.enumerate() {
            let index = cell.to_string();
            let unit = quantity.unit.of(study.config.length_unit);
            // Where every trial failed, the scene still knows.
            let truth = summary.truth.or_else(|| scene.truth(place));
            let statistics = statistics_of(statistics, &Summary { truth, ..*summary });
            let bound = of_presses.then(|| number(scene.std_bound(place)));
            let coordinates = &study.cells[*cell].coordinates;
            let row = [index.as_str()]
                .into_iter()
                .chain(swept.iter().map(|&place| coordinates[place].as_str()))
                .chain([quantity.name, &unit])
                .chain(statistics.iter().map(String::as_str))
                .chain(bound.as_deref());
            writer.write_record(row)?;
        }
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A number, zero without a sign; empty where there is none.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| (value + 0.0).to_string())
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
        number(truth),
        cell.trials.to_string(),
        cell.failed().to_string(),
    ];
    texts.extend(
        [
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
        ]
        .map(number),
    );
    texts
}

/// One row per cell and kind of failure.
pub(crate) fn failures(ran: &[Ran<'_>]) -> Result<String, Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["cell", "kind", "count", "first_trial"])?;
    for Ran {
        cell, statistics, ..
    } in ran
    {
        for failure in &statistics.failures {
            let numbers = [*cell as u64, failure.count, failure.first_trial].map(|n| n.to_string());
            let [cell, count, first] = numbers.each_ref().map(String::as_str);
            writer.write_record([cell, failure.kind, count, first])?;
        }
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
