//! `palpate plot` and `palpate report`.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use palpate_report::{
    Figure, Files, Study, claims_csv, figures, page, press_figures, score, scorecard_lines,
};

use crate::cli::{PlotArgs, ReportArgs};
use crate::failure::Failure;
use crate::output::names::{CLAIMS, CONFIG, MARKERS, text_of};
use crate::output::{self, Folder, Format, Guard, Single, StudyId, refuse_no_directory};

pub(crate) fn plot(args: &PlotArgs) -> Result<(), Failure> {
    refuse_no_directory(&args.dir)?;
    // No other process writes there from here on.
    let mut folder = Folder::open(&args.dir, Guard::new([], args.force))?;
    let study = loaded(&args.dir)?;
    let mut drawn = figures(&study).map_err(Failure::work)?;
    // What a camera saw of the pass that was traced.
    if args.dir.join(MARKERS).is_file() {
        drawn.extend(press_figures(&Files::in_folder(&args.dir)).map_err(Failure::work)?);
    }
    if drawn.is_empty() {
        let name = study.name();
        return output::print(&format!(
            "{name} has no [[plot]], and sweeps nothing that one could be of; nothing drawn"
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

/// Study of a directory.
fn loaded(dir: &Path) -> Result<Study, Failure> {
    refuse_no_directory(dir)?;
    if Format::found_in(dir) == Some(Format::Parquet) {
        return Err(Failure::work(anyhow!(
            "{} has its tables as Parquet, and figures and scores are made from CSV: `palpate run {}` in another \
             directory writes the same tables so",
            dir.display(),
            dir.join(CONFIG).display()
        )));
    }
    Study::load(dir).map_err(Failure::work)
}

/// The study as manifests name it, with its table.
fn id_of(study: &Study) -> Result<StudyId, Failure> {
    let path = study.dir().join(CONFIG);
    let config = text_of(&path)
        .with_context(|| format!("cannot read {}", path.display()))
        .map_err(Failure::work)?;
    Ok(StudyId::new(study.name(), &config).with_cells_in(study.dir()))
}

/// Names and contents of the files of figures, each an SVG and a PNG.
pub(crate) fn drawings(figures: &[Figure]) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut files = Vec::new();
    for figure in figures {
        let png = figure.png().map_err(Failure::work)?;
        let svg = figure.svg.clone().into_bytes();
        files.push((format!("{}.svg", figure.name), svg));
        files.push((format!("{}.png", figure.name), png));
    }
    Ok(files)
}

pub(crate) fn report(args: &ReportArgs) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = args.dirs.iter().flat_map(|dir| files_of(dir)).collect();
    let guard = || Guard::new(&inputs, args.force);
    let out = Single::new("--out", &args.out, guard())?;
    let studies = args
        .dirs
        .iter()
        .map(|dir| loaded(dir))
        .collect::<Result<Vec<_>, _>>()?;
    for study in &studies {
        let claims = claims_csv(&score(std::slice::from_ref(study)));
        let mut folder = Folder::open(study.dir(), Guard::new([], args.force))?;
        folder.write(&[(CLAIMS, claims)], Some(&id_of(study)?))?;
    }
    let page = page(&studies).map_err(Failure::work)?;
    out.write(page.as_bytes())?;
    let scores = score(&studies);
    out.print(&scorecard_lines(&scores))?;
    out.print(&format!("page -> {}", args.out.display()))
}

/// Files of a study, which its page is made from.
fn files_of(dir: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten();
    let is_page = |path: &PathBuf| path.extension().is_some_and(|kind| kind == "html");
    entries
        .map(|entry| entry.path())
        .filter(|path| !is_page(path))
        .collect()
}
