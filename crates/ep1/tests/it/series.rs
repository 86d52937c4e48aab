//! Compares estimates from time series of rolls with the exact solution for a ball on a ball, and with rolls that are
//! computed by integration of the rolling equations.

use approx::assert_relative_eq;
use nalgebra::{Vector2, Vector3};
use palpate_ep1::{
    Exclusion, PadCell, Places, Quantity, RollSample, RollSeries, SeriesError, SeriesMethod,
    SeriesNoise, estimate_series,
};
use palpate_geometry::{Cylinder, Shape, ShapeThresholds, Surface};

use crate::ball_rolls::{EXACT, RADIUS, SQUARE, chart, on_squares, pad, rolls, without_starts};
use crate::draws::Draws;
use crate::trajectories::integrated;

const QUANTITIES: [Quantity; 5] = [
    Quantity::Normal { angle_rad: 0.3 },
    Quantity::Gaussian,
    Quantity::Mean,
    Quantity::PrincipalMin,
    Quantity::PrincipalMax,
];

#[test]
fn the_set_of_exact_rolls_contains_the_truth_and_is_narrow() {
    let mut draws = Draws(47);
    for is_hexagonal in [false, true] {
        let cell = PadCell {
            is_hexagonal,
            ..SQUARE
        };
        for (object, width) in [(47.0, 0.025), (470.0, 0.16)] {
            for turn in [0.1, 0.3, 0.6] {
                let stated = rolls(object, &cell, turn, &mut draws);
                for (rolls, share) in [(without_starts(&stated), 1.0), (stated, 0.7)] {
                    let places = Places::Pads(cell);
                    let found =
                        estimate_series(SeriesMethod::PadEdge, RADIUS, &places, &EXACT, &rolls)
                            .unwrap();
                    for quantity in QUANTITIES {
                        let truth = match quantity {
                            Quantity::Gaussian => (1.0 / object) / object,
                            _ => 1.0 / object,
                        };
                        let [Some(low), Some(high)] = found.bounds(quantity).unwrap() else {
                            panic!("{quantity:?} has no bounds");
                        };
                        assert!(low <= truth && truth <= high, "{quantity:?}: {low} {high}");
                        let powers = match quantity {
                            Quantity::Normal { .. } | Quantity::Mean => 1.0,
                            _ => 2.0,
                        };
                        assert!(high - low < powers * share * width * truth, "{quantity:?}");
                        let [from, to] = found.interval95(quantity);
                        assert!(from < Some(high) && to > Some(low));
                        let width = (to.unwrap() - from.unwrap()) / (high - low);
                        assert!(
                            (0.1..4.0 * powers).contains(&width),
                            "{quantity:?}: {width}"
                        );
                    }
                    let value = found.curvature.normal_curvature(0.3);
                    assert_relative_eq!(value, 1.0 / object, max_relative = 0.3 * width);
                }
            }
        }
    }
}

/// Computes the bounds of the curvatures from time series of rolls. Checks that the bounds contain the true curvatures
/// `truths`.
fn bounds_around(
    cell: PadCell,
    radius: f64,
    rolls: &[RollSeries],
    truths: [f64; 5],
) -> [[Option<f64>; 2]; 5] {
    let places = Places::Pads(cell);
    let found = estimate_series(SeriesMethod::PadEdge, radius, &places, &EXACT, rolls).unwrap();
    let mut all = [[None; 2]; 5];
    for ((quantity, truth), ends) in QUANTITIES.into_iter().zip(truths).zip(&mut all) {
        *ends = found.bounds(quantity).unwrap();
        let [low, high] = *ends;
        assert!(low.is_none_or(|low| low <= truth), "{quantity:?}: {low:?}");
        assert!(
            high.is_none_or(|high| truth <= high),
            "{quantity:?}: {high:?}"
        );
        if found.has_few_crossings() {
            assert_eq!(found.interval95(quantity), *ends);
        }
    }
    assert!(
        found
            .rolls
            .iter()
            .all(|roll| roll.left_out != Some(Exclusion::Inconsistent))
    );
    all
}

