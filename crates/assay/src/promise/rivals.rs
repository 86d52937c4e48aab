//! The models that a choice is held against, more than a ladder shows, and the truth that all of them are.

use anyhow::{Result, bail};
use palpate_press::Skin;
use palpate_rolling::{Chart, Model, Rolls, Touch};
use palpate_scene::config::{
    self, FingertipConfig, GlideConfig, GlideModelConfig, ModelConfig, PressConfig,
    PressModelConfig, PressProbeConfig, RollModelConfig, SceneConfig, Study,
};
use palpate_scene::{GlideScene, Ladder, Rung, Scene};

use super::cost;
use crate::pressed::{Body, Pressed};

/// Of RK4.
const STEPS: [u32; 19] = [
    1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 32, 40, 48, 56, 64,
];
/// Of DOP853 and of Newton's method, the negative exponents.
const TOLERANCES: std::ops::RangeInclusive<i32> = 1..=13;
/// Closer markers lie at the same distance, as a share of the sensor's radius.
const SAME: f64 = 1e-9;

/// A model that could be taken.
#[derive(Debug)]
pub struct Rival {
    /// Its name, and what it errs by against the truth.
    pub rung: Rung,
    /// How often a roll evaluates the contact equations; of others not known.
    pub evaluations: Option<usize>,
}

/// What a choice is held against.
pub(super) struct Rivals {
    /// The rung that is taken is among them.
    pub(super) all: Vec<Rival>,
    pub(super) taken: usize,
    /// What the rung that is taken is held against.
    pub(super) truth: &'static str,
}

impl Rivals {
    pub(super) fn of(study: &Study, ladder: &Ladder) -> Result<Self> {
        match &study.cells[0].config.scene {
            SceneConfig::Roll(_) => of_roll(study),
            SceneConfig::Glide(config) => of_glide(config, ladder),
            SceneConfig::Press(config) => of_press(config, ladder),
            SceneConfig::Fingertip(_) => bail!("it touches nothing"),
        }
    }
}

fn of_roll(study: &Study) -> Result<Rivals> {
    let Scene::Roll(scene) = study.scene(0)? else {
        bail!("no roll");
    };
    let chart = Chart::Free;
    let mut models = vec![Model::ClosedForm, Model::Meridian];
    models.extend(STEPS.map(|steps| Model::Rk4 {
        steps: steps as usize,
        chart,
    }));
    models.extend(TOLERANCES.map(|exponent| Model::Dop853 {
        tolerance: 10_f64.powi(-exponent),
        chart,
    }));
    let taken = scene.roller().choice().model;
    if !models.contains(&taken) {
        models.push(taken);
    }
    let rolls = scene.noiseless();
    let measured = scene
        .roller()
        .measured(&models, chart, Rolls { rolls: &rolls });
    let rival = |rung: palpate_rolling::MeasuredRung| -> Result<Rival> {
        Ok(Rival {
            rung: Rung {
                model: ModelConfig::Roll(named(rung.model)?),
                name: rung.name,
                outcome: rung.outcome,
            },
            evaluations: Some(rung.evaluations),
        })
    };
    Ok(Rivals {
        all: measured.into_iter().map(rival).collect::<Result<_>>()?,
        taken: models.iter().position(|model| *model == taken).unwrap_or(0),
        truth: "DOP853, tolerance 1e-14",
    })
}

/// As it stands in a config.
fn named(model: Model) -> Result<RollModelConfig> {
    let chart = config::Chart::Free;
    Ok(match model {
        Model::ClosedForm => RollModelConfig::ClosedForm {},
        Model::Meridian => RollModelConfig::Meridian {},
        Model::Rk4 { steps, .. } => RollModelConfig::Rk4 {
            steps: u32::try_from(steps)?,
            chart,
        },
        Model::Dop853 { tolerance, .. } => RollModelConfig::Dop853 { tolerance, chart },
        Model::Auto { .. } => bail!("auto is no rung"),
    })
}

