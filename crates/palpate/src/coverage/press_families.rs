//! Families of presses: of presses whose displacements are read directly, and of presses with a fit of camera images.

use palpate_study::config::{
    Baseline, CameraConfig, GainNoise, Indentation, LayoutConfig, LengthNoise, LengthUnit,
    NamedLayout, NoiseKnown, PixelNoise, PressConfig, PressEstimatorConfig, PressModelConfig,
    PressObjectConfig, PressProbeConfig, PressSensorConfig, SensorNoise,
};

use super::{FamilyMatch, Limits, scaled, unless};

// Ranges of the random scenes. Lengths are in radii of the sensor, angles in degrees.
const DEPTH: f64 = 0.1;
const RELATIVE_CURVATURES: [f64; 2] = [2.0 / 3.0, 5.0];
const INDENTATIONS: [f64; 2] = [0.03, 0.07];
const POLAR_ANGLES_DEG: [f64; 2] = [0.0, 20.0];
const NOISES: [f64; 2] = [0.0005, 0.005];
const INDENTATION_STDS: [f64; 2] = [0.0, 0.002];
const THICKNESSES: [f64; 6] = [0.2, 0.25, 0.35, 0.5, 0.7, 1.0];

// Ranges of the random scenes with a fit of images. Lengths are in radii of the sensor, noise in levels of 255.
const IMAGE_SIZES_PX: [f64; 2] = [400.0, 1024.0];
const PIXEL_NOISES: [f64; 2] = [1.0, 5.0];
const MISALIGNMENTS: [f64; 2] = [0.0, 0.3];
const IMAGE_INDENTATION_STDS: [f64; 2] = [0.0, 0.0005];
const IMAGE_THICKNESSES: [f64; 2] = [0.2, 0.5];
/// Polar angle at the edge of the image's inscribed circle.
const FIELD_DEG: f64 = 65.0;
const CAMERA_PLACE: f64 = 0.0025;
const DISC_DEPTH: f64 = 0.0015;

