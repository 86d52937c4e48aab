//! The curvature of an object from a recorded press.

use palpate_number::{BadSetting, Number};
use palpate_press::{
    Body, ContactRegime, Estimated, ForwardFit, Markers, Measured, PressError, PressEstimate,
    Reading, Skin,
};

use super::Value;
use super::press::PressReadings;
use super::pressed_object::{PressNoise, PressedObject, Radius, Row, Told};
use super::sheet::{RecordedError, agreed_unit};
use crate::press::{Assumed, body_of, large_contact};
use palpate_study::Unit;
use palpate_study::config::{LengthUnit, PressEstimatorConfig, PressModelConfig};

/// Settings of an estimate that the readings do not state; lengths in the readings' unit.
#[derive(Clone, Debug, PartialEq)]
pub struct PressOptions {
    /// Radius of the skin, length.
    pub sensor_radius: f64,
    /// Depth of the markers under the skin, length.
    pub marker_depth: f64,
    /// Model of the sensor's soft body: what the estimator leaves out is its, and a Gaussian is calibrated on it.
    pub model: PressModelConfig,
    /// The estimator. Whether it is given the indentation is told by [`Self::indentation`] and not by its own setting: a
    /// study knows the indentation of its presses, a reading does not.
    pub estimator: PressEstimatorConfig,
    /// The indentation, if something else tells it; length. The estimator ascribes its `indentation_std` to it.
    pub indentation: Option<f64>,
    /// Standard deviation of normal displacements, length; `None` finds it from the residuals.
    pub normal_std: Option<f64>,
    /// Standard deviation of displacements along the skin, length; `None` finds it from the residuals.
    pub tangential_std: Option<f64>,
    /// Factor on the markers' positions.
    pub radial_scale: f64,
    /// Young's modulus of the soft body, force per length²; gives forces.
    pub young: Option<f64>,
    /// The unit of lengths, where the header does not state it.
    pub length_unit: Option<LengthUnit>,
}

