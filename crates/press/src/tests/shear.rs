//! Compares the sideways motion of the skin with a Fourier integral over wavenumbers and directions and with exact
//! formulas, and checks relations at the surface.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::shear::stuck_shift;
use crate::{Markers, Skin, sneddon_indentation};

/// Columns: Poisson's ratio, depth, contact radius, distance, azimuth; displacements along the shift, across the shift
/// and inward. The displacements were computed as a sum of traction waves over 4,000 wavenumbers (Gauss) and 256
/// directions.
#[rustfmt::skip]
const QUADRATURE: [[f64; 8]; 18] = [
    [0.0, 0.5, 2.0, 0.0, 0.0, 0.806593517359, 0.0, 0.0],
    [0.0, 0.5, 2.0, 1.0, 0.4, 0.780864170961, -0.001310411549, 0.083602022178],
    [0.0, 0.5, 2.0, 2.0, 1.1, 0.648569141512, 0.004121679376, 0.106262980214],
    [0.0, 2.0, 2.0, 3.0, 2.5, 0.32529663307, -0.020751849763, -0.121946965268],
    [0.0, 2.0, 5.0, 1.0, 0.7, 0.698574413465, -0.000202844973, 0.027078894188],
    [0.0, 1.0, 0.5, 4.0, 0.9, 0.074754732326, 0.006193215011, 0.024367716889],
    [0.3, 0.5, 2.0, 0.0, 0.0, 0.799985007611, 0.0, 0.0],
    [0.3, 0.5, 2.0, 1.0, 0.4, 0.774752063796, -0.000146796537, 0.047366385657],
    [0.3, 0.5, 2.0, 2.0, 1.1, 0.631602203561, 0.018437861085, 0.070976448093],
    [0.3, 2.0, 2.0, 3.0, 2.5, 0.324003666121, -0.035828151647, -0.097457231075],
    [0.3, 2.0, 5.0, 1.0, 0.7, 0.688868341512, 9.8813508e-05, 0.016986273253],
    [0.3, 1.0, 0.5, 4.0, 0.9, 0.07242985635, 0.015282142969, 0.015473188536],
    [0.5, 0.5, 2.0, 0.0, 0.0, 0.794110776724, 0.0, 0.0],
    [0.5, 0.5, 2.0, 1.0, 0.4, 0.769319079649, 0.000887527918, 0.015156930972],
    [0.5, 0.5, 2.0, 2.0, 1.1, 0.616520480938, 0.031163355938, 0.039610641763],
    [0.5, 2.0, 2.0, 3.0, 2.5, 0.322854362167, -0.049229308878, -0.07568857846],
    [0.5, 2.0, 5.0, 1.0, 0.7, 0.680240721998, 0.00036695438, 0.008015054643],
    [0.5, 1.0, 0.5, 4.0, 0.9, 0.070363299927, 0.023361190043, 0.00756694111],
];

#[test]
fn shifts_match_the_sum_of_traction_waves() {
    for [poisson, depth, a, r, azimuth, along, across, normal] in QUADRATURE {
        let shift = stuck_shift(poisson, depth, a, r, azimuth).unwrap();
        let error = (shift.along - along)
            .abs()
            .max((shift.across - across).abs())
            .max((shift.normal - normal).abs());
        assert!(
            error < 1e-10,
            "{poisson} {depth} {a} {r} {azimuth}: off by {error:e}"
        );
    }
}

#[test]
fn the_contact_moves_as_a_rigid_body() {
    for poisson in [0.0, 0.3, 0.5] {
        for share in [0.0, 0.4, 0.999] {
            for azimuth in [0.0, 0.8, 2.0, 4.0] {
                let shift = stuck_shift(poisson, 0.0, 3.0, 3.0 * share, azimuth).unwrap();
                assert!((shift.along - 1.0).abs() < 1e-14 && shift.across.abs() < 1e-14);
            }
        }
    }
}

#[test]
fn far_from_the_contact_the_shift_is_that_of_a_point_force() {
    // The reference is Cerruti's solution for a point force Q, with Poisson's ratio ν, the contact radius a and the shear
    // modulus G. The contact shifts by Q(2−ν)/(8aG), and Q is chosen such that this shift is 1.
    for (poisson, r, z, azimuth) in [
        (0.0, 3.0, 4.0, 0.5),
        (0.3, 5.0, 0.0, 2.0),
        (0.5, 0.1, 7.0, 4.0),
    ] {
        let a = 1e-5;
        let rho = libm::hypot(r, z);
        let (x, y) = (r * libm::cos(azimuth), r * libm::sin(azimuth));
        let unit = 8.0 * a / (2.0 - poisson) / (4.0 * PI);
        let spread = (1.0 - 2.0 * poisson) / (rho * (rho + z) * (rho + z));
        let along =
            1.0 / rho + x * x / rho.powi(3) + (1.0 - 2.0 * poisson) / (rho + z) - x * x * spread;
        let across = x * y / rho.powi(3) - x * y * spread;
        let normal = x * z / rho.powi(3) + x * spread * (rho + z);
        let shift = stuck_shift(poisson, z, a, r, azimuth).unwrap();
        for (got, expected) in [
            (shift.along, along),
            (shift.across, across),
            (shift.normal, normal),
        ] {
            assert!(
                (got - unit * expected).abs() < 1e-9 * unit,
                "{poisson}: {got} {expected}"
            );
        }
    }
}

