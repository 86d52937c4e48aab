//! Converts between points of a fingertip, given as directions from its centre, and great-circle displacements.

use nalgebra::{UnitQuaternion, Vector2, Vector3};

/// The direction that is reached from +z along a great circle by `displacement` (exponential map). The displacement is
/// in radians, in the tangent basis (x, y) at +z. The result is finite for displacements up to 1e150. The error of each
/// component is at most 1e-15 plus the effect of rounding the angle.
pub fn direction_at(displacement: &Vector2<f64>) -> Vector3<f64> {
    let angle = displacement.norm();
    if angle == 0.0 {
        return Vector3::z();
    }
    let (sin, cos) = libm::sincos(angle);
    let across = displacement * (sin / angle);
    Vector3::new(across.x, across.y, cos)
}

/// The great-circle displacement (logarithm map, radians) from direction `from` to direction `to`, both unit vectors.
/// The tangent basis at `from` is the basis (x, y) at +z, rotated by the shortest rotation from +z to `from`.
///
/// If `from` is +z, the error is at most 1e-15 of the displacement, otherwise 1e-15 radians. Opposite directions are
/// connected by many great circles of the same length. In this case, the result is along x.
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
/// use nalgebra::{Vector2, Vector3};
/// use palpate_sensing::{direction_at, displacement_between};
///
/// // A quarter turn from +z along x leads to +x, and back.
/// let quarter = Vector2::new(FRAC_PI_2, 0.0);
/// assert!((direction_at(&quarter) - Vector3::x()).norm() < 1e-15);
/// assert!((displacement_between(&Vector3::z(), &Vector3::x()) - quarter).norm() < 1e-15);
/// ```
pub fn displacement_between(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector2<f64> {
    let level = UnitQuaternion::rotation_between(from, &Vector3::z()).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    });
    let local = level * to;
    let across = local.xy();
    let sine = across.norm();
    if sine == 0.0 {
        return if local.z >= 0.0 {
            Vector2::zeros()
        } else {
            Vector2::x() * std::f64::consts::PI
        };
    }
    across * (libm::atan2(sine, local.z) / sine)
}

/// The direction that is reached from the unit vector `direction` along a great circle by `displacement` (rad). The
/// directions of the tangent basis at `direction` are arbitrary, so use this function only for displacements in random
/// directions.
pub(crate) fn moved_along(direction: &Vector3<f64>, displacement: &Vector2<f64>) -> Vector3<f64> {
    let x = direction.cross(&Vector3::y()).try_normalize(1e-6);
    let x = x.unwrap_or_else(|| direction.cross(&Vector3::x()).normalize());
    let y = direction.cross(&x);
    let local = direction_at(displacement);
    x * local.x + y * local.y + direction * local.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn length_is_the_angle(a in -1.0..1.0_f64, b in -1.0..1.0_f64, c in -3.0..3.0_f64) {
            let from = direction_at(&Vector2::new(a, b));
            let to = direction_at(&Vector2::new(b, c));
            let angle = libm::atan2(from.cross(&to).norm(), from.dot(&to));
            assert_relative_eq!(displacement_between(&from, &to).norm(), angle, epsilon = 1e-14);
        }
    }

    #[test]
    fn opposite_directions_are_half_a_turn_apart() {
        let opposite = displacement_between(&Vector3::z(), &-Vector3::z());
        assert_eq!(opposite, Vector2::new(std::f64::consts::PI, 0.0));
        let from_below = displacement_between(&-Vector3::z(), &Vector3::z());
        assert_relative_eq!(from_below.norm(), std::f64::consts::PI, epsilon = 1e-15);
    }
}
