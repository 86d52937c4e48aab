//! Tests the errors for presses that are impossible, and for readings without information.

use palpate_press::{
    Body, ForwardFit, Markers, Measured, PressError, PressEstimate, Prior, Reading, Skin, Verdict,
    calibrated_c,
};

use crate::sensor::{
    DEPTH, RADIUS, Readings, along, at, exactly, fit_of, half_space, measured, published,
};

fn refusal<T>(result: Result<T, PressError>) -> &'static str {
    result.err().map_or("none", Into::into)
}

fn read(normal: Vec<f64>, known: Option<Measured>) -> Result<PressEstimate, PressError> {
    let readings = Readings::inward(normal);
    ForwardFit::new(half_space()).estimate(&readings.reading(&published(), known))
}

#[test]
fn impossible_presses_have_named_errors() {
    let skin = Skin::new(RADIUS).unwrap();
    let body = half_space();
    let press = |object, indentation| refusal(skin.contact(&body, object, indentation));
    assert_eq!(press(0.0, 0.0), "no-indentation");
    assert_eq!(press(0.0, f64::NAN), "out-of-range");
    assert_eq!(press(0.0, RADIUS), "too-deep");
    assert_eq!(press(0.0, 1e-200 * RADIUS), "out-of-range");
    assert_eq!(press(f64::INFINITY, 1.0), "out-of-range");
    assert_eq!(press(-1.0 / RADIUS, 1.0), "conforming");
    assert_eq!(press(-(1.0 - 1e-13) / RADIUS, 1e-12), "conforming");
    assert_eq!(press(-1.0 / 10.0, 1.0), "edge-contact");
    assert_eq!(press(-1.0 / 20.1, 1.0), "too-wide");
    assert_eq!(press(1e9, 1.0), "none");
    let layer = Body::bonded_layer(5.0, DEPTH).unwrap();
    assert_eq!(refusal(skin.contact(&layer, 0.0, 5.0)), "too-deep");
    let thin = Body::bonded_layer(1e-6, 0.0).unwrap();
    assert_eq!(refusal(thin.press(1.0, 1e-6)), "too-deep");
    assert_eq!(refusal(thin.press(1e-9, 1e-9)), "layer-too-thin");
}

#[test]
fn readings_without_information_are_refused() {
    let count = published().count();
    assert_eq!(refusal(read(vec![0.0; count], exactly(1.0))), "no-contact");
    assert_eq!(refusal(read(vec![0.3; count], exactly(1.0))), "no-contact");
    assert_eq!(refusal(read(vec![0.3; count], None)), "no-contact");
    assert_eq!(refusal(read(vec![0.1; 3], None)), "bad-setting");
    let calibrated = |depth| calibrated_c(&published(), &half_space(), depth, None);
    assert_eq!(refusal(calibrated(f64::NAN)), "out-of-range");
    assert_eq!(refusal(calibrated(f64::INFINITY)), "too-deep");
    // A plane touches all markers of a flat or nearly flat pad.
    for radius in [1e6, f64::INFINITY] {
        let skin = Skin::new(radius).unwrap();
        let flat = Markers::new(skin, &[[0.0, 0.0], [2.0, 0.0], [4.0, 3.0]]).unwrap();
        let found = calibrated_c(&flat, &half_space(), 0.5, None);
        assert_eq!(refusal(found), "undetermined");
    }
    for bad in [f64::NAN, f64::INFINITY, -1e200] {
        let mut normal = vec![0.1; count];
        normal[7] = bad;
        let refused = read(normal, exactly(1.0));
        assert_eq!(refused.unwrap_err(), PressError::NotFinite { marker: 7 });
    }
    for (value, name) in [(0.0, "no-indentation"), (f64::NAN, "out-of-range")] {
        let mut normal = vec![0.0; count];
        normal[0] = 0.5;
        assert_eq!(refusal(read(normal, exactly(value))), name);
    }
}

#[test]
fn too_few_markers() {
    for (distances, expected) in [
        (&[][..], "too-few-markers"),
        (&[0.0, 3.0], "too-few-markers"),
        (&[3.0; 1000], "no-contact"),
    ] {
        let markers = along(distances);
        let normal = distances.iter().map(|distance| 1.0 / (1.0 + distance));
        let readings = Readings::inward(normal.collect());
        let fit = ForwardFit::new(half_space());
        let refused = fit.estimate(&readings.reading(&markers, exactly(1.0)));
        assert_eq!(refusal(refused), expected);
    }
}

