//! Reads the settings of an estimate from the study that `--like` names.

use palpate_recorded::StudyMismatch;
use palpate_study::config::{self, LengthUnit, Study, StudyConfig};

use crate::cli::LikeArgs;
use crate::failure::Failure;

/// The study that `--like` names. It supplies every setting that no flag states.
pub(crate) struct Like {
    study: Study,
    cell: usize,
    pub(crate) config: StudyConfig,
}

impl Like {
    pub(crate) fn of(args: &LikeArgs) -> Result<Option<Self>, Failure> {
        let Some(file) = &args.like else {
            return Ok(None);
        };
        let study = config::load(file).map_err(Failure::usage)?;
        let Ok(cell) = study.cell(args.cell) else {
            return Err(Failure::no_cell(args.cell, &study));
        };
        Ok(Some(Self {
            study,
            cell: args.cell,
            config: cell.config,
        }))
    }

    /// Options that the study states for an estimate, with lengths in `unit`. If the unit of the readings is unknown
    /// (`None`), lengths keep the unit of the study.
    pub(crate) fn options<T>(
        &self,
        unit: Option<LengthUnit>,
        options: fn(&StudyConfig, LengthUnit) -> Result<T, StudyMismatch>,
    ) -> Result<T, Failure> {
        let unit = unit.unwrap_or(self.config.length_unit);
        options(&self.config, unit).map_err(|error| {
            let message = error.to_string();
            Failure::usage(self.study.error_at(self.cell, error.path(), message))
        })
    }
}
