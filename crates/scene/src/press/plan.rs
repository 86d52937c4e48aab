//! Builds a [`PressScene`] from its config.

mod calibrated;
mod camera;
mod discs;
mod estimator;
mod straining;

use std::sync::OnceLock;

use palpate_press::{Body, Contact, Markers, PressError, Skin};
use palpate_statistics::Number;

use self::camera::CameraPlan;
use self::discs::DiscMarkers;
use self::estimator::EstimatorPlan;
use super::ladder::{Choice, PressRungs};
use super::parts::Parts;
use super::pressed::Pressed;
use super::readings::MarkerNoise;
use super::scene::{PressScene, PressSensor, TruePress};
use super::soft_body::SoftBody;
use super::words;
use palpate_estimators::{LAYOUT, MarkerSphere};
use palpate_study::FieldError;
use palpate_study::config::{CameraConfig, PressConfig, PressEstimatorConfig, PressSensorConfig};

/// Error of displacements from a layer's tables, relative to the largest displacement.
const OF_TABLES: f64 = 1e-7;
/// Number of markers for which a direct solution costs as much as a layer's table.
const MANY_MARKERS: usize = 1000;

impl PressScene {
    /// Builds the scene of a config. `seed` seeds its random numbers; other scenes may share `parts`.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the field that makes no scene.
    pub fn new(config: &PressConfig, seed: u64, parts: &Parts) -> Result<Self, FieldError> {
        let sphere = MarkerSphere::of(&config.probe);
        let (markers, places) = markers(&sphere)?;
        let pressed = Pressed::of(&config.object, &config.motion, sphere.radius)?;
        let look = Look::of(&config.sensor);
        let rungs = PressRungs::of(&config.model, &sphere, look.camera.is_some())?;
        let choice = rungs.choice(&markers, &pressed)?;
        let shared = tables(config, &choice, places.len());
        let layer = |thickness, depth| match shared {
            Some(_) => parts.layer(thickness, depth),
            None => Body::solved_layer(thickness, depth),
        };
        let body = SoftBody::of(&choice.model, sphere.radius, sphere.marker_depth, layer)?;
        let noise = MarkerNoise::of(&config.noise, look.frames, places.len())?;
        let contact = body.contact(&markers, &pressed).and_then(|contact| {
            let place = markers.skin().place(pressed.at);
            markers.see(&place, contact.radius).map(|()| contact)
        });
        let truth = true_press(&body, &markers, &pressed, &contact);
        let sensor = match look.camera {
            None => PressSensor::Direct,
            Some(camera) => PressSensor::Camera(match &truth {
                Ok(_) => CameraPlan {
                    sphere: &sphere,
                    camera,
                    is_rendered: look.is_rendered,
                    noise: &config.noise,
                    model: &choice.model,
                    seed,
                    places: &places,
                    discs: DiscMarkers::of(&sphere, &choice.model, &markers, &body, parts)?,
                    parts,
                }
                .press(&pressed)?
                .map(Box::new),
                // If the contact failed there is nothing to image: keep the contact's error.
                Err(error) => Err(*error),
            }),
        };
        let estimator = EstimatorPlan {
            estimator: &config.estimator,
            model: &config.model,
            sphere: &sphere,
            body: &body,
            shared,
            markers: &markers,
            pressed: &pressed,
            noise: &noise,
            sensed: sensed_stds(&sensor),
            sensor: &sensor,
            of_sensor: config.noise.sensor.as_ref(),
            rest_frames: look
                .camera
                .map_or(1, |camera| camera.calibration.rest_frames),
            parts,
        };
        // With a camera, the errors of the readings are not known at this point.
        let bounds = contact
            .as_ref()
            .ok()
            .filter(|_| matches!(sensor, PressSensor::Direct))
            .and_then(|contact| estimator.bounds(contact, look.tangential));
        let method = estimator.method()?;
        let resolved = &PressConfig {
            model: choice.model.clone(),
            ..config.clone()
        };
        let needs = [
            words::of_model(&choice, &pressed, markers.skin(), &contact),
            words::of_readings(&noise, &sensor, look.tangential, places.len(), resolved),
            words::of_estimator(resolved, &method),
        ];
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
            needs: needs.concat(),
            exact: OnceLock::new(),
            markers,
            body,
        })
    }
}

/// Settings of the readings of a press.
struct Look<'a> {
    /// The camera; `None` if the markers are read directly.
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
fn markers(sphere: &MarkerSphere<'_>) -> Result<(Markers, Vec<[f64; 2]>), FieldError> {
    let (radius, depth) = (sphere.radius, sphere.marker_depth);
    let skin = Skin::new(radius).map_err(|error| FieldError::at("scene.probe.radius", error))?;
    if depth >= radius {
        let message = format!(
            "must be less than the sensor's radius {}, is {}",
            Number(radius),
            Number(depth)
        );
        return Err(FieldError::at("scene.probe.marker_depth", message));
    }
    let places = sphere.places()?;
    let markers = Markers::new(skin, &places).map_err(|error| FieldError::at(LAYOUT, error))?;
    Ok((markers, places))
}

/// Thickness of the layer, if its tables compute the true displacements: the fit shares them or there are many
/// markers, and they are accurate enough for `auto`.
fn tables(config: &PressConfig, choice: &Choice, markers: usize) -> Option<f64> {
    let of_model = config.model.thickness();
    let is_shared = matches!(config.estimator, PressEstimatorConfig::BondedLayer { .. })
        && config.estimator.layer(of_model) == of_model;
    let is_good = choice
        .tolerance
        .is_none_or(|tolerance| tolerance >= OF_TABLES);
    let layer = choice.model.thickness();
    layer.filter(|_| is_good && (is_shared || markers > MANY_MARKERS))
}

/// The true contact, and the true displacements of the markers.
fn true_press(
    body: &SoftBody,
    markers: &Markers,
    pressed: &Pressed,
    contact: &Result<Contact<'_>, PressError>,
) -> Result<TruePress, PressError> {
    let contact = contact.as_ref().map_err(|error| *error)?;
    Ok(TruePress {
        contact_radius: contact.radius,
        markers: body.moved(markers, pressed, contact)?,
    })
}

/// Standard deviations of a camera's normal and tangential displacements, from its calibration.
fn sensed_stds(sensor: &PressSensor) -> [Option<f64>; 2] {
    match sensor {
        PressSensor::Camera(Ok(camera)) => camera.sensor.stds,
        PressSensor::Camera(Err(_)) | PressSensor::Direct => [None; 2],
    }
}
