//! Compares the displacements of the bonded layer with values from an independent solver and with limiting cases, and
//! checks equations that every solution satisfies.

use std::f64::consts::PI;

use proptest::prelude::*;

use crate::body::Field;
use crate::bonded_layer::{BondedLayer, LayerContact};
use crate::{Body, PressError};

/// Columns: effective radius, indentation, thickness of the layer, contact radius, depth, distance from the axis,
/// normal displacement. The displacements are accurate to 0.3 %.
const GOLDEN: [[f64; 7]; 45] = [
    [20.0, 1.0, 5.0, 6.17679, 0.0, 0.0, 1.0],
    [20.0, 1.0, 5.0, 6.17679, 0.0, 1.0, 0.975],
    [20.0, 1.0, 5.0, 6.17679, 0.0, 2.0, 0.9],
    [20.0, 1.0, 5.0, 6.17679, 0.0, 4.0, 0.6],
    [20.0, 1.0, 5.0, 6.17679, 0.0, 6.0, 0.1],
    [20.0, 1.0, 5.0, 6.17679, 0.5, 0.0, 0.9038],
    [20.0, 1.0, 5.0, 6.17679, 0.5, 1.0, 0.88119],
    [20.0, 1.0, 5.0, 6.17679, 0.5, 2.0, 0.81325],
    [20.0, 1.0, 5.0, 6.17679, 0.5, 4.0, 0.53776],
    [20.0, 1.0, 5.0, 6.17679, 0.5, 6.0, 0.08062],
    [20.0, 1.0, 5.0, 6.17679, 2.0, 0.0, 0.5328],
    [20.0, 1.0, 5.0, 6.17679, 2.0, 1.0, 0.51862],
    [20.0, 1.0, 5.0, 6.17679, 2.0, 2.0, 0.47554],
    [20.0, 1.0, 5.0, 6.17679, 2.0, 4.0, 0.29895],
    [20.0, 1.0, 5.0, 6.17679, 2.0, 6.0, 0.04583],
    [20.0, 1.0, 10.0, 5.42319, 0.0, 0.0, 1.0],
    [20.0, 1.0, 10.0, 5.42319, 0.0, 1.0, 0.975],
    [20.0, 1.0, 10.0, 5.42319, 0.0, 2.0, 0.9],
    [20.0, 1.0, 10.0, 5.42319, 0.0, 4.0, 0.6],
    [20.0, 1.0, 10.0, 5.42319, 0.0, 6.0, 0.16592],
    [20.0, 1.0, 10.0, 5.42319, 0.5, 0.0, 0.97142],
    [20.0, 1.0, 10.0, 5.42319, 0.5, 1.0, 0.94666],
    [20.0, 1.0, 10.0, 5.42319, 0.5, 2.0, 0.87243],
    [20.0, 1.0, 10.0, 5.42319, 0.5, 4.0, 0.57591],
    [20.0, 1.0, 10.0, 5.42319, 0.5, 6.0, 0.16264],
    [20.0, 1.0, 10.0, 5.42319, 2.0, 0.0, 0.79334],
    [20.0, 1.0, 10.0, 5.42319, 2.0, 1.0, 0.77106],
    [20.0, 1.0, 10.0, 5.42319, 2.0, 2.0, 0.7049],
    [20.0, 1.0, 10.0, 5.42319, 2.0, 4.0, 0.45605],
    [20.0, 1.0, 10.0, 5.42319, 2.0, 6.0, 0.16337],
    [16.0, 0.6, 8.0, 3.66509, 0.0, 0.0, 0.6],
    [16.0, 0.6, 8.0, 3.66509, 0.0, 1.0, 0.56875],
    [16.0, 0.6, 8.0, 3.66509, 0.0, 2.0, 0.475],
    [16.0, 0.6, 8.0, 3.66509, 0.0, 4.0, 0.12924],
    [16.0, 0.6, 8.0, 3.66509, 0.0, 6.0, 0.01259],
    [16.0, 0.6, 8.0, 3.66509, 0.5, 0.0, 0.57576],
    [16.0, 0.6, 8.0, 3.66509, 0.5, 1.0, 0.54487],
    [16.0, 0.6, 8.0, 3.66509, 0.5, 2.0, 0.45241],
    [16.0, 0.6, 8.0, 3.66509, 0.5, 4.0, 0.12957],
    [16.0, 0.6, 8.0, 3.66509, 0.5, 6.0, 0.00934],
    [16.0, 0.6, 8.0, 3.66509, 2.0, 0.0, 0.41502],
    [16.0, 0.6, 8.0, 3.66509, 2.0, 1.0, 0.39057],
    [16.0, 0.6, 8.0, 3.66509, 2.0, 2.0, 0.32088],
    [16.0, 0.6, 8.0, 3.66509, 2.0, 4.0, 0.12093],
    [16.0, 0.6, 8.0, 3.66509, 2.0, 6.0, 0.01138],
];

