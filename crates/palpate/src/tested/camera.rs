//! Presses whose pictures are fitted.

use palpate_study::config::{
    CameraConfig, LengthUnit, PixelNoise, PressConfig, PressProbeConfig, PressSensorConfig,
    SensorNoise,
};

use super::limits::{Likeness, Limits, scaled, unless};
use super::press::{of_body, of_indentation, of_motion, of_probe};

// Draws of the random scenes beside those of presses that are read directly. Lengths are in radii of the sensor, noise in
// levels of 255.
const SIZES_PX: [f64; 2] = [400.0, 1024.0];
const NOISES: [f64; 2] = [1.0, 5.0];
const MISALIGNMENTS: [f64; 2] = [0.0, 0.3];
const INDENTATION_STDS: [f64; 2] = [0.0, 0.0005];
const THICKNESSES: [f64; 2] = [0.2, 0.5];
/// Polar angle that the image's inscribed circle shows.
const FIELD_DEG: f64 = 65.0;
const PLACE: f64 = 0.0025;
const DISC_DEPTH: f64 = 0.0015;

/// Family of random scenes that a press before a camera is like, else why there is none.
pub(super) fn family(press: &PressConfig, unit: LengthUnit) -> Likeness {
    let mut limits = Limits::new(unit);
    let radius = of_probe(press, &mut limits)?;
    of_motion(press, radius, &mut limits)?;
    let PressSensorConfig::Rendered(camera) = &press.sensor else {
        return Err("pictures without pixels".to_owned());
    };
    let CameraConfig { size_px, .. } = camera;
    unless(
        is_plain(camera),
        "a camera that is not the usual one in the very centre",
    )?;
    unless(
        camera.frames == 1 && camera.calibration.rest_frames == 1,
        "more than one frame of a press (`frames`) or at rest (`calibration.rest_frames`, 16 by default)",
    )?;
    limits.within("image", f64::from(*size_px), SIZES_PX, " px");
    let pixel = press.noise.pixel.as_ref();
    let pixel = pixel.map_or(0.0, |PixelNoise::Gaussian { std }| *std);
    limits.within("noise of pixels", pixel, NOISES, " levels");
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
    limits.within(
        "uncertainty of the image's centre",
        centre_px,
        [0.0, 0.29],
        " px",
    );
    limits.within("uncertainty of px per radian", scale, [0.0, 0.002], "");
    limits.length_within(
        "uncertainty of the camera's place",
        place,
        scaled([0.0, PLACE], radius),
    );
    limits.within(
        "uncertainty of the camera's turn",
        turn_deg,
        [0.0, 0.3],
        " deg",
    );
    limits.length_within(
        "uncertainty of discs' depths",
        disc_depth,
        scaled([0.0, DISC_DEPTH], radius),
    );
    limits.within(
        "uncertainty of discs' diameters",
        disc_diameter,
        [0.0, 0.01],
        "",
    );
    limits.within("uncertainty of colours", colour, [0.0, 0.01], "");
    let is_known = of_indentation(press, scaled(INDENTATION_STDS, radius), &mut limits)?;
    let thickness = of_body(press)?;
    let Some(thickness) = thickness else {
        return Err("pictures of a half-space".to_owned());
    };
    limits.length_within("layer", thickness, scaled(THICKNESSES, radius));
    let known = if is_known { "known" } else { "fitted" };
    limits.likeness(format!("pictures of layers, indentation {known}"))
}

/// Whether a camera is as those of the random scenes, but for its pixels and frames.
fn is_plain(camera: &CameraConfig) -> bool {
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
