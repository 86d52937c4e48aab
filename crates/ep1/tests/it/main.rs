//! Integration tests of EP1.
#![allow(clippy::unwrap_used)]

mod any_number;
mod ball_rolls;
mod covariance;
mod draws;
mod exact;
mod misfit;
mod refusals;
mod series;
mod trajectories;

use nalgebra::{Matrix2, Rotation2, Vector2};
use palpate_ep1::{PadStart, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;

/// A curvature form whose normal curvature depends on the direction.
pub const FORM: CurvatureForm = CurvatureForm {
    k_uu: 0.4,
    k_uv: 0.3,
    k_vv: 1.2,
};

/// Zero noise.
pub const EXACT: ReadingNoise = ReadingNoise {
    relative_rotation_std: 0.0,
    rotation_std_rad: 0.0,
    shift_std: 0.0,
    shift_resolution: 0.0,
    pad_start: PadStart::PerRoll,
    is_rotation_measured: false,
};

/// The curvature form of a sphere with this curvature.
pub const fn isotropic(curvature: f64) -> CurvatureForm {
    CurvatureForm {
        k_uu: curvature,
        k_uv: 0.0,
        k_vv: curvature,
    }
}

/// Noiseless readings of a probe of radius `radius` on an object with the curvature `form`. The shift of the contact is
/// proportional to the rotation. Each element of `rolls` is a direction (rad from u) and a rotation (rad).
pub fn readings(radius: f64, form: &CurvatureForm, rolls: &[(f64, f64)]) -> Vec<ProbeReading> {
    let relative = Matrix2::identity() / radius + form.matrix();
    let mobility = relative.try_inverse().unwrap();
    rolls
        .iter()
        .map(|&(direction, theta)| {
            let drive = Vector2::new(libm::cos(direction), libm::sin(direction)) * theta;
            ProbeReading {
                rotation: Vector2::new(drive.y, -drive.x),
                shift: mobility * drive,
            }
        })
        .collect()
}

/// The curvature form `form`, expressed in axes that are turned by `angle_rad`.
pub fn rotated(form: &CurvatureForm, angle_rad: f64) -> CurvatureForm {
    let turn = Rotation2::new(angle_rad);
    let matrix = turn.inverse() * form.matrix() * turn;
    CurvatureForm {
        k_uu: matrix[(0, 0)],
        k_uv: matrix[(0, 1)],
        k_vv: matrix[(1, 1)],
    }
}

/// Eight rolls by the angle `theta`: two in each of the directions ±u and ±v.
pub fn eight(theta: f64) -> Vec<(f64, f64)> {
    (0..8)
        .map(|index| (f64::from(index / 2) * std::f64::consts::FRAC_PI_2, theta))
        .collect()
}
