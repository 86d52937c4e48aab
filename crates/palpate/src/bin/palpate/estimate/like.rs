//! Settings of a study for recorded readings.

use palpate_scene::recorded::LikeError;
use palpate_study::config::{self, LengthUnit, StudyConfig};

use crate::cli::LikeArgs;
use crate::failure::Failure;

/// Options like those of the study that the arguments name, if they name one, with lengths in the readings' unit; where
/// that is not stated, in the study's.
pub(crate) fn like<T>(
    args: &LikeArgs,
    unit: Option<LengthUnit>,
    options: fn(&StudyConfig, LengthUnit) -> Result<T, LikeError>,
) -> Result<Option<T>, Failure> {
    let Some(file) = &args.like else {
        return Ok(None);
    };
    let study = config::load(file).map_err(Failure::usage)?;
    let Ok(cell) = study.cell(args.cell) else {
        return Err(Failure::no_cell(args.cell, &study));
    };
    let unit = unit.unwrap_or(cell.config.length_unit);
    options(&cell.config, unit)
        .map(Some)
        .map_err(|error| Failure::usage(study.error_at(args.cell, error.path(), error.to_string())))
}
