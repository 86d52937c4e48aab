//! Builds the estimator of a press from its settings and the parameters of the sensor.

use palpate_press::{
    Body, ForwardFit, Markers, PressError, Prior, calibrated_c, sneddon_indentation,
};
use palpate_statistics::{BadSetting, Number};
use palpate_study::config::{
    Baseline, Indentation, NoiseKnown, PressEstimatorConfig, PressModelConfig,
};
use palpate_study::{FieldError, Warning};

/// Settings of an estimator, and the sensor whose readings it uses.
pub struct PressFitSetup<'a> {
    /// Settings of the estimator, from the config.
    pub estimator: &'a PressEstimatorConfig,
    /// Soft body of the sensor. If the estimator's config does not state a parameter of the soft body, the parameter of
    /// `model` is used.
    pub model: &'a PressModelConfig,
    /// The soft body of the sensor. It computes displacements at the depth of the markers.
    pub body: &'a Body,
    /// Thickness of the bonded layer `body` if the fit can reuse the precomputed tables of this layer; otherwise
    /// `None`.
    pub shared: Option<f64>,
    /// Function that builds a bonded layer and its precomputed tables. Its arguments are the thickness of the layer and
    /// the depth of the markers (lengths).
    pub layer: &'a dyn Fn(f64, f64) -> Result<Body, PressError>,
    /// The markers under the skin.
    pub markers: &'a Markers,
    /// Depth of the markers under the skin (length).
    pub marker_depth: f64,
    /// Indentation (length) of a simulated press on a plane. The width c of the Gaussian model is calibrated with this
    /// press. `None` if the indentation is not stated.
    pub calibrated_at: Option<f64>,
    /// Whether the estimator receives the indentation as an input instead of fitting it.
    pub knows_indentation: bool,
    /// Stated standard deviations of the noise of normal and tangential displacements; `None` if they are not stated.
    pub stds: [Option<f64>; 2],
}

impl PressFitSetup<'_> {
    /// Builds the fit of a press to marker displacements, with the soft body that the estimator assumes.
    ///
    /// # Errors
    /// [`PressFitError::Setting`] if a setting is out of its range; [`PressFitError::Calibration`] if a Gaussian cannot
    /// be calibrated.
    pub fn fit(&self) -> Result<ForwardFit, PressFitError> {
        let priors = self.estimator.priors();
        Ok(ForwardFit {
            // The amplitude of the Gaussian model depends on whether the estimator receives the indentation. If it
            // does, the amplitude is this indentation times a fitted gain. Otherwise, the amplitude is the fitted
            // indentation.
            gain: priors.gain_std.map_or(
                match self.knows_indentation {
                    true => Prior::Free,
                    false => Prior::Exact,
                },
                Prior::from,
            ),
            baseline: baseline(priors.baseline),
            normal_std: self.stds[0],
            tangential_std: self.stds[1],
            window: match self.estimator {
                PressEstimatorConfig::Gaussian { window, .. } => *window,
                _ => None,
            },
            is_elliptic: matches!(self.estimator, PressEstimatorConfig::Elliptic { .. }),
            ..ForwardFit::new(self.assumed_body()?)
        })
    }

    fn assumed_body(&self) -> Result<Body, PressFitError> {
        let thickness = self.estimator.layer(self.model.thickness());
        let body = match (thickness, self.estimator) {
            (Some(thickness), _) if self.shared == Some(thickness) => return Ok(self.body.clone()),
            (Some(thickness), _) => (self.layer)(thickness, self.marker_depth),
            (None, PressEstimatorConfig::BondedLayer { .. }) => Err(PressError::Undetermined {
                what: "the thickness of the bonded layer is not given",
            }),
            (
                None,
                PressEstimatorConfig::HalfSpace { poisson, .. }
                | PressEstimatorConfig::Elliptic { poisson, .. }
                | PressEstimatorConfig::Image { poisson, .. },
            ) => Body::half_space(poisson.unwrap_or(self.model.poisson()), self.marker_depth),
            (None, PressEstimatorConfig::Gaussian { c: Some(c), .. }) => Body::gaussian(*c),
            (None, PressEstimatorConfig::Gaussian { window, .. }) => {
                let undetermined = PressError::Undetermined {
                    what: "neither `c` nor the indentation is given; the Gaussian needs one of them, because `c` is calibrated at the indentation",
                };
                let c = self
                    .calibrated_at
                    .ok_or(undetermined)
                    .and_then(|indentation| {
                        calibrated_c(self.markers, self.body, indentation, *window)
                    });
                let body = c.and_then(Body::gaussian);
                return body.map_err(PressFitError::Calibration);
            }
        };
        body.map_err(PressFitError::Setting)
    }
}

/// A fit that assumes the true soft body `body`. `gain_std` and `stds` are the true standard deviations of the noise of
/// the gain, and of normal and tangential displacements; `None` for noise that is not random. `None` if the estimator is
/// a Gaussian, which cannot describe the true press.
pub fn ideal_fit(
    estimator: &PressEstimatorConfig,
    body: &Body,
    gain_std: Option<f64>,
    stds: [Option<f64>; 2],
) -> Option<ForwardFit> {
    let priors = estimator.priors();
    Some(ForwardFit {
        baseline: baseline(priors.baseline),
        gain: gain_std.unwrap_or(priors.gain_std?).into(),
        normal_std: stds[0],
        tangential_std: stds[1],
        is_elliptic: matches!(estimator, PressEstimatorConfig::Elliptic { .. }),
        ..ForwardFit::new(body.clone())
    })
}

