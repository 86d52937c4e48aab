//! Builds the fit of pictures from an estimator's settings and the sensor's parameters.

use palpate_chromatouch::{Departure, DiscDepths, Optics};
use palpate_number::Number;
use palpate_press::{Body, ImageFit, Markers, PressError, Told};
use palpate_study::config::{PressEstimatorConfig, PressModelConfig};

use super::method::thickness;
use super::picture_law::PictureLaw;
use super::soft_body::{of_body, within_sensor};
use crate::marker_sphere::{MarkerSphere, of_optics};
use crate::plan::PlanError;

/// Finite-difference step of the discs' depth, in sensor radii.
const DEEPER: f64 = 1e-3;
const ESTIMATOR: &str = "scene.estimator";

/// Builds layers of a thickness, with their markers at each of the depths.
pub(crate) type Layers<'a> = dyn Fn(f64, &[f64]) -> Result<Vec<Body>, PressError> + 'a;

/// Settings of an estimator that fits pictures, and the sensor whose pictures it fits.
pub(crate) struct PicturePlan<'a> {
    pub(crate) estimator: &'a PressEstimatorConfig,
    /// The sensor's own soft-body model; it supplies settings that the estimator omits.
    pub(crate) model: &'a PressModelConfig,
    pub(crate) sphere: &'a MarkerSphere<'a>,
    pub(crate) markers: &'a Markers,
    /// The nominal camera and markers; the fit ignores misalignments in it.
    pub(crate) optics: &'a Optics,
    /// Standard deviations of the sensor's departures from `optics`.
    pub(crate) stds: [f64; Departure::NUMBERS],
    /// Departures whose joint covariance is given, if any.
    pub(crate) told: Option<Told>,
    /// Builds layers of a thickness, with their markers at each of the depths.
    pub(crate) layers: &'a Layers<'a>,
}

impl PicturePlan<'_> {
    /// Builds the fit; `None` if the estimator does not fit pictures.
    ///
    /// # Errors
    /// [`PlanError`] for an impossible body or impossible discs.
    pub(crate) fn fit(&self) -> Result<Option<ImageFit<PictureLaw>>, PlanError> {
        let PressEstimatorConfig::Image {
            poisson, shift_std, ..
        } = self.estimator
        else {
            return Ok(None);
        };
        let thickness = thickness(self.estimator, self.model);
        let DiscDepths { magenta, yellow } = self.sphere.disc_depths()?;
        if let Some(thickness) = thickness {
            let path = "scene.estimator.thickness";
            within_sensor(path, thickness, self.sphere.radius)?;
            let deepest = magenta.max(yellow);
            if thickness < deepest {
                let [thickness, deepest] = [thickness, deepest].map(Number);
                let message = format!(
                    "is {thickness}; the layer must reach to the deepest discs, {deepest} under the skin"
                );
                return Err(PlanError::at(path, message));
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
        let bodies = bodies.map_err(|error| of_body(ESTIMATOR, error))?;
        let mut pairs = bodies.chunks_exact(2);
        let mut pair = || match pairs.next() {
            Some([magenta, yellow]) => Some([magenta.clone(), yellow.clone()]),
            _ => None,
        };
        let missing = || PlanError::at(ESTIMATOR, "no layer at the depths of the discs");
        let aligned = vec![[0.0; 2]; self.optics.array().len()];
        let optics = self.optics.misaligned(&aligned);
        Ok(Some(ImageFit {
            view: PictureLaw {
                optics: optics.map_err(|error| of_optics(&error))?,
            },
            markers: self.markers.clone(),
            bodies: pair().ok_or_else(missing)?,
            deeper: pair().map(|bodies| (deeper, bodies)),
            common_stds: self.stds.to_vec(),
            told: self.told.clone(),
            misalignment_std: self.sphere.misalignment_std()?,
            shift_std: *shift_std,
        }))
    }
}
