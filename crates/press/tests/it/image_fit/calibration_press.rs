//! Sensors that known presses calibrate.

use palpate_press::{CalibrationPress, Rest};

use super::*;

/// Standard deviations of a sensor that is known far more roughly.
const WIDE: [f64; 5] = [0.05, 0.05, 3.0, 3.0, 0.05];
const PLANE: f64 = 1.0 / RADIUS;

/// A press of a plane on the apex, so deep, as a sensor shows it.
fn plane(truth: &Truth, indentation: f64, noise: &mut Stream) -> CalibrationPress {
    let skin = Skin::new(RADIUS).unwrap();
    let markers = Markers::new(skin, &places()).unwrap();
    let [magenta, yellow] = [0, 1].map(|disc| {
        let body = &bodies(None, truth.common[disc])[disc];
        let contact = skin.contact(body, 0.0, indentation).unwrap();
        markers.displacements(&contact, [0.0; 2])
    });
    let moved: Vec<_> = magenta.into_iter().zip(yellow).map(Into::into).collect();
    CalibrationPress {
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
    let presses: Vec<CalibrationPress> = depths[..presses]
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
        sum += departures_off(&rest, &truth);
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
    let told = |press: &CalibrationPress| {
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

/// A sensor, its frame at rest, and presses of a plane on it, with noise.
fn pressed(depths: &[f64]) -> (Truth, Vec<Option<Seen>>, Vec<CalibrationPress>) {
    let truth = Truth::drawn(2, WIDE);
    let mut noise = Stream::new(8, 2, Channel::Centroid);
    let at_rest = truth.at_rest(Some(&mut noise));
    let depths = depths.iter();
    let presses = depths.map(|depth| plane(&truth, *depth, &mut noise));
    let presses = presses.collect();
    (truth, at_rest, presses)
}

/// The square of the departures' error, in what is stated of them.
fn departures_off(rest: &Rest, truth: &Truth) -> f64 {
    let precision = rest.covariance().unwrap().try_inverse().unwrap();
    let off =
        nalgebra::DVector::from_fn(5, |at, _| (rest.common[at] - truth.common[at]) / WIDE[at]);
    off.dot(&(precision * &off))
}

/// Beyond it lies chi-squared of 5 degrees of freedom in one of 1,000 cases.
const FAR: f64 = 20.5;

#[test]
fn a_press_that_is_told_wrong_is_named() {
    let (truth, at_rest, presses) = pressed(&[0.5, 0.8, 1.1]);
    let told = |presses: &[CalibrationPress]| fit(None, WIDE).calibrated(&at_rest, presses);
    let sound = told(&presses).unwrap();
    assert!(departures_off(&sound, &truth) < FAR);
    assert!(sound.goodness().p_value > 1e-3, "{:?}", sound.goodness());
    let wrongs: [fn(&mut CalibrationPress); 3] = [
        |press| press.relative_curvature *= 1.5,
        |press| press.at = [1.0, -1.0],
        |press| press.indentation *= 1.2,
    ];
    for wrong in wrongs {
        for number in 0..3 {
            let mut presses = presses.clone();
            wrong(&mut presses[number]);
            let error = told(&presses).map(|_| ()).unwrap_err();
            let PressError::ContradictingPress {
                press,
                markers,
                most,
            } = error
            else {
                panic!("{error}");
            };
            assert_eq!((press, most), (number, 10));
            assert!((11..=81).contains(&markers), "{markers}");
        }
    }
}

/// The only press is named where it contradicts the frame at rest, which is told beforehand.
#[test]
fn the_only_press_that_is_told_wrong_is_named() {
    let (_, at_rest, mut presses) = pressed(&[1.0]);
    presses[0].at = [2.0, 0.0];
    let error = fit(None, WIDE).calibrated(&at_rest, &presses).unwrap_err();
    let is_named = matches!(error, PressError::ContradictingPress { press: 0, .. });
    assert!(is_named, "{error}");
}

#[test]
fn a_frame_at_rest_of_another_sensor_is_named() {
    let (_, _, presses) = pressed(&[0.5, 0.8, 1.1]);
    let other = Truth::drawn(3, WIDE).at_rest(None);
    let error = fit(None, WIDE).calibrated(&other, &presses).unwrap_err();
    let is_named =
        matches!(error, PressError::ContradictingRest { markers, most: 10 } if markers > 10);
    assert!(is_named, "{error}");
}

/// One marker slips in one frame: it alone is left out, and departures err no more than is stated.
#[test]
fn a_marker_that_slips_in_one_frame_is_left_out_of_it() {
    let (truth, at_rest, presses) = pressed(&[0.5, 0.8, 1.1]);
    let sound = fit(None, WIDE).calibrated(&at_rest, &presses).unwrap();
    for frame in 0..4 {
        let (mut at_rest, mut presses) = (at_rest.clone(), presses.clone());
        let seen = match frame {
            0 => &mut at_rest[30],
            _ => &mut presses[frame - 1].seen[30],
        };
        if let Some(seen) = seen {
            seen.picture[1] += 2.0;
            seen.picture[2] += 0.02;
        }
        let rest = fit(None, WIDE).calibrated(&at_rest, &presses).unwrap();
        assert_eq!(rest.freedom, sound.freedom - 4);
        assert!(departures_off(&rest, &truth) < FAR, "{frame}");
        assert!(rest.goodness().p_value > 1e-3, "{frame}");
        for (marker, seen) in rest.seen.iter().enumerate() {
            assert_eq!(*seen, frame > 0 || marker != 30);
        }
    }
}

/// A camera with a marker out of its sight, or one that tells of another number of markers.
#[derive(Clone)]
struct Partial {
    whole: Ideal,
    hidden: Option<usize>,
    told: usize,
}

impl View for Partial {
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>> {
        let mut pictures = self.whole.pictures(sensor, moved)?;
        if let Some(hidden) = self.hidden {
            pictures[hidden] = None;
        }
        pictures.resize(self.told, None);
        Some(pictures)
    }
}

fn partial(hidden: Option<usize>, told: usize) -> ImageFit<Partial> {
    let fit = fit(None, WIDE);
    ImageFit {
        view: Partial {
            whole: fit.view,
            hidden,
            told,
        },
        markers: fit.markers,
        bodies: fit.bodies,
        deeper: fit.deeper,
        common_stds: fit.common_stds,
        departure_prior: fit.departure_prior,
        misalignment_std: fit.misalignment_std,
        shift_std: fit.shift_std,
    }
}

/// Reading of a marker that cannot be seen, which contradicts the sensor in every frame.
#[test]
fn a_reading_out_of_sight_is_left_out() {
    let (truth, at_rest, presses) = pressed(&[0.5, 0.8, 1.1]);
    let rest = partial(Some(30), 81)
        .calibrated(&at_rest, &presses)
        .unwrap();
    assert_eq!(rest.freedom, 4 * 4 * 80);
    assert!(!rest.seen[30]);
    assert!(departures_off(&rest, &truth) < FAR);
    assert!(rest.goodness().p_value > 1e-3, "{:?}", rest.goodness());
}

#[test]
fn a_reading_out_of_sight_is_named_without_presses() {
    let (_, at_rest, _) = pressed(&[0.5]);
    let error = partial(Some(30), 81).at_rest(&at_rest).map(|_| ());
    assert_eq!(error, Err(PressError::HiddenMarker { marker: 30 }));
}

#[test]
fn laws_of_another_number_of_markers_are_refused() {
    let (_, at_rest, presses) = pressed(&[0.5]);
    let rest = partial(None, 81).at_rest(&at_rest).unwrap();
    for told in [0, 80, 82] {
        let fit = partial(None, told);
        assert!(fit.at_rest(&at_rest).is_err(), "{told}");
        assert!(fit.calibrated(&at_rest, &presses).is_err(), "{told}");
        let estimate = fit.estimate(&rest, &presses[0].seen, None);
        assert!(estimate.is_err(), "{told}");
    }
}
