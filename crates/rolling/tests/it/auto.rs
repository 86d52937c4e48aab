//! Tests the automatic choice of a roll model (`auto`) on random scenes. The error of the chosen model must be at most
//! the tolerance, and its cost at most twice the cost of the cheapest model that meets the tolerance. The cost is the
//! number of evaluations of the contact equations.

use palpate_geometry::Shape;
use palpate_rolling::{Chart, InvalidRoll, MeasuredRung, Model, Motion, Probe, Roller, Rolls};

use crate::scenes::{
    cylinder, dish, ellipsoid, height_field, paraboloid, plane, saddle, sphere, torus,
};

/// Random numbers from 0 to 1, the same in every run: the upper bits of a linear congruential generator.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A random number between `low` and `high` whose logarithm is uniformly distributed.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.between(libm::log(low), libm::log(high)))
    }
}

struct Scene {
    object: Shape,
    first: (f64, f64),
    rolls: Vec<Vec<Motion>>,
    tolerance: f64,
}

/// A random scene for a probe of radius 1; `kind` selects the object.
fn scene(kind: usize, numbers: &mut Numbers) -> Scene {
    let size = numbers.decades(0.05, 500.0);
    let aside = [numbers.between(-0.6, 0.6), numbers.between(-0.6, 0.6)];
    let spread = 1.0 + 0.5 * numbers.next();
    let on = |reach: f64| (aside[0] * reach, aside[1] * reach);
    let (object, first) = match kind {
        0 => (sphere(size), on(size)),
        1 => (dish(1.1 + size), on(1.1 + size)),
        2 => (plane(), on(size)),
        3 => (cylinder(size, 360.0 * aside[0]), on(size)),
        4 => (ellipsoid(size, size * spread, 1.3 * size), on(size)),
        // On this surface and the next one, the contact starts at the apex; on all other surfaces, it starts beside the
        // apex.
        5 => (ellipsoid(size, size, size * spread), (0.0, 0.0)),
        6 => (paraboloid(0.5 / size), (0.0, 0.0)),
        7 => (paraboloid(-0.45 / (1.0 + size)), on(1.0)),
        8 => (torus(size * (1.0 + spread), size), {
            let out = size * (1.0 + spread + 0.8 * aside[0]);
            let turn = aside[1];
            (out * libm::cos(turn), out * libm::sin(turn))
        }),
        9 => (saddle(0.4 / (1.0 + size)), on(1.0)),
        _ => {
            let formula = "h*sin(x/l)*cos(0.7*y/l) + 0.1*h*x/l";
            let length = 1.0 + size;
            let height = 0.3 * length * spread;
            (
                height_field(formula, &[("h", height), ("l", length)]),
                on(length),
            )
        }
    };
    let angle = numbers.decades(0.01, 3.0);
    let turn = numbers.between(0.0, 90.0);
    let rolls = (0..4)
        .map(|quarter| {
            let direction = f64::to_radians(90.0 * f64::from(quarter) + turn);
            vec![Motion::rolling(direction, 0.7, angle / 0.7)]
        })
        .collect();
    Scene {
        object,
        first,
        rolls,
        tolerance: numbers.decades(1e-12, 1e-3),
    }
}

const FREE: Chart = Chart::Free;

fn models() -> Vec<Model> {
    let few = 1..=8;
    let more = [10, 12, 14, 16, 20, 24, 32, 40, 48, 56, 64];
    let rk4 = few
        .chain(more)
        .map(|steps| Model::Rk4 { steps, chart: FREE });
    let dop853 = (1..=14).map(|power| Model::Dop853 {
        tolerance: 10.0_f64.powi(-power),
        chart: FREE,
    });
    [Model::ClosedForm, Model::Meridian]
        .into_iter()
        .chain(rk4)
        .chain(dop853)
        .collect()
}

fn error(rung: &MeasuredRung) -> f64 {
    rung.outcome.clone().unwrap_or(f64::INFINITY)
}