/// A closed form and Newton's method are each held against the other, where there is a closed form.
fn of_glide(config: &GlideConfig, ladder: &Ladder) -> Result<Rivals> {
    let newton = |tolerance| GlideModelConfig::Newton { tolerance };
    let mut models = vec![GlideModelConfig::ClosedForm {}];
    models.extend(TOLERANCES.map(|exponent| newton(10_f64.powi(-exponent))));
    let ModelConfig::Glide(taken) = &ladder.taken().model else {
        bail!("no glide");
    };
    if !models.contains(taken) {
        models.push(taken.clone());
    }
    let FingertipConfig::Sphere { radius } = config.probe else {
        bail!("a point touches where it is held");
    };
    let follow = |model: &GlideModelConfig| -> Result<Vec<Touch>, String> {
        let config = GlideConfig {
            model: model.clone(),
            ..config.clone()
        };
        let glider = GlideScene::glider(&config).map_err(|error| error.message)?;
        GlideScene::follow(&glider, &config).map_err(|error| error.message)
    };
    let closed = follow(&GlideModelConfig::ClosedForm {});
    let finest = follow(&newton(Model::SMALLEST_TOLERANCE));
    let truth_of = |model: &GlideModelConfig| match (model, &closed) {
        (GlideModelConfig::ClosedForm {}, _) | (_, Err(_)) => ("Newton, tolerance 1e-14", &finest),
        (_, Ok(_)) => ("closed form", &closed),
    };
    let rival = |model: &GlideModelConfig| Rival {
        rung: Rung {
            name: match model {
                GlideModelConfig::Newton { tolerance } => {
                    format!("Newton, tolerance {tolerance:e}")
                }
                _ => "closed form".to_owned(),
            },
            outcome: follow(model).and_then(|touches| {
                let truth = truth_of(model).1.as_ref().map_err(Clone::clone)?;
                Ok(distance(&touches, truth) / radius)
            }),
            model: ModelConfig::Glide(model.clone()),
        },
        evaluations: None,
    };
    Ok(Rivals {
        all: models.iter().map(rival).collect(),
        taken: models.iter().position(|model| model == taken).unwrap_or(0),
        truth: truth_of(taken).0,
    })
}

/// The largest distance between contacts.
fn distance(touches: &[Touch], others: &[Touch]) -> f64 {
    let pairs = touches.iter().zip(others);
    let distances = pairs.map(|(one, other)| (one.point - other.point).norm());
    distances.fold(0.0, f64::max)
}

/// All rungs, Hertz's and the layer among them, are held against a quadrature.
fn of_press(config: &PressConfig, ladder: &Ladder) -> Result<Rivals> {
    let PressProbeConfig::MarkerSphere {
        radius,
        marker_depth,
        ..
    } = config.probe;
    let body = match config.model {
        PressModelConfig::Auto {
            thickness: Some(thickness),
            ..
        } => Body::Layer { thickness },
        PressModelConfig::Auto { poisson, .. } => Body::HalfSpace { poisson },
        _ => bail!("the model is named"),
    };
    let distances = distances(config)?;
    let object_curvature = cost::curvature(config);
    let indentation = config.motion.indentation;
    let truth = Pressed::new(body, radius.recip() + object_curvature, indentation)?;
    let truth = truth.displacements(marker_depth, &distances)?;
    let rival = |rung: &Rung| -> Result<Rival> {
        let ModelConfig::Press(model) = &rung.model else {
            bail!("no press");
        };
        let body = cost::body(config, model)?;
        let contact = Skin::new(radius)?.contact(&body, object_curvature, indentation);
        let outcome = contact.map_err(|error| error.to_string()).map(|contact| {
            let moved = distances.iter().map(|r| contact.displacement(*r));
            let pairs = truth.iter().zip(moved);
            let off = pairs.map(|([normal, radial], moved)| {
                (moved.normal - normal).hypot(moved.radial - radial)
            });
            let sizes = truth.iter().map(|[normal, radial]| normal.hypot(*radial));
            off.fold(0.0, f64::max) / sizes.fold(0.0, f64::max)
        });
        Ok(Rival {
            rung: Rung {
                outcome,
                ..rung.clone()
            },
            evaluations: None,
        })
    };
    Ok(Rivals {
        all: ladder.rungs.iter().map(rival).collect::<Result<_>>()?,
        taken: ladder.taken,
        truth: "quadrature",
    })
}

/// How far the markers lie from the contact: each distance once.
fn distances(config: &PressConfig) -> Result<Vec<f64>> {
    let markers = cost::markers(config)?;
    let mut distances = markers.distances([0.0; 2]);
    let same = SAME * markers.skin().radius();
    distances.sort_unstable_by(f64::total_cmp);
    distances.dedup_by(|one, other| (*one - *other).abs() <= same);
    Ok(distances)
}
