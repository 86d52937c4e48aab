//! Fits of presses to exact data, to noisy data, to data with outliers, and to published data.

use approx::assert_relative_eq;
use palpate_press::{
    Body, ForwardFit, Interval, Markers, Measured, Prior, Reading, Skin, Verdict, calibrated_c,
};

use crate::sensor::{RADIUS, Readings, along, at, exactly, fit_of, half_space, published};

/// Curvatures (1/mm) of the pressed objects: dishes, a plane and balls.
const OBJECTS: [f64; 6] = [
    -1.0 / 80.0,
    -1.0 / 25.0,
    0.0,
    1.0 / 80.0,
    1.0 / 20.0,
    1.0 / 5.0,
];

#[test]
fn exact_readings_determine_the_curvature() {
    let markers = published();
    let layer = Body::bonded_layer(5.0, 2.0).unwrap();
    for (body, tolerance) in [(half_space(), 1e-6), (layer, 1e-4)] {
        let fit = ForwardFit::new(body.clone());
        for (object, indentation) in OBJECTS
            .into_iter()
            .flat_map(|one| [(one, 0.05), (one, 1.4)])
        {
            let Ok(contact) = markers.skin().contact(&body, object, indentation) else {
                continue;
            };
            for place in [at(0.0, 0.0), at(30.0, 300.0)] {
                let readings = Readings::of(&markers, &contact, place);
                for known in [exactly(indentation), None] {
                    let found = fit.estimate(&readings.reading(&markers, known)).unwrap();
                    let curvature = found.relative_curvature.value;
                    let truth = contact.relative_curvature;
                    assert_relative_eq!(curvature, truth, max_relative = tolerance);
                    assert_relative_eq!(
                        found.indentation.value,
                        indentation,
                        max_relative = tolerance
                    );
                    assert!(found.wrong_markers.is_empty());
                }
            }
        }
    }
}

#[test]
fn exact_readings_on_sensors_of_any_size_determine_the_curvature() {
    type OfRadius = fn(f64) -> Body;
    let half_space: OfRadius = |radius| Body::half_space(0.5, 0.1 * radius).unwrap();
    let layer: OfRadius = |radius| Body::bonded_layer(0.3 * radius, 0.1 * radius).unwrap();
    let gaussian: OfRadius = |_| Body::gaussian(1.0).unwrap();
    for (body, radius, object, depth) in [
        (half_space, 1e-30, 0.0, 0.05),
        (half_space, 1e30, 0.0, 0.05),
        (layer, 1e-30, 0.0, 0.05),
        (gaussian, 1e30, 0.0, 0.05),
        (half_space, 20.0, -0.99, 0.01),
        (half_space, 20.0, 20.0, 0.01),
        (half_space, 20.0, 0.0, 1e-9),
        (half_space, 20.0, 0.0, 0.3),
    ] {
        let at = |index: usize| 0.5 * radius * (index as f64 - 3.0) / 3.0;
        let places: Vec<_> = (0..49)
            .map(|index| [at(index % 7), at(index / 7)])
            .collect();
        let markers = Markers::new(Skin::new(radius).unwrap(), &places).unwrap();
        let body = body(radius);
        let contact = markers
            .skin()
            .contact(&body, object / radius, depth * radius);
        let contact = contact.unwrap();
        let readings = Readings::of(&markers, &contact, [0.02 * radius, -0.03 * radius]);
        let reading = readings.reading(&markers, exactly(contact.indentation));
        let found = ForwardFit::new(body.clone()).estimate(&reading).unwrap();
        let bound = 1e-9 + 10.0 * found.relative_curvature.std / contact.relative_curvature;
        assert!(bound < 0.1, "{found:?}");
        assert_relative_eq!(
            found.most_likely_curvature,
            contact.relative_curvature,
            max_relative = bound
        );
    }
}

#[test]
fn tangential_readings_reduce_the_standard_error_if_the_indentation_is_fitted() {
    let (markers, body) = (published(), half_space());
    let fit = ForwardFit {
        normal_std: Some(0.07),
        tangential_std: Some(0.02),
        ..ForwardFit::new(body.clone())
    };
    for object in [-1.0 / 80.0, 0.0, 1.0 / 80.0] {
        let contact = markers.skin().contact(&body, object, 1.4).unwrap();
        let bound = |tangential| {
            let bounds = fit.bounds(&markers, &contact, [0.0; 2], tangential, None);
            bounds.unwrap().relative_curvature
        };
        assert!(bound(true) < 0.8 * bound(false));
        let readings = Readings::of(&markers, &contact, [0.0; 2]);
        let reading = Reading {
            tangential: Some(&readings.tangential),
            ..readings.reading(&markers, None)
        };
        let found = fit.estimate(&reading).unwrap().relative_curvature;
        assert_relative_eq!(found.std, bound(true), max_relative = 0.1);
    }
}

