//! Computes the options of an estimate from a study.

use palpate_study::config::{
    FingertipConfig, GlideSensorConfig, LengthUnit, PadLayout, PressConfig, PressProbeConfig,
    ProbeConfig, Reports, RollConfig, RollSensorConfig, SceneConfig, StudyConfig, in_unit,
};

use super::glide_options::{GlideOptions, TipReports};
use super::press_options::PressOptions;
use super::roll_options::RollOptions;
use super::roll_series::SeriesOptions;
use palpate_ep1::{PadCell, ReadingNoise, SeriesNoise};
use palpate_geometry::ShapeThresholds;
use palpate_study::FieldError;

pub(super) fn factor(study: &StudyConfig, unit: LengthUnit) -> Result<f64, FieldError> {
    study.length_unit.to(unit).ok_or_else(|| {
        let [of_study, of_readings] = [study.length_unit, unit].map(LengthUnit::as_str);
        let message = format!(
            "the unit of the study is {of_study}, but the unit of the readings is {of_readings}"
        );
        FieldError::at("length_unit", message)
    })
}

pub(super) fn press_of(study: &StudyConfig) -> Result<&PressConfig, FieldError> {
    match &study.scene {
        SceneConfig::Press(press) => Ok(press),
        scene => Err(other_kind("press", scene)),
    }
}

fn other_kind(needed: &str, scene: &SceneConfig) -> FieldError {
    let found = scene.kind();
    let message = format!("must be {needed:?} for these readings, is {found:?}");
    FieldError::at("scene.kind", message)
}

impl RollOptions {
    /// Options with the probe and the estimator of a study. `noise` computes the noise of the study's sensor and of its
    /// time series. Lengths are converted to `unit`.
    ///
    /// # Errors
    /// [`FieldError`] if the scene is of another kind, if the unit cannot be converted, or if `noise` fails.
    pub fn from_study(
        study: &StudyConfig,
        unit: LengthUnit,
        noise: impl FnOnce(&RollConfig) -> Result<(ReadingNoise, SeriesNoise), FieldError>,
    ) -> Result<Self, FieldError> {
        let SceneConfig::Roll(config) = &study.scene else {
            return Err(other_kind("roll", &study.scene));
        };
        let factor = factor(study, unit)?;
        let ProbeConfig::Sphere { radius } = config.probe;
        let (noise, series_noise) = noise(config)?;
        let (pads, contact_std) = match config.sensor {
            RollSensorConfig::Ideal => (None, 0.0),
            RollSensorConfig::Wrist { std } => (None, std * factor),
            RollSensorConfig::Pads { pitch, layout, .. } => {
                let pads = PadCell {
                    pitch: pitch * factor,
                    is_hexagonal: layout == PadLayout::Hexagonal,
                };
                (Some(pads).filter(|_| layout != PadLayout::Uniform), 0.0)
            }
        };
        Ok(Self {
            series: SeriesOptions {
                start: None,
                pads,
                contact_std,
                noise: series_noise,
            },
            estimator: in_unit(&config.estimator, factor),
            length_unit: Some(unit),
            noise: ReadingNoise {
                shift_std: noise.shift_std * factor,
                shift_resolution: noise.shift_resolution * factor,
                ..noise
            },
            ..Self::new(radius * factor)
        })
    }
}

impl GlideOptions {
    /// Options with the estimator, the inter-finger distance and the thresholds of a study. If the study's sensor
    /// reports the lowest point of a round fingertip instead of the contact, the options also contain the radius of the
    /// fingertip. Lengths are converted to `unit`.
    ///
    /// # Errors
    /// [`FieldError`] if the scene is of another kind, if the unit cannot be converted, or if the thresholds
    /// contradict each other.
    pub fn from_study(study: &StudyConfig, unit: LengthUnit) -> Result<Self, FieldError> {
        let SceneConfig::Glide(config) = &study.scene else {
            return Err(other_kind("glide", &study.scene));
        };
        let factor = factor(study, unit)?;
        let evaluate = &config.evaluate;
        let thresholds = ShapeThresholds::new(
            evaluate.gaussian_threshold / (factor * factor),
            evaluate.mean_threshold / factor,
        )
        .map_err(|error| FieldError::at("scene.evaluate", error))?;
        // The radius of the fingertip is needed only if the sensor reports the lowest point of a round tip instead of
        // the contact.
        let tip_radius = match (&config.probe, &config.sensor) {
            (
                FingertipConfig::Sphere { radius },
                GlideSensorConfig::Ideal {
                    reports: Reports::LowestPoint,
                    ..
                },
            ) => Some(radius * factor),
            _ => None,
        };
        Ok(Self {
            estimator: in_unit(&config.estimator, factor),
            length_unit: Some(unit),
            gaussian_threshold: Some(thresholds.gaussian()),
            mean_threshold: Some(thresholds.mean()),
            inter_finger_distance: Some(config.motion.inter_finger_distance * factor),
            tip_radius,
            reports: tip_radius.map(|_| TipReports::LowestPoint),
            ..Self::default()
        })
    }
}

impl PressOptions {
    /// Options with the sensor and the estimator of a study. Lengths are converted to `unit`. The study's indentation
    /// is not used, because the recorded press has another indentation. `stated_stds` computes the standard deviations
    /// of normal and tangential displacements that the study's estimator assumes.
    ///
    /// # Errors
    /// [`FieldError`] if the scene is of another kind, if the unit cannot be converted, or if `stated_stds` fails.
    pub fn from_study(
        study: &StudyConfig,
        unit: LengthUnit,
        stated_stds: impl FnOnce(&PressConfig) -> Result<[Option<f64>; 2], FieldError>,
    ) -> Result<Self, FieldError> {
        let config = press_of(study)?;
        let factor = factor(study, unit)?;
        let [normal_std, tangential_std] =
            stated_stds(config)?.map(|std| std.map(|std| std * factor));
        Ok(Self {
            model: in_unit(&config.model, factor),
            estimator: in_unit(&config.estimator, factor),
            normal_std,
            tangential_std,
            length_unit: Some(unit),
            ..Self::of_probe(&in_unit(&config.probe, factor))
        })
    }

    pub(super) fn of_probe(probe: &PressProbeConfig) -> Self {
        let PressProbeConfig::MarkerSphere {
            radius,
            marker_depth,
            ..
        } = *probe;
        Self {
            marker_depth: Some(marker_depth),
            ..Self::new(radius)
        }
    }
}
