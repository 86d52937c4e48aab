//! Rungs of a glide: how the contact of a round tip is found.

use anyhow::{Context, Result};
use nalgebra::Point3;
use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Ellipsoid, Graph, Sphere};
use palpate_rolling::{Fingertip, Glider, TouchModel};

use super::ladder::{Ease, Ladder, Rung, SceneRungs};
use super::trials::at_least_rounding;

/// Of Newton's method.
const TOLERANCES: [i32; 7] = [-1, -2, -3, -5, -7, -10, -13];
/// Along a finger's path.
const PLACES: u32 = 32;
const BALL: f64 = 5.0;
const SADDLE: f64 = 0.1;
/// Its sharp end has a radius of 0.2.
const SEMI_AXES: [f64; 3] = [5.0, 1.0, 1.0];

/// A finger's path over an object, from one place of the tip's centre to another.
#[derive(Clone, Copy)]
struct Path {
    ease: Ease,
    scene: &'static str,
    object: fn() -> Result<Shape>,
    tip_radius: f64,
    ends: [[f64; 2]; 2],
    /// The contact below a place of the tip's centre.
    truth: fn(tip_radius: f64, centre: [f64; 2]) -> [f64; 3],
}

const PATHS: [Path; 3] = [
    Path {
        ease: Ease::Easy,
        scene: "round tip of 1 over a ball of 5",
        object: || Ok(Shape::Sphere(Sphere::new(BALL)?)),
        tip_radius: 1.0,
        ends: [[-2.0, 0.5], [2.0, 0.5]],
        truth: on_ball,
    },
    Path {
        ease: Ease::Typical,
        scene: "round tip of 0.5 over the saddle z = 0.1 (x² − y²)",
        object: || Ok(Shape::Saddle(Graph::saddle(SADDLE)?)),
        tip_radius: 0.5,
        ends: [[-1.5, -1.0], [1.5, 1.0]],
        truth: on_saddle,
    },
    Path {
        ease: Ease::Hard,
        scene: "round tip of 1 over the sharp end of an ellipsoid of semi-axes 5, 1, 1",
        object: || Ok(Shape::Ellipsoid(Ellipsoid::new(SEMI_AXES)?)),
        tip_radius: 1.0,
        ends: [[4.5, 0.2], [5.7, 0.2]],
        truth: on_ellipsoid,
    },
];

pub(super) fn ladder() -> Ladder {
    Ladder {
        name: "gliding",
        title: "How to find where a round tip touches?",
        error: "largest distance of a contact from its true place, over the tip's radius; true: the offset surface in \
                closed form, but for one number that is bisected",
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
            // Not every object has a closed form.
            let glider = self.glider(model).ok()?;
            let (path, errs) = (*self, glider.clone());
            let rung = Rung::new(
                name,
                move || path.error(&errs),
                move || path.follow(&glider),
            );
            Some(rung.in_a_row(PLACES).set(setting))
        });
        SceneRungs {
            ease: self.ease,
            scene: self.scene.to_owned(),
            rungs: rungs.collect(),
        }
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

fn on_ball(tip_radius: f64, centre: [f64; 2]) -> [f64; 3] {
    let [x, y] = centre.map(|part| part * BALL / (BALL + tip_radius));
    [x, y, (BALL * BALL - x * x - y * y).sqrt()]
}

/// With s = √(1 + 4a²(x² + y²)) the tip's centre is x (1 − 2ar/s), y (1 + 2ar/s) from the contact's x and y; which s it is
/// is bisected.
fn on_saddle(tip_radius: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let at = |s: f64| {
        let aside = 2.0 * SADDLE * tip_radius / s;
        [x / (1.0 - aside), y / (1.0 + aside)]
    };
    let is_less = |s: f64| {
        let [x, y] = at(s);
        s * s < 1.0 + 4.0 * SADDLE * SADDLE * (x * x + y * y)
    };
    let [x, y] = at(bisected(1.0, 100.0, is_less));
    [x, y, SADDLE * (x * x - y * y)]
}

/// With g = |(x/a², y/b², z/c²)| the tip's centre is x (1 + r/(g a²)) and so on; which g it is is bisected.
fn on_ellipsoid(tip_radius: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let squares = SEMI_AXES.map(|axis| axis * axis);
    let at = |g: f64| {
        let shrunk = |part: f64, square: f64| part / (1.0 + tip_radius / (g * square));
        let [x, y] = [shrunk(x, squares[0]), shrunk(y, squares[1])];
        let height = 1.0 - x * x / squares[0] - y * y / squares[1];
        // The larger g, the farther out.
        (height >= 0.0).then(|| [x, y, (height * squares[2]).sqrt()])
    };
    let is_less = |g: f64| {
        at(g).is_some_and(|point| {
            let parts = [0, 1, 2].map(|axis| point[axis] / squares[axis]);
            g * g < parts.iter().map(|part| part * part).sum()
        })
    };
    // g lies between the reciprocals of the longest and the shortest axis.
    let [long, short] = [SEMI_AXES[0], SEMI_AXES[2]];
    at(bisected(long.recip(), short.recip(), is_less)).unwrap_or([f64::NAN; 3])
}

/// The number below which something holds, to the last bit, from below.
fn bisected(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while let middle = 0.5 * (low + high)
        && low < middle
        && middle < high
    {
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn true_contacts_lie_a_tip_radius_below_the_centre() {
        // On the object, with the centre along its normal.
        for path in PATHS {
            let r = path.tip_radius;
            for [x, y] in path.centres() {
                let [px, py, pz] = (path.truth)(r, [x, y]);
                let gradient = match path.ease {
                    Ease::Easy => [px, py, pz],
                    Ease::Typical => [-2.0 * SADDLE * px, 2.0 * SADDLE * py, 1.0],
                    Ease::Hard => [px / 25.0, py, pz],
                };
                let size = gradient.iter().map(|part| part * part).sum::<f64>().sqrt();
                let off = (px + r * gradient[0] / size - x).hypot(py + r * gradient[1] / size - y);
                assert!(off < 1e-14, "{x} {y}: {off:e}");
            }
        }
    }

    #[test]
    fn the_finest_rung_errs_by_rounding() {
        for stage in ladder().scenes {
            let errors = stage.rungs.into_iter().map(|rung| (rung.error)().unwrap());
            let errors: Vec<f64> = errors.collect();
            assert!(errors.iter().any(|error| *error < 1e-13), "{errors:?}");
        }
    }
}
