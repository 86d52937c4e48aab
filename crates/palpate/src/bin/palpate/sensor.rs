//! Implements the command `palpate sensor`.

mod calibrate;
mod track;

use palpate_estimators::CutPattern;
use palpate_study::config;

use crate::cli::{PatternArgs, SensorCommand};
use crate::failure::Failure;
use crate::output::{self, Guard, LockedDir, StudyId};

pub(crate) fn sensor(command: &SensorCommand) -> Result<(), Failure> {
    match command {
        SensorCommand::Pattern(args) => pattern(args),
        SensorCommand::Calibrate(args) => calibrate::calibrate(args),
        SensorCommand::Track(args) => track::track(args),
    }
}

fn pattern(args: &PatternArgs) -> Result<(), Failure> {
    let study = config::load(&args.config).map_err(Failure::usage)?;
    let pattern = CutPattern::of(&study).map_err(Failure::usage)?;
    let percent = |strain: f64| 100.0 * strain;
    let summary = format!(
        "{}: {} gores with {} markers; folding stretches them by {:.1} % at most, {:.1} % rms -> {}",
        study.config.name,
        pattern.gores,
        pattern.markers,
        percent(pattern.fold_strain.greatest),
        percent(pattern.fold_strain.rms),
        args.out.display()
    );
    let of_study = StudyId::new(&study.config.name, &palpate::resolved(&study));
    let mut folder = LockedDir::open(&args.out, Guard::new([&args.config], args.force))?;
    folder.write(
        &[
            ("pattern.svg", pattern.svg),
            ("pattern.dxf", pattern.dxf),
            ("strain.csv", pattern.strain.to_csv()),
            ("strain-by-gores.csv", pattern.strain_by_gores.to_csv()),
        ],
        Some(&of_study),
    )?;
    output::print(&summary)
}
