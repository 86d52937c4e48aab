//! Fits and maps of EP2.

use std::hint::black_box;

use anyhow::Result;
use palpate_ep2::{Curvature, Ep2Error, Fit, Method, Penalised, Quadric, TwoPass};

use super::{Figure, MANY, PATCHES};
use crate::accuracy::rms;
use crate::hot::patches;

/// Places a side of the map.
const SIDE: usize = 30;
/// Intervals of the spline that the peer has with six knots.
const INTERVALS: usize = 7;

/// A method by its name, and what is kept of its fits.
type Told = (&'static str, Box<dyn Method>, fn(Fit) -> Fit);

/// Every method on all patches of few contacts, as the peer does it: curvatures alone. One with their standard deviations
/// beside.
pub(super) fn few() -> Result<Vec<Figure>> {
    let methods: [Told; 4] = [
        ("quadric", Box::new(Quadric::default()), without_deviations),
        (
            "penalised",
            Box::new(Penalised::default()),
            without_deviations,
        ),
        ("two-pass", Box::new(TwoPass::default()), without_deviations),
        (
            "quadric, with standard deviations",
            Box::new(Quadric::default()),
            |fit| fit,
        ),
    ];
    let contacts: Vec<_> = (0..PATCHES).map(patches::few).collect();
    let mut figures = Vec::new();
    for (name, method, told) in methods {
        let contacts = contacts.clone();
        let maps = move || -> Result<Vec<_>, Ep2Error> {
            let patches = black_box(&contacts).iter();
            patches
                .map(|contacts| told(method.fit(&patches::patch(contacts)?)?).curvatures(SIDE))
                .collect()
        };
        let relative = |map: &Vec<Curvature>| -> Vec<f64> {
            map.iter()
                .map(|found| found.mean * patches::RADIUS - 1.0)
                .collect()
        };
        let error = rms(maps()?.iter().flat_map(relative));
        let task = "EP2, 30 contacts, map of 30 x 30";
        figures.push(Figure::measured(task, name, error, PATCHES as usize, maps));
    }
    Ok(figures)
}

/// The peers know no standard deviations.
fn without_deviations(fit: Fit) -> Fit {
    Fit {
        covariance: None,
        ..fit
    }
}

/// The penalised spline on many contacts.
pub(super) fn many() -> Result<Vec<Figure>> {
    let contacts = patches::many(MANY);
    let method = Penalised {
        intervals: Some(INTERVALS),
        ..Penalised::default()
    };
    let fit = method.fit(&patches::patch(&contacts)?)?;
    let mut errors = Vec::new();
    for (place, mean) in patches::places_on_waves() {
        errors.push(fit.curvature_at(&place)?.mean - mean);
    }
    let figure = Figure::measured(
        "EP2, 100 000 contacts, map of 30 x 30",
        format!("penalised, {INTERVALS} x {INTERVALS} intervals"),
        rms(errors),
        1,
        move || {
            let fit = method.fit(&patches::patch(black_box(&contacts))?)?;
            without_deviations(fit).curvatures(SIDE)
        },
    );
    Ok(vec![figure])
}
