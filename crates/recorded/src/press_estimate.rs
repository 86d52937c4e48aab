//! The curvature of an object from a recorded press.

use palpate_press::{
    Body, ForwardFit, Markers, Misfit, PressError, PressEstimate, Prior, Reading, Skin,
};
use palpate_statistics::{BadSetting, Number};

use super::Value;
use super::consistency::{self, FORMAT_VERSION};
use super::duplicate_rows::repeated;
use super::error::{RecordedError, explained};
use super::input_checks::{Sensor, along_skin, of_press};
use super::press_recording::PressRecording;
use super::press_report::{Described, PressReport, Row};
use super::source::agreed_unit;
use palpate_estimators::{PressFitError, PressFitSetup, large_contact_warning, sensor_body};
use palpate_study::Warning;
use palpate_study::config::{
    Baseline, LengthUnit, PressEstimatorConfig, PressModelConfig, SettingError,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of an estimate that the readings do not state; lengths in the readings' unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PressOptions {
    /// Radius of the sensor's skin, in the readings' length unit; needed without setting `like`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub sensor_radius: Option<f64>,
    /// Depth of the markers under the skin. Readings of a calibrated camera need it without setting `like`; for other
    /// readings it is 0 by default, the surface, with a warning.
    #[serde(rename = "depth")]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub marker_depth: Option<f64>,
    /// Model of the sensor's soft body. It completes the estimator's settings, and a Gaussian is calibrated on it.
    #[serde(skip)]
    pub model: PressModelConfig,
    /// The estimator. [`Self::indentation`] replaces its own setting on whether the indentation is known, because
    /// that setting is about the study's presses.
    #[serde(skip)]
    pub estimator: PressEstimatorConfig,
    /// Indentation, where it is known from elsewhere, such as a robot's pose; by default fitted. Its standard deviation is
    /// setting `indentation_std`; where that is 0 or not given, 2 % of the indentation, with a warning. (In a study, 0 is
    /// exact.) A warning reports a large difference from the estimate by the readings alone.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: Option<f64>,
    /// Standard deviation of each normal displacement; by default estimated from the residuals.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub normal_std: Option<f64>,
    /// Standard deviation of each component of the tangential displacements; by default estimated from the residuals.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub tangential_std: Option<f64>,
    /// Factor on the positions of the markers.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radial_scale: f64,
    /// Young's modulus of the soft body, force per squared length unit. With it the output has the force and the highest
    /// pressure, which are proportional to it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<f64>,
    /// The unit of lengths, where the header does not state it.
    #[serde(skip)]
    pub length_unit: Option<LengthUnit>,
}

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
    /// Options with only the sensor's radius stated: a half-space with its markers at the surface.
    pub fn new(sensor_radius: f64) -> Self {
        Self {
            sensor_radius: Some(sensor_radius),
            ..Self::default()
        }
    }

    /// Radius of the skin, length: 0, which no estimate accepts, where it is not stated.
    pub fn radius(&self) -> f64 {
        self.sensor_radius.unwrap_or_default()
    }

    /// Depth of the markers under the skin, length: 0 where it is not stated.
    pub fn depth(&self) -> f64 {
        self.marker_depth.unwrap_or_default()
    }
}

