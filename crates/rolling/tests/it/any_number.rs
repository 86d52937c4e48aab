//! Tests rolls and glides. On objects that are less curved than the probe, they succeed. If the parameters of probe,
//! object, motion and position have any bit patterns, the result is finite or a named error. A roll and then the
//! reversed roll end at the first contact.

use nalgebra::{Vector2, Vector3};
use palpate_geometry::{
    Cylinder, Dish, Ellipsoid, Formula, Graph, Plane, Shape, Sphere, Surface, Torus,
};
use palpate_rolling::{
    Chart, Contact, Fingertip, Glider, HeldAxis, InvalidRoll, Model, Motion, Roller, Rolls, Touch,
};
use proptest::prelude::*;

use crate::scenes::{
    auto, cylinder, dish, dop853, ellipsoid, paraboloid, plane, saddle, sphere, torus,
};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -2.0..2.0_f64,
        (-12.0..12.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        proptest::sample::select(&[0.0, -0.0, f64::NAN, f64::INFINITY, f64::MAX, 5e-324][..]),
    ]
}

fn objects(a: f64, b: f64, c: f64) -> Vec<Shape> {
    let parameters = [("a".to_owned(), a), ("b".to_owned(), b)].into();
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
        Formula::parse("a*sin(b*x) + ln(1 - y)", &parameters)
            .map(|formula| Shape::HeightField(Graph::from(formula)))
            .ok(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn models(tolerance: f64) -> [Model; 6] {
    let held = Chart::Montana(HeldAxis::Transported);
    [
        auto(1e-3),
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
    let units = [contact.normal, contact.x_axis, contact.on_probe(1.0).coords];
    contact.on_object.iter().all(|x| x.is_finite())
        && units.iter().all(|unit| (unit.norm() - 1.0).abs() < 1e-9)
        && contact.arc_length.is_finite()
        && contact.arc_length >= 0.0
}

/// Whether all numbers of a touch are finite and the centre of the tip is above (x, y).
fn is_sound_touch(touch: &Touch, tip: Fingertip, (x, y): (f64, f64)) -> bool {
    let vectors = [touch.point.coords, touch.normal, touch.tip_centre.coords];
    let form = touch.curvature;
    let radius = match tip {
        Fingertip::Point => 0.0,
        Fingertip::Sphere { radius } => radius,
    };
    let miss = touch.tip_centre.coords.xy() - Vector2::new(x, y);
    vectors.iter().flatten().all(|x| x.is_finite())
        && (form.k_uu + form.k_uv + form.k_vv).is_finite()
        && miss.amax() <= 1e-11 * (radius + x.abs() + y.abs())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() })]

    /// Tests glides, and rolls by up to 1 rad, on objects of any size that are less curved than the probe.
    #[test]
    fn blunt_objects_are_rolled_and_glided_on(
        probe in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        ratio in (0.6..3.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        (turning, sliding) in ([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], [-0.3..0.3_f64, -0.3..0.3]),
        (duration_s, direction) in (0.0..1.0_f64, -3.0..3.0_f64),
        at in [-0.2..0.2_f64, -0.2..0.2],
    ) {
        let size = probe * ratio;
        let motion = Motion {
            angular_velocity: Vector3::from(turning),
            sliding: Vector2::from(sliding) * probe,
            duration_s,
        };
        let made = Sphere::new(probe).unwrap();
        for object in [
            sphere(size),
            dish(size),
            plane(),
            cylinder(size, direction),
            ellipsoid(size, 1.3 * size, 1.1 * size),
            torus(3.0 * size, size),
            paraboloid(0.5 / size),
            paraboloid(-0.2 / size),
            saddle(0.2 / size),
        ] {
            let (x, y) = object.default_contact();
            let place = (x + at[0] * size, y + at[1] * size);
            let what = format!("{object:?} at {place:?}, {motion:?}");
            for tip in [Fingertip::Point, Fingertip::Sphere { radius: probe }] {
                let touch = Glider::new(object.clone(), tip).unwrap().touch(place.0, place.1);
                prop_assert!(touch.as_ref().is_ok_and(|touch| is_sound_touch(touch, tip, place)), "{what}: {touch:?}");
            }
            let motions = [vec![motion]];
            for model in [
                auto(1e-6),
                dop853(1e-6, Chart::Free),
                Model::Rk4 { steps: 2, chart: Chart::Free },
            ] {
                let roller = Roller::new(made, object.clone(), place, model, Rolls::exact(&motions));
                let end = roller.unwrap().roll(&motions[0]);
                prop_assert!(end.as_ref().is_ok_and(is_sound), "{what}, {model:?}: {end:?}");
            }
        }
    }

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
        // Long motions are skipped, because an integrator takes up to 100,000 steps before it fails, which is slow.
        let is_short = |motion: &Motion| {
            let sharpness = 1.0 / made[3] + made[0].abs() + 1.0 / made[0].abs();
            let way = motion.sliding.norm() + motion.angular_velocity.norm() * made[3];
            let length = way * motion.duration_s * sharpness;
            (length <= 6.0 || length.is_nan()) && motion.angular_velocity.z.abs() < 6.0
        };
        let probe = Sphere::new(made[3]);
        prop_assert_eq!(probe.is_ok(), (1e-150..=1e150).contains(&made[3]));
        let Ok(probe) = probe else { return Ok(()) };
        let at = [(0.0, 0.0), (place[0], place[1])];
        for object in objects(made[0], made[1], made[2]) {
            for (model, at) in models(tolerance).into_iter().zip(at.into_iter().cycle()) {
                let exact = matches!(model, Model::ClosedForm | Model::Meridian);
                for motions in [vec![motion], vec![plain], vec![plain, motion]] {
                    if !exact && !motions.iter().all(is_short) {
                        continue;
                    }
                    let rolls = Rolls::exact(std::slice::from_ref(&motions));
                    let roller = Roller::new(probe, object.clone(), at, model, rolls);
                    let is_promised = (1e-14..=0.1).contains(&tolerance);
                    match (&roller, model) {
                        (Ok(_), Model::Auto { chart: Chart::Montana(_), .. }) => prop_assert!(is_promised),
                        (Err(InvalidRoll::Tolerance(_)), Model::Auto { .. }) => prop_assert!(!is_promised),
                        (Err(InvalidRoll::Tolerance(_)), _) => prop_assert!(false, "{model:?} has none"),
                        _ => {}
                    }
                    let Ok(roller) = roller else { continue };
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
                let glider = Glider::new(object.clone(), tip);
                let is_tip = tip == Fingertip::Point || (1e-150..=1e150).contains(&radius);
                prop_assert_eq!(glider.is_ok(), is_tip);
                let Ok(glider) = glider else { continue };
                for [x, y] in [place, [place[0] * made[0], place[1] * made[0]]] {
                    let touch = glider.touch(x, y);
                    let is_sound = touch.as_ref().map_or(true, |touch| is_sound_touch(touch, tip, (x, y)));
                    prop_assert!(is_sound, "{object:?}, {tip:?} at {x:e}, {y:e}: {touch:?}");
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
        let auto = auto(1e-10);
        let smaller = probe.min(size);
        for (object, scale) in [
            (sphere(size), smaller),
            (paraboloid(0.5 / size), smaller),
            (saddle(0.1 / size.max(probe)), probe),
        ] {
            let rolls = [vec![there, back]];
            let rolls = Rolls::exact(&rolls);
            let made = Sphere::new(probe).unwrap();
            let roller = Roller::new(made, object.clone(), (0.1 * size.min(probe), 0.0), auto, rolls).unwrap();
            let end = roller.roll(&[there, back]).unwrap();
            let scale = scale * 1e-8;
            let off = (end.on_object - roller.first_contact().on_object).norm();
            prop_assert!(off <= scale, "{}: {off:e} of {scale:e}", object.name());
            let shift = end.shift_from(roller.first_contact(), probe);
            prop_assert!(shift.displacement.norm() <= scale, "{}: {shift:?}", object.name());
        }
    }
}
