//! Tests the goodness of fit of presses.

use palpate_press::{ForwardFit, Interval};

use crate::sensor::{Readings, at, distance_from_uniform, exactly, fit_of, half_space, published};

const PRESSES: u64 = 200;

/// The p-values of 200 presses are compared with the uniform distribution. For 200 numbers that are drawn from the
/// uniform distribution, the Kolmogorov distance exceeds 0.115 with a probability of 1 %.
#[test]
fn p_values_are_uniform_if_the_model_is_right() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.2).unwrap();
    let exact = Readings::of(&markers, &contact, at(5.0, 40.0));
    let fit = fit_of(&body, 0.03);
    let p_value = |press| {
        let readings = exact.noisy(0.03, press);
        let found = fit.estimate(&readings.reading(&markers, exactly(1.2)));
        found.unwrap().goodness.unwrap().p_value
    };
    let distance = distance_from_uniform((0..PRESSES).map(p_value).collect());
    assert!(distance < 0.115, "{distance}");
}

#[test]
fn estimated_noise_has_no_goodness_of_fit() {
    let (markers, body) = (published(), half_space());
    let contact = markers.skin().contact(&body, 0.0, 1.2).unwrap();
    let readings = Readings::of(&markers, &contact, [0.0; 2]).noisy(0.03, 1);
    let found = ForwardFit::new(body.clone()).estimate(&readings.reading(&markers, exactly(1.2)));
    assert_eq!(found.unwrap().goodness, None);
}

#[test]
fn a_far_too_small_stated_noise_is_reported() {
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
            let misfits = fit.misfits(&reading, &found).unwrap();
            (found, misfits)
        };
        let (due, none) = estimate(0.03);
        assert_eq!(none, []);
        for std in [1e-4, 1e-9, 1e-20, 1e-100, 1e-160, 1e-300, f64::MIN_POSITIVE] {
            let (found, misfits) = estimate(std);
            let codes: Vec<_> = misfits.iter().map(|misfit| misfit.code()).collect();
            assert_eq!(codes, ["poor-fit", "stated-noise"], "{std:e}: {misfits:?}");
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
