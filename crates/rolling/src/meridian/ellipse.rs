//! Arc lengths of ellipses, by Carlson's duplication.
//!
//! From the pole of `r = a sin t`, `height = c cos t` the arc is `a E(t, m)` with `m = 1 − (c/a)²`,
//!
//! ```text
//! E(t, m) = s R_F − (m/3) s³ R_D,     s = sin t,     R(cos² t, 1 − m s², 1),     |t| ≤ π/2
//! ```
//!
//! after Carlson, "Numerical computation of real or complex elliptic integrals", 1995.

use std::f64::consts::{FRAC_PI_2, PI};

/// Each duplication brings the arguments four times closer; the series leave out sixth powers.
const CLOSE: f64 = 1.5e-3;
/// Largest number of duplications; arguments a factor of 1e300 apart take some 260.
const MOST_DUPLICATIONS: usize = 300;

/// The arc from the pole of an ellipse with half-axes `a` across and `c` along its axis, both
/// positive, up to the parameter `t >= 0`.
pub(super) fn arc_length(a: f64, c: f64, t: f64) -> f64 {
    let half_turns = (t / PI).round();
    let rest = within_quarter(a, c, t - half_turns * PI);
    if half_turns == 0.0 {
        rest
    } else {
        rest + 2.0 * half_turns * within_quarter(a, c, FRAC_PI_2)
    }
}

fn within_quarter(a: f64, c: f64, t: f64) -> f64 {
    let (sin, cos) = libm::sincos(t);
    let ratio = c / a;
    let [x, y] = [cos * cos, cos * cos + ratio * sin * (ratio * sin)];
    let (first, second) = integrals(x, y);
    let m = (1.0 - ratio) * (1.0 + ratio);
    a * sin * (first - m / 3.0 * sin * sin * second)
}

/// Carlson's `R_F(x, y, 1)` and `R_D(x, y, 1)`, of which at most one argument is 0.
fn integrals(mut x: f64, mut y: f64) -> (f64, f64) {
    let mut z = 1.0;
    let (mut sum, mut share) = (0.0, 1.0);
    for _ in 0..MOST_DUPLICATIONS {
        let mean = (x + y + 3.0 * z) / 5.0;
        let apart = (x - mean).abs().max((y - mean).abs()).max((z - mean).abs());
        if apart <= CLOSE * mean {
            break;
        }
        let (root_x, root_y, root_z) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = root_x * (root_y + root_z) + root_y * root_z;
        sum += share / (root_z * (z + shift));
        share *= 0.25;
        x = 0.25 * (x + shift);
        y = 0.25 * (y + shift);
        z = 0.25 * (z + shift);
    }
    (
        first_kind(x, y, z),
        share * second_kind(x, y, z) + 3.0 * sum,
    )
}

/// `R_F` of arguments that are close to each other.
fn first_kind(x: f64, y: f64, z: f64) -> f64 {
    let mean = (x + y + z) / 3.0;
    let (dx, dy) = (1.0 - x / mean, 1.0 - y / mean);
    let dz = -dx - dy;
    let e2 = dx * dy - dz * dz;
    let e3 = dx * dy * dz;
    let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 / 44.0 * e2 * e3;
    series / mean.sqrt()
}

/// `R_D` of arguments that are close to each other.
fn second_kind(x: f64, y: f64, z: f64) -> f64 {
    let mean = (x + y + 3.0 * z) / 5.0;
    let (dx, dy) = (1.0 - x / mean, 1.0 - y / mean);
    let dz = -(dx + dy) / 3.0;
    let (xy, zz) = (dx * dy, dz * dz);
    let e2 = xy - 6.0 * zz;
    let e3 = (3.0 * xy - 8.0 * zz) * dz;
    let e4 = 3.0 * (xy - zz) * zz;
    let e5 = xy * zz * dz;
    let series = 1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2
        - 3.0 / 22.0 * e4
        - 9.0 / 52.0 * e2 * e3
        + 3.0 / 26.0 * e5;
    series / (mean * mean.sqrt())
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn integrals_of_the_literature() {
        // Carlson 1995, section 3: R_F(2, 3, 4) and R_D(2, 3, 4), R_D(0, 2, 1); R_F(1, 2, 0) is that of (0, 2, 1).
        let scaled = integrals(0.5, 0.75);
        assert_relative_eq!(
            scaled.0 / 2.0,
            0.584_082_841_677_151_7,
            max_relative = 2e-15
        );
        assert_relative_eq!(
            scaled.1 / 8.0,
            0.165_105_272_942_610_53,
            max_relative = 2e-15
        );
        let lemniscate = integrals(0.0, 2.0);
        assert_relative_eq!(lemniscate.0, 1.311_028_777_146_059_8, max_relative = 2e-15);
        assert_relative_eq!(lemniscate.1, 1.797_210_352_103_388_4, max_relative = 2e-15);
    }

    #[test]
    fn arcs_of_circles_and_quarters_of_ellipses() {
        for t in [1e-300, 1e-9, 0.3, 1.5, 1.6, 3.0, 4.0, 1e3] {
            assert_relative_eq!(arc_length(2.0, 2.0, t), 2.0 * t, max_relative = 2e-15);
        }
        // E(3/4) of a half as high ellipse, and the other way round; a quarter of the perimeter of both.
        let quarter = 2.0 * 1.211_056_027_568_459_5;
        assert_relative_eq!(
            arc_length(2.0, 1.0, FRAC_PI_2),
            quarter,
            max_relative = 2e-15
        );
        assert_relative_eq!(
            arc_length(1.0, 2.0, FRAC_PI_2),
            quarter,
            max_relative = 2e-15
        );
        assert_relative_eq!(
            arc_length(2.0, 1.0, 7.0 * PI),
            14.0 * quarter,
            max_relative = 2e-15
        );
    }

    #[test]
    fn a_quarter_of_a_flat_or_long_ellipse_is_its_longer_half_axis() {
        // A quarter tends to the longer half-axis, plus (b²/a)(ln(4a/b) − ½)/2.
        for (a, c) in [(1.0, 1e-9), (1e-9, 1.0), (1e9, 1e-9), (1e-150, 1.0)] {
            let arc = arc_length(a, c, FRAC_PI_2);
            assert_relative_eq!(arc, f64::max(a, c), max_relative = 2e-14);
        }
        let (short, rest) = (1e-3_f64, 0.5e-6 * (libm::log(4e3_f64) - 0.5));
        assert_relative_eq!(
            arc_length(1.0, short, FRAC_PI_2),
            1.0 + rest,
            max_relative = 1e-11
        );
        assert_relative_eq!(
            arc_length(short, 1.0, FRAC_PI_2),
            1.0 + rest,
            max_relative = 1e-11
        );
    }
}
