//! Compares standard errors with a Monte Carlo simulation of the readings.

use approx::assert_relative_eq;
use palpate_ep1::{Estimate, LeastSquares, Measured, PadStart, ReadingNoise};
use palpate_geometry::CurvatureForm;

use crate::draws::Draws;
use crate::{FORM, eight, isotropic, readings};

fn quantities(estimate: &Estimate) -> [Measured; 4] {
    [
        estimate.normal_curvature_u,
        estimate.normal_curvature_v,
        estimate.gaussian_curvature,
        estimate.mean_curvature,
    ]
}

#[test]
fn standard_errors_match_all_noise_with_any_lengths_and_directions() {
    let noise = ReadingNoise {
        relative_rotation_std: 0.002,
        rotation_std_rad: 1e-4,
        shift_std: 1e-4,
        ..Default::default()
    };
    let rolls = [(0.2, 0.1), (1.0, 0.2), (2.5, 0.05), (-1.7, 0.15)];
    let exact = readings(1.0, &FORM, &rolls);
    let stated = quantities(&LeastSquares::of(1.0, noise, &exact).unwrap());
    let trials = 20_000;
    let mut draws = Draws(99);
    let mut square = [0.0; 4];
    for _ in 0..trials {
        let noisy = draws.noisy(&exact, &noise);
        let estimate = LeastSquares::of(1.0, noise, &noisy).unwrap();
        for (sum, (found, stated)) in square
            .iter_mut()
            .zip(quantities(&estimate).iter().zip(&stated))
        {
            *sum += (found.value - stated.value).powi(2) / f64::from(trials);
        }
    }
    for (square, stated) in square.iter().zip(&stated) {
        assert_relative_eq!(square.sqrt(), stated.std.unwrap(), max_relative = 0.03);
    }
}

/// Without the correction of the second order, the bias would be 0.37 % times 1 + R₂/R₁, where R₁ and R₂ are the radii of
/// probe and object.
#[test]
fn errors_of_measured_rotations_do_not_bias_the_curvature() {
    let noise = ReadingNoise {
        relative_rotation_std: 0.1,
        is_rotation_measured: true,
        ..Default::default()
    };
    let star: Vec<_> = (0..8).map(|roll| (0.785 * f64::from(roll), 0.1)).collect();
    let exact = readings(1.0, &isotropic(0.2), &star);
    let (mut draws, trials) = (Draws(7), 40_000);
    let estimates = (0..trials).map(|_| LeastSquares::of(1.0, noise, &draws.noisy(&exact, &noise)));
    let sum: f64 = estimates.map(|one| one.unwrap().mean_curvature.value).sum();
    let bias = (sum / f64::from(trials) / 0.2 - 1.0) / 6.0;
    assert!(bias.abs() < 1e-3, "{bias}");
}

/// Standard error of the mean curvature that is estimated from rolls in the directions `directions_deg` over pads. The
/// object is a ball with a radius of five probe radii.
fn std_over_pads(start: PadStart, directions_deg: &[f64]) -> f64 {
    let rolls: Vec<(f64, f64)> = directions_deg
        .iter()
        .map(|direction| (direction.to_radians(), 0.3))
        .collect();
    let exact = readings(1.0, &isotropic(0.2), &rolls);
    let noise = ReadingNoise::of_pads(0.02, start);
    let estimate = LeastSquares::of(1.0, noise, &exact).unwrap();
    estimate.mean_curvature.std.unwrap()
}

#[test]
fn rolls_that_share_errors_count_once() {
    let crossed = [0.0, 90.0];
    let star = [0.0, 90.0, 180.0, 270.0];
    let stars = [star; 8].concat();
    let ratio =
        |start, one: &[f64], other: &[f64]| std_over_pads(start, one) / std_over_pads(start, other);
    assert_relative_eq!(
        ratio(PadStart::PerRoll, &star, &stars),
        8.0_f64.sqrt(),
        max_relative = 1e-9
    );
    assert_relative_eq!(
        ratio(PadStart::PerTrial, &star, &stars),
        1.0,
        max_relative = 1e-9
    );
    assert_relative_eq!(
        ratio(PadStart::Centred, &crossed, &stars),
        1.0,
        max_relative = 1e-9
    );
    // A star is a set of rolls in pairs: both rolls of a pair begin at the same start and have opposite directions. The
    // error of the start cancels in each pair, so only the errors of the ends remain.
    assert_relative_eq!(
        std_over_pads(PadStart::PerTrial, &star),
        std_over_pads(PadStart::PerRoll, &star) / 2.0_f64.sqrt(),
        max_relative = 1e-9
    );
}

#[test]
fn intervals_of_flat_objects_include_the_rounding_error() {
    for flatter in [1e3, 1e9, 1e13, 1e17, 1e30] {
        let exact = readings(2.0, &isotropic(0.5 / flatter), &eight(0.1));
        // This noise is far smaller than the last digit of the readings, so the rounding of the readings alone
        // determines the standard error.
        let noise = ReadingNoise {
            shift_std: 1e-30,
            ..Default::default()
        };
        let estimate = LeastSquares::of(2.0, noise, &exact).unwrap();
        let truth = 0.5 / flatter;
        for (found, truth) in [
            (estimate.normal_curvature_u, truth),
            (estimate.normal_curvature_v, truth),
            (estimate.mean_curvature, truth),
            (estimate.gaussian_curvature, truth * truth),
        ] {
            let half_width = 1.96 * found.std.unwrap();
            assert!(
                (found.value - truth).abs() <= half_width,
                "{flatter:e}: {found:?}"
            );
            assert!(half_width < 2e-15, "{flatter:e}: {found:?}");
        }
    }
}

#[test]
fn intervals_of_principal_curvatures_hold_them_even_where_they_coincide() {
    let noise = ReadingNoise {
        shift_std: 2e-4,
        ..Default::default()
    };
    let near = CurvatureForm {
        k_uu: 0.21,
        k_uv: 0.01,
        k_vv: 0.2,
    };
    for form in [FORM, near, isotropic(0.2), CurvatureForm::default()] {
        let (exact, truth) = (readings(1.0, &form, &eight(0.1)), form.principal());
        let (mut draws, trials, mut held) = (Draws(7), 4000, [0.0; 3]);
        for _ in 0..trials {
            let noisy = draws.noisy(&exact, &noise);
            let (fit, estimate) = LeastSquares::fitted(1.0, noise, &noisy).unwrap();
            let found = estimate.curvature.principal();
            let covariance = fit.covariance(&estimate).unwrap();
            let stds = estimate.curvature.principal_stds(&covariance);
            let turn = found.angle_of_max_rad - truth.angle_of_max_rad;
            let errors = [
                found.k_min - truth.k_min,
                found.k_max - truth.k_max,
                turn - std::f64::consts::PI * (turn / std::f64::consts::PI).round(),
            ];
            for (held, (error, std)) in held.iter_mut().zip(errors.iter().zip(stds)) {
                *held += f64::from(u8::from(error.abs() <= 1.96 * std)) / f64::from(trials);
            }
        }
        assert!(
            held.iter().all(|share| *share > 0.935),
            "{form:?}: {held:?}"
        );
    }
}
