//! Settings of an estimate from a press: from displacements of markers, or from camera frames.

use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{
    LengthUnit, NoiseKnown, PressConfig, PressEstimatorConfig, PressModelConfig, SettingError,
    SettingTable, StudyConfig, in_unit, split_settings, with_settings,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

use super::camera_file::CameraEstimate;
use super::nominal_sensor::NominalSensor;
use super::study_options::{factor, press_of};

/// Settings of an estimate from displacements, in addition to the readings. Lengths are in the unit of the readings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PressOptions {
    /// Radius of the sensor's skin, in the readings' length unit; `inf` for a flat pad. It must be given unless setting
    /// `like` is given.
    #[serde(with = "palpate_study::config::infinite_length")]
    #[schemars(with = "Option<f64>", extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-infinite" = true))]
    pub sensor_radius: Option<f64>,
    /// Depth of the markers under the skin. For readings of a calibrated camera, it must be given unless setting `like`
    /// is given. For other readings, it is 0 by default (markers at the surface), and there is a warning.
    #[serde(rename = "depth")]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub marker_depth: Option<f64>,
    /// Model of the sensor's soft body. It is part of the estimator's settings. The setting `c` of a Gaussian is
    /// calibrated with this model (R = c σ²/δ, with the effective radius R, the width σ and the indentation δ).
    #[serde(skip)]
    pub model: PressModelConfig,
    /// The estimator. Its own setting `indentation`, which is for the presses of a study, is replaced by
    /// [`Self::indentation`].
    #[serde(skip)]
    pub estimator: PressEstimatorConfig,
    /// Indentation, if it was measured separately, for example by the pose of a robot. By default, it is fitted. The
    /// setting `indentation_std` is its standard deviation. If this setting is 0 or not given, 2 % of the indentation
    /// is assumed, with a warning. (In a study, 0 means an exact indentation.) There is also a warning if the
    /// indentation contradicts the readings.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: Option<f64>,
    /// Standard deviation of the noise of each normal displacement. By default, it is estimated from the residuals.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub normal_std: Option<f64>,
    /// Standard deviation of the noise of each component of the tangential displacements. By default, it is estimated
    /// from the residuals.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub tangential_std: Option<f64>,
    /// Factor by which the positions of the markers are multiplied.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radial_scale: f64,
    /// Young's modulus of the soft body, force per squared length unit. If it is given, the output contains the force
    /// and the peak pressure, which are proportional to Young's modulus.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<f64>,
    /// Unit of lengths, used if the header does not state it.
    #[serde(skip)]
    pub length_unit: Option<LengthUnit>,
}

impl SettingTable for PressOptions {}

impl Default for PressOptions {
    fn default() -> Self {
        Self {
            sensor_radius: None,
            marker_depth: None,
            model: PressModelConfig::default(),
            estimator: PressEstimatorConfig::default(),
            indentation: None,
            normal_std: None,
            tangential_std: None,
            radial_scale: 1.0,
            young: None,
            length_unit: None,
        }
    }
}

impl PressOptions {
    /// Options that state only the sensor's radius. The soft body is a half-space with the markers at its surface.
    pub fn new(sensor_radius: f64) -> Self {
        Self {
            sensor_radius: Some(sensor_radius),
            ..Self::default()
        }
    }

    /// Radius of the skin, length. If it is not stated, the result is 0, which every estimate rejects.
    pub(super) fn radius(&self) -> f64 {
        self.sensor_radius.unwrap_or_default()
    }

    /// Depth of the markers under the skin, length; 0 if it is not stated.
    pub(super) fn depth(&self) -> f64 {
        self.marker_depth.unwrap_or_default()
    }

    /// Returns options in which the settings `given` replace the values of `base`. The keys of `given` are the fields
    /// of this struct and the settings of the estimator. For a Gaussian, `thickness` and `poisson` describe the elastic
    /// model that calibrates it.
    ///
    /// ```
    /// use palpate_recorded::PressOptions;
    ///
    /// let given = serde_json::json!({ "sensor_radius": 20.0, "depth": 25.0 });
    /// let given = given.as_object().ok_or("a table")?;
    /// let error = PressOptions::with_settings(None, given, None, true).expect_err("deeper than the core");
    /// assert_eq!(error.key, "depth");
    /// assert_eq!(error.reason, "is 25; it must be less than setting `sensor_radius`, 20");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SettingError`] if a setting is missing, out of its range or without effect, and if lengths do not fit into the
    /// sensor.
    pub fn with_settings(
        base: Option<Self>,
        given: &Map<String, Json>,
        length_unit: Option<LengthUnit>,
        has_tangential: bool,
    ) -> Result<Self, SettingError> {
        let base = base.unwrap_or_default();
        let [own, of_estimator] = split_settings::<Self>(given);
        let options = with_settings(&base, &own)?;
        if options.sensor_radius.is_none() {
            let reason = "is needed, or setting `like`";
            return Err(SettingError::new("sensor_radius", reason));
        }
        let (estimator, model) = estimator(&of_estimator, &base)?;
        let is_used = estimator.priors().noise == NoiseKnown::Stated;
        let std = |key: &str, std: Option<f64>| std.filter(|_| is_used || own.contains_key(key));
        let options = Self {
            normal_std: std("normal_std", options.normal_std),
            tangential_std: std("tangential_std", options.tangential_std),
            model,
            estimator,
            length_unit: length_unit.or(base.length_unit),
            ..options
        };
        check_effect(given, &options)?;
        check_lengths(&options)?;
        if own.contains_key("tangential_std") && !has_tangential {
            let reason = "has an effect only with tangential displacements";
            return Err(SettingError::new("tangential_std", reason));
        }
        Ok(options)
    }
}

