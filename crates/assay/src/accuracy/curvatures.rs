//! Errors of the curvatures that EP2 estimates from contacts.

use anyhow::Result;
use palpate_ep2::{Curvature, Method, Penalised, Quadric, TwoPass};

use super::figure::{Figure, rms};
use crate::hot::patches;

const PATCHES: u64 = 50;
const SIDE: usize = 20;
const MANY: usize = 10_000;

pub(super) fn figures() -> Result<Vec<Figure>> {
    let methods: [(&str, &dyn Method); 3] = [
        ("quadric", &Quadric::default()),
        ("penalised", &Penalised::default()),
        ("two-pass", &TwoPass::default()),
    ];
    let mut figures = Vec::new();
    for (name, method) in methods {
        let mut found = Vec::new();
        for patch in 0..PATCHES {
            let patch = patches::patch(&patches::few(patch))?;
            found.extend(method.fit(&patch)?.curvatures(SIDE)?);
        }
        let radius = patches::RADIUS;
        let mean = |one: &Curvature| one.mean * radius - 1.0;
        let gaussian = |one: &Curvature| one.gaussian * radius * radius - 1.0;
        let figure =
            |of: &str, error| Figure::new(format!("EP2, 30 contacts, {name}, {of}"), error);
        figures.push(figure("mean curvature", rms(found.iter().map(mean))));
        figures.push(figure(
            "gaussian curvature",
            rms(found.iter().map(gaussian)),
        ));
    }
    let method = Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    let fit = method.fit(&patches::patch(&patches::many(MANY))?)?;
    let mut errors = Vec::new();
    for (place, mean) in patches::places_on_waves() {
        errors.push(fit.curvature_at(&place)?.mean - mean);
    }
    let name = format!("EP2, {MANY} contacts, penalised, mean curvature, 1/length");
    figures.push(Figure::new(name, rms(errors)));
    Ok(figures)
}
