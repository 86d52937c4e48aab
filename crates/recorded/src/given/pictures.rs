//! Settings of an estimate from the frames of a press.

use palpate_study::config::{Range, with_settings};
use serde_json::Value as Json;

use super::super::pictured::PictureOptions;
use super::super::pressed::PressOptions;
use super::super::wording::{GivenError, Wording};
use super::press::{PressGiven, possible, useful_std};

impl PictureOptions {
    /// Options from the given settings, and from the study's `base` for all others.
    ///
    /// # Errors
    /// [`GivenError`] without a study, for a setting that a fit of pictures does not use or that is out of its range,
    /// and for lengths that do not fit into the sensor.
    pub fn given(
        given: &PressGiven,
        base: Option<Self>,
        wording: Wording,
    ) -> Result<Self, GivenError> {
        let method = wording.with("kind", "image");
        let Some(base) = base else {
            let like = wording.with("like", "STUDY.toml");
            let message = format!(
                "{method} needs {like}: a study of a press before a camera, which states layout, discs, body, camera and noise"
            );
            return Err(wording.refused("like", message));
        };
        for (key, value) in [
            ("sensor_radius", given.sensor_radius),
            ("depth", given.depth),
            ("normal_std", given.normal_std),
            ("tangential_std", given.tangential_std),
            ("radial_scale", given.radial_scale),
        ] {
            if value.is_some() {
                let like = wording.name("like");
                let name = wording.name(key);
                let message = format!(
                    "{name} is of no use to {method}: the study of {like} states the sensor, the tracker the noise"
                );
                return Err(wording.refused(key, message));
            }
        }
        wording.check([
            ("indentation", given.indentation, Range::POSITIVE),
            ("young", given.young, Range::POSITIVE),
        ])?;
        let mut settings = given.estimator.clone();
        settings.insert("kind".to_owned(), Json::from("image"));
        let mut press = base.press;
        press.estimator = with_settings(&press.estimator, &settings)
            .map_err(|error| wording.of_estimator(error))?;
        let options = PressOptions {
            indentation: given.indentation,
            estimator: press.estimator.clone(),
            model: press.model.clone(),
            ..PressOptions::of_probe(&press.probe)
        };
        useful_std(given, wording)?;
        possible(&options, wording)?;
        Ok(Self {
            press,
            indentation: given.indentation,
            young: given.young,
            ..base
        })
    }
}
