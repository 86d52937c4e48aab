//! Makes the options of estimates from recorded readings that depend on the simulated sensor of a study. The options of
//! other estimates follow from the config alone:
//! [`GlideOptions::from_study`](crate::recorded::GlideOptions::from_study) and
//! [`PictureOptions::from_study`](crate::recorded::PictureOptions::from_study).
//!
//! Each function converts the study's lengths to the unit of the readings.
//!
//! # Errors
//! [`StudyMismatch`] for a scene of another kind, for a unit that cannot be converted, and for a config that does not
//! describe a possible scene.

use palpate_recorded::{PressOptions, RollOptions, StudyMismatch};
use palpate_scene::{PressScene, RollScene, SharedModels};
use palpate_study::config::{LengthUnit, StudyConfig};

/// Options of `estimate_roll`. The stated noise is the noise of the study's simulated sensor.
#[expect(clippy::missing_errors_doc, reason = "the module has them")]
pub fn roll(study: &StudyConfig, unit: LengthUnit) -> Result<RollOptions, StudyMismatch> {
    RollOptions::from_study(study, unit, |config| {
        let scene = RollScene::new(config, study.seed)?;
        Ok((
            scene.reading_noise(),
            scene.series_noise().unwrap_or_default(),
        ))
    })
}

/// Options of `estimate_press`. The study states the standard deviations in these options as settings of its estimator.
#[expect(clippy::missing_errors_doc, reason = "the module has them")]
pub fn press(study: &StudyConfig, unit: LengthUnit) -> Result<PressOptions, StudyMismatch> {
    PressOptions::from_study(study, unit, |config| {
        let models = SharedModels::default();
        let scene = PressScene::new(config, study.length_unit, study.seed, &models)?;
        Ok(scene.stated_stds())
    })
}