/// The expected Cramér–Rao bound, 6.7 % of the curvature, comes from an independent calculation.
#[test]
fn the_bound_matches_an_independent_calculation() {
    let (markers, body) = (published(), half_space());
    let fit = fit_of(&body, 0.07);
    let contact = markers.skin().contact(&body, 0.0, 1.4).unwrap();
    let bounds = fit.bounds(&markers, &contact, [0.0; 2], false, Some(0.02));
    let share = bounds.unwrap().relative_curvature / contact.relative_curvature;
    assert_relative_eq!(share, 0.067, max_relative = 0.01);
    // The Cramér–Rao bounds of the standard deviations are proportional to the noise, unless the square of the noise
    // exceeds the range of double-precision numbers.
    let by = |std| {
        let fit = ForwardFit {
            normal_std: Some(std),
            ..fit.clone()
        };
        fit.bounds(&markers, &contact, [0.0; 2], false, None)
    };
    let unit = by(1.0).unwrap().relative_curvature;
    let most = by(1e100).unwrap().relative_curvature;
    assert_relative_eq!(most, 1e100 * unit, max_relative = 1e-9);
    assert!(by(1e-300).is_none());
}

/// In 400 presses, the root-mean-square error equals the Cramér–Rao bound within its statistical uncertainty. The 95 %
/// intervals contain the true value as often as they should. The indentation is stated, or it is fitted together with
/// tangential readings.
#[test]
fn errors_from_noisy_readings_reach_the_bound() {
    const PRESSES: u64 = 400;
    const KNOWN_STD: f64 = 0.02;
    let (markers, body) = (published(), half_space());
    let fit = ForwardFit {
        normal_std: Some(0.07),
        tangential_std: Some(0.02),
        ..ForwardFit::new(body.clone())
    };
    let contact = markers.skin().contact(&body, 0.0, 1.4).unwrap();
    let truth = contact.relative_curvature;
    let exact = Readings::of(&markers, &contact, [0.0; 2]);
    for tangential in [false, true] {
        let known_std = (!tangential).then_some(KNOWN_STD);
        let bounds = fit.bounds(&markers, &contact, [0.0; 2], tangential, known_std);
        let bound = bounds.unwrap().relative_curvature;
        let (mut squares, mut held) = (0.0, 0);
        for press in 0..PRESSES {
            // The indentation reported by the robot is alternately too large and too small by its stated standard
            // deviation.
            let value = 1.4 + KNOWN_STD * if press % 2 == 0 { 1.0 } else { -1.0 };
            let known = known_std.map(|std| Measured { value, std });
            let readings = exact.noisy_along(0.07, 0.02, press);
            let reading = Reading {
                tangential: tangential.then_some(&readings.tangential),
                ..readings.reading(&markers, known)
            };
            let found = fit.estimate(&reading).unwrap().relative_curvature;
            squares += (found.value - truth).powi(2);
            held += u32::from(found.interval.holds(truth));
        }
        let rms = (squares / PRESSES as f64).sqrt();
        assert!(
            rms < 1.2 * bound,
            "rms error {rms} against a bound of {bound}"
        );
        let coverage = f64::from(held) / PRESSES as f64;
        assert!((0.92..=0.98).contains(&coverage), "coverage {coverage}");
    }
}

/// The estimated curvature has a standard deviation of about 20 %, but the mean over 600 presses has no significant
/// bias. Without the bias correction, the curvature of the best fit is too large on average.
#[test]
fn curvatures_are_without_bias() {
    const PRESSES: u64 = 600;
    let (markers, body) = (published(), half_space());
    let fit = fit_of(&body, 0.15);
    let contact = markers.skin().contact(&body, 1.0 / 80.0, 1.0).unwrap();
    let exact = Readings::of(&markers, &contact, [0.0; 2]);
    let (mut sum, mut sum_of_best) = (0.0, 0.0);
    for press in 0..PRESSES {
        let readings = exact.noisy(0.15, press);
        let found = fit
            .estimate(&readings.reading(&markers, exactly(1.0)))
            .unwrap();
        sum += found.relative_curvature.value;
        sum_of_best += found.most_likely_curvature;
    }
    let bias = |sum: f64| sum / PRESSES as f64 / contact.relative_curvature - 1.0;
    assert!(bias(sum).abs() < 0.012, "bias {}", bias(sum));
    assert!(bias(sum_of_best) > 0.015, "bias {}", bias(sum_of_best));
}