#[test]
fn the_rung_that_auto_takes_is_good_and_cheap() {
    let mut numbers = Numbers(1996);
    let mut judged = 0;
    let mut index = 0;
    while judged < 50 {
        let scene = scene(index % 11, &mut numbers);
        index += 1;
        let rolls = Rolls::exact(&scene.rolls);
        let auto = Model::Auto {
            tolerance: scene.tolerance,
            chart: FREE,
        };
        let probe = Probe::new(1.0).unwrap();
        let roller = match Roller::new(probe, scene.object.clone(), scene.first, auto, rolls) {
            Err(InvalidRoll::FirstContact(_) | InvalidRoll::Fault(_)) => continue,
            roller => roller.unwrap(),
        };
        let taken = roller
            .measure(&[roller.choice().model], FREE, rolls)
            .remove(0);
        // If the roll leaves the object, no error can be measured. Skip the roll.
        let Ok(err) = taken.outcome else { continue };
        judged += 1;
        let what = format!("{:?} {} {:e}", scene.object, taken.name, scene.tolerance);
        assert!(err <= scene.tolerance, "{what}: error {err:e}");
        // The error bound of the chosen model is increased by the rounding errors of the reference solution.
        let bound = roller.choice().error_bound.unwrap() + 1e-13;
        assert!(err <= bound, "{what}: error {err:e} > {bound:e}");

        let all = roller.measure(&models(), FREE, rolls);
        let adequate = all.iter().filter(|rung| error(rung) <= scene.tolerance);
        let cheapest = adequate.min_by_key(|rung| rung.evaluations).unwrap();
        let (paid, least) = (taken.evaluations, cheapest.evaluations);
        assert!(
            paid <= 2 * least,
            "{what}: {paid}; {}: {least}",
            cheapest.name
        );
    }
}

/// Four rolls in different directions. The probe makes `turns` turns in each roll.
fn turns(turns: f64) -> Vec<Vec<Motion>> {
    let angle = turns * std::f64::consts::TAU;
    let directions = [0.2, 1.7, 3.3, 4.9];
    directions
        .map(|direction| vec![Motion::rolling(direction, 1.0, angle)])
        .to_vec()
}

#[test]
fn long_rolls_are_not_rolled_to_choose_how() {
    let start = |turned: f64, tolerance: f64| {
        let rolls = turns(turned);
        let auto = Model::Auto {
            tolerance,
            chart: FREE,
        };
        let probe = Probe::new(1.0).unwrap();
        let rolls = Rolls::exact(&rolls);
        let roller = Roller::new(probe, ellipsoid(5.0, 4.0, 3.0), (1.0, 0.5), auto, rolls);
        roller.unwrap()
    };
    for tolerance in [1e-6_f64, 1e-14] {
        for turned in [200.0, 1e3, 1e6, 1e12] {
            let taken = (1e-3 * tolerance / turned).max(1e-14);
            let choice = start(turned, tolerance).choice().clone();
            let Model::Dop853 { tolerance: set, .. } = choice.model else {
                panic!("{choice:?}");
            };
            assert!((set / taken - 1.0).abs() < 1e-12, "{turned}: {choice:?}");
            assert!(choice.reason.contains("too long"), "{choice:?}");
        }
    }
    // For long rolls, `auto` chooses a model without measuring its error. The error must be within the tolerance
    // nevertheless.
    let rolls = turns(100.0);
    let rolls = Rolls::exact(&rolls);
    let roller = start(100.0, 1e-6);
    assert!(roller.choice().reason.contains("too long"));
    let taken = roller.measure(&[roller.choice().model], FREE, rolls);
    let err = error(&taken[0]);
    assert!(err <= 1e-6, "{err:e}");
    // Many short motions do not count as a long roll.
    let pieces = vec![vec![Motion::rolling(0.2, 1.0, 1e-3); 3000]];
    let auto = Model::Auto {
        tolerance: 1e-6,
        chart: FREE,
    };
    let roller = roller.on(auto, Rolls::exact(&pieces)).unwrap();
    assert!(matches!(roller.choice().model, Model::Rk4 { steps: 1, .. }));
}
