//! Plan of a press: from its config to a [`PressScene`].

mod calibrated;
mod camera;

pub(super) use camera::AT_REST;
pub(crate) use camera::{disc_depths, discs, of_optics};

use palpate_chromatouch::{Layout, LayoutError};
use palpate_number::{BadSetting, Number};
use palpate_press::{Body, Bounds, Contact, ForwardFit, Markers, PressError, Skin};
use palpate_sensing::{GaussianError, InvalidSensor};

use super::ladder;
use super::method::{self, Assumed};
use super::noise::ReadingNoise;
use super::words;
use super::{PressMethod, PressScene, PressSensor, PressedObject, TruePress};
use crate::plan::PlanError;
pub(super) use camera::{Pressed, shifted};
use palpate_study::config::{
    GainNoise, Indentation, LayoutConfig, LayoutTable, LengthNoise, NamedLayout, NoiseKnown,
    PressConfig, PressEstimatorConfig, PressModelConfig, PressNoiseConfig, PressObjectConfig,
    PressProbeConfig, PressSensorConfig,
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
        let PressProbeConfig::MarkerSphere {
            radius,
            marker_depth,
            layout,
            ..
        } = &config.probe;
        let skin =
            Skin::new(*radius).map_err(|error| PlanError::at("scene.probe.radius", error))?;
        below_radius("scene.probe.marker_depth", *marker_depth, *radius)?;
        let layout_path = "scene.probe.layout";
        let places = layout_of(layout)
            .places(*radius)
            .map_err(|error| of_layout(layout_path, &error))?;
        let markers =
            Markers::new(skin, &places).map_err(|error| PlanError::at(layout_path, error))?;
        let object = object(&config.object);
        let at = contact_place(config.motion.contact_deg, *radius)?;
        let pressed = Pressed {
            object_curvature: object.curvature,
            indentation: config.motion.indentation,
            at,
            shift: config.motion.shift,
        };
        let asked = config;
        let choice = ladder::choice(config, &markers, &pressed)?;
        let config = &PressConfig {
            model: choice.model.clone(),
            ..config.clone()
        };
        let has_tables = takes_tables(asked, choice.tolerance, places.len());
        let layer = match has_tables {
            true => Body::bonded_layer,
            false => Body::solved_layer,
        };
        let body = body_of(&config.model, *radius, *marker_depth, layer)?;
        let (tangential, frames) = match &config.sensor {
            PressSensorConfig::Direct { tangential, frames } => (*tangential, *frames),
            PressSensorConfig::Projected(camera) | PressSensorConfig::Rendered(camera) => {
                (camera.tangential, camera.frames)
            }
        };
        let noise = noise(&config.noise, frames, places.len())?;
        let contact = skin.contact(&body, object.curvature, config.motion.indentation);
        let truth = contact
            .as_ref()
            .map_err(|error| *error)
            .and_then(|contact| true_press(config, &markers, contact, &pressed));
        let sensor = match &config.sensor {
            PressSensorConfig::Direct { .. } => PressSensor::Direct,
            PressSensorConfig::Projected(camera) | PressSensorConfig::Rendered(camera) => {
                let planned = camera::Planned {
                    config,
                    camera,
                    seed,
                    places: &places,
                    markers: &markers,
                    body: &body,
                };
                // If the contact failed there is nothing to image: keep the contact's error.
                let seen = match &truth {
                    Ok(_) => planned.press(&pressed)?,
                    Err(error) => Err(*error),
                };
                PressSensor::Camera(seen.map(Box::new))
            }
        };
        let method = Planned {
            config: asked,
            body: &body,
            shared: has_tables.then(|| config.model.thickness()).flatten(),
            markers: &markers,
            noise: &noise,
            sensed: sensed_stds(&sensor),
        };
        // The errors of a camera are not known beforehand.
        let bounds = contact
            .as_ref()
            .ok()
            .filter(|_| matches!(sensor, PressSensor::Direct))
            .and_then(|contact| method.bounds(contact, at, tangential));
        let method = method.method(*radius, *marker_depth)?;
        let mut needs = words::of_model(&config.model, &object, &skin, &contact);
        if let Some(first) = needs.first_mut().filter(|_| choice.tolerance.is_some()) {
            *first += &format!(" ({})", choice.reason);
        }
        let is_seen = matches!(&sensor, PressSensor::Camera(Ok(seen)) if seen.is_random());
        needs.extend(
            noise
                .need()
                .or_else(|| (!is_seen).then(|| "no noise: no random numbers are drawn".to_owned())),
        );
        needs.extend(words::of_sensor(places.len(), &sensor, tangential, config));
        let is_direct = matches!(sensor, PressSensor::Direct);
        if is_direct && tangential && noise.normal.is_random() && !noise.tangential.is_random() {
            needs.push(words::EXACT_TANGENTIAL.to_owned());
        }
        needs.extend(words::of_estimator(config, &method));
        Ok(Self {
            seed,
            truth,
            places,
            at,
            object,
            indentation: config.motion.indentation,
            sensor,
            tangential,
            noise,
            method,
            bounds,
            needs,
            markers,
            body,
        })
    }
}

