//! Tests the reference contacts of round fingertips.

use palpate_assay::contact_reference::{
    tip_on_ball, tip_on_ellipsoid, tip_on_quadric, tip_on_waves,
};

const PLACES: [[f64; 2]; 5] = [[0.0, 0.0], [0.4, 0.0], [0.0, -0.7], [-0.5, 0.6], [1.1, 0.9]];

/// Checks that the contact is on the object. Also checks that the tip's centre lies on the surface normal through the
/// contact, at a distance that equals the tip's radius.
#[track_caller]
fn check_contact(
    tip: f64,
    contact: impl Fn([f64; 2]) -> [f64; 3],
    level: impl Fn([f64; 3]) -> f64,
    gradient: impl Fn([f64; 3]) -> [f64; 3],
) {
    for [x, y] in PLACES {
        let [px, py, pz] = contact([x, y]);
        let normal = gradient([px, py, pz]);
        let size = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
        let off = libm::hypot(
            px + tip * normal[0] / size - x,
            py + tip * normal[1] / size - y,
        );
        assert!(off < 1e-14, "{x} {y}: {off:e}");
        let height = level([px, py, pz]);
        assert!(height.abs() < 1e-14, "{x} {y}: {height:e}");
        assert!(pz + tip * normal[2] / size > pz, "{x} {y}: from below");
    }
}

#[test]
fn the_centre_of_a_tip_is_its_radius_along_the_normal() {
    check_contact(
        0.5,
        |centre| tip_on_ball(2.0, 0.5, centre),
        |[x, y, z]| (x * x + y * y + z * z) / 4.0 - 1.0,
        |point| point,
    );
    for [k, l] in [[-0.3, -0.3], [0.4, -0.4], [0.45, 0.2]] {
        check_contact(
            0.8,
            |centre| tip_on_quadric([k, l], 0.8, centre),
            |[x, y, z]| z - k * x * x - l * y * y,
            |[x, y, _]| [-2.0 * k * x, -2.0 * l * y, 1.0],
        );
    }
    for [a, b, c] in [[2.0, 1.5, 1.0], [1.5, 1.5, 3.0]] {
        check_contact(
            1.0,
            |centre| tip_on_ellipsoid([a, b, c], 1.0, centre),
            |[x, y, z]| (x / a).powi(2) + (y / b).powi(2) + (z / c).powi(2) - 1.0,
            |[x, y, z]| [x / (a * a), y / (b * b), z / (c * c)],
        );
    }
    check_contact(
        0.5,
        |centre| tip_on_waves([0.1, 0.7], 0.5, centre),
        |[x, y, z]| z - 0.1 * libm::sin(x / 0.7) * libm::cos(y / 0.7),
        |[x, y, _]| {
            let [(sin_x, cos_x), (sin_y, cos_y)] = [x, y].map(|part| libm::sincos(part / 0.7));
            [-cos_x * cos_y / 7.0, sin_x * sin_y / 7.0, 1.0]
        },
    );
}
