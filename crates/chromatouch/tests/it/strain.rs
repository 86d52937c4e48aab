//! Tests the strain of a skin that is folded from gores.

use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use palpate_chromatouch::FoldStrain;

#[test]
fn four_six_and_eight_gores_stretch_by_47_30_and_22_percent() {
    for (gores, percent) in [(4, 47.0), (6, 30.0), (8, 22.0)] {
        let greatest = FoldStrain::of(gores).unwrap().greatest;
        assert_eq!((100.0 * greatest).round(), percent);
    }
}

/// Point of a flat gore after folding onto a sphere of radius 1.
fn fold([x, y]: [f64; 2]) -> [f64; 3] {
    let longitude = x / libm::cos(y);
    [
        libm::cos(y) * libm::cos(longitude),
        libm::cos(y) * libm::sin(longitude),
        libm::sin(y),
    ]
}

/// Principal stretches of the fold: the square roots of the eigenvalues of JᵀJ. The Jacobian J of the fold is
/// computed by central differences.
fn stretches(x: f64, y: f64) -> [f64; 2] {
    let step = 1e-5;
    let difference = |ahead: [f64; 3], behind: [f64; 3]| {
        [0, 1, 2].map(|axis| (ahead[axis] - behind[axis]) / (2.0 * step))
    };
    let along_x = difference(fold([x + step, y]), fold([x - step, y]));
    let along_y = difference(fold([x, y + step]), fold([x, y - step]));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (xx, xy, yy) = (
        dot(along_x, along_x),
        dot(along_x, along_y),
        dot(along_y, along_y),
    );
    let spread = libm::hypot(0.5 * (xx - yy), xy);
    [0.5 * (xx + yy) + spread, 0.5 * (xx + yy) - spread].map(f64::sqrt)
}

#[test]
fn the_strain_is_that_of_the_fold_in_space() {
    for gores in [3, 4, 8] {
        let strain = FoldStrain::of(gores).unwrap();
        for latitude in [0.01_f64, 0.4, 0.9, 1.4] {
            for share in [-1.0, -0.3, 0.0, 0.7, 1.0] {
                let longitude = share * PI / f64::from(gores);
                let [greatest, least] = stretches(longitude * libm::cos(latitude), latitude);
                let expected = 1.0 + strain.at(longitude, latitude).unwrap();
                assert_relative_eq!(greatest, expected, max_relative = 1e-8);
                assert_relative_eq!(least, 1.0 / expected, max_relative = 1e-8);
                assert!(expected - 1.0 <= strain.greatest);
            }
        }
    }
}

/// Mean square of the strain, computed from a series. The shear s and the stretch σ fulfil σ² = sσ + 1. Therefore
/// the squared strain is (σ − 1)² = 2 + (s − 2)(s/2 + √(1 + s²/4)), which is expanded in powers of s. The mean of
/// sᵏ over one of n gores is (π/n)ᵏ/(k + 1)².
fn mean_square_by_series(gores: u32) -> f64 {
    let widest = PI / f64::from(gores);
    let moment = |power: i32| widest.powi(power) / f64::from((power + 1).pow(2));
    let mut mean = moment(2) / 2.0 - moment(1) + 2.0;
    let mut binomial = 1.0;
    for term in 0..60 {
        // The square root √(1 + s²/4) is expanded as Σ C(½, j) (s/2)²ʲ, with the shear s and the binomial
        // coefficients C(½, j).
        let weight = binomial / 4.0_f64.powi(term);
        mean += weight * (moment(2 * term + 1) - 2.0 * moment(2 * term));
        binomial *= (0.5 - f64::from(term)) / f64::from(term + 1);
    }
    mean
}

#[test]
fn the_mean_square_is_that_of_the_series() {
    for gores in 3..=12 {
        let strain = FoldStrain::of(gores).unwrap();
        let series = mean_square_by_series(gores).sqrt();
        assert_relative_eq!(strain.rms, series, max_relative = 1e-11);
    }
}

#[test]
fn many_gores_strain_in_proportion_to_their_width() {
    // For a small shear s, the strain is s/2. If a skin is folded from n gores (flat pieces), the largest strain is
    // π/(2n), and the root mean square of the strain is a third of this value.
    for gores in [1_000_000, u32::MAX] {
        let strain = FoldStrain::of(gores).unwrap();
        let limit = FRAC_PI_2 / f64::from(gores);
        assert_relative_eq!(strain.greatest, limit, max_relative = 1e-5);
        assert_relative_eq!(strain.rms, limit / 3.0, max_relative = 1e-5);
    }
}

#[test]
fn too_few_gores_are_named() {
    for (gores, percent) in [(0, None), (1, Some("243 %")), (2, Some("106 %"))] {
        let error = FoldStrain::of(gores).unwrap_err();
        assert_eq!(<&str>::from(&error), "too-few-gores");
        let message = error.to_string();
        assert!(message.contains(&format!("gores is {gores}; it must be at least 3")));
        assert_eq!(message.contains('%'), percent.is_some());
        assert!(percent.is_none_or(|percent| message.contains(percent)));
    }
}