/// Truth of a press: the contact and the displacements of the markers.
fn true_press(
    config: &PressConfig,
    markers: &Markers,
    contact: &Contact<'_>,
    pressed: &Pressed,
) -> Result<TruePress, PressError> {
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    let mut moved = markers.displacements(contact, pressed.at);
    let radius = contact.radius;
    camera::shifted(
        &config.model,
        markers,
        marker_depth,
        radius,
        pressed,
        &mut moved,
    )?;
    Ok(TruePress {
        contact_radius: radius,
        markers: moved,
    })
}

/// Standard deviations of a camera's normal and tangential displacements, as its calibration tells them.
fn sensed_stds(sensor: &PressSensor) -> [Option<f64>; 2] {
    match sensor {
        PressSensor::Camera(Ok(camera)) => camera.sensor.stds,
        PressSensor::Camera(Err(_)) | PressSensor::Direct => [None; 2],
    }
}

fn below_radius(path: &str, depth: f64, radius: f64) -> Result<(), PlanError> {
    if depth < radius {
        return Ok(());
    }
    let message = format!(
        "must be less than the sensor's radius {}, is {}",
        Number(radius),
        Number(depth)
    );
    Err(PlanError::at(path, message))
}

pub(crate) fn layout_of(config: &LayoutConfig) -> Layout {
    match config {
        LayoutConfig::Named(NamedLayout::Published) => Layout::published(),
        LayoutConfig::Table(LayoutTable::Gores {
            gores,
            rows,
            row_spacing_deg,
        }) => Layout::Gores {
            gores: *gores,
            rows: rows.clone(),
            row_spacing_deg: *row_spacing_deg,
        },
        LayoutConfig::Table(LayoutTable::Lattice { pitch, cap_deg }) => Layout::Lattice {
            pitch: *pitch,
            cap_deg: *cap_deg,
        },
        LayoutConfig::Table(LayoutTable::Line { markers, length }) => Layout::Line {
            markers: *markers,
            length: *length,
        },
        LayoutConfig::Table(LayoutTable::Radius { markers, length }) => Layout::Radius {
            markers: *markers,
            length: *length,
        },
    }
}

pub(crate) fn of_layout(path: &str, error: &LayoutError) -> PlanError {
    match error.setting() {
        Some(setting) => PlanError::at(format!("{path}.{setting}"), error),
        None => PlanError::at(path, error),
    }
}

fn object(config: &PressObjectConfig) -> PressedObject {
    let of_radius = |radius: f64| PressedObject {
        curvature: radius.recip(),
        radius: Some(radius),
    };
    match *config {
        PressObjectConfig::Sphere { radius } => of_radius(radius),
        PressObjectConfig::Dish { radius } => of_radius(-radius),
        PressObjectConfig::Plane {} => PressedObject {
            curvature: 0.0,
            radius: None,
        },
    }
}

/// Chart coordinates of a polar angle and an azimuth.
fn contact_place([polar, azimuth]: [f64; 2], radius: f64) -> Result<[f64; 2], PlanError> {
    if !(0.0..=180.0).contains(&polar) {
        let message = format!(
            "the polar angle must be from 0 to 180, is {}",
            Number(polar)
        );
        return Err(PlanError::at("scene.motion.contact_deg", message));
    }
    let distance = radius * polar.to_radians();
    let (sine, cosine) = libm::sincos(azimuth.to_radians());
    Ok([distance * cosine, distance * sine])
}

/// Body under the skin that moves the markers, by the model of the config.
fn body(config: &PressConfig, radius: f64, marker_depth: f64) -> Result<Body, PlanError> {
    body_of(&config.model, radius, marker_depth, Body::bonded_layer)
}

/// The body of a model, with a layer made by `layer`.
pub(super) fn body_of(
    model: &PressModelConfig,
    radius: f64,
    depth: f64,
    layer: fn(f64, f64) -> Result<Body, PressError>,
) -> Result<Body, PlanError> {
    if let Some(thickness) = model.thickness() {
        within_sensor("scene.model.thickness", thickness, radius)?;
    }
    method::body_of(model, depth, layer).map_err(|error| of_body("scene.model", error))
}

/// Whether the truth of a layer is read off tables: where the fit is of the same layer and shares them, or there are many
/// markers, unless more is asked than they hold.
fn takes_tables(config: &PressConfig, tolerance: Option<f64>, markers: usize) -> bool {
    let of_model = config.model.thickness();
    let is_shared = matches!(config.estimator, PressEstimatorConfig::BondedLayer { .. })
        && method::thickness(&config.estimator, &config.model) == of_model;
    let is_good = tolerance.is_none_or(|tolerance| tolerance >= OF_TABLES);
    is_good && (is_shared || markers > MANY_MARKERS)
}

