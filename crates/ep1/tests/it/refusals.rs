//! Readings that do not determine the curvature cause a named error.

use nalgebra::{Matrix2, Rotation2, Vector2};
use palpate_ep1::{Ep1Error, Estimate, LeastSquares, ProbeReading, ReadingNoise};

use crate::{eight, isotropic, readings};

fn estimate(readings: &[ProbeReading]) -> Result<Estimate, Ep1Error> {
    LeastSquares::of(1.0, ReadingNoise::default(), readings)
}

#[test]
fn a_contact_that_did_not_move_bounds_the_radius() {
    let mut readings = readings(1.0, &isotropic(1.0), &eight(0.1));
    for reading in &mut readings {
        reading.shift.x = 0.0;
    }
    let noise = ReadingNoise {
        shift_resolution: 0.01,
        ..Default::default()
    };
    let error = LeastSquares::of(1.0, noise, &readings).unwrap_err();
    let Ep1Error::Unresolved {
        direction_rad,
        radius_below: Some(bound),
    } = error
    else {
        panic!("{error}");
    };
    // The probe turned by 0.1 rad, but its contact moved by less than the resolution of 0.01. The relative curvature is
    // therefore at least 10.
    assert!(direction_rad.abs() < 1e-6);
    let relative = 0.1 / 0.01;
    assert!((bound - 1.0 / (relative - 1.0)).abs() < 1e-12, "{bound}");
    assert!(error.to_string().contains("radius below 0.11"), "{error}");
    // Without a stated resolution, there is no bound on the radius.
    let error = estimate(&readings).unwrap_err();
    assert!(
        matches!(
            error,
            Ep1Error::Unresolved {
                radius_below: None,
                ..
            }
        ),
        "{error}"
    );
}

/// In each of two perpendicular directions, the contact moves forward, backward or not at all. An estimate is returned
/// only if it moves forward in both.
#[test]
fn a_curvature_needs_contacts_that_move_forwards_in_every_direction() {
    let sizes = [0.0, 1e-16, 1e-14, 1e-13, 1e-9, 0.5];
    let travels = || sizes.into_iter().flat_map(|size| [size, -size]);
    for along in travels() {
        for (across, turned) in travels().flat_map(|across| [(across, 0.0), (across, 0.4)]) {
            let axes = Rotation2::new(turned).into_inner();
            let travel = axes * Matrix2::from_diagonal(&[along, across].into()) * axes.transpose();
            let readings: Vec<ProbeReading> = eight(0.1)
                .into_iter()
                .map(|(direction, theta)| {
                    let drive = Vector2::new(libm::cos(direction), libm::sin(direction)) * theta;
                    ProbeReading {
                        rotation: Vector2::new(drive.y, -drive.x),
                        shift: travel * drive,
                    }
                })
                .collect();
            let smallest = along.min(across);
            let expected = if smallest < -1e-12 {
                Some("not-rolling")
            } else if smallest < 1e-12 {
                Some("unresolved")
            } else {
                None
            };
            let found = estimate(&readings).err().map(<&str>::from);
            assert_eq!(found, expected, "{along:e}, {across:e} at {turned}");
        }
    }
}

#[test]
fn readings_that_are_not_numbers_are_named() {
    let good = readings(1.0, &isotropic(1.0), &eight(0.1));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..4 {
            let mut readings = good.clone();
            let reading = &mut readings[5];
            match place {
                0 => reading.rotation.x = bad,
                1 => reading.rotation.y = bad,
                2 => reading.shift.x = bad,
                _ => reading.shift.y = bad,
            }
            assert_eq!(
                estimate(&readings).unwrap_err(),
                Ep1Error::NotFinite { probe: 5 }
            );
        }
    }
}

/// The estimate from probes that rotate by `theta` along u and by `theta * across` along v.
fn lopsided(theta: f64, across: f64) -> Result<Estimate, Ep1Error> {
    let rolls = [
        (0.0, theta),
        (std::f64::consts::FRAC_PI_2, theta * across),
        (std::f64::consts::PI, theta),
    ];
    estimate(&readings(1.0, &isotropic(0.5), &rolls))
}

#[test]
fn rotations_must_span_the_plane_and_have_squares_in_range() {
    for theta in [1e-40, 1e-12, 6000.0, 1e40] {
        for across in [1.0, 1e-4] {
            let form = lopsided(theta, across).unwrap().curvature;
            assert!((form.k_uu - 0.5).abs() < 1e-14);
            // `across` is the rotation across u, divided by the rotation along u. The normal equations contain its
            // square, so the tolerance is divided by this square.
            assert!((form.k_vv - 0.5).abs() < 1e-14 / across / across);
        }
        assert_eq!(
            <&str>::from(lopsided(theta, 1e-7).unwrap_err()),
            "unresolvable-set"
        );
    }
    for theta in [1e-60, 1e60] {
        assert_eq!(lopsided(theta, 1.0), Err(Ep1Error::OutOfRange));
    }
    let noise = ReadingNoise {
        shift_std: 1e200,
        ..Default::default()
    };
    let readings = readings(1.0, &isotropic(0.5), &eight(0.1));
    let found = LeastSquares::of(1.0, noise, &readings);
    assert_eq!(found, Err(Ep1Error::OutOfRange));
}
