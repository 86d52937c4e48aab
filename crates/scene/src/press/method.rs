//! Estimators of presses, from their settings and what is known of the sensor.

use palpate_press::{Body, ForwardFit, Markers, PressError, Prior, calibrated_c};
use palpate_study::config::{Baseline, PressEstimatorConfig, PressModelConfig};

/// Estimator's settings, with the sensor that they are used on.
pub(crate) struct Assumed<'a> {
    pub(crate) estimator: &'a PressEstimatorConfig,
    /// The sensor's own soft body, which has what the settings leave out.
    pub(crate) model: &'a PressModelConfig,
    /// Body of that model under these markers.
    pub(crate) body: &'a Body,
    /// Thickness of its layer, where that has tables for fits to share.
    pub(crate) shared: Option<f64>,
    /// Layer of a thickness, with its markers at a depth, that has tables for fits.
    pub(crate) layer: &'a dyn Fn(f64, f64) -> Result<Body, PressError>,
    pub(crate) markers: &'a Markers,
    /// Depth of the markers under the skin, length.
    pub(crate) marker_depth: f64,
    /// Indentation of the plane on which a Gaussian's c is calibrated.
    pub(crate) calibrated_at: Option<f64>,
    /// Whether the estimator is given the indentation.
    pub(crate) knows_indentation: bool,
    /// Standard deviations of normal and tangential displacements, where they are told.
    pub(crate) stds: [Option<f64>; 2],
}

impl Assumed<'_> {
    /// Fit of the assumed body; the inner error where a Gaussian cannot be calibrated.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for a setting out of its range.
    pub(crate) fn fit(&self) -> Result<Result<ForwardFit, PressError>, PressError> {
        let priors = self.estimator.priors();
        let fit = self.assumed_body()?.map(|body| ForwardFit {
            // The amplitude of a Gaussian is fitted, unless it is the indentation.
            gain: priors.gain_std.map_or(
                match self.knows_indentation {
                    true => Prior::Free,
                    false => Prior::Exact,
                },
                within,
            ),
            baseline: baseline(priors.baseline),
            normal_std: self.stds[0],
            tangential_std: self.stds[1],
            window: match self.estimator {
                PressEstimatorConfig::Gaussian { window, .. } => *window,
                _ => None,
            },
            ..ForwardFit::new(body)
        });
        Ok(fit)
    }

    fn assumed_body(&self) -> Result<Result<Body, PressError>, PressError> {
        match (thickness(self.estimator, self.model), self.estimator) {
            (Some(thickness), _) if self.shared == Some(thickness) => Ok(self.body.clone()),
            (Some(thickness), _) => (self.layer)(thickness, self.marker_depth),
            (None, PressEstimatorConfig::BondedLayer { .. }) => Err(PressError::Undetermined {
                what: "the thickness of the bonded layer is not given",
            }),
            (
                None,
                PressEstimatorConfig::HalfSpace { poisson, .. }
                | PressEstimatorConfig::Image { poisson, .. },
            ) => Body::half_space(poisson.unwrap_or(self.model.poisson()), self.marker_depth),
            (None, PressEstimatorConfig::Gaussian { c: Some(c), .. }) => Body::gaussian(*c),
            (None, PressEstimatorConfig::Gaussian { window, .. }) => {
                let Some(indentation) = self.calibrated_at else {
                    return Ok(Err(PressError::Undetermined {
                        what: "the c of a Gaussian is calibrated at a known indentation",
                    }));
                };
                return Ok(calibrated_c(self.markers, self.body, indentation, *window)
                    .and_then(Body::gaussian));
            }
        }
        .map(Ok)
    }
}

/// Body that an estimator assumes, in words, and whether it knows what happens below its surface.
pub(super) const fn assumed_body(estimator: &PressEstimatorConfig) -> (&'static str, bool) {
    match estimator {
        PressEstimatorConfig::HalfSpace { .. } => ("a half-space", true),
        PressEstimatorConfig::BondedLayer { .. } => ("a bonded layer", true),
        PressEstimatorConfig::Image { .. } => ("the body to the markers' pictures", true),
        PressEstimatorConfig::Gaussian { c: Some(_), .. } => ("a Gaussian with a given c", false),
        PressEstimatorConfig::Gaussian { c: None, .. } => {
            ("a Gaussian calibrated on a plane", false)
        }
    }
}

/// Thickness of the layer that an estimator assumes: its own, else the model's; length.
pub(crate) fn thickness(estimator: &PressEstimatorConfig, model: &PressModelConfig) -> Option<f64> {
    estimator.layer(model.thickness())
}

/// Body of a model that is named, with a layer made by `layer`.
pub(crate) fn body_of(
    model: &PressModelConfig,
    depth: f64,
    layer: impl Fn(f64, f64) -> Result<Body, PressError>,
) -> Result<Body, PressError> {
    match (model, model.thickness()) {
        (PressModelConfig::Hertz { poisson }, _) => Body::hertz(*poisson),
        (_, Some(thickness)) => layer(thickness, depth),
        (_, None) => Body::half_space(model.poisson(), depth),
    }
}

pub(super) const fn baseline(config: Baseline) -> Prior {
    match config {
        Baseline::Known => Prior::Exact,
        Baseline::Fitted => Prior::Free,
    }
}

/// Prior of a factor near 1 with this standard deviation.
pub(super) fn within(std: f64) -> Prior {
    if std > 0.0 {
        Prior::Within(std)
    } else {
        Prior::Exact
    }
}
