//! Plan of a press: from its config to a [`PressScene`].

mod calibrated;
mod camera;
mod discs;

use palpate_press::{
    Body, Bounds, Contact, ForwardFit, Markers, PressError, Prior, Skin, calibrated_c,
};
use palpate_sensing::GaussianError;

use self::camera::CameraPlan;
use self::discs::DiscMarkers;
use super::ladder::{Choice, PressRungs};
use super::noise::PressNoise;
use super::pressed::Pressed;
use super::scene::{PressMethod, PressScene, PressSensor, TruePress};
use super::soft_body::{SoftBody, of_body, within_sensor};
use super::words;
use crate::marker_sphere::{LAYOUT, MarkerSphere};
use crate::plan::PlanError;
use palpate_study::config::{
    Baseline, CameraConfig, Indentation, NoiseKnown, PressConfig, PressEstimatorConfig,
    PressSensorConfig,
};

/// Error of displacements by a layer's tables, relative to the largest.
const OF_TABLES: f64 = 1e-7;
/// A layer's table costs as much as a solution that is read at so many markers.
const MANY_MARKERS: usize = 1000;

impl PressScene {
    /// The scene that a config describes, with the random numbers of `seed`.
    ///
    /// # Errors
    /// [`PlanError`] with the path of the field that makes no scene.
    pub fn new(config: &PressConfig, seed: u64) -> Result<Self, PlanError> {
        let sphere = MarkerSphere::of(&config.probe);
        let (markers, places) = markers(&sphere)?;
        let pressed = Pressed::of(&config.object, &config.motion, sphere.radius)?;
        let look = Look::of(&config.sensor);
        let rungs = PressRungs::of(&config.model, &sphere, look.camera.is_some())?;
        let choice = rungs.choice(&markers, &pressed)?;
        let shared = tables(config, &choice, places.len());
        let layer = match shared {
            Some(_) => Body::bonded_layer,
            None => Body::solved_layer,
        };
        let body = SoftBody::of(&choice.model, sphere.radius, sphere.marker_depth, layer)?;
        let noise = PressNoise::of(&config.noise, look.frames, places.len())?;
        let contact = body.contact(&markers, &pressed);
        let truth = contact
            .as_ref()
            .map_err(|error| *error)
            .and_then(|contact| {
                Ok(TruePress {
                    contact_radius: contact.radius,
                    markers: body.moved(&markers, &pressed, contact)?,
                })
            });
        let sensor = match look.camera {
            None => PressSensor::Direct,
            Some(camera) => PressSensor::Camera(match &truth {
                Ok(_) => CameraPlan {
                    sphere: &sphere,
                    camera,
                    is_rendered: look.is_rendered,
                    noise: &config.noise,
                    seed,
                    places: &places,
                    discs: DiscMarkers::of(&sphere, &choice.model, &markers, &body)?,
                }
                .press(&pressed)?
                .map(Box::new),
                // If the contact failed there is nothing to image: keep the contact's error.
                Err(error) => Err(*error),
            }),
        };
        let method = Planned {
            config,
            body: &body.body,
            shared,
            markers: &markers,
            noise: &noise,
            sensed: sensed_stds(&sensor),
        };
        // The errors of a camera are not known beforehand.
        let bounds = contact
            .as_ref()
            .ok()
            .filter(|_| matches!(sensor, PressSensor::Direct))
            .and_then(|contact| method.bounds(contact, pressed.at, look.tangential));
        let method = method.method(sphere.radius, sphere.marker_depth)?;
        let resolved = &PressConfig {
            model: choice.model.clone(),
            ..config.clone()
        };
        let mut needs = words::of_model(&choice, &pressed.object, markers.skin(), &contact);
        needs.extend(words::of_readings(
            &noise,
            &sensor,
            look.tangential,
            places.len(),
            resolved,
        ));
        needs.extend(words::of_estimator(resolved, &method));
        Ok(Self {
            seed,
            truth,
            places,
            pressed,
            sensor,
            tangential: look.tangential,
            noise,
            method,
            bounds,
            rungs,
            needs,
            markers,
            body,
        })
    }
}

