//! Settings of an estimate from rolls.

use std::f64::consts::SQRT_2;

use palpate_ep1::{PadCell, PadStart, ReadingNoise, SeriesNoise};
use palpate_statistics::Number;
use palpate_study::config::{
    LengthUnit, PadLayout, RollEstimatorConfig, SettingError, SettingTable, split_settings,
    with_settings,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use super::roll_series::SeriesOptions;

/// Settings of rolls as a user states them; `None` for settings that are not given. Lengths are in the unit of the
/// readings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RollSettings {
    /// The probe's radius, in the readings' length unit. It must be given unless setting `like` is given.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub probe_radius: Option<f64>,
    /// Pitch of the pads, in the readings' length unit. With a pitch, the estimates have standard errors. In addition,
    /// a roll whose contact did not move sets an upper bound on the object's radius.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub pitch: Option<f64>,
    /// For a sensor without pads: standard deviation of each component of the contact's shift or, in time series, of
    /// the contact point. It is in the readings' length unit.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub shift_std: Option<f64>,
    /// Standard deviation of each component of a rotation, rad. In time series, each sample has its own error.
    #[schemars(extend("minimum" = 0, "maximum" = std::f64::consts::PI))]
    pub rotation_std_rad: Option<f64>,
    /// Standard deviation of each component of a rotation, as a fraction of the rotation's magnitude. In time series,
    /// the relative error is the same for all samples of a roll.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub relative_rotation_std: Option<f64>,
    /// Arrangement of the pads, for time series; square by default.
    pub pad_layout: Option<PadLayout>,
    /// Contact point at the start of every time series, in the coordinates of the pads and in the readings' length unit.
    /// By default it is unknown.
    #[schemars(extend("x-unit" = "length"))]
    pub start: Option<[f64; 2]>,
}

impl SettingTable for RollSettings {}

/// Settings of an estimate from rolls, in addition to the readings.
#[derive(Clone, Debug, PartialEq)]
pub struct RollOptions {
    /// The probe's radius, in the readings' length unit.
    pub probe_radius: f64,
    /// The estimator and its settings.
    pub estimator: RollEstimatorConfig,
    /// Unit of lengths, used if the header does not state it.
    pub length_unit: Option<LengthUnit>,
    /// Noise and resolution of the readings, with lengths in the readings' length unit. If no noise is stated, standard
    /// errors follow from the residuals.
    pub noise: ReadingNoise,
    /// Settings of the methods for time series.
    pub series: SeriesOptions,
}

impl RollOptions {
    /// Options that state only the probe's radius.
    pub fn new(probe_radius: f64) -> Self {
        Self {
            probe_radius,
            estimator: RollEstimatorConfig::default(),
            length_unit: None,
            noise: ReadingNoise::default(),
            series: SeriesOptions::default(),
        }
    }

    /// Replaces the noise of one sample of a time series by the noise of the difference between the last and the first
    /// sample. `has_start_rotations` states whether the rotation of the first sample was measured, so that it has an
    /// error too.
    pub(super) fn difference_noise(&mut self, has_start_rotations: bool) {
        let (series, noise) = (&self.series, &mut self.noise);
        if series.contact_std > 0.0 && noise.shift_resolution == 0.0 {
            noise.shift_std = SQRT_2 * series.contact_std;
        }
        if has_start_rotations {
            let of_sample = series.noise.rotation_std_rad;
            noise.rotation_std_rad = libm::hypot(noise.rotation_std_rad, of_sample);
        }
    }

    /// Noise of the readings of a probe with pads. Each roll is assumed to start at a random place on a pad.
    ///
    /// # Errors
    /// [`SettingError`] if the pitch is larger than the probe's radius or smaller than 1e-15 of it. The limits are the
    /// same as in a study.
    pub fn noise_of_pads(probe_radius: f64, pitch: f64) -> Result<ReadingNoise, SettingError> {
        let refuse = |expected: String| Err(SettingError::of_number("pitch", pitch, expected));
        let radius = Number(probe_radius);
        match pitch {
            _ if !(pitch > 0.0 && pitch <= probe_radius) => {
                refuse(format!("> 0 and at most the probe's radius, {radius}"))
            }
            _ if pitch < 1e-15 * probe_radius => {
                refuse("at least 1e-15 of the probe's radius".to_owned())
            }
            _ => Ok(ReadingNoise::of_pads(pitch, PadStart::PerRoll)),
        }
    }

