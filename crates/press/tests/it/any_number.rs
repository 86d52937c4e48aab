//! Presses with random parameters. If a press is possible, its contact and an estimate can be computed. For any other
//! parameters, the result is finite or an expected error.

use palpate_press::sneddon_indentation;
use palpate_press::{
    Body, Contact, ForwardFit, MarkerDisplacement, Markers, Measured, PressError, PressEstimate,
    Prior, Reading, Skin,
};
use proptest::prelude::*;

/// Any double-precision number; two thirds of the generated numbers have an ordinary magnitude.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -30.0..30.0,
        (-9.0..9.0).prop_map(|power: f64| libm::pow(10f64, power)),
    ]
}

fn bodies(poisson: f64, thickness: f64, depth: f64) -> Vec<Body> {
    let bodies = [
        Body::half_space(poisson, depth),
        Body::bonded_layer(thickness, depth),
        Body::gaussian(thickness),
    ];
    bodies.into_iter().flatten().collect()
}

fn parts(moved: &MarkerDisplacement) -> [f64; 3] {
    [moved.normal, moved.tangential[0], moved.tangential[1]]
}

fn assert_finite(contact: &Contact<'_>, r: f64, young: f64) {
    let moved = contact.displacement(r);
    let stated = [contact.force(young), contact.peak_pressure(young)];
    let mut numbers = vec![contact.radius, moved.normal, moved.radial];
    numbers.extend(stated.into_iter().flatten());
    assert!(
        numbers.iter().all(|number| number.is_finite()),
        "{contact:?} at {r:e}"
    );
}

#[test]
fn non_finite_positions_map_to_the_apex_and_non_finite_distances_to_no_displacement() {
    let skin = Skin::new(20.0).unwrap();
    let markers = Markers::new(skin, &[[1.0, 2.0]]).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(markers.distances([bad, 1.0]), markers.distances([0.0; 2]));
    }
    for body in bodies(0.5, 5.0, 2.0) {
        let contact = body.press(0.1, 1.0).unwrap();
        for r in [f64::NAN, f64::INFINITY, f64::MAX] {
            assert_eq!(contact.displacement(r).normal, 0.0);
        }
        assert_eq!(contact.displacement(-3.0), contact.displacement(3.0));
        assert_eq!(contact.force(f64::INFINITY), None);
    }
}

/// A number in the range `range`; with a probability of 1/8, any double-precision number.
fn mostly(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![7 => range, 1 => any_number()]
}

fn power(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|exponent| libm::pow(10f64, exponent))
}

fn is_setting(value: f64, range: impl std::ops::RangeBounds<f64>) -> bool {
    range.contains(&value)
}

/// Returns the value of `result` if `is_good` is true. Otherwise checks that `result` is the error `bad-setting`, and
/// returns `None`.
fn valid_value<T: std::fmt::Debug>(is_good: bool, result: Result<T, PressError>) -> Option<T> {
    if is_good {
        return Some(result.unwrap());
    }
    assert_eq!(<&str>::from(result.unwrap_err()), "bad-setting");
    None
}

const POSITIVE: std::ops::RangeInclusive<f64> = 5e-324..=f64::MAX;

fn square_of_markers() -> Markers {
    let at = |index: u32| 3.0 * (f64::from(index) - 2.0);
    let places: Vec<[f64; 2]> = (0..25)
        .map(|index| [at(index % 5), at(index / 5)])
        .collect();
    Markers::new(Skin::new(20.0).unwrap(), &places).unwrap()
}

