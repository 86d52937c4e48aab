//! Tests estimates of principal curvatures from presses on cylinders, ellipsoids and balls.

use palpate_press::{ForwardFit, Markers, ObjectPress, PressError, Reading};
use palpate_sensing::{Channel, Stream};

use crate::sensor::{Readings, at, half_space, measured, published};

/// A press on an object with two principal curvatures. `axis` is the angle between the direction of the smaller
/// curvature and the x axis.
struct Press {
    curvatures: [f64; 2],
    axis: f64,
    at: [f64; 2],
    indentation: f64,
}

impl Press {
    fn readings(&self, markers: &Markers) -> Readings {
        let [larger, smaller] = self.curvatures;
        let press = ObjectPress {
            curvature: 0.5 * (larger + smaller),
            unequal: Some([smaller, larger]),
            axis: self.axis,
            indentation: self.indentation,
            at: self.at,
            shift: 0.0,
        };
        let moved = press.displacements(&half_space(), markers).unwrap();
        Readings {
            normal: moved.iter().map(|moved| moved.normal).collect(),
            tangential: moved.iter().map(|moved| moved.tangential).collect(),
        }
    }
}

fn elliptic(normal_std: Option<f64>) -> ForwardFit {
    ForwardFit {
        normal_std,
        is_elliptic: true,
        ..ForwardFit::new(half_space())
    }
}

fn presses() -> Vec<Press> {
    let objects = [
        [0.1, 0.0],
        [0.02, 0.0],
        [0.2, 0.05],
        [0.08, 0.06],
        [0.05, -0.02],
    ];
    let each = objects.into_iter().enumerate();
    each.map(|(index, curvatures)| Press {
        curvatures,
        axis: 0.3 + 0.5 * index as f64,
        at: at(6.0 * index as f64, 70.0 * index as f64),
        indentation: 0.8 + 0.3 * index as f64,
    })
    .collect()
}

#[test]
fn equal_curvatures_move_the_markers_as_a_round_contact_does() {
    let (markers, body, place) = (published(), half_space(), at(12.0, 200.0));
    let round = markers.skin().contact(&body, 0.05, 1.4).unwrap();
    let both = markers.displacements(&round, place);
    let equal = ObjectPress {
        curvature: 0.05,
        unequal: Some([0.05; 2]),
        axis: 1.0,
        indentation: 1.4,
        at: place,
        shift: 0.0,
    };
    let moved = equal.displacements(&body, &markers).unwrap();
    for (round, moved) in both.iter().zip(moved) {
        let [x, y] = [0, 1].map(|axis| round.tangential[axis] - moved.tangential[axis]);
        let error = (round.normal - moved.normal)
            .abs()
            .max(x.abs())
            .max(y.abs());
        assert!(error <= 1e-12, "off by {error:e}");
    }
}

#[test]
fn exact_readings_determine_curvatures_and_axis() {
    let markers = published();
    for press in presses() {
        let readings = press.readings(&markers);
        for tangential in [None, Some(readings.tangential.as_slice())] {
            let reading = Reading {
                tangential,
                ..readings.reading(&markers, None)
            };
            let found = elliptic(None).estimate(&reading).unwrap();
            for (found, curvature) in found
                .principal
                .unwrap()
                .curvatures
                .iter()
                .zip(press.curvatures)
            {
                assert!(
                    (found.value - curvature).abs() <= 1e-6,
                    "{found:?} for {curvature}"
                );
                assert!(found.interval.holds(curvature));
            }
            let turn = (found.principal.unwrap().axis - press.axis) / std::f64::consts::PI;
            assert!(
                (turn - turn.round()).abs() <= 1e-5,
                "axis {} for {}",
                found.principal.unwrap().axis,
                press.axis
            );
            assert!((found.indentation.value - press.indentation).abs() <= 1e-6);
        }
    }
}

#[test]
fn the_force_on_a_ball_is_that_of_a_round_contact() {
    let (markers, body) = (published(), half_space());
    let round = markers.skin().contact(&body, 0.05, 1.4).unwrap();
    let readings = Readings::of(&markers, &round, at(12.0, 200.0));
    let found = elliptic(None).estimate(&readings.reading(&markers, None));
    let found = found.unwrap().principal.unwrap().contact;
    let pairs = [
        (found.force(0.3), round.force(0.3)),
        (found.pressure(0.3), round.peak_pressure(0.3)),
    ];
    for (found, round) in pairs {
        assert!(
            (found / round.unwrap() - 1.0).abs() <= 1e-5,
            "{found} for {round:?}"
        );
    }
}

#[test]
fn intervals_hold_both_curvatures() {
    let (markers, std, trials) = (published(), 0.02, 30);
    let (mut hits, mut count) = ([0; 2], 0);
    for (scene, press) in (0..).zip(presses()) {
        let exact = press.readings(&markers);
        let fit = elliptic(Some(std));
        for trial in (0..trials).map(|trial| 1000 * scene + trial) {
            let readings = exact.noisy(std, trial);
            let error = 0.02 * Stream::new(2020, trial, Channel::Normal).standard_normal();
            let known = measured(press.indentation + error, 0.02);
            let found = fit.estimate(&readings.reading(&markers, known)).unwrap();
            count += 1;
            let [larger, smaller] = found.principal.unwrap().curvatures.map(|one| one.value);
            assert!(larger >= smaller, "{larger} < {smaller}");
            for (hits, (found, curvature)) in hits.iter_mut().zip(
                found
                    .principal
                    .unwrap()
                    .curvatures
                    .iter()
                    .zip(press.curvatures),
            ) {
                *hits += usize::from(found.interval.holds(curvature));
            }
        }
    }
    for hits in hits {
        let share = hits as f64 / f64::from(count);
        assert!((0.9..=0.99).contains(&share), "{share} of {count}");
    }
}

#[test]
fn a_sensor_at_rest_has_no_contact() {
    let markers = published();
    let rest = Readings::inward(vec![0.0; 77]);
    let fit = elliptic(Some(0.02));
    for trial in 0..5 {
        let readings = rest.noisy(0.02, trial);
        let error = fit.estimate(&readings.reading(&markers, None)).unwrap_err();
        assert!(matches!(error, PressError::NoContact { .. }), "{error}");
    }
}