#[test]
fn few_crossings_give_wide_bounds() {
    let mut draws = Draws(17);
    for (object, pitch, is_open) in [(47.0, 1.0, false), (5.0, 2.0, true), (5.0, 4.0, true)] {
        for _ in 0..6 {
            let cell = PadCell { pitch, ..SQUARE };
            let all = without_starts(&rolls(object, &cell, 0.0, &mut draws));
            // Rolls that are all parallel to pad edges give only wide bounds for the twist of the surface.
            let mut along: Vec<_> = all.iter().step_by(2).cloned().collect();
            for sample in along.iter_mut().flat_map(|roll| &mut roll.samples) {
                let is_zero = |part: f64| part.abs() < 1e-12;
                sample
                    .rotation
                    .apply(|part| *part = if is_zero(*part) { 0.0 } else { *part });
            }
            let curvature = 1.0 / object;
            let square = curvature * curvature;
            let truths = [curvature, square, curvature, curvature, curvature];
            for rolls in [along, all] {
                let bounds = bounds_around(cell, RADIUS, &rolls, truths);
                let [low, high] = bounds[0];
                let places = Places::Pads(cell);
                let found = estimate_series(SeriesMethod::PadEdge, RADIUS, &places, &EXACT, &rolls);
                let found = found.unwrap();
                let has_few = is_open || rolls.len() == 4;
                assert_eq!(found.has_few_crossings(), has_few);
                assert_eq!(high.is_none(), is_open, "{low:?} {high:?}");
                assert!(low > Some(-0.1 - 1e-12));
                assert!(found.curvature.normal_curvature(0.0) > -0.1);
                if rolls.len() == 4 && !is_open {
                    assert!(high.unwrap() - low.unwrap() > 0.1 * curvature);
                }
            }
        }
    }
}

#[test]
fn the_set_contains_a_curvature_that_differs_between_directions() {
    let cylinder = Shape::Cylinder(Cylinder::new(0.5, 0.4).unwrap());
    let cell = PadCell {
        pitch: 0.1,
        ..SQUARE
    };
    let (mut draws, mut sums) = (Draws(29), [0.0; 2]);
    for trial in 0..8 {
        // In every second trial, the probe spins by 2 rad.
        let spin = [0.0, 2.0][trial % 2];
        let (contacts, roller) = integrated(&cylinder, (0.0, 0.0), [0.5, spin], 30);
        let from = roller.first_contact();
        let (_, truth) = cylinder
            .curvature_along(&from.on_object, &from.x_axis)
            .unwrap();
        let truths = [truth.normal_curvature(0.3), 0.0, 1.0, 0.0, 2.0];
        let mut rolls = contacts.clone();
        for roll in &mut rolls {
            let start = Vector2::new(draws.uniform() - 0.5, draws.uniform() - 0.5);
            for sample in &mut roll.samples {
                let place = chart(&start, &(sample.place * RADIUS)) / RADIUS;
                sample.place = pad(&cell, &place);
            }
        }
        let [.., [_, high]] = bounds_around(cell, 1.0, &rolls, truths);
        sums[trial % 2] += high.unwrap() / 4.0;
    }
    assert!(sums[0] < 2.35 && sums[1] < 2.75, "{sums:?}");
}

#[test]
fn noisy_rotations_give_intervals_that_hold() {
    let mut draws = Draws(5);
    let noise = SeriesNoise {
        rotation_std_rad: 0.1_f64.to_radians(),
        ..EXACT
    };
    let (mut held, trials) = (0, 40);
    for trial in 0..trials {
        let mut noisy = rolls(47.0, &SQUARE, 0.1 * f64::from(trial), &mut draws);
        // In every fourth trial, the start is known, and the rotations are relative to a noisy first orientation.
        let is_relative = trial % 4 == 0;
        if !is_relative {
            noisy = without_starts(&noisy);
        }
        // In every second trial, the probes start and stop smoothly, and return to their starts.
        for roll in noisy.iter_mut().filter(|_| trial % 2 == 1) {
            for sample in &mut roll.samples {
                sample.time_s = libm::acos(1.0 - 2.0 * sample.time_s) / std::f64::consts::PI;
            }
            let back = roll.samples.clone().into_iter().rev().skip(1);
            roll.samples.extend(back.map(|sample| RollSample {
                time_s: 2.0 - sample.time_s,
                ..sample
            }));
        }
        for sample in noisy.iter_mut().flat_map(|roll| &mut roll.samples) {
            sample.rotation += Vector3::from_fn(|_, _| draws.normal()) * noise.rotation_std_rad;
        }
        for roll in noisy.iter_mut().filter(|_| is_relative) {
            let first = roll.samples[0].rotation;
            roll.samples
                .iter_mut()
                .for_each(|one| one.rotation -= first);
        }
        let found = on_squares(SeriesMethod::PadEdge, &noise, &noisy).unwrap();
        let value = found.curvature.k_uu;
        let arc_length = found.estimate().arc_length;
        assert!(arc_length > 2.0, "{arc_length}");
        assert_relative_eq!(value, 1.0 / 47.0, max_relative = 0.02);
        let [low, high] = found.interval95(Quantity::Normal { angle_rad: 0.0 });
        assert!(high.unwrap() - low.unwrap() < 0.02 / 47.0);
        held += u32::from(low < Some(1.0 / 47.0) && Some(1.0 / 47.0) < high);
    }
    assert!(held >= 34, "{held} of {trials}");
}