/// The displacements of a press differ from the fitted Gaussian by more than the small noise. This difference must not
/// make a marker an outlier.
#[test]
fn a_gaussian_model_reports_no_outliers() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 30.0, 1.5).unwrap();
    let readings = Readings::of(&markers, &contact, [0.0; 2]).noisy(0.01, 3);
    let fit = ForwardFit {
        gain: Prior::Free,
        normal_std: Some(0.01),
        ..ForwardFit::new(Body::gaussian(1.0).unwrap())
    };
    let found = fit
        .estimate(&readings.reading(&markers, exactly(1.5)))
        .unwrap();
    assert!(found.wrong_markers.is_empty());
    assert!(libm::hypot(found.contact[0], found.contact[1]) < 0.3);
}

#[test]
fn a_needle_is_not_estimated_as_a_dish() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 5.0, 1.0).unwrap();
    let exact = Readings::of(&markers, &contact, [0.0; 2]);
    for normal_std in [0.005, 0.02] {
        let fit = fit_of(&body, normal_std);
        for trial in 0..20 {
            let readings = exact.noisy(normal_std, trial);
            if let Ok(found) = fit.estimate(&readings.reading(&markers, None)) {
                let curvature = found.relative_curvature;
                assert!(curvature.interval.holds(curvature.value), "{found:?}");
                assert_ne!(found.verdict, Verdict::Concave);
                assert!(found.indentation.value < RADIUS);
            }
        }
    }
}

#[test]
fn wrong_markers_are_named() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 1.0 / 80.0, 1.0).unwrap();
    let mut readings = Readings::of(&markers, &contact, at(4.0, 30.0)).noisy(0.03, 1);
    for (marker, error) in [(2, 0.9), (40, -1.2), (60, 5.0)] {
        readings.normal[marker] += error;
    }
    for normal_std in [Some(0.03), None] {
        let fit = ForwardFit {
            normal_std,
            ..ForwardFit::new(body.clone())
        };
        let found = fit
            .estimate(&readings.reading(&markers, exactly(1.0)))
            .unwrap();
        assert_eq!(found.wrong_markers, [2, 40, 60]);
        assert!(
            found
                .relative_curvature
                .interval
                .holds(contact.relative_curvature)
        );
        assert_relative_eq!(found.normal_std, 0.03, max_relative = 0.3);
    }
}

#[test]
fn a_window_stays_on_the_contact() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.0).unwrap();
    let exact = Readings::of(&markers, &contact, at(10.0, 70.0));
    let fit = ForwardFit {
        normal_std: Some(0.05),
        window: Some(9.0),
        ..ForwardFit::new(body.clone())
    };
    for trial in 0..20 {
        let readings = exact.noisy(0.05, trial);
        let found = fit
            .estimate(&readings.reading(&markers, exactly(1.0)))
            .unwrap();
        let [x, y] = at(10.0, 70.0);
        assert!(libm::hypot(found.contact[0] - x, found.contact[1] - y) < 1.5);
    }
}

#[test]
fn a_gain_prior_widens_the_interval_to_contain_the_truth() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.4).unwrap();
    let mut readings = Readings::of(&markers, &contact, [0.0; 2]);
    readings
        .normal
        .iter_mut()
        .for_each(|normal| *normal *= 1.17);
    let with_gain = |gain| ForwardFit {
        normal_std: Some(0.02),
        gain,
        ..ForwardFit::new(body.clone())
    };
    let reading = readings.reading(&markers, exactly(1.4));
    let trusting = with_gain(Prior::Exact).estimate(&reading).unwrap();
    let wary = with_gain(Prior::Within(0.17)).estimate(&reading).unwrap();
    assert!(
        !trusting
            .relative_curvature
            .interval
            .holds(contact.relative_curvature)
    );
    assert!(
        wary.relative_curvature
            .interval
            .holds(contact.relative_curvature)
    );
    assert!((wary.gain.unwrap().value - 1.17).abs() < 0.05);
}

/// Columns: effective radius, indentation δ, and amplitude, σ, R² and σ²/δ of a Gaussian. Another program fitted the
/// Gaussian by unweighted least squares to displacements of a half-space at a depth of 2 mm. The displacements are at
/// 60 equally spaced distances, from 0 to twice the contact radius.
const GAUSSIANS: [[f64; 6]; 4] = [
    [26.67, 1.0, 0.870, 5.385, 0.977, 29.0],
    [20.0, 1.0, 0.844, 4.763, 0.978, 22.7],
    [16.0, 1.0, 0.820, 4.342, 0.979, 18.9],
    [20.0, 1.4, 1.224, 5.501, 0.977, 21.6],
];

