//! The ladder of a press, and what `auto` takes of it.

use palpate_press::{Body, MarkerDisplacement, Markers, PressError};

use super::PressScene;
use super::plan::{Pressed, body_of, disc_depths, shifted};
use crate::ladder::{Ladder, Rung};
use crate::plan::PlanError;
use palpate_study::config::{
    ModelConfig, PressConfig, PressModelConfig, PressProbeConfig, PressSensorConfig,
};

/// The model that is taken, and why.
pub(super) struct Choice {
    /// Model in the form of a config: never `auto`.
    pub(super) model: PressModelConfig,
    pub(super) reason: String,
    /// Tolerance of `auto`; `None` where the config names a model.
    pub(super) tolerance: Option<f64>,
}

/// A rung, with what it errs by or why it cannot do the press.
struct Judged {
    model: PressModelConfig,
    outcome: Result<f64, String>,
}

/// The model of a press: as named, or what `auto` takes.
pub(super) fn choice(
    config: &PressConfig,
    markers: &Markers,
    pressed: &Pressed,
) -> Result<Choice, PlanError> {
    let PressModelConfig::Auto { tolerance, .. } = config.model else {
        return Ok(Choice {
            model: config.model.clone(),
            reason: "named in the config".to_owned(),
            tolerance: None,
        });
    };
    if !(SMALLEST_TOLERANCE..=LARGEST_TOLERANCE).contains(&tolerance) {
        let message =
            format!("is {tolerance:e}; must be from {SMALLEST_TOLERANCE:e} to {LARGEST_TOLERANCE}");
        return Err(PlanError::at("scene.model.tolerance", message));
    }
    let rungs = judged(config, markers, pressed)?;
    let good = |rung: &&Judged| matches!(rung.outcome, Ok(error) if error <= tolerance);
    let taken = rungs.iter().find(good);
    let (model, reason) = match taken {
        Some(Judged { model, outcome }) if *model != config.model.reference() => {
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
            (config.model.reference(), reason)
        }
    };
    Ok(Choice {
        model,
        reason,
        tolerance: Some(tolerance),
    })
}

/// Below this a solved layer promises nothing.
const SMALLEST_TOLERANCE: f64 = 1e-9;
const LARGEST_TOLERANCE: f64 = 1.0;

/// All rungs, cheapest first; the last is what the others are held against.
fn judged(
    config: &PressConfig,
    markers: &Markers,
    pressed: &Pressed,
) -> Result<Vec<Judged>, PlanError> {
    let poisson = config.model.poisson();
    let mut models = vec![
        PressModelConfig::Hertz { poisson },
        PressModelConfig::HalfSpace { poisson },
    ];
    models.extend(
        config
            .model
            .thickness()
            .map(|thickness| PressModelConfig::BondedLayer { thickness }),
    );
    let depths = depths(config)?;
    let moved = |model: &PressModelConfig| -> Result<Moved, PlanError> {
        let PressProbeConfig::MarkerSphere { radius, .. } = config.probe;
        let mut all = Vec::new();
        for &depth in &depths {
            let body = body_of(model, radius, depth, Body::solved_layer)?;
            match displaced(model, &body, markers, depth, pressed) {
                Ok(moved) => all.extend(moved),
                Err(error) => return Ok(Err(error)),
            }
        }
        Ok(Ok(all))
    };
    let mut all = Vec::new();
    for model in models {
        all.push((moved(&model)?, model));
    }
    let reference = all
        .last()
        .map_or(Ok(Vec::new()), |(moved, _)| moved.clone());
    let held = |moved: Moved| -> Result<f64, String> {
        let fails = |error: PressError| error.to_string();
        let reference = reference.as_ref().map_err(|error| fails(*error))?;
        Ok(distance(&moved.map_err(fails)?, reference))
    };
    Ok(all
        .into_iter()
        .map(|(moved, model)| Judged {
            model,
            outcome: held(moved),
        })
        .collect())
}

type Moved = Result<Vec<MarkerDisplacement>, PressError>;

/// Depths at which displacements count: midway between the discs of a marker, and those of the discs that a camera
/// sees.
fn depths(config: &PressConfig) -> Result<Vec<f64>, PlanError> {
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    let mut depths = vec![marker_depth];
    if !matches!(config.sensor, PressSensorConfig::Direct { .. }) {
        let discs = disc_depths(&config.probe)?;
        depths.extend([discs.magenta, discs.yellow]);
    }
    Ok(depths)
}

fn displaced(
    model: &PressModelConfig,
    body: &Body,
    markers: &Markers,
    depth: f64,
    pressed: &Pressed,
) -> Moved {
    let contact = markers
        .skin()
        .contact(body, pressed.object_curvature, pressed.indentation)?;
    let mut moved = markers.displacements(&contact, pressed.at);
    shifted(model, markers, depth, contact.radius, pressed, &mut moved)?;
    Ok(moved)
}

/// The largest difference, relative to the largest displacement of the second.
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

impl PressScene {
    /// The rungs of the scene of `config`.
    pub(crate) fn ladder(&self, config: &PressConfig) -> Result<Ladder, PlanError> {
        let pressed = Pressed {
            object_curvature: self.object.curvature,
            indentation: self.indentation,
            at: self.at,
            shift: config.motion.shift,
        };
        let choice = choice(config, &self.markers, &pressed)?;
        let rungs: Vec<Rung> = judged(config, &self.markers, &pressed)?
            .into_iter()
            .map(|Judged { model, outcome }| Rung {
                name: name(&model),
                model: ModelConfig::Press(model),
                outcome,
            })
            .collect();
        let taken = ModelConfig::Press(choice.model);
        Ok(Ladder {
            taken: rungs
                .iter()
                .position(|rung| rung.model == taken)
                .expect("what is named or chosen is among the rungs"),
            reference: Some(rungs.len() - 1),
            reason: choice.reason,
            tolerance: choice.tolerance,
            rungs,
        })
    }
}

fn name(model: &PressModelConfig) -> String {
    match model {
        PressModelConfig::Auto { tolerance, .. } => format!("auto, tolerance {tolerance:e}"),
        PressModelConfig::Hertz { .. } => "Hertz contact, at the surface".to_owned(),
        PressModelConfig::HalfSpace { .. } => "half-space, at the markers' depth".to_owned(),
        PressModelConfig::BondedLayer { .. } => "bonded layer, solved".to_owned(),
    }
}
