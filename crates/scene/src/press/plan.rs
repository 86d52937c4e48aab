//! Builds a [`PressScene`] from its config: its model, its sensor and its estimator.

use std::sync::OnceLock;

use palpate_chromatouch::Departure;
use palpate_estimators::{
    ImageEstimator, ImageFitSetup, MarkerSphere, PressFitError, PressFitSetup, body_error,
    departure_stds, ideal_fit, within_sensor,
};
use palpate_press::{
    Body, Bounds, MarkerDisplacement, Markers, ObjectContact, ObjectPress, PressError,
};
use palpate_sensing::{GaussianError, MarkerNoise};
use palpate_study::FieldError;
use palpate_study::config::{
    CameraConfig, LengthUnit, ModelConfig, NoiseKnown, PressConfig, PressEstimatorConfig,
    PressModelConfig, PressSensorConfig,
};

use super::SharedModels;
use super::camera_calibration::RestFrames;
use super::camera_model::{AT_REST, SimulatedCamera};
use super::reading::{CameraPressSensor, PressNoise, PressSensor};
use super::trial::{PressCase, PressEstimator, PressScene, given_indentation_std};
use super::truth::{DiscMarkers, TruePress, object_press, soft_body};
use crate::ladder::{Accuracy, Ladder, Rung};

/// Error of displacements that are interpolated in the tables of a layer, compared with a direct solution. It is
/// relative to the largest displacement.
const TABLE_ERROR: f64 = 1e-7;
/// With more markers than this number, it is faster to compute the tables of a layer and to interpolate the
/// displacements than to solve for each marker.
const MANY_MARKERS: usize = 1000;

impl PressScene {
    /// Builds the scene of a config. `seed` is the seed of its random numbers. Several scenes may share `models`.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn new(
        config: &PressConfig,
        unit: LengthUnit,
        seed: u64,
        models: &SharedModels,
    ) -> Result<Self, FieldError> {
        let young = young(&config.model, unit)?;
        let sphere = MarkerSphere::from(&config.probe);
        let (markers, places) = sphere.markers()?;
        let geometry = object_press(config, sphere.radius)?;
        let camera = config.sensor.camera();
        let rungs = PressRungs::new(&config.model, &sphere, camera.is_some())?;
        let choice = rungs.choice(&markers, &geometry)?;
        let tables = layer_with_tables(config, &choice, places.len());
        let layer = |thickness, depth| match tables {
            Some(_) => models.layer(thickness, depth),
            None => Body::solved_layer(thickness, depth),
        };
        let body = soft_body(&choice.model, sphere.radius, sphere.marker_depth, layer)?;
        let (has_tangential, frames) = match &config.sensor {
            PressSensorConfig::Direct { tangential, frames } => (*tangential, *frames),
            PressSensorConfig::Projected(camera) | PressSensorConfig::Rendered(camera) => {
                (camera.tangential, camera.frames)
            }
        };
        let noise = PressNoise::new(&config.noise, frames, places.len(), seed)?;
        let setup = PressSetup {
            config,
            model: &choice.model,
            sphere: &sphere,
            markers: &markers,
            places: &places,
            geometry: &geometry,
            body: &body,
            models,
            seed,
        };
        let contact = geometry.contact(&body, &markers).and_then(|contact| {
            let seen = markers.see(geometry.at, contact.radius());
            seen.map(|()| contact)
        });
        let case = match &contact {
            Ok(contact) => setup.case(contact, camera)?,
            Err(error) => PressCase::NoPress(*error),
        };
        // `noise` does not contain the errors of a camera. Therefore a press with a camera has no Cramér–Rao bound.
        let bounds = contact
            .ok()
            .filter(|_| camera.is_none())
            .and_then(|contact| setup.bounds(&noise, &contact, has_tangential));
        let estimator = setup.estimator(&noise, &case, tables)?;
        let fit = estimator.fit();
        Ok(Self {
            stated_stds: fit.map_or([None; 2], |fit| [fit.normal_std, fit.tangential_std]),
            config: config.clone(),
            choice,
            places,
            has_tangential,
            noise,
            case,
            estimator,
            bounds,
            rungs,
            exact: OnceLock::new(),
            geometry,
            markers,
            body,
            young,
        })
    }
}

fn young(model: &PressModelConfig, unit: LengthUnit) -> Result<Option<f64>, FieldError> {
    let Some(modulus_kpa) = model.modulus_kpa() else {
        return Ok(None);
    };
    let message = "a force needs a unit of lengths: set `length_unit`, or leave out the modulus";
    let refuse = || FieldError::at("scene.model.modulus_kpa", message);
    let metres = unit.to(LengthUnit::M).ok_or_else(refuse)?;
    Ok(Some(modulus_kpa * 1e3 * metres * metres))
}

