//! The ladder of roll models, that is, the list of roll models that are compared.

use std::cell::OnceCell;
use std::f64::consts::FRAC_PI_6;
use std::rc::Rc;

use anyhow::{Result, ensure};
use palpate_geometry::{Ellipsoid, Graph, Shape, Sphere};
use palpate_rolling::{Chart, Contact, HeldAxis, Model, Motion, Roller, Rolls};

use super::ladder::{Ease, Ladder, Rung, SceneRungs};
use super::scene_trials::at_least_rounding;
use crate::contact_reference::RollEnd;

const STEPS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
const TOLERANCES: [i32; 6] = [-3, -5, -7, -9, -11, -13];
const RADIUS: f64 = 1.0;
const BALL: f64 = 5.0;
/// Coefficient c of the paraboloid z = −c r².
const PARABOLOID: f64 = 0.2;
/// Largest allowed difference between two independent references for the same roll, relative to the length of the
/// contact's path.
const MAX_DIFFERENCE: f64 = 1e-12;
/// Direction in which the contact moves at the start of the roll, rad.
const DIRECTION: f64 = FRAC_PI_6;

struct Roll {
    ease: Ease,
    scene: &'static str,
    object: Shape,
    at: (f64, f64),
    angle: f64,
    truth: fn(&Roll) -> Result<RollEnd>,
    /// The true contact at the end of the roll, computed at its first use.
    end: OnceCell<RollEnd>,
}

pub(super) fn ladder() -> Result<Ladder> {
    let rolls = [
        Roll {
            ease: Ease::Easy,
            scene: "roll by 0.1 rad on a ball whose radius is 5 probe radii",
            object: Shape::Sphere(Sphere::new(BALL)?),
            at: (0.0, 0.0),
            angle: 0.1,
            truth: |roll| Ok(RollEnd::on_ball(BALL, DIRECTION, roll.angle)),
            end: OnceCell::new(),
        },
        Roll {
            ease: Ease::Typical,
            scene: "roll by 1 rad from the apex of the paraboloid z = −0.2 r²",
            object: Shape::Paraboloid(Graph::paraboloid(PARABOLOID)?),
            at: (0.0, 0.0),
            angle: 1.0,
            truth: |roll| Ok(RollEnd::on_paraboloid(PARABOLOID, DIRECTION, roll.angle)),
            end: OnceCell::new(),
        },
        Roll {
            ease: Ease::Hard,
            scene: "roll by 6 rad round an ellipsoid with the semi-axes 4, 3, 2",
            object: Shape::Ellipsoid(Ellipsoid::new([4.0, 3.0, 2.0])?),
            at: (1.0, 0.5),
            angle: 6.0,
            truth: in_charts,
            end: OnceCell::new(),
        },
    ];
    Ok(Ladder {
        name: "rolling",
        title: "What does a roll cost?",
        error: "distance of the contact from its true place, over its path; true: closed forms, on the ellipsoid RK4 in \
                charts, extrapolated",
        evaluation: "one roll",
        scenes: rolls.into_iter().map(Roll::stage).collect(),
    })
}

impl Roll {
    fn stage(self) -> SceneRungs {
        let roll = Rc::new(self);
        let rungs = models()
            .into_iter()
            .filter_map(|(name, setting, model)| {
                let roller = roll.roller(model).ok()?;
                let motion = roll.motion();
                // Some models compute the contact in a chart of the object. Skip such a model if the contact leaves the
                // chart before the end of the roll.
                roller.roll(&[motion]).ok()?;
                let (same, errs) = (Rc::clone(&roll), roller.clone());
                let rung = Rung::new(
                    name,
                    move || same.error(&errs),
                    move || roller.roll(&[motion]),
                );
                Some(rung.set(setting))
            })
            .collect();
        SceneRungs::new(roll.ease, roll.scene, rungs)
    }

    fn motion(&self) -> Motion {
        Motion::rolling(DIRECTION, 1.0, self.angle)
    }

    fn roller(&self, model: Model) -> Result<Roller> {
        let rolls = [vec![self.motion()]];
        let rolls = Rolls::exact(&rolls);
        let probe = Sphere::new(RADIUS)?;
        Ok(Roller::new(
            probe,
            self.object.clone(),
            self.at,
            model,
            rolls,
        )?)
    }

    fn error(&self, roller: &Roller) -> Result<f64> {
        let truth = match self.end.get() {
            Some(truth) => truth,
            None => {
                let truth = (self.truth)(self)?;
                self.end.get_or_init(|| truth)
            }
        };
        let end = roller.roll(&[self.motion()])?;
        let off_object = (end.on_object - truth.on_object).norm();
        let off_probe = (end.on_probe(RADIUS) - truth.on_probe).norm();
        at_least_rounding(off_object.max(off_probe) / truth.path)
    }
}

fn models() -> Vec<(String, Option<f64>, Model)> {
    let charts = [
        ("", Chart::Free),
        (", Montana", Chart::Montana(HeldAxis::Transported)),
    ];
    let mut models = vec![
        ("closed form".to_owned(), None, Model::ClosedForm),
        ("meridian".to_owned(), None, Model::Meridian),
    ];
    for (suffix, chart) in charts {
        models.extend(STEPS.map(|steps| {
            let name = format!("RK4 × {steps}{suffix}");
            (name, Some(steps as f64), Model::Rk4 { steps, chart })
        }));
        models.extend(TOLERANCES.map(|exponent| {
            let name = format!("DOP853 1e{exponent}{suffix}");
            let tolerance = 10_f64.powi(exponent);
            (name, Some(tolerance), Model::Dop853 { tolerance, chart })
        }));
    }
    models
}

/// Reference for rolls on objects without a closed-form solution: RK4 on Montana's equations in the charts of both
/// surfaces, with Richardson extrapolation from two numbers of steps. The reference is independent, because the
/// compared models use other equations, without charts. As a check, the integrator DOP853 on Montana's equations must
/// agree with the reference.
fn in_charts(roll: &Roll) -> Result<RollEnd> {
    const STEPS: usize = 3000;
    let chart = Chart::Montana(HeldAxis::Transported);
    let end = |model: Model| -> Result<Contact> { Ok(roll.roller(model)?.roll(&[roll.motion()])?) };
    let coarse = end(Model::Rk4 {
        steps: STEPS,
        chart,
    })?;
    let fine = end(Model::Rk4 {
        steps: 2 * STEPS,
        chart,
    })?;
    let adaptive = end(Model::Dop853 {
        tolerance: Model::SMALLEST_TOLERANCE,
        chart,
    })?;
    let on_object = fine.on_object + (fine.on_object - coarse.on_object) / 15.0;
    let on_probe = |contact: &Contact| contact.on_probe(RADIUS);
    let extrapolated = on_probe(&fine) + (on_probe(&fine) - on_probe(&coarse)) / 15.0;
    let off_object = (adaptive.on_object - on_object).norm();
    let off_probe = (on_probe(&adaptive) - extrapolated).norm();
    let off = off_object.max(off_probe) / fine.arc_length;
    ensure!(off < MAX_DIFFERENCE, "the references differ by {off:e}");
    Ok(RollEnd {
        on_object,
        on_probe: extrapolated,
        path: fine.arc_length,
    })
}
