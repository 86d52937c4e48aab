//! Options for estimates from recorded readings, taken from a study. This module contains the options that need the
//! simulated sensor of the study.

use palpate_recorded::{PressOptions, RollOptions};
use palpate_scene::{PressScene, RollScene, SharedModels};
use palpate_study::FieldError;
use palpate_study::config::{LengthUnit, StudyConfig};

/// Options of `estimate_roll`, taken from a study of rolls. The noise is that of the study's simulated sensor. Lengths
/// are converted to `unit`.
///
/// # Errors
/// [`FieldError`] if the study is of another kind, if its unit cannot be converted, or if its config does not describe
/// a possible scene.
pub fn roll_options(study: &StudyConfig, unit: LengthUnit) -> Result<RollOptions, FieldError> {
    RollOptions::from_study(study, unit, |config| {
        let scene = RollScene::new(config, study.seed)?;
        Ok((scene.reading_noise, scene.series_noise.unwrap_or_default()))
    })
}

/// Options of `estimate_press`, taken from a study of presses. The standard deviations are those that the study's
/// estimator assumes. Lengths are converted to `unit`.
///
/// # Errors
/// [`FieldError`] if the study is of another kind, if its unit cannot be converted, or if its config does not describe
/// a possible scene.
pub fn press_options(study: &StudyConfig, unit: LengthUnit) -> Result<PressOptions, FieldError> {
    PressOptions::from_study(study, unit, |config| {
        let models = SharedModels::default();
        let scene = PressScene::new(config, study.length_unit, study.seed, &models)?;
        Ok(scene.stated_stds)
    })
}
