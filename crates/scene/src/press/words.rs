//! Lines about a press for `palpate check`.

use palpate_estimators::{assumed_body, large_contact_warning};
use palpate_press::{Contact, ContactRegime, PressError, Skin};
use palpate_statistics::Number;

use super::ladder::Choice;
use super::pressed::Pressed;
use super::readings::MarkerNoise;
use super::scene::{PressMethod, PressSensor};
use crate::need::Need;
use palpate_study::Warning;
use palpate_study::config::{
    Baseline, CentroidNoise, HueNoise, Indentation, LostMarkers, NoiseKnown, NormalFrom,
    PixelNoise, PressConfig, PressModelConfig, PressNoiseConfig, PressProbeConfig,
    PressSensorConfig, SizeNoise,
};

/// The model and the regime of the contact, with warnings about both.
pub(super) fn of_model(
    choice: &Choice,
    pressed: &Pressed,
    skin: &Skin,
    contact: &Result<Contact<'_>, PressError>,
) -> Vec<Need> {
    let mut model = match choice.model.reference() {
        PressModelConfig::Hertz { .. } => "Hertz contact, markers at the surface: closed form",
        PressModelConfig::HalfSpace { .. } | PressModelConfig::Auto { .. } => {
            "Hertz contact on a half-space, at the markers' depth: closed form"
        }
        PressModelConfig::BondedLayer { .. } => {
            "incompressible layer bonded to a rigid core: computed numerically"
        }
    }
    .to_owned();
    if choice.tolerance.is_some() {
        model += &format!(" ({})", choice.reason);
    }
    let mut needs = vec![Need::from(model)];
    let regime = ContactRegime::of(skin.curvature(), pressed.object.curvature);
    match contact {
        Ok(contact) => {
            let what = match regime {
                ContactRegime::Convex => ": the object bulges",
                ContactRegime::Concave => {
                    ": the object is hollow, less so than the sensor is round"
                }
                ContactRegime::Flat | ContactRegime::Conforming | ContactRegime::Edge => "",
            };
            needs.push(format!("{} contact{what}", regime.name()).into());
            let is_layer = matches!(choice.model, PressModelConfig::BondedLayer { .. });
            let large = large_contact_warning(
                contact.relative_curvature,
                contact.radius,
                skin.radius(),
                is_layer,
            );
            needs.extend(large.map(Need::from));
            if pressed.shift.abs() > contact.radius {
                let numbers = [("shift", pressed.shift), ("contact_radius", contact.radius)];
                let [shift, radius] = numbers.map(|(_, number)| Number::rounded(number));
                let text = format!(
                    "the shift of {shift} is more than the contact's radius, {radius}: strains are not small, and skin would slip"
                );
                needs.push(Warning::new("large-shift", text, numbers).into());
            }
        }
        Err(error) => {
            let name = error.name();
            let text = format!("no press; every trial fails as `{name}`: {error}");
            needs.push(Warning::new("no-press", text, []).into());
        }
    }
    needs
}

const EXACT_TANGENTIAL: &str = "displacements along the skin have no error and outweigh all \
    others; give `noise.tangential_displacement`, or set `sensor.tangential` = false";

/// The errors of the readings, and the sensor.
pub(super) fn of_readings(
    noise: &MarkerNoise,
    sensor: &PressSensor,
    tangential: bool,
    markers: usize,
    config: &PressConfig,
) -> Vec<Need> {
    let is_seen = matches!(sensor, PressSensor::Camera(Ok(seen)) if seen.is_random());
    let none = || (!is_seen).then(|| "no noise: no random numbers are drawn".to_owned());
    let mut needs: Vec<Need> = noise
        .need()
        .or_else(none)
        .map(Need::from)
        .into_iter()
        .collect();
    needs.extend(of_sensor(markers, sensor, tangential, config));
    let is_direct = matches!(sensor, PressSensor::Direct);
    if is_direct && tangential && noise.normal.is_random() && !noise.tangential.is_random() {
        needs.push(Warning::new("exact-tangential-displacements", EXACT_TANGENTIAL, []).into());
    }
    needs
}