const WIDTHS: [f64; 10] = [1e-9, 1e-3, 0.1, 0.74, 0.76, 1.24, 2.9, 5.9, 11.9, 30.0];

fn solve_contact(thickness: f64, depth: f64, a: f64) -> LayerContact {
    BondedLayer::new(thickness, depth)
        .unwrap()
        .solved(a)
        .unwrap()
}

fn numbers(field: Field) -> [f64; 6] {
    [
        field.normal,
        field.radial,
        field.normal_per_r,
        field.radial_per_r,
        field.normal_per_a,
        field.radial_per_a,
    ]
}

#[test]
fn golden_displacements() {
    for [radius, indentation, thickness, contact, depth, r, normal] in GOLDEN {
        let body = Body::bonded_layer(thickness, depth).unwrap();
        let press = body.press(1.0 / radius, indentation).unwrap();
        let wider = press.radius / contact - 1.0;
        assert!(
            wider.abs() < 5e-4,
            "radius {} off by {wider:e}",
            press.radius
        );
        let error = press.displacement(r).normal / normal - 1.0;
        assert!(
            error.abs() < 1.3e-3,
            "at r = {r}, z = {depth}, h = {thickness}: off by {error:e}"
        );
    }
}

#[test]
fn the_surface_follows_the_object_within_the_contact() {
    for a in WIDTHS {
        let contact = solve_contact(1.0, 0.0, a);
        let [indentation, _] = contact.indentation();
        for share in 0..=20 {
            let r = a * f64::from(share) / 20.0;
            let error = contact.field(r).normal - (indentation - 0.5 * r * r);
            assert!(
                error.abs() < 1e-9 * indentation,
                "a = {a}, r = {r}: off by {error:e}"
            );
        }
        // Outside of the contact, the object must not penetrate the layer, so the gap is positive.
        let gap = contact.field(1.2 * a).normal - (indentation - 0.72 * a * a);
        assert!(gap > 0.0, "a = {a}: {gap:e}");
    }
}

#[test]
fn the_volume_is_conserved() {
    // The layer is incompressible, so the divergence of the displacement is 0. The derivative with respect to depth is
    // computed as a finite difference.
    for (a, depth) in [(0.3, 0.2), (1.2, 0.4), (1.2, 0.9), (4.0, 0.5), (9.0, 0.3)] {
        let step = 1e-4;
        let [above, here, below] =
            [-step, 0.0, step].map(|shift| solve_contact(1.0, depth + shift, a));
        for r in [0.2, 0.7, 1.1, 2.5, 5.0] {
            let stretched = (below.field(r).normal - above.field(r).normal) / (2.0 * step);
            let Field {
                radial,
                radial_per_r,
                ..
            } = here.field(r);
            let spread = radial_per_r + radial / r;
            let size = radial_per_r.abs() + (radial / r).abs() + 0.1 * a * a;
            assert!(
                (stretched + spread).abs() < 1e-6 * size,
                "{a} {depth} {r}: {stretched} {spread}"
            );
        }
    }
}

#[test]
fn a_thick_layer_is_a_half_space() {
    for (a, depth) in [(1.0, 0.0), (1.0, 0.5), (3.0, 2.0), (0.2, 2.0)] {
        let layer = BondedLayer::new(1e9, depth).unwrap();
        let half_space = Body::half_space(0.5, depth).unwrap();
        let press = half_space.press(1.0, a * a).unwrap();
        for contact in [layer.solved(a).unwrap(), layer.contact(a).unwrap()] {
            for r in [0.0, 0.3, 0.99, 1.5, 20.0] {
                let (got, expected) = (contact.field(r), press.displacement(r));
                let error = (got.normal - expected.normal)
                    .abs()
                    .max((got.radial - expected.radial).abs());
                assert!(error < 1e-7 * expected.normal, "{a} {depth} {r}: {error:e}");
            }
            let young = 3.0;
            let force = contact.force() * young / 0.75;
            assert!((force / press.force(young).unwrap() - 1.0).abs() < 1e-7);
            let peak = contact.peak_pressure() * young / 0.75;
            assert!((peak / press.peak_pressure(young).unwrap() - 1.0).abs() < 1e-7);
        }
    }
}

