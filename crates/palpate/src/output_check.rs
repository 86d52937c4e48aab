//! Checks the outputs that a study requests: its plots, its claims and its stopping rule.

use palpate_report::{Files, figure, is_claim};
use palpate_scene::quantities_of;
use palpate_study::config::{ConfigError, PlotConfig, PlotKind, SceneConfig, Study};
use palpate_sweep::{CellStatistics, Summary};

use crate::run_files::{self, Row};
use crate::simulation::CellTruth;

/// Rejects a study that requests an impossible output. For example, a plot cannot be drawn from the study's table, or a
/// claim does not exist. Another example is a stopping rule for a quantity that the study does not have.
///
/// In a long sweep, only some values are checked. Faults that depend on the results of trials are found only when the
/// plot is drawn.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// [[plot]]
/// x = "truth"
/// y = "rms_error"
/// quantity = "radius"
/// "#;
/// let error = palpate::check_outputs(&palpate::parse("a-ball.toml", text)?).expect_err("no such quantity");
/// assert_eq!(error.path, "plot.0.quantity");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] at the impossible plot, claim or stopping rule.
pub fn check_outputs(study: &Study) -> Result<(), ConfigError> {
    for (place, &claim) in study.config.claims.iter().enumerate() {
        if !is_claim(claim) {
            let message = format!("there is no claim {claim}");
            return Err(study.error_beside(&format!("claims.{place}"), message));
        }
    }
    check_stop_rule(study)?;
    for (place, plot) in study.config.plot.iter().enumerate() {
        if plot.kind == PlotKind::Lines {
            check_plot(study, place, plot)?;
        }
    }
    Ok(())
}

fn check_stop_rule(study: &Study) -> Result<(), ConfigError> {
    let stop = study.config.stop.as_ref();
    let Some(name) = stop.and_then(|stop| stop.quantity.as_ref()) else {
        return Ok(());
    };
    let known = |scene: &SceneConfig| {
        let names: Vec<&str> = quantities_of(scene).iter().map(|one| one.name).collect();
        match names.contains(&name.as_str()) {
            true => Ok(()),
            false => {
                let (kind, names) = (scene.kind(), names.join(", "));
                let message = format!("a {kind} has no quantity {name:?} (known: {names})");
                Err(study.error_beside("stop.quantity", message))
            }
        }
    };
    known(&study.config.scene)?;
    let sets_kind =
        |path: &String| path == "scene" || path == "scene.kind" || path == "scene.object";
    if study.paths.iter().any(sets_kind) {
        for &number in &study.sample {
            known(&study.cell(number)?.config.scene)?;
        }
    }
    Ok(())
}

/// Draws a plot from a table with invented numbers. This finds faults in the plot's settings before the run.
fn check_plot(study: &Study, place: usize, plot: &PlotConfig) -> Result<(), ConfigError> {
    let is_swept = |path: &str| {
        study
            .columns
            .iter()
            .chain(&study.paths)
            .any(|swept| swept == path)
    };
    let mut plot = plot.clone();
    let all = plot.where_.len();
    plot.where_.retain(|path, _| is_swept(path));
    // The results do not exist yet, so draw the plot from invented results. Invented results cannot be filtered, so
    // omit filters on columns of results. Without such a filter, a point may have several rows, which is an error.
    // Ignore this error below, because the filter may select one of the rows.
    let filters_results = plot.where_.len() < all;
    let filters: Vec<(&str, Vec<String>)> = plot.filters().collect();
    let cells = table(study, &study.star(&filters))?;
    let name = plot.name.clone().unwrap_or(format!("plot-{}", place + 1));
    plot.name = Some(name.clone());
    let Err(error) = figure(&plot, Files::in_memory([("cells.csv", cells)])) else {
        return Ok(());
    };
    let text = error.to_string();
    let text = text.strip_prefix(&format!("run.toml: plot {name:?}: "));
    let message = text.map_or(error.to_string(), str::to_owned);
    if filters_results && message.starts_with("several rows") {
        return Ok(());
    }
    // Some messages begin with a key of the plot. In this case, report the error at this key.
    let key = message.split(" = ").next().unwrap_or_default();
    let keys = ["x", "y", "quantity", "series", "panels", "compare", "where"];
    let path = match keys.contains(&key) {
        true => format!("plot.{place}.{key}"),
        false => format!("plot.{place}"),
    };
    Err(study.error_beside(&path, message))
}

/// A table like the `cells.csv` of a run, but with invented statistics that differ from row to row.
fn table(study: &Study, numbers: &[usize]) -> Result<String, ConfigError> {
    let mut rows: Vec<(usize, CellTruth, CellStatistics)> = Vec::new();
    let mut value = 0.0;
    for &number in numbers {
        let cell = study.cell(number)?;
        let quantities = quantities_of(&cell.config.scene);
        let trials = cell.config.trials;
        let truth = CellTruth::unknown(&cell, quantities);
        let mut summary = || {
            value += 1.0;
            let value = Some(value);
            Summary {
                observations: 1,
                truth: value,
                mean: value,
                std: value,
                bias: value,
                rms_error: value,
                rms_error_std: value,
                mean_abs_error: value,
                relative_rms_error: value,
                relative_mean_abs_error: value,
                q05: value,
                q50: value,
                q95: value,
                mean_reported_std: value,
                coverage50: value,
                coverage80: value,
                coverage95: value,
            }
        };
        let statistics = CellStatistics {
            trials,
            failures: Vec::new(),
            quantities: quantities.iter().map(|_| summary()).collect(),
        };
        rows.push((number, truth, statistics));
    }
    let rows = rows.iter().map(|(cell, truth, statistics)| Row {
        cell: *cell,
        truth,
        statistics,
    });
    let states_bounds = run_files::states_bounds(study);
    Ok(run_files::cells(study, &rows.collect::<Vec<_>>(), states_bounds).to_csv())
}
