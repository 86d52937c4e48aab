//! `palpate estimate press`.

use anyhow::anyhow;
use palpate_scene::recorded::{
    PressBody, PressMethod, PressOptions, PressReadings, estimate_press, read_press,
};

use crate::cli::{BaselineIs, EstimatePressArgs, PressMethodName};
use crate::failure::Failure;
use crate::output;

pub(crate) fn press(args: &EstimatePressArgs) -> Result<(), Failure> {
    let options = press_options(args)?;
    let readings = read_press(&args.readings).map_err(Failure::work)?;
    fits_readings(args, &readings)?;
    let estimate = estimate_press(&readings, &options).map_err(Failure::work)?;
    output::print(&output::json(&estimate)?)
}

fn refuse(message: impl std::fmt::Display) -> Result<(), Failure> {
    Err(Failure::Usage(anyhow!("{message}")))
}

/// Options of the estimator, after a check that the arguments fit together.
pub(crate) fn press_options(args: &EstimatePressArgs) -> Result<PressOptions, Failure> {
    useful(args)?;
    possible(args)?;
    Ok(PressOptions {
        indentation: args
            .indentation
            .map(|indentation| (indentation, args.indentation_std)),
        fits_baseline: args.baseline == BaselineIs::Fitted,
        gain_std: args.gain_std,
        normal_std: args.normal_std,
        tangential_std: args.tangential_std,
        radial_scale: args.radial_scale,
        young: args.young,
        length_unit: args.length_unit,
        ..PressOptions::new(args.sensor_radius, method(args))
    })
}

fn method(args: &EstimatePressArgs) -> PressMethod {
    let depth = args.depth;
    let half_space = PressBody::HalfSpace {
        poisson: args.poisson.unwrap_or(0.5),
        depth,
    };
    let body = match args.thickness {
        Some(thickness) => PressBody::BondedLayer { thickness, depth },
        None => half_space,
    };
    match args.method {
        PressMethodName::HalfSpace => PressMethod::Body(half_space),
        PressMethodName::BondedLayer => PressMethod::Body(body),
        PressMethodName::Gaussian => PressMethod::Gaussian {
            c: args.c,
            calibrated_on: body,
            window: args.window,
        },
    }
}

/// Refuses options that the method has no use for, and the lack of those that it needs.
fn useful(args: &EstimatePressArgs) -> Result<(), Failure> {
    let is_gaussian = args.method == PressMethodName::Gaussian;
    let calibrates = is_gaussian && args.c.is_none();
    let has_layer = args.method == PressMethodName::BondedLayer || calibrates;
    for (option, is_given, is_useful, to_whom) in [
        ("--c", args.c.is_some(), is_gaussian, "--method gaussian"),
        (
            "--window",
            args.window.is_some(),
            is_gaussian,
            "--method gaussian",
        ),
        (
            "--gain-std",
            args.gain_std > 0.0,
            !is_gaussian,
            "half-space and bonded-layer: a Gaussian's amplitude is fitted",
        ),
        (
            "--young",
            args.young.is_some(),
            !is_gaussian,
            "half-space and bonded-layer: a Gaussian knows no stress",
        ),
        (
            "--thickness",
            args.thickness.is_some(),
            has_layer,
            "--method bonded-layer and to calibrate a Gaussian",
        ),
        (
            "--poisson",
            args.poisson.is_some(),
            args.thickness.is_none() && (!is_gaussian || calibrates),
            "a half-space",
        ),
        (
            "--indentation-std",
            args.indentation_std > 0.0,
            args.indentation.is_some(),
            "a given --indentation",
        ),
    ] {
        if is_given && !is_useful {
            return refuse(format_args!("{option} is of use only to {to_whom}"));
        }
    }
    if args.method == PressMethodName::BondedLayer && args.thickness.is_none() {
        return refuse("--method bonded-layer needs --thickness H");
    }
    if calibrates && args.indentation.is_none() {
        return refuse("--method gaussian needs --c C, or --indentation D to calibrate c at");
    }
    Ok(())
}

/// Refuses lengths that do not fit into the sensor.
fn possible(args: &EstimatePressArgs) -> Result<(), Failure> {
    let (depth, radius) = (args.depth, args.sensor_radius);
    if depth >= radius {
        return refuse(format_args!(
            "--depth is {depth}; it must be less than --sensor-radius, {radius}"
        ));
    }
    let (what, limit) = match (args.method, args.thickness) {
        (PressMethodName::BondedLayer, Some(thickness)) => ("--thickness", thickness),
        _ => ("--sensor-radius", radius),
    };
    if let Some(indentation) = args.indentation.filter(|&indentation| indentation >= limit) {
        return refuse(format_args!(
            "--indentation is {indentation}; it must be less than {what}, {limit}"
        ));
    }
    if let Some(thickness) = args.thickness {
        if depth > thickness {
            return refuse(format_args!(
                "--depth is {depth}; it must be at most --thickness, {thickness}"
            ));
        }
        if thickness > radius {
            return refuse(format_args!(
                "--thickness is {thickness}; it must be at most --sensor-radius, {radius}"
            ));
        }
    }
    Ok(())
}

fn fits_readings(args: &EstimatePressArgs, readings: &PressReadings) -> Result<(), Failure> {
    if args.tangential_std.is_some() && !readings.has_tangential() {
        return refuse(
            "--tangential-std is of use only to readings with tangential_x and tangential_y",
        );
    }
    Ok(())
}
