//! Settings of an estimate from presses.

use palpate_statistics::Number;
use palpate_study::config::{
    LengthUnit, NoiseKnown, PressEstimatorConfig, PressModelConfig, Range, with_settings,
};
use serde_json::{Map, Value as Json};

use super::super::press::PressReadings;
use super::super::pressed::PressOptions;
use super::super::wording::{GivenError, Wording};

/// Settings given for an estimate from presses; `None` if not given. Lengths are in the readings' unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PressGiven {
    /// Radius of the sensor's skin; needed unless a study states it.
    pub sensor_radius: Option<f64>,
    /// Depth of the markers under the skin.
    pub depth: Option<f64>,
    /// Settings of the estimator by their config keys, including `kind`. For a Gaussian, thickness and Poisson's
    /// ratio are those of the elastic model on which it is calibrated.
    pub estimator: Map<String, Json>,
    /// Indentation, if it was measured separately.
    pub indentation: Option<f64>,
    /// Standard deviation of each normal displacement.
    pub normal_std: Option<f64>,
    /// Standard deviation of each component of the tangential displacements.
    pub tangential_std: Option<f64>,
    /// Factor on the markers' positions.
    pub radial_scale: Option<f64>,
    /// Young's modulus of the soft material, force per length².
    pub young: Option<f64>,
    /// Unit of lengths, where the readings do not state it.
    pub length_unit: Option<LengthUnit>,
}

impl PressGiven {
    /// Checks that the readings contain the displacements whose noise is given.
    ///
    /// # Errors
    /// [`GivenError`] if tangential noise is given, but the readings have no tangential displacements.
    pub fn fits(&self, readings: &PressReadings, wording: Wording) -> Result<(), GivenError> {
        if self.tangential_std.is_none() || readings.has_tangential() {
            return Ok(());
        }
        let needed = match wording {
            Wording::Flags => "readings with tangential_x and tangential_y",
            Wording::Arguments => "displacements of three columns: normal, tangential x and y",
        };
        let name = wording.name("tangential_std");
        Err(wording.refused(
            "tangential_std",
            format!("{name} is of use only to {needed}"),
        ))
    }
}

impl PressOptions {
    /// Options from the given settings, and from `base` for all others.
    ///
    /// ```
    /// use palpate_recorded::{PressGiven, PressOptions, Wording};
    ///
    /// let given = PressGiven { sensor_radius: Some(20.0), depth: Some(25.0), ..PressGiven::default() };
    /// let error = PressOptions::given(&given, None, Wording::Flags).expect_err("deeper than the core");
    /// assert_eq!(error.to_string(), "--depth is 25; it must be less than --sensor-radius, 20");
    /// ```
    ///
    /// # Errors
    /// [`GivenError`] for a setting that is missing, out of its range or without effect, and for lengths that do not
    /// fit into the sensor.
    pub fn given(
        given: &PressGiven,
        base: Option<Self>,
        wording: Wording,
    ) -> Result<Self, GivenError> {
        wording.check([
            ("sensor_radius", given.sensor_radius, Range::POSITIVE),
            ("depth", given.depth, Range::NOT_NEGATIVE),
            ("indentation", given.indentation, Range::POSITIVE),
            ("normal_std", given.normal_std, Range::POSITIVE),
            ("tangential_std", given.tangential_std, Range::POSITIVE),
            ("radial_scale", given.radial_scale, Range::POSITIVE),
            ("young", given.young, Range::POSITIVE),
        ])?;
        let base = match (base, given.sensor_radius) {
            (Some(base), _) => base,
            (None, Some(radius)) => Self::new(radius),
            (None, None) => {
                let needed = wording.with("sensor_radius", "R");
                let like = wording.with("like", "STUDY.toml");
                let message = format!("needs {needed}, or {like}");
                return Err(wording.refused("sensor_radius", message));
            }
        };
        let (estimator, model) = estimator(&given.estimator, &base, wording)?;
        let is_stated = estimator.priors().noise == NoiseKnown::Stated;
        let told = |std: Option<f64>| std.filter(|_| is_stated);
        let options = Self {
            sensor_radius: given.sensor_radius.unwrap_or(base.sensor_radius),
            marker_depth: given.depth.or(base.marker_depth),
            model,
            estimator,
            indentation: given.indentation,
            normal_std: given.normal_std.or(told(base.normal_std)),
            tangential_std: given.tangential_std.or(told(base.tangential_std)),
            radial_scale: given.radial_scale.unwrap_or(base.radial_scale),
            young: given.young,
            length_unit: given.length_unit.or(base.length_unit),
        };
        useful(given, &options, wording)?;
        possible(&options, wording)?;
        Ok(options)
    }
}

