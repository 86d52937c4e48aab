//! The fidelity ladder of a glide.

use palpate_rolling::{Glider, InvalidTouch, Model, Touch, TouchModel};

use super::plan::{glider, middle, tip, touches};
use super::scene::{FingerTouch, GlideScene};
use crate::ladder::{Ladder, Rung};
use palpate_study::FieldError;
use palpate_study::config::{GlideConfig, GlideModelConfig, ModelConfig};

/// Relative tolerances of the rungs of Newton's method.
const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

impl GlideScene {
    /// Builds the glider that finds the contacts of the scene, with the model of `config`.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn glider(config: &GlideConfig) -> Result<Glider, FieldError> {
        glider(config)
    }

    /// Computes the contacts of all fingers with `glider`, finger by finger.
    ///
    /// # Errors
    /// [`FieldError`] if the contact of a finger cannot be computed.
    pub fn follow(glider: &Glider, config: &GlideConfig) -> Result<Vec<Touch>, FieldError> {
        let middle = middle(config, glider.object())?;
        let touches = touches(glider, middle, &config.motion)?;
        Ok(touches.into_iter().map(|one| one.touch).collect())
    }

    /// The rungs of the scene.
    pub(super) fn measured_ladder(&self) -> Result<Ladder, FieldError> {
        let config = &self.config;
        let glider = glider(config)?;
        let middle = middle(config, glider.object())?;
        let (_, radius) = tip(config);
        let on = |model: TouchModel| -> Result<Vec<FingerTouch>, String> {
            let glider = glider.on(model).map_err(|error| match error {
                InvalidTouch::Unsupported { reason, .. } => reason,
                error => error.to_string(),
            })?;
            touches(&glider, middle, &config.motion).map_err(|error| error.message)
        };
        let closed = on(TouchModel::ClosedForm);
        let finest = on(TouchModel::Newton {
            tolerance: Model::SMALLEST_TOLERANCE,
        });
        // The closed form and the finest Newton are compared with each other. If only one is possible, its error
        // counts as 0.
        let best = closed.as_ref().or(finest.as_ref());
        let off_closed = match (&closed, &finest) {
            (Ok(closed), Ok(finest)) => Ok(distance(closed, finest) / radius),
            (Ok(_), Err(_)) => Ok(0.0),
            (Err(why), _) => Err(why.clone()),
        };
        let rung = |model: TouchModel, outcome: Result<f64, String>| Rung {
            name: named(model).0,
            model: ModelConfig::Glide(named(model).1),
            outcome,
        };
        let choice = glider.choice();
        let mut tolerances = TOLERANCES.to_vec();
        if let TouchModel::Newton { tolerance } = choice.model {
            tolerances.push(tolerance);
        }
        tolerances.sort_by(|one, other| other.total_cmp(one));
        tolerances.dedup();
        let mut rungs = vec![rung(TouchModel::ClosedForm, off_closed)];
        rungs.extend(tolerances.into_iter().map(|tolerance| {
            let model = TouchModel::Newton { tolerance };
            let outcome = on(model).and_then(|touches| {
                let best = best.map_err(Clone::clone)?;
                Ok(distance(&touches, best) / radius)
            });
            rung(model, outcome)
        }));
        let (reason, tolerance) = match config.model {
            GlideModelConfig::Auto { tolerance } => (choice.reason, Some(tolerance)),
            _ => ("named in the config".to_owned(), None),
        };
        let taken = ModelConfig::Glide(named(choice.model).1);
        Ok(Ladder::new(rungs, &taken, reason, tolerance))
    }
}

/// Largest distance between corresponding contacts.
fn distance(touches: &[FingerTouch], others: &[FingerTouch]) -> f64 {
    let pairs = touches.iter().zip(others);
    pairs
        .map(|(one, other)| (one.touch.point - other.touch.point).norm())
        .fold(0.0, f64::max)
}

/// The model's name, and its form in a config.
fn named(model: TouchModel) -> (String, GlideModelConfig) {
    match model {
        TouchModel::Auto { tolerance } => (
            format!("auto, tolerance {tolerance:e}"),
            GlideModelConfig::Auto { tolerance },
        ),
        TouchModel::ClosedForm => ("closed form".to_owned(), GlideModelConfig::ClosedForm {}),
        TouchModel::Newton { tolerance } => (
            format!("Newton's method, tolerance {tolerance:e}"),
            GlideModelConfig::Newton { tolerance },
        ),
    }
}