/// What a sensor reads of a press.
struct Look<'a> {
    /// Camera before the markers; `None` where these are read directly.
    camera: Option<&'a CameraConfig>,
    /// Whether the camera renders frames.
    is_rendered: bool,
    /// Whether displacements along the skin are read.
    tangential: bool,
    /// Number of readings that are averaged.
    frames: u32,
}

impl<'a> Look<'a> {
    fn of(config: &'a PressSensorConfig) -> Self {
        let by = |camera: &'a CameraConfig, is_rendered: bool| Self {
            camera: Some(camera),
            is_rendered,
            tangential: camera.tangential,
            frames: camera.frames,
        };
        match config {
            PressSensorConfig::Direct { tangential, frames } => Self {
                camera: None,
                is_rendered: false,
                tangential: *tangential,
                frames: *frames,
            },
            PressSensorConfig::Projected(camera) => by(camera, false),
            PressSensorConfig::Rendered(camera) => by(camera, true),
        }
    }
}

/// The markers of a sensor, and their chart coordinates.
fn markers(sphere: &MarkerSphere<'_>) -> Result<(Markers, Vec<[f64; 2]>), PlanError> {
    let (radius, depth) = (sphere.radius, sphere.marker_depth);
    let skin = Skin::new(radius).map_err(|error| PlanError::at("scene.probe.radius", error))?;
    if depth >= radius {
        let message = format!("must be less than the sensor's radius {radius}, is {depth}");
        return Err(PlanError::at("scene.probe.marker_depth", message));
    }
    let places = sphere.places()?;
    let markers = Markers::new(skin, &places).map_err(|error| PlanError::at(LAYOUT, error))?;
    Ok((markers, places))
}

/// Thickness of the layer whose truth is read off tables: where the fit is of the same layer and shares them, or there are
/// many markers, unless more is asked than they hold.
fn tables(config: &PressConfig, choice: &Choice, markers: usize) -> Option<f64> {
    let of_model = config.model.thickness();
    let is_shared = match config.estimator {
        PressEstimatorConfig::BondedLayer { thickness, .. } => {
            thickness.is_none_or(|thickness| Some(thickness) == of_model)
        }
        PressEstimatorConfig::HalfSpace { .. } | PressEstimatorConfig::Gaussian { .. } => false,
    };
    let is_good = choice
        .tolerance
        .is_none_or(|tolerance| tolerance >= OF_TABLES);
    let layer = choice.model.thickness();
    layer.filter(|_| is_good && (is_shared || markers > MANY_MARKERS))
}

/// Standard deviations of a camera's normal and tangential displacements, as its calibration tells them.
fn sensed_stds(sensor: &PressSensor) -> [Option<f64>; 2] {
    match sensor {
        PressSensor::Camera(Ok(camera)) => camera.sensor.stds,
        PressSensor::Camera(Err(_)) | PressSensor::Direct => [None; 2],
    }
}

/// Parts that an estimator is made of.
struct Planned<'a> {
    config: &'a PressConfig,
    body: &'a Body,
    /// Thickness of its layer, where that has tables for fits to share.
    shared: Option<f64>,
    markers: &'a Markers,
    noise: &'a PressNoise,
    /// Standard deviations that a camera adds to the noise: normal, tangential.
    sensed: [Option<f64>; 2],
}

/// Settings that all estimators have.
struct Nuisances {
    known_indentation: Option<f64>,
    baseline: Prior,
    /// Prior of the factor on all displacements; `None` for the Gaussian, where the amplitude takes its place.
    gain: Option<Prior>,
    noise: NoiseKnown,
}

impl Nuisances {
    fn of(config: &PressEstimatorConfig) -> Self {
        let (indentation, indentation_std, baseline, gain_std, noise) = match *config {
            PressEstimatorConfig::HalfSpace {
                indentation,
                indentation_std,
                baseline,
                gain_std,
                noise,
                ..
            }
            | PressEstimatorConfig::BondedLayer {
                indentation,
                indentation_std,
                baseline,
                gain_std,
                noise,
                ..
            } => (
                indentation,
                indentation_std,
                baseline,
                Some(gain_std),
                noise,
            ),
            PressEstimatorConfig::Gaussian {
                indentation,
                indentation_std,
                baseline,
                noise,
                ..
            } => (indentation, indentation_std, baseline, None, noise),
        };
        Self {
            known_indentation: match indentation {
                Indentation::Known => Some(indentation_std),
                Indentation::Fitted => None,
            },
            baseline: match baseline {
                Baseline::Known => Prior::Exact,
                Baseline::Fitted => Prior::Free,
            },
            gain: gain_std.map(within),
            noise,
        }
    }
}

