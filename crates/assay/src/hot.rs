//! The hot paths and their inputs. Instruction counts ([`counts`]), errors ([`crate::accuracy`]) and the comparison
//! with peers ([`crate::ours`]) use the same inputs.

pub mod camera;
pub mod patches;
pub mod pictures;
pub mod presses;
pub mod rolls;
pub mod texts;

use anyhow::{Context, Result, ensure};
use palpate_ep2::{Penalised, Quadric, TwoPass};
use palpate_press::Body;
use palpate_rolling::HeldAxis;
use palpate_sensing::PadLayout;

use crate::measured::{self, Evaluation};
use pictures::{Step, half_spaces, layers};
use rolls::{Chart, Ep1, Model};

/// Number of trials: four blocks of the runner.
const TRIALS: u64 = 4096;

/// Name of a path, and the function that builds its evaluation from the name.
type Path = (&'static str, Box<dyn Fn(&str) -> Result<Evaluation>>);

fn path(name: &'static str, make: impl Fn(&str) -> Result<Evaluation> + 'static) -> Path {
    (name, Box::new(make))
}

/// Every path whose instructions are counted. Each run of a path does the same work.
fn paths() -> Vec<Path> {
    let charts = Chart::Montana(HeldAxis::Transported);
    let rk4 = |chart| Model::Rk4 { steps: 16, chart };
    let dop853 = |chart| Model::Dop853 {
        tolerance: 1e-10,
        chart,
    };
    let over_sphere = |name: &str, model| rolls::rolled(name, rolls::sphere()?, model, 0.1);
    let over_paraboloid =
        |name: &str, model, angle_rad| rolls::rolled(name, rolls::paraboloid()?, model, angle_rad);
    let few = || patches::few(0);
    let of_many = || Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    let half_space = || Body::half_space(0.5, 2.0);
    let layer = || Body::bonded_layer(5.0, 2.0);
    vec![
        path("rolling, closed form", move |name| {
            over_sphere(name, Model::ClosedForm)
        }),
        path("rolling, meridian", move |name| {
            over_paraboloid(name, Model::Meridian, 0.1)
        }),
        path("rolling, rk4 chart free", move |name| {
            over_paraboloid(name, rk4(Chart::Free), 0.1)
        }),
        path("rolling, rk4 in charts", move |name| {
            over_paraboloid(name, rk4(charts), 0.1)
        }),
        path("rolling, dop853 chart free", move |name| {
            over_paraboloid(name, dop853(Chart::Free), 6.0)
        }),
        path("rolling, dop853 in charts", move |name| {
            over_paraboloid(name, dop853(charts), 6.0)
        }),
        path("rolling, touch of a round tip", |name| {
            rolls::touches(name, 16)
        }),
        path("sensing, square pads", |name| {
            rolls::pads(name, PadLayout::Square, 1000)
        }),
        path("sensing, uniform pads", |name| {
            rolls::pads(name, PadLayout::Uniform, 1000)
        }),
        path("trials, ep1", |name| {
            rolls::trials(name, Ep1::UNIFORM, TRIALS)
        }),
        path("trials, ep1 on pads", |name| {
            rolls::trials(name, Ep1::PADS, TRIALS)
        }),
        path("runner, statistics alone", |name| {
            Ok(rolls::statistics_alone(name, TRIALS))
        }),
        path("ep2, quadric fit", move |name| {
            patches::fitted(name, Quadric::default(), &few())
        }),
        path("ep2, penalised fit", move |name| {
            patches::fitted(name, Penalised::default(), &few())
        }),
        path("ep2, penalised estimate", move |name| {
            patches::estimated(name, Penalised::default(), &few())
        }),
        path("ep2, two pass fit", move |name| {
            patches::fitted(name, TwoPass::default(), &few())
        }),
        path("ep2, quadric map", move |name| {
            patches::mapped(name, &Quadric::default(), &few(), 30)
        }),
        path("ep2, penalised map", move |name| {
            patches::mapped(name, &Penalised::default(), &few(), 30)
        }),
        path("ep2, ten thousand contacts", move |name| {
            patches::fitted(name, of_many(), &patches::many(10_000))
        }),
        path("press, half space at 77 markers", move |name| {
            presses::moved(name, half_space()?)
        }),
        path("press, layer at 77 markers", move |name| {
            presses::moved(name, layer()?)
        }),
        path("press, solved layer at 77 markers", |name| {
            presses::moved(name, Body::solved_layer(5.0, 2.0)?)
        }),
        path("press, half space fit", move |name| {
            presses::fitted(name, half_space()?)
        }),
        path("press, layer fit", move |name| {
            presses::fitted(name, layer()?)
        }),
        path("images, rest", |name| {
            pictures::worked(name, layers, Step::Rest)
        }),
        path("images, half space fit", |name| {
            pictures::worked(name, half_spaces, Step::Fit)
        }),
        path("images, layer fit", |name| {
            pictures::worked(name, layers, Step::Fit)
        }),
        path("images, layer doubts", |name| {
            pictures::worked(name, layers, Step::Doubts)
        }),
        path("sight, projected", camera::projected),
        path("sight, rendered 640 px", |name| camera::rendered(name, 640)),
        path("sight, find 640 px", |name| camera::found(name, 640)),
        path("sight, match 77 markers", |name| camera::matched(name, 640)),
        path("text, formula", |name| texts::evaluated(name, 100)),
        path("text, config", texts::parsed),
    ]
}

/// Name and number of instructions of each path. Each path runs in its own process, because memory that other paths
/// left on the heap changes the cost of allocations.
///
/// # Errors
/// If valgrind is missing, a path cannot be set up, or it runs no instruction.
pub fn counts() -> Result<Vec<(String, f64)>> {
    let count = |(name, _): Path| {
        let arguments = ["instructions", measured::COUNTED, name].map(Into::into);
        let counts = measured::instructions_by(arguments, &[1])?;
        let count = counts.context(measured::NO_VALGRIND)?[0];
        ensure!(count > 0, "{name} runs no instruction");
        Ok((name.to_owned(), count as f64))
    };
    paths().into_iter().map(count).collect()
}

/// Runs a path, so that [`counts`] can count it.
///
/// # Errors
/// If no path has this name, or it cannot be set up.
pub fn count(name: &str) -> Result<()> {
    let path = paths().into_iter().find(|(known, _)| *known == name);
    let (_, make) = path.with_context(|| format!("no path `{name}`"))?;
    measured::count([make(name)?]);
    Ok(())
}