/// Family of a press whose displacements are read directly.
pub(super) fn family(press: &PressConfig, unit: LengthUnit) -> FamilyMatch {
    let mut limits = Limits::new(unit);
    let radius = sensor_radius(press, &mut limits)?;
    check_motion(press, radius, &mut limits)?;
    let PressSensorConfig::Direct { tangential, frames } = press.sensor else {
        return Err(
            "displacements that are not read directly, whose errors the estimator is not told"
                .to_owned(),
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
    let is_exact = |GainNoise::Gaussian { std }: &GainNoise| *std == 0.0;
    unless(noise.gain.as_ref().is_none_or(is_exact), "a gain that errs")?;
    unless(noise.wrong_markers.is_none(), "wrong markers")?;
    let priors = press.estimator.priors();
    let has_baseline = priors.baseline == Baseline::Known;
    unless(has_baseline, "a baseline that is fitted")?;
    let has_gain = priors.gain_std.unwrap_or(0.0) == 0.0;
    unless(has_gain, "a gain that is fitted")?;
    let is_known = knows_indentation(press, scaled(INDENTATION_STDS, radius), &mut limits)?;
    let thickness = layer_thickness(press)?;
    let is_stated = priors.noise == NoiseKnown::Stated;
    let body = match thickness {
        None => "half-space".to_owned(),
        // One family holds the layers of all thicknesses if tangential displacements are read or the noise is estimated.
        Some(_) if tangential || !is_stated => "layers".to_owned(),
        Some(thickness) => {
            let nearest = nearest(thickness / radius, &THICKNESSES);
            format!("layer of {} mm", (20.0 * nearest).round())
        }
    };
    if let Some(thickness) = thickness {
        let thicknesses = scaled([THICKNESSES[0], THICKNESSES[5]], radius);
        limits.length_within("layer", thickness, thicknesses);
    }
    let indentation = if is_known { "known" } else { "fitted" };
    let displacements = if tangential { "all" } else { "normal" };
    let noise = if is_stated { "told" } else { "found" };
    limits.family(format!(
        "{body}, indentation {indentation}, {displacements} displacements, noise {noise}"
    ))
}

/// Family of a press with a fit of camera images.
pub(super) fn image_family(press: &PressConfig, unit: LengthUnit) -> FamilyMatch {
    let mut limits = Limits::new(unit);
    let radius = sensor_radius(press, &mut limits)?;
    check_motion(press, radius, &mut limits)?;
    let PressSensorConfig::Rendered(camera) = &press.sensor else {
        return Err("pictures without pixels".to_owned());
    };
    let CameraConfig { size_px, .. } = camera;
    unless(
        is_usual(camera),
        "a camera that is not the usual one in the very centre",
    )?;
    unless(
        camera.frames == 1 && camera.calibration.rest_frames == 1,
        "more than one frame of a press (`frames`) or at rest (`calibration.rest_frames`, 16 by default)",
    )?;
    limits.within("image", f64::from(*size_px), IMAGE_SIZES_PX, " px");
    let pixel = press.noise.pixel.as_ref();
    let pixel = pixel.map_or(0.0, |PixelNoise::Gaussian { std }| *std);
    limits.within("noise of pixels", pixel, PIXEL_NOISES, " levels");
    let PressProbeConfig::MarkerSphere { discs, .. } = &press.probe;
    let misalignment = discs.as_ref().map_or(0.0, |discs| discs.misalignment);
    limits.within("misalignment", misalignment, MISALIGNMENTS, " diameters");
    let SensorNoise {
        centre_px,
        scale,
        place,
        turn_deg,
        disc_depth,
        disc_diameter,
        colour,
    } = press.noise.sensor.clone().unwrap_or_default();
    let length_unit = format!(" {}", limits.unit);
    for (what, std, most, unit) in [
        ("the image's centre", centre_px, 0.29, " px"),
        ("px per radian", scale, 0.002, ""),
        (
            "the camera's place",
            place,
            CAMERA_PLACE * radius,
            length_unit.as_str(),
        ),
        ("the camera's turn", turn_deg, 0.3, " deg"),
        (
            "discs' depths",
            disc_depth,
            DISC_DEPTH * radius,
            length_unit.as_str(),
        ),
        ("discs' diameters", disc_diameter, 0.01, ""),
        ("colours", colour, 0.01, ""),
    ] {
        limits.within(&format!("uncertainty of {what}"), std, [0.0, most], unit);
    }
    let is_known = knows_indentation(press, scaled(IMAGE_INDENTATION_STDS, radius), &mut limits)?;
    let Some(thickness) = layer_thickness(press)? else {
        return Err("pictures of a half-space".to_owned());
    };
    limits.length_within("layer", thickness, scaled(IMAGE_THICKNESSES, radius));
    let known = if is_known { "known" } else { "fitted" };
    limits.family(format!("pictures of layers, indentation {known}"))
}

/// Radius of the sensor. Its markers must be those of the paper.
fn sensor_radius(press: &PressConfig, limits: &mut Limits) -> Result<f64, String> {
    let PressProbeConfig::MarkerSphere {
        radius,
        marker_depth,
        layout,
        ..
    } = &press.probe;
    let is_published = *layout == LayoutConfig::Named(NamedLayout::Published);
    unless(is_published, "another layout of markers")?;
    let depths = scaled([DEPTH; 2], *radius);
    limits.length_within("depth of markers", *marker_depth, depths);
    Ok(*radius)
}

/// Compares the object, the contact and the indentation with the ranges.
fn check_motion(press: &PressConfig, radius: f64, limits: &mut Limits) -> Result<(), String> {
    let curvature = match press.object {
        PressObjectConfig::Sphere { radius } => radius.recip(),
        PressObjectConfig::Dish { radius } => -radius.recip(),
        PressObjectConfig::Plane {} => 0.0,
    };
    let between = RELATIVE_CURVATURES.map(|relative| (relative - 1.0) / radius);
    limits.curvature_within(curvature, between);
    let indentation = press.motion.indentation;
    limits.length_within("indentation", indentation, scaled(INDENTATIONS, radius));
    let polar_deg = press.motion.contact_deg[0];
    limits.within("polar angle", polar_deg, POLAR_ANGLES_DEG, " deg");
    unless(press.motion.shift == 0.0, "a sideways move")
}

/// Whether the indentation is known to the estimator, with its true standard deviation.
fn knows_indentation(
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

/// Thickness of the layer, `None` for a half-space. The estimator must have the same body as the scene.
fn layer_thickness(press: &PressConfig) -> Result<Option<f64>, String> {
    if press.model.poisson() != 0.5 {
        return Err("a skin that is not incompressible".to_owned());
    }
    if matches!(press.model, PressModelConfig::Hertz { .. }) {
        return Err("displacements of Hertz's contact at the surface".to_owned());
    }
    let pressed = press.model.thickness();
    let estimated = match press.estimator {
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
    match pressed == estimated {
        true => Ok(pressed),
        false => Err("an estimator that believes in another body than is pressed".to_owned()),
    }
}

fn std(noise: &Option<LengthNoise>) -> f64 {
    noise
        .as_ref()
        .map_or(0.0, |LengthNoise::Gaussian { std }| *std)
}

/// The nearest of several positive numbers, by their ratio.
fn nearest(number: f64, among: &[f64]) -> f64 {
    let off = |one: &f64| libm::log(one / number).abs();
    let nearest = among
        .iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)));
    nearest.copied().unwrap_or(number)
}

/// Whether a camera is as in the random scenes, apart from its pixels and frames.
fn is_usual(camera: &CameraConfig) -> bool {
    let CameraConfig {
        k3,
        k5,
        light_at_rim,
        blur_px,
        seam_width,
        place,
        turn_deg,
        ..
    } = camera;
    let lens = [*k3, *k5, *blur_px, *seam_width, light_at_rim - 1.0];
    let stand = place.iter().chain(turn_deg);
    lens.iter().chain(stand).all(|one| *one == 0.0) && camera.field_deg == FIELD_DEG
}