#[test]
fn a_thin_layer_flows_outward() {
    // Let a be the contact radius, h the thickness of the layer, R the effective radius, δ the indentation, and r the
    // distance from the axis. By lubrication theory, a² is 4 R δ, and the pressure is (3/128) (E*/h³ R) (a² − r²)²,
    // with the modulus E*. The neglected terms decrease with h/a.
    let ratios = |a: f64| {
        let contact = solve_contact(1.0, 0.0, a);
        [
            4.0 * contact.indentation()[0] / (a * a),
            2.0 * contact.indentation()[1] / a,
            libm::pow(contact.force() / (PI / 128.0 * a.powi(6)), 1.0 / 6.0),
            libm::pow(contact.peak_pressure() / (3.0 / 128.0 * a.powi(4)), 0.25),
        ]
    };
    for (half, whole) in ratios(25.0).into_iter().zip(ratios(50.0)) {
        assert!((whole - 1.0).abs() < 0.06, "{whole}");
        assert!((2.0 * whole - half - 1.0).abs() < 0.005, "{half} {whole}");
    }
}

#[test]
fn nothing_moves_at_the_base() {
    for a in [0.01, 1.0, 10.0] {
        assert_eq!(solve_contact(1.0, 1.0, a).field(0.5), Field::default());
        // Near the rigid base, the normal displacement is proportional to the square of the distance from the base, and
        // the radial displacement to the distance.
        let [near, nearer] =
            [0.998, 0.999].map(|depth| solve_contact(1.0, depth, a).field(0.5 * a));
        assert!(
            (near.normal / nearer.normal - 4.0).abs() < 0.02,
            "{near:?} {nearer:?}"
        );
        assert!(
            (near.radial / nearer.radial - 2.0).abs() < 0.01,
            "{near:?} {nearer:?}"
        );
    }
}