/// Thickness of the layer if the true displacements are interpolated in tables of this layer; `None` if they are
/// computed without tables. The error of the tables must be within the tolerance of `auto`. In addition, the fit must
/// need the same tables anyway, or there must be many markers.
fn layer_with_tables(config: &PressConfig, choice: &Choice, markers: usize) -> Option<f64> {
    let thickness = config.model.thickness();
    let is_shared = matches!(config.estimator, PressEstimatorConfig::BondedLayer { .. })
        && config.estimator.layer(thickness) == thickness;
    let is_accurate = choice
        .tolerance
        .is_none_or(|tolerance| tolerance >= TABLE_ERROR);
    let layer = choice.model.thickness();
    layer.filter(|_| is_accurate && (is_shared || markers > MANY_MARKERS))
}

pub(super) struct PressSetup<'a> {
    pub(super) config: &'a PressConfig,
    pub(super) model: &'a PressModelConfig,
    pub(super) sphere: &'a MarkerSphere<'a>,
    pub(super) markers: &'a Markers,
    pub(super) places: &'a [[f64; 2]],
    pub(super) geometry: &'a ObjectPress,
    pub(super) body: &'a Body,
    pub(super) models: &'a SharedModels,
    pub(super) seed: u64,
}

impl PressSetup<'_> {
    fn case(
        &self,
        contact: &ObjectContact<'_>,
        camera: Option<(&CameraConfig, bool)>,
    ) -> Result<PressCase, FieldError> {
        let discs = camera.map(|camera| Ok((camera, DiscMarkers::new(self)?)));
        let discs = discs.transpose()?;
        let only_discs = discs.as_ref().map(|(_, discs)| discs);
        let truth = TruePress::new(self, contact, only_discs);
        let truth = match truth {
            Ok(truth) => truth,
            Err(error) => return Ok(PressCase::NoPress(error)),
        };
        let sensor = match &discs {
            None => PressSensor::Direct,
            Some((camera, discs)) => {
                let sensor = CameraPressSensor::new(self, *camera, discs, &truth)?;
                PressSensor::Camera(Box::new(sensor))
            }
        };
        Ok(PressCase::Press { truth, sensor })
    }

    /// Builds the estimator that the config states. `tables` is the thickness of the layer whose tables the fits can
    /// use; `None` if there are no tables.
    fn estimator(
        &self,
        noise: &PressNoise,
        case: &PressCase,
        tables: Option<f64>,
    ) -> Result<PressEstimator, FieldError> {
        let PressConfig {
            estimator, model, ..
        } = self.config;
        match estimator.layer(model.thickness()) {
            Some(thickness) => {
                within_sensor("scene.estimator.thickness", thickness, self.sphere.radius)?;
            }
            None if matches!(estimator, PressEstimatorConfig::BondedLayer { .. }) => {
                return Err(FieldError::at("scene.estimator", "`thickness` is missing"));
            }
            None => {}
        }
        let camera = case.camera();
        let camera_stds = camera.map_or([None; 2], |camera| camera.calibration.stds);
        let is_stated = estimator.priors().noise == NoiseKnown::Stated;
        let stated = |error: GaussianError, camera_std: Option<f64>| {
            let std = libm::hypot(error.std(), camera_std.unwrap_or(0.0));
            Some(std).filter(|&std| is_stated && std > 0.0)
        };
        let setup = PressFitSetup {
            estimator,
            model,
            body: self.body,
            shared: tables,
            layer: &|thickness, depth| self.models.layer(thickness, depth),
            markers: self.markers,
            marker_depth: self.sphere.marker_depth,
            calibrated_at: Some(self.geometry.indentation),
            knows_indentation: given_indentation_std(estimator).is_some(),
            stds: [
                stated(noise.markers.normal, camera_stds[0]),
                stated(noise.markers.tangential, camera_stds[1]),
            ],
        };
        let fit = setup.fit();
        if let Err(PressFitError::Setting(error)) = fit {
            return Err(body_error("scene.estimator", error));
        }
        let images = match (camera, self.config.sensor.camera()) {
            (Some(sensor), Some((config, _))) => {
                let frames = RestFrames::new(&sensor.camera, config.calibration.rest_frames);
                self.image_estimator(&sensor.camera, &frames)?
            }
            _ => None,
        };
        Ok(match fit {
            Ok(fit) => PressEstimator::Fit(fit, images),
            Err(error) => PressEstimator::NoFit(error.into()),
        })
    }

    fn image_estimator(
        &self,
        camera: &SimulatedCamera,
        frames: &RestFrames,
    ) -> Result<Option<ImageEstimator>, FieldError> {
        let noise = self.config.noise.sensor.as_ref();
        let setup = ImageFitSetup {
            estimator: &self.config.estimator,
            model: &self.config.model,
            sphere: self.sphere,
            markers: self.markers,
            optics: &camera.optics,
            stds: noise.map_or([0.0; Departure::NUMBERS], departure_stds),
            departure_prior: None,
            layers: &|thickness, depths| self.models.layers(thickness, depths),
        };
        let Some(fit) = setup.fit()? else {
            return Ok(None);
        };
        let rest = frames
            .measurements(AT_REST)
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        let rest = rest.iter().map(|one| Some(one.as_ref()?.image()));
        Ok(Some(ImageEstimator::new(fit, rest.collect())))
    }

    /// Cramér–Rao bounds of a fit that assumes the true body. `None` for a fit that cannot describe the true press.
    /// Such fits are a Gaussian, and a fit of one curvature to an object with two curvatures.
    fn bounds(
        &self,
        noise: &PressNoise,
        contact: &ObjectContact<'_>,
        has_tangential: bool,
    ) -> Option<Bounds> {
        let estimator = &self.config.estimator;
        let drawn = |error: GaussianError| error.is_random().then(|| error.std());
        let MarkerNoise {
            normal,
            tangential,
            gain,
            ..
        } = noise.markers;
        let stds = [normal, tangential].map(drawn);
        let fit = ideal_fit(estimator, self.body, drawn(gain), stds)?;
        let indentation_std =
            given_indentation_std(estimator).map(|std| drawn(noise.indentation).unwrap_or(std));
        let (markers, press) = (self.markers, self.geometry);
        fit.press_bounds(markers, press, contact, has_tangential, indentation_std)
    }
}

