//! Estimates from recorded glides, as the package for Python asks for them.

use std::borrow::Cow;
use std::hint::black_box;

use anyhow::Result;
use palpate::recorded::{
    Curvature, FittedGlide, GlideGiven, GlideOptions, GlideReadings, RecordedError, Wording,
};
use palpate_ep2::Contact;

use super::{Figure, MANY, PATCHES};
use crate::accuracy::rms;
use crate::hot::patches;

fn positions(contacts: &[Contact]) -> Vec<[f64; 3]> {
    let position = |contact: &Contact| contact.position.coords.into();
    contacts.iter().map(position).collect()
}

/// Surface through the points and its curvatures all over the map, which is what Python computes for a map of one of them.
fn estimated(points: &[[f64; 3]]) -> Result<Vec<Curvature>, RecordedError> {
    let options = GlideOptions::given(&GlideGiven::default(), None, false, Wording::Arguments);
    let readings = GlideReadings::new(points, None, None, None)?;
    let options = options.map_err(|error| RecordedError::Readings {
        file: "options".to_owned(),
        message: error.message,
    })?;
    let fitted = FittedGlide::new(Cow::Owned(readings), &options)?;
    let curvatures = fitted.curvatures()?;
    black_box(fitted);
    Ok(curvatures)
}

/// Mean curvatures all over a map, relative to those of the sphere of few contacts, less 1.
fn errors(map: &[Curvature]) -> impl Iterator<Item = f64> {
    map.iter()
        .map(|curvature| curvature.mean * patches::RADIUS - 1.0)
}

/// Few contacts and many.
pub(super) fn recorded() -> Result<Vec<Figure>> {
    const RUNG: &str = "palpate in Rust";
    let few: Vec<_> = (0..PATCHES)
        .map(|patch| positions(&patches::few(patch)))
        .collect();
    let mut of_few = Vec::new();
    for points in &few {
        of_few.extend(errors(&estimated(points)?));
    }
    let all = move || -> Result<(), RecordedError> {
        for points in black_box(&few) {
            black_box(estimated(points)?);
        }
        Ok(())
    };
    let task = "estimate_glide of 30 contacts, map of 30 x 30";
    let mut figures = vec![Figure::measured(
        task,
        RUNG,
        rms(of_few),
        PATCHES as usize,
        all,
    )];
    let many = positions(&patches::many(MANY));
    let of_many = rms(errors(&estimated(&many)?));
    let task = "estimate_glide of 100 000 contacts, map of 30 x 30";
    let all = move || estimated(black_box(&many));
    figures.push(Figure::measured(task, RUNG, of_many, 1, all));
    Ok(figures)
}
