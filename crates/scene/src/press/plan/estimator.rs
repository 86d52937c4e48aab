//! Plan of the estimator of a press.

use palpate_chromatouch::{Departure, DiscDepths};
use palpate_press::{Body, Bounds, Contact, ForwardFit, ImageFit, Markers, PressError};
use palpate_sensing::GaussianError;
use palpate_study::config::{
    Indentation, NoiseKnown, PressEstimatorConfig, PressModelConfig, SensorNoise,
};

use super::super::camera::AT_REST;
use super::super::departed::stds;
use super::super::looks::RestLook;
use super::super::method::{self, Assumed};
use super::super::parts::Parts;
use super::super::picture_law::PictureLaw;
use super::super::pictures::PictureMethod;
use super::super::pressed::Pressed;
use super::super::readings::MarkerNoise;
use super::super::scene::{PressMethod, PressSensor};
use super::super::soft_body::{SoftBody, of_body, within_sensor};
use crate::marker_sphere::{MarkerSphere, of_optics};
use crate::plan::PlanError;

/// Step of the discs' depth by which slopes are found, in radii of the sensor.
const DEEPER: f64 = 1e-3;

/// Settings of an estimator, and the press and the sensor that it is used on.
pub(super) struct EstimatorPlan<'a> {
    pub(super) estimator: &'a PressEstimatorConfig,
    /// Model of the config, which may be `auto`.
    pub(super) model: &'a PressModelConfig,
    pub(super) sphere: &'a MarkerSphere<'a>,
    pub(super) body: &'a SoftBody,
    /// Thickness of its layer, where that has tables for fits to share.
    pub(super) shared: Option<f64>,
    pub(super) markers: &'a Markers,
    pub(super) pressed: &'a Pressed,
    pub(super) noise: &'a MarkerNoise,
    /// Standard deviations that a camera adds to the noise: normal, tangential.
    pub(super) sensed: [Option<f64>; 2],
    pub(super) parts: &'a Parts,
    pub(super) sensor: &'a PressSensor,
    /// How roughly the sensor is known.
    pub(super) of_sensor: Option<&'a SensorNoise>,
    /// Frames at rest that are averaged.
    pub(super) rest_frames: u32,
}

impl EstimatorPlan<'_> {
    /// The method that follows from the settings and from what is known of the sensor.
    pub(super) fn method(&self) -> Result<PressMethod, PlanError> {
        let Self {
            estimator, model, ..
        } = *self;
        let priors = estimator.priors();
        let stated = |error: GaussianError, sensed: Option<f64>| {
            let std = libm::hypot(error.std(), sensed.unwrap_or(0.0));
            Some(std).filter(|&std| priors.noise == NoiseKnown::Stated && std > 0.0)
        };
        match method::thickness(estimator, model) {
            Some(thickness) => {
                within_sensor("scene.estimator.thickness", thickness, self.sphere.radius)?;
            }
            None if matches!(estimator, PressEstimatorConfig::BondedLayer { .. }) => {
                return Err(PlanError::at("scene.estimator", "`thickness` is missing"));
            }
            None => {}
        }
        let knows_indentation = priors.indentation == Indentation::Known;
        let assumed = Assumed {
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
            fit: assumed
                .fit()
                .map_err(|error| of_body("scene.estimator", error))?,
            known_indentation: knows_indentation.then_some(priors.indentation_std),
            of_pictures: self.of_pictures()?,
        })
    }

    /// The fit of pictures, where that is asked for and there is a camera.
    fn of_pictures(&self) -> Result<Option<PictureMethod>, PlanError> {
        let (
            PressEstimatorConfig::Image {
                poisson, shift_std, ..
            },
            PressSensor::Camera(Ok(camera)),
        ) = (self.estimator, self.sensor)
        else {
            return Ok(None);
        };
        let thickness = method::thickness(self.estimator, self.model);
        let poisson = poisson.unwrap_or(self.model.poisson());
        let DiscDepths { magenta, yellow } = self.sphere.disc_depths()?;
        let bodies = |deeper: f64| -> Result<[Body; 2], PressError> {
            let body = |depth: f64| match thickness {
                Some(thickness) => self.parts.layer(thickness, depth),
                None => Body::half_space(poisson, depth),
            };
            Ok([body(magenta + deeper)?, body(yellow + deeper)?])
        };
        let refused = |error| of_body("scene.estimator", error);
        let stds = self.of_sensor.map_or([0.0; Departure::NUMBERS], stds);
        let deeper = DEEPER * self.sphere.radius;
        let deeper = match stds[0] > 0.0 {
            true => Some((deeper, bodies(deeper).map_err(refused)?)),
            false => None,
        };
        let eye = &camera.sensor.eye;
        let aligned = vec![[0.0; 2]; eye.optics.array().len()];
        let optics = eye
            .optics
            .misaligned(&aligned)
            .map_err(|error| of_optics(&error))?;
        let diameters = self.sphere.diameters()?;
        let fit = ImageFit {
            view: PictureLaw { optics },
            markers: self.markers.clone(),
            bodies: bodies(0.0).map_err(refused)?,
            deeper,
            common_stds: stds.to_vec(),
            // Of a point that is uniform over a disc, either coordinate has half the radius.
            misalignment_std: 0.5 * self.sphere.misalignment() * diameters.yellow
                / (self.sphere.radius - yellow),
            shift_std: *shift_std,
        };
        let look = RestLook::new(eye, self.rest_frames);
        let rest = look
            .spotted(AT_REST)
            .map_err(|error| PlanError::at("scene.sensor", error))?;
        Ok(Some(PictureMethod::new(fit, &rest)))
    }

    /// The bounds on what the readings can tell by the model's own body.
    pub(super) fn bounds(&self, contact: &Contact<'_>, tangential: bool) -> Option<Bounds> {
        let priors = self.estimator.priors();
        let drawn = |error: GaussianError| error.is_random().then(|| error.std());
        let fit = ForwardFit {
            baseline: method::baseline(priors.baseline),
            gain: method::within(drawn(self.noise.gain).unwrap_or(priors.gain_std?)),
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
