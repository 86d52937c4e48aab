//! The lines that `palpate check` prints about a press: its models, its noise, and warnings.

use palpate_estimators::{fit_description, large_contact_warning};
use palpate_press::{ContactRegime, ObjectContact, PressEstimate};
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::{
    CameraConfig, NormalFrom, PressEstimatorConfig, PressModelConfig, PressNoiseConfig,
    PressProbeConfig, PressSensorConfig, Pure, ReadingNoise,
};

use super::reading::PressNoise;
use super::trial::{PressCase, PressEstimator, PressScene};
use super::truth::TruePress;
use crate::scene::{Need, joined};

const EXACT_TANGENTIAL: &str = "displacements along the skin have no error, so the fit ignores \
     all other displacements; set `noise.tangential_displacement`, or `sensor.tangential` = false";

impl PressScene {
    pub(super) fn description(&self) -> Vec<Need> {
        let mut needs = vec![Need::Model(self.model_text())];
        match &self.case {
            PressCase::Press { truth, .. } => needs.extend(self.contact_needs(truth)),
            PressCase::NoPress(error) => {
                let name: &str = error.into();
                let text = format!("no press; every trial fails as `{name}`: {error}");
                needs.push(Need::Warning(Warning::new("no-press", text, [])));
            }
        }
        needs.extend(self.reading_needs());
        needs.extend(self.estimator_needs());
        needs.extend(self.exact_warning().map(Need::Warning));
        needs
    }

    /// Text for `palpate check` about the model of the soft body. If `auto` chose the model, the text states the
    /// reason.
    fn model_text(&self) -> String {
        let model = match self.choice.model.reference() {
            PressModelConfig::Hertz { .. } => "Hertz contact, markers at the surface: closed form",
            PressModelConfig::HalfSpace { .. } | PressModelConfig::Auto { .. } => {
                "Hertz contact on a half-space, at the markers' depth: closed form"
            }
            PressModelConfig::BondedLayer { .. } => {
                "incompressible layer bonded to a rigid core: computed numerically"
            }
        };
        match self.choice.tolerance {
            Some(_) => format!("{model} ({})", self.choice.reason),
            None => model.to_owned(),
        }
    }

    fn contact_needs(&self, truth: &TruePress) -> Vec<Need> {
        let skin = self.markers.skin();
        let (object, shift) = (truth.geometry.curvature, truth.geometry.shift);
        let radius = truth.contact_radius;
        let regime = ContactRegime::of(skin.curvature(), object);
        let shape = match regime {
            ContactRegime::Convex => ": the object bulges",
            ContactRegime::Concave => ": the object is hollow, but less curved than the sensor",
            ContactRegime::Flat | ContactRegime::Conforming | ContactRegime::Edge => "",
        };
        let ellipse = match truth.geometry.unequal {
            Some(_) => "; it is an ellipse, because the object has two different curvatures",
            None => "",
        };
        let text = format!("{} contact{shape}{ellipse}", <&str>::from(regime));
        let mut needs = vec![Need::Model(text)];
        let is_layer = matches!(self.choice.model, PressModelConfig::BondedLayer { .. });
        // The longer semi-axis of the contact is in the direction in which the curvature is smaller.
        let own = skin.curvature();
        let extents = match self.geometry.contact(&self.body, &self.markers) {
            Ok(ObjectContact::Elliptic(contact, _)) => {
                std::iter::zip(contact.relative_curvatures, contact.semi_axes).collect()
            }
            _ => vec![(own + object, radius)],
        };
        let large = extents.into_iter().find_map(|(relative, radius)| {
            large_contact_warning(relative, radius, skin.radius(), is_layer)
        });
        needs.extend(large.map(Need::Warning));
        if shift.abs() > radius {
            let numbers = [("shift", shift), ("contact_radius", radius)];
            let [shift, radius] = numbers.map(|(_, number)| Number::rounded(number));
            let text = format!(
                "the shift of {shift} is more than the contact radius, {radius}: the strains are \
                 not small, and skin would slip"
            );
            needs.push(Need::Warning(Warning::new("large-shift", text, numbers)));
        }
        needs
    }

