//! The fidelity ladder of a press, and the choice of `auto`.

use palpate_press::{Body, MarkerDisplacement, Markers, PressError};

use super::pressed::Pressed;
use super::soft_body::SoftBody;
use crate::ladder::{Ladder, Rung};
use palpate_estimators::MarkerSphere;
use palpate_study::FieldError;
use palpate_study::config::{ModelConfig, PressModelConfig};

/// The model used, and why.
pub(super) struct Choice {
    /// Model in the form of a config: never `auto`.
    pub(super) model: PressModelConfig,
    pub(super) reason: String,
    /// Tolerance of `auto`; `None` where the config names a model.
    pub(super) tolerance: Option<f64>,
}

/// A rung with its error, or why it cannot simulate the press.
struct Judged {
    model: PressModelConfig,
    outcome: Result<f64, String>,
}

/// The solved layer is not accurate below this tolerance.
const SMALLEST_TOLERANCE: f64 = 1e-9;
const LARGEST_TOLERANCE: f64 = 1.0;

/// Models that can compute a press, and the depths at which their displacements are compared.
#[derive(Clone, Debug)]
pub(super) struct PressRungs {
    /// Model of the config, which may be `auto`.
    asked: PressModelConfig,
    radius: f64,
    /// Depth of the markers (midway between their discs) and, with a camera, of both discs.
    depths: Vec<f64>,
}

/// Displacements of the markers at all depths, from one model.
type Moved = Result<Vec<MarkerDisplacement>, PressError>;

impl PressRungs {
    /// Rungs for a sensor that is read directly or, if `by_camera`, by a camera.
    pub(super) fn of(
        asked: &PressModelConfig,
        sphere: &MarkerSphere<'_>,
        by_camera: bool,
    ) -> Result<Self, FieldError> {
        let mut depths = vec![sphere.marker_depth];
        if by_camera {
            let discs = sphere.disc_depths()?;
            depths.extend([discs.magenta, discs.yellow]);
        }
        Ok(Self {
            asked: asked.clone(),
            radius: sphere.radius,
            depths,
        })
    }

    /// The model of a press: the one named in the config, or the choice of `auto`.
    pub(super) fn choice(
        &self,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Choice, FieldError> {
        let PressModelConfig::Auto { tolerance, .. } = self.asked else {
            return Ok(Choice {
                model: self.asked.clone(),
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
        let rungs = self.judged(markers, pressed)?;
        let reference = self.asked.reference();
        let good = |rung: &&Judged| matches!(rung.outcome, Ok(error) if error <= tolerance);
        let taken = rungs.iter().find(good);
        let (model, reason) = match taken {
            Some(Judged { model, outcome }) if *model != reference => {
                let error = outcome.as_ref().copied().unwrap_or(0.0);
                let reason = format!(
                    "the cheapest that meets {tolerance:.0e}: errs by {error:.1e} of the largest displacement"
                );
                (model.clone(), reason)
            }
            _ => {
                let reason = match rungs.iter().rev().nth(1).map(|rung| &rung.outcome) {
                    Some(Ok(error)) => {
                        format!("the next cheaper errs by {error:.1e} of the largest displacement")
                    }
                    _ => "there is no press to hold a cheaper one against".to_owned(),
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

    /// All rungs, cheapest first; their errors are relative to the last one.
    fn judged(&self, markers: &Markers, pressed: &Pressed) -> Result<Vec<Judged>, FieldError> {
        let poisson = self.asked.poisson();
        let layer = self.asked.thickness();
        let layer = layer.map(|thickness| PressModelConfig::BondedLayer { thickness });
        let models = [
            PressModelConfig::Hertz { poisson },
            PressModelConfig::HalfSpace { poisson },
        ];
        let all: Vec<(Moved, PressModelConfig)> = models
            .into_iter()
            .chain(layer)
            .map(|model| Ok((self.moved(&model, markers, pressed)?, model)))
            .collect::<Result<_, FieldError>>()?;
        let reference = all
            .last()
            .map_or(Ok(Vec::new()), |(moved, _)| moved.clone());
        let held = |moved: Moved| -> Result<f64, String> {
            let fails = |error: PressError| error.to_string();
            let reference = reference.as_ref().map_err(|error| fails(*error))?;
            let error = distance(&moved.map_err(fails)?, reference);
            let still = || "no marker moves, so that no error is relative to it".to_owned();
            error.is_finite().then_some(error).ok_or_else(still)
        };
        Ok(all
            .into_iter()
            .map(|(moved, model)| Judged {
                model,
                outcome: held(moved),
            })
            .collect())
    }

    /// The ladder of a press.
    pub(super) fn ladder(
        &self,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Ladder, FieldError> {
        let choice = self.choice(markers, pressed)?;
        let judged = self.judged(markers, pressed)?;
        let rungs: Vec<Rung> = judged
            .into_iter()
            .map(|Judged { model, outcome }| Rung {
                name: name(&model),
                model: ModelConfig::Press(model),
                outcome,
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

    fn moved(
        &self,
        model: &PressModelConfig,
        markers: &Markers,
        pressed: &Pressed,
    ) -> Result<Moved, FieldError> {
        let mut all = Vec::new();
        for &depth in &self.depths {
            let body = SoftBody::of(model, self.radius, depth, Body::solved_layer)?;
            match body.displacements(markers, pressed) {
                Ok(moved) => all.extend(moved),
                Err(error) => return Ok(Err(error)),
            }
        }
        Ok(Ok(all))
    }
}

/// Largest difference, relative to the largest displacement of `reference`.
fn distance(moved: &[MarkerDisplacement], reference: &[MarkerDisplacement]) -> f64 {
    let size = |normal: f64, [x, y]: [f64; 2]| libm::hypot(libm::hypot(normal, x), y);
    let differences = moved.iter().zip(reference).map(|(one, other)| {
        let aside = [0, 1].map(|axis| one.tangential[axis] - other.tangential[axis]);
        size(one.normal - other.normal, aside)
    });
    let largest = reference.iter().map(|one| size(one.normal, one.tangential));
    let (off, largest) = (differences.fold(0.0, f64::max), largest.fold(0.0, f64::max));
    if off > 0.0 { off / largest } else { 0.0 }
}

fn name(model: &PressModelConfig) -> String {
    match model {
        PressModelConfig::Auto { tolerance, .. } => format!("auto, tolerance {tolerance:e}"),
        PressModelConfig::Hertz { .. } => "Hertz contact, at the surface".to_owned(),
        PressModelConfig::HalfSpace { .. } => "half-space, at the markers' depth".to_owned(),
        PressModelConfig::BondedLayer { .. } => "bonded layer, solved".to_owned(),
    }
}
