//! `palpate trace`.

use palpate::{Trace, TraceError, load};

use palpate_report::{Files, press_figures};

use crate::cli::TraceArgs;
use crate::failure::Failure;
use crate::output::names::{FRAMES, MARKERS, READINGS, TRACE};
use crate::output::{self, Folder, Guard, StudyId};
use crate::results::drawings;

pub(crate) use palpate::resolved;

pub(crate) fn trace(args: &TraceArgs) -> Result<(), Failure> {
    let study = load(&args.config).map_err(Failure::usage)?;
    if args.cell >= study.cell_count() {
        return Err(Failure::no_cell(args.cell, &study));
    }
    let trace = palpate::trace(&study, args.cell, args.trial).map_err(refused)?;
    let of_study = StudyId::new(&study.config.name, &resolved(&study));
    let mut folder = Folder::open(&args.out, Guard::new([&args.config], args.force))?;
    let mut drawn = Vec::new();
    if trace.camera.is_some() {
        let tables = [
            (TRACE, trace.contacts.to_csv()),
            (READINGS, trace.readings.to_csv()),
        ];
        let figures = press_figures(&Files::in_memory(tables)).map_err(Failure::work)?;
        drawn = drawings(&figures)?;
    }
    let mut files = files(&trace)?;
    files.extend(
        drawn
            .iter()
            .map(|(name, bytes)| (name.as_str(), bytes.clone())),
    );
    folder.write(&files, Some(&of_study))?;
    output::print(&format!(
        "{}: {} -> {}",
        study.config.name,
        trace.what,
        args.out.display()
    ))
}

/// Names and contents of the files of a pass.
pub(crate) fn files(trace: &Trace) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
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

/// A config that has no such pass is bad usage; a pass that ends early is not.
pub(crate) fn refused(error: TraceError) -> Failure {
    match error {
        TraceError::Config(error) => Failure::usage(error),
        error => Failure::work(error),
    }
}