fn within(std: f64) -> Prior {
    if std > 0.0 {
        Prior::Within(std)
    } else {
        Prior::Exact
    }
}

impl Planned<'_> {
    fn method(&self, radius: f64, marker_depth: f64) -> Result<PressMethod, PlanError> {
        let nuisances = Nuisances::of(&self.config.estimator);
        let stated = |error: GaussianError, sensed: Option<f64>| {
            let std = libm::hypot(error.std(), sensed.unwrap_or(0.0));
            Some(std).filter(|&std| nuisances.noise == NoiseKnown::Stated && std > 0.0)
        };
        let fit = self
            .assumed_body(radius, marker_depth)?
            .map(|body| ForwardFit {
                // The amplitude of a Gaussian is fitted, unless it is the indentation.
                gain: nuisances.gain.unwrap_or(match nuisances.known_indentation {
                    Some(_) => Prior::Free,
                    None => Prior::Exact,
                }),
                baseline: nuisances.baseline,
                normal_std: stated(self.noise.normal, self.sensed[0]),
                tangential_std: stated(self.noise.tangential, self.sensed[1]),
                window: match self.config.estimator {
                    PressEstimatorConfig::Gaussian { window, .. } => window,
                    _ => None,
                },
                ..ForwardFit::new(body)
            });
        Ok(PressMethod {
            fit,
            known_indentation: nuisances.known_indentation,
        })
    }

    /// The body that the estimator assumes; the inner error where a Gaussian cannot be calibrated.
    fn assumed_body(
        &self,
        radius: f64,
        marker_depth: f64,
    ) -> Result<Result<Body, PressError>, PlanError> {
        let model = &self.config.model;
        match self.config.estimator {
            PressEstimatorConfig::HalfSpace { poisson, .. } => {
                Body::half_space(poisson.unwrap_or(model.poisson()), marker_depth)
            }
            PressEstimatorConfig::BondedLayer { thickness, .. } => {
                let of_model = model.thickness();
                let Some(thickness) = thickness.or(of_model) else {
                    let message = "`thickness` is missing";
                    return Err(PlanError::at("scene.estimator", message));
                };
                within_sensor("scene.estimator.thickness", thickness, radius)?;
                if self.shared == Some(thickness) {
                    Ok(self.body.clone())
                } else {
                    Body::bonded_layer(thickness, marker_depth)
                }
            }
            PressEstimatorConfig::Gaussian { c: Some(c), .. } => Body::gaussian(c),
            PressEstimatorConfig::Gaussian { window, .. } => {
                let indentation = self.config.motion.indentation;
                return Ok(calibrated_c(self.markers, self.body, indentation, window)
                    .and_then(Body::gaussian));
            }
        }
        .map(Ok)
        .map_err(|error| of_body("scene.estimator", error))
    }

    /// The bounds on what the readings can tell by the model's own body.
    fn bounds(&self, contact: &Contact<'_>, at: [f64; 2], tangential: bool) -> Option<Bounds> {
        let nuisances = Nuisances::of(&self.config.estimator);
        let drawn = |error: GaussianError| error.is_random().then(|| error.std());
        let fit = ForwardFit {
            baseline: nuisances.baseline,
            gain: drawn(self.noise.gain).map_or(nuisances.gain?, within),
            normal_std: drawn(self.noise.normal),
            tangential_std: drawn(self.noise.tangential),
            ..ForwardFit::new(self.body.clone())
        };
        let indentation_std = nuisances
            .known_indentation
            .map(|told| drawn(self.noise.indentation).unwrap_or(told));
        fit.bounds(self.markers, contact, at, tangential, indentation_std)
    }
}
