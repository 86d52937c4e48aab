//! `palpate plot` and `palpate report`.

use std::path::{Path, PathBuf};

use palpate_report::{
    Figure, Files, Study, claims_csv, figures, page, press_figures, score, scorecard_text,
};

use crate::cli::{PlotArgs, ReportArgs};
use crate::failure::Failure;
use crate::output;

pub(crate) fn plot(args: &PlotArgs) -> Result<(), Failure> {
    let study = Study::load(&args.dir).map_err(Failure::work)?;
    let mut drawn = figures(&study).map_err(Failure::work)?;
    // What a camera saw of the pass that was traced.
    if args.dir.join("markers.csv").is_file() {
        drawn.extend(press_figures(&Files::in_folder(&args.dir)).map_err(Failure::work)?);
    }
    if drawn.is_empty() {
        let name = study.name();
        return output::print(&format!("{name} has no [[plot]]; nothing drawn"));
    }
    for file in write_figures(&args.dir, &drawn)? {
        output::print(&file.display().to_string())?;
    }
    Ok(())
}

/// Writes figures into `dir`, each as SVG and PNG, and returns their paths.
pub(crate) fn write_figures(dir: &Path, figures: &[Figure]) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for figure in figures {
        let png = figure.png().map_err(Failure::work)?;
        files.push((
            format!("{}.svg", figure.name),
            figure.svg.clone().into_bytes(),
        ));
        files.push((format!("{}.png", figure.name), png));
    }
    let named: Vec<(&str, &[u8])> = files
        .iter()
        .map(|(name, bytes)| (name.as_str(), bytes.as_slice()))
        .collect();
    output::write_files(dir, &named)?;
    Ok(files.iter().map(|(name, _)| dir.join(name)).collect())
}

pub(crate) fn report(args: &ReportArgs) -> Result<(), Failure> {
    let studies = args
        .dirs
        .iter()
        .map(Study::load)
        .collect::<Result<Vec<_>, _>>()
        .map_err(Failure::work)?;
    for study in &studies {
        let claims = claims_csv(&score(std::slice::from_ref(study)));
        output::write_files(study.dir(), &[("claims.csv", claims)])?;
    }
    let page = page(&studies).map_err(Failure::work)?;
    output::write_file(&args.out, &page)?;
    output::print(&scorecard_text(&score(&studies)))?;
    output::print(&format!("page -> {}", args.out.display()))
}
