//! Builds the fit to marker images from the settings of an estimator and the parameters of the sensor.

use std::sync::Arc;

use palpate_chromatouch::{Departure, DiscDepths, Optics};
use palpate_press::{Body, DeparturePrior, ImageFit, Markers, PressError};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{PressEstimatorConfig, PressModelConfig, SensorNoise};

use crate::image_model::ImageModel;
use crate::marker_sphere::{MarkerSphere, optics_error};
use crate::press_fit::{body_error, within_sensor};

/// Length by which the depth of a disc is increased, as a share of the sensor's radius. From the displacements at both
/// depths, the fit computes their derivatives with respect to the depth by finite differences.
const DEEPER: f64 = 1e-3;
const ESTIMATOR: &str = "scene.estimator";

type Layers<'a> = dyn Fn(f64, &[f64]) -> Result<Vec<Body>, PressError> + 'a;

/// Settings of an estimator that fits marker images, and the sensor whose images are fitted.
pub struct ImageFitSetup<'a> {
    /// Settings of the estimator, from the config.
    pub estimator: &'a PressEstimatorConfig,
    /// Soft body of the sensor. If the estimator's config does not state a parameter of the soft body, the parameter of
    /// `model` is used.
    pub model: &'a PressModelConfig,
    /// Skin, layout and discs of the sensor.
    pub sphere: &'a MarkerSphere<'a>,
    /// The markers under the skin.
    pub markers: &'a Markers,
    /// The camera and the markers with their nominal parameters. The fit ignores the misalignments between the two
    /// discs of these markers.
    pub optics: &'a Optics,
    /// Standard deviation of each difference between a parameter of the sensor and its nominal value in `optics`.
    pub stds: [f64; Departure::NUMBERS],
    /// Joint prior of the differences between the sensor's parameters and their nominal values in `optics`. `None` if
    /// the covariance matrix of these differences is not stated.
    pub departure_prior: Option<DeparturePrior>,
    /// Function that builds a bonded layer (a soft layer on a rigid core). Its arguments are the thickness of the layer
    /// and a list of depths. It returns one body per depth, which computes the displacements at this depth.
    pub layers: &'a Layers<'a>,
}

impl ImageFitSetup<'_> {
    /// Builds the fit to marker images; `None` if the estimator does not fit images.
    ///
    /// # Errors
    /// [`FieldError`] if the soft body or the discs are impossible.
    pub fn fit(&self) -> Result<Option<ImageFit>, FieldError> {
        let PressEstimatorConfig::Image {
            poisson, shift_std, ..
        } = self.estimator
        else {
            return Ok(None);
        };
        let thickness = self.estimator.layer(self.model.thickness());
        let DiscDepths { magenta, yellow } = self.sphere.disc_depths()?;
        if let Some(thickness) = thickness {
            let path = "scene.estimator.thickness";
            within_sensor(path, thickness, self.sphere.radius)?;
            let deepest = magenta.max(yellow);
            if thickness < deepest {
                let [thickness, deepest] = [thickness, deepest].map(Number);
                let message = format!(
                    "is {thickness}; must be at least {deepest}, so that the layer contains the deepest discs"
                );
                return Err(FieldError::at(path, message));
            }
        }
        let poisson = poisson.unwrap_or(self.model.poisson());
        let deeper = DEEPER * self.sphere.radius;
        let mut depths = vec![magenta, yellow];
        if self.stds[0] > 0.0 {
            depths.extend([magenta + deeper, yellow + deeper]);
        }
        let bodies = match thickness {
            Some(thickness) => (self.layers)(thickness, &depths),
            None => depths
                .iter()
                .map(|depth| Body::half_space(poisson, *depth))
                .collect(),
        };
        let bodies = bodies.map_err(|error| body_error(ESTIMATOR, error))?;
        let mut pairs = bodies.chunks_exact(2);
        let mut pair = || match pairs.next() {
            Some([magenta, yellow]) => Some([magenta.clone(), yellow.clone()]),
            _ => None,
        };
        let missing = || FieldError::at(ESTIMATOR, "no layer at the depths of the discs");
        let aligned = vec![[0.0; 2]; self.optics.array().places().len()];
        let optics = self.optics.misaligned(&aligned);
        Ok(Some(ImageFit {
            view: Arc::new(ImageModel {
                optics: optics.map_err(|error| optics_error(&error))?,
            }),
            markers: self.markers.clone(),
            bodies: pair().ok_or_else(missing)?,
            deeper: pair().map(|bodies| (deeper, bodies)),
            common_stds: self.stds.to_vec(),
            departure_prior: self.departure_prior.clone(),
            misalignment_std: self.sphere.misalignment_std()?,
            shift_std: *shift_std,
        }))
    }
}

/// Standard deviation of each value of a [`Departure`]. Such a value is the difference between a parameter of the
/// sensor and its nominal value.
pub fn departure_stds(noise: &SensorNoise) -> [f64; Departure::NUMBERS] {
    let turn = noise.turn_deg.to_radians();
    // The lens coefficients k3 and k5 are assumed to be exact, so their standard deviations stay 0.
    let mut stds = [0.0; Departure::NUMBERS];
    stds[13..19].fill(noise.colour);
    stds[..13].copy_from_slice(&[
        noise.disc_depth,
        noise.disc_depth,
        noise.disc_diameter,
        noise.disc_diameter,
        noise.centre_px,
        noise.centre_px,
        noise.scale,
        noise.place,
        noise.place,
        noise.place,
        turn,
        turn,
        turn,
    ]);
    stds
}
