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

/// Reason why the settings of a study cannot be used for recorded readings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyMismatch {
    /// The scene of the study is of another kind than the readings.
    #[error("must be {needed:?} for these readings, is {found:?}")]
    Kind {
        /// Kind of scene that the readings need.
        needed: &'static str,
        /// Kind of scene that the study describes.
        found: &'static str,
    },
    /// The lengths in the study cannot be converted to the unit of the readings.
    #[error("the unit of the study is {}, but the unit of the readings is {}", study.as_str(), readings.as_str())]
    Unit {
        /// Unit of lengths in the study.
        study: LengthUnit,
        /// Unit of lengths in the readings.
        readings: LengthUnit,
    },
    /// A field of the study is invalid.
    #[error("{}", .0.message)]
    Plan(FieldError),
}

impl StudyMismatch {
    /// Path of the study's field that causes the problem.
    pub fn path(&self) -> &str {
        match self {
            Self::Kind { .. } => "scene.kind",
            Self::Unit { .. } => "length_unit",
            Self::Plan(error) => &error.path,
        }
    }
}

impl From<FieldError> for StudyMismatch {
    fn from(error: FieldError) -> Self {
        Self::Plan(error)
    }
}

pub(super) fn factor(study: &StudyConfig, unit: LengthUnit) -> Result<f64, StudyMismatch> {
    study.length_unit.to(unit).ok_or(StudyMismatch::Unit {
        study: study.length_unit,
        readings: unit,
    })
}

pub(super) fn press_of(study: &StudyConfig) -> Result<&PressConfig, StudyMismatch> {
    match &study.scene {
        SceneConfig::Press(press) => Ok(press),
        scene => Err(other_kind("press", scene)),
    }
}

fn other_kind(needed: &'static str, scene: &SceneConfig) -> StudyMismatch {
    let found = scene.kind();
    StudyMismatch::Kind { needed, found }
}

impl RollOptions {
    /// Options with the probe and the estimator of a study. `noise` computes the noise of the study's sensor and of its
    /// time series. Lengths are converted to `unit`.
    ///
    /// # Errors
    /// [`StudyMismatch`] if the scene is of another kind, if the unit cannot be converted, or if `noise` fails.
    pub fn from_study(
        study: &StudyConfig,
        unit: LengthUnit,
        noise: impl FnOnce(&RollConfig) -> Result<(ReadingNoise, SeriesNoise), FieldError>,
    ) -> Result<Self, StudyMismatch> {
        let SceneConfig::Roll(config) = &study.scene else {
            return Err(other_kind("roll", &study.scene));
        };
        let factor = factor(study, unit)?;
        let ProbeConfig::Sphere { radius } = config.probe;
        let (noise, series_noise) = noise(config)?;
        let (pads, contact_std) = match config.sensor {
            RollSensorConfig::Ideal => (None, 0.0),
            RollSensorConfig::Wrist { std } => (None, std * factor),
            RollSensorConfig::Pads { pitch, layout, .. } => match layout {
                PadLayout::Square => (Some(PadCell::square(pitch * factor)), 0.0),
                PadLayout::Hexagonal => (Some(PadCell::hexagonal(pitch * factor)), 0.0),
                PadLayout::Uniform => (None, 0.0),
            },
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
    /// [`StudyMismatch`] if the scene is of another kind, if the unit cannot be converted, or if the thresholds
    /// contradict each other.
    pub fn from_study(study: &StudyConfig, unit: LengthUnit) -> Result<Self, StudyMismatch> {
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
    /// [`StudyMismatch`] if the scene is of another kind, if the unit cannot be converted, or if `stated_stds` fails.
    pub fn from_study(
        study: &StudyConfig,
        unit: LengthUnit,
        stated_stds: impl FnOnce(&PressConfig) -> Result<[Option<f64>; 2], FieldError>,
    ) -> Result<Self, StudyMismatch> {
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
