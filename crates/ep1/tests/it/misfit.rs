//! Compares the goodness of fit and the misfits of readings with exact formulas.

use approx::assert_relative_eq;
use palpate_ep1::{GoodnessOfFit, LeastSquares, Misfit, ProbeReading, ReadingNoise};

use crate::draws::Draws;
use crate::{EXACT, FORM, eight, isotropic, readings};

const OF_SHIFTS: ReadingNoise = ReadingNoise {
    shift_std: 1e-3,
    ..EXACT
};
const OF_ALL: ReadingNoise = ReadingNoise {
    relative_rotation_std: 0.02,
    rotation_std_rad: 1e-3,
    shift_std: 5e-4,
    ..EXACT
};

/// Eight rolls whose directions are an eighth of a turn apart.
fn around() -> Vec<(f64, f64)> {
    let step = std::f64::consts::FRAC_PI_4;
    (0..8).map(|index| (f64::from(index) * step, 0.1)).collect()
}

/// Rolls in several directions, each by a different angle.
fn askew() -> Vec<(f64, f64)> {
    [0.2, 0.9, 1.7, 2.4, -2.8, -1.9, -1.1, -0.5, 0.3]
        .into_iter()
        .enumerate()
        .map(|(index, direction)| (direction, 0.05 + 0.02 * index as f64))
        .collect()
}

fn goodness(stated: ReadingNoise, readings: &[ProbeReading]) -> Option<GoodnessOfFit> {
    let estimate = LeastSquares::of(1.0, stated, readings).unwrap();
    estimate.goodness(stated, readings)
}

fn misfits(stated: ReadingNoise, readings: &[ProbeReading]) -> Vec<Misfit> {
    let estimate = LeastSquares::of(1.0, stated, readings).unwrap();
    estimate.misfits(stated, readings)
}

/// Kolmogorov statistic of `numbers`: the largest difference between their distribution and the uniform distribution
/// from 0 to 1, multiplied by the square root of their count.
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

/// Kolmogorov statistic that a large sample of uniform numbers exceeds with a probability of 1 %.
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
        let p_values = (0..300).map(|_| {
            let goodness = goodness(noise, &draws.noisy(&exact, &noise)).unwrap();
            assert_eq!(goodness.freedom, 2 * rolls.len() - 3);
            goodness.p_value
        });
        let off = kolmogorov(p_values.collect());
        assert!(off < ONE_IN_100, "{off} of {noise:?}");
    }
}

#[test]
fn residuals_of_two_probes_to_and_fro_are_in_closed_form() {
    // The first two rolls have the same direction, but their shifts have the errors +0.003 and −0.003. No curvature of
    // the object explains both shifts.
    let rolls = [(0.0, 0.1), (0.0, 0.1), (1.5, 0.1)];
    let mut read = readings(1.0, &FORM, &rolls);
    read[0].shift.x += 0.003;
    read[1].shift.x -= 0.003;
    let of_shifts = goodness(OF_SHIFTS, &read).unwrap();
    assert_eq!(of_shifts.freedom, 3);
    assert_relative_eq!(of_shifts.chi_squared, 18.0, max_relative = 1e-9);
    // Noise of the rotations, multiplied by the contact's travel per radian, has the same effect as noise of the
    // shifts. So chi-squared is the same.
    let stated = ReadingNoise {
        relative_rotation_std: 0.01,
        ..EXACT
    };
    let plane = isotropic(0.0);
    let mut read = readings(1.0, &plane, &rolls);
    read[0].shift.x += 0.003;
    read[1].shift.x -= 0.003;
    let of_rotations = goodness(stated, &read).unwrap();
    assert_relative_eq!(of_rotations.chi_squared, 18.0, max_relative = 1e-9);
}

/// Share of 400 noisy sets of rolls in which at least one misfit fulfils the condition `is_due`.
fn share(
    stated: ReadingNoise,
    exact: &[ProbeReading],
    noise: &ReadingNoise,
    is_due: impl Fn(&Misfit) -> bool,
) -> f64 {
    let mut draws = Draws(11);
    let found = (0..400).filter(|_| {
        let misfits = misfits(stated, &draws.noisy(exact, noise));
        misfits.iter().any(&is_due)
    });
    found.count() as f64 / 400.0
}

#[test]
fn sound_readings_hardly_ever_have_a_misfit() {
    for (noise, stated) in [(OF_SHIFTS, OF_SHIFTS), (OF_ALL, OF_ALL), (OF_SHIFTS, EXACT)] {
        for rolls in [around(), eight(0.1), askew(), askew()[..4].to_vec()] {
            let share = share(stated, &readings(1.0, &FORM, &rolls), &noise, |_| true);
            assert!(share < 0.05, "{share} with {stated:?}");
        }
    }
    // If all rotations are multiplied by the same factor, the readings equal the readings of another probe on another
    // object, so there is no misfit.
    let mut gained = readings(1.0, &FORM, &around());
    gained.iter_mut().for_each(|one| one.rotation *= 1.3);
    let share = share(OF_SHIFTS, &gained, &OF_SHIFTS, |_| true);
    assert!(share < 0.03, "{share}");
}

