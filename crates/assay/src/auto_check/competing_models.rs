//! Models that `auto` could have chosen, and their errors relative to independent references. Each method appears with
//! more settings than in the list that `palpate check` prints.

use anyhow::{Result, bail};
use nalgebra::Point3;
use palpate_chromatouch::Layout;
use palpate_geometry::Surface;
use palpate_press::{self as press, Markers, Skin};
use palpate_rolling::{Chart, HeldAxis, Model, Roller, Rolls};
use palpate_scene::{GlideScene, Ladder, Rung, Scene, Scenes};
use palpate_study::config::{
    self, FingertipConfig, GlideConfig, GlideModelConfig, ModelConfig, ObjectConfig, PressConfig,
    PressModelConfig, PressObjectConfig, PressProbeConfig, RollModelConfig, SceneConfig, Study,
};

use crate::contact_reference::{tip_on_ellipsoid, tip_on_quadric, tip_on_waves};
use crate::paraboloid_reference::{Body, ParaboloidPress};

/// Numbers of steps of the competing RK4 models.
const STEPS: [u32; 19] = [
    1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 32, 40, 48, 56, 64,
];
/// Tolerances of the competing models DOP853 and Newton's method, as negative decimal exponents: 1 means a tolerance of
/// 0.1.
const TOLERANCES: std::ops::RangeInclusive<i32> = 1..=13;
/// Two markers count as equally far from the contact if their distances differ by less than this share of the sensor's
/// radius.
const DISTANCE_TOLERANCE: f64 = 1e-9;

/// A model that `auto` could have chosen for a scene.
#[derive(Debug)]
pub struct CompetingModel {
    /// The model: its name, its config and its error.
    pub rung: Rung,
    /// Number of evaluations of the contact equations in a roll; `None` for other scenes.
    pub evaluations: Option<usize>,
}

/// All models for a scene, and the index of the model that `auto` chose.
pub(super) struct CompetingModels {
    pub(super) all: Vec<CompetingModel>,
    pub(super) taken: usize,
    pub(super) truth: &'static str,
}

impl CompetingModels {
    pub(super) fn new(study: &Study, ladder: &Ladder) -> Result<Self> {
        match &study.config.scene {
            SceneConfig::Roll(_) => roll_models(study),
            SceneConfig::Glide(config) => glide_models(config, ladder),
            SceneConfig::Press(config) => press_models(config, ladder),
            SceneConfig::Fingertip(_) => bail!("the scene has no contact"),
        }
    }
}

fn roll_models(study: &Study) -> Result<CompetingModels> {
    let Scene::Roll(scene) = study.scene(0)? else {
        bail!("the scene is not a roll");
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
    let taken = scene.roller.choice().model;
    if !models.contains(&taken) {
        models.push(taken);
    }
    let rolls = scene.noiseless();
    let rolls = Rolls::exact(&rolls);
    let roller = &scene.roller;
    let truth = ends(roller, TRUE_ROLL, rolls)?;
    let length = length_scale(roller)?;
    let measured = roller.measure(&models, chart, rolls);
    let competing = |rung: palpate_rolling::MeasuredRung| -> Result<CompetingModel> {
        let found = ends(roller, rung.model, rolls).map_err(|error| format!("{error:#}"));
        Ok(CompetingModel {
            rung: Rung {
                accuracy: found
                    .map(|found| farthest(found.iter().zip(&truth)) / length)
                    .into(),
                model: ModelConfig::Roll(named(rung.model)?),
                name: rung.name,
            },
            evaluations: Some(rung.evaluations),
        })
    };
    Ok(CompetingModels {
        all: measured.into_iter().map(competing).collect::<Result<_>>()?,
        taken: models.iter().position(|model| *model == taken).unwrap_or(0),
        truth: "Montana's equations in charts",
    })
}

/// Reference for rolls: Montana's equations in the charts of both bodies, with coordinates, metrics and Christoffel
/// symbols. It is independent, because the competing models use a normal and a shape operator in 3D instead of charts.
const TRUE_ROLL: Model = Model::Dop853 {
    tolerance: Model::SMALLEST_TOLERANCE,
    chart: Chart::Montana(HeldAxis::Transported),
};

/// Contact points at the end of each roll: first the point on the object, then the point on the probe.
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

/// Length scale of a roll: 1/(1/R + k), where R is the radius of the probe, and k the largest magnitude of the object's
/// curvature at the first contact. On a convex object, the contact moves at least this distance per radian of rolling.
fn length_scale(roller: &Roller) -> Result<f64> {
    let first = roller.first_contact();
    let (_, curvature) = roller
        .object()
        .curvature_along(&first.on_object, &first.x_axis)?;
    let principal = curvature.principal();
    let sharpest = principal.k_min.abs().max(principal.k_max.abs());
    Ok(1.0 / (1.0 / roller.probe().radius() + sharpest))
}

fn farthest<'a>(pairs: impl Iterator<Item = (&'a Point3<f64>, &'a Point3<f64>)>) -> f64 {
    pairs.fold(0.0, |most: f64, (one, other)| {
        most.max((one - other).norm())
    })
}

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
        Model::Auto { .. } => bail!("auto is not a rung"),
    })
}

