//! `palpate plot` and `palpate report`.

use palpate_report::{
    Study, draw_press_trace, plot as draw, scorecard_text, write_claims, write_page,
};

use crate::cli::{PlotArgs, ReportArgs};
use crate::failure::Failure;
use crate::output;

pub(crate) fn plot(args: &PlotArgs) -> Result<(), Failure> {
    let study = Study::load(&args.dir).map_err(Failure::work)?;
    let mut files = draw(&study).map_err(Failure::work)?;
    // What a camera saw of the pass that was traced.
    if args.dir.join("markers.csv").is_file() {
        files.extend(draw_press_trace(&args.dir).map_err(Failure::work)?);
    }
    if files.is_empty() {
        let name = study.name();
        return output::print(&format!("{name} has no [[plot]]; nothing drawn"));
    }
    for file in files {
        output::print(&file.display().to_string())?;
    }
    Ok(())
}

pub(crate) fn report(args: &ReportArgs) -> Result<(), Failure> {
    let studies = args
        .dirs
        .iter()
        .map(Study::load)
        .collect::<Result<Vec<_>, _>>()
        .map_err(Failure::work)?;
    for study in &studies {
        write_claims(study).map_err(Failure::work)?;
    }
    write_page(&studies, &args.out).map_err(Failure::work)?;
    output::print(&scorecard_text(&palpate_report::score(&studies)))?;
    output::print(&format!("page -> {}", args.out.display()))
}