fn is_finite(found: &PressEstimate) -> bool {
    let mut numbers = vec![found.r_squared, found.reduced_chi_squared, found.contact[0]];
    for estimated in [
        found.relative_curvature,
        found.object_curvature(),
        found.effective_radius(),
        found.indentation,
        found.contact_radius,
    ] {
        numbers.extend([estimated.value, estimated.std]);
        numbers.extend(
            [estimated.interval.low, estimated.interval.high]
                .into_iter()
                .flatten(),
        );
    }
    numbers.iter().all(|number| number.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    /// If the indentation is at most 1/50 of the sensor's radius, the contact is not too wide for the sensor.
    #[test]
    fn shallow_presses_on_any_sensor_have_a_contact(
        radius in power(-9.0..9.0),
        (poisson, thickness, depth) in (0.0..0.5, 0.2..0.9, 0.0..1.0),
        (object, indentation, r) in (-0.9..20.0, power(-6.0..-1.7), -2.0..2.0),
    ) {
        let (thickness, depth) = (thickness * radius, depth * thickness * radius);
        let skin = Skin::new(radius).unwrap();
        let bodies = bodies(poisson, thickness, depth);
        prop_assert_eq!(bodies.len(), 3);
        for body in bodies {
            let contact = skin.contact(&body, object / radius, indentation * radius).unwrap();
            assert_finite(&contact, r * radius, 0.1);
            prop_assert!(contact.radius > 0.0 && contact.radius < radius, "{contact:?}");
            prop_assert!(contact.displacement(0.0).normal > 0.0, "{contact:?}");
        }
    }

    #[test]
    fn bodies_return_numbers_or_the_expected_error(numbers in prop::array::uniform7(any_number())) {
        let [poisson, thickness, depth, curvature, indentation, r, young] = numbers;
        let is_depth = is_setting(depth, 0.0..=1e50);
        valid_value(is_setting(poisson, 0.0..=0.5), Body::half_space(poisson, 0.0));
        valid_value(is_setting(poisson, 0.0..=0.5) && is_depth, Body::half_space(poisson, depth));
        let is_layer = is_setting(thickness, 1e-50..=1e50) && is_setting(depth, 0.0..=thickness);
        valid_value(is_layer, Body::bonded_layer(thickness, depth));
        valid_value(is_setting(thickness, POSITIVE), Body::gaussian(thickness));
        let skin = valid_value(is_setting(thickness, 1e-50..=1e50), Skin::new(thickness));
        let due = match (curvature, indentation) {
            (k, d) if !(k.is_finite() && d.is_finite()) => Some("out-of-range"),
            (k, _) if k < 0.0 => Some("edge-contact"),
            (0.0, _) => Some("conforming"),
            (_, d) if d <= 0.0 => Some("no-indentation"),
            _ => None,
        };
        for body in bodies(0.5 * (libm::sin(poisson) + 1.0), thickness, depth) {
            let pressed = body.press(curvature, indentation);
            if let Some(due) = due {
                prop_assert_eq!(<&str>::from(pressed.as_ref().unwrap_err()), due);
            }
            let on_skin = skin.map(|skin| skin.contact(&body, curvature, indentation));
            for contact in [Some(pressed), on_skin].into_iter().flatten().flatten() {
                assert_finite(&contact, r, young);
            }
        }
    }

    #[test]
    fn skins_and_shifts_return_numbers_or_the_expected_error(numbers in prop::array::uniform7(any_number())) {
        let [radius, x, y, z, depth, a, shift] = numbers;
        let is_sphere = is_setting(radius, POSITIVE) && is_setting(a, 0.0..radius);
        let indentation = valid_value(is_sphere, sneddon_indentation(radius, a));
        prop_assert!(indentation.is_none_or(f64::is_finite));
        let is_contact = is_setting(depth, 0.0..=1e50) && is_setting(a, 1e-50..=1e50);
        let Some(skin) = valid_value(is_setting(radius, 1e-50..=1e50), Skin::new(radius)) else { return Ok(()) };
        let places = [[0.0, 0.0], [x, y], [y, z]];
        let is_number = |place: &[f64; 2]| place.iter().all(|part| part.abs() <= 1e50);
        let beyond = |[x, y]: &[f64; 2]| libm::hypot(*x, *y) > std::f64::consts::PI * radius * (1.0 + 1e-9);
        let markers = match Markers::new(skin, &places) {
            Ok(markers) => markers,
            Err(PressError::NotFinite { marker }) => {
                prop_assert_eq!(places.iter().position(|place| !is_number(place)), Some(marker));
                return Ok(());
            }
            Err(PressError::OffSkin { marker, .. }) => {
                prop_assert_eq!(places.iter().position(beyond), Some(marker));
                return Ok(());
            }
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        prop_assert!(places.iter().all(|place| is_number(place) && !beyond(place)));
        prop_assert!(markers.distances([z, x]).iter().all(|part| part.is_finite()));
        let is_shift = is_contact && is_setting(shift, -1e50..=1e50);
        let moved = valid_value(is_shift, markers.shifted(0.3, depth, a, [x, y], shift));
        prop_assert!(moved.iter().flatten().flat_map(parts).all(|part| part.is_finite()));
    }

    #[test]
    fn presses_among_the_markers_are_estimated(
        (object, indentation) in (0.0..0.5, 0.5..2.0),
        at in [-3.0..3.0, -3.0..3.0],
        is_known in any::<bool>(),
    ) {
        let markers = square_of_markers();
        let body = Body::half_space(0.5, 2.0).unwrap();
        let contact = markers.skin().contact(&body, object, indentation).unwrap();
        let normal: Vec<f64> = markers.displacements(&contact, at).iter().map(|moved| moved.normal).collect();
        let fit = ForwardFit { normal_std: Some(0.01), ..ForwardFit::new(body.clone()) };
        let reading = Reading {
            markers: &markers,
            normal: &normal,
            tangential: None,
            indentation: is_known.then_some(Measured { value: indentation, std: 0.0 }),
        };
        let found = fit.estimate(&reading).unwrap();
        prop_assert!(is_finite(&found), "{found:?}");
        let left = found.goodness.map_or(f64::INFINITY, |goodness| goodness.chi_squared);
        prop_assert!(left < 1e-3, "{found:?}");
        // With the stated noise, a shallow press of a sharp object hardly determines the curvature. Therefore any
        // estimate of such a press is accepted.
        let is_resolved = found.relative_curvature.std < 0.3 * found.relative_curvature.value;
        let off = found.most_likely_curvature - 0.05 - object;
        prop_assert!(off.abs() < 1e-4 || !is_resolved, "{found:?}");
    }

    #[test]
    fn fits_return_numbers_or_the_expected_error(
        mut readings in prop::collection::vec(-1.0..3.0, 25),
        wrong in prop::option::weighted(0.3, (0..25_usize, any_number())),
        known in prop::option::of([mostly(0.1..2.0), mostly(1e-3..0.1)]),
        stds in prop::array::uniform3(prop::option::of(mostly(1e-3..10.0))),
    ) {
        if let Some((marker, reading)) = wrong {
            readings[marker] = reading;
        }
        let markers = square_of_markers();
        let fit = ForwardFit {
            normal_std: stds[0],
            window: stds[1],
            baseline: stds[2].map_or(Prior::Free, Prior::Within),
            ..ForwardFit::new(Body::half_space(0.5, 2.0).unwrap())
        };
        let reading = Reading {
            markers: &markers,
            normal: &readings,
            tangential: None,
            indentation: known.map(|[value, std]| Measured { value, std }),
        };
        let found = fit.estimate(&reading);
        let are_good = [stds[0], known.map(|[_, std]| std)].iter().flatten().all(|std| is_setting(*std, 0.0..=1e100))
            && stds[1].is_none_or(|window| window > 0.0)
            && stds[2].is_none_or(|std| std > 0.0 && std <= 1e100);
        let due = match known {
            _ if !are_good => Some("bad-setting"),
            Some([value, _]) if !value.is_finite() => Some("out-of-range"),
            Some([value, _]) if value <= 0.0 => Some("no-indentation"),
            _ => readings.iter().any(|one| one.is_nan() || one.abs() > 1e50).then_some("not-finite"),
        };
        if let Some(due) = due {
            prop_assert_eq!(<&str>::from(found.as_ref().unwrap_err()), due);
        }
        prop_assert!(found.is_err() || is_finite(found.as_ref().unwrap()), "{found:?}");
    }

    #[test]
    fn scaled_lengths_scale_the_press(power in -60..60, object in -0.9..20.0, share in 1e-6..0.05, x in -10.0..10.0) {
        let scale = 2f64.powi(power);
        let of = |scale: f64| {
            let skin = Skin::new(20.0 * scale).unwrap();
            let markers = Markers::new(skin, &[[x * scale, scale], [0.0, 3.0 * scale]]).unwrap();
            let body = Body::half_space(0.5, 2.0 * scale).unwrap();
            let contact = skin.contact(&body, object / 20.0 / scale, 20.0 * share * scale).unwrap();
            markers.displacements(&contact, [0.5 * scale, 0.0])
        };
        for (one, scaled) in of(1.0).iter().flat_map(parts).zip(of(scale).iter().flat_map(parts)) {
            prop_assert!((one * scale - scaled).abs() <= 1e-12 * scale * (one.abs() + 1e-3 * share));
        }
    }

    #[test]
    fn displacements_rotate_with_the_markers(angle in 0.0..6.3, r in 0.0..40.0, at in 0.0..40.0, bearing in 0.0..6.3) {
        let skin = Skin::new(20.0).unwrap();
        let body = Body::half_space(0.3, 2.0).unwrap();
        let contact = skin.contact(&body, 0.1, 1.0).unwrap();
        let moved = |turn: f64| {
            let place = |r: f64, bearing: f64| [r * libm::cos(bearing + turn), r * libm::sin(bearing + turn)];
            let markers = Markers::new(skin, &[place(r, bearing)]).unwrap();
            let [x, y] = markers.displacements(&contact, place(at, 0.0))[0].tangential;
            let normal = markers.displacements(&contact, place(at, 0.0))[0].normal;
            [normal, x * libm::cos(turn) + y * libm::sin(turn), y * libm::cos(turn) - x * libm::sin(turn)]
        };
        for (still, turned) in moved(0.0).into_iter().zip(moved(angle)) {
            prop_assert!((still - turned).abs() < 1e-11, "{still} {turned}");
        }
    }
}
