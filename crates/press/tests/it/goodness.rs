//! Goodness of fit of presses.

use palpate_press::{Body, ForwardFit, Interval};

use crate::sensor::{Readings, at, distance_from_uniform, exactly, fit_of, half_space, published};

const PRESSES: u64 = 200;

/// P-values of presses of a half-space on a plane, fitted by a body; of those that are not refused.
fn p_values(fitted: Body, presses: u64) -> Vec<f64> {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.2).unwrap();
    let exact = Readings::of(&markers, &contact, at(5.0, 40.0));
    let fit = fit_of(&fitted, 0.03);
    let p_value = |press| {
        let readings = exact.noisy(0.03, press);
        let found = fit.estimate(&readings.reading(&markers, exactly(1.2)));
        found.ok().map(|found| found.goodness.unwrap().p_value)
    };
    (0..presses).filter_map(p_value).collect()
}

/// Kolmogorov's distance from the uniform distribution, of which 200 draws pass 0.115 once in a hundred times.
#[test]
fn p_values_are_uniform_where_the_model_holds() {
    let p_values = p_values(half_space(), PRESSES);
    assert_eq!(p_values.len() as u64, PRESSES);
    let distance = distance_from_uniform(p_values);
    assert!(distance < 0.115, "{distance}");
}

#[test]
fn a_layer_is_contradicted_by_presses_of_a_half_space() {
    const FEW: u64 = 20;
    let p_values = p_values(Body::bonded_layer(8.0, 2.0).unwrap(), FEW);
    let small = p_values.iter().filter(|&&p_value| p_value < 0.01).count();
    let count = p_values.len();
    assert!(count as u64 > FEW / 2, "{count} of {FEW} are estimated");
    assert!(small as f64 >= 0.9 * count as f64, "{small} of {count}");
}

#[test]
fn noise_that_is_found_leaves_nothing_to_judge() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.2).unwrap();
    let readings = Readings::of(&markers, &contact, [0.0; 2]).noisy(0.03, 1);
    let found = ForwardFit::new(body.clone()).estimate(&readings.reading(&markers, exactly(1.2)));
    assert_eq!(found.unwrap().goodness, None);
}

/// Noise that is stated far too small moves the estimate by nothing to speak of, and is doubted; a press stays a press.
#[test]
fn noise_that_is_stated_far_too_small_is_doubted() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.2).unwrap();
    let exact = Readings::of(&markers, &contact, at(5.0, 40.0));
    for (press, is_normal_alone) in [(0, true), (1, false), (2, true)] {
        let readings = exact.noisy_along(0.03, 0.03, press);
        let mut reading = readings.reading(&markers, exactly(1.2));
        if is_normal_alone {
            reading.tangential = None;
        }
        let estimate = |std| {
            let fit = ForwardFit {
                normal_std: Some(std),
                tangential_std: Some(std),
                ..ForwardFit::new(body.clone())
            };
            let found = fit.estimate(&reading).unwrap();
            let doubts = fit.doubts(&reading, &found).unwrap();
            (found, doubts)
        };
        let (due, none) = estimate(0.03);
        assert_eq!(none, []);
        for std in [1e-4, 1e-9, 1e-20, 1e-100, 1e-160, 1e-300, f64::MIN_POSITIVE] {
            let (found, doubts) = estimate(std);
            let names: Vec<_> = doubts.iter().map(|doubt| doubt.name()).collect();
            assert_eq!(names, ["large-residuals"], "{std:e}: {doubts:?}");
            let [one, other] = [&due, &found].map(|found| found.most_likely_curvature);
            assert!(
                (one - other).abs() < 0.1 * due.relative_curvature.std,
                "{std:e}"
            );
            let Interval { low, high } = found.relative_curvature.interval;
            assert!(
                low < high && found.relative_curvature.std > 0.0,
                "{found:?}"
            );
        }
    }
}