/// All rotations of a roll have the same relative error. Each trial runs four times, with the errors turned by 90° each
/// time, so that their linear effects cancel.
#[test]
fn errors_of_the_measured_rotations_do_not_bias() {
    let noise = SeriesNoise {
        relative_rotation_std: 0.1,
        ..EXACT
    };
    for (pitch, trials) in [(1.0, 60), (0.1, 12)] {
        let cell = PadCell { pitch, ..SQUARE };
        let (mut draws, mut sum) = (Draws(11), 0.0);
        for _ in 0..trials {
            let turn = 6.3 * draws.uniform();
            let exact = without_starts(&rolls(50.0, &cell, turn, &mut draws));
            let mut errors = [(); 8].map(|()| Vector2::from_fn(|_, _| draws.normal()) * 0.1);
            for _ in 0..4 {
                let mut rolls = exact.clone();
                for (roll, error) in rolls.iter_mut().zip(&mut errors) {
                    *error = Vector2::new(-error.y, error.x);
                    let samples = roll.samples.iter_mut();
                    samples.for_each(|one| one.rotation += error.push(0.0) * one.rotation.norm());
                }
                let places = Places::Pads(cell);
                let found = estimate_series(SeriesMethod::PadEdge, RADIUS, &places, &noise, &rolls);
                let relative = 1.0 + RADIUS * found.unwrap().curvature.mean_curvature();
                sum += relative / (1.0 + RADIUS / 50.0) - 1.0;
            }
        }
        let bias = sum / f64::from(4 * trials);
        assert!(bias.abs() < 1e-3, "{pitch}: {bias}");
    }
}

#[test]
fn a_roll_that_contradicts_the_others_is_left_out() {
    let sound = without_starts(&rolls(47.0, &SQUARE, 0.3, &mut Draws(3)));
    let turned = |factor: f64| {
        let mut rolls = sound.clone();
        let samples = rolls[5].samples.iter_mut();
        samples.for_each(|sample| sample.rotation *= factor);
        rolls
    };
    // In these samples, the pads are too far away for the contact.
    let far = |samples: std::ops::RangeInclusive<usize>| {
        let mut rolls = sound.clone();
        let samples = rolls[5].samples[samples].iter_mut();
        samples.for_each(|sample| sample.place.x += 5.0);
        rolls
    };
    let noise = |relative_rotation_std, rotation_std_rad| SeriesNoise {
        relative_rotation_std,
        rotation_std_rad,
        ..EXACT
    };
    let (gain, noisy) = (noise(0.002, 0.0), noise(0.0, 0.0017));
    let (pad_edge, trajectory) = (SeriesMethod::PadEdge, SeriesMethod::Trajectory);
    for (rolls, method, noise) in [
        (turned(1.05), pad_edge, EXACT),
        (turned(1.05), pad_edge, gain),
        (turned(1.3), pad_edge, noisy),
        (turned(-1.0), pad_edge, noisy),
        (turned(-1.0), trajectory, EXACT),
        (far(400..=420), pad_edge, EXACT),
        (far(400..=420), trajectory, EXACT),
        (far(1000..=1000), trajectory, EXACT),
        (far(1000..=1000), pad_edge, noisy),
    ] {
        let found = on_squares(method, &noise, &rolls).unwrap();
        let left_out = found.rolls.iter().map(|roll| roll.left_out);
        let named: Vec<_> = left_out
            .enumerate()
            .filter_map(|(roll, why)| Some((roll, why?)))
            .collect();
        assert_eq!(named, [(5, Exclusion::Inconsistent)], "{noise:?}");
        assert!(found.rolls[5].p_value.is_none_or(|p_value| p_value < 1e-4));
        let mean = found.curvature.mean_curvature();
        assert_relative_eq!(mean, 1.0 / 47.0, max_relative = 0.02);
    }
}