/// Models of a glide, with their errors. If the model `closed-form` can compute the contacts with the object, this
/// model and Newton's method are references for each other. For other objects, the reference is the solution on the
/// offset surface, on which the centre of the fingertip moves while the tip touches the object.
fn glide_models(config: &GlideConfig, ladder: &Ladder) -> Result<CompetingModels> {
    let newton = |tolerance| GlideModelConfig::Newton { tolerance };
    let mut models = vec![GlideModelConfig::ClosedForm {}];
    models.extend(TOLERANCES.map(|exponent| newton(10_f64.powi(-exponent))));
    let ModelConfig::Glide(taken) = &ladder.taken().model else {
        bail!("the model is not one of a glide");
    };
    if !models.contains(taken) {
        models.push(taken.clone());
    }
    let FingertipConfig::Sphere { radius } = config.probe else {
        bail!("a pointed tip has no contact to compute");
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
    let newton_reference = match true_touches(config, radius) {
        Some(touches) => ("offset surface", Ok(touches)),
        None => ("closed form", closed),
    };
    let closed_reference = (
        "Newton, tolerance 1e-14",
        follow(&newton(Model::SMALLEST_TOLERANCE)),
    );
    let truth_of = |model: &GlideModelConfig| match model {
        GlideModelConfig::ClosedForm {} => &closed_reference,
        _ => &newton_reference,
    };
    let competing = |model: &GlideModelConfig| CompetingModel {
        rung: Rung {
            name: match model {
                GlideModelConfig::Newton { tolerance } => {
                    format!("Newton, tolerance {tolerance:e}")
                }
                _ => "closed form".to_owned(),
            },
            accuracy: follow(model)
                .and_then(|found| {
                    let truth = truth_of(model).1.as_ref().map_err(Clone::clone)?;
                    Ok(farthest(found.iter().zip(truth)) / radius)
                })
                .into(),
            model: ModelConfig::Glide(model.clone()),
        },
        evaluations: None,
    };
    Ok(CompetingModels {
        all: models.iter().map(competing).collect(),
        taken: models.iter().position(|model| model == taken).unwrap_or(0),
        truth: truth_of(taken).0,
    })
}

/// Contacts of all fingers, computed on the offset surface, on which the centre of a fingertip moves while the tip
/// touches the object. `None` for objects whose contacts the model `closed-form` can compute.
fn true_touches(config: &GlideConfig, tip: f64) -> Option<Vec<Point3<f64>>> {
    let touch: Box<dyn Fn([f64; 2]) -> [f64; 3]> = match &config.object {
        &ObjectConfig::Ellipsoid { semi_axes } => {
            Box::new(move |centre| tip_on_ellipsoid(semi_axes, tip, centre))
        }
        &ObjectConfig::Paraboloid { c } => {
            Box::new(move |centre| tip_on_quadric([-c, -c], tip, centre))
        }
        &ObjectConfig::Saddle { a } => Box::new(move |centre| tip_on_quadric([a, -a], tip, centre)),
        ObjectConfig::HeightField { parameters, .. } => {
            let waves = [*parameters.get("a")?, *parameters.get("l")?];
            Box::new(move |centre| tip_on_waves(waves, tip, centre))
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

/// Models of a press, with their errors. The reference is a quadrature over wavenumbers.
fn press_models(config: &PressConfig, ladder: &Ladder) -> Result<CompetingModels> {
    let PressProbeConfig::MarkerSphere {
        radius,
        marker_depth,
        ..
    } = config.probe;
    let reference = match config.model {
        PressModelConfig::Auto {
            thickness: Some(thickness),
            ..
        } => Body::Layer { thickness },
        PressModelConfig::Auto { poisson, .. } => Body::HalfSpace { poisson },
        _ => bail!("the model is not auto"),
    };
    let distances = distances(config)?;
    let object_curvature = curvature(config)?;
    let indentation = config.motion.indentation;
    let truth = ParaboloidPress::new(reference, radius.recip() + object_curvature, indentation)?;
    let truth = truth.displacements(marker_depth, &distances)?;
    let competing = |rung: &Rung| -> Result<CompetingModel> {
        let ModelConfig::Press(model) = &rung.model else {
            bail!("the model is not one of a press");
        };
        let body = body(config, model)?;
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
        Ok(CompetingModel {
            rung: Rung {
                accuracy: outcome.into(),
                ..rung.clone()
            },
            evaluations: None,
        })
    };
    Ok(CompetingModels {
        all: ladder.rungs.iter().map(competing).collect::<Result<_>>()?,
        taken: ladder.taken,
        truth: "quadrature",
    })
}

fn distances(config: &PressConfig) -> Result<Vec<f64>> {
    let markers = markers(config)?;
    let mut distances = markers.distances([0.0; 2]);
    let same = DISTANCE_TOLERANCE * markers.skin().radius();
    distances.sort_unstable_by(f64::total_cmp);
    distances.dedup_by(|one, other| (*one - *other).abs() <= same);
    Ok(distances)
}

pub(super) fn body(config: &PressConfig, model: &PressModelConfig) -> Result<press::Body> {
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    Ok(match *model {
        PressModelConfig::Hertz { poisson, .. } => press::Body::half_space(poisson, 0.0)?,
        PressModelConfig::HalfSpace { poisson, .. } => {
            press::Body::half_space(poisson, marker_depth)?
        }
        PressModelConfig::BondedLayer { thickness, .. } => {
            press::Body::solved_layer(thickness, marker_depth)?
        }
        PressModelConfig::Auto { .. } => bail!("auto is not a rung"),
    })
}

/// Curvature of the pressed object. An error if the object is not round, that is, has two different curvatures.
pub(super) fn curvature(config: &PressConfig) -> Result<f64> {
    Ok(match config.object {
        PressObjectConfig::Sphere { radius } => radius.recip(),
        PressObjectConfig::Dish { radius } => -radius.recip(),
        PressObjectConfig::Plane {} => 0.0,
        PressObjectConfig::Cylinder { .. } | PressObjectConfig::Ellipsoid { .. } => {
            bail!("only presses on round objects are compared")
        }
    })
}

/// Markers in the layout of the 2020 paper's sensor, under a skin with the radius in the config.
pub(super) fn markers(config: &PressConfig) -> Result<Markers> {
    let PressProbeConfig::MarkerSphere { radius, .. } = config.probe;
    let places = Layout::published().places(radius)?;
    Ok(Markers::new(Skin::new(radius)?, &places)?)
}