/// Checks the displacement at the depth z (in contact radii) below the middle of the contact. For Poisson's ratio ν,
/// this displacement divided by the shift of the contact is [2(2 − ν) atan(1/z) − z/(1 + z²)] / (π(2 − ν)).
#[test]
fn the_shift_below_the_centre_has_a_closed_form() {
    for depth in [0.0, 1e-12, 1e-3, 1.0, 1e3, 1e15] {
        for poisson in [0.0, 0.5] {
            for radius in [1e-30, 1.0, 1e30] {
                let share =
                    2.0 * (2.0 - poisson) * libm::atan2(1.0, depth) - depth / (1.0 + depth * depth);
                let share = share / (PI * (2.0 - poisson));
                let found = stuck_shift(poisson, depth * radius, radius, 0.0, 0.0);
                let found = found.unwrap().along;
                assert!((found / share - 1.0).abs() < 1e-14, "{depth:e}: {found}");
            }
        }
    }
}

#[test]
fn sneddons_indentation_contains_an_inverse_hyperbolic_tangent() {
    for radius in [1e-9, 20.0, 1e9] {
        assert_eq!(sneddon_indentation(radius, 0.0), Ok(0.0));
        for ratio in [1e-140, 1e-9, 0.5, 0.999_999] {
            let a = ratio * radius;
            let found = sneddon_indentation(radius, a).unwrap();
            // If the ratio a/R of contact radius and object radius is nearly 1, `atanh` amplifies the rounding error of
            // a/R.
            let bound = 1e-15 / (1.0 - ratio);
            assert!(
                (found / (a * libm::atanh(a / radius)) - 1.0).abs() < bound,
                "{a:e}"
            );
        }
    }
    for (radius, a) in [(f64::NAN, 0.0), (1.0, 1.0), (1.0, -0.1), (0.0, 0.0)] {
        assert!(sneddon_indentation(radius, a).is_err());
    }
}

#[test]
fn extremes_are_finite_or_named() {
    let extreme = [0.0, 1e-300, 1e-50, 1e-9, 1.0, 1e9, 1e50];
    for z in extreme {
        for r in extreme {
            for a in [1e-50, 1e-9, 1.0, 1e50] {
                let shift = stuck_shift(0.5, z, a, r, FRAC_PI_2).unwrap();
                let sum = shift.along + shift.across + shift.normal;
                assert!(sum.is_finite() && sum.abs() < 2.0, "{z} {r} {a}: {shift:?}");
            }
        }
    }
    let nan = f64::NAN;
    for [poisson, z, a, r, azimuth] in [
        [0.6, 1.0, 1.0, 1.0, 0.0],
        [nan, 1.0, 1.0, 1.0, 0.0],
        [0.5, -1.0, 1.0, 1.0, 0.0],
        [0.5, 1.0, 0.0, 1.0, 0.0],
        [0.5, 1.0, 1.0, nan, 0.0],
        [0.5, 1.0, 1.0, 1.0, f64::INFINITY],
    ] {
        let error = stuck_shift(poisson, z, a, r, azimuth).unwrap_err();
        assert_eq!(<&str>::from(error), "bad-setting");
    }
}

#[test]
fn markers_of_a_nearly_flat_skin_move_as_on_a_plane() {
    let (poisson, depth, contact_radius, shift) = (0.5, 2.0, 4.0, 0.7);
    let places = [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [-4.0, 2.0], [1.0, -5.0]];
    let markers = Markers::new(Skin::new(1e7).unwrap(), &places).unwrap();
    let at = [0.5, -0.25];
    let moved = markers
        .shifted(poisson, depth, contact_radius, at, shift)
        .unwrap();
    for ([x, y], moved) in places.iter().zip(moved) {
        let (x, y) = (x - at[0], y - at[1]);
        let flat = stuck_shift(
            poisson,
            depth,
            contact_radius,
            libm::hypot(x, y),
            libm::atan2(y, x),
        )
        .unwrap();
        let expected = [flat.along, flat.across, flat.normal].map(|one| one * shift);
        // `across` is perpendicular to the direction of the shift, which is along x.
        let found = [moved.tangential[0], moved.tangential[1], moved.normal];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
    let none = markers.subset(&[3, 99, 0]);
    assert_eq!(none.places(), [markers.places()[3], markers.places()[0]]);
    let error = markers.shifted(0.7, depth, contact_radius, at, shift);
    assert_eq!(<&str>::from(error.unwrap_err()), "bad-setting");
}
