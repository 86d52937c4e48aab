//! Estimates the curvature of an object from a recorded press.

use palpate_estimators::{PressFitSetup, sensor_body};
use palpate_press::{
    Body, ForwardFit, Markers, Misfit, PressError, PressEstimate, Prior, Reading, Skin,
};
use palpate_statistics::{BadSetting, Number, SIGNIFICANCE_LEVEL};
use palpate_study::Warning;
use palpate_study::config::{LengthUnit, PressEstimatorConfig, SettingError};

use super::error::{RecordedError, explained};
use super::log_warnings::listed;
use super::press_options::PressOptions;
use super::press_recording::PressRecording;
use super::press_report::{PressReport, Row};
use super::press_warnings::{
    common_offset, indentation_check, left_out, misfit_warning, of_estimate, stated_indentation,
    swapped_columns, units,
};
use super::value::Value;

/// Fewest markers with the same displacement that may be lost readings.
const MIN_LOST: usize = 3;
/// Largest relative difference of equal distances from the contact.
const MAX_SCATTER: f64 = 0.01;
/// Readings are lost if the variance of the residuals is smaller without them, by at least this factor.
const MIN_IMPROVEMENT: f64 = 4.0;
/// Largest share of the markers that may be lost.
const MAX_LOST_SHARE: f64 = 0.2;

/// Estimates the curvature of an object from a recorded press.
///
/// # Errors
/// [`RecordedError::Line`] if a marker is wrong. [`RecordedError::Readings`] if the options contradict the file, or if
/// the readings do not determine the press.
pub fn estimate_press(
    recorded: &PressRecording,
    options: &PressOptions,
) -> Result<PressReport, RecordedError> {
    let (count, (distinct, repeated)) = (recorded.places.len(), recorded.without_copies().unzip());
    let recorded = distinct.as_ref().unwrap_or(recorded);
    let report = without_lost(recorded, options, of_distinct(recorded, options))?;
    let repeated = Warning::of("repeated-rows", repeated);
    Ok(PressReport {
        markers: count,
        warnings: repeated.into_iter().chain(report.warnings).collect(),
        ..report
    })
}

/// Leaves out lost readings, for which the sensor has written the same number. These readings are found from the
/// estimate without them: its residuals are much smaller than those of the estimate from all markers, `all`.
fn without_lost(
    recorded: &PressRecording,
    options: &PressOptions,
    all: Result<PressReport, RecordedError>,
) -> Result<PressReport, RecordedError> {
    let (lost, count) = (recorded.of_same_displacement(), recorded.places.len());
    let is_too_many = lost.len() as f64 > MAX_LOST_SHARE * count as f64;
    // Many zeros may be displacements below the smallest one that the sensor measures.
    let is_unclear = all.is_err() || lost.first().is_some_and(|&one| recorded.normal[one] == 0.0);
    if lost.len() < MIN_LOST || is_too_many && is_unclear {
        return all;
    }
    let sound: Vec<usize> = (0..count).filter(|marker| !lost.contains(marker)).collect();
    let Ok(mut report) = of_distinct(&recorded.selected(&sound), options) else {
        return all;
    };
    // Without noise, markers with the same distance from the contact have the same displacement. So if the markers of
    // `lost` have the same distance, they are not lost.
    let distance = |&one: &usize| {
        let [[x, y], at] = [recorded.places[one], report.contact];
        libm::hypot(x - at[0], y - at[1])
    };
    let first = distance(&lost[0]);
    let is_equal = |one: &usize| (distance(one) - first).abs() <= MAX_SCATTER * first;
    let is_worse =
        |all: &PressReport| all.residual_variance() > MIN_IMPROVEMENT * report.residual_variance();
    if lost.iter().all(is_equal) || !all.as_ref().map_or(true, is_worse) {
        return all;
    }
    let source = &recorded.source;
    let value = Number(recorded.normal[lost[0]]);
    let rows = listed(lost.iter().map(|&marker| source.row(marker)));
    let text = format!(
        "{} of {count} markers have the normal displacement {value}, which contradicts the others: lost readings ({rows})",
        lost.len()
    );
    if is_too_many {
        return Err(source.fail(format!("{text}; leave them out of the file")));
    }
    let markers = lost.iter().map(|&marker| recorded.marker(marker));
    report.wrong_markers.extend(markers);
    let warning = Warning::new("left-out", text, []);
    report.warnings.insert(0, warning);
    Ok(report)
}

