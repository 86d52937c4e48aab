//! Plots of a study, as its `[[plot]]` tables ask for them.

mod canvas;
mod captions;
mod compose;
mod draw;
mod figure;
mod layout;
mod lettering;
mod scale;
mod select;
mod spec;
mod style;

use crate::{ReportError, Study, file};
use std::path::PathBuf;

/// Draws every `[[plot]]` of the study, as SVG and PNG beside its tables, and returns the files written, in
/// the order of the config. The bytes of an SVG depend on `cells.csv`, `failures.csv` and `run.toml` alone.
///
/// # Errors
/// A `[[plot]]` is malformed, names an unknown column, or leaves several rows for one point (the error says
/// which axis is free); or a file cannot be written. Nothing is half-written, and nothing at all is written
/// if any `[[plot]]` is wrong.
pub fn plot(study: &Study) -> Result<Vec<PathBuf>, ReportError> {
    let mut written = Vec::new();
    for figure in figures(study)? {
        let svg = study.dir().join(format!("{}.svg", figure.name));
        file::write(&svg, canvas::svg(&figure, &svg)?.as_bytes())?;
        let png = study.dir().join(format!("{}.png", figure.name));
        file::replace(&png, |temporary| canvas::png(&figure, temporary))?;
        written.extend([svg, png]);
    }
    Ok(written)
}

/// The study's plots as (title, SVG text), in the order of the config.
pub(crate) fn svgs(study: &Study) -> Result<Vec<(String, String)>, ReportError> {
    let draw = |figure: &figure::Figure| {
        let path = study.dir().join(format!("{}.svg", figure.name));
        Ok((figure.title.clone(), canvas::svg(figure, &path)?))
    };
    figures(study)?.iter().map(draw).collect()
}

fn figures(study: &Study) -> Result<Vec<figure::Figure>, ReportError> {
    spec::plots(study)?
        .iter()
        .map(|spec| compose::figure(study, spec))
        .collect()
}
