//! Families of rolls with a least-squares estimate over all probes.

use palpate_study::config::{
    AngularVelocityNoise, LengthUnit, ObjectConfig, PadLayout, PadOffset, ProbeConfig, RollConfig,
    RollMotionConfig, RollSensorConfig, When,
};

use super::{FamilyMatch, Limits, scaled, unless};

// Ranges of the random scenes. Lengths are in radii of the probe, angles in radians.
const PROBES: [usize; 2] = [4, 8];
const RADII: [f64; 2] = [0.8, 20.0];
const SEMI_AXES: [f64; 2] = [2.0, 8.0];
const SHORT_ANGLES: [f64; 2] = [0.1, 0.3];
const LONG_ANGLES: [f64; 2] = [0.5, 1.2];
const SHIFT_STDS: [f64; 2] = [0.001, 0.01];
const ROTATION_STDS: [f64; 2] = [0.005, 0.03];
/// Smallest and largest bound of a uniform error: √3 standard deviations.
const ROTATION_BOUNDS: [f64; 2] = [0.008_660_254_037_844_386, 0.051_961_524_227_066_32];
const PITCHES: [f64; 2] = [0.01, 0.05];

/// Family of a roll.
pub(super) fn family(roll: &RollConfig, unit: LengthUnit) -> FamilyMatch {
    let mut limits = Limits::new(unit);
    let ProbeConfig::Sphere { radius } = roll.probe;
    let probes = roll.motion.directions_deg.len();
    unless(
        PROBES.contains(&probes),
        "a number of probes that is neither 4 nor 8",
    )?;
    unless(roll.motion.spin_rad_per_s == 0.0, "a probe that spins")?;
    let (object, curvature) = of_object(&roll.object, radius, &mut limits)?;
    let angle = angle(&roll.motion, radius, curvature)?;
    // The curvature of a ball is the same everywhere, so balls were measured with short rolls only.
    let is_long = object != "balls" && angle > (SHORT_ANGLES[1] * LONG_ANGLES[0]).sqrt();
    let angles = if is_long { LONG_ANGLES } else { SHORT_ANGLES };
    limits.within("rotation", angle, angles, " rad");
    let sensor = of_sensor(roll, radius, &mut limits)?;
    let rolls = if is_long { "long rolls" } else { "short rolls" };
    limits.family(format!(
        "{probes} probes, {object}, {rolls}, {sensor}, told"
    ))
}

/// Name of the objects, and the curvature of a ball.
fn of_object(
    object: &ObjectConfig,
    probe: f64,
    limits: &mut Limits,
) -> Result<(&'static str, Option<f64>), String> {
    match object {
        ObjectConfig::Sphere { radius } => {
            limits.length_within("radius", *radius, scaled(RADII, probe));
            Ok(("balls", Some(radius.recip())))
        }
        ObjectConfig::Ellipsoid { semi_axes } => {
            for axis in semi_axes {
                limits.length_within("semi-axis", *axis, scaled(SEMI_AXES, probe));
            }
            Ok(("ellipsoids", None))
        }
        _ => Err("an object that is neither a ball nor an ellipsoid".to_owned()),
    }
}

/// Rotation of each probe.
fn angle(motion: &RollMotionConfig, radius: f64, curvature: Option<f64>) -> Result<f64, String> {
    let by_rate = motion.rate_rad_per_s.zip(motion.duration_s);
    let by_rate = by_rate.map(|(rate, duration)| rate * duration);
    let direct = motion.angle_deg.map(f64::to_radians).or(by_rate);
    // A contact moves by 1/(1/R₁ + 1/R₂) per radian.
    let arc = motion.arc_length.zip(curvature);
    let by_arc = arc.map(|(length, curvature)| length * (radius.recip() + curvature));
    direct.or(by_arc).ok_or_else(|| {
        "rolls whose rotations follow from lengths on an object that is no ball".to_owned()
    })
}

/// Name of the noise.
fn of_sensor(roll: &RollConfig, radius: f64, limits: &mut Limits) -> Result<&'static str, String> {
    let is_unmeasured = roll.noise.encoder.is_none() && roll.noise.rotation.is_none();
    unless(is_unmeasured, "measured rotations")?;
    let (rotations, drawn, name) = match &roll.noise.angular_velocity {
        None => (0.0, ROTATION_STDS, ""),
        Some(AngularVelocityNoise::Gaussian {
            fraction,
            when: When::PerProbe,
            ..
        }) => (*fraction, ROTATION_STDS, "noise of rotations"),
        Some(AngularVelocityNoise::Uniform {
            fraction,
            when: When::PerProbe,
            ..
        }) => (*fraction, ROTATION_BOUNDS, "uniform noise of rotations"),
        Some(_) => return Err("errors of rotations that are drawn at instants".to_owned()),
    };
    if rotations > 0.0 {
        limits.within("error of rotations", rotations, drawn, "");
    }
    match roll.sensor {
        RollSensorConfig::Pads {
            pitch,
            layout,
            offset,
            ..
        } => {
            let is_known = layout == PadLayout::Square && offset == PadOffset::Random;
            unless(
                is_known,
                "pads that are not square or whose places are not random",
            )?;
            unless(rotations == 0.0, "pads with errors of rotations")?;
            limits.length_within("pitch", pitch, scaled(PITCHES, radius));
            Ok("pads")
        }
        RollSensorConfig::Wrist { std } if std > 0.0 => {
            limits.length_within("error of shifts", std, scaled(SHIFT_STDS, radius));
            match (rotations > 0.0, drawn == ROTATION_STDS) {
                (false, _) => Ok("noise of shifts"),
                (true, true) => Ok("noise of both"),
                (true, false) => {
                    Err("uniform errors of rotations beside errors of shifts".to_owned())
                }
            }
        }
        RollSensorConfig::Ideal {} | RollSensorConfig::Wrist { .. } if rotations > 0.0 => Ok(name),
        _ => Err("no noise".to_owned()),
    }
}
