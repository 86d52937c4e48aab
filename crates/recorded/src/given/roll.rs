//! Settings of an estimate from rolls.

use std::f64::consts::PI;

use palpate_ep1::ReadingNoise;
use palpate_statistics::BadSetting;
use palpate_study::config::{LengthUnit, Range, with_settings};
use serde_json::{Map, Value as Json};

use super::super::roll::RollOptions;
use super::super::wording::{GivenError, Wording};

/// Settings given for an estimate from rolls; `None` if not given. Lengths are in the readings' unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RollGiven {
    /// The probe's radius; needed unless a study states it.
    pub probe_radius: Option<f64>,
    /// Settings of the estimator by their config keys, including `kind`.
    pub estimator: Map<String, Json>,
    /// Pitch of the pads, from which the noise of shifts is computed.
    pub pitch: Option<f64>,
    /// Standard deviation of each component of a shift, for a sensor without pads.
    pub shift_std: Option<f64>,
    /// Standard deviation of each component of a rotation, rad.
    pub rotation_std_rad: Option<f64>,
    /// Standard deviation of each component of a rotation, as a fraction of its magnitude.
    pub relative_rotation_std: Option<f64>,
    /// Unit of lengths, where the readings do not state it.
    pub length_unit: Option<LengthUnit>,
}

impl RollOptions {
    /// Options from the given settings, and from `base` for all others.
    ///
    /// ```
    /// use palpate_recorded::{RollGiven, RollOptions, Wording};
    ///
    /// let given = RollGiven { probe_radius: Some(10.0), pitch: Some(-0.5), ..RollGiven::default() };
    /// let error = RollOptions::given(&given, None, Wording::Arguments).expect_err("no pitch");
    /// assert_eq!(error.to_string(), "pitch is -0.5; it must be finite and > 0");
    /// assert_eq!((error.setting.as_str(), error.value), ("pitch", Some(-0.5)));
    /// ```
    ///
    /// # Errors
    /// [`GivenError`] for a setting that is missing, out of its range or without effect.
    pub fn given(
        given: &RollGiven,
        base: Option<Self>,
        wording: Wording,
    ) -> Result<Self, GivenError> {
        let up_to = |most: f64| Range {
            most: Some(most),
            ..Range::NOT_NEGATIVE
        };
        wording.check([
            ("probe_radius", given.probe_radius, Range::POSITIVE),
            ("pitch", given.pitch, Range::POSITIVE),
            ("shift_std", given.shift_std, Range::POSITIVE),
            ("rotation_std_rad", given.rotation_std_rad, up_to(PI)),
            (
                "relative_rotation_std",
                given.relative_rotation_std,
                up_to(1.0),
            ),
        ])?;
        let base = match (base, given.probe_radius) {
            (Some(base), _) => base,
            (None, Some(radius)) => Self::new(radius),
            (None, None) => {
                let radius = wording.with("probe_radius", "R");
                return Err(wording.refused("probe_radius", format!("needs {radius}")));
            }
        };
        let probe_radius = given.probe_radius.unwrap_or(base.probe_radius);
        let refused =
            |error: BadSetting<String>| wording.bad(error.setting, error.value, &error.expected);
        let shifts = match (given.pitch, given.shift_std) {
            (Some(_), Some(_)) => {
                let [pitch, std] = ["pitch", "shift_std"].map(|key| wording.name(key));
                let message = format!("{std} is of use only without {pitch}");
                return Err(wording.refused("shift_std", message));
            }
            (Some(pitch), None) => Self::noise_of_pads(probe_radius, pitch).map_err(refused)?,
            (None, Some(std)) => Self::noise_of_shifts(probe_radius, std).map_err(refused)?,
            (None, None) => base.noise,
        };
        let rotations = base.noise;
        let estimator = match given.estimator.is_empty() {
            true => base.estimator,
            false => with_settings(&base.estimator, &given.estimator)
                .map_err(|error| wording.of_estimator(error))?,
        };
        Ok(Self {
            probe_radius,
            estimator,
            noise: ReadingNoise {
                rotation_std_rad: given.rotation_std_rad.unwrap_or(rotations.rotation_std_rad),
                relative_rotation_std: given
                    .relative_rotation_std
                    .unwrap_or(rotations.relative_rotation_std),
                ..shifts
            },
            length_unit: given.length_unit.or(base.length_unit),
        })
    }
}