/// Options of a fit to camera frames: the camera sensor, and the stated data of the press.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// The press of the study, with its lengths converted to `unit`.
    pub(super) press: PressConfig,
    /// Unit of all lengths in these options.
    pub unit: LengthUnit,
    /// Indentation of the press (length), if it was measured separately; otherwise `None`. See
    /// [`PressOptions::indentation`].
    pub indentation: Option<f64>,
    /// Young's modulus of the soft body, force per length². Without it, no force is computed.
    pub young: Option<f64>,
    /// A camera that was calibrated from a frame at rest, with the name of its file for messages. If it is `None`, the
    /// camera of the study is used. With a calibrated camera, the fit assumes the same uncertainty of the discs as
    /// [`calibrate_camera`](super::calibrate_camera). The frame at rest then does not refine the camera, because the
    /// camera may have been calibrated from the same frame.
    pub camera: Option<(String, CameraEstimate)>,
}

impl PictureOptions {
    /// Options with the marker layout, the discs, the soft body, the camera and the noise of a study. Lengths are
    /// converted to `unit`. The study's indentation is not used.
    ///
    /// # Errors
    /// [`FieldError`] if the scene is not a press with a camera, the unit cannot be converted, or the markers are
    /// not discs.
    pub fn from_study(study: &StudyConfig, unit: LengthUnit) -> Result<Self, FieldError> {
        let press = in_unit(press_of(study)?, factor(study, unit)?);
        NominalSensor::of(&press)?;
        Ok(Self {
            press,
            unit,
            indentation: None,
            young: None,
            camera: None,
        })
    }

    pub(super) fn thickness(&self) -> Option<f64> {
        self.press.estimator.layer(self.press.model.thickness())
    }

    pub(super) fn other_body(&self) -> Option<String> {
        let layer = self.press.model.thickness()?;
        self.thickness().is_none().then(|| {
            format!(
                "a half-space is fitted, because Poisson's ratio is stated without a thickness, although the study's model is a layer of {} {}",
                Number(layer),
                self.unit.as_str()
            )
        })
    }

    pub(super) fn poisson(&self) -> f64 {
        match self.press.estimator {
            PressEstimatorConfig::Image {
                poisson: Some(poisson),
                ..
            } => poisson,
            _ => self.press.model.poisson(),
        }
    }

    /// Whether the press is fitted to camera frames, that is, whether the method is `image`. The method follows from
    /// the given settings or, if they state none, from the study's estimator.
    pub fn are_asked_for(given: &Map<String, Json>, study: Option<&StudyConfig>) -> bool {
        let of_study = || Some(<&str>::from(&press_of(study?).ok()?.estimator));
        let kind = given.get("kind").and_then(Json::as_str).or_else(of_study);
        kind == Some("image")
    }

    /// Options of a fit to frames. The settings `given` replace the values of `base`, the options of a study.
    ///
    /// # Errors
    /// [`SettingError`] if there is no study, if a setting is out of its range or has no effect in a fit to frames, or
    /// if a length is too large for the sensor.
    pub fn with_settings(
        base: Option<Self>,
        given: &Map<String, Json>,
    ) -> Result<Self, SettingError> {
        let Some(base) = base else {
            let reason = "is missing, but setting `kind` image requires it: a study of a press with a camera, which states layout, discs, body, camera and noise";
            return Err(SettingError::new("like", reason));
        };
        let [own, mut of_estimator] = split_settings::<PressOptions>(given);
        let is_used = |key: &&String| ["indentation", "young"].contains(&key.as_str());
        if let Some(key) = own.keys().find(|key| !is_used(key)) {
            let reason = "has no effect with setting `kind` image: the study of setting `like` states the sensor, and the tracker estimates the noise";
            return Err(SettingError::new(key, reason));
        }
        of_estimator.insert("kind".to_owned(), Json::from("image"));
        let mut press = base.press;
        press.estimator = with_settings(&press.estimator, &of_estimator)?;
        let options = PressOptions {
            estimator: press.estimator.clone(),
            model: press.model.clone(),
            ..with_settings(&PressOptions::of_probe(&press.probe), &own)?
        };
        check_indentation_std(given, options.indentation)?;
        check_lengths(&options)?;
        Ok(Self {
            press,
            indentation: options.indentation,
            young: options.young,
            ..base
        })
    }
}