fn within_sensor(path: &str, thickness: f64, radius: f64) -> Result<(), PlanError> {
    if thickness <= radius {
        return Ok(());
    }
    let message = format!(
        "must be at most the sensor's radius {}, is {}",
        Number(radius),
        Number(thickness)
    );
    Err(PlanError::at(path, message))
}

/// Error at the setting of a body that is out of its range.
fn of_body(table: &str, error: PressError) -> PlanError {
    match error {
        PressError::BadSetting(BadSetting {
            setting: "depth", ..
        }) => PlanError::at("scene.probe.marker_depth", error),
        PressError::BadSetting(BadSetting { setting, .. }) => {
            PlanError::at(format!("{table}.{setting}"), error)
        }
        _ => PlanError::at(table, error),
    }
}

fn noise(
    config: &PressNoiseConfig,
    frames: u32,
    markers: usize,
) -> Result<ReadingNoise, PlanError> {
    let error = |std: Option<f64>, key: &str| {
        GaussianError::new(std.unwrap_or(0.0))
            .map_err(|error: InvalidSensor| PlanError::at(format!("scene.noise.{key}.std"), error))
    };
    let length = |noise: &Option<LengthNoise>, key: &str| {
        let std = noise.as_ref().map(|LengthNoise::Gaussian { std }| *std);
        error(std, key)
    };
    let wrong = config.wrong_markers.as_ref();
    let count = wrong.map_or(0, |wrong| wrong.count as usize);
    if count > markers {
        let message = format!("must be at most the number of markers {markers}, is {count}");
        return Err(PlanError::at("scene.noise.wrong_markers.count", message));
    }
    let gain = config.gain.as_ref();
    Ok(ReadingNoise {
        normal: length(&config.normal_displacement, "normal_displacement")?.averaged(frames),
        tangential: length(&config.tangential_displacement, "tangential_displacement")?
            .averaged(frames),
        indentation: length(&config.indentation, "indentation")?,
        gain: error(gain.map(|GainNoise::Gaussian { std }| *std), "gain")?,
        wrong_markers: count,
        wrong: error(wrong.map(|wrong| wrong.std), "wrong_markers")?,
    })
}

/// Parts that an estimator is made of.
struct Planned<'a> {
    config: &'a PressConfig,
    body: &'a Body,
    /// Thickness of its layer, where that has tables for fits to share.
    shared: Option<f64>,
    markers: &'a Markers,
    noise: &'a ReadingNoise,
    /// Standard deviations that a camera adds to the noise: normal, tangential.
    sensed: [Option<f64>; 2],
}

impl Planned<'_> {
    fn method(&self, radius: f64, marker_depth: f64) -> Result<PressMethod, PlanError> {
        let (estimator, model) = (&self.config.estimator, &self.config.model);
        let priors = estimator.priors();
        let stated = |error: GaussianError, sensed: Option<f64>| {
            let std = libm::hypot(error.std(), sensed.unwrap_or(0.0));
            Some(std).filter(|&std| priors.noise == NoiseKnown::Stated && std > 0.0)
        };
        match method::thickness(estimator, model) {
            Some(thickness) => within_sensor("scene.estimator.thickness", thickness, radius)?,
            None if matches!(estimator, PressEstimatorConfig::BondedLayer { .. }) => {
                return Err(PlanError::at("scene.estimator", "`thickness` is missing"));
            }
            None => {}
        }
        let knows_indentation = priors.indentation == Indentation::Known;
        let assumed = Assumed {
            estimator,
            model,
            body: self.body,
            shared: self.shared,
            markers: self.markers,
            marker_depth,
            calibrated_at: Some(self.config.motion.indentation),
            knows_indentation,
            stds: [
                stated(self.noise.normal, self.sensed[0]),
                stated(self.noise.tangential, self.sensed[1]),
            ],
        };
        Ok(PressMethod {
            fit: assumed
                .fit()
                .map_err(|error| of_body("scene.estimator", error))?,
            known_indentation: knows_indentation.then_some(priors.indentation_std),
        })
    }

    /// The bounds on what the readings can tell by the model's own body.
    fn bounds(&self, contact: &Contact<'_>, at: [f64; 2], tangential: bool) -> Option<Bounds> {
        let priors = self.config.estimator.priors();
        let drawn = |error: GaussianError| error.is_random().then(|| error.std());
        let fit = ForwardFit {
            baseline: method::baseline(priors.baseline),
            gain: method::within(drawn(self.noise.gain).unwrap_or(priors.gain_std?)),
            normal_std: drawn(self.noise.normal),
            tangential_std: drawn(self.noise.tangential),
            ..ForwardFit::new(self.body.clone())
        };
        let indentation_std = (priors.indentation == Indentation::Known)
            .then(|| drawn(self.noise.indentation).unwrap_or(priors.indentation_std));
        fit.bounds(self.markers, contact, at, tangential, indentation_std)
    }
}
