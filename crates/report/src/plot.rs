//! Plots of a study, as its `[[plot]]` tables ask for them.

mod along;
mod canvas;
mod captions;
mod cells;
mod class_map;
mod compose;
mod contacts;
mod draw;
mod figure;
mod fronts;
mod layout;
mod lettering;
mod picture;
mod points;
mod press_trace;
mod profile;
mod scale;
mod select;
mod spec;
mod style;

use crate::{ReportError, Study, file};
use picture::Picture;
use std::path::{Path, PathBuf};

pub use fronts::draw_tradeoff;
pub(crate) use fronts::{spoken_cost, svgs as fronts_svgs};
pub use press_trace::draw_press_trace;

/// Draws every `[[plot]]` of the study, as SVG and PNG beside its tables, and returns the files written, in the order
/// of the config. A plot of kind `class-map` or `profile` is of `map.csv`, one of kind `contacts` of `trace.csv` and
/// `readings.csv`. The bytes of an SVG depend on the study's tables and `run.toml` alone.
///
/// # Errors
/// A `[[plot]]` is malformed, names an unknown column, or leaves several rows for one point (the error says which axis
/// is free); its table is absent or malformed; or a file cannot be written. Nothing is half-written, and nothing at all
/// is written if any `[[plot]]` is wrong.
pub fn plot(study: &Study) -> Result<Vec<PathBuf>, ReportError> {
    let mut written = Vec::new();
    for picture in pictures(study)? {
        written.extend(write(&picture, study.dir())?);
    }
    Ok(written)
}

/// Writes a picture to `dir` as SVG and PNG.
fn write(picture: &Picture, dir: &Path) -> Result<[PathBuf; 2], ReportError> {
    let [svg, png] = ["svg", "png"].map(|kind| dir.join(format!("{}.{kind}", picture.name())));
    file::write(&svg, canvas::svg(picture, &svg)?.as_bytes())?;
    file::replace(&png, |temporary| canvas::png(picture, temporary))?;
    Ok([svg, png])
}

/// The study's plots as (title, SVG text), in the order of the config.
pub(crate) fn svgs(study: &Study) -> Result<Vec<(String, String)>, ReportError> {
    let draw = |picture: &Picture| {
        let path = study.dir().join(format!("{}.svg", picture.name()));
        Ok((picture.title().to_owned(), canvas::svg(picture, &path)?))
    };
    pictures(study)?.iter().map(draw).collect()
}

fn pictures(study: &Study) -> Result<Vec<Picture>, ReportError> {
    let plots = spec::plots(study)?;
    plots.iter().map(|plot| Picture::of(study, plot)).collect()
}
