//! Options for estimates from recorded readings, taken from a study. This module contains the options that need the
//! simulated sensor of the study. The options of glides and images follow from the config alone:
//! [`GlideOptions::from_study`](crate::recorded::GlideOptions::from_study) and
//! [`PictureOptions::from_study`](crate::recorded::PictureOptions::from_study).
//!
//! Each function converts the study's lengths to the unit of the readings.
//!
//! # Errors
//! [`StudyMismatch`] if the study is of another kind, if its unit cannot be converted, or if its config does not
//! describe a possible scene.

use palpate_recorded::{PressOptions, RollOptions, StudyMismatch};
use palpate_scene::{PressScene, RollScene, SharedModels};
use palpate_study::config::{LengthUnit, StudyConfig};

/// Options of `estimate_roll`, taken from a study of rolls. The noise is that of the study's simulated sensor.
#[expect(clippy::missing_errors_doc, reason = "the module has them")]
pub fn roll(study: &StudyConfig, unit: LengthUnit) -> Result<RollOptions, StudyMismatch> {
    RollOptions::from_study(study, unit, |config| {
        let scene = RollScene::new(config, study.seed)?;
        Ok((scene.reading_noise, scene.series_noise.unwrap_or_default()))
    })
}

/// Options of `estimate_press`, taken from a study of presses. The standard deviations are those that the study's
/// estimator assumes.
#[expect(clippy::missing_errors_doc, reason = "the module has them")]
pub fn press(study: &StudyConfig, unit: LengthUnit) -> Result<PressOptions, StudyMismatch> {
    PressOptions::from_study(study, unit, |config| {
        let models = SharedModels::default();
        let scene = PressScene::new(config, study.length_unit, study.seed, &models)?;
        Ok(scene.stated_stds)
    })
}
