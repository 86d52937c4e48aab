//! Presses whose displacements are read directly.

use palpate_study::config::{
    Baseline, GainNoise, Indentation, LayoutConfig, LengthNoise, LengthUnit, NamedLayout,
    NoiseKnown, PressConfig, PressEstimatorConfig, PressModelConfig, PressObjectConfig,
    PressProbeConfig, PressSensorConfig,
};

use super::limits::{Likeness, Limits, scaled, unless};

// Draws of the random scenes. Lengths are in radii of the sensor, angles in degrees.
const DEPTH: f64 = 0.1;
const RELATIVE_CURVATURES: [f64; 2] = [2.0 / 3.0, 5.0];
const INDENTATIONS: [f64; 2] = [0.03, 0.07];
const POLAR_ANGLES_DEG: [f64; 2] = [0.0, 20.0];
const NOISES: [f64; 2] = [0.0005, 0.005];
const INDENTATION_STDS: [f64; 2] = [0.0, 0.002];
const THICKNESSES: [f64; 6] = [0.2, 0.25, 0.35, 0.5, 0.7, 1.0];

/// Family of random scenes that a press is like, else why there is none.
pub(super) fn family(press: &PressConfig, unit: LengthUnit) -> Likeness {
    let mut limits = Limits::new(unit);
    let radius = of_probe(press, &mut limits)?;
    of_motion(press, radius, &mut limits)?;
    let PressSensorConfig::Direct { tangential, frames } = press.sensor else {
        return Err(
            "displacements from a camera, whose errors the estimator is not told".to_owned(),
        );
    };
    let noise = &press.noise;
    let averaged = f64::from(frames).sqrt();
    let normal = std(&noise.normal_displacement) / averaged;
    limits.length_within("noise of displacements", normal, scaled(NOISES, radius));
    if tangential {
        let along = std(&noise.tangential_displacement) / averaged;
        limits.length_within("noise along the skin", along, scaled(NOISES, radius));
    }
    let gains = noise
        .gain
        .as_ref()
        .map_or(0.0, |GainNoise::Gaussian { std }| *std);
    unless(gains == 0.0, "a gain that errs")?;
    unless(noise.wrong_markers.is_none(), "wrong markers")?;
    let priors = press.estimator.priors();
    unless(
        priors.baseline == Baseline::Known,
        "a baseline that is fitted",
    )?;
    unless(
        priors.gain_std.unwrap_or(0.0) == 0.0,
        "a gain that is fitted",
    )?;
    let is_known = of_indentation(press, scaled(INDENTATION_STDS, radius), &mut limits)?;
    let thickness = of_body(press)?;
    let is_told = priors.noise == NoiseKnown::Stated;
    let body = match thickness {
        None => "half-space".to_owned(),
        // One family of all layers where more is read, or less is told.
        Some(_) if tangential || !is_told => "layers".to_owned(),
        Some(thickness) => {
            let nearest = nearest(thickness / radius, &THICKNESSES);
            format!("layer of {} mm", (20.0 * nearest).round())
        }
    };
    if let Some(thickness) = thickness {
        limits.length_within(
            "layer",
            thickness,
            scaled([THICKNESSES[0], THICKNESSES[5]], radius),
        );
    }
    let indentation = if is_known { "known" } else { "fitted" };
    let displacements = if tangential { "all" } else { "normal" };
    let told = if is_told { "told" } else { "found" };
    limits.likeness(format!(
        "{body}, indentation {indentation}, {displacements} displacements, noise {told}"
    ))
}

/// Radius of the sensor, whose markers are to be those of the paper.
pub(super) fn of_probe(press: &PressConfig, limits: &mut Limits) -> Result<f64, String> {
    let PressProbeConfig::MarkerSphere {
        radius,
        marker_depth,
        layout,
        ..
    } = &press.probe;
    let is_published = *layout == LayoutConfig::Named(NamedLayout::Published);
    unless(is_published, "another layout of markers")?;
    limits.length_within(
        "depth of markers",
        *marker_depth,
        scaled([DEPTH; 2], *radius),
    );
    Ok(*radius)
}

/// Asks for an object, a contact and an indentation among the draws.
pub(super) fn of_motion(
    press: &PressConfig,
    radius: f64,
    limits: &mut Limits,
) -> Result<(), String> {
    let curvature = match press.object {
        PressObjectConfig::Sphere { radius } => radius.recip(),
        PressObjectConfig::Dish { radius } => -radius.recip(),
        PressObjectConfig::Plane {} => 0.0,
    };
    let between = RELATIVE_CURVATURES.map(|relative| (relative - 1.0) / radius);
    limits.curvature_within(curvature, between);
    limits.length_within(
        "indentation",
        press.motion.indentation,
        scaled(INDENTATIONS, radius),
    );
    limits.within(
        "polar angle",
        press.motion.contact_deg[0],
        POLAR_ANGLES_DEG,
        " deg",
    );
    unless(press.motion.shift == 0.0, "a sideways move")
}

/// Whether the indentation is known; asks for an error that is stated as it is.
pub(super) fn of_indentation(
    press: &PressConfig,
    stds: [f64; 2],
    limits: &mut Limits,
) -> Result<bool, String> {
    let priors = press.estimator.priors();
    let is_known = priors.indentation == Indentation::Known;
    if is_known {
        let error = std(&press.noise.indentation);
        unless(
            (error - priors.indentation_std).abs() <= 1e-9 * error,
            "an indentation that errs otherwise than the estimator is told",
        )?;
        limits.length_within("error of the indentation", error, stds);
    }
    Ok(is_known)
}

/// Thickness of the layer, `None` of a half-space; the estimator is to believe in the body that is there.
pub(super) fn of_body(press: &PressConfig) -> Result<Option<f64>, String> {
    if press.model.poisson() != 0.5 {
        return Err("a skin that is not incompressible".to_owned());
    }
    if matches!(press.model, PressModelConfig::Hertz { .. }) {
        return Err("displacements of Hertz's contact at the surface".to_owned());
    }
    let pressed = press.model.thickness();
    let believed = match press.estimator {
        PressEstimatorConfig::HalfSpace { poisson, .. } if poisson.unwrap_or(0.5) == 0.5 => None,
        PressEstimatorConfig::Image {
            thickness, poisson, ..
        } if poisson.unwrap_or(0.5) == 0.5 => thickness.or(pressed),
        PressEstimatorConfig::BondedLayer { thickness, .. } => thickness.or(pressed),
        PressEstimatorConfig::Gaussian { .. } => {
            return Err("a Gaussian, which is no body".to_owned());
        }
        _ => return Err("an estimator that believes in another Poisson's ratio".to_owned()),
    };
    match pressed == believed {
        true => Ok(pressed),
        false => Err("an estimator that believes in another body than is pressed".to_owned()),
    }
}

fn std(noise: &Option<LengthNoise>) -> f64 {
    noise
        .as_ref()
        .map_or(0.0, |LengthNoise::Gaussian { std }| *std)
}

/// The nearest of some positive numbers, by their ratio.
pub(super) fn nearest(number: f64, among: &[f64]) -> f64 {
    let off = |one: &f64| libm::log(one / number).abs();
    let nearest = among
        .iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)));
    nearest.copied().unwrap_or(number)
}
