//! Tasks with contact points (EP2): fits of a surface, maps of its curvature, and estimates from recorded glides.

use std::borrow::Cow;
use std::hint::black_box;

use anyhow::Result;
use palpate::recorded::{Curvature, GlideFitResult, GlideOptions, GlideRecording, RecordedError};
use palpate_ep2::{Contact, Ep2Error, Fit, Method, Passes, Patch, Penalised, Quadric, TwoPass};

use super::{Figure, MANY, PATCHES};
use crate::accuracy::rms;
use crate::workloads::ep2_contacts;

const SIDE: usize = 30;
/// Number of knot intervals along each side of the spline. The program that palpate is compared with has the same
/// number: its spline has six inner knots.
const INTERVALS: usize = 7;

/// A measured fit method: its name, the method itself, and a function that removes the parts of the fit that the peer
/// program does not compute.
type MethodRung = (&'static str, Box<dyn Method>, fn(Fit) -> Fit);

/// Measures the time and the error of surface fits on all patches with few contacts. As in the peer program, the
/// measured time does not include the computation of standard errors; the quadric is also measured with it. The first
/// pass of the method `two-pass` fits the same smoothing spline as the peer program.
pub(super) fn few() -> Result<Vec<Figure>> {
    let one_pass = TwoPass {
        passes: Passes::One,
        // Fit in the length unit of the readings, because the weights of the peer program refer to this unit of length.
        unit_length: Some(1.0),
        ..TwoPass::default()
    };
    let methods: [MethodRung; 5] = [
        (
            "first pass of two-pass (the same spline)",
            Box::new(one_pass),
            Fit::without_uncertainty,
        ),
        (
            "two-pass",
            Box::new(TwoPass::default()),
            Fit::without_uncertainty,
        ),
        (
            "quadric",
            Box::new(Quadric::default()),
            Fit::without_uncertainty,
        ),
        (
            "penalised",
            Box::new(Estimate(Penalised::default())),
            Fit::without_uncertainty,
        ),
        (
            "quadric, with standard deviations",
            Box::new(Quadric::default()),
            |fit| fit,
        ),
    ];
    let contacts: Vec<_> = (0..PATCHES).map(ep2_contacts::few).collect();
    let mut figures = Vec::new();
    for (name, method, reduce) in methods {
        let contacts = contacts.clone();
        let mut errors = Vec::new();
        for contacts in &contacts {
            let fit = method.fit(&ep2_contacts::patch(contacts)?)?;
            for place in ep2_contacts::places_on_sphere() {
                errors.push(fit.curvature_at(&place)?.mean * ep2_contacts::RADIUS - 1.0);
            }
        }
        let maps = move || -> Result<(), Ep2Error> {
            for contacts in black_box(&contacts) {
                let fit = reduce(method.fit(&ep2_contacts::patch(contacts)?)?);
                black_box(fit.curvatures(SIDE)?);
            }
            Ok(())
        };
        let task = "EP2, 30 contacts, map of 30 x 30";
        let patches = PATCHES as usize;
        figures.push(Figure::measured(task, name, rms(errors), patches, maps));
    }
    Ok(figures)
}

/// A fit method that fits the penalised spline without computing standard errors.
struct Estimate(Penalised);

impl Method for Estimate {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        self.0.estimate(patch)
    }
}

pub(super) fn many() -> Result<Vec<Figure>> {
    let contacts = ep2_contacts::many(MANY);
    let method = Penalised {
        intervals: Some(INTERVALS),
        ..Penalised::default()
    };
    let fit = method.fit(&ep2_contacts::patch(&contacts)?)?;
    let figure = Figure::measured(
        "EP2, 100 000 contacts, map of 30 x 30",
        format!("penalised, {INTERVALS} x {INTERVALS} intervals"),
        ep2_contacts::error_on_waves(&fit)?,
        1,
        move || {
            let fit = method.estimate(&ep2_contacts::patch(black_box(&contacts))?)?;
            fit.curvatures(SIDE)
        },
    );
    Ok(vec![figure])
}

fn positions(contacts: &[Contact]) -> Vec<[f64; 3]> {
    let position = |contact: &Contact| contact.position.coords.into();
    contacts.iter().map(position).collect()
}

/// Fits a surface to the points, and computes the curvatures on a map of this surface. It makes the same calls as a
/// user's Python code.
fn estimate_recorded(points: &[[f64; 3]]) -> Result<Vec<Curvature>, RecordedError> {
    let readings = GlideRecording::new(points, None, None, None)?;
    let fitted = GlideFitResult::new(Cow::Owned(readings), &GlideOptions::default())?;
    let curvatures = fitted.curvatures()?;
    black_box(fitted);
    Ok(curvatures)
}

/// Relative errors of the mean curvatures at the points of a map. The map belongs to a patch of the tasks with few
/// contacts per patch.
fn map_errors(map: &[Curvature]) -> impl Iterator<Item = f64> {
    map.iter()
        .map(|curvature| curvature.mean * ep2_contacts::RADIUS - 1.0)
}

pub(super) fn recorded() -> Result<Vec<Figure>> {
    const RUNG: &str = "palpate in Rust";
    let few: Vec<_> = (0..PATCHES)
        .map(|patch| positions(&ep2_contacts::few(patch)))
        .collect();
    let mut errors_of_few = Vec::new();
    for points in &few {
        errors_of_few.extend(map_errors(&estimate_recorded(points)?));
    }
    let all = move || -> Result<(), RecordedError> {
        for points in black_box(&few) {
            black_box(estimate_recorded(points)?);
        }
        Ok(())
    };
    let task = "estimate_glide of 30 contacts, map of 30 x 30";
    let mut figures = vec![Figure::measured(
        task,
        RUNG,
        rms(errors_of_few),
        PATCHES as usize,
        all,
    )];
    let many = positions(&ep2_contacts::many(MANY));
    let error_of_many = rms(map_errors(&estimate_recorded(&many)?));
    let task = "estimate_glide of 100 000 contacts, map of 30 x 30";
    let all = move || estimate_recorded(black_box(&many));
    figures.push(Figure::measured(task, RUNG, error_of_many, 1, all));
    Ok(figures)
}