/// Estimates the curvature of an object from a recorded press.
///
/// # Errors
/// [`RecordedError::Line`] if one marker is at fault, else [`RecordedError::Readings`] if the options contradict the
/// file or the readings do not determine a press.
pub fn estimate_press(
    recorded: &PressRecording,
    options: &PressOptions,
) -> Result<PressReport, RecordedError> {
    let unit = agreed_unit(&recorded.origin, recorded.unit, options.length_unit)?;
    let refused = |error| refused(recorded, options, &error);
    let scaled = |place: &[f64; 2]| place.map(|component| component * options.radial_scale);
    let places: Vec<[f64; 2]> = recorded.places.iter().map(scaled).collect();
    let skin = Skin::new(options.radius()).map_err(refused)?;
    let markers = Markers::new(skin, &places).map_err(refused)?;
    let Fits { fit, alone } = Fits::new(options, &markers).map_err(refused)?;
    let c = fit.body.c();
    let reading = Reading {
        markers: &markers,
        normal: &recorded.normal,
        tangential: recorded.tangential.as_deref(),
        indentation: None,
    };
    let std = options.estimator.priors().indentation_std;
    let stated = options
        .indentation
        .map(|value| consistency::indentation(value, std, unit.as_str()));
    let indentation = stated.as_ref().map(|(indentation, _)| *indentation);
    let stated_reading = Reading {
        indentation,
        ..reading
    };
    let estimate = fit.estimate(&stated_reading);
    let checked = alone.check_indentation(&stated_reading, estimate.as_ref().ok());
    let (contradiction, unchecked) = match checked {
        Ok(contradiction) => (contradiction, None),
        Err(error) => (None, Some(consistency::unchecked_indentation(error))),
    };
    let warning = |misfit: &Misfit| consistency::warning(misfit, &recorded.origin, unit.as_str());
    let estimate = estimate.map_err(|error| {
        refused_for(
            recorded,
            options,
            &error,
            contradiction.as_ref().map(warning),
        )
    })?;
    let misfits = fit.misfits(&stated_reading, &estimate).map_err(refused)?;
    let misfits: Vec<Misfit> = contradiction.into_iter().chain(misfits).collect();
    // A contact that is too wide is an error, unless a warning already names the cause.
    if misfits.is_empty() && estimate.only_marker.is_none() {
        estimate.within_object().map_err(refused)?;
    }
    let mistake = along_skin(&fit, &stated_reading, &estimate, !misfits.is_empty());
    let wrong_markers: Vec<Row> = estimate
        .wrong_markers
        .iter()
        .map(|&marker| Row {
            row: marker + 1,
            line: recorded.origin.line(marker),
            columns: recorded.extras.named(marker),
        })
        .collect();
    let left_out = consistency::left_out(
        &wrong_markers,
        &markers.distances(estimate.contact),
        estimate.contact_radius.value,
        indentation.is_some(),
    );
    let warnings = [
        Warning::of("units", suspicion(recorded, options, unit)),
        Warning::of("unstated-depth", at_surface(options)),
        Warning::of("swapped-columns", mistake),
        unchecked,
        stated.and_then(|(_, warning)| warning),
        left_out,
        Warning::of(
            "unseen-contact",
            (!estimate.is_detected).then_some(consistency::UNSEEN),
        ),
        Warning::of("repeated-rows", copies(recorded)),
        Warning::of(
            "lone-marker",
            estimate
                .only_marker
                .map(|marker| consistency::alone(marker, &recorded.origin)),
        ),
    ]
    .into_iter()
    .flatten()
    .chain(misfits.iter().map(warning))
    .chain(warnings(&estimate, options, misfits.is_empty()))
    .collect();
    let stresses = force_and_pressure(&fit.body, &estimate, options.young, unit);
    Ok(PressReport::of(
        &estimate,
        Described {
            format_version: FORMAT_VERSION,
            method: options.estimator.name(),
            c,
            markers: recorded.places.len(),
            with_tangential: recorded.tangential.is_some(),
            unit,
            stresses: stresses.map_err(refused)?,
            wrong_markers,
            warnings,
        },
    ))
}

/// Warning of repeated markers.
fn copies(recorded: &PressRecording) -> Option<String> {
    let along = recorded.tangential.as_deref();
    let each = recorded.places.iter().zip(&recorded.normal).enumerate();
    let markers = each.map(|(marker, (&[x, y], &normal))| {
        let [along_x, along_y] = along.map_or([0.0; 2], |along| along[marker]);
        [x, y, normal, along_x, along_y]
    });
    repeated(&recorded.origin, "marker", markers, 0.0)
}

