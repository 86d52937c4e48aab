//! Workloads are computations that dominate the run time of palpate. The bench `workloads` measures their times, and
//! [`counts`] their instructions. Errors ([`crate::accuracy`]) and the comparison with peers ([`crate::peer_tasks`]) use
//! the same inputs.

pub mod camera_frames;
pub mod ep2_contacts;
pub mod image_fits;
pub mod marker_presses;
pub mod unit_rolls;

use std::collections::BTreeMap;
use std::hint::black_box;

use anyhow::{Context, Result, ensure};
use palpate_ep2::{Penalised, Quadric, TwoPass};
use palpate_geometry::Formula;
use palpate_press::Body;
use palpate_rolling::HeldAxis;
use palpate_sensing::PadLayout;

use crate::timing::{self, Evaluation};
use image_fits::{Step, half_spaces, layers};
use unit_rolls::{Chart, Ep1, Model};

/// Number of trials of a workload. The sweep runner divides them into four blocks.
const TRIALS: u64 = 4096;

/// Name of a workload, and a function that creates its computation. The function's argument is the name.
type Workload = (&'static str, Box<dyn Fn(&str) -> Result<Evaluation>>);

fn workload(name: &'static str, make: impl Fn(&str) -> Result<Evaluation> + 'static) -> Workload {
    (name, Box::new(make))
}

fn workloads() -> Vec<Workload> {
    let charts = Chart::Montana(HeldAxis::Transported);
    let rk4 = |chart| Model::Rk4 { steps: 16, chart };
    let dop853 = |chart| Model::Dop853 {
        tolerance: 1e-10,
        chart,
    };
    let over_sphere = |name: &str, model| unit_rolls::roll(name, unit_rolls::sphere()?, model, 0.1);
    let over_paraboloid = |name: &str, model, angle_rad| {
        unit_rolls::roll(name, unit_rolls::paraboloid()?, model, angle_rad)
    };
    let few = || ep2_contacts::few(0);
    let six_intervals = || Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    let half_space = || Body::half_space(0.5, 2.0);
    let layer = || Body::bonded_layer(5.0, 2.0);
    vec![
        workload("rolling, closed form", move |name| {
            over_sphere(name, Model::ClosedForm)
        }),
        workload("rolling, meridian", move |name| {
            over_paraboloid(name, Model::Meridian, 0.1)
        }),
        workload("rolling, rk4 chart free", move |name| {
            over_paraboloid(name, rk4(Chart::Free), 0.1)
        }),
        workload("rolling, rk4 in charts", move |name| {
            over_paraboloid(name, rk4(charts), 0.1)
        }),
        workload("rolling, dop853 chart free", move |name| {
            over_paraboloid(name, dop853(Chart::Free), 6.0)
        }),
        workload("rolling, dop853 in charts", move |name| {
            over_paraboloid(name, dop853(charts), 6.0)
        }),
        workload("rolling, touch of a round tip", |name| {
            unit_rolls::touches(name, 16)
        }),
        workload("sensing, square pads", |name| {
            unit_rolls::pads(name, PadLayout::Square, 1000)
        }),
        workload("sensing, uniform pads", |name| {
            unit_rolls::pads(name, PadLayout::Uniform, 1000)
        }),
        workload("trials, ep1", |name| {
            unit_rolls::trials(name, Ep1::UNIFORM, TRIALS)
        }),
        workload("trials, ep1 on pads", |name| {
            unit_rolls::trials(name, Ep1::PADS, TRIALS)
        }),
        workload("recorded, eight rolls", unit_rolls::recorded),
        workload("runner, statistics alone", |name| {
            Ok(unit_rolls::statistics_alone(name, TRIALS))
        }),
        workload("ep2, quadric fit", move |name| {
            ep2_contacts::fit(name, Quadric::default(), &few())
        }),
        workload("ep2, penalised fit", move |name| {
            ep2_contacts::fit(name, Penalised::default(), &few())
        }),
        workload("ep2, penalised estimate", move |name| {
            ep2_contacts::estimate(name, Penalised::default(), &few())
        }),
        workload("ep2, two pass fit", move |name| {
            ep2_contacts::fit(name, TwoPass::default(), &few())
        }),
        workload("ep2, quadric map", move |name| {
            ep2_contacts::map(name, &Quadric::default(), &few(), 30)
        }),
        workload("ep2, penalised map", move |name| {
            ep2_contacts::map(name, &Penalised::default(), &few(), 30)
        }),
        workload("ep2, ten thousand contacts", move |name| {
            ep2_contacts::fit(name, six_intervals(), &ep2_contacts::many(10_000))
        }),
        workload("press, half space at 77 markers", move |name| {
            marker_presses::displacements(name, half_space()?)
        }),
        workload("press, layer at 77 markers", move |name| {
            marker_presses::displacements(name, layer()?)
        }),
        workload("press, solved layer at 77 markers", |name| {
            marker_presses::displacements(name, Body::solved_layer(5.0, 2.0)?)
        }),
        workload("press, half space fit", move |name| {
            marker_presses::fit_workload(name, half_space()?)
        }),
        workload("press, layer fit", move |name| {
            marker_presses::fit_workload(name, layer()?)
        }),
        workload("images, rest", |name| {
            image_fits::workload(name, layers, Step::Rest)
        }),
        workload("images, half space fit", |name| {
            image_fits::workload(name, half_spaces, Step::Fit)
        }),
        workload("images, layer fit", |name| {
            image_fits::workload(name, layers, Step::Fit)
        }),
        workload("images, layer doubts", |name| {
            image_fits::workload(name, layers, Step::Misfits)
        }),
        workload("sight, projected", camera_frames::projection),
        workload("sight, rendered 640 px", |name| {
            camera_frames::rendering(name, 640)
        }),
        workload("sight, find 640 px", |name| {
            camera_frames::detection(name, 640)
        }),
        workload("sight, match 77 markers", |name| {
            camera_frames::matching(name, 640)
        }),
        workload("text, formula", |name| formula(name, 100)),
        workload("text, config", config),
    ]
}

/// Name and number of instructions of each workload. Each workload runs in its own process. If they shared a process,
/// the cost of memory allocations would depend on the workloads that ran before.
///
/// # Errors
/// An error if valgrind is missing, or a workload cannot be set up or executes no instruction.
pub fn counts() -> Result<Vec<(String, f64)>> {
    let count = |(name, _): Workload| {
        let arguments = ["instructions", timing::COUNTED, name].map(Into::into);
        let counts = timing::instructions_by(arguments, &[1])?;
        let count = counts.context(timing::NO_VALGRIND)?[0];
        ensure!(count > 0, "{name} runs no instruction");
        Ok((name.to_owned(), count as f64))
    };
    workloads().into_iter().map(count).collect()
}

/// Runs a workload so that [`counts`] can count its instructions.
///
/// # Errors
/// An error if no workload has this name, or it cannot be set up.
pub fn count(name: &str) -> Result<()> {
    timing::count([evaluation(name)?]);
    Ok(())
}

/// Names of all workloads.
pub fn names() -> Vec<&'static str> {
    workloads().into_iter().map(|(name, _)| name).collect()
}

/// Sets up a workload.
///
/// # Errors
/// An error if no workload has this name, or it cannot be set up.
pub fn evaluation(name: &str) -> Result<Evaluation> {
    let workload = workloads().into_iter().find(|(known, _)| *known == name);
    let (_, make) = workload.with_context(|| format!("no workload `{name}`"))?;
    make(name)
}

fn formula(name: &str, points: u32) -> Result<Evaluation> {
    let parameters = BTreeMap::from([("a".to_owned(), 0.2)]);
    let formula = Formula::parse("a * sin(2 * x) * cos(2 * y) + x^2 / 8", &parameters)?;
    Ok(Evaluation::new(name, move || {
        (0..points).for_each(|point| {
            black_box(formula.jet(0.01 * f64::from(point), black_box(0.3)));
        });
    }))
}

fn config(name: &str) -> Result<Evaluation> {
    let text = include_str!("../../../examples/press-a-ball.toml");
    palpate_study::config::parse("press-a-ball.toml", text)?;
    Ok(Evaluation::new(name, move || {
        palpate_study::config::parse("press-a-ball.toml", black_box(text))
    }))
}
