//! Goodness of fit and doubts against readings whose truth is in closed form.

use std::collections::BTreeMap;

use approx::assert_relative_eq;
use nalgebra::{Matrix2, Vector2};
use palpate_ep1::{Agreement, Doubt, LeastSquares, PadStart, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;

use crate::draws::Draws;
use crate::{eight, readings};

const FORM: CurvatureForm = CurvatureForm {
    k_uu: 0.4,
    k_uv: 0.3,
    k_vv: 1.2,
};
const OF_SHIFTS: ReadingNoise = ReadingNoise {
    relative_rotation_std: 0.0,
    rotation_std_rad: 0.0,
    shift_std: 1e-3,
    shift_resolution: 0.0,
    pad_start: PadStart::PerRoll,
};
const OF_ALL: ReadingNoise = ReadingNoise {
    relative_rotation_std: 0.02,
    rotation_std_rad: 1e-3,
    shift_std: 5e-4,
    shift_resolution: 0.0,
    pad_start: PadStart::PerRoll,
};
const UNKNOWN: ReadingNoise = ReadingNoise {
    relative_rotation_std: 0.0,
    rotation_std_rad: 0.0,
    shift_std: 0.0,
    shift_resolution: 0.0,
    pad_start: PadStart::PerRoll,
};

/// Eight probes in directions an eighth of a turn apart.
fn around() -> Vec<(f64, f64)> {
    let step = std::f64::consts::FRAC_PI_4;
    (0..8).map(|index| (f64::from(index) * step, 0.1)).collect()
}

/// Ten probes that all roll to one side.
fn one_way() -> Vec<(f64, f64)> {
    (0..10).map(|index| (0.3 * f64::from(index), 0.1)).collect()
}

/// Probes of every length and direction.
fn askew() -> Vec<(f64, f64)> {
    [0.2, 0.9, 1.7, 2.4, -2.8, -1.9, -1.1, -0.5, 0.3]
        .into_iter()
        .enumerate()
        .map(|(index, direction)| (direction, 0.05 + 0.02 * index as f64))
        .collect()
}

fn agreement(told: ReadingNoise, readings: &[ProbeReading]) -> Agreement {
    let (fit, estimate) = LeastSquares::fitted(1.0, told, readings).unwrap();
    fit.agreement(&estimate, readings)
}

/// Largest distance of the distribution of numbers from the uniform one (Kolmogorov), times the root of their number.
fn kolmogorov(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len() as f64;
    let off = numbers.iter().enumerate().map(|(index, number)| {
        let below = index as f64 / count;
        (number - below)
            .abs()
            .max((number - below - 1.0 / count).abs())
    });
    off.fold(0.0, f64::max) * count.sqrt()
}

/// Kolmogorov's distance that uniform numbers exceed once in a hundred.
const ONE_IN_100: f64 = 1.628;

#[test]
fn p_values_are_uniform_where_the_model_holds() {
    let mut draws = Draws(5);
    for (noise, rolls) in [
        (OF_SHIFTS, around()),
        (OF_SHIFTS, eight(0.1)),
        (OF_SHIFTS, askew()[..3].to_vec()),
        (OF_ALL, around()),
        (OF_ALL, askew()),
    ] {
        let exact = readings(1.0, &FORM, &rolls);
        let goodness = (0..300).map(|_| {
            let goodness = agreement(noise, &draws.noisy(&exact, &noise))
                .goodness
                .unwrap();
            assert_eq!(goodness.freedom, 2 * rolls.len() - 3);
            goodness.p_value
        });
        let off = kolmogorov(goodness.collect());
        assert!(off < ONE_IN_100, "{off} of {noise:?}");
    }
}

#[test]
fn residuals_of_two_probes_to_and_fro_are_in_closed_form() {
    // Each pair errs by ±0.003 along the roll, which no mobility explains.
    let rolls = [(0.0, 0.1), (0.0, 0.1), (1.5, 0.1)];
    let mut read = readings(1.0, &FORM, &rolls);
    read[0].shift.x += 0.003;
    read[1].shift.x -= 0.003;
    let goodness = agreement(OF_SHIFTS, &read).goodness.unwrap();
    assert_eq!(goodness.freedom, 3);
    assert_relative_eq!(goodness.chi_squared, 18.0, max_relative = 1e-9);
    // Noise of rotations is that of shifts through the mobility.
    let told = ReadingNoise {
        relative_rotation_std: 0.01,
        ..UNKNOWN
    };
    let plane = CurvatureForm::isotropic(0.0);
    let mut read = readings(1.0, &plane, &rolls);
    read[0].shift.x += 0.003;
    read[1].shift.x -= 0.003;
    let goodness = agreement(told, &read).goodness.unwrap();
    assert_relative_eq!(goodness.chi_squared, 18.0, max_relative = 1e-9);
}

#[test]
fn what_holds_is_hardly_ever_doubted() {
    let mut draws = Draws(11);
    for (noise, told) in [
        (OF_SHIFTS, OF_SHIFTS),
        (OF_ALL, OF_ALL),
        (OF_SHIFTS, UNKNOWN),
    ] {
        for rolls in [around(), eight(0.1), askew()] {
            let exact = readings(1.0, &FORM, &rolls);
            let trials = 200;
            let doubted = (0..trials).filter(|_| {
                let found = agreement(told, &draws.noisy(&exact, &noise));
                assert_eq!(found.goodness.is_some(), told.is_stated());
                !found.doubts.is_empty()
            });
            let share = doubted.count() as f64 / f64::from(trials);
            assert!((0.002..0.06).contains(&share), "{share} with {told:?}");
        }
    }
}

/// Readings that are changed, and the doubt that is due.
type Flaw = (fn(&mut [ProbeReading]), &'static str);

const FLAWS: [Flaw; 5] = [
    (
        |readings| readings.iter_mut().for_each(|one| one.shift.y += 0.006),
        "common-shift",
    ),
    (
        |readings| {
            let (sine, cosine) = libm::sincos(0.15);
            let turn = Matrix2::new(cosine, -sine, sine, cosine);
            readings
                .iter_mut()
                .for_each(|one| one.rotation = turn * one.rotation);
        },
        "twist",
    ),
    (
        |readings| {
            for one in readings {
                // The curvature along u changes along u.
                one.shift.x += 2.0 * one.shift.x * one.shift.x;
            }
        },
        "varying-curvature",
    ),
    (
        |readings| {
            for one in readings {
                // A quartic saddle of heights.
                let [u, v]: [f64; 2] = one.shift.into();
                one.shift +=
                    30.0 * Vector2::new(u * u * u - 3.0 * u * v * v, v * v * v - 3.0 * u * u * v);
            }
        },
        "varying-curvature",
    ),
    (|readings| readings[3].shift *= 0.7, "slipped-probe"),
];

#[test]
fn pads_round_the_first_contact_by_no_more_than_a_pad() {
    const PITCH: f64 = 0.002;
    let told = ReadingNoise {
        shift_std: PITCH / 6.0_f64.sqrt(),
        shift_resolution: PITCH,
        ..ReadingNoise::default()
    };
    let shifted = |by: f64| {
        let mut read = readings(1.0, &FORM, &one_way());
        read.iter_mut().for_each(|one| one.shift.x += by);
        agreement(told, &read)
    };
    assert!(shifted(0.5 * PITCH).doubts.is_empty());
    let beyond = shifted(6.0 * PITCH);
    assert!(beyond.goodness.unwrap().p_value < 1e-3, "{beyond:?}");
    assert!(
        beyond
            .doubts
            .iter()
            .any(|doubt| doubt.name() == "common-shift"),
        "{beyond:?}"
    );
}

#[test]
fn each_flaw_is_named() {
    let mut draws = Draws(17);
    for (flaw, name) in FLAWS {
        for told in [OF_SHIFTS, UNKNOWN] {
            let trials = 100;
            let named = (0..trials).filter(|_| {
                let mut read = readings(1.0, &FORM, &one_way());
                flaw(&mut read);
                let doubts = agreement(told, &draws.noisy(&read, &OF_SHIFTS)).doubts;
                doubts.iter().any(|doubt| doubt.name() == name)
            });
            let share = named.count() as f64 / f64::from(trials);
            assert!(share > 0.9, "{name}: {share} with {told:?}");
        }
    }
}

/// Names of the doubts of noisy rolls around that are spoiled, and how many of 200 estimates have each.
fn doubted(told: ReadingNoise, exact: &[ProbeReading], seed: u64) -> BTreeMap<&'static str, u32> {
    let mut draws = Draws(seed);
    let mut counts = BTreeMap::new();
    for _ in 0..200 {
        for doubt in agreement(told, &draws.noisy(exact, &OF_SHIFTS)).doubts {
            *counts.entry(doubt.name()).or_default() += 1;
        }
    }
    counts
}

#[test]
fn first_contacts_that_are_off_are_told_where_they_change_no_curvature() {
    let exact = readings(1.0, &FORM, &around());
    let mut off = exact.clone();
    off.iter_mut().for_each(|one| one.shift.y += 0.006);
    let curvature = |readings: &[ProbeReading]| {
        let estimate = LeastSquares::of(1.0, UNKNOWN, readings).unwrap();
        estimate.curvature.matrix()
    };
    assert!((curvature(&off) - curvature(&exact)).amax() < 1e-12);
    for told in [OF_SHIFTS, UNKNOWN] {
        let counts = doubted(told, &off, 19);
        assert!(counts["common-shift"] > 190, "{counts:?}");
    }
}

#[test]
fn a_curvature_that_varies_is_told_where_the_rolls_are_long_enough_to_err_by_it() {
    // The curvature along u grows to as much as it falls fro, so that the estimate does not change.
    let varying = |angle: f64| {
        let rolls: Vec<_> = around().iter().map(|(to, _)| (*to, angle)).collect();
        let mut read = readings(1.0, &FORM, &rolls);
        for one in &mut read {
            one.shift.x += 0.15 * FORM.k_uu * one.shift.x * one.shift.x;
        }
        read
    };
    for (angle, is_told) in [(0.3, false), (2.0, true)] {
        let read = varying(angle);
        for told in [OF_SHIFTS, UNKNOWN] {
            let found = agreement(told, &read);
            assert!(found.goodness.is_none_or(|one| one.p_value < 0.1));
            let counts = doubted(told, &read, 19);
            let of_varying = counts.get("varying-curvature").copied().unwrap_or(0);
            let all: u32 = counts.values().sum();
            match is_told {
                true => assert!(of_varying > 190, "{counts:?}"),
                false => assert!(all < 30, "{counts:?}"),
            }
        }
    }
}

#[test]
fn the_probe_that_slipped_is_told() {
    let mut draws = Draws(23);
    let mut read = readings(1.0, &FORM, &askew());
    read[6].shift *= 0.8;
    let doubts = agreement(OF_SHIFTS, &draws.noisy(&read, &OF_SHIFTS)).doubts;
    let slipped = doubts.iter().find_map(|doubt| match doubt {
        Doubt::SlippedProbe { probe, .. } => Some(*probe),
        _ => None,
    });
    assert_eq!(slipped, Some(6));
}

#[test]
fn noise_thrice_as_large_as_told_is_named() {
    let mut draws = Draws(29);
    let exact = readings(1.0, &FORM, &around());
    let thrice = ReadingNoise {
        shift_std: 3.0 * OF_SHIFTS.shift_std,
        ..OF_SHIFTS
    };
    let named = (0..200).filter(|_| {
        let doubts = agreement(OF_SHIFTS, &draws.noisy(&exact, &thrice)).doubts;
        doubts.iter().any(|doubt| doubt.name() == "large-residuals")
    });
    let count = named.count();
    assert!(count > 180, "{count}");
}

#[test]
fn a_gain_is_not_seen() {
    // It is that of another probe on another object.
    let mut draws = Draws(31);
    let exact = readings(1.0, &FORM, &around());
    let doubted = (0..500).filter(|_| {
        let mut read = draws.noisy(&exact, &OF_SHIFTS);
        read.iter_mut().for_each(|one| one.rotation *= 1.3);
        !agreement(OF_SHIFTS, &read).doubts.is_empty()
    });
    let count = doubted.count();
    assert!(count < 25, "{count}");
}

#[test]
fn first_contacts_between_pads_are_no_common_shift() {
    let told = ReadingNoise {
        shift_resolution: 1e-3,
        ..OF_SHIFTS
    };
    let mut draws = Draws(37);
    let mut read = draws.noisy(&readings(1.0, &FORM, &around()), &OF_SHIFTS);
    read.iter_mut().for_each(|one| one.shift.x += 4e-4);
    let found = agreement(told, &read);
    assert_eq!(found.doubts, []);
    assert_eq!(found.goodness.unwrap().freedom, 13);
}

#[test]
fn exact_readings_are_not_doubted() {
    let exact = readings(1.0, &FORM, &around());
    assert_eq!(agreement(UNKNOWN, &exact), Agreement::default());
    let found = agreement(OF_SHIFTS, &exact);
    assert!(found.doubts.is_empty() && found.goodness.unwrap().p_value > 0.999_999);
    // Two probes have one equation to spare.
    let two = agreement(OF_SHIFTS, &exact[..2]);
    assert_eq!((two.doubts.len(), two.goodness.unwrap().freedom), (0, 1));
}

/// Noise of which nothing is left in double precision: the residuals are too large for it, and no cause is named.
#[test]
fn noise_that_is_far_too_small_names_no_cause() {
    let mut draws = Draws(29);
    let read = draws.noisy(&readings(1.0, &FORM, &around()), &OF_SHIFTS);
    for shift_std in [1e-6, 1e-100, 1e-300] {
        let told = ReadingNoise {
            shift_std,
            ..ReadingNoise::default()
        };
        let found = agreement(told, &read);
        let names: Vec<_> = found.doubts.iter().map(|doubt| doubt.name()).collect();
        assert_eq!(names, ["large-residuals"], "{shift_std}");
        assert!(found.doubts[0].p_value() < 1e-12);
    }
}