/// The fits of one press.
struct Fits {
    /// The requested fit.
    fit: ForwardFit,
    /// The fit that estimates the indentation from the readings alone. A Gaussian is replaced by the sensor's elastic
    /// body.
    alone: ForwardFit,
}

impl Fits {
    fn new(options: &PressOptions, markers: &Markers) -> Result<Self, PressError> {
        let model = options.model.reference();
        let body = sensor_body(&model, options.depth(), Body::bonded_layer)?;
        let assumed = PressFitSetup {
            estimator: &options.estimator,
            model: &model,
            body: &body,
            shared: model.thickness(),
            layer: &Body::bonded_layer,
            markers,
            marker_depth: options.depth(),
            calibrated_at: options.indentation,
            knows_indentation: options.indentation.is_some(),
            stds: [options.normal_std, options.tangential_std],
        };
        let fit = assumed.fit().map_err(PressFitError::into_inner)?;
        let alone = match options.estimator {
            PressEstimatorConfig::Gaussian { .. } => ForwardFit {
                body,
                gain: Prior::Exact,
                ..fit.clone()
            },
            _ => fit.clone(),
        };
        Ok(Self { fit, alone })
    }
}

/// Warning if the depth of the markers is not stated.
fn at_surface(options: &PressOptions) -> Option<&'static str> {
    options.marker_depth.is_none().then_some(
        "the depth of the markers is not stated: they are taken to lie at the skin's surface; the readings may not tell that they lie deeper, and the curvature is wrong then (setting `depth`)",
    )
}

/// Likely mistake of sign or unit in the readings.
fn suspicion(
    recorded: &PressRecording,
    options: &PressOptions,
    unit: LengthUnit,
) -> Option<String> {
    let sensor = Sensor {
        radius: options.radius(),
        radial_scale: options.radial_scale,
        has_baseline: options.estimator.priors().baseline == Baseline::Known,
    };
    of_press(recorded, sensor, unit)
}

/// Force and peak pressure of the estimated press, if Young's modulus is given.
pub(super) fn force_and_pressure(
    body: &Body,
    estimate: &PressEstimate,
    young: Option<f64>,
    unit: LengthUnit,
) -> Result<[Option<Value>; 2], PressError> {
    let Some(young) = young else {
        return Ok([None, None]);
    };
    let (curvature, indentation) = (estimate.relative_curvature, estimate.indentation);
    let contact = body.press(curvature.value, indentation.value)?;
    let value = |value: f64, unit: &str| Value {
        value,
        std: None,
        interval95: None,
        unit: unit.to_owned().into(),
    };
    let sound = |number: Option<f64>| number.filter(|number| number.is_finite());
    let young_unit = "unit of young";
    let area = format!("{young_unit} x {}^2", unit.as_str());
    Ok([
        sound(contact.force(young)).map(|force| value(force, &area)),
        sound(contact.peak_pressure(young)).map(|pressure| value(pressure, young_unit)),
    ])
}

/// Advice if the readings do not determine a press.
pub(super) const GIVE_INDENTATION: &str =
    "give the indentation with setting `indentation` if it is known";

/// A fit that explains less than this share of the variance gives a warning.
const LITTLE: f64 = 0.5;

/// Warning if the contact is too wide for small strains.
pub(super) fn too_large(
    estimate: &PressEstimate,
    sensor_radius: f64,
    is_layer: bool,
) -> Option<Warning> {
    large_contact_warning(
        estimate.most_likely_curvature,
        estimate.contact_radius.value,
        sensor_radius,
        is_layer,
    )
}

