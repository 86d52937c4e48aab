//! Tests the computed overlap between a probe and the parts of the object beside the contact. The expected overlap is
//! found by a search on a fine grid.

use nalgebra::{Point3, Vector2};
use palpate_geometry::{Shape, Sphere, Surface};
use palpate_rolling::{Motion, RollError, RollFault, Roller, Rolls};

use crate::scenes::{auto, height_field, saddle};

const SCENES: u64 = 40;

fn between(random: &mut fastrand::Rng, least: f64, most: f64) -> f64 {
    least + random.f64() * (most - least)
}

/// A height field of one of five kinds, and the radius of a probe that may or may not fit into it.
fn scene(number: u64) -> (Shape, f64) {
    let mut random = fastrand::Rng::with_seed(number);
    let mut draw = |least, most| between(&mut random, least, most);
    match number % 5 {
        0 => {
            let (height, far, width) = (draw(0.5, 8.0), draw(3.0, 9.0), draw(0.5, 2.0));
            let formula = format!("{height}*exp(-((x-{far})^2+y^2)/(2*{width}^2))");
            (height_field(&formula, &[]), draw(0.5, 10.0))
        }
        1 => {
            let (height, steep, far) = (draw(0.1, 1.5), draw(3.0, 20.0), draw(0.4, 1.6));
            let formula = format!("{height}*(1+tanh({steep}*(x-{far})))");
            (height_field(&formula, &[]), draw(0.2, 1.5))
        }
        2 => {
            let (height, along, aside) = (draw(0.02, 0.3), draw(0.5, 3.0), draw(0.5, 3.0));
            let formula = format!("{height}*sin({along}*x+{})*cos({aside}*y)", draw(0.0, 6.0));
            (height_field(&formula, &[]), draw(0.3, 3.0))
        }
        3 => {
            let hill = |height: f64, x: f64, y: f64, width: f64| {
                format!("{height}*exp(-((x-{x})^2+(y-{y})^2)/{width})")
            };
            let mut hills = String::from("-0.02*x^2");
            for _ in 0..3 {
                let place = [draw(-2.0, 2.0), draw(-2.0, 2.0)];
                hills += &format!(
                    "+{}",
                    hill(draw(-0.5, 1.0), place[0], place[1], draw(0.1, 2.0))
                );
            }
            (height_field(&hills, &[]), draw(0.2, 2.0))
        }
        _ => {
            let (a, radius) = (draw(0.1, 1.0), draw(0.5, 3.0));
            (saddle(a), radius)
        }
    }
}

/// Depth of the deepest overlap of probe and object during a roll, found by a grid search at 41 positions of the probe.
fn overlap(roller: &Roller, motion: &Motion) -> f64 {
    let radius = roller.probe().radius();
    let mut deepest: f64 = 0.0;
    for step in 0..=40 {
        let share = f64::from(step) / 40.0;
        let until = Motion {
            duration_s: share * motion.duration_s,
            ..*motion
        };
        let contact = roller.roll(&[until]).unwrap();
        let centre = contact.on_object + contact.normal * radius;
        let depth = |at: Vector2<f64>| {
            let place = roller.object().contact_at(at.x, at.y);
            place.map_or(f64::NEG_INFINITY, |place: Point3<f64>| {
                radius - (place - centre).norm()
            })
        };
        let (mut middle, mut half) = (centre.xy().coords, radius);
        let mut best = f64::NEG_INFINITY;
        // Search for the deepest overlap on grids. Each grid is finer and lies around the best point of the previous
        // one.
        for lines in [90, 12, 12, 12, 12, 12] {
            let spacing = 2.0 * half / f64::from(lines);
            let from = middle;
            for row in 0..=lines {
                for column in 0..=lines {
                    let aside = Vector2::new(f64::from(column), f64::from(row)) * spacing;
                    let at = from - Vector2::repeat(half) + aside;
                    let here = depth(at);
                    if here > best {
                        (best, middle) = (here, at);
                    }
                }
            }
            half = 2.0 * spacing;
        }
        deepest = deepest.max(best);
    }
    deepest / radius
}

