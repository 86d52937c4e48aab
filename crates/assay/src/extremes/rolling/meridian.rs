//! Through the apex of paraboloids from flat to sharp, and of spheroids.

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Ellipsoid, Graph};
use palpate_rolling::{Chart, Model, Motion};

use super::super::Precise;
use super::super::answer::Named;
use super::super::{Answer, Case};
use super::{MADE, ended, numbers, roll, roller};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let c = 10f64.powi(exponent);
        for theta in [1e-12, 0.1, 3.0] {
            let input = format!("meridian of a paraboloid, c = {c:e}, {theta:e} rad");
            cases.push(Case::value("rolling::Roller::shift", input, move || {
                paraboloid(c, theta)
            }));
        }
    }
    for c in [-1e-12, -1e-6, -0.1, -0.499, -0.499_999_5] {
        let input = format!("meridian of a bowl, c = {c:e}, 0.1 rad");
        cases.push(Case::value("rolling::Roller::shift", input, move || {
            paraboloid(c, 0.1)
        }));
    }
    for theta in [1e3, 1e6, 1e9] {
        let input = format!("meridian of a paraboloid, c = 0.5, {theta:e} rad");
        cases.push(Case::value("rolling::Roller::shift", input, move || {
            paraboloid(0.5, theta)
        }));
    }
    for turns in [1e-12, 0.1, 1.0, 1000.0] {
        let input = format!("meridian of a spheroid that is a sphere, {turns:e} turns");
        cases.push(Case::value("rolling::Roller::roll", input, move || {
            round_spheroid(turns * std::f64::consts::TAU)
        }));
    }
    for aspect in [1e-12, 1e-3, 0.1, 9.0, 1e3, 1e12] {
        let made = move |model| {
            let axes = [1.0, 1.0, aspect];
            let spheroid = Shape::Ellipsoid(Ellipsoid::new(axes).expect(MADE));
            let motion = Motion::rolling(0.0, 1.0, 0.1);
            let roller = roller(1.0, spheroid, (0.0, 0.0), model, motion)?;
            roll(&roller, motion)
        };
        let against_dop853 = move |model, bound| {
            let found = made(model)?;
            let truth = made(Model::Dop853 {
                tolerance: 1e-13,
                chart: Chart::Free,
            })?;
            let pairs = [
                (found.on_object.x, truth.on_object.x),
                (found.arc_length, truth.arc_length),
            ];
            let answer = Answer::all_near(pairs).within(bound);
            Ok::<_, Named>(answer.also(numbers(&found)))
        };
        cases.push(Case::new(
            "rolling::Roller::roll",
            format!("meridian of a spheroid of aspect {aspect:e}: as DOP853 has it"),
            move || against_dop853(Model::Meridian, 1e-11).into(),
        ));
        cases.push(Case::value(
            "rolling::Roller::roll",
            format!("auto on a spheroid of aspect {aspect:e}: as DOP853 has it"),
            move || {
                let chart = Chart::Free;
                let tolerance = 1e-6;
                against_dop853(Model::Auto { tolerance, chart }, tolerance)
            },
        ));
    }
    cases
}

/// `θ = α + s` with `tan α = q` and `4 c s = q √(1 + q²) + asinh q`: Newton's method from what was
/// found, and on until nothing changes.
fn paraboloid(c: f64, theta: f64) -> Result<Answer, Named> {
    let hill = Shape::Paraboloid(Graph::paraboloid(c).expect(MADE));
    let motion = Motion::rolling(0.0, 1.0, theta);
    let roller = roller(1.0, hill, (0.0, 0.0), Model::Meridian, motion)?;
    let found = roller.shift(&[motion]).map_err(ended)?;
    let contact = roll(&roller, motion)?;
    let mut q = Precise::new(2.0) * c * contact.on_object.x;
    let mut arc = Precise::new(0.0);
    for _ in 0..6 {
        let root = (q.squared() + 1.0).sqrt();
        arc = (&q * &root + q.asinh()) / 4.0 / c;
        let excess = q.atan() + &arc - theta;
        let slope = Precise::new(1.0) / root.squared() + &root / 2.0 / c;
        let step = excess / slope;
        arc = &arc - &step * &root / 2.0 / c;
        q = q - step;
    }
    let arc = arc.to_f64();
    let scale = 1.0 / (1.0 + 2.0 * c.abs());
    let pairs = [(found.arc_length, arc), (contact.arc_length, arc)];
    // A bowl that hardly fits magnifies, and a long path is no better known than its length.
    let condition = (1.0 / (1.0 + 2.0 * c.min(0.0))).max(1.0) * (arc / scale).max(1.0);
    Ok(Answer::all_at_scale(pairs, scale)
        .within(1e-13)
        .conditioned(condition)
        .also(numbers(&contact)))
}

/// A sphere of radius 3 in a spheroid's guise.
fn round_spheroid(theta: f64) -> Result<Answer, Named> {
    let path = Precise::new(theta) * 3.0 / 4.0;
    let angle = &path / 3.0;
    let sphere = Shape::Ellipsoid(Ellipsoid::new([3.0; 3]).expect(MADE));
    let motion = Motion::rolling(0.0, 1.0, theta);
    let roller = roller(1.0, sphere, (0.0, 0.0), Model::Meridian, motion)?;
    let contact = roll(&roller, motion)?;
    let pairs = [
        (contact.arc_length, path.to_f64()),
        (contact.on_object.x, (angle.sin() * 3.0).to_f64()),
        (contact.on_object.z, (angle.cos() * 3.0).to_f64()),
    ];
    Ok(Answer::all_at_scale(pairs, 0.75)
        .within(1e-13)
        .conditioned(theta.max(1.0))
        .also(numbers(&contact)))
}
