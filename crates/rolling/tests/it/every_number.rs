//! Any bit patterns as probes, objects, motions and places: finite numbers or a named error; a roll there
//! and back returns.

use nalgebra::{Vector2, Vector3};
use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_rolling::{
    Chart, Contact, Fingertip, Glider, HeldAxis, Model, Motion, Probe, Roller, Rolls,
};
use proptest::prelude::*;

use crate::scenes::{paraboloid, roll, saddle, sphere};

/// Any double at all, or one of everyday size.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -2.0..2.0_f64,
        (-12.0..12.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        Just(0.0),
        Just(-0.0),
    ]
}

/// The objects that these numbers make.
fn objects(a: f64, b: f64, c: f64) -> Vec<Shape> {
    [
        Sphere::new(a).map(Shape::Sphere).ok(),
        Dish::new(a).map(Shape::Dish).ok(),
        Some(Shape::Plane(Plane)),
        Cylinder::new(a, b).map(Shape::Cylinder).ok(),
        Ellipsoid::new([a, b, c]).map(Shape::Ellipsoid).ok(),
        Ellipsoid::new([a, a, b]).map(Shape::Ellipsoid).ok(),
        Torus::new(a, b).map(Shape::Torus).ok(),
        Graph::paraboloid(a).map(Shape::Paraboloid).ok(),
        Graph::saddle(a).map(Shape::Saddle).ok(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn models(tolerance: f64) -> [Model; 6] {
    let held = Chart::Montana(HeldAxis::Transported);
    [
        Model::Auto {
            tolerance: 1e-3,
            chart: Chart::Free,
        },
        Model::Auto {
            tolerance,
            chart: held,
        },
        Model::ClosedForm,
        Model::Meridian,
        Model::Rk4 {
            steps: 2,
            chart: Chart::Free,
        },
        Model::Rk4 {
            steps: 2,
            chart: held,
        },
    ]
}

fn is_sound(contact: &Contact) -> bool {
    let vectors = [
        contact.on_object.coords,
        contact.normal,
        contact.x_axis,
        contact.y_axis(),
        contact.probe_direction(),
    ];
    vectors.iter().flatten().all(|x| x.is_finite()) && contact.arc_length.is_finite()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() })]

    #[test]
    fn rolls_end_in_numbers_or_in_errors(
        made in [number(), number(), number(), number()],
        place in [number(), number()],
        moves in [number(), number(), number(), number(), number(), number()],
        tolerance in number(),
    ) {
        let [x, y, z, u, v, duration_s] = moves;
        let motion = Motion {
            angular_velocity: Vector3::new(x, y, z),
            sliding: Vector2::new(u, v),
            duration_s,
        };
        let plain = Motion::rolling(x, y, duration_s);
        // A hundred thousand steps to nowhere take their time; the harness of extremes waits for them.
        let is_short = |motion: &Motion| {
            let sharpness = 1.0 / made[3] + made[0].abs() + 1.0 / made[0].abs();
            let way = motion.sliding.norm() + motion.angular_velocity.norm() * made[3];
            let length = way * motion.duration_s * sharpness;
            (length <= 6.0 || length.is_nan()) && motion.angular_velocity.z.abs() < 6.0
        };
        let Ok(probe) = Probe::new(made[3]) else { return Ok(()) };
        let at = [(0.0, 0.0), (place[0], place[1])];
        for object in objects(made[0], made[1], made[2]) {
            for (model, at) in models(tolerance).into_iter().zip(at.into_iter().cycle()) {
                let exact = matches!(model, Model::ClosedForm | Model::Meridian);
                for motions in [vec![motion], vec![plain], vec![plain, motion]] {
                    if !exact && !motions.iter().all(is_short) {
                        continue;
                    }
                    let rolls = Rolls { rolls: std::slice::from_ref(&motions) };
                    let Ok(roller) = Roller::new(probe, object.clone(), at, model, rolls) else {
                        continue;
                    };
                    let (end, shift) = (roller.roll(&motions), roller.shift(&motions));
                    prop_assert!(end.is_err() || is_sound(&end.unwrap()), "{object:?} {motions:?}: {end:?}");
                    if let Ok(shift) = shift {
                        let [du, dv] = shift.displacement.into();
                        let is_finite = (du + dv + shift.arc_length).is_finite();
                        prop_assert!(is_finite, "{object:?} {motions:?}: {shift:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn touches_are_numbers_or_errors(
        made in [number(), number(), number()],
        radius in number(),
        place in [number(), number()],
    ) {
        for object in objects(made[0], made[1], made[2]) {
            for tip in [Fingertip::Point, Fingertip::Sphere { radius }] {
                let Ok(glider) = Glider::new(object.clone(), tip) else { continue };
                for [x, y] in [place, [place[0] * made[0], place[1] * made[0]]] {
                    if let Ok(touch) = glider.touch(x, y) {
                        let vectors = [touch.point.coords, touch.normal, touch.tip_centre.coords];
                        let form = touch.curvature;
                        let finite = vectors.iter().flatten().all(|x| x.is_finite())
                            && (form.k_uu + form.k_uv + form.k_vv).is_finite();
                        prop_assert!(finite, "{object:?}, {tip:?} at {x:e}, {y:e}: {touch:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn there_and_back_is_where_it_began(
        probe in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        ratio in (-3.0..3.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        direction in -3.0..3.0_f64,
        theta in (-9.0..0.5_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
    ) {
        let size = probe * ratio;
        let there = Motion::rolling(direction, 1.0, theta);
        let back = Motion { angular_velocity: -there.angular_velocity, ..there };
        let auto = Model::Auto { tolerance: 1e-10, chart: Chart::Free };
        let smaller = probe.min(size);
        for (object, scale) in [
            (sphere(size), smaller),
            (paraboloid(0.5 / size), smaller),
            (saddle(0.1 / size.max(probe)), probe),
        ] {
            let rolls = [vec![there, back]];
            let rolls = Rolls { rolls: &rolls };
            let made = Probe::new(probe).unwrap();
            let roller = Roller::new(made, object.clone(), (0.1 * size.min(probe), 0.0), auto, rolls).unwrap();
            let end = roller.roll(&[there, back]).unwrap();
            let scale = scale * 1e-8;
            let off = (end.on_object - roller.first_contact().on_object).norm();
            prop_assert!(off <= scale, "{}: {off:e} of {scale:e}", object.name());
            let shift = end.shift_from(roller.first_contact(), probe);
            prop_assert!(shift.displacement.norm() <= scale, "{}: {shift:?}", object.name());
        }
    }

    #[test]
    fn an_arc_lasts_as_long_as_it_takes(
        arc in (-12.0..1.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        c in -0.4..5.0_f64,
    ) {
        let unit = Motion::rolling(0.3, 1.0, 1.0);
        let roller = crate::scenes::roller(1.0, &paraboloid(c), (0.0, 0.0), Model::Meridian, unit);
        let duration_s = roller.duration_for_arc(&unit, arc).unwrap();
        let end = roll(1.0, &paraboloid(c), (0.0, 0.0), Model::Meridian, Motion { duration_s, ..unit });
        prop_assert!((end.arc_length / arc - 1.0).abs() < 1e-12, "{}", end.arc_length);
    }
}

#[test]
fn an_arc_too_short_to_be_squared_lasts_as_long_as_it_takes() {
    let unit = Motion::rolling(0.3, 0.7, 1.0);
    let roller = crate::scenes::roller(1.0, &sphere(3.0), (0.0, 0.0), Model::ClosedForm, unit);
    let duration_s = roller.duration_for_arc(&unit, 1e-300).unwrap();
    assert!((duration_s / (1e-300 * 4.0 / 3.0 / 0.7) - 1.0).abs() < 1e-15);
}
