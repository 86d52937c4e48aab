//! `palpate trace`.

use anyhow::anyhow;
use palpate_report::{Files, press_figures};
use palpate_scene::Scene;
use palpate_scene::Scenes;
use palpate_study::config;

use crate::cli::TraceArgs;
use crate::failure::Failure;
use crate::results::write_figures;
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
    let rows = traced.contacts;
    let what = match &scene {
        Scene::Roll(_) => {
            let probes = counted(traced.readings, "probe");
            format!("{} of {probes}", counted(rows, "contact"))
        }
        Scene::Glide(glide) => {
            let fingers = counted(glide.fingers(), "finger");
            format!("{} of {fingers}", counted(rows, "contact"))
        }
        Scene::Press(press) => {
            let unit = study.config.length_unit.as_str();
            let told = press.told_indentation(args.trial);
            let camera = press
                .px_per_rad()
                .map_or(String::new(), |f| format!(", seen with {f:.3} px per rad"));
            let read = match traced.readings {
                all if all == rows => String::new(),
                some => format!("{some} of "),
            };
            let markers = counted(rows, "marker");
            format!("{read}{markers} under an indentation told as {told} {unit}{camera}")
        }
        Scene::Fingertip(_) => String::new(),
    };
    output::write_files(&args.out, &traced.files)?;
    if traced.is_seen {
        let figures = press_figures(&Files::in_folder(&args.out)).map_err(Failure::work)?;
        write_figures(&args.out, &figures)?;
    }
    output::print(&format!(
        "{}: {what} -> {}",
        study.config.name,
        args.out.display()
    ))
}

fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}