/// The estimator and its elastic model, from the settings `given`. The settings `thickness` and `poisson` are not
/// settings of the estimator `gaussian` itself, but of the elastic model that calibrates it. They exclude each other.
fn estimator(
    given: &Map<String, Json>,
    base: &PressOptions,
) -> Result<(PressEstimatorConfig, PressModelConfig), SettingError> {
    let kind = given.get("kind").and_then(Json::as_str);
    if kind.unwrap_or((&base.estimator).into()) != "gaussian" {
        let estimator = with_settings(&base.estimator, given)?;
        return Ok((estimator, base.model.clone()));
    }
    let mut of_gaussian = given.clone();
    let [thickness, poisson] = ["thickness", "poisson"].map(|key| {
        let value = of_gaussian.remove(key)?;
        Some(Map::from_iter([(key.to_owned(), value)]))
    });
    let estimator = with_settings(&base.estimator, &of_gaussian)?;
    let has_c = matches!(estimator, PressEstimatorConfig::Gaussian { c: Some(_), .. });
    let useless = |key: &str, to: &str| {
        let reason = format!("has an effect only {to}");
        Err(SettingError::new(key, reason))
    };
    let model = match (thickness, poisson) {
        (None, None) => base.model.clone(),
        (Some(_), _) if has_c => {
            let to = "with setting `kind` bonded-layer and in the calibration of a Gaussian, but setting `c` is given";
            return useless("thickness", to);
        }
        (None, Some(_)) if has_c => {
            let to = "with setting `kind` half-space and in the calibration of a Gaussian, but setting `c` is given";
            return useless("poisson", to);
        }
        (Some(_), Some(_)) => {
            return useless(
                "poisson",
                "without setting `thickness`, because the Poisson ratio of a layer is always 0.5",
            );
        }
        (Some(given), None) => with_settings(
            &PressModelConfig::BondedLayer {
                thickness: 1.0,
                modulus_kpa: None,
            },
            &given,
        )?,
        (None, Some(given)) => with_settings(&PressModelConfig::default(), &given)?,
    };
    Ok((estimator, model))
}

/// Returns an error if the estimator does not use a given setting, or needs a setting that is missing.
fn check_effect(given: &Map<String, Json>, options: &PressOptions) -> Result<(), SettingError> {
    check_indentation_std(given, options.indentation)?;
    if given.get("noise").is_some_and(|word| word == "found") {
        let stds = ["normal_std", "tangential_std"];
        if let Some(key) = stds.into_iter().find(|key| given.contains_key(*key)) {
            let reason = "has an effect only without setting `noise` found";
            return Err(SettingError::new(key, reason));
        }
    }
    let (key, reason) = match options.estimator {
        PressEstimatorConfig::Gaussian { .. } if options.young.is_some() => (
            "young",
            "has an effect only with setting `kind` half-space or bonded-layer: the Gaussian model computes no stress",
        ),
        PressEstimatorConfig::Gaussian { c: None, .. } if options.indentation.is_none() => (
            "c",
            "is missing, but setting `kind` gaussian requires it, or setting `indentation` from which it is calibrated",
        ),
        PressEstimatorConfig::Image { .. } => (
            "kind",
            "image requires frames and a model of the sensor (`sensor track`); for displacements use half-space or bonded-layer",
        ),
        PressEstimatorConfig::BondedLayer {
            thickness: None, ..
        } if options.model.thickness().is_none() => (
            "thickness",
            "is missing, but setting `kind` bonded-layer requires it",
        ),
        _ => return Ok(()),
    };
    Err(SettingError::new(key, reason))
}

fn check_indentation_std(
    given: &Map<String, Json>,
    indentation: Option<f64>,
) -> Result<(), SettingError> {
    if given.contains_key("indentation_std") && indentation.is_none() {
        let reason = "has an effect only with a given setting `indentation`";
        return Err(SettingError::new("indentation_std", reason));
    }
    Ok(())
}

fn check_lengths(options: &PressOptions) -> Result<(), SettingError> {
    let refuse = |key: &str, value: f64, bound: &str, (other, limit): (&str, f64)| {
        let expected = format!("{bound} setting `{other}`, {}", Number(limit));
        Err(SettingError::of_number(key, value, expected))
    };
    let (depth, radius) = (options.depth(), options.radius());
    let of_sensor = ("sensor_radius", radius);
    if depth >= radius {
        return refuse("depth", depth, "less than", of_sensor);
    }
    let of_model = options.model.thickness();
    let (thickness, limit) = match options.estimator {
        PressEstimatorConfig::BondedLayer { thickness, .. }
        | PressEstimatorConfig::Image { thickness, .. } => {
            let thickness = thickness.or(of_model);
            (thickness, thickness.map(|limit| ("thickness", limit)))
        }
        PressEstimatorConfig::Gaussian { c: None, .. } => (of_model, None),
        _ => (None, None),
    };
    let limit = limit.unwrap_or(of_sensor);
    let indentation = options.indentation;
    if let Some(indentation) = indentation.filter(|&indentation| indentation >= limit.1) {
        return refuse("indentation", indentation, "less than", limit);
    }
    if let Some(thickness) = thickness {
        if depth > thickness {
            return refuse("depth", depth, "at most", ("thickness", thickness));
        }
        if thickness > radius {
            return refuse("thickness", thickness, "at most", of_sensor);
        }
    }
    Ok(())
}
