//! Sensors that known presses calibrate.

use palpate_press::{KnownPress, Rest};

use super::*;

/// Standard deviations of a sensor that is known far more roughly.
const WIDE: [f64; 5] = [0.05, 0.05, 3.0, 3.0, 0.05];
const PLANE: f64 = 1.0 / RADIUS;

/// A press of a plane on the apex, so deep, as a sensor shows it.
fn plane(truth: &Truth, indentation: f64, noise: &mut Stream) -> KnownPress {
    let skin = Skin::new(RADIUS).unwrap();
    let markers = Markers::new(skin, &places()).unwrap();
    let [magenta, yellow] = [0, 1].map(|disc| {
        let body = &bodies(None, truth.common[disc])[disc];
        let contact = skin.contact(body, 0.0, indentation).unwrap();
        markers.displacements(&contact, [0.0; 2])
    });
    let moved: Vec<_> = magenta.into_iter().zip(yellow).map(Into::into).collect();
    KnownPress {
        seen: truth.seen(&moved, Some(noise)),
        relative_curvature: PLANE,
        at: [0.0; 2],
        indentation,
    }
}

/// The sensor of a trial, what its presses tell of it, and the noise that is left.
fn calibrated(number: u64, presses: usize) -> (Truth, Rest, Stream) {
    let truth = Truth::drawn(number, WIDE);
    let mut noise = Stream::new(6, number, Channel::Centroid);
    let at_rest = truth.at_rest(Some(&mut noise));
    let depths = [0.6, 1.2];
    let presses: Vec<KnownPress> = depths[..presses]
        .iter()
        .map(|depth| plane(&truth, *depth, &mut noise))
        .collect();
    let rest = fit(None, WIDE).calibrated(&at_rest, &presses).unwrap();
    (truth, rest, noise)
}

/// Presses and the frame at rest are not counted twice, nor half.
#[test]
fn departures_scatter_by_their_covariance() {
    let trials = 60;
    let mut sum = 0.0;
    for number in 0..trials {
        let (truth, rest, _) = calibrated(number, 2);
        let precision = rest.covariance().unwrap().try_inverse().unwrap();
        let off =
            nalgebra::DVector::from_fn(5, |at, _| (rest.common[at] - truth.common[at]) / WIDE[at]);
        sum += off.dot(&(precision * &off));
    }
    // Chi-squared of 300 degrees of freedom: 8 % is its standard deviation.
    let share = sum / (5 * trials) as f64;
    assert!((0.75..1.25).contains(&share), "{share}");
}

#[test]
fn presses_of_a_sensor_that_presses_calibrate_are_told() {
    let std = |presses: usize| {
        let trials = 40;
        let (mut held, mut variance) = (0.0, 0.0);
        for number in 0..trials {
            let (truth, rest, mut noise) = calibrated(number, presses);
            let seen = truth.seen(&truth.moved(None, [2.5, -1.0], 1.0), Some(&mut noise));
            let estimate = fit(None, WIDE).estimate(&rest, &seen, None).unwrap();
            let curvature = estimate.object_curvature();
            held += f64::from(u8::from(curvature.interval.holds(CURVATURE)));
            variance += curvature.std * curvature.std / trials as f64;
        }
        // Of 40 intervals of 95 %, 33 or fewer hold in one of 1,000 cases.
        assert!(held > 33.0, "{held}");
        variance.sqrt()
    };
    let (alone, two) = (std(0), std(2));
    assert!(two < 0.9 * alone, "{two} {alone}");
}

/// A marker of a calibrating press that is taken for another.
#[test]
fn a_wrong_marker_of_a_press_changes_little() {
    let truth = Truth::drawn(1, WIDE);
    let fit = fit(None, WIDE);
    let at_rest = truth.at_rest(Some(&mut Stream::new(7, 1, Channel::Centroid)));
    let mut press = plane(&truth, 1.0, &mut Stream::new(7, 2, Channel::Centroid));
    let told = |press: &KnownPress| {
        let presses = [press.clone()];
        fit.calibrated(&at_rest, &presses).unwrap()
    };
    let sound = told(&press);
    if let Some(seen) = &mut press.seen[40] {
        seen.picture[0] += 3.0;
        seen.picture[3] += 0.1;
    }
    let spoilt = told(&press);
    let covariance = sound.covariance().unwrap();
    for at in 0..5 {
        let std = covariance[(at, at)].sqrt() * WIDE[at];
        assert!((spoilt.common[at] - sound.common[at]).abs() < std, "{at}");
    }
}

#[test]
fn presses_that_cannot_be_are_refused() {
    let (truth, _, mut noise) = calibrated(0, 0);
    let good = plane(&truth, 1.0, &mut noise);
    let at_rest = truth.at_rest(None);
    let fit = fit(None, WIDE);
    let refused = |press: KnownPress| fit.calibrated(&at_rest, &[press]).map(|_| ()).unwrap_err();
    for number in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
        let mut bad = good.clone();
        bad.relative_curvature = number;
        refused(bad);
        let mut bad = good.clone();
        bad.indentation = number;
        refused(bad);
        let mut bad = good.clone();
        bad.at = [number.min(1e299), f64::NAN];
        refused(bad);
    }
    let mut few = good;
    few.seen.pop();
    assert!(matches!(refused(few), PressError::BadSetting(_)));
}
