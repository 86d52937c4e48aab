//! `palpate estimate press`.

use anyhow::anyhow;
use palpate_number::Number;
use palpate_scene::recorded::{PressOptions, PressReadings, estimate_press, parse_press};
use palpate_study::config::{LengthUnit, NoiseKnown, PressEstimatorConfig, PressModelConfig};
use serde_json::Value as Json;

use super::like::Like;
use super::table::{form, table};
use super::warned::warn;
use crate::cli::{EstimatePressArgs, SensorArgs, Settings};
use crate::failure::Failure;
use crate::output;

pub(crate) fn press(args: &EstimatePressArgs) -> Result<(), Failure> {
    let like = Like::of(&args.sensor.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_press(file).map_err(Failure::work)?;
    let unit = readings.unit().or(args.form.length_unit);
    let options = press_options(&args.sensor, like.as_ref(), unit)?;
    let options = PressOptions {
        radial_scale: args.radial_scale,
        length_unit: args.form.length_unit.or(options.length_unit),
        ..options
    };
    fits_readings(args, &readings)?;
    let estimate = estimate_press(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&output::json(&estimate)?)
}

fn refuse<T>(message: impl std::fmt::Display) -> Result<T, Failure> {
    Err(Failure::Usage(anyhow!("{message}")))
}

/// Options of the estimator in the readings' unit, after a check that the arguments fit together.
pub(crate) fn press_options(
    args: &SensorArgs,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
) -> Result<PressOptions, Failure> {
    let like = like.map(|like| like.options(unit, PressOptions::like));
    let base = match (like.transpose()?, args.sensor_radius) {
        (Some(base), _) => base,
        (None, Some(radius)) => PressOptions::new(radius),
        (None, None) => return refuse("needs --sensor-radius R, or --like STUDY.toml"),
    };
    let (estimator, model) = estimator(&args.estimator, &base)?;
    let is_stated = estimator.priors().noise == NoiseKnown::Stated;
    let told = |std: Option<f64>| std.filter(|_| is_stated);
    let options = PressOptions {
        sensor_radius: args.sensor_radius.unwrap_or(base.sensor_radius),
        marker_depth: args.depth.unwrap_or(base.marker_depth),
        model,
        estimator,
        indentation: args.indentation,
        normal_std: args.normal_std.or(told(base.normal_std)),
        tangential_std: args.tangential_std.or(told(base.tangential_std)),
        young: args.young,
        ..base
    };
    useful(args, &options)?;
    possible(&options)?;
    Ok(options)
}

/// The estimator, and the body that it is told of: a Gaussian has neither thickness nor Poisson's ratio, but is calibrated
/// on a body that has.
fn estimator(
    settings: &Settings<PressEstimatorConfig>,
    base: &PressOptions,
) -> Result<(PressEstimatorConfig, PressModelConfig), Failure> {
    let kind = settings.kind().unwrap_or(base.estimator.name());
    if kind != "gaussian" {
        return Ok((settings.over(&base.estimator)?, base.model.clone()));
    }
    let mut of_gaussian = settings.clone();
    let mut number = |key| {
        of_gaussian
            .given
            .remove(key)
            .as_ref()
            .and_then(Json::as_f64)
    };
    let (thickness, poisson) = (number("thickness"), number("poisson"));
    let estimator = of_gaussian.over(&base.estimator)?;
    let has_c = matches!(estimator, PressEstimatorConfig::Gaussian { c: Some(_), .. });
    match (thickness, poisson) {
        (None, None) => Ok((estimator, base.model.clone())),
        (Some(_), _) if has_c => refuse(
            "--thickness is of use only to --method bonded-layer and to calibrate a Gaussian, whose --c is given",
        ),
        (None, Some(_)) if has_c => refuse(
            "--poisson is of use only to --method half-space and to calibrate a Gaussian, whose --c is given",
        ),
        (Some(_), Some(_)) => {
            refuse("--poisson is of use only without --thickness: a layer's is 0.5")
        }
        (Some(thickness), None) => Ok((estimator, PressModelConfig::BondedLayer { thickness })),
        (None, Some(poisson)) => Ok((estimator, PressModelConfig::HalfSpace { poisson })),
    }
}

/// Refuses options that the estimator has no use for, and the lack of those that it needs.
fn useful(args: &SensorArgs, options: &PressOptions) -> Result<(), Failure> {
    let is_told = options.indentation.is_some();
    if args.estimator.given.contains_key("indentation_std") && !is_told {
        return refuse("--indentation-std is of use only to a given --indentation");
    }
    let is_found = args
        .estimator
        .given
        .get("noise")
        .is_some_and(|word| word == "found");
    for (option, std) in [
        ("--normal-std", args.normal_std),
        ("--tangential-std", args.tangential_std),
    ] {
        if is_found && std.is_some() {
            return refuse(format_args!(
                "{option} is of use only without --noise found"
            ));
        }
    }
    let thickness = options.model.thickness();
    match options.estimator {
        PressEstimatorConfig::Gaussian { .. } if options.young.is_some() => refuse(
            "--young is of use only to --method half-space or bonded-layer: a Gaussian knows no stress",
        ),
        PressEstimatorConfig::Gaussian { c: None, .. } if !is_told => {
            refuse("--method gaussian needs --c C, or --indentation D to calibrate c at")
        }
        PressEstimatorConfig::BondedLayer {
            thickness: None, ..
        } if thickness.is_none() => refuse("--method bonded-layer needs --thickness H"),
        _ => Ok(()),
    }
}

/// Refuses lengths that do not fit into the sensor.
fn possible(options: &PressOptions) -> Result<(), Failure> {
    let (depth, radius) = (options.marker_depth, options.sensor_radius);
    if depth >= radius {
        return refuse(format_args!(
            "--depth is {}; it must be less than --sensor-radius, {}",
            Number(depth),
            Number(radius)
        ));
    }
    let of_model = options.model.thickness();
    let (thickness, limit) = match options.estimator {
        PressEstimatorConfig::BondedLayer { thickness, .. } => {
            let thickness = thickness.or(of_model);
            (thickness, thickness.map(|limit| ("--thickness", limit)))
        }
        PressEstimatorConfig::Gaussian { c: None, .. } => (of_model, None),
        _ => (None, None),
    };
    let (what, limit) = limit.unwrap_or(("--sensor-radius", radius));
    if let Some(indentation) = options
        .indentation
        .filter(|&indentation| indentation >= limit)
    {
        return refuse(format_args!(
            "--indentation is {}; it must be less than {what}, {}",
            Number(indentation),
            Number(limit)
        ));
    }
    if let Some(thickness) = thickness {
        if depth > thickness {
            return refuse(format_args!(
                "--depth is {}; it must be at most --thickness, {}",
                Number(depth),
                Number(thickness)
            ));
        }
        if thickness > radius {
            return refuse(format_args!(
                "--thickness is {}; it must be at most --sensor-radius, {}",
                Number(thickness),
                Number(radius)
            ));
        }
    }
    Ok(())
}

fn fits_readings(args: &EstimatePressArgs, readings: &PressReadings) -> Result<(), Failure> {
    if args.sensor.tangential_std.is_some() && !readings.has_tangential() {
        return refuse(
            "--tangential-std is of use only to readings with tangential_x and tangential_y",
        );
    }
    Ok(())
}
