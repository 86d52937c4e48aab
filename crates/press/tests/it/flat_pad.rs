//! Fits of presses with a flat pad. A flat pad is the limit of spheres with increasing radius.

use approx::assert_relative_eq;
use palpate_press::{Body, ForwardFit, Markers, PressError, PressEstimate, Skin};

use crate::sensor::{Readings, exactly, fit_of};

fn grid(radius: f64) -> Markers {
    let places: Vec<[f64; 2]> = (0..13 * 11)
        .map(|marker| [f64::from(marker % 13 - 6), f64::from(marker / 13 - 5)])
        .collect();
    Markers::new(Skin::new(radius).unwrap(), &places).unwrap()
}

/// The estimate from a press of a sensor with the radius `radius` on a ball of radius 4. `indentation` is the stated
/// indentation, `None` if it is fitted. The contact is not at the apex, but at the skin coordinates (1.2, −0.7).
fn estimate(radius: f64, fit: &ForwardFit, indentation: Option<f64>) -> PressEstimate {
    let markers = grid(radius);
    let contact = markers.skin().contact(&fit.body, 0.25, 0.5).unwrap();
    let readings = Readings::of(&markers, &contact, [1.2, -0.7]);
    fit.estimate(&readings.reading(&markers, indentation.and_then(exactly)))
        .unwrap()
}

#[test]
fn a_flat_pad_is_the_limit_of_large_radii() {
    let bodies = [
        Body::half_space(0.5, 0.0).unwrap(),
        Body::half_space(0.4, 0.5).unwrap(),
        Body::bonded_layer(3.0, 0.5).unwrap(),
    ];
    for (body, is_elliptic) in bodies.into_iter().zip([true, false, false]) {
        let fit = ForwardFit {
            is_elliptic,
            ..ForwardFit::new(body)
        };
        for known in [None, Some(0.5)] {
            let flat = estimate(f64::INFINITY, &fit, known);
            assert_eq!(flat.sensor_curvature, 0.0);
            for radius in [1e11, 1e30] {
                let large = estimate(radius, &fit, known);
                let values = |one: &PressEstimate| {
                    [
                        one.relative_curvature.value,
                        one.most_likely_object_curvature(),
                        one.indentation.value,
                        one.contact_radius.value,
                        one.contact[0],
                        one.contact[1],
                    ]
                };
                for (large, flat) in values(&large).into_iter().zip(values(&flat)) {
                    assert_relative_eq!(large, flat, max_relative = 1e-9);
                }
            }
            let found = flat.most_likely_object_curvature();
            assert_relative_eq!(found, 0.25, max_relative = 1e-4);
            assert!(flat.object_curvature().interval.high.is_some());
        }
    }
}

/// Exact displacements contain only errors of the computation and of the printed digits. They must not make a marker an outlier.
#[test]
fn printed_digits_make_no_marker_wrong() {
    let (markers, body) = (grid(f64::INFINITY), Body::half_space(0.5, 0.0).unwrap());
    for curvature in [0.07, 0.1, 0.25] {
        for digits in [1e4, 1e5, 1e6] {
            let contact = markers.skin().contact(&body, curvature, 0.5).unwrap();
            let mut readings = Readings::of(&markers, &contact, [0.0; 2]);
            for normal in &mut readings.normal {
                let unit = 10.0_f64.powf(normal.abs().log10().floor()) / digits;
                *normal = (*normal / unit).round() * unit;
            }
            let fit = ForwardFit::new(body.clone());
            let found = fit.estimate(&readings.reading(&markers, None)).unwrap();
            assert!(found.wrong_markers.is_empty(), "{curvature} {digits}");
        }
    }
}

/// With coarse markers and an unknown indentation, a small and a large ball explain the readings equally well.
#[test]
fn intervals_of_coarse_markers_hold_the_curvature() {
    let place =
        |marker: i32| [f64::from(marker % 6), f64::from(marker / 6)].map(|at| 3.0 * at - 7.5);
    let places: Vec<[f64; 2]> = (0..36).map(place).collect();
    let markers = Markers::new(Skin::new(f64::INFINITY).unwrap(), &places).unwrap();
    let body = Body::half_space(0.0, 0.5).unwrap();
    let contact = markers.skin().contact(&body, 0.25, 1.0).unwrap();
    let exact = Readings::of(&markers, &contact, [0.2, 0.3]);
    let held = (0..20).filter(|trial| {
        let noisy = exact.noisy(0.02, *trial);
        let found = fit_of(&body, 0.02).estimate(&noisy.reading(&markers, None));
        let interval = found.unwrap().relative_curvature.interval;
        interval.low.unwrap_or(0.0) < 0.25 && interval.high.is_none_or(|high| high > 0.25)
    });
    assert!(held.count() >= 17);
}

#[test]
fn a_row_of_markers_on_a_flat_pad_determines_the_curvature_along_it() {
    let places: Vec<[f64; 2]> = (0..21)
        .map(|step| [0.5 * f64::from(step - 10), 0.3])
        .collect();
    let skin = Skin::new(f64::INFINITY).unwrap();
    let markers = Markers::new(skin, &places).unwrap();
    let body = Body::half_space(0.5, 0.0).unwrap();
    let contact = skin.contact(&body, 0.1, 0.5).unwrap();
    let readings = Readings::of(&markers, &contact, [0.4, 0.3]);
    let mut reading = readings.reading(&markers, None);
    reading.tangential = None;
    let found = ForwardFit::new(body).estimate(&reading).unwrap();
    assert_relative_eq!(found.most_likely_curvature, 0.1, max_relative = 1e-6);
    assert!(found.contact_std[1] < 1e-100);
}

#[test]
fn a_plane_has_no_contact_point_on_a_flat_pad() {
    let skin = Skin::new(f64::INFINITY).unwrap();
    let body = Body::half_space(0.5, 0.0).unwrap();
    let press = |object| skin.contact(&body, object, 0.5).err();
    assert!(matches!(press(0.0), Some(PressError::Conforming { .. })));
    assert!(matches!(press(-0.1), Some(PressError::EdgeContact { .. })));
}

/// A plane moves all markers equally, apart from noise and a tilt. The interval must hold the curvature 0.
#[test]
fn a_plane_is_flat_within_the_noise() {
    let markers = grid(f64::INFINITY);
    let fit = fit_of(&Body::half_space(0.5, 0.5).unwrap(), 0.01);
    let tilted = (0..13 * 11).map(|marker| 0.4 + 0.002 * f64::from(marker % 13));
    let readings = Readings::inward(tilted.collect());
    let held = (0..100).filter(|trial| {
        let found = fit.estimate(&readings.noisy(0.01, *trial).reading(&markers, None));
        found.unwrap().object_curvature().interval.holds(0.0)
    });
    assert!((90..100).contains(&held.count()));
    let mut with_outlier = readings.noisy(0.01, 1);
    with_outlier.normal[0] *= 0.6;
    let found = fit.estimate(&with_outlier.reading(&markers, None)).unwrap();
    assert_eq!(found.wrong_markers, [0]);
}