#[test]
fn noise_three_times_the_stated_one_is_a_poor_fit() {
    let thrice = ReadingNoise {
        shift_std: 3.0 * OF_SHIFTS.shift_std,
        ..OF_SHIFTS
    };
    for (rolls, least) in [(around(), 0.99), (eight(0.1)[..4].to_vec(), 0.9)] {
        let exact = readings(1.0, &FORM, &rolls);
        let share = share(OF_SHIFTS, &exact, &thrice, |one| one.code() == "poor-fit");
        assert!(share >= least, "{share} of {} probes", rolls.len());
    }
}

#[test]
fn an_outlier_of_eight_standard_deviations_is_named() {
    let is_third = |misfit: &Misfit| matches!(misfit, Misfit::Outlier { reading: 2, .. });
    for (stated, rolls, least) in [
        (OF_SHIFTS, around(), 0.99),
        (OF_SHIFTS, askew()[..4].to_vec(), 0.9),
        (EXACT, around(), 0.9),
    ] {
        let mut read = readings(1.0, &FORM, &rolls);
        read[2].shift.x += 8.0 * OF_SHIFTS.shift_std;
        let named = share(stated, &read, &OF_SHIFTS, is_third);
        let other = |one: &Misfit| matches!(one, Misfit::Outlier { reading, .. } if *reading != 2);
        let wrong = share(stated, &read, &OF_SHIFTS, other);
        assert!(
            named >= least && wrong <= 0.02,
            "{named} {wrong} with {stated:?}"
        );
    }
}

#[test]
fn pads_round_the_first_contact_by_no_more_than_a_pad() {
    const PITCH: f64 = 0.002;
    let stated = ReadingNoise {
        shift_std: PITCH / 6.0_f64.sqrt(),
        shift_resolution: PITCH,
        ..ReadingNoise::default()
    };
    let rolls: Vec<_> = (0..10).map(|index| (0.3 * f64::from(index), 0.1)).collect();
    let shifted = |by: f64| {
        let mut read = readings(1.0, &FORM, &rolls);
        read.iter_mut().for_each(|one| one.shift.x += by);
        goodness(stated, &read).unwrap()
    };
    assert!(shifted(0.5 * PITCH).p_value > 0.99);
    assert!(shifted(6.0 * PITCH).p_value < 1e-3);
}

#[test]
fn a_stated_noise_far_above_the_residuals_contradicts_them() {
    let exact = readings(1.0, &FORM, &around());
    let large = ReadingNoise {
        shift_std: 8.0 * OF_SHIFTS.shift_std,
        ..OF_SHIFTS
    };
    let is_found = |one: &Misfit| one.code() == "stated-noise";
    assert!(share(large, &exact, &OF_SHIFTS, is_found) > 0.99);
    assert_eq!(share(OF_SHIFTS, &exact, &OF_SHIFTS, is_found), 0.0);
}

#[test]
fn exact_readings_have_no_misfit_but_a_stated_noise() {
    let exact = readings(1.0, &FORM, &around());
    assert_eq!(misfits(EXACT, &exact), []);
    assert_eq!(goodness(EXACT, &exact), None);
    assert!(goodness(OF_SHIFTS, &exact).unwrap().p_value > 0.999_999);
    let codes: Vec<_> = misfits(OF_SHIFTS, &exact)
        .iter()
        .map(Misfit::code)
        .collect();
    assert_eq!(codes, ["stated-noise"]);
    // Two probes give four equations for three parameters, so there is one degree of freedom.
    assert_eq!(goodness(OF_SHIFTS, &exact[..2]).unwrap().freedom, 1);
}

/// The noise is so small that the squared residuals, divided by its variance, overflow. The fit is then reported as
/// poor, but no roll is reported as an outlier.
#[test]
fn noise_that_is_far_too_small_is_a_poor_fit_alone() {
    let mut draws = Draws(29);
    let read = draws.noisy(&readings(1.0, &FORM, &around()), &OF_SHIFTS);
    for shift_std in [1e-6, 1e-100, 1e-300] {
        let stated = ReadingNoise {
            shift_std,
            ..ReadingNoise::default()
        };
        let found = misfits(stated, &read);
        let codes: Vec<_> = found.iter().map(Misfit::code).collect();
        assert_eq!(codes, ["poor-fit"], "{shift_std}");
        assert!(found[0].p_value() < 1e-12);
    }
}
