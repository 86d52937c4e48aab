//! `palpate trace`.

use anyhow::anyhow;
use palpate_scene::Scenes;
use palpate_study::config;

use crate::cli::TraceArgs;
use crate::failure::Failure;
use crate::{output, run};

pub(crate) fn trace(args: &TraceArgs) -> Result<(), Failure> {
    let study = config::load(&args.config).map_err(Failure::usage)?;
    let cells = study.cells.len();
    if args.cell >= cells {
        let last = cells - 1;
        return Err(Failure::Usage(anyhow!(
            "--cell is {}; the study has cells 0 to {last}",
            args.cell
        )));
    }
    let scene = study.scene(args.cell).map_err(Failure::usage)?;
    let traced = run::trace_files(&study, &scene, args.trial)?;
    output::write_files(&args.out, &traced.files)?;
    if traced.is_seen {
        palpate_report::draw_press_trace(&args.out).map_err(Failure::work)?;
    }
    output::print(&format!(
        "{}: {} -> {}",
        study.config.name,
        traced.what,
        args.out.display()
    ))
}
