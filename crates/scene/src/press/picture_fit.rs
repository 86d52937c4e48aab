//! Fit of pictures, from the settings of an estimator and what is known of the sensor.

use palpate_chromatouch::{Departure, DiscDepths, Optics};
use palpate_press::{Body, ImageFit, Markers, PressError, Told};
use palpate_study::config::{PressEstimatorConfig, PressModelConfig};

use super::method::thickness;
use super::picture_law::PictureLaw;
use super::soft_body::{of_body, within_sensor};
use crate::marker_sphere::{MarkerSphere, of_optics};
use crate::plan::PlanError;

/// Step of the discs' depth by which slopes are found, in radii of the sensor.
const DEEPER: f64 = 1e-3;
const ESTIMATOR: &str = "scene.estimator";

/// Estimator by pictures, with the sensor that it is used on.
pub(crate) struct PicturePlan<'a> {
    pub(crate) estimator: &'a PressEstimatorConfig,
    /// The sensor's own soft body, which has what the settings leave out.
    pub(crate) model: &'a PressModelConfig,
    pub(crate) sphere: &'a MarkerSphere<'a>,
    pub(crate) markers: &'a Markers,
    /// The camera and the markers as they are meant to be, however they are misaligned.
    pub(crate) optics: &'a Optics,
    /// Standard deviations of departures from them.
    pub(crate) stds: [f64; Departure::NUMBERS],
    /// Departures whose joint covariance something else tells.
    pub(crate) told: Option<Told>,
    /// Layer of a thickness, with its markers at a depth.
    pub(crate) layer: &'a dyn Fn(f64, f64) -> Result<Body, PressError>,
}

impl PicturePlan<'_> {
    /// The fit; `None` where the estimator is another one.
    ///
    /// # Errors
    /// [`PlanError`] for a body or discs that cannot be.
    pub(crate) fn fit(&self) -> Result<Option<ImageFit<PictureLaw>>, PlanError> {
        let PressEstimatorConfig::Image {
            poisson, shift_std, ..
        } = self.estimator
        else {
            return Ok(None);
        };
        let thickness = thickness(self.estimator, self.model);
        if let Some(thickness) = thickness {
            within_sensor("scene.estimator.thickness", thickness, self.sphere.radius)?;
        }
        let poisson = poisson.unwrap_or(self.model.poisson());
        let DiscDepths { magenta, yellow } = self.sphere.disc_depths()?;
        let bodies = |deeper: f64| -> Result<[Body; 2], PlanError> {
            let body = |depth: f64| match thickness {
                Some(thickness) => (self.layer)(thickness, depth),
                None => Body::half_space(poisson, depth),
            };
            let both = body(magenta + deeper).and_then(|one| Ok([one, body(yellow + deeper)?]));
            both.map_err(|error| of_body(ESTIMATOR, error))
        };
        let deeper = DEEPER * self.sphere.radius;
        let deeper = match self.stds[0] > 0.0 {
            true => Some((deeper, bodies(deeper)?)),
            false => None,
        };
        let aligned = vec![[0.0; 2]; self.optics.array().len()];
        let optics = self.optics.misaligned(&aligned);
        Ok(Some(ImageFit {
            view: PictureLaw {
                optics: optics.map_err(|error| of_optics(&error))?,
            },
            markers: self.markers.clone(),
            bodies: bodies(0.0)?,
            deeper,
            common_stds: self.stds.to_vec(),
            told: self.told.clone(),
            misalignment_std: self.sphere.misalignment_std()?,
            shift_std: *shift_std,
        }))
    }
}
