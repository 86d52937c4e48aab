//! The ladder of gliding: a list of compared models that find the contact of a round tip.

use anyhow::{Context, Result};
use nalgebra::Point3;
use palpate_geometry::{Ellipsoid, Graph, Shape, Sphere};
use palpate_rolling::{Fingertip, Glider, TouchModel};

use super::ladder::{Ease, Ladder, Rung, SceneRungs};
use super::scene_trials::at_least_rounding;
use crate::contact_reference::{tip_on_ball, tip_on_ellipsoid, tip_on_quadric};

/// Compared tolerances of Newton's method, as decimal exponents: −3 means a tolerance of 0.001.
const TOLERANCES: [i32; 7] = [-1, -2, -3, -5, -7, -10, -13];
const PLACES: u32 = 32;
const BALL: f64 = 5.0;
/// Coefficient a of the saddle z = a (x² − y²).
const SADDLE: f64 = 0.1;
/// Semi-axes of the ellipsoid. The radius of curvature at its sharp end is 0.2.
const SEMI_AXES: [f64; 3] = [5.0, 1.0, 1.0];

/// A straight path of a finger over an object.
#[derive(Clone, Copy)]
struct Path {
    ease: Ease,
    scene: &'static str,
    object: fn() -> Result<Shape>,
    tip_radius: f64,
    /// Positions of the fingertip's centre at both ends of the path, in the xy plane.
    ends: [[f64; 2]; 2],
    /// Computes the true contact point (x, y, z) of a spherical tip. The tip has the radius `tip_radius`, and its
    /// centre is at the position `centre` in the xy plane.
    truth: fn(tip_radius: f64, centre: [f64; 2]) -> [f64; 3],
}

const PATHS: [Path; 3] = [
    Path {
        ease: Ease::Easy,
        scene: "a round tip of radius 1 on a ball of radius 5",
        object: || Ok(Shape::Sphere(Sphere::new(BALL)?)),
        tip_radius: 1.0,
        ends: [[-2.0, 0.5], [2.0, 0.5]],
        truth: |tip, centre| tip_on_ball(BALL, tip, centre),
    },
    Path {
        ease: Ease::Typical,
        scene: "a round tip of radius 0.5 on the saddle z = 0.1 (x² − y²)",
        object: || Ok(Shape::Saddle(Graph::saddle(SADDLE)?)),
        tip_radius: 0.5,
        ends: [[-1.5, -1.0], [1.5, 1.0]],
        truth: |tip, centre| tip_on_quadric([SADDLE, -SADDLE], tip, centre),
    },
    Path {
        ease: Ease::Hard,
        scene: "a round tip of radius 1 on the sharp end of an ellipsoid with the semi-axes 5, 1, 1",
        object: || Ok(Shape::Ellipsoid(Ellipsoid::new(SEMI_AXES)?)),
        tip_radius: 1.0,
        ends: [[4.5, 0.2], [5.7, 0.2]],
        truth: |tip, centre| tip_on_ellipsoid(SEMI_AXES, tip, centre),
    },
];

pub(super) fn ladder() -> Ladder {
    Ladder {
        name: "gliding",
        title: "What does it cost to compute the contact point of a round tip?",
        error: "largest distance of a contact from its true place, over the tip's radius; true: closed form of the \
                offset surface, with one number found by bisection",
        evaluation: "one contact",
        scenes: PATHS.iter().map(Path::stage).collect(),
    }
}

impl Path {
    fn stage(&self) -> SceneRungs {
        let mut models = vec![("closed form".to_owned(), None, TouchModel::ClosedForm)];
        models.extend(TOLERANCES.map(|exponent| {
            let tolerance = 10_f64.powi(exponent);
            let name = format!("Newton 1e{exponent}");
            (name, Some(tolerance), TouchModel::Newton { tolerance })
        }));
        let rungs = models.into_iter().filter_map(|(name, setting, model)| {
            // Skip the model `ClosedForm` if the tip's contact with this object has no closed-form solution.
            let glider = self.glider(model).ok()?;
            let (path, errs) = (*self, glider.clone());
            let rung = Rung::new(
                name,
                move || path.error(&errs),
                move || path.follow(&glider),
            );
            Some(rung.evaluations_per_run(PLACES).set(setting))
        });
        SceneRungs::new(self.ease, self.scene, rungs.collect())
    }

    fn glider(&self, model: TouchModel) -> Result<Glider> {
        let radius = self.tip_radius;
        let glider = Glider::new((self.object)()?, Fingertip::Sphere { radius })?;
        Ok(glider.on(model)?)
    }

    fn centres(self) -> impl Iterator<Item = [f64; 2]> {
        let [from, to] = self.ends;
        (0..PLACES).map(move |at| {
            let share = f64::from(at) / f64::from(PLACES - 1);
            [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
        })
    }

    fn follow(self, glider: &Glider) -> Result<Vec<Point3<f64>>> {
        let touch = |[x, y]: [f64; 2]| glider.touch(x, y).map(|touch| touch.point);
        let points: Result<Vec<_>, _> = self.centres().map(touch).collect();
        points.context("the finger loses the object")
    }

    fn error(self, glider: &Glider) -> Result<f64> {
        let found = self.follow(glider)?;
        let pairs = found.iter().zip(self.centres());
        let off = pairs.fold(0.0, |most: f64, (found, centre)| {
            let truth = Point3::from((self.truth)(self.tip_radius, centre));
            most.max((found - truth).norm())
        });
        at_least_rounding(off / self.tip_radius)
    }
}