#[test]
fn a_gaussian_fit_of_a_profile_matches_another_program() {
    let body = half_space();
    for [radius, indentation, amplitude, sigma, r_squared, ratio] in GAUSSIANS {
        let object = 1.0 / radius - 1.0 / RADIUS;
        let contact = body.press(1.0 / RADIUS + object, indentation).unwrap();
        let steps: Vec<f64> = (-60..=60)
            .map(|step| f64::from(step) / 30.0 * contact.radius)
            .collect();
        let markers = along(&steps);
        let readings = Readings::of(&markers, &contact, [0.0; 2]);
        let fit = ForwardFit {
            gain: Prior::Free,
            ..ForwardFit::new(Body::gaussian(1.0).unwrap())
        };
        let found = fit
            .estimate(&readings.reading(&markers, exactly(indentation)))
            .unwrap();
        let squared = indentation / found.most_likely_curvature;
        let gain = found.gain.unwrap().value;
        assert_relative_eq!(gain * indentation, amplitude, max_relative = 5e-3);
        assert_relative_eq!(squared.sqrt(), sigma, max_relative = 5e-3);
        assert_relative_eq!(found.r_squared, r_squared, max_relative = 5e-3);
        assert_relative_eq!(squared / indentation, ratio, max_relative = 5e-3);
    }
}

#[test]
fn a_calibrated_gaussian_estimates_its_calibration_plane() {
    let (markers, body) = (published(), half_space());
    let c = calibrated_c(&markers, &body, 1.0, None).unwrap();
    let fit = ForwardFit {
        gain: Prior::Free,
        ..ForwardFit::new(Body::gaussian(c).unwrap())
    };
    let contact = markers.skin().contact(&body, 0.0, 1.0).unwrap();
    let readings = Readings::of(&markers, &contact, [0.0; 2]);
    let found = fit
        .estimate(&readings.reading(&markers, exactly(1.0)))
        .unwrap();
    assert_relative_eq!(found.effective_radius().value, RADIUS, max_relative = 1e-5);
}

/// Profiles of the skin's displacement from Fig. 7c of the 2020 paper, for presses on a plane and on a dish with a
/// radius of 80 mm. Columns: radial position as drawn and normal displacement, mm.
const PLANE: [[f64; 2]; 11] = [
    [-9.576, -0.0006],
    [-7.684, -0.0268],
    [-5.792, -0.0208],
    [-3.901, 0.4397],
    [-2.009, 0.8896],
    [-0.117, 0.9893],
    [1.775, 0.6722],
    [3.667, 0.2366],
    [5.559, 0.1191],
    [7.450, 0.1236],
    [9.342, 0.0827],
];
const DISH: [[f64; 2]; 11] = [
    [-9.500, -0.0021],
    [-7.602, 0.0048],
    [-5.705, 0.0739],
    [-3.807, 0.4087],
    [-1.910, 0.8025],
    [-0.012, 0.9776],
    [1.885, 0.7624],
    [3.783, 0.4417],
    [5.681, 0.2783],
    [7.578, 0.0809],
    [9.476, -0.0361],
];

/// Most likely effective radius, and its 95 % interval, from a published profile of displacements. The radial positions
/// in the profile are multiplied by `stretch`.
fn published_radius(profile: &[[f64; 2]], stretch: f64) -> (f64, Interval) {
    let positions: Vec<f64> = profile
        .iter()
        .map(|[position, _]| stretch * position)
        .collect();
    let markers = along(&positions);
    let normal: Vec<f64> = profile.iter().map(|[_, normal]| *normal).collect();
    let readings = Readings::inward(normal);
    let fit = ForwardFit::new(half_space());
    let found = fit.estimate(&readings.reading(&markers, None)).unwrap();
    assert_ne!(found.verdict, Verdict::Convex);
    (
        1.0 / found.most_likely_curvature,
        found.effective_radius().interval,
    )
}

/// The profiles were read off Fig. 7c of the 2020 paper, whose axis of radial positions is compressed by a factor of
/// about 2.19. With this factor, an independent fit gives the effective radius 21.7 for the plane and 31.5 for the
/// dish.
#[test]
fn published_profiles() {
    let (plane, _) = published_radius(&PLANE, 2.19);
    let (dish, interval) = published_radius(&DISH, 2.19);
    assert_relative_eq!(plane, 21.7, max_relative = 0.01);
    assert_relative_eq!(dish, 31.5, max_relative = 0.01);
    assert!(interval.holds(26.7));

    // On a plane, the true effective radius is the radius of the sensor. Find, by bisection, the factor by which the
    // radial positions must be multiplied so that the radius estimated on the plane equals the sensor's radius.
    let (mut low, mut high) = (1.9, 2.3);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if published_radius(&PLANE, middle).0 < RADIUS {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (dish, interval) = published_radius(&DISH, low);
    assert_relative_eq!(dish, 26.7, max_relative = 0.2);
    assert!(interval.holds(26.7) && interval.holds(31.4));
}