/// Text for `palpate check` about the fit to marker displacements.
pub fn fit_description(estimator: &PressEstimatorConfig) -> String {
    let body = match estimator {
        PressEstimatorConfig::HalfSpace { .. } => "a half-space",
        PressEstimatorConfig::Elliptic { .. } => "an elliptic contact of a half-space",
        PressEstimatorConfig::BondedLayer { .. } => "a bonded layer",
        PressEstimatorConfig::Image { .. } => "the body to the markers' images",
        PressEstimatorConfig::Gaussian { c: Some(_), .. } => "a Gaussian with a given c",
        PressEstimatorConfig::Gaussian { c: None, .. } => "a Gaussian calibrated on a plane",
    };
    let priors = estimator.priors();
    let indentation = match priors.indentation {
        Indentation::Known => "indentation given",
        Indentation::Fitted => "indentation fitted",
    };
    let baseline = match priors.baseline {
        Baseline::Known => "",
        Baseline::Fitted => ", baseline fitted",
    };
    let noise = match priors.noise {
        NoiseKnown::Stated => "noise as stated",
        NoiseKnown::Found => "noise estimated from the residuals",
    };
    format!("least-squares fit of {body}, {indentation}{baseline}, {noise}")
}

/// Reason why the fit of a press cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressFitError {
    /// A setting of the estimator is out of its range, or missing.
    Setting(PressError),
    /// The width c of a Gaussian model cannot be calibrated with the sensor's soft body.
    Calibration(PressError),
}

impl From<PressFitError> for PressError {
    fn from(error: PressFitError) -> Self {
        match error {
            PressFitError::Setting(error) | PressFitError::Calibration(error) => error,
        }
    }
}

/// Builds the soft body that `model` describes. The body computes displacements at the depth `depth` of the markers.
/// `layer` is a function that builds a bonded layer from its thickness and this depth.
pub fn sensor_body(
    model: &PressModelConfig,
    depth: f64,
    layer: impl Fn(f64, f64) -> Result<Body, PressError>,
) -> Result<Body, PressError> {
    match (model, model.thickness()) {
        (PressModelConfig::Hertz { poisson, .. }, _) => Body::half_space(*poisson, 0.0),
        (_, Some(thickness)) => layer(thickness, depth),
        (_, None) => Body::half_space(model.poisson(), depth),
    }
}

/// Prior of the baseline, which is an offset added to the normal displacements of all markers.
const fn baseline(config: Baseline) -> Prior {
    match config {
        Baseline::Known => Prior::Exact,
        Baseline::Fitted => Prior::Free,
    }
}

/// Checks that a layer is not thicker than the sensor's radius.
///
/// # Errors
/// [`FieldError`] at `path` if the layer is thicker.
pub fn within_sensor(path: &str, thickness: f64, radius: f64) -> Result<(), FieldError> {
    if thickness <= radius {
        return Ok(());
    }
    let message = format!(
        "must be at most the sensor's radius {}, is {}",
        Number(radius),
        Number(thickness)
    );
    Err(FieldError::at(path, message))
}

/// Converts an error of the soft body to an error that names the invalid field of the config.
pub fn body_error(table: &str, error: PressError) -> FieldError {
    match error {
        PressError::BadSetting(BadSetting {
            setting: "depth", ..
        }) => FieldError::at("scene.probe.marker_depth", error),
        PressError::BadSetting(BadSetting { setting, .. }) => {
            FieldError::at(format!("{table}.{setting}"), error)
        }
        _ => FieldError::at(table, error),
    }
}

/// Limit of small-strain theory: ratio of the contact's radius to the radius of the sensor or of the object. Above this
/// ratio, the errors of the theory are noticeable.
const LARGE_CONTACT: f64 = 0.3;

/// Returns a warning if the contact, compared with the sensor or the object, is too wide for small-strain theory.
pub fn large_contact_warning(
    relative_curvature: f64,
    contact_radius: f64,
    sensor_radius: f64,
    is_layer: bool,
) -> Option<Warning> {
    let of_sensor = contact_radius / sensor_radius;
    let of_object = contact_radius * (relative_curvature - sensor_radius.recip());
    let (share, whose) = match of_object > of_sensor {
        true => (of_object, "object"),
        false => (of_sensor, "sensor"),
    };
    if share < LARGE_CONTACT {
        return None;
    }
    let reason = match sneddon_indentation(1.0, share) {
        _ if is_layer => "strains are not small".to_owned(),
        Ok(sneddon) => format!(
            "Sneddon's relation gives an indentation that is {:.1} % larger than Hertz's",
            100.0 * (sneddon / (share * share) - 1.0)
        ),
        Err(_) => format!("it is wider than the {whose}"),
    };
    let text = format!(
        "the contact's radius is {share:.2} of the {whose}'s radius, above {LARGE_CONTACT}: {reason}"
    );
    Some(Warning::new("large-contact", text, [("share", share)]))
}