#[test]
fn bad_series_are_named() {
    let good = without_starts(&rolls(47.0, &SQUARE, 0.3, &mut Draws(3)));
    let estimate = |rolls: &[RollSeries]| on_squares(SeriesMethod::PadEdge, &EXACT, rolls);
    let changed = |change: &dyn Fn(&mut Vec<RollSeries>)| {
        let mut rolls = good.clone();
        change(&mut rolls);
        estimate(&rolls)
    };
    type Change = fn(&mut Vec<RollSeries>);
    let changes: [(&str, Change); 5] = [
        ("time-order", |rolls| rolls[2].samples.swap(3, 4)),
        ("not-finite", |rolls| {
            rolls[2].samples[7].rotation.x = f64::NAN;
        }),
        ("off-probe", |rolls| rolls[2].samples[7].place.x = 40.0),
        ("too-few-rolls", Vec::clear),
        ("not-rolling", |rolls| {
            let samples = rolls.iter_mut().flat_map(|roll| &mut roll.samples);
            samples.for_each(|one| one.rotation = -one.rotation);
        }),
    ];
    for (name, change) in changes {
        assert_eq!(<&str>::from(changed(&change).unwrap_err()), name);
    }
    // Two rolls along the same line do not determine the curvature across this line.
    let one_way = [good[0].clone(), good[4].clone()];
    assert_eq!(
        <&str>::from(estimate(&one_way).unwrap_err()),
        "undetermined"
    );
    type Cut = fn(&mut RollSeries);
    let cuts: [(usize, Exclusion, Cut); 4] = [
        (1, Exclusion::TooFewSamples, |one| one.samples.truncate(1)),
        (1, Exclusion::TooFewSamples, |one| one.samples.clear()),
        (6, Exclusion::NoRotation, |one| {
            let samples = one.samples.iter_mut();
            samples.for_each(|sample| sample.rotation = Vector3::zeros());
        }),
        (0, Exclusion::NoCrossing, |one| one.samples.truncate(5)),
    ];
    for (roll, why, change) in cuts {
        let found = changed(&|rolls| change(&mut rolls[roll])).unwrap();
        assert_eq!(found.rolls[roll].left_out, Some(why));
        let mean = found.curvature.mean_curvature();
        assert_relative_eq!(mean, 1.0 / 47.0, max_relative = 0.02);
    }
}

#[test]
fn noise_of_contacts_widens_the_bounds() {
    let (cell, mut draws) = (SQUARE, Draws(8));
    for trial in 0..6 {
        let mut rolls = rolls(47.0, &cell, 0.1 * f64::from(trial), &mut draws);
        for roll in &mut rolls {
            let start = roll.start.take().unwrap();
            for sample in &mut roll.samples {
                let drive = Vector2::new(-sample.rotation.y, sample.rotation.x);
                let noise = Vector2::from_fn(|_, _| draws.normal()) * 0.01;
                let path = drive / (1.0 / RADIUS + 1.0 / 47.0);
                sample.place = pad(&cell, &(chart(&start, &path) + noise));
            }
        }
        let curvature = 1.0 / 47.0;
        let square = curvature * curvature;
        let truths = [curvature, square, curvature, curvature, curvature];
        bounds_around(cell, RADIUS, &rolls, truths);
    }
}

/// The contact at each sample has noise that is smaller than the step between two samples, so pads hardly alternate.
#[test]
fn noise_of_crossings_is_estimated() {
    let (mut draws, mut held) = (Draws(5), 0);
    let trials = 60;
    for trial in 0..trials {
        let mut rolls = rolls(47.0, &SQUARE, 0.1 * f64::from(trial), &mut draws);
        for roll in &mut rolls {
            let start = roll.start.take().unwrap();
            roll.samples = roll.samples.iter().step_by(5).copied().collect();
            for sample in &mut roll.samples {
                let drive = Vector2::new(-sample.rotation.y, sample.rotation.x);
                let noise = Vector2::from_fn(|_, _| draws.normal()) * 0.003;
                let path = drive / (1.0 / RADIUS + 1.0 / 47.0);
                sample.place = pad(&SQUARE, &(chart(&start, &path) + noise));
            }
        }
        let found = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls).unwrap();
        assert!(found.rolls.iter().all(|roll| roll.left_out.is_none()));
        let [low, high] = found.interval95(Quantity::Mean).map(Option::unwrap);
        let distance = (1.0 / 47.0 - 0.5 * (low + high)) / (0.5 * (high - low));
        assert!(
            distance.abs() < 2.0 && high - low < 0.05 / 47.0,
            "{trial}: {distance}"
        );
        held += i32::from(distance.abs() < 1.0);
    }
    assert!(held >= 53, "{held} of {trials}");
}