    /// Returns options in which the settings `given` replace the values of `base`. The keys of `given` are the fields
    /// of [`RollSettings`] and the settings of the estimator.
    ///
    /// ```
    /// use palpate_recorded::RollOptions;
    ///
    /// let given = serde_json::json!({ "probe_radius": 10.0, "pitch": -0.5 });
    /// let given = given.as_object().ok_or("a table")?;
    /// let error = RollOptions::with_settings(None, given, None).expect_err("no pitch");
    /// assert_eq!(error.to_string(), "setting `pitch` is -0.5; it must be finite and > 0");
    /// assert_eq!((error.key.as_str(), error.value), ("pitch", Some(-0.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SettingError`] if a setting is missing, out of its range or without effect.
    pub fn with_settings(
        base: Option<Self>,
        given: &Map<String, Json>,
        length_unit: Option<LengthUnit>,
    ) -> Result<Self, SettingError> {
        let [own, of_estimator] = split_settings::<RollSettings>(given);
        let own = with_settings(&RollSettings::default(), &own)?;
        let base = base.or(own.probe_radius.map(Self::new)).ok_or_else(|| {
            SettingError::new("probe_radius", "is needed, unless setting `like` is stated")
        })?;
        let probe_radius = own.probe_radius.unwrap_or(base.probe_radius);
        let shifts = match (own.pitch, own.shift_std) {
            (Some(_), Some(_)) => {
                let reason = "has an effect only without setting `pitch`";
                return Err(SettingError::new("shift_std", reason));
            }
            (Some(pitch), None) => {
                let square = Self::noise_of_pads(probe_radius, pitch)?;
                let cell = base.series.pads.filter(|_| own.pad_layout.is_none());
                let scale = cell.map(|cell| pitch / cell.pitch);
                scale.map_or(square, |scale| ReadingNoise {
                    shift_std: scale * base.noise.shift_std,
                    shift_resolution: scale * base.noise.shift_resolution,
                    ..base.noise
                })
            }
            (None, Some(std)) if std > probe_radius => {
                let radius = Number(probe_radius);
                let expected = format!("at least 0 and at most the probe's radius, {radius}");
                return Err(SettingError::of_number("shift_std", std, expected));
            }
            (None, Some(shift_std)) => ReadingNoise {
                shift_std,
                ..ReadingNoise::default()
            },
            (None, None) => base.noise,
        };
        let series = Self::series(&own, base.series)?;
        let rotations = base.noise;
        Ok(Self {
            series,
            probe_radius,
            estimator: with_settings(&base.estimator, &of_estimator)?,
            noise: ReadingNoise {
                rotation_std_rad: own.rotation_std_rad.unwrap_or(rotations.rotation_std_rad),
                relative_rotation_std: own
                    .relative_rotation_std
                    .unwrap_or(rotations.relative_rotation_std),
                is_rotation_measured: own.relative_rotation_std.is_some()
                    || rotations.is_rotation_measured,
                ..shifts
            },
            length_unit: length_unit.or(base.length_unit),
        })
    }

    fn series(own: &RollSettings, base: SeriesOptions) -> Result<SeriesOptions, SettingError> {
        let pitch = own.pitch.or(base.pads.map(|cell| cell.pitch));
        let pads = |pitch, is_hexagonal| {
            Some(PadCell {
                pitch,
                is_hexagonal,
            })
        };
        let layout = match own.pad_layout {
            None if own.pitch.is_some() && base.pads.is_some_and(|cell| cell.is_hexagonal) => {
                Some(PadLayout::Hexagonal)
            }
            stated => stated,
        };
        let pads = match (layout, pitch) {
            (None | Some(PadLayout::Square), Some(pitch)) if own.pitch.is_some() => {
                pads(pitch, false)
            }
            (None, _) => base.pads.filter(|_| own.shift_std.is_none()),
            (Some(PadLayout::Square), Some(pitch)) => pads(pitch, false),
            (Some(PadLayout::Hexagonal), Some(pitch)) => pads(pitch, true),
            (Some(PadLayout::Uniform), _) => {
                let reason = "must be square or hexagonal: other pads have no straight edges";
                return Err(SettingError::new("pad_layout", reason));
            }
            (Some(_), None) => {
                let reason = "has an effect only with setting `pitch`";
                return Err(SettingError::new("pad_layout", reason));
            }
        };
        Ok(SeriesOptions {
            start: own.start.or(base.start),
            pads,
            contact_std: own.shift_std.unwrap_or(base.contact_std),
            noise: SeriesNoise {
                rotation_std_rad: own.rotation_std_rad.unwrap_or(base.noise.rotation_std_rad),
                relative_rotation_std: own
                    .relative_rotation_std
                    .unwrap_or(base.noise.relative_rotation_std),
                ..base.noise
            },
        })
    }
}