#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// The model in the form of a config; it is never `auto`.
    pub(super) model: PressModelConfig,
    pub(super) reason: String,
    pub(super) tolerance: Option<f64>,
}

/// Smallest tolerance that `auto` accepts: about the error of the most accurate model, which computes the displacements
/// of a layer without tables.
const SMALLEST_TOLERANCE: f64 = 1e-9;
const LARGEST_TOLERANCE: f64 = 1.0;

/// Models of the soft body that can compute a press, and the depths at which their displacements are compared.
#[derive(Clone, Debug)]
pub(super) struct PressRungs {
    requested: PressModelConfig,
    radius: f64,
    /// Depths at which the displacements of the models are compared. The first depth is midway between the two discs of
    /// a marker. With a camera, the depths of both discs follow.
    depths: Vec<f64>,
}

impl PressRungs {
    fn new(
        requested: &PressModelConfig,
        sphere: &MarkerSphere<'_>,
        has_camera: bool,
    ) -> Result<Self, FieldError> {
        let mut depths = vec![sphere.marker_depth];
        if has_camera {
            let discs = sphere.disc_depths()?;
            depths.extend([discs.magenta, discs.yellow]);
        }
        Ok(Self {
            requested: requested.clone(),
            radius: sphere.radius,
            depths,
        })
    }

    /// Model of the soft body that the config names or that `auto` chooses.
    fn choice(&self, markers: &Markers, geometry: &ObjectPress) -> Result<Choice, FieldError> {
        let PressModelConfig::Auto { tolerance, .. } = self.requested else {
            return Ok(Choice {
                model: self.requested.clone(),
                reason: "named in the config".to_owned(),
                tolerance: None,
            });
        };
        if !(SMALLEST_TOLERANCE..=LARGEST_TOLERANCE).contains(&tolerance) {
            let message = format!(
                "is {tolerance:e}; must be from {SMALLEST_TOLERANCE:e} to {LARGEST_TOLERANCE}"
            );
            return Err(FieldError::at("scene.model.tolerance", message));
        }
        let rungs = self.measure(markers, geometry)?;
        let reference = self.requested.reference();
        // Hertz contact and the half-space cost the same, so choose the more accurate of the two.
        let cheap = rungs.iter().filter_map(|(model, accuracy)| {
            let error = accuracy.error().filter(|&error| error <= tolerance)?;
            model.thickness().is_none().then_some((model, error))
        });
        let best = cheap.min_by(|(_, one), (_, other)| one.total_cmp(other));
        let (model, reason) = match best {
            Some((model, error)) if *model != reference => {
                let reason = format!(
                    "the cheapest model that meets {tolerance:.0e}; its error is {error:.1e} of the largest displacement"
                );
                (model.clone(), reason)
            }
            _ => {
                let cheaper = rungs.iter().rev().nth(1);
                let reason = match cheaper.and_then(|(_, accuracy)| accuracy.error()) {
                    Some(error) => {
                        let other = match reference.thickness() {
                            Some(_) => "the error of the next cheaper model",
                            None => "Hertz contact costs the same and its error",
                        };
                        format!("{other} is {error:.1e} of the largest displacement")
                    }
                    None => "no press can be simulated to measure the error of a cheaper model"
                        .to_owned(),
                };
                (reference, reason)
            }
        };
        Ok(Choice {
            model,
            reason,
            tolerance: Some(tolerance),
        })
    }

