//! Settings of an estimate from presses.

use palpate_statistics::Number;
use palpate_study::config::{
    LengthUnit, NoiseKnown, PressEstimatorConfig, PressModelConfig, SettingError, split_settings,
    with_settings,
};
use serde_json::{Map, Value as Json};

use super::image_estimate::PictureOptions;
use super::press_estimate::PressOptions;

impl PressOptions {
    /// Options from the given settings, by their keys: fields of this struct and settings of the estimator. `base` states
    /// all others. For a Gaussian, `thickness` and `poisson` are those of the elastic model on which it is calibrated.
    /// Readings may have tangential displacements or not.
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
    /// [`SettingError`] for a setting that is missing, out of its range or without effect, and for lengths that do not
    /// fit into the sensor.
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
        let is_stated = estimator.priors().noise == NoiseKnown::Stated;
        let std = |key: &str, std: Option<f64>| std.filter(|_| is_stated || own.contains_key(key));
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
            let reason = "is of use only to readings with tangential displacements";
            return Err(SettingError::new("tangential_std", reason));
        }
        Ok(options)
    }
}

impl PictureOptions {
    /// Options of a fit of frames from the given settings, by their keys. The study's `base` states all others.
    ///
    /// # Errors
    /// [`SettingError`] without a study, for a setting that a fit of frames does not use or that is out of its range,
    /// and for lengths that do not fit into the sensor.
    pub fn with_settings(
        base: Option<Self>,
        given: &Map<String, Json>,
    ) -> Result<Self, SettingError> {
        let Some(base) = base else {
            let reason = "is needed by setting `kind` image: a study of a press before a camera, which states layout, discs, body, camera and noise";
            return Err(SettingError::new("like", reason));
        };
        let [own, mut of_estimator] = split_settings::<PressOptions>(given);
        let is_used = |key: &&String| ["indentation", "young"].contains(&key.as_str());
        if let Some(key) = own.keys().find(|key| !is_used(key)) {
            let reason = "is of no use to setting `kind` image: the study of setting `like` states the sensor, the tracker the noise";
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

/// The estimator and its elastic model. A Gaussian has neither thickness nor Poisson's ratio, but it is calibrated on
/// a model that has one of them.
fn estimator(
    given: &Map<String, Json>,
    base: &PressOptions,
) -> Result<(PressEstimatorConfig, PressModelConfig), SettingError> {
    let kind = given.get("kind").and_then(Json::as_str);
    if kind.unwrap_or(base.estimator.name()) != "gaussian" {
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
        let reason = format!("is of use only {to}");
        Err(SettingError::new(key, reason))
    };
    let model = match (thickness, poisson) {
        (None, None) => return Ok((estimator, base.model.clone())),
        (Some(_), _) if has_c => {
            return useless(
                "thickness",
                "to setting `kind` bonded-layer and to calibrate a Gaussian, but setting `c` is given",
            );
        }
        (None, Some(_)) if has_c => {
            return useless(
                "poisson",
                "to setting `kind` half-space and to calibrate a Gaussian, but setting `c` is given",
            );
        }
        (Some(_), Some(_)) => {
            return useless("poisson", "without setting `thickness`: a layer has 0.5");
        }
        (Some(of_layer), None) => {
            with_settings(&PressModelConfig::BondedLayer { thickness: 1.0 }, &of_layer)?
        }
        (None, Some(of_half_space)) => with_settings(
            &PressModelConfig::HalfSpace { poisson: 0.5 },
            &of_half_space,
        )?,
    };
    Ok((estimator, model))
}

/// Rejects settings that the estimator does not use, and missing settings that it needs.
fn check_effect(given: &Map<String, Json>, options: &PressOptions) -> Result<(), SettingError> {
    check_indentation_std(given, options.indentation)?;
    if given.get("noise").is_some_and(|word| word == "found") {
        let stds = ["normal_std", "tangential_std"];
        if let Some(key) = stds.into_iter().find(|key| given.contains_key(*key)) {
            let reason = "is of use only without setting `noise` found";
            return Err(SettingError::new(key, reason));
        }
    }
    let (key, reason) = match options.estimator {
        PressEstimatorConfig::Gaussian { .. } if options.young.is_some() => (
            "young",
            "is of use only to setting `kind` half-space or bonded-layer: a Gaussian has no stress",
        ),
        PressEstimatorConfig::Gaussian { c: None, .. } if options.indentation.is_none() => (
            "c",
            "is needed by setting `kind` gaussian, or setting `indentation` to calibrate c at",
        ),
        PressEstimatorConfig::Image { .. } => (
            "kind",
            "image needs the frames and a model of the sensor, as `sensor track` reads them; for displacements use half-space or bonded-layer",
        ),
        PressEstimatorConfig::BondedLayer {
            thickness: None, ..
        } if options.model.thickness().is_none() => {
            ("thickness", "is needed by setting `kind` bonded-layer")
        }
        _ => return Ok(()),
    };
    Err(SettingError::new(key, reason))
}

/// Rejects `indentation_std` if no indentation is given.
fn check_indentation_std(
    given: &Map<String, Json>,
    indentation: Option<f64>,
) -> Result<(), SettingError> {
    if given.contains_key("indentation_std") && indentation.is_none() {
        let reason = "is of use only to a given setting `indentation`";
        return Err(SettingError::new("indentation_std", reason));
    }
    Ok(())
}

/// Rejects lengths that do not fit into the sensor.
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