#[test]
fn noise_alone_is_no_contact() {
    let markers = published();
    let nothing = Readings::inward(vec![0.0; markers.count()]);
    let fit = fit_of(&half_space(), 0.05);
    for trial in 0..20 {
        let readings = nothing.noisy(0.05, trial);
        let found = fit.estimate(&readings.reading(&markers, exactly(1.0)));
        assert_eq!(refusal(found), "no-contact", "trial {trial}");
    }
}

/// Only one marker moved, so the object may be as sharp as a needle under this marker.
#[test]
fn intervals_of_objects_sharper_than_the_marker_spacing_contain_the_truth() {
    let (markers, body) = (published(), half_space());
    let fit = fit_of(&body, 0.02);
    let (mut estimates, mut held) = (0, 0);
    for radius in [0.2, 0.5, 1.0] {
        let contact = markers.skin().contact(&body, 1.0 / radius, 0.5).unwrap();
        let truth = contact.relative_curvature;
        for trial in 0..20 {
            let readings = Readings::of(&markers, &contact, at(0.5, 10.0)).noisy(0.02, trial);
            // An error instead of an estimate is also accepted.
            if let Ok(found) = fit.estimate(&readings.reading(&markers, exactly(0.5))) {
                let curvature = found.relative_curvature;
                assert!(curvature.value.is_finite() && curvature.std.is_finite());
                assert!([Verdict::Convex, Verdict::NotResolved].contains(&found.verdict));
                estimates += 1;
                held += u32::from(curvature.interval.holds(truth));
            }
        }
    }
    let share = f64::from(held) / f64::from(estimates);
    assert!(share > 0.85, "{held} of {estimates}");
}

/// If the contact is far from all markers, a needle that presses on one marker fits the readings almost as well as the
/// true contact.
#[test]
fn intervals_off_the_markers_contain_the_truth_or_are_refused() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.0).unwrap();
    let fit = fit_of(&body, 0.07);
    for polar in [75.0, 90.0, 120.0] {
        let exact = Readings::of(&markers, &contact, at(polar, 37.0));
        let (mut estimates, mut held) = (0, 0);
        for trial in 0..60 {
            let readings = exact.noisy(0.07, trial);
            if let Ok(found) = fit.estimate(&readings.reading(&markers, exactly(1.0))) {
                estimates += 1;
                held += u32::from(
                    found
                        .relative_curvature
                        .interval
                        .holds(contact.relative_curvature),
                );
            }
        }
        assert!(
            f64::from(held) >= 0.75 * f64::from(estimates),
            "{held} of {estimates} at {polar}"
        );
        assert!(polar > 75.0 || estimates > 30, "{estimates}");
    }
}

/// A thin layer moves only under the contact, so only one marker moves. A wrong reading of this marker would look like
/// a needle that presses on it.
#[test]
fn a_press_measured_by_one_marker_alone_is_estimated_and_reported() {
    let (markers, std) = (published(), 0.03);
    let body = Body::bonded_layer(4.0, DEPTH).unwrap();
    let fit = fit_of(&body, std);
    let contact = markers.skin().contact(&body, 0.15, 0.6).unwrap();
    let pressed = Readings::of(&markers, &contact, at(23.8, 45.0));
    let felt = pressed.normal.iter().filter(|normal| **normal > std);
    assert_eq!(felt.count(), 1);
    let mut slipped = pressed.clone();
    slipped.normal.fill(0.0);
    slipped.normal[7] = 0.5;
    // `from_marker_alone` simulates 15 presses. It counts the estimates that depend on the marker `marker` alone, and
    // how many of their intervals contain the true curvature.
    let from_marker_alone = |readings: &Readings, marker: usize, curvature: f64| {
        let (mut estimates, mut held) = (0, 0);
        for trial in 0..15 {
            let found = fit.estimate(&readings.noisy(std, trial).reading(&markers, None));
            if let Ok(found) = found
                && found.only_marker == Some(marker)
            {
                estimates += 1;
                held += u32::from(found.relative_curvature.interval.holds(curvature));
            }
        }
        (estimates, held)
    };
    let under = pressed.normal.iter().position(|normal| *normal > std);
    let (of_press, held) = from_marker_alone(&pressed, under.unwrap(), 0.15 + 1.0 / RADIUS);
    assert!(of_press >= 13 && held >= 12, "{held} of {of_press}");
    let (of_slip, _) = from_marker_alone(&slipped, 7, 0.0);
    assert!(of_slip >= 13, "{of_slip}");
    // If the indentation is stated, the markers that did not move exclude more curvatures. The only marker that moved
    // must still not be rejected as an outlier.
    let indentation = exactly(0.6);
    let estimates = (0..15).filter_map(|trial| {
        let readings = pressed.noisy(std, trial);
        fit.estimate(&readings.reading(&markers, indentation)).ok()
    });
    let unseen: Vec<_> = estimates.filter(|found| !found.is_detected).collect();
    let alone = unseen.iter().filter(|found| found.only_marker == under);
    let wrong = unseen
        .iter()
        .filter(|found| !found.wrong_markers.is_empty());
    let counts = (unseen.len(), alone.count(), wrong.count());
    assert!(counts.1 >= 7 && counts.2 <= 2, "{counts:?}");
}

