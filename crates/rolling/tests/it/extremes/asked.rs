//! Probes, motions and tolerances that nobody means.

use nalgebra::{Vector2, Vector3};
use palpate_geometry::Shape;
use palpate_rolling::{Motion, Probe};
use palpate_verdict::{Answer, NO_LENGTHS, NOT_FINITE, extreme_pairs, rows};

use super::rolled::{DURATION, NEW, ROLL, SHIFT, auto, dop853, ended, numbers, roll, roller};
use crate::scenes::{paraboloid, plane, saddle, sphere};

const TOLERANCES: [f64; 6] = [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e-15, 0.11];
const MOVING: Motion = Motion {
    angular_velocity: Vector3::new(0.0, 1.0, 0.0),
    sliding: Vector2::new(0.0, 0.0),
    duration_s: 0.1,
};

rows! {
    "rolling::Probe::new", "radius {bad:e}", "invalid-shape" => Probe::new(bad), for bad in NO_LENGTHS;
    NEW, "{name}, tolerance {tolerance:e}", "tolerance" => roller(1.0, plane(), (0.0, 0.0), model, MOVING),
        for tolerance in TOLERANCES, for (name, model) in [("auto", auto(tolerance)), ("DOP853", dop853(tolerance))];
    NEW, "first contact at {bad:e} on a {name}", "off-domain" => roller(1.0, object, (bad, 0.0), auto(1e-6), MOVING),
        for bad in NOT_FINITE, for (name, object) in objects();
    ROLL, "{part} {bad:e} on a {name}", "not-finite" => roll(&on(object, motion)?, motion),
        for bad in NOT_FINITE, for (part, motion) in broken(bad), for (name, object) in objects();
    SHIFT, "{part} {bad:e} on a {name}", "not-finite" => on(object, motion)?.shift(&[motion]).map_err(ended),
        for bad in NOT_FINITE, for (part, motion) in broken(bad), for (name, object) in objects();
    DURATION, "arc {bad:e}", "not-finite" => duration(MOVING, bad), for bad in NOT_FINITE;
    DURATION, "of a motion that stands still", "not-finite" => duration(Motion::rolling(0.0, 0.0, 1.0), 1.0);
    "rolling::Motion::rolling", "direction {direction:e} rad: a rate of 1 all the same" =>
        Answer::near(Motion::rolling(direction, 1.0, 1.0).rotation().norm(), 1.0).within(1e-15),
        for direction in [1e-300, 1.5, 1e6, 1e15, 1e20, 1e300];
    ROLL, "{name} at 256 pairs of extreme rates and durations" => extreme_motions(&object, answered),
        for ((name, object), answered) in objects().into_iter().zip([300, 300, 300, 298]);
}

fn objects() -> [(&'static str, Shape); 4] {
    [plane(), sphere(2.0), paraboloid(0.5), saddle(0.2)].map(|object| (object.name(), object))
}

fn on(object: Shape, motion: Motion) -> Result<palpate_rolling::Roller, &'static str> {
    roller(1.0, object, (0.0, 0.0), auto(1e-6), motion)
}

fn broken(bad: f64) -> [(&'static str, Motion); 4] {
    let [mut rate, mut spin, mut sliding, mut duration] = [MOVING; 4];
    rate.angular_velocity.x = bad;
    spin.angular_velocity.z = bad;
    sliding.sliding.y = bad;
    duration.duration_s = bad;
    [
        ("rate", rate),
        ("spin", spin),
        ("sliding", sliding),
        ("duration", duration),
    ]
}

fn duration(motion: Motion, arc: f64) -> Result<f64, &'static str> {
    let roller = on(sphere(2.0), motion)?;
    roller.duration_for_arc(&motion, arc).map_err(ended)
}

fn extreme_motions(object: &Shape, answered: u32) -> Result<Answer, String> {
    let calls = extreme_pairs().flat_map(|(rate, duration_s)| {
        let motion = Motion::rolling(0.3, rate, duration_s);
        let roller = on(object.clone(), MOVING).unwrap();
        let shift = roller.shift(&[motion]).map_err(ended);
        [
            roll(&roller, motion).map(|contact| numbers(&contact)),
            shift.map(|shift| vec![shift.displacement.x, shift.displacement.y, shift.arc_length]),
        ]
    });
    Answer::counted(calls, answered, &["not-finite", "off-domain"])
}
