//! Tasks with rolls, and with estimates from rolls (EP1).

use std::hint::black_box;

use anyhow::{Context, Result};
use palpate_geometry::Shape;
use palpate_rolling::Roller;

use super::Figure;
use crate::workloads::unit_rolls::{self, Chart, Ep1, Model, motion, paraboloid, roller, sphere};

const LONG_RAD: f64 = 6.0;
const SHORT_RAD: f64 = 0.1;
/// Tolerances that are tried for the integrator DOP853, largest first.
const TOLERANCES: [f64; 16] = [
    1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 3e-12, 1e-12, 3e-13,
    1e-13, 3e-14,
];
/// Largest allowed error of tasks for which no other limit is given.
const DEFAULT_ERROR: f64 = 1e-12;
/// Number of trials whose time is measured.
const TRIALS: u64 = 1 << 17;

/// Measures rolls by an angle of 6 rad with two models: an integrator, and the cheapest model. `error_at_most` contains
/// the integrator's largest allowed error for each task.
pub(super) fn long(error_at_most: &[(String, f64)]) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, object) in [("sphere", sphere()?), ("paraboloid", paraboloid()?)] {
        let task = format!("roll 6 rad over a {name}");
        let limit = error_at_most.iter().find(|(of, _)| *of == task);
        let limit = limit.map_or(DEFAULT_ERROR, |&(_, error)| error);
        for roller in [integrator(&object, limit)?, cheapest(&object, LONG_RAD)?] {
            figures.push(figure(&task, roller, LONG_RAD)?);
        }
    }
    Ok(figures)
}

pub(super) fn short() -> Result<Vec<Figure>> {
    let objects = [("sphere", sphere()?), ("paraboloid", paraboloid()?)];
    let roll = |(name, object)| {
        let task = format!("roll 0.1 rad over a {name}");
        figure(&task, cheapest(&object, SHORT_RAD)?, SHORT_RAD)
    };
    objects.into_iter().map(roll).collect()
}

/// Creates a roller with the cheapest model for this object. This is the closed form or, if the object has none, the
/// model for surfaces of revolution (`meridian`).
fn cheapest(object: &Shape, angle_rad: f64) -> Result<Roller> {
    let model = Model::Auto {
        tolerance: 1e-13,
        chart: Chart::Free,
    };
    roller(object.clone(), model, angle_rad)
}

/// Creates a roller with the integrator DOP853. Its tolerance is the largest one for which the error is at most
/// `error_at_most`.
fn integrator(object: &Shape, error_at_most: f64) -> Result<Roller> {
    for tolerance in TOLERANCES {
        let model = Model::Dop853 {
            tolerance,
            chart: Chart::Free,
        };
        let roller = roller(object.clone(), model, LONG_RAD)?;
        if unit_rolls::error(&roller, LONG_RAD)? <= error_at_most {
            return Ok(roller);
        }
    }
    anyhow::bail!("no tolerance of DOP853 errs by at most {error_at_most}")
}

fn figure(task: &str, roller: Roller, angle_rad: f64) -> Result<Figure> {
    let error = unit_rolls::error(&roller, angle_rad)?;
    let rung = roller.choice().rung.clone();
    let motion = motion(angle_rad);
    Ok(Figure::measured(task, rung, error, 1, move || {
        roller.roll(black_box(&[motion]))
    }))
}

/// Measures trials of estimates from rolls (EP1): without statistics, as in the peer program, and with the statistics
/// of the sweep runner.
pub(super) fn ep1() -> Result<Vec<Figure>> {
    const TASK: &str = "EP1 trial, 8 probes";
    let [alone, whole] = [Ep1::new(Ep1::UNIFORM)?, Ep1::new(Ep1::UNIFORM)?];
    let error_alone = alone
        .relative_rms_error(TRIALS)
        .context("some trials cannot run side by side")?;
    let statistics = whole.statistics(TRIALS)?;
    let curvature = statistics.quantities.first().context("no quantity")?;
    let error = curvature.relative_rms_error.context("no error")?;
    let trials = TRIALS as usize;
    Ok(vec![
        Figure::measured(
            TASK,
            "trial, with standard deviations",
            error_alone,
            trials,
            move || alone.relative_rms_error(TRIALS),
        ),
        Figure::measured(
            TASK,
            "run, with standard deviations and statistics",
            error,
            trials,
            move || whole.statistics(TRIALS),
        ),
    ])
}
