//! Builds the estimator of a press.

use palpate_chromatouch::Departure;
use palpate_estimators::{
    ImageEstimator, ImageFitSetup, MarkerSphere, PressFitError, PressFitSetup, baseline,
    body_error, departure_stds, within, within_sensor,
};
use palpate_press::{Bounds, Contact, ForwardFit, Markers};
use palpate_sensing::GaussianError;
use palpate_study::FieldError;
use palpate_study::config::{
    Indentation, NoiseKnown, PressEstimatorConfig, PressModelConfig, SensorNoise,
};

use super::super::camera::AT_REST;
use super::super::looks::RestLook;
use super::super::parts::Parts;
use super::super::pressed::Pressed;
use super::super::readings::MarkerNoise;
use super::super::scene::{PressMethod, PressSensor};
use super::super::soft_body::SoftBody;

/// Settings of an estimator, with the press and the sensor whose readings it uses.
pub(super) struct EstimatorPlan<'a> {
    pub(super) estimator: &'a PressEstimatorConfig,
    /// Model of the config, which may be `auto`.
    pub(super) model: &'a PressModelConfig,
    pub(super) sphere: &'a MarkerSphere<'a>,
    pub(super) body: &'a SoftBody,
    /// Thickness of the body's layer, if fits can share its tables.
    pub(super) shared: Option<f64>,
    pub(super) markers: &'a Markers,
    pub(super) pressed: &'a Pressed,
    pub(super) noise: &'a MarkerNoise,
    /// Standard deviations that a camera adds to the noise: normal, tangential.
    pub(super) sensed: [Option<f64>; 2],
    pub(super) parts: &'a Parts,
    pub(super) sensor: &'a PressSensor,
    /// Uncertainty of the sensor's parameters.
    pub(super) of_sensor: Option<&'a SensorNoise>,
    /// Number of frames at rest that are averaged.
    pub(super) rest_frames: u32,
}

impl EstimatorPlan<'_> {
    /// Builds the method from the settings and the sensor's parameters.
    pub(super) fn method(&self) -> Result<PressMethod, FieldError> {
        let Self {
            estimator, model, ..
        } = *self;
        let priors = estimator.priors();
        let stated = |error: GaussianError, sensed: Option<f64>| {
            let std = libm::hypot(error.std(), sensed.unwrap_or(0.0));
            Some(std).filter(|&std| priors.noise == NoiseKnown::Stated && std > 0.0)
        };
        match estimator.layer(model.thickness()) {
            Some(thickness) => {
                within_sensor("scene.estimator.thickness", thickness, self.sphere.radius)?;
            }
            None if matches!(estimator, PressEstimatorConfig::BondedLayer { .. }) => {
                return Err(FieldError::at("scene.estimator", "`thickness` is missing"));
            }
            None => {}
        }
        let knows_indentation = priors.indentation == Indentation::Known;
        let assumed = PressFitSetup {
            estimator,
            model,
            body: &self.body.body,
            shared: self.shared,
            layer: &|thickness, depth| self.parts.layer(thickness, depth),
            markers: self.markers,
            marker_depth: self.sphere.marker_depth,
            calibrated_at: Some(self.pressed.indentation),
            knows_indentation,
            stds: [
                stated(self.noise.normal, self.sensed[0]),
                stated(self.noise.tangential, self.sensed[1]),
            ],
        };
        Ok(PressMethod {
            fit: match assumed.fit() {
                Ok(fit) => Ok(fit),
                Err(PressFitError::Calibration(error)) => Err(error),
                Err(PressFitError::Setting(error)) => {
                    return Err(body_error("scene.estimator", error));
                }
            },
            known_indentation: knows_indentation.then_some(priors.indentation_std),
            of_pictures: self.of_pictures()?,
        })
    }

    /// The fit of pictures; `None` if the config uses another estimator or there is no camera.
    fn of_pictures(&self) -> Result<Option<ImageEstimator>, FieldError> {
        let PressSensor::Camera(Ok(camera)) = self.sensor else {
            return Ok(None);
        };
        let eye = &camera.sensor.eye;
        let plan = ImageFitSetup {
            estimator: self.estimator,
            model: self.model,
            sphere: self.sphere,
            markers: self.markers,
            optics: &eye.optics,
            stds: self
                .of_sensor
                .map_or([0.0; Departure::NUMBERS], departure_stds),
            told: None,
            layers: &|thickness, depths| self.parts.layers(thickness, depths),
        };
        let Some(fit) = plan.fit()? else {
            return Ok(None);
        };
        let look = RestLook::new(eye, self.rest_frames);
        let rest = look
            .spotted(AT_REST)
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        let rest = rest.iter().map(|one| Some(one.as_ref()?.image()));
        Ok(Some(ImageEstimator::new(fit, rest.collect())))
    }

    /// Cramér–Rao bounds for the readings, assuming the model's own body.
    pub(super) fn bounds(&self, contact: &Contact<'_>, tangential: bool) -> Option<Bounds> {
        let priors = self.estimator.priors();
        let drawn = |error: GaussianError| error.is_random().then(|| error.std());
        let fit = ForwardFit {
            baseline: baseline(priors.baseline),
            gain: within(drawn(self.noise.gain).unwrap_or(priors.gain_std?)),
            normal_std: drawn(self.noise.normal),
            tangential_std: drawn(self.noise.tangential),
            ..ForwardFit::new(self.body.body.clone())
        };
        let indentation_std = (priors.indentation == Indentation::Known)
            .then(|| drawn(self.noise.indentation).unwrap_or(priors.indentation_std));
        fit.bounds(
            self.markers,
            contact,
            self.pressed.at,
            tangential,
            indentation_std,
        )
    }
}