/// The estimator and its elastic model. A Gaussian has neither thickness nor Poisson's ratio, but it is calibrated on
/// a model that has one of them.
fn estimator(
    given: &Map<String, Json>,
    base: &PressOptions,
    wording: Wording,
) -> Result<(PressEstimatorConfig, PressModelConfig), GivenError> {
    if given.is_empty() {
        return Ok((base.estimator.clone(), base.model.clone()));
    }
    let over = |given: &Map<String, Json>| {
        with_settings(&base.estimator, given).map_err(|error| wording.of_estimator(error))
    };
    let kind = given.get("kind").and_then(Json::as_str);
    if kind.unwrap_or(base.estimator.name()) != "gaussian" {
        return Ok((over(given)?, base.model.clone()));
    }
    let mut of_gaussian = given.clone();
    let mut number = |key| of_gaussian.remove(key).as_ref().and_then(Json::as_f64);
    let (thickness, poisson) = (number("thickness"), number("poisson"));
    wording.check([
        ("thickness", thickness, Range::POSITIVE),
        ("poisson", poisson, POISSON),
    ])?;
    let estimator = over(&of_gaussian)?;
    let has_c = matches!(estimator, PressEstimatorConfig::Gaussian { c: Some(_), .. });
    let useless = |key: &str, to: String| {
        let message = format!("{} is of use only {to}", wording.name(key));
        Err(wording.refused(key, message))
    };
    let calibrated = |kind: &str| {
        let (kind, c) = (wording.with("kind", kind), wording.name("c"));
        format!("to {kind} and to calibrate a Gaussian, but {c} is given")
    };
    match (thickness, poisson) {
        (None, None) => Ok((estimator, base.model.clone())),
        (Some(_), _) if has_c => useless("thickness", calibrated("bonded-layer")),
        (None, Some(_)) if has_c => useless("poisson", calibrated("half-space")),
        (Some(_), Some(_)) => {
            let thickness = wording.name("thickness");
            useless("poisson", format!("without {thickness}: a layer has 0.5"))
        }
        (Some(thickness), None) => Ok((estimator, PressModelConfig::BondedLayer { thickness })),
        (None, Some(poisson)) => Ok((estimator, PressModelConfig::HalfSpace { poisson })),
    }
}

/// Range of Poisson's ratio.
const POISSON: Range = Range {
    most: Some(0.5),
    ..Range::NOT_NEGATIVE
};

/// Rejects settings that the estimator does not use, and missing settings that it needs.
fn useful(given: &PressGiven, options: &PressOptions, wording: Wording) -> Result<(), GivenError> {
    let refuse = |key: &str, message: String| Err(wording.refused(key, message));
    let name = |key: &str| wording.name(key);
    let is_told = options.indentation.is_some();
    useful_std(given, wording)?;
    let noise = given.estimator.get("noise");
    let is_found = noise.is_some_and(|word| word == "found");
    for (key, std) in [
        ("normal_std", given.normal_std),
        ("tangential_std", given.tangential_std),
    ] {
        if is_found && std.is_some() {
            let found = wording.with("noise", "found");
            return refuse(key, format!("{} is of use only without {found}", name(key)));
        }
    }
    let thickness = options.model.thickness();
    match options.estimator {
        PressEstimatorConfig::Gaussian { .. } if options.young.is_some() => {
            let method = wording.with("kind", "half-space or bonded-layer");
            let message = format!(
                "{} is of use only to {method}: a Gaussian has no stress",
                name("young")
            );
            refuse("young", message)
        }
        PressEstimatorConfig::Gaussian { c: None, .. } if !is_told => {
            let method = wording.with("kind", "gaussian");
            let [c, indentation] =
                [("c", "C"), ("indentation", "D")].map(|(key, value)| wording.with(key, value));
            let message = format!("{method} needs {c}, or {indentation} to calibrate c at");
            refuse("c", message)
        }
        PressEstimatorConfig::Image { .. } => {
            let method = wording.with("kind", "half-space or bonded-layer");
            let frames = match wording {
                Wording::Flags => "use `palpate sensor track`",
                Wording::Arguments => "use `track`",
            };
            let message =
                format!("a fit of pictures needs the frames and a model of the sensor: {frames}");
            refuse("kind", format!("{message}; for displacements use {method}"))
        }
        PressEstimatorConfig::BondedLayer {
            thickness: None, ..
        } if thickness.is_none() => {
            let method = wording.with("kind", "bonded-layer");
            let thickness = wording.with("thickness", "H");
            refuse("thickness", format!("{method} needs {thickness}"))
        }
        _ => Ok(()),
    }
}

/// Rejects `indentation_std` if no indentation is given.
pub(super) fn useful_std(given: &PressGiven, wording: Wording) -> Result<(), GivenError> {
    if given.estimator.contains_key("indentation_std") && given.indentation.is_none() {
        let [std, indentation] = ["indentation_std", "indentation"].map(|key| wording.name(key));
        let message = format!("{std} is of use only to a given {indentation}");
        return Err(wording.refused("indentation_std", message));
    }
    Ok(())
}

/// Refuses lengths that do not fit into the sensor.
pub(super) fn possible(options: &PressOptions, wording: Wording) -> Result<(), GivenError> {
    let refuse = |key: &str, value: f64, bound: &str, (what, limit): (&str, f64)| {
        let expected = format!("{bound} {}, {}", wording.name(what), Number(limit));
        Err(wording.bad(key, value, &expected))
    };
    let (depth, radius) = (options.depth(), options.sensor_radius);
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
