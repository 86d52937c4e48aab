//! Implements the commands `palpate plot`, `palpate report` and `palpate trace`.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use palpate::{Trace, TraceError, load, resolved};
use palpate_report::{
    Figure, Files, Study, claims_table, figures, page, press_figures, score, scorecard_lines,
};
use rayon::prelude::*;

use crate::cli::{PlotArgs, ReportArgs, TraceArgs};
use crate::failure::Failure;
use crate::output::names::{CLAIMS, CONFIG, FRAMES, Format, MARKERS, READINGS, TRACE, text_of};
use crate::output::{self, Guard, LockedDir, OutputFile, StudyId, refuse_no_directory};

pub(crate) fn plot(args: &PlotArgs) -> Result<(), Failure> {
    refuse_no_directory(&args.dir)?;
    // This process holds the lock of the directory until the end of this function.
    let mut folder = LockedDir::open(&args.dir, Guard::new([], args.force))?;
    let study = load_results(&args.dir)?;
    let mut drawn = figures(&study).map_err(Failure::work)?;
    // A file with markers exists if the directory contains the trace of a press with a camera. Such a trace has
    // additional figures.
    if args.dir.join(MARKERS).is_file() {
        drawn.extend(press_figures(&Files::in_folder(&args.dir)).map_err(Failure::work)?);
    }
    if drawn.is_empty() {
        let name = study.name();
        return output::print(&format!(
            "{name} has no [[plot]] and no sweep, so there is nothing to plot"
        ));
    }
    let files = drawings(&drawn)?;
    let named: Vec<(&str, &[u8])> = files
        .iter()
        .map(|(name, bytes)| (&**name, &**bytes))
        .collect();
    folder.write(&named, Some(&id_of(&study)?))?;
    let mut names = files.iter().map(|(name, _)| args.dir.join(name));
    names.try_for_each(|path| output::print(&path.display().to_string()))
}

fn load_results(dir: &Path) -> Result<Study, Failure> {
    refuse_no_directory(dir)?;
    if Format::found_in(dir) == Some(Format::Parquet) {
        return Err(Failure::work(anyhow!(
            "{} has its tables as Parquet, but figures and scores need CSV: `palpate run {}` in another directory writes the same tables as CSV",
            dir.display(),
            dir.join(CONFIG).display()
        )));
    }
    Study::read(Files::in_folder(dir)).map_err(Failure::work)
}

fn id_of(study: &Study) -> Result<StudyId, Failure> {
    let path = study.dir().join(CONFIG);
    let config = text_of(&path)
        .with_context(|| format!("cannot read {}", path.display()))
        .map_err(Failure::work)?;
    Ok(StudyId::new(study.name(), &config).with_cells_in(study.dir()))
}

/// File names and contents of figures: an SVG file and a PNG file for each figure.
pub(crate) fn drawings(figures: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let both = |figure: &Figure| {
        let png = figure.png().map_err(Failure::work)?;
        let svg = figure.svg.clone().into_bytes();
        Ok([
            (format!("{}.svg", figure.name), svg),
            (format!("{}.png", figure.name), png),
        ])
    };
    let files: Result<Vec<_>, Failure> = figures.par_iter().map(both).collect();
    Ok(files?.into_iter().flatten().collect())
}

pub(crate) fn report(args: &ReportArgs) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = args.dirs.iter().flat_map(|dir| input_files(dir)).collect();
    let guard = || Guard::new(&inputs, args.force);
    let out = OutputFile::new("--out", &args.out, guard())?;
    let studies = args
        .dirs
        .iter()
        .map(|dir| load_results(dir))
        .collect::<Result<Vec<_>, _>>()?;
    for study in &studies {
        let claims = claims_table(&score(std::slice::from_ref(study))).to_csv();
        let mut folder = LockedDir::open(study.dir(), Guard::new([], args.force))?;
        folder.write(&[(CLAIMS, claims)], Some(&id_of(study)?))?;
    }
    let page = page(&studies).map_err(Failure::work)?;
    out.write(page.as_bytes())?;
    let scores = score(&studies);
    out.print(&scorecard_lines(&scores))?;
    out.print(&format!("page -> {}", args.out.display()))
}

/// Files in a directory that `palpate report` reads and therefore must not overwrite: all files except HTML pages.
fn input_files(dir: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let is_page = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "html");
    entries
        .map(|entry| entry.path())
        .filter(|path| !is_page(path))
        .collect()
}

pub(crate) fn trace(args: &TraceArgs) -> Result<(), Failure> {
    let study = load(&args.config).map_err(Failure::usage)?;
    if args.cell >= study.cell_count() {
        return Err(Failure::no_cell(args.cell, &study));
    }
    let trace = palpate::trace(&study, args.cell, args.trial).map_err(trace_failure)?;
    let of_study = StudyId::new(&study.config.name, &resolved(&study));
    let mut folder = LockedDir::open(&args.out, Guard::new([&args.config], args.force))?;
    let mut drawn = Vec::new();
    if trace.camera.is_some() {
        let tables = [
            (TRACE, trace.contacts.to_csv()),
            (READINGS, trace.readings.to_csv()),
        ];
        let figures = press_figures(&Files::in_memory(tables)).map_err(Failure::work)?;
        drawn = drawings(&figures)?;
    }
    let mut files = trace_files(&trace)?;
    files.extend(
        drawn
            .iter()
            .map(|(name, bytes)| (name.as_str(), bytes.clone())),
    );
    folder.write(&files, Some(&of_study))?;
    let (name, out) = (&study.config.name, args.out.display());
    output::print(&format!("{name}: {} -> {out}", trace.what))
}

/// File names and contents of a traced trial: its tables and, with a camera, its frames.
pub(crate) fn trace_files(trace: &Trace) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    let mut files = vec![
        (TRACE, trace.contacts.to_csv().into_bytes()),
        (READINGS, trace.readings.to_csv().into_bytes()),
    ];
    if let Some(seen) = &trace.camera {
        files.push((MARKERS, seen.markers.to_csv().into_bytes()));
        for (name, frame) in FRAMES.into_iter().zip(seen.frames.iter().flatten()) {
            files.push((name, output::png(frame)?));
        }
    }
    Ok(files)
}

/// Converts the error of a trace to a failure. The failure is bad usage if the config or the cell number is wrong; it
/// is failed work if the traced trial itself fails.
pub(crate) fn trace_failure(error: TraceError) -> Failure {
    match error {
        TraceError::Config(error) => Failure::usage(error),
        error => Failure::work(error),
    }
}
