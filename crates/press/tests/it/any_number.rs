//! Whatever the numbers: a finite answer or a named error.

use nalgebra::Vector3;
use palpate_press::hertz::{published_parabola, sneddon_indentation};
use palpate_press::shear::stuck_shift;
use palpate_press::{
    Body, BondedLayer, Contact, ForwardFit, MarkerDisplacement, Markers, Measured, Prior, Reading,
    Skin,
};
use proptest::prelude::*;

/// Any double, those of everyday size as often as all the others.
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
fn a_direction_too_long_to_be_squared_still_has_its_chart() {
    let skin = Skin::new(2.0).unwrap();
    let [x, y] = skin.chart(&Vector3::new(1e308, 0.0, 1e308));
    assert!((x - std::f64::consts::FRAC_PI_2).abs() < 1e-15 && y == 0.0);
    assert_eq!(skin.chart(&Vector3::new(f64::NAN, 1.0, 0.0)), [0.0; 2]);
}

#[test]
fn places_that_are_none_count_as_the_apex_and_distances_that_are_none_move_nothing() {
    let skin = Skin::new(20.0).unwrap();
    assert_eq!(skin.place([f64::NAN, 1.0]), skin.place([0.0, 0.0]));
    assert_eq!(skin.place([f64::INFINITY, 1.0]), skin.place([0.0, 0.0]));
    for body in bodies(0.5, 5.0, 2.0) {
        let contact = body.press(0.1, 1.0).unwrap();
        for r in [f64::NAN, f64::INFINITY, f64::MAX] {
            assert_eq!(contact.displacement(r).normal, 0.0);
        }
        assert_eq!(contact.displacement(-3.0), contact.displacement(3.0));
        assert_eq!(contact.force(f64::INFINITY), None);
    }
}

/// The cosine of twice the azimuth, which may leave the doubles.
#[test]
fn shifts_know_any_azimuth() {
    let moved = stuck_shift(0.3, 0.0, 1.0, 0.5, f64::MAX).unwrap();
    assert!((moved.along - 1.0).abs() < 1e-15 && moved.across.abs() < 1e-15);
    let markers = Markers::new(Skin::new(20.0).unwrap(), &[[1.0, 2.0]]).unwrap();
    for shift in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(markers.shifted(0.3, 2.0, 4.0, [0.0; 2], shift).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bodies_give_numbers_or_errors(numbers in prop::array::uniform7(any_number())) {
        let [poisson, thickness, depth, curvature, indentation, r, young] = numbers;
        for body in bodies(0.5 * (libm::sin(poisson) + 1.0), thickness, depth) {
            if let Ok(contact) = body.press(curvature, indentation) {
                assert_finite(&contact, r, young);
            }
            if let Ok(skin) = Skin::new(thickness)
                && let Ok(contact) = skin.contact(&body, curvature, indentation)
            {
                assert_finite(&contact, r, young);
            }
        }
        let _ = Body::hertz(poisson);
    }

    #[test]
    fn layers_give_numbers_or_errors(numbers in prop::array::uniform4(any_number())) {
        let [thickness, depth, a, r] = numbers;
        let Ok(layer) = BondedLayer::new(thickness, depth) else { return Ok(()) };
        let _ = layer.contact_radius(a);
        if let Ok(contact) = layer.contact(a) {
            let field = contact.field(r);
            let [indentation, slope] = contact.indentation();
            let all = [field.normal, field.radial, field.normal_per_r, field.normal_per_a,
                field.radial_per_r, field.radial_per_a, indentation, slope, contact.force(),
                contact.peak_pressure()];
            prop_assert!(all.iter().all(|part| part.is_finite()), "{numbers:?}: {all:?}");
        }
    }

    #[test]
    fn skins_and_shifts_give_numbers_or_errors(numbers in prop::array::uniform7(any_number())) {
        let [radius, x, y, z, depth, a, shift] = numbers;
        prop_assert!(published_parabola(x, y, z).is_finite());
        if let Ok(indentation) = sneddon_indentation(radius, a) {
            prop_assert!(indentation.is_finite());
        }
        if let Ok(moved) = stuck_shift(0.3, depth, a, x.abs(), y) {
            prop_assert!([moved.along, moved.across, moved.normal].iter().all(|part| part.is_finite()));
        }
        let Ok(skin) = Skin::new(radius) else { return Ok(()) };
        let place = skin.place([x, y]);
        prop_assert!((place.direction.norm() - 1.0).abs() < 1e-12);
        prop_assert!((place.x_axis.norm() - 1.0).abs() < 1e-12);
        prop_assert!(skin.chart(&Vector3::new(x, y, z)).iter().all(|part| part.is_finite()));
        let Ok(markers) = Markers::new(skin, &[[0.0, 0.0], [x, y], [y, z]]) else { return Ok(()) };
        prop_assert!(markers.distances([z, x]).iter().all(|part| part.is_finite()));
        if let Ok(moved) = markers.shifted(0.3, depth, a, [x, y], shift) {
            prop_assert!(moved.iter().flat_map(parts).all(|part| part.is_finite()));
        }
    }

    #[test]
    fn fits_give_numbers_or_errors(
        readings in prop::collection::vec(any_number(), 9),
        known in prop::option::of([any_number(), any_number()]),
        stds in prop::array::uniform3(prop::option::of(any_number())),
    ) {
        let skin = Skin::new(20.0).unwrap();
        let at = |index: usize| 5.0 * (index as f64 - 1.0);
        let places: Vec<[f64; 2]> = (0..9).map(|index| [at(index % 3), at(index / 3)]).collect();
        let markers = Markers::new(skin, &places).unwrap();
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
        if let Ok(found) = fit.estimate(&reading) {
            let mut numbers = vec![found.r_squared, found.reduced_chi_squared, found.contact[0]];
            for estimated in [found.relative_curvature, found.object_curvature(), found.effective_radius(),
                found.indentation, found.contact_radius] {
                numbers.extend([estimated.value, estimated.std]);
                numbers.extend([estimated.interval.low, estimated.interval.high].into_iter().flatten());
            }
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{found:?}");
        }
    }

    /// All lengths times a power of two: so are displacements, and curvatures through it, to the last bit.
    #[test]
    fn scaled_lengths_scale_the_press(power in -60..60, object in -0.9..20.0, share in 1e-6..0.05, x in -10.0..10.0) {
        let scale = 2f64.powi(power);
        let of = |scale: f64| {
            let skin = Skin::new(20.0 * scale).unwrap();
            let markers = Markers::new(skin, &[[x * scale, scale], [0.0, 3.0 * scale]]).unwrap();
            let body = Body::half_space(0.5, 2.0 * scale).unwrap();
            let contact = skin.contact(&body, object / 20.0 / scale, 20.0 * share * scale).ok()?;
            Some(markers.displacements(&contact, [0.5 * scale, 0.0]))
        };
        let (Some(one), Some(scaled)) = (of(1.0), of(scale)) else { return Ok(()) };
        for (one, scaled) in one.iter().flat_map(parts).zip(scaled.iter().flat_map(parts)) {
            prop_assert!((one * scale - scaled).abs() <= 1e-12 * scale * (one.abs() + 1e-3 * share));
        }
    }

    /// A contact on the markers' other side moves them as much.
    #[test]
    fn turned_places_are_moved_alike(angle in 0.0..6.3, r in 0.0..40.0, at in 0.0..40.0, bearing in 0.0..6.3) {
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