impl PressOptions {
    /// Options with nothing known but the sensor's radius: a half-space with its markers at the surface.
    pub fn new(sensor_radius: f64) -> Self {
        Self {
            sensor_radius,
            marker_depth: 0.0,
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

/// Estimates the curvature of an object from a recorded press.
///
/// # Errors
/// [`RecordedError::Line`] where one marker is at fault, else [`RecordedError::Readings`]: where the options contradict
/// the file, or the readings tell no press.
pub fn estimate_press(
    recorded: &PressReadings,
    options: &PressOptions,
) -> Result<PressedObject, RecordedError> {
    let unit = agreed_unit(&recorded.file, recorded.unit, options.length_unit)?;
    let refused = |error| refused(recorded, options, &error);
    let scaled = |place: &[f64; 2]| place.map(|component| component * options.radial_scale);
    let places: Vec<[f64; 2]> = recorded.places.iter().map(scaled).collect();
    let skin = Skin::new(options.sensor_radius).map_err(refused)?;
    let markers = Markers::new(skin, &places).map_err(refused)?;
    let (fit, c) = fit(options, &markers).map_err(refused)?;
    let reading = Reading {
        markers: &markers,
        normal: &recorded.normal,
        tangential: recorded.tangential.as_deref(),
        indentation: options.indentation.map(|value| Measured {
            value,
            std: options.estimator.priors().indentation_std,
        }),
    };
    let estimate = fit.estimate(&reading).map_err(refused)?;
    let told = |estimated, power| Told::new(&estimated, power, unit);
    let curvature = estimate.object_curvature();
    // Radii are those of the best fit.
    let most_likely = Estimated {
        value: estimate.most_likely_object_curvature(),
        ..curvature
    };
    let [force, peak_pressure] = stresses(&fit.body, &estimate, options, unit).map_err(refused)?;
    Ok(PressedObject {
        method: options.estimator.name(),
        c,
        markers: recorded.places.len(),
        with_tangential: recorded.tangential.is_some(),
        length_unit: unit.as_str(),
        relative_curvature: told(estimate.relative_curvature, Unit::PerLength),
        effective_radius: told(estimate.effective_radius(), Unit::Length),
        object_curvature: told(curvature, Unit::PerLength),
        object_radius: Radius::of(&most_likely, unit),
        regime: ContactRegime::of(skin.curvature(), most_likely.value).name(),
        verdict: estimate.verdict.name(),
        indentation: told(estimate.indentation, Unit::Length),
        contact_radius: told(estimate.contact_radius, Unit::Length),
        force,
        peak_pressure,
        contact: estimate.contact.map(|component| component + 0.0),
        contact_std: estimate
            .contact_std
            .map(|std| Some(std).filter(|std| std.is_finite())),
        baseline: estimate
            .baseline
            .map(|baseline| told(baseline, Unit::Length)),
        gain: estimate.gain.map(|gain| told(gain, Unit::One)),
        wrong_markers: estimate
            .wrong_markers
            .iter()
            .map(|&marker| Row {
                row: marker + 1,
                line: recorded.lines.get(marker).copied(),
            })
            .collect(),
        noise: PressNoise {
            normal_std: Value::new(estimate.normal_std, None, Unit::Length, unit),
            tangential_std: estimate
                .tangential_std
                .map(|std| Value::new(std, None, Unit::Length, unit)),
            reduced_chi_squared: estimate.reduced_chi_squared,
        },
        r_squared: estimate.r_squared,
        warnings: warnings(&estimate, options),
    })
}

/// The fit, and the c of a Gaussian.
fn fit(options: &PressOptions, markers: &Markers) -> Result<(ForwardFit, Option<f64>), PressError> {
    let model = options.model.reference();
    let assumed = Assumed {
        estimator: &options.estimator,
        model: &model,
        body: &body_of(&model, options.marker_depth, Body::bonded_layer)?,
        shared: model.thickness(),
        markers,
        marker_depth: options.marker_depth,
        calibrated_at: options.indentation,
        knows_indentation: options.indentation.is_some(),
        stds: [options.normal_std, options.tangential_std],
    };
    let fit = assumed.fit()??;
    let c = fit.body.c();
    Ok((fit, c))
}

/// The force and the highest pressure of the estimated press, where they are known.
fn stresses(
    body: &Body,
    estimate: &PressEstimate,
    options: &PressOptions,
    unit: LengthUnit,
) -> Result<[Option<Value>; 2], PressError> {
    let Some(young) = options.young else {
        return Ok([None, None]);
    };
    let (curvature, indentation) = (estimate.relative_curvature, estimate.indentation);
    let contact = body.press(curvature.value, indentation.value)?;
    let value = |value: f64, unit: &str| Value {
        value,
        std: None,
        unit: unit.to_owned(),
    };
    let sound = |number: Option<f64>| number.filter(|number| number.is_finite());
    let area = format!("unit of --young x {}^2", unit.as_str());
    Ok([
        sound(contact.force(young)).map(|force| value(force, &area)),
        sound(contact.peak_pressure(young)).map(|pressure| value(pressure, "unit of --young")),
    ])
}

/// Past this ratio of the residuals to the noise that is stated, the intervals are too narrow.
const LARGE_RESIDUALS: f64 = 1.5;

/// Share of the variance below which the fit explains little.
const LITTLE: f64 = 0.5;

fn warnings(estimate: &PressEstimate, options: &PressOptions) -> Vec<String> {
    let is_layer = matches!(options.estimator, PressEstimatorConfig::BondedLayer { .. });
    let large = large_contact(
        estimate.relative_curvature.value,
        estimate.contact_radius.value,
        options.sensor_radius,
        is_layer,
    );
    let ratio = estimate.reduced_chi_squared.sqrt();
    let residuals = (options.normal_std.is_some() && ratio > LARGE_RESIDUALS).then(|| {
        format!(
            "the residuals are {ratio:.1} times the noise that is given: intervals are too narrow"
        )
    });
    let unexplained = (estimate.r_squared < LITTLE).then(|| {
        let percent = 100.0 * estimate.r_squared.max(0.0);
        format!(
            "the fit explains {percent:.0} % of the normal displacements' variance: noise, or not the press of this body"
        )
    });
    large
        .into_iter()
        .chain(residuals)
        .chain(unexplained)
        .collect()
}

/// The error in the words of the command line, with the line of the marker that is at fault, if it is one.
fn refused(recorded: &PressReadings, options: &PressOptions, error: &PressError) -> RecordedError {
    let file = recorded.file.clone();
    let message = match error {
        PressError::BadSetting(BadSetting {
            setting,
            value,
            expected,
        }) => {
            let option = match *setting {
                "radius" => "sensor-radius".to_owned(),
                setting => setting.replace('_', "-"),
            };
            format!("--{option} is {}; it must be {expected}", Number(*value))
        }
        PressError::Undetermined { .. } if options.indentation.is_none() => {
            format!("{error}; give the indentation with --indentation D if it is known")
        }
        _ => error.to_string(),
    };
    match error {
        PressError::NotFinite { marker }
        | PressError::OffSkin { marker, .. }
        | PressError::OneMarker { marker, .. }
            if *marker < recorded.lines.len() =>
        {
            RecordedError::Line {
                file,
                line: recorded.lines[*marker],
                message,
            }
        }
        _ => RecordedError::Readings { file, message },
    }
}
