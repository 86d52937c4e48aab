//! Requests of a study beside its tables: plots that can be drawn, and claims that somebody made.

use palpate_report::{Files, figure, is_claim};
use palpate_scene::quantities_of;
use palpate_study::config::{ConfigError, PlotConfig, PlotKind, SceneConfig, Study};
use palpate_sweep::{CellStatistics, Summary};

use crate::facts::Facts;
use crate::tables::{self, Row};

/// Refuses a study that asks for what it cannot have: a plot of its table that will not be drawn whatever the trials
/// give, in the words in which drawing it would fail, and a claim that nobody made.
///
/// A long axis is looked at in some of its values only; what hangs on the numbers that the trials give shows when the
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
/// let error = palpate::refuse(&palpate::parse("a-ball.toml", text)?).expect_err("no such quantity");
/// assert_eq!(error.path(), "plot.0.quantity");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ConfigError`] at the plot or the claim.
pub fn refuse(study: &Study) -> Result<(), ConfigError> {
    for (place, &claim) in study.config.claims.iter().enumerate() {
        if !is_claim(claim) {
            let message = format!("there is no claim {claim}");
            return Err(study.error_beside(&format!("claims.{place}"), message));
        }
    }
    refuse_stop(study)?;
    for (place, plot) in study.config.plot.iter().enumerate() {
        if plot.kind == PlotKind::Lines {
            draw(study, place, plot)?;
        }
    }
    Ok(())
}

/// Refuses a rule that watches a quantity which some cell does not have.
fn refuse_stop(study: &Study) -> Result<(), ConfigError> {
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
        for &number in study.sample() {
            known(&study.cell(number)?.config.scene)?;
        }
    }
    Ok(())
}

/// Draws a plot of a table that has numbers of no trials.
fn draw(study: &Study, place: usize, plot: &PlotConfig) -> Result<(), ConfigError> {
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
    // Such rows may be told apart by numbers that only trials give.
    let tells_by_numbers = plot.where_.len() < all;
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
    if tells_by_numbers && message.starts_with("several rows") {
        return Ok(());
    }
    // The key that the message opens with, if any.
    let key = message.split(" = ").next().unwrap_or_default();
    let keys = ["x", "y", "quantity", "series", "panels", "compare", "where"];
    let path = match keys.contains(&key) {
        true => format!("plot.{place}.{key}"),
        false => format!("plot.{place}"),
    };
    Err(study.error_beside(&path, message))
}

/// Table of cells as their run would write it, but with numbers that only tell rows apart.
fn table(study: &Study, numbers: &[usize]) -> Result<String, ConfigError> {
    let mut rows: Vec<(usize, Facts, CellStatistics)> = Vec::new();
    let mut value = 0.0;
    for &number in numbers {
        let cell = study.cell(number)?;
        let quantities = quantities_of(&cell.config.scene);
        let trials = cell.config.trials;
        let facts = Facts::bare(&cell, quantities);
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
        rows.push((number, facts, statistics));
    }
    let rows = rows.iter().map(|(cell, facts, statistics)| Row {
        cell: *cell,
        facts,
        statistics,
    });
    let states_bounds = tables::states_bounds(study);
    Ok(tables::cells(study, &rows.collect::<Vec<_>>(), states_bounds).to_csv())
}