#[test]
fn tables_agree_with_solutions() {
    for depth in [0.0, 0.01, 0.4, 0.8] {
        let layer = BondedLayer::new(1.0, depth).unwrap();
        for a in WIDTHS {
            let (exact, table) = (layer.solved(a).unwrap(), layer.contact(a).unwrap());
            let [indentation, slope] = exact.indentation();
            assert!((table.indentation()[0] / indentation - 1.0).abs() < 1e-9);
            assert!((table.indentation()[1] / slope - 1.0).abs() < 1e-8);
            assert!((table.force() / exact.force() - 1.0).abs() < 1e-9);
            assert!((table.peak_pressure() / exact.peak_pressure() - 1.0).abs() < 1e-9);
            let peak = exact.field(0.0).normal;
            for step in 0..60 {
                let r = f64::from(step) * (a + 3.0) / 40.0;
                let (exact, table) = (numbers(exact.field(r)), numbers(table.field(r)));
                for (which, (exact, table)) in exact.into_iter().zip(table).enumerate() {
                    let tolerance = if which < 2 {
                        1e-7
                    } else {
                        1e-6 * (1.0 + 1.0 / a)
                    };
                    let error = (exact - table).abs() / peak;
                    assert!(
                        error < tolerance,
                        "z = {depth}, a = {a}, r = {r}, {which}: {error:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn derivatives_match_finite_differences() {
    for (depth, a) in [(0.05, 0.3), (0.4, 1.2), (0.4, 0.02), (0.7, 5.0)] {
        let layer = BondedLayer::new(1.0, depth).unwrap();
        let step = 1e-4 * f64::min(a, depth);
        let slope = |ahead: f64, behind: f64| (ahead - behind) / (2.0 * step);
        let [before, here, after] =
            [-step, 0.0, step].map(|shift| layer.contact(a + shift).unwrap());
        let peak = here.field(0.0).normal;
        let by_difference = slope(after.indentation()[0], before.indentation()[0]);
        assert!((by_difference / here.indentation()[1] - 1.0).abs() < 1e-6);
        for r in [0.0, 0.5 * a, a, 1.3 * a, a + 2.0] {
            let got = numbers(here.field(r));
            let (wider, narrower) = (numbers(after.field(r)), numbers(before.field(r)));
            let (farther, nearer) = (numbers(here.field(r + step)), numbers(here.field(r - step)));
            for i in 0..2 {
                let by_a = slope(wider[i], narrower[i]) - got[4 + i];
                assert!(
                    by_a.abs() < 1e-6 * peak / a,
                    "{depth} {a} {r}: {by_a:e} by a"
                );
                let by_r = slope(farther[i], nearer[i]) - got[2 + i];
                assert!(
                    r == 0.0 || by_r.abs() < 1e-6 * peak / a,
                    "{depth} {a} {r}: {by_r:e} by r"
                );
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn layers_of_any_size_support_contacts_up_to_fifty_thicknesses(
        (size, depth) in (-50.0..50.0, 0.0..1.0),
        (width, r) in (-50.0..1.69, -3.0..3.0),
    ) {
        let [thickness, width] = [size, width].map(|power| libm::pow(10.0, power));
        let layer = BondedLayer::new(thickness, depth * thickness).unwrap();
        let contact = layer.contact(width * thickness).unwrap();
        let [indentation, slope] = contact.indentation();
        let mut all = vec![indentation, slope, contact.force(), contact.peak_pressure()];
        all.extend(numbers(contact.field(r * thickness)));
        prop_assert!(all.iter().all(|part| part.is_finite()), "{all:?}");
        let again = layer.contact_radius(indentation).unwrap();
        prop_assert!((again / (width * thickness) - 1.0).abs() < 1e-9, "{again:e}");
    }
}

#[test]
fn settings_and_widths_out_of_range_have_names() {
    let name = |error: PressError| <&str>::from(error);
    let nan = f64::NAN;
    for (thickness, depth) in [
        (0.0, 0.0),
        (-1.0, 0.0),
        (nan, 0.0),
        (1e51, 0.0),
        (5.0, 5.1),
        (5.0, nan),
    ] {
        let error = BondedLayer::new(thickness, depth).err().map(name);
        assert_eq!(error, Some("bad-setting"), "{thickness} {depth}");
    }
    let layer = BondedLayer::new(0.1, 0.05).unwrap();
    for wide in [5.01, 1e9, 1e150, f64::INFINITY] {
        assert_eq!(layer.contact(wide).err().map(name), Some("layer-too-thin"));
        let indentation = 0.264_102 * wide * wide;
        assert_eq!(
            layer.contact_radius(indentation).map_err(name),
            Err("layer-too-thin")
        );
    }
    for wrong in [0.0, -1.0, nan] {
        assert_eq!(layer.contact(wrong).err().map(name), Some("out-of-range"));
        assert_eq!(
            layer.contact_radius(wrong).map_err(name),
            Err("no-indentation")
        );
    }
}

#[test]
fn errors_decrease_with_resolution_and_invalid_ones_are_refused() {
    let layer = |resolution: f64| Body::solved_layer_at(5.0, 2.0, resolution);
    let field = |resolution: f64| {
        let moved = layer(resolution).unwrap();
        let moved = moved.press(0.1, 0.5).unwrap().displacement(3.0);
        [moved.normal, moved.radial]
    };
    let finest = field(2.0);
    let off = |resolution: f64| {
        let pairs = field(resolution).into_iter().zip(finest);
        pairs.fold(0.0, |most: f64, (one, best)| most.max((one - best).abs()))
    };
    let errors = [0.125, 0.25, 0.5, 1.0].map(off);
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    assert!(errors[0] > 1e-4 && errors[3] < 1e-9, "{errors:?}");
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0, 0.06, 16.1] {
        assert!(layer(bad).is_err(), "{bad}");
    }
}

/// Layers that share tables must have the same displacements as layers with separate tables.
#[test]
fn a_layer_at_several_depths_equals_separate_layers() {
    for thickness in [1e-40, 1.0, 1e40] {
        let depths = [0.0, 0.2, 0.75, 1.0].map(|share| share * thickness);
        let layers = BondedLayer::at_depths(thickness, &depths).unwrap();
        for (layer, depth) in layers.iter().zip(depths) {
            let alone = BondedLayer::new(thickness, depth).unwrap();
            for contact in [0.3, 1.2] {
                let contact = contact * thickness;
                let [shared, own] = [layer, &alone].map(|layer| layer.contact(contact).unwrap());
                let area = thickness * thickness;
                let most = own.field(0.0).normal.abs().max(1e-3 * area);
                for r in [0.0, 0.1, 0.9, 2.0, 6.0] {
                    let [shared, own] = [&shared, &own].map(|contact| contact.field(r * thickness));
                    for (part, (shared, own)) in
                        numbers(shared).into_iter().zip(numbers(own)).enumerate()
                    {
                        let unit = if part < 2 { most } else { most / thickness };
                        assert!(
                            (shared - own).abs() < 1e-8 * unit,
                            "{depth:e} {r}: {shared} {own}"
                        );
                    }
                }
            }
        }
    }
    assert!(Body::bonded_layers(1.0, &[0.5, 1.5]).is_err());
    assert!(Body::bonded_layers(1.0, &[]).unwrap().is_empty());
}