    fn reading_needs(&self) -> Vec<Need> {
        let camera = self.case.camera();
        let mut needs = Vec::new();
        match displacement_noise(&self.noise) {
            Some(noise) => needs.push(Need::Model(noise)),
            None if camera.is_some_and(|camera| camera.is_random()) => {}
            None => needs.push(Need::Model(
                "no noise: no random numbers are drawn".to_owned(),
            )),
        }
        let markers = self.places.len();
        let plural = if markers == 1 { "" } else { "s" };
        let with = if self.has_tangential {
            "with"
        } else {
            "without"
        };
        let displacements = |frames| {
            format!(
                "{markers} marker{plural}, {with} displacements along the skin{}",
                averaged(frames)
            )
        };
        let (level, config) = match &self.config.sensor {
            PressSensorConfig::Direct { frames, .. } => {
                needs.push(Need::Model(format!(
                    "direct sensor: {}",
                    displacements(*frames)
                )));
                let is_exact = !self.noise.markers.tangential.is_random();
                if self.has_tangential && self.noise.markers.normal.is_random() && is_exact {
                    let code = "exact-tangential-displacements";
                    needs.push(Need::Warning(Warning::new(code, EXACT_TANGENTIAL, [])));
                }
                return needs;
            }
            PressSensorConfig::Projected(camera) => (
                "projected sensor: the camera's image of each marker in closed form, no pixels"
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
        needs.push(Need::Model(format!(
            "{level}: {}",
            displacements(config.frames)
        )));
        needs.push(Need::Model(calibration_text(config)));
        if let Some(camera) = camera {
            let visible = camera.rest.iter().flatten().count();
            if visible < markers {
                let text = format!("the camera sees {visible} of {markers} markers");
                let numbers = [("visible", visible as f64), ("markers", markers as f64)];
                needs.push(Need::Warning(Warning::new("hidden-markers", text, numbers)));
            }
        }
        needs.extend(camera_noise(&self.config.noise).map(Need::Model));
        needs
    }

    fn estimator_needs(&self) -> Vec<Need> {
        let estimator = &self.config.estimator;
        let mut needs = vec![Need::Model(fit_description(estimator))];
        if let PressEstimator::NoFit(error) = &self.estimator {
            let name: &str = error.into();
            let text = format!("no estimator; every trial fails as `{name}`: {error}");
            needs.push(Need::Warning(Warning::new("no-estimator", text, [])));
        }
        let PressProbeConfig::MarkerSphere { marker_depth, .. } = self.config.probe;
        let at_surface = matches!(self.choice.model, PressModelConfig::Hertz { .. });
        let has_depth = !matches!(estimator, PressEstimatorConfig::Gaussian { .. });
        if at_surface && has_depth && marker_depth > 0.0 {
            let text = "the model moves the markers as if they were at the surface, but the \
                 estimator assumes that they are at their depth";
            let numbers = [("marker_depth", marker_depth)];
            needs.push(Need::Warning(Warning::new(
                "markers-at-surface",
                text,
                numbers,
            )));
        }
        needs
    }

    fn exact_warning(&self) -> Option<Warning> {
        if let PressCase::NoPress(_) = &self.case {
            return None;
        }
        match self.exact() {
            Ok(estimate) => bias_warning(estimate, self.geometry.curvature),
            Err(error) => {
                let name: &str = error.into();
                let text = format!("even without noise the estimate fails as `{name}`: {error}");
                Some(Warning::new("no-estimate", text, []))
            }
        }
    }
}

fn displacement_noise(noise: &PressNoise) -> Option<String> {
    let (markers, indentation) = (&noise.markers, &noise.indentation);
    let errors = [
        (
            markers.normal.is_random(),
            "normal displacements, drawn per marker",
        ),
        (
            markers.tangential.is_random(),
            "tangential displacements, drawn per marker and component",
        ),
        (indentation.is_random(), "the given indentation"),
        (markers.gain.is_random(), "the gain of a press"),
        (markers.outliers > 0, "outliers among the markers"),
    ];
    let biases = [
        (
            markers.normal.bias() != 0.0,
            "a bias of all normal displacements",
        ),
        (indentation.bias() != 0.0, "a bias of the given indentation"),
    ];
    let stated = |(is_stated, text): (bool, &'static str)| is_stated.then_some(text);
    let errors = joined(errors.map(stated), "; of ");
    let errors = errors.map(|errors| format!("Gaussian errors of {errors}"));
    let all = joined([errors, joined(biases.map(stated), "; ")], "; ");
    all.map(|all| format!("noise: {all}"))
}

fn averaged(frames: u32) -> String {
    match frames {
        1 => String::new(),
        frames => format!(", the mean of {frames} frames"),
    }
}

fn calibration_text(camera: &CameraConfig) -> String {
    let from = match camera.normal_from {
        NormalFrom::Hue => "hue",
        NormalFrom::Size => "size",
        NormalFrom::Both => "hue and size",
    };
    let presses = camera.calibration.presses;
    format!(
        "normal displacements from the {from} of markers, calibrated by {presses} presses on a plane"
    )
}

fn camera_noise(noise: &PressNoiseConfig) -> Option<String> {
    let std = |noise: Option<ReadingNoise<Pure>>| noise.map(|ReadingNoise::Gaussian { std }| std.0);
    let pixel = noise.pixel.map(|ReadingNoise::Gaussian { std }| std.0);
    let sensor = noise.sensor.as_ref();
    let lost = noise.lost_markers.as_ref();
    let errors = [
        pixel.map(|std| format!("{std} levels of 255 in each colour of each pixel")),
        std(noise.hue).map(|std| format!("{std} turns in each hue")),
        std(noise.centroid).map(|std| format!("{std} px in each centroid")),
        std(noise.size).map(|std| format!("{} % in each size", 100.0 * std)),
        sensor.map(|_| "parameters of the sensor, redrawn in every trial".to_owned()),
        lost.map(|lost| format!("{} markers lost", lost.count)),
    ];
    joined(errors, "; ").map(|errors| format!("noise of the camera: {errors}"))
}

/// Largest accepted error of the curvature that is estimated from noiseless readings, relative to the sum of the
/// curvatures of the sensor and the object. A larger error is reported as a bias.
const BIAS_LIMIT: f64 = 0.5;
/// Largest accepted error of the curvature that is estimated from noiseless readings, if its interval excludes the true
/// value. The error is relative to the sum of the curvatures of the sensor and the object.
const EXCLUDED_BIAS_LIMIT: f64 = 0.05;

fn bias_warning(estimate: &PressEstimate, object: f64) -> Option<Warning> {
    let estimated = estimate.object_curvature();
    let relative = estimate.sensor_curvature + object;
    let error = (estimated.value - object).abs();
    if error <= EXCLUDED_BIAS_LIMIT * relative {
        return None;
    }
    match error > BIAS_LIMIT * relative || !estimated.interval.holds(object) {
        true => {
            let numbers = [
                ("estimated_curvature", estimated.value),
                ("true_curvature", object),
            ];
            let [estimated, object] = numbers.map(|(_, number)| Number::rounded(number));
            let text = format!(
                "even without noise the estimated curvature is {estimated}, but the true one is {object}: the estimator's model does not match the simulated body, contact or readings"
            );
            Some(Warning::new("biased-estimate", text, numbers))
        }
        false => unexplained_warning(estimate),
    }
}

/// Smallest accepted R² of a fit to noiseless readings, that is, the share of the variance of normal displacements that
/// the fit explains. If the estimator assumes the correct soft body, R² is larger.
const MIN_R_SQUARED: f64 = 0.95;

fn unexplained_warning(estimate: &PressEstimate) -> Option<Warning> {
    let explained = estimate.r_squared;
    (explained < MIN_R_SQUARED).then(|| {
        let percent = 100.0 * explained.max(0.0);
        let text = format!("even without noise the estimator explains only {percent:.0} % of the variance of the normal displacements: its model does not match the simulated body, contact or readings");
        Warning::new("unexplained-readings", text, [("r_squared", explained)])
    })
}
