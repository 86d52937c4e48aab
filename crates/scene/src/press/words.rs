//! What a press needs, in words.

use palpate_press::hertz::{LARGE_CONTACT, sneddon_indentation};
use palpate_press::{Contact, ContactRegime, PressError, Skin};

use super::{PressMethod, PressSensor, PressedObject};
use crate::config::{
    Baseline, Indentation, NoiseKnown, PressConfig, PressEstimatorConfig, PressModelConfig,
    PressProbeConfig,
};
use crate::legible::legible;

/// The model, the regime of the contact, and what is doubtful about either.
pub(super) fn of_model(
    model: &PressModelConfig,
    object: &PressedObject,
    skin: &Skin,
    contact: &Result<Contact<'_>, PressError>,
) -> Vec<String> {
    let mut needs = vec![
        match model {
            PressModelConfig::Hertz { .. } => "Hertz contact, seen at the surface: closed form",
            PressModelConfig::HalfSpace { .. } => {
                "Hertz contact on a half-space, at the markers' depth: closed form"
            }
            PressModelConfig::BondedLayer { .. } => {
                "incompressible layer bonded to a rigid core: the contact is solved for"
            }
        }
        .to_owned(),
    ];
    let regime = ContactRegime::of(skin.curvature(), object.curvature);
    match contact {
        Ok(contact) => {
            let what = match regime {
                ContactRegime::Convex => ": the object bulges",
                ContactRegime::Concave => {
                    ": the object is hollow, less so than the sensor is round"
                }
                ContactRegime::Flat | ContactRegime::Conforming | ContactRegime::Edge => "",
            };
            needs.push(format!("{} contact{what}", regime.name()));
            let is_layer = matches!(model, PressModelConfig::BondedLayer { .. });
            let large = large_contact(
                contact.relative_curvature,
                contact.radius,
                skin.radius(),
                is_layer,
            );
            needs.extend(large.map(|large| format!("warning: {large}")));
        }
        Err(error) => needs.push(legible(&format!(
            "warning: no press; every trial fails as `{}`: {error}",
            error.name()
        ))),
    }
    needs
}

/// A warning where the contact is so wide that small-strain theory errs.
pub(crate) fn large_contact(
    relative_curvature: f64,
    contact_radius: f64,
    sensor_radius: f64,
    is_layer: bool,
) -> Option<String> {
    let share = contact_radius / sensor_radius;
    if share <= LARGE_CONTACT {
        return None;
    }
    let doubt = match sneddon_indentation(relative_curvature.recip(), contact_radius) {
        _ if is_layer => "strains are not small".to_owned(),
        Ok(sneddon) => format!(
            "by Sneddon's relation it takes an indentation {:.1} % larger than by Hertz's",
            100.0 * (sneddon / (contact_radius * contact_radius * relative_curvature) - 1.0)
        ),
        Err(_) => "it is wider than a sphere of the effective radius".to_owned(),
    };
    Some(format!(
        "the contact's radius is {share:.2} of the sensor's, past {LARGE_CONTACT}: {doubt}"
    ))
}

pub(super) const EXACT_TANGENTIAL: &str = "warning: displacements along the skin have no error and outweigh all \
    others; give `noise.tangential_displacement`, or set `sensor.tangential` = false";

pub(super) fn of_sensor(markers: usize, sensor: PressSensor) -> String {
    let plural = if markers == 1 { "" } else { "s" };
    let with = if sensor.tangential { "with" } else { "without" };
    let frames = match sensor.frames {
        1 => String::new(),
        frames => format!(", the mean of {frames} frames"),
    };
    format!("direct sensor: {markers} marker{plural}, {with} displacements along the skin{frames}")
}

/// The estimator, and what is doubtful about it.
pub(super) fn of_estimator(config: &PressConfig, method: &PressMethod) -> Vec<String> {
    let (what, indentation, baseline, noise) = match &config.estimator {
        PressEstimatorConfig::HalfSpace {
            indentation,
            baseline,
            noise,
            ..
        } => ("a half-space", indentation, baseline, noise),
        PressEstimatorConfig::BondedLayer {
            indentation,
            baseline,
            noise,
            ..
        } => ("a bonded layer", indentation, baseline, noise),
        PressEstimatorConfig::Gaussian {
            c,
            indentation,
            baseline,
            noise,
            ..
        } => match c {
            Some(_) => ("a Gaussian with a given c", indentation, baseline, noise),
            None => (
                "a Gaussian calibrated on a plane",
                indentation,
                baseline,
                noise,
            ),
        },
    };
    let indentation = match indentation {
        Indentation::Known => "indentation given",
        Indentation::Fitted => "indentation fitted",
    };
    let baseline = match baseline {
        Baseline::Known => "",
        Baseline::Fitted => ", baseline fitted",
    };
    let noise = match noise {
        NoiseKnown::Stated => "noise as stated",
        NoiseKnown::Found => "noise found from the residuals",
    };
    let mut needs = vec![format!(
        "least-squares fit of {what}, {indentation}{baseline}, {noise}"
    )];
    if let Err(error) = &method.fit {
        needs.push(legible(&format!(
            "warning: no estimator; every trial fails as `{}`: {error}",
            error.name()
        )));
    }
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    let at_surface = matches!(config.model, PressModelConfig::Hertz { .. });
    let at_depth = !matches!(config.estimator, PressEstimatorConfig::Gaussian { .. });
    if at_surface && at_depth && marker_depth > 0.0 {
        needs.push(
            "warning: the model moves markers as at the surface, the estimator takes them to be at their depth"
                .to_owned(),
        );
    }
    needs
}
