//! Sensors that are calibrated by known presses.

use palpate_press::{CalibrationPress, Rest};

use super::*;

/// Standard deviations of the parameters of a much more uncertain sensor.
const WIDE: [f64; 5] = [0.05, 0.05, 3.0, 3.0, 0.05];
const PLANE: f64 = 1.0 / RADIUS;

/// Pictures of a plane that is pressed onto the apex.
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

/// The sensor of a trial, its calibration by presses, and the noise stream after them.
fn calibrate_trial(number: u64, presses: usize) -> (Truth, Rest, Stream) {
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

/// Presses and the frame at rest are each counted with their full weight, once.
#[test]
fn departures_scatter_by_their_covariance() {
    let trials = 60;
    let mut sum = 0.0;
    for number in 0..trials {
        let (truth, rest, _) = calibrate_trial(number, 2);
        sum += departures_off(&rest, &truth);
    }
    // Chi-squared of 300 degrees of freedom: 8 % is its standard deviation.
    let share = sum / (5 * trials) as f64;
    assert!((0.75..1.25).contains(&share), "{share}");
}

#[test]
fn intervals_of_a_sensor_calibrated_by_presses_contain_the_truth() {
    let std = |presses: usize| {
        let trials = 40;
        let (mut held, mut variance) = (0.0, 0.0);
        for number in 0..trials {
            let (truth, rest, mut noise) = calibrate_trial(number, presses);
            let seen = truth.seen(&truth.moved(None, [2.5, -1.0], 1.0), Some(&mut noise));
            let estimate = fit(None, WIDE).estimate(&rest, &seen, None).unwrap();
            let curvature = estimate.object_curvature();
            held += f64::from(u8::from(curvature.interval.holds(CURVATURE)));
            variance += curvature.std * curvature.std / trials as f64;
        }
        // Of 40 intervals with 95 % coverage, 33 or fewer contain the truth in one of 1,000 cases.
        assert!(held > 33.0, "{held}");
        variance.sqrt()
    };
    let (alone, two) = (std(0), std(2));
    assert!(two < 0.9 * alone, "{two} {alone}");
}

/// In a calibration press, one marker is confused with another.
#[test]
fn a_wrong_marker_of_a_calibration_press_has_little_effect() {
    let truth = Truth::drawn(1, WIDE);
    let fit = fit(None, WIDE);
    let at_rest = truth.at_rest(Some(&mut Stream::new(7, 1, Channel::Centroid)));
    let mut press = plane(&truth, 1.0, &mut Stream::new(7, 2, Channel::Centroid));
    let calibrate = |press: &CalibrationPress| {
        let presses = [press.clone()];
        fit.calibrated(&at_rest, &presses).unwrap()
    };
    let sound = calibrate(&press);
    if let Some(seen) = &mut press.seen[40] {
        seen.picture[0] += 3.0;
        seen.picture[3] += 0.1;
    }
    let spoilt = calibrate(&press);
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

/// Squared error of the departures, relative to their stated covariance (chi-squared).
fn departures_off(rest: &Rest, truth: &Truth) -> f64 {
    let precision = rest.covariance().unwrap().try_inverse().unwrap();
    let off =
        nalgebra::DVector::from_fn(5, |at, _| (rest.common[at] - truth.common[at]) / WIDE[at]);
    off.dot(&(precision * &off))
}

/// Chi-squared with 5 degrees of freedom exceeds this in one of 1,000 cases.
const CHI_SQUARED_LIMIT: f64 = 20.5;

#[test]
fn a_wrongly_stated_press_is_named() {
    let (truth, at_rest, presses) = pressed(&[0.5, 0.8, 1.1]);
    let calibrate = |presses: &[CalibrationPress]| fit(None, WIDE).calibrated(&at_rest, presses);
    let sound = calibrate(&presses).unwrap();
    assert!(departures_off(&sound, &truth) < CHI_SQUARED_LIMIT);
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
            let error = calibrate(&presses).map(|_| ()).unwrap_err();
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

/// A single press is named if it contradicts the frame at rest, which is fitted first.
#[test]
fn a_wrongly_stated_single_press_is_named() {
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

/// One marker slips in one frame: only this reading is excluded, and the departures stay within their stated errors.
#[test]
fn a_marker_that_slips_in_one_frame_is_excluded_there() {
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
        assert!(departures_off(&rest, &truth) < CHI_SQUARED_LIMIT, "{frame}");
        assert!(rest.goodness().p_value > 1e-3, "{frame}");
        for (marker, seen) in rest.seen.iter().enumerate() {
            assert_eq!(*seen, frame > 0 || marker != 30);
        }
    }
}

/// A camera with a hidden marker, or one that returns another number of markers.
#[derive(Clone)]
struct Partial {
    whole: Ideal,
    hidden: Option<usize>,
    count: usize,
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
        pictures.resize(self.count, None);
        Some(pictures)
    }
}

fn partial(hidden: Option<usize>, count: usize) -> ImageFit<Partial> {
    let fit = fit(None, WIDE);
    ImageFit {
        view: Partial {
            whole: fit.view,
            hidden,
            count,
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

/// A marker that the camera cannot image has a reading in every frame.
#[test]
fn a_reading_of_a_hidden_marker_is_excluded() {
    let (truth, at_rest, presses) = pressed(&[0.5, 0.8, 1.1]);
    let rest = partial(Some(30), 81)
        .calibrated(&at_rest, &presses)
        .unwrap();
    assert_eq!(rest.freedom, 4 * 4 * 80);
    assert!(!rest.seen[30]);
    assert!(departures_off(&rest, &truth) < CHI_SQUARED_LIMIT);
    assert!(rest.goodness().p_value > 1e-3, "{:?}", rest.goodness());
}

#[test]
fn a_reading_of_a_hidden_marker_is_named_without_presses() {
    let (_, at_rest, _) = pressed(&[0.5]);
    let error = partial(Some(30), 81).at_rest(&at_rest).map(|_| ());
    assert_eq!(error, Err(PressError::HiddenMarker { marker: 30 }));
}

#[test]
fn camera_models_with_another_number_of_markers_are_refused() {
    let (_, at_rest, presses) = pressed(&[0.5]);
    let rest = partial(None, 81).at_rest(&at_rest).unwrap();
    for count in [0, 80, 82] {
        let fit = partial(None, count);
        assert!(fit.at_rest(&at_rest).is_err(), "{count}");
        assert!(fit.calibrated(&at_rest, &presses).is_err(), "{count}");
        let estimate = fit.estimate(&rest, &presses[0].seen, None);
        assert!(estimate.is_err(), "{count}");
    }
}