fn of_distinct(
    recorded: &PressRecording,
    options: &PressOptions,
) -> Result<PressReport, RecordedError> {
    let source = &recorded.source;
    let unit = source.unit(recorded.unit, options.length_unit)?;
    let refused = |error| refused(recorded, options, &error, None);
    let scaled = |place: &[f64; 2]| place.map(|component| component * options.radial_scale);
    let places: Vec<[f64; 2]> = recorded.places.iter().map(scaled).collect();
    let skin = Skin::new(options.radius()).map_err(refused)?;
    let markers = Markers::new(skin, &places).map_err(refused)?;
    let [fit, alone] = fits(options, &markers).map_err(refused)?;
    let std = options.estimator.priors().indentation_std;
    let stated = options.indentation;
    let stated = stated.map(|value| stated_indentation(value, std, unit.as_str()));
    let (indentation, assumed) = stated.unzip();
    let reading = Reading {
        markers: &markers,
        normal: &recorded.normal,
        tangential: recorded.tangential.as_deref(),
        indentation,
    };
    let estimate = fit.estimate(&reading);
    let checked = alone.check_indentation(&reading, estimate.as_ref().ok());
    let (contradiction, unchecked) = indentation_check(checked);
    let is_half_space = matches!(options.estimator, PressEstimatorConfig::HalfSpace { .. });
    let warning = |misfit: &Misfit| {
        let mut warning = misfit_warning(misfit, source, unit);
        if is_half_space && matches!(misfit, Misfit::NotRound { .. }) {
            warning.text += "; setting `method` elliptic estimates both principal curvatures";
        }
        warning
    };
    let estimate = estimate.map_err(|error| {
        let cause = contradiction.as_ref().map(warning);
        self::refused(recorded, options, &error, cause)
    })?;
    let misfits = fit.misfits(&reading, &estimate).map_err(refused)?;
    let mut misfits: Vec<Misfit> = contradiction.into_iter().chain(misfits).collect();
    let is_other = |misfit: &Misfit| matches!(misfit, Misfit::OtherBody { .. });
    if !misfits.iter().any(is_other) {
        misfits.extend(half_space_instead(&fit, &reading, &estimate, options));
    }
    // A contact area that is too wide for the object is an error, unless a warning already states the cause.
    if misfits.is_empty() && estimate.only_marker.is_none() {
        estimate.within_object().map_err(refused)?;
    }
    let wrong = estimate.wrong_markers.iter();
    let wrong_markers: Vec<Row> = wrong.map(|&marker| recorded.marker(marker)).collect();
    let distances = markers.distances(estimate.contact);
    let radius = estimate.contact_radius.value;
    let wrong: Vec<_> = estimate
        .wrong_markers
        .iter()
        .copied()
        .zip(&wrong_markers)
        .collect();
    let left_out = left_out(&wrong, &distances, radius, indentation.is_some());
    let swapped = swapped_columns(&fit, &reading, &estimate, &misfits);
    let has_misfit = !misfits.is_empty();
    let offset = (has_misfit || !wrong_markers.is_empty())
        .then(|| common_offset(&fit, &reading, unit))
        .flatten();
    let warnings = of_estimate(recorded, options, &estimate, has_misfit)
        .chain(Warning::of("offset", offset))
        .chain(Warning::of("swapped-columns", swapped))
        .chain(unchecked)
        .chain(assumed.flatten())
        .chain(left_out)
        .chain(misfits.iter().map(warning));
    let stresses = force_and_pressure(&fit.body, &estimate, options.young, unit);
    let [force, peak_pressure] = stresses.map_err(refused)?;
    Ok(PressReport {
        c: fit.body.c(),
        markers: recorded.places.len(),
        with_tangential: recorded.tangential.is_some(),
        force,
        peak_pressure,
        warnings: warnings.collect(),
        wrong_markers,
        ..PressReport::of(&estimate, (&options.estimator).into(), unit)
    })
}

/// Compares the fit of a layer with the fit of a half-space, which has the same unknowns. Returns a misfit if the
/// readings are much more probable with the half-space. The p-value is an upper bound: if the layer is right, the
/// likelihood ratio exceeds 1/p with a probability of at most p. The comparison is made only if the noise is estimated.
/// In this case, a fit with the wrong body may reject the markers at the contact as outliers and estimate the noise
/// from the other markers. Its residuals then do not show that the body is wrong.
fn half_space_instead(
    fit: &ForwardFit,
    reading: &Reading<'_>,
    estimate: &PressEstimate,
    options: &PressOptions,
) -> Option<Misfit> {
    let is_layer = matches!(options.estimator, PressEstimatorConfig::BondedLayer { .. });
    if !is_layer || fit.normal_std.is_some() {
        return None;
    }
    let other = ForwardFit {
        body: Body::half_space(0.5, options.depth()).ok()?,
        ..fit.clone()
    };
    let other = other.estimate(reading).ok()?;
    let markers =
        reading.normal.len() - estimate.wrong_markers.len().max(other.wrong_markers.len());
    let p_value = (other.normal_std / estimate.normal_std).powi(markers as i32);
    (p_value < SIGNIFICANCE_LEVEL).then_some(Misfit::OtherBody { p_value })
}

