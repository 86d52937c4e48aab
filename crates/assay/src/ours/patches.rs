//! Fits and maps of EP2.

use std::hint::black_box;

use anyhow::Result;
use palpate_ep2::{Ep2Error, Fit, Method, Passes, Patch, Penalised, Quadric, TwoPass};

use super::{Figure, MANY, PATCHES};
use crate::accuracy::rms;
use crate::hot::patches;

/// Places a side of the map.
const SIDE: usize = 30;
/// Intervals of the spline that the peer has with six knots.
const INTERVALS: usize = 7;

/// A method by its name, and what is kept of its fits.
type Told = (&'static str, Box<dyn Method>, fn(Fit) -> Fit);

/// Every method on all patches of few contacts, as the peer does it: curvatures alone. One with their standard
/// deviations beside. One pass of the paper's method is the peer's own task: the same smoothing spline.
pub(super) fn few() -> Result<Vec<Figure>> {
    let one_pass = TwoPass {
        passes: Passes::One,
        // The peer's weights are per unit of length.
        unit_length: Some(1.0),
        ..TwoPass::default()
    };
    let methods: [Told; 5] = [
        ("one pass, the same spline", Box::new(one_pass), bare),
        ("two-pass", Box::new(TwoPass::default()), bare),
        ("quadric", Box::new(Quadric::default()), bare),
        ("penalised", Box::new(Estimate(Penalised::default())), bare),
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
        let mut errors = Vec::new();
        for contacts in &contacts {
            let fit = method.fit(&patches::patch(contacts)?)?;
            for place in patches::places_on_sphere() {
                errors.push(fit.curvature_at(&place)?.mean * patches::RADIUS - 1.0);
            }
        }
        let maps = move || -> Result<(), Ep2Error> {
            for contacts in black_box(&contacts) {
                let fit = told(method.fit(&patches::patch(contacts)?)?);
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

/// The penalised spline without its uncertainty.
struct Estimate(Penalised);

impl Method for Estimate {
    fn fit(&self, patch: &Patch) -> Result<Fit, Ep2Error> {
        self.0.estimate(patch)
    }
}

/// The peers know no standard deviations.
fn bare(fit: Fit) -> Fit {
    Fit {
        posterior: None,
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
    let figure = Figure::measured(
        "EP2, 100 000 contacts, map of 30 x 30",
        format!("penalised, {INTERVALS} x {INTERVALS} intervals"),
        patches::error_on_waves(&fit)?,
        1,
        move || {
            let fit = method.estimate(&patches::patch(black_box(&contacts))?)?;
            fit.curvatures(SIDE)
        },
    );
    Ok(vec![figure])
}