/// The rotations jump once between two values, and do not change at the crossings of pad edges.
#[test]
fn rotations_that_jump_are_a_contradiction() {
    let mut rolls = without_starts(&rolls(47.0, &SQUARE, 0.3, &mut Draws(3)));
    for roll in &mut rolls {
        let (middle, end) = (roll.samples.len() / 2, roll.samples[roll.samples.len() - 1]);
        for (at, sample) in roll.samples.iter_mut().enumerate() {
            sample.rotation = if at < middle {
                Vector3::zeros()
            } else {
                end.rotation
            };
        }
    }
    let found = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls);
    assert!(
        matches!(found, Err(SeriesError::Contradiction { .. })),
        "{found:?}"
    );
}

#[test]
fn gaps_and_chatter_do_not_bias() {
    let mut rolls = without_starts(&rolls(47.0, &SQUARE, 0.3, &mut Draws(3)));
    for roll in &mut rolls {
        // For 3 ms after each crossing from one pad to the next, the samples alternate between the two pads.
        let places: Vec<_> = roll.samples.iter().map(|sample| sample.place).collect();
        for index in 3..places.len() - 3 {
            if index % 2 == 0 {
                roll.samples[index].place = places[index - 3];
            }
        }
        roll.samples
            .retain(|sample| (sample.time_s * 1000.0).round() as u32 % 97 > 2);
    }
    let found = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls).unwrap();
    assert!(found.rolls.iter().all(|roll| roll.left_out.is_none()));
    let [low, high] = found.bounds(Quantity::Mean).unwrap();
    assert!(low < Some(1.0 / 47.0) && Some(1.0 / 47.0) < high);
    let mean = found.curvature.mean_curvature();
    assert_relative_eq!(mean, 1.0 / 47.0, max_relative = 0.02);
    let thresholds = ShapeThresholds::new(1e-6, 1e-3).unwrap();
    assert_relative_eq!(found.class_probabilities(&thresholds)[0], 1.0);
}

#[test]
fn long_chatter_at_an_uneven_speed_ends() {
    let mut rolls = without_starts(&rolls(47.0, &SQUARE, 0.3, &mut Draws(4)));
    for samples in rolls.iter_mut().map(|roll| &mut roll.samples) {
        let places: Vec<_> = samples.iter().map(|sample| sample.place).collect();
        for index in (40..places.len()).step_by(2) {
            samples[index].place = places[index - 40];
        }
        for sample in samples {
            sample.time_s += 0.02 * libm::sin(40.0 * sample.time_s);
        }
    }
    let noise = SeriesNoise {
        rotation_std_rad: 1e-4,
        ..EXACT
    };
    let found = on_squares(SeriesMethod::PadEdge, &noise, &rolls);
    let [low, high] = found.unwrap().interval95(Quantity::Mean);
    assert!(low < Some(1.0 / 47.0) && Some(1.0 / 47.0) < high);
}

#[test]
fn rolls_that_turn_back_have_intervals_that_hold() {
    let (mut draws, mut held) = (Draws(6), 0);
    for trial in 0..20 {
        let turn = 0.1 * f64::from(trial);
        let mut rolls = without_starts(&rolls(47.0, &SQUARE, turn, &mut draws));
        for samples in rolls.iter_mut().map(|roll| &mut roll.samples) {
            samples.extend_from_within(..samples.len() - 1);
            let half = samples.len() / 2 + 1;
            samples[half..].reverse();
            let times = samples.iter_mut().zip(0..);
            times.for_each(|(sample, time)| sample.time_s = f64::from(time));
        }
        let found = on_squares(SeriesMethod::PadEdge, &EXACT, &rolls);
        let [low, high] = found.unwrap().interval95(Quantity::Mean);
        held += u32::from(low < Some(1.0 / 47.0) && Some(1.0 / 47.0) < high);
    }
    assert!(held >= 17, "{held}");
}