/// Returns two fits: the fit that the options state, and a fit for estimates of the indentation from the displacements
/// alone. If the first fit is a Gaussian, the second uses the elastic body of the sensor.
fn fits(options: &PressOptions, markers: &Markers) -> Result<[ForwardFit; 2], PressError> {
    let model = options.model.reference();
    let body = sensor_body(&model, options.depth(), Body::bonded_layer)?;
    let setup = PressFitSetup {
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
    let fit = setup.fit()?;
    let alone = match options.estimator {
        PressEstimatorConfig::Gaussian { .. } => ForwardFit {
            body,
            gain: Prior::Exact,
            ..fit.clone()
        },
        _ => fit.clone(),
    };
    Ok([fit, alone])
}

/// Force and peak pressure of the estimated press; `None` without Young's modulus and for a Gaussian. Returns an error
/// if Young's modulus is so large that the force or the pressure overflows.
pub(super) fn force_and_pressure(
    body: &Body,
    estimate: &PressEstimate,
    young: Option<f64>,
    unit: LengthUnit,
) -> Result<[Option<Value>; 2], PressError> {
    let young = young.filter(|_| estimate.contact_radius.std.is_finite());
    let Some(young) = young else {
        return Ok([None, None]);
    };
    let [force, pressure] = match &estimate.principal {
        Some(principal) => {
            let contact = principal.contact;
            [contact.force(young), contact.pressure(young)].map(Some)
        }
        None => {
            let (curvature, indentation) = (estimate.relative_curvature, estimate.indentation);
            let contact = body.press(curvature.value, indentation.value)?;
            [contact.force(young), contact.peak_pressure(young)]
        }
    };
    let is_sound = |number: Option<f64>| number.is_some_and(f64::is_finite);
    if body.c().is_none() && ![force, pressure].into_iter().all(is_sound) {
        return Err(PressError::BadSetting(BadSetting {
            setting: "young",
            value: young,
            expected: "smaller: force or peak pressure overflow",
        }));
    }
    let force_unit = format!("unit of young x {}^2", unit.as_str());
    let force = force.map(|force| Value::bare(force, force_unit));
    Ok([force, pressure.map(|one| Value::bare(one, "unit of young"))])
}

pub(super) const GIVE_INDENTATION: &str =
    "state setting `indentation` if the indentation is measured";

/// Converts an error of a fit to an error about the recording. If a single marker is wrong, the new error states the
/// marker's line. Its message also states a possible cause: a stated indentation that contradicts the readings, or a
/// likely mistake of sign or unit.
fn refused(
    recorded: &PressRecording,
    options: &PressOptions,
    error: &PressError,
    contradiction: Option<Warning>,
) -> RecordedError {
    let mut sizes: Vec<f64> = recorded.normal.iter().map(|one| one.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let largest = sizes.last().copied().unwrap_or(0.0);
    // The displacements are clearly larger than the noise if at least three of them exceed five times the median
    // displacement.
    let third = sizes.iter().rev().nth(2);
    let are_distinct = third.is_some_and(|third| *third > 5.0 * sizes[sizes.len() / 2]);
    let mut message = match error {
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
        PressError::NoContact { .. } if options.normal_std > Some(largest) => {
            let noise = options.normal_std.unwrap_or(0.0);
            let [noise, moved] = [noise, largest].map(Number::rounded);
            let unit = recorded.unit.or(options.length_unit).unwrap_or_default();
            let unit = unit.as_str();
            format!(
                "{error}; the stated noise is {noise} {unit} (setting `normal_std`), and no marker moved by more than {moved} {unit}"
            )
        }
        PressError::NoContact { .. } if are_distinct => format!(
            "{error}; but some markers moved much more than the others: do the method, the thickness, the depth of the markers and the indentation match the sensor?"
        ),
        _ => error.to_string(),
    };
    if !matches!(error, PressError::BadSetting(_)) {
        let contradiction = contradiction.map(|contradiction| contradiction.text);
        for cause in units(recorded, options).into_iter().chain(contradiction) {
            message += &format!("; {cause}");
        }
    }
    let message = explained(message, error.into());
    match error {
        PressError::NotFinite { marker } | PressError::OffSkin { marker, .. } => {
            recorded.source.fail_at(*marker, message)
        }
        _ => recorded.source.fail(message),
    }
}