    /// Measures the errors of the models `rungs`, which are sorted from the fastest to the slowest. The error of a
    /// model is the largest difference between its displacements and those of the last model.
    fn measure(
        &self,
        markers: &Markers,
        geometry: &ObjectPress,
    ) -> Result<Vec<(PressModelConfig, Accuracy)>, FieldError> {
        let poisson = self.requested.poisson();
        let layer = self.requested.thickness();
        let modulus_kpa = self.requested.modulus_kpa();
        let layer = layer.map(|thickness| PressModelConfig::BondedLayer {
            thickness,
            modulus_kpa,
        });
        let models = [
            PressModelConfig::Hertz {
                poisson,
                modulus_kpa,
            },
            PressModelConfig::HalfSpace {
                poisson,
                modulus_kpa,
            },
        ];
        let models: Vec<PressModelConfig> = models.into_iter().chain(layer).collect();
        let bodies: Vec<Vec<Body>> = models
            .iter()
            .map(|model| self.bodies(model))
            .collect::<Result<_, _>>()?;
        let moved = bodies.iter().map(|bodies| {
            let moved = bodies
                .iter()
                .map(|body| geometry.displacements(body, markers));
            Ok(moved.collect::<Result<Vec<_>, PressError>>()?.concat())
        });
        let moved: Vec<Result<Vec<MarkerDisplacement>, PressError>> = moved.collect();
        let reference = moved.last().cloned().unwrap_or(Ok(Vec::new()));
        let accuracies = moved.iter().map(|moved| match (&reference, moved) {
            (Err(error), _) | (_, Err(error)) => Accuracy::Impossible(error.to_string()),
            (Ok(reference), Ok(moved)) => relative_error(moved, reference),
        });
        Ok(models.into_iter().zip(accuracies).collect())
    }

    pub(super) fn ladder(
        &self,
        markers: &Markers,
        geometry: &ObjectPress,
    ) -> Result<Ladder, FieldError> {
        let choice = self.choice(markers, geometry)?;
        let rungs = self.measure(markers, geometry)?.into_iter();
        let rungs: Vec<Rung> = rungs
            .map(|(model, accuracy)| Rung {
                name: name(&model),
                model: ModelConfig::Press(model),
                accuracy,
            })
            .collect();
        Ok(Ladder {
            reference: Some(rungs.len() - 1),
            ..Ladder::new(
                rungs,
                &ModelConfig::Press(choice.model),
                choice.reason,
                choice.tolerance,
            )
        })
    }

    fn bodies(&self, model: &PressModelConfig) -> Result<Vec<Body>, FieldError> {
        let body = |&depth| soft_body(model, self.radius, depth, Body::solved_layer);
        self.depths.iter().map(body).collect()
    }
}

fn relative_error(moved: &[MarkerDisplacement], reference: &[MarkerDisplacement]) -> Accuracy {
    let size = |normal: f64, [x, y]: [f64; 2]| libm::hypot(libm::hypot(normal, x), y);
    let differences = moved.iter().zip(reference).map(|(one, other)| {
        let tangential = [0, 1].map(|axis| one.tangential[axis] - other.tangential[axis]);
        size(one.normal - other.normal, tangential)
    });
    let sizes = reference.iter().map(|one| size(one.normal, one.tangential));
    let (difference, size) = (differences.fold(0.0, f64::max), sizes.fold(0.0, f64::max));
    let error = if difference > 0.0 {
        difference / size
    } else {
        0.0
    };
    match error.is_finite() {
        true => Accuracy::Error(error),
        false => {
            let reason = "no marker moves, so a relative error is undefined";
            Accuracy::Impossible(reason.to_owned())
        }
    }
}

fn name(model: &PressModelConfig) -> String {
    match model {
        PressModelConfig::Auto { tolerance, .. } => format!("auto, tolerance {tolerance:e}"),
        PressModelConfig::Hertz { .. } => "Hertz contact, at the surface".to_owned(),
        PressModelConfig::HalfSpace { .. } => "half-space, at the markers' depth".to_owned(),
        PressModelConfig::BondedLayer { .. } => "bonded layer, solved".to_owned(),
    }
}