fn of_sensor(
    markers: usize,
    sensor: &PressSensor,
    tangential: bool,
    config: &PressConfig,
) -> Vec<Need> {
    let plural = if markers == 1 { "" } else { "s" };
    let with = if tangential { "with" } else { "without" };
    let averaged = |frames: u32| match frames {
        1 => String::new(),
        frames => format!(", the mean of {frames} frames"),
    };
    let (rung, camera) = match &config.sensor {
        PressSensorConfig::Direct { frames, .. } => {
            let frames = averaged(*frames);
            let sensor = format!(
                "direct sensor: {markers} marker{plural}, {with} displacements along the skin{frames}"
            );
            return vec![sensor.into()];
        }
        PressSensorConfig::Projected(camera) => (
            "projected sensor: the camera's picture of each marker in closed form, no pixels"
                .to_owned(),
            camera,
        ),
        PressSensorConfig::Rendered(camera) => (
            format!(
                "rendered sensor: frames of {0} x {0} px, in which markers are found and tracked",
                camera.size_px
            ),
            camera,
        ),
    };
    let from = match camera.normal_from {
        NormalFrom::Hue => "hue",
        NormalFrom::Size => "size",
        NormalFrom::Both => "hue and size",
    };
    let (frames, presses) = (averaged(camera.frames), camera.calibration.presses);
    let models = [
        format!("{rung}: {markers} marker{plural}, {with} displacements along the skin{frames}"),
        format!(
            "normal displacements from the {from} of markers, calibrated by {presses} presses on a plane"
        ),
    ];
    let mut needs: Vec<Need> = models.map(Need::from).into();
    if let PressSensor::Camera(Ok(seen)) = sensor {
        let rest = seen.sensor.rest.iter().flatten().count();
        if rest < markers {
            let text = format!("the camera sees {rest} of {markers} markers");
            let numbers = [("visible", rest as f64), ("markers", markers as f64)];
            needs.push(Warning::new("hidden-markers", text, numbers).into());
        }
    }
    needs.extend(camera_noise(&config.noise).map(Need::from));
    needs
}

/// The noise of the camera, if there is any.
fn camera_noise(noise: &PressNoiseConfig) -> Option<String> {
    let mut errors = Vec::new();
    if let Some(PixelNoise::Gaussian { std }) = noise.pixel {
        errors.push(format!("{std} levels of 255 in each colour of each pixel"));
    }
    if let Some(HueNoise::Gaussian { std }) = noise.hue {
        errors.push(format!("{std} turns in each hue"));
    }
    if let Some(CentroidNoise::Gaussian { std }) = noise.centroid {
        errors.push(format!("{std} px in each centroid"));
    }
    if let Some(SizeNoise::Gaussian { std }) = noise.size {
        errors.push(format!("{} % in each size", 100.0 * std));
    }
    if noise.sensor.is_some() {
        errors.push(
            "another sensor in every trial, which departs from what is known of it".to_owned(),
        );
    }
    if let Some(LostMarkers { count }) = noise.lost_markers {
        errors.push(format!("{count} markers lost"));
    }
    (!errors.is_empty()).then(|| format!("noise of the camera: {}", errors.join("; ")))
}

/// The estimator, with warnings about it.
pub(super) fn of_estimator(config: &PressConfig, method: &PressMethod) -> Vec<Need> {
    let (what, has_depth) = assumed_body(&config.estimator);
    let priors = config.estimator.priors();
    let indentation = match priors.indentation {
        Indentation::Known => "indentation given",
        Indentation::Fitted => "indentation fitted",
    };
    let baseline = match priors.baseline {
        Baseline::Known => "",
        Baseline::Fitted => ", baseline fitted",
    };
    let noise = match priors.noise {
        NoiseKnown::Stated => "noise as stated",
        NoiseKnown::Found => "noise found from the residuals",
    };
    let fit = format!("least-squares fit of {what}, {indentation}{baseline}, {noise}");
    let mut needs = vec![Need::from(fit)];
    if let Err(error) = &method.fit {
        let name = error.name();
        let text = format!("no estimator; every trial fails as `{name}`: {error}");
        needs.push(Warning::new("no-estimator", text, []).into());
    }
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    let at_surface = matches!(config.model, PressModelConfig::Hertz { .. });
    if at_surface && has_depth && marker_depth > 0.0 {
        let text = "the model moves markers as at the surface, the estimator takes them to be at their depth";
        needs.push(
            Warning::new("markers-at-surface", text, [("marker_depth", marker_depth)]).into(),
        );
    }
    needs
}
