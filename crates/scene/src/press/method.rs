//! Builds the estimator of a press from its settings and the sensor's parameters.

use palpate_press::{Body, ForwardFit, Markers, PressError, Prior, calibrated_c};
use palpate_study::config::{Baseline, PressEstimatorConfig, PressModelConfig};

/// Settings of an estimator, and the sensor whose readings it uses.
pub(crate) struct Assumed<'a> {
    pub(crate) estimator: &'a PressEstimatorConfig,
    /// The sensor's own soft-body model; it supplies settings that the estimator omits.
    pub(crate) model: &'a PressModelConfig,
    /// Body of that model at the depth of the markers.
    pub(crate) body: &'a Body,
    /// Thickness of the body's layer, if fits can share its tables.
    pub(crate) shared: Option<f64>,
    /// Builds a layer with tables from its thickness and the depth of its markers.
    pub(crate) layer: &'a dyn Fn(f64, f64) -> Result<Body, PressError>,
    pub(crate) markers: &'a Markers,
    /// Depth of the markers under the skin, length.
    pub(crate) marker_depth: f64,
    /// Indentation of the press on a plane that calibrates a Gaussian's c.
    pub(crate) calibrated_at: Option<f64>,
    /// Whether the estimator is given the indentation.
    pub(crate) knows_indentation: bool,
    /// Standard deviations of normal and tangential displacements, if stated.
    pub(crate) stds: [Option<f64>; 2],
}

impl Assumed<'_> {
    /// Builds the fit of the assumed body. The inner result is an error if a Gaussian cannot be calibrated.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for a setting out of its range.
    pub(crate) fn fit(&self) -> Result<Result<ForwardFit, PressError>, PressError> {
        let priors = self.estimator.priors();
        let fit = self.assumed_body()?.map(|body| ForwardFit {
            // A Gaussian's amplitude is fitted if the indentation is given; otherwise it is the indentation.
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
                        what: "the calibration of a Gaussian's c needs the indentation",
                    }));
                };
                return Ok(calibrated_c(self.markers, self.body, indentation, *window)
                    .and_then(Body::gaussian));
            }
        }
        .map(Ok)
    }
}

/// Name of the body that an estimator assumes, and whether it models displacements below the surface.
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

/// Thickness of the layer that an estimator assumes, length: its own setting, or else the model's.
pub(crate) fn thickness(estimator: &PressEstimatorConfig, model: &PressModelConfig) -> Option<f64> {
    estimator.layer(model.thickness())
}

/// Builds the body of a model; `layer` builds a bonded layer from its thickness and depth.
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