#[test]
fn chi_squared_of_few_markers_is_at_most_that_of_the_truth() {
    let body = Body::half_space(0.5, 0.0).unwrap();
    let skin = Skin::new(RADIUS).unwrap();
    let contact = skin.contact(&body, 1.0 / 30.0, 1.5).unwrap();
    for trial in 0..60_u32 {
        let share = |number: f64| 16.0 * ((number * f64::from(trial + 1)).fract() - 0.5);
        let place = |marker: u32| [2.0_f64, 3.0].map(|n| share(f64::from(marker + 1) * n.sqrt()));
        let markers = Markers::new(skin, &(0..12).map(place).collect::<Vec<_>>()).unwrap();
        let exact = Readings::of(&markers, &contact, [0.0; 2]);
        let readings = exact.noisy(0.02, trial.into());
        let pairs = readings.normal.iter().zip(&exact.normal);
        let of_truth: f64 = pairs.map(|(a, b)| ((a - b) / 0.02).powi(2)).sum();
        let found = fit_of(&body, 0.02).estimate(&readings.reading(&markers, None));
        let chi_squared = 8.0 * found.unwrap().reduced_chi_squared;
        assert!(
            chi_squared <= of_truth,
            "trial {trial}: {chi_squared} > {of_truth}"
        );
    }
}

fn five_markers() -> (Markers, Readings) {
    let places = [[0.0, 0.0], [4.0, 0.5], [-4.0, 1.0], [0.5, 4.0], [0.0, -4.0]];
    let skin = Skin::new(RADIUS).unwrap();
    let markers = Markers::new(skin, &places).unwrap();
    let body = half_space();
    let contact = skin.contact(&body, 1.0 / 30.0, 1.0).unwrap();
    let exact = Readings::of(&markers, &contact, [0.6, -0.3]);
    (markers, exact)
}

/// The noise can only be estimated from the residuals if there are more used readings than fitted parameters.
#[test]
fn noise_is_not_estimated_without_more_used_readings_than_parameters() {
    let (markers, exact) = five_markers();
    let fit = ForwardFit::new(half_space());
    let with_baseline = ForwardFit {
        baseline: Prior::Free,
        ..fit.clone()
    };
    let mut estimated = 0;
    for trial in 0..200 {
        let mut readings = exact.noisy_along(0.05, 0.05, trial);
        let reading = Reading {
            tangential: Some(&readings.tangential),
            ..readings.reading(&markers, None)
        };
        if let Ok(found) = with_baseline.estimate(&reading) {
            assert!(found.normal_std > 1e-4, "trial {trial}: {found:?}");
        }
        readings.normal[trial as usize % 5] += 1.0;
        if let Ok(found) = fit.estimate(&readings.reading(&markers, measured(1.0, 0.02))) {
            estimated += 1;
            assert!(found.normal_std > 1e-4, "trial {trial}: {found:?}");
        }
    }
    assert!(estimated > 20, "{estimated}");
    let elliptic = ForwardFit {
        is_elliptic: true,
        ..fit
    };
    let found = elliptic.estimate(&exact.reading(&markers, measured(1.0, 0.02)));
    assert_eq!(refusal(found), "too-few-markers");
}

/// No contact with the assumed model of the soft body fits the readings. The error must not be `no-contact`, even if
/// the noise is not stated.
#[test]
fn a_bad_fit_with_estimated_noise_is_not_called_no_contact() {
    let markers = published();
    let layer = Body::bonded_layer(5.0, DEPTH).unwrap();
    let contact = markers.skin().contact(&layer, 1.0 / 30.0, 1.0).unwrap();
    let moved = Readings::of(&markers, &contact, [0.6, -0.3]);
    let nothing = Readings::inward(vec![0.0; moved.normal.len()]);
    let fit = ForwardFit::new(half_space());
    for trial in 0..15 {
        let readings = moved.noisy(0.015, trial);
        let refused = refusal(fit.estimate(&readings.reading(&markers, measured(1.0, 0.02))));
        assert_ne!(refused, "no-contact", "trial {trial}");
        let readings = nothing.noisy(0.03, trial);
        let refused = refusal(fit.estimate(&readings.reading(&markers, None)));
        assert_eq!(refused, "no-contact", "trial {trial}");
    }
}