fn warnings(
    estimate: &PressEstimate,
    options: &PressOptions,
    has_no_misfit: bool,
) -> impl Iterator<Item = Warning> {
    let is_layer = matches!(options.estimator, PressEstimatorConfig::BondedLayer { .. });
    let large = too_large(estimate, options.radius(), is_layer);
    let is_noise = options.normal_std.is_some() && has_no_misfit;
    let unexplained = (estimate.r_squared < LITTLE && !is_noise).then(|| {
        let percent = 100.0 * estimate.r_squared.max(0.0);
        let text = format!("the fit explains {percent:.0} % of the normal displacements' variance: noise, or not the press of this body");
        Warning::new("unexplained-readings", text, [("r_squared", estimate.r_squared)])
    });
    let is_gaussian = matches!(options.estimator, PressEstimatorConfig::Gaussian { .. });
    large
        .into_iter()
        .chain(unexplained)
        .chain(Warning::of("gaussian-body", is_gaussian.then_some(NO_BODY)))
}

/// Warning of a fit to a Gaussian.
const NO_BODY: &str = "a Gaussian is no elastic body: its intervals tell of noise alone, not of how far a skin is from it";

/// Largest absolute normal displacement.
fn most_moved(recorded: &PressRecording) -> f64 {
    let moved = recorded.normal.iter();
    moved.fold(0.0, |most: f64, one| most.max(one.abs()))
}

/// Whether at least three displacements exceed five times the median.
fn stand_out(recorded: &PressRecording) -> bool {
    const FEW: usize = 3;
    const MANY_TIMES: f64 = 5.0;
    let mut sizes: Vec<f64> = recorded.normal.iter().map(|one| one.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let middle = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    sizes
        .iter()
        .rev()
        .nth(FEW - 1)
        .is_some_and(|&large| large > MANY_TIMES * middle)
}

/// The error, with the line of the marker if one marker is at fault.
fn refused(recorded: &PressRecording, options: &PressOptions, error: &PressError) -> RecordedError {
    refused_for(recorded, options, error, None)
}

/// The same error with its possible cause: a stated indentation that the readings contradict, or a likely mistake of
/// sign or unit.
fn refused_for(
    recorded: &PressRecording,
    options: &PressOptions,
    error: &PressError,
    contradiction: Option<Warning>,
) -> RecordedError {
    let unit = recorded.unit.or(options.length_unit).unwrap_or_default();
    let (suspicion, contradiction) = match error {
        PressError::BadSetting(_) => (None, None),
        _ => (suspicion(recorded, options, unit), contradiction),
    };
    let origin = &recorded.origin;
    let message = match error {
        PressError::BadSetting(BadSetting {
            setting,
            value,
            expected,
        }) => {
            let key = match *setting {
                "radius" => "sensor_radius",
                setting => setting,
            };
            SettingError::of_number(key, *value, expected).to_string()
        }
        PressError::Undetermined { .. } if options.indentation.is_none() => {
            format!("{error}; {GIVE_INDENTATION}")
        }
        PressError::NoContact { .. } if options.normal_std > Some(most_moved(recorded)) => {
            let [noise, moved] =
                [options.normal_std.unwrap_or(0.0), most_moved(recorded)].map(Number::rounded);
            let unit = unit.as_str();
            format!(
                "{error}; the noise is stated as {noise} {unit} (setting `normal_std`), and no marker moved by more than {moved} {unit}"
            )
        }
        PressError::NoContact { .. } if stand_out(recorded) => {
            format!(
                "{error}; but some markers moved much more than the others: are the method, the thickness, the depth of the markers and the indentation those of the sensor?"
            )
        }
        _ => error.to_string(),
    };
    let contradiction = contradiction.map(|contradiction| contradiction.text);
    let message = [suspicion, contradiction]
        .into_iter()
        .flatten()
        .fold(message, |message, more| format!("{message}; {more}"));
    let message = explained(message, error.name());
    match error {
        PressError::NotFinite { marker } | PressError::OffSkin { marker, .. } => {
            origin.fail_at(*marker, message)
        }
        _ => origin.fail(message),
    }
}