#[test]
fn no_roll_is_accepted_that_overlaps_nor_refused_that_clears() {
    let (mut refused, mut accepted) = (0, 0);
    for number in 0..SCENES {
        let (object, radius) = scene(number);
        let mut random = fastrand::Rng::with_seed(number.wrapping_add(1000));
        let mut draw = |least, most| between(&mut random, least, most);
        let motion = Motion::rolling(draw(0.0, 6.3), 1.0, draw(0.1, 0.6));
        let place = (draw(-0.5, 0.5), draw(-0.5, 0.5));
        let model = auto(1e-9);
        let rolls = [vec![motion]];
        // The roller rejects a hollow object if the radius of the hollow is not larger than the probe's radius. Such
        // objects are skipped.
        let Ok(roller) = Roller::new(
            Sphere::new(radius).unwrap(),
            object,
            place,
            model,
            Rolls::exact(&rolls),
        ) else {
            continue;
        };
        if roller.roll(&[motion]).is_err() {
            continue;
        }
        let deepest = overlap(&roller, &motion);
        let Some(terrain) = roller.terrain(&[motion], 0.0).unwrap() else {
            assert!(deepest < 1e-6, "{number}: {deepest:e}");
            continue;
        };
        match roller.clearance(&[motion], &terrain, 0.0) {
            Ok(_) => {
                accepted += 1;
                assert!(
                    deepest < 1e-6,
                    "{number} is accepted and overlaps by {deepest:e}"
                );
            }
            Err(error) => {
                refused += 1;
                let RollFault::Overlapping { depth } = error.fault else {
                    panic!("{number}: {error}");
                };
                assert!(depth > 0.0 && error.on_object.iter().all(|one| one.is_finite()));
                assert!(
                    deepest > 4e-7,
                    "{number} is refused and overlaps by {deepest:e}: {error}"
                );
            }
        }
    }
    assert!(refused > 4 && accepted > 8, "{refused} {accepted}");
}

/// Smallest clearance during a roll that starts at the origin and leads along x, or the error of the roll.
fn along_x(formula: &str, radius: f64, angle_rad: f64, spin: f64) -> Result<f64, RollError> {
    let mut motion = Motion::rolling(0.0, angle_rad, 1.0);
    motion.angular_velocity.z = spin;
    let rolls = [vec![motion]];
    let model = auto(1e-9);
    let (probe, exact) = (Sphere::new(radius).unwrap(), Rolls::exact(&rolls));
    let object = height_field(formula, &[]);
    let roller = Roller::new(probe, object, (0.0, 0.0), model, exact).unwrap();
    let terrain = roller.terrain(&rolls[0], 0.0).unwrap().unwrap();
    roller.clearance(&rolls[0], &terrain, 0.0)
}

#[track_caller]
fn assert_overlapping(found: Result<f64, RollError>) -> RollError {
    let error = found.unwrap_err();
    assert_eq!(<&str>::from(error.fault), "overlapping", "{error}");
    error
}

#[test]
fn steep_steps_and_paths_that_close_are_checked() {
    for steep in [20.0, 200.0, 1e3, 1e4] {
        for far in [0.55, 0.6, 0.731, 0.8] {
            let step = |far: f64| format!("1.5*(1+tanh({steep}*(x-{far})))");
            assert_overlapping(along_x(&step(far), 1.0, 0.3, 0.0));
            let found = along_x(&step(far + 0.9), 1.0, 0.3, 0.0);
            assert!(found.is_ok(), "{steep} {far}");
        }
    }
    // The probe (radius 1) spins as fast as it rolls, so its centre moves on a circle of radius 1. The circle starts at
    // y = 0 and reaches a distance of 2 from this line. The side of the probe then reaches a distance of 3, so it hits
    // the object's step at y = 2.6 or y = −2.6.
    let tau = std::f64::consts::TAU;
    assert_overlapping(along_x("1.5*(1+tanh(20*(y^2-6.76)))", 1.0, tau, tau));
}

#[test]
fn the_error_names_place_and_depth() {
    let found = along_x("8*exp(-((x-6)^2+y^2)/2)", 10.0, 0.1, 0.0);
    let text = assert_overlapping(found).to_string();
    assert!(
        text.starts_with("the probe overlaps the object by "),
        "{text}"
    );
    assert!(
        text.contains(" at (5.") || text.contains(" at (6."),
        "{text}"
    );
}
