//! Models that a choice is compared with, more than a ladder shows, and the truth that the errors of all of them are
//! measured against.

use anyhow::{Result, bail};
use nalgebra::Point3;
use palpate_geometry::Surface;
use palpate_press::Skin;
use palpate_rolling::{Chart, HeldAxis, Model, Roller, Rolls};
use palpate_scene::Scenes;
use palpate_scene::{GlideScene, Ladder, Rung, Scene};
use palpate_study::config::{
    self, FingertipConfig, GlideConfig, GlideModelConfig, ModelConfig, ObjectConfig, PressConfig,
    PressModelConfig, PressProbeConfig, RollModelConfig, SceneConfig, Study,
};

use super::cost;
use crate::pressed::{Body, Pressed};
use crate::touched;

/// Numbers of steps of the RK4 rivals.
const STEPS: [u32; 19] = [
    1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 32, 40, 48, 56, 64,
];
/// Negative decimal exponents of the tolerances of DOP853 and of Newton's method.
const TOLERANCES: std::ops::RangeInclusive<i32> = 1..=13;
/// Difference between two distances from the contact below which they count as one, as a share of the sensor's radius.
const SAME: f64 = 1e-9;

/// A model that could be taken.
#[derive(Debug)]
pub struct Rival {
    /// Name of the model, and its error against the truth.
    pub rung: Rung,
    /// Evaluations of the contact equations by a roll; not known of other scenes.
    pub evaluations: Option<usize>,
}

/// Models for a scene with their errors, and the index of the one that `auto` took.
pub(super) struct Rivals {
    /// All models, with the one that was taken.
    pub(super) all: Vec<Rival>,
    pub(super) taken: usize,
    /// Words for the truth that the errors are measured against.
    pub(super) truth: &'static str,
}

impl Rivals {
    pub(super) fn of(study: &Study, ladder: &Ladder) -> Result<Self> {
        match &study.config.scene {
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
    let rolls = Rolls { rolls: &rolls };
    let roller = scene.roller();
    let truth = ends(roller, TRUE_ROLL, rolls)?;
    let length = length_scale(roller)?;
    let measured = roller.measured(&models, chart, rolls);
    let rival = |rung: palpate_rolling::MeasuredRung| -> Result<Rival> {
        let found = ends(roller, rung.model, rolls).map_err(|error| format!("{error:#}"));
        Ok(Rival {
            rung: Rung {
                outcome: found.map(|found| farthest(found.iter().zip(&truth)) / length),
                model: ModelConfig::Roll(named(rung.model)?),
                name: rung.name,
            },
            evaluations: Some(rung.evaluations),
        })
    };
    Ok(Rivals {
        all: measured.into_iter().map(rival).collect::<Result<_>>()?,
        taken: models.iter().position(|model| *model == taken).unwrap_or(0),
        truth: "Montana's equations in charts",
    })
}

/// Model of the truth of rolls. It computes in the charts of both bodies, with coordinates, metrics and Christoffel
/// symbols; the rungs that are judged use a normal and a shape operator in space.
const TRUE_ROLL: Model = Model::Dop853 {
    tolerance: Model::SMALLEST_TOLERANCE,
    chart: Chart::Montana(HeldAxis::Transported),
};

/// End points of each roll on the object and on the probe.
fn ends(roller: &Roller, model: Model, rolls: Rolls<'_>) -> Result<Vec<Point3<f64>>> {
    let radius = roller.probe().radius();
    let roller = roller.on(model, rolls)?;
    let mut ends = Vec::new();
    for motions in rolls.rolls {
        let contact = roller.roll(motions)?;
        ends.extend([contact.on_object, contact.on_probe(radius)]);
    }
    Ok(ends)
}

/// How far a contact moves per radian at first, at least.
fn length_scale(roller: &Roller) -> Result<f64> {
    let first = roller.first_contact();
    let (_, curvature) = roller
        .object()
        .curvature_along(&first.on_object, &first.x_axis)?;
    let principal = curvature.principal();
    let sharpest = principal.k_min.abs().max(principal.k_max.abs());
    Ok(1.0 / (1.0 / roller.probe().radius() + sharpest))
}

/// The largest distance between two points of a pair.
fn farthest<'a>(pairs: impl Iterator<Item = (&'a Point3<f64>, &'a Point3<f64>)>) -> f64 {
    pairs.fold(0.0, |most: f64, (one, other)| {
        most.max((one - other).norm())
    })
}

/// Config of a rolling model.
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

/// Newton's method is held against the closed form or the offset surface, and the closed form against Newton's method.
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
    let follow = |model: &GlideModelConfig| -> Result<Vec<Point3<f64>>, String> {
        let config = GlideConfig {
            model: model.clone(),
            ..config.clone()
        };
        let glider = GlideScene::glider(&config).map_err(|error| error.message)?;
        let touches = GlideScene::follow(&glider, &config).map_err(|error| error.message)?;
        Ok(touches.into_iter().map(|touch| touch.point).collect())
    };
    let closed = follow(&GlideModelConfig::ClosedForm {});
    let of_newton = match true_touches(config, radius) {
        Some(touches) => ("offset surface", Ok(touches)),
        None => ("closed form", closed),
    };
    let of_closed = (
        "Newton, tolerance 1e-14",
        follow(&newton(Model::SMALLEST_TOLERANCE)),
    );
    let truth_of = |model: &GlideModelConfig| match model {
        GlideModelConfig::ClosedForm {} => &of_closed,
        _ => &of_newton,
    };
    let rival = |model: &GlideModelConfig| Rival {
        rung: Rung {
            name: match model {
                GlideModelConfig::Newton { tolerance } => {
                    format!("Newton, tolerance {tolerance:e}")
                }
                _ => "closed form".to_owned(),
            },
            outcome: follow(model).and_then(|found| {
                let truth = truth_of(model).1.as_ref().map_err(Clone::clone)?;
                Ok(farthest(found.iter().zip(truth)) / radius)
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

/// Points at which the fingers touch, finger by finger; `None` on objects for which a rung has a closed form.
fn true_touches(config: &GlideConfig, tip: f64) -> Option<Vec<Point3<f64>>> {
    let touch: Box<dyn Fn([f64; 2]) -> [f64; 3]> = match &config.object {
        &ObjectConfig::Ellipsoid { semi_axes } => {
            Box::new(move |centre| touched::on_ellipsoid(semi_axes, tip, centre))
        }
        &ObjectConfig::Paraboloid { c } => {
            Box::new(move |centre| touched::on_quadric([-c, -c], tip, centre))
        }
        &ObjectConfig::Saddle { a } => {
            Box::new(move |centre| touched::on_quadric([a, -a], tip, centre))
        }
        ObjectConfig::HeightField { parameters, .. } => {
            let waves = [*parameters.get("a")?, *parameters.get("l")?];
            Box::new(move |centre| touched::on_waves(waves, tip, centre))
        }
        _ => return None,
    };
    let motion = &config.motion;
    let contacts = motion.contacts_per_finger;
    let along =
        |contact: u32| motion.patch_length * (f64::from(contact) / f64::from(contacts - 1) - 0.5);
    let fingers = motion.finger_positions.iter();
    let centres = fingers.flat_map(|across| (0..contacts).map(move |one| [along(one), *across]));
    Some(centres.map(|centre| Point3::from(touch(centre))).collect())
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
                libm::hypot(moved.normal - normal, moved.radial - radial)
            });
            let sizes = truth
                .iter()
                .map(|[normal, radial]| libm::hypot(*normal, *radial));
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
