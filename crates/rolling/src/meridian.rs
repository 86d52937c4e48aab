//! Rolling from an apex in a symmetry plane of the object, for example along the meridians of a surface of revolution.
//!
//! The contact moves along a meridian of the object and along a great circle of the probe. If the object's normal has
//! turned by the angle α along the arc length s, the probe has turned by `θ = α + s/R₁`, where R₁ is the probe's
//! radius. This equation is solved for the parameter of the meridian.

use std::f64::consts::{FRAC_PI_2, PI};
use std::num::NonZeroUsize;
use std::sync::LazyLock;

use gauss_quad::GaussLegendre;
use nalgebra::{Vector2, Vector3};
use palpate_geometry::{Meridian, Shape, Surface};

use crate::closed_form::roll_on_probe;
use crate::{Contact, Motion, Shift};

/// Maximum number of iterations of Newton's or Halley's method, including bisections. Usually 3 iterations are enough.
const MAX_ITERATIONS: usize = 200;
/// Carlson's elliptic integrals are computed by a series if the relative difference of their arguments is at most this
/// number. A larger difference is first reduced by Carlson's duplication formula; each duplication makes it four times
/// smaller. The error of the series is proportional to the sixth power of the difference.
const MAX_DIFFERENCE: f64 = 1.5e-3;
/// Maximum number of duplications for one of Carlson's elliptic integrals. Arguments with a ratio of 1e300 need about
/// 260 duplications.
const MAX_DUPLICATIONS: usize = 300;

/// Maximum number of Newton iterations along the section of a height field. If they do not suffice, an integrator
/// computes the roll.
const MAX_SECTION_ITERATIONS: usize = 20;
/// Maximum number of successive halvings of an interval of integration along the section of a height field.
const MAX_HALVINGS: usize = 6;
/// A Newton step along the section of a height field is integrated by one Gauss–Legendre rule, without halving, if its
/// length is at most this fraction of the section's parameter at the start of the step.
const SMALL_STEP: f64 = 0.1;

/// Nodes and weights of a Gauss–Legendre rule on [−1, 1].
static RULE: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| {
    let nodes = NonZeroUsize::new(10).expect("a rule has nodes");
    let rule = GaussLegendre::new(nodes);
    rule.iter().map(|&(node, weight)| [node, weight]).collect()
});

#[derive(Clone, Debug)]
pub(crate) struct MeridianRung {
    /// The meridian of an object that is a surface of revolution whose axis passes through the apex. All its meridians
    /// are equal, so one is stored. `None` for other objects.
    revolved: Option<Meridian>,
    /// The sections of the object along the x and y axes of the contact frame; `None` for an axis along which the
    /// object is not symmetric.
    along: [Option<Meridian>; 2],
    radius: f64,
}

impl MeridianRung {
    /// Prepares rolls of a probe of radius `radius` that start at the contact `apex`. At this contact, the probe must
    /// not overlap the object.
    pub(crate) fn new(object: &Shape, apex: &Contact, radius: f64) -> Self {
        let (x, y) = (apex.x_axis, apex.y_axis());
        let section = |direction: Vector3<f64>| object.meridian(&apex.on_object, &direction);
        Self {
            revolved: section((x + y).normalize()),
            along: [section(x), section(y)],
            radius,
        }
    }

    /// Whether the object is a surface of revolution whose axis passes through the apex. Every roll from the apex then
    /// follows a meridian.
    pub(crate) const fn is_revolved(&self) -> bool {
        self.revolved.is_some()
    }

    /// The section of the object along which the contact moves in a motion from the apex; `None` if there is no section
    /// in the motion's direction. The motion must have no spin and no sliding.
    #[inline]
    pub(crate) fn section(&self, motion: &Motion) -> Option<&Meridian> {
        let aside = match motion.drive() {
            _ if self.revolved.is_some() => return self.revolved.as_ref(),
            drive if drive.y == 0.0 => 0,
            drive if drive.x == 0.0 => 1,
            _ => return None,
        };
        self.along[aside].as_ref()
    }

    /// Computes the contact after the probe has turned by `theta > 0` (rad) from the apex. Returns the section's
    /// parameter and the arc length from the apex. `None` if a result is not finite, or if the numerical method fails,
    /// for example at a kink or at the end of a height field's section.
    fn solve(&self, section: &Meridian, theta: f64) -> Option<(f64, f64)> {
        match *section {
            Meridian::Paraboloid { c } => along_parabola(c, self.radius, theta),
            Meridian::Spheroid { a, c } => along_ellipse(a, c, self.radius, theta),
            Meridian::HeightField { .. } => along_section(section, self.radius, theta),
        }
        .filter(|(t, arc)| t.is_finite() && arc.is_finite())
    }

    /// Displacement of the contact on the probe by `motion`, which starts at the apex and follows `section`. `None` for
    /// the same reason as in [`MeridianRung::advance`].
    pub(crate) fn shift(&self, section: &Meridian, motion: &Motion) -> Option<Shift> {
        let turn = motion.drive() * motion.duration_s;
        let theta = turn.norm();
        if theta == 0.0 {
            return Some(Shift::default());
        }
        let (_, arc) = self.solve(section, theta)?;
        Some(Shift::along_great_circle(turn * (arc / theta), self.radius))
    }

    /// The contact at the end of `motion`. It starts at the object's apex (`apex`) and moves along the meridian
    /// `section` of the object. `None` if the meridian model does not find the contact. The caller then uses an
    /// integrator, which finds the contact or returns the reason why the roll ends.
    pub(crate) fn advance(
        &self,
        section: &Meridian,
        apex: &Contact,
        motion: &Motion,
    ) -> Option<Contact> {
        let turn = motion.drive() * motion.duration_s;
        let theta = turn.norm();
        if theta == 0.0 {
            return Some(*apex);
        }
        let (t, arc) = self.solve(section, theta)?;
        let point = section.at(t);
        let direction: Vector2<f64> = turn / theta;
        let outward = apex.x_axis * direction.x + apex.y_axis() * direction.y;
        // The contact frame turns by the angle between the normal and the apex's normal, about the tangent
        // perpendicular to the meridian.
        let [sin, cos] = point.normal;
        let along = outward * (1.0 - cos) + apex.normal * sin;
        Some(Contact {
            on_object: apex.on_object + outward * point.r + apex.normal * point.height,
            normal: apex.normal * cos + outward * sin,
            x_axis: apex.x_axis - along * direction.x,
            body_from_contact: roll_on_probe(apex, direction * arc, self.radius),
            arc_length: apex.arc_length + arc,
        })
    }
}

/// Parameter and arc length at which a probe on any section has turned by `theta > 0`, by Newton's method and
/// quadrature. `None` if the method does not converge, for example because the section ends, has a kink, or is curved
/// inwards as strongly as the probe.
fn along_section(section: &Meridian, radius: f64, theta: f64) -> Option<(f64, f64)> {
    let rates = |t: f64| {
        let point = section.slope(t);
        let turn = point.slope_per_parameter + point.arc_per_parameter / radius;
        (turn > 0.0).then(|| Vector2::new(turn, point.arc_per_parameter))
    };
    let (mut t, mut passed, mut rate) = (0.0_f64, Vector2::zeros(), rates(0.0)?);
    for _ in 0..MAX_SECTION_ITERATIONS {
        let step: f64 = (theta - passed.x) / rate.x;
        passed += if step.abs() > SMALL_STEP * t {
            integral(&rates, t, t + step, MAX_HALVINGS)?
        } else {
            gauss(&rates, t, t + step)?
        };
        t += step;
        rate = rates(t)?;
        // Newton's method converges quadratically, as on an ellipse.
        if step.abs() <= 1e-8 * t {
            let last = (theta - passed.x) / rate.x;
            // At a kink, the slope changes by more than the integral of its derivative.
            let turned = section.slope(t).slope_rad + passed.y / radius;
            let is_smooth = (turned - passed.x).abs() <= 1e-12 * theta.max(1.0);
            return is_smooth.then_some((t + last, passed.y + last * rate.y));
        }
    }
    None
}

/// The integral of `rates` from `from` to `to`. The interval is halved until the halves agree with the whole.
fn integral(
    rates: &impl Fn(f64) -> Option<Vector2<f64>>,
    from: f64,
    to: f64,
    halvings: usize,
) -> Option<Vector2<f64>> {
    let middle = 0.5 * (from + to);
    let whole = gauss(rates, from, to)?;
    let halves = gauss(rates, from, middle)? + gauss(rates, middle, to)?;
    if (halves - whole).amax() <= 1e-13 * halves.amax() || halvings == 0 {
        return Some(halves);
    }
    let [first, second] =
        [(from, middle), (middle, to)].map(|(from, to)| integral(rates, from, to, halvings - 1));
    Some(first? + second?)
}

/// The integral of `rates` from `from` to `to` by one Gauss–Legendre rule.
fn gauss(rates: &impl Fn(f64) -> Option<Vector2<f64>>, from: f64, to: f64) -> Option<Vector2<f64>> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let sum = RULE
        .iter()
        .try_fold(Vector2::zeros(), |sum, [node, weight]| {
            Some(sum + rates(middle + half * node)? * *weight)
        })?;
    Some(sum * half)
}

/// Parameter and arc length at which a probe on an ellipse has turned by `theta > 0`. Newton's method finds them,
/// because the angle increases with the parameter if the relative curvature is positive. `None` if the method does not
/// converge.
fn along_ellipse(a: f64, c: f64, radius: f64, theta: f64) -> Option<(f64, f64)> {
    let ellipse = Meridian::Spheroid { a, c };
    let apex = ellipse.slope(0.0);
    let rate = apex.slope_per_parameter + apex.arc_per_parameter / radius;
    let mut root = Bracket::new(theta / rate);
    for _ in 0..MAX_ITERATIONS {
        let t = root.at;
        let arc = arc_length(a, c, t);
        let point = ellipse.slope(t);
        let excess = point.slope_rad + arc / radius - theta;
        let slope = point.slope_per_parameter + point.arc_per_parameter / radius;
        root.step(excess, excess / slope);
        // Newton's method converges quadratically. After a relative correction below 1e-8, the next correction would be
        // below the rounding errors.
        if (root.at - t).abs() <= 1e-8 * t {
            return Some((root.at, arc + (root.at - t) * point.arc_per_parameter));
        }
    }
    None
}

/// Parameter `r` and arc length at which a probe on `z = −c r²` has turned by `theta`, which must be positive.
///
/// Let q = 2|c|r be the slope, σ the sign of c and a = 1/(2|c|R₁). The equation
///
/// ```text
/// θ = σ atan q + a S(q),     S(q) = (q √(1+q²) + asinh q)/2 = 2|c| s
/// ```
///
/// is solved by Halley's method. The start value of q is computed from the first three terms of the equation's power
/// series or, if they converge badly, from its asymptote.
fn along_parabola(c: f64, radius: f64, theta: f64) -> Option<(f64, f64)> {
    let (sign, steepening) = (c.signum(), 2.0 * c.abs());
    let a = 1.0 / (steepening * radius);
    if !(a * a).is_finite() {
        let arc = theta * radius;
        return Some((arc, arc));
    }
    let mut root = Bracket::new(first_slope(sign, a, theta));
    for _ in 0..MAX_ITERATIONS {
        let q = root.at;
        let ww = 1.0 + q * q;
        let w = ww.sqrt();
        // asinh q for the slope q, computed from w = √(1 + q²) without loss of digits for small q.
        let asinh = libm::log1p(q + q * q / (1.0 + w));
        let arc = 0.5 * (q * w + asinh);
        let excess = sign * libm::atan(q) + a * arc - theta;
        let slope = sign / ww + a * w;
        let bend = q * (a / w - 2.0 * sign / (ww * ww));
        let newton = excess / slope;
        root.step(excess, newton / (1.0 - 0.5 * newton * bend / slope));
        // Halley's method converges cubically. After a step below 3e-6 of q, the next correction would be below the
        // rounding errors.
        let step = root.at - q;
        if step.abs() <= 3e-6 * q {
            let arc = arc + step * (w + 0.5 * step * q / w);
            return Some((root.at / steepening, arc / steepening));
        }
    }
    None
}

/// First estimate of the slope of the parabola at which the probe has turned by `theta`. Halley's method starts from
/// this estimate.
fn first_slope(sign: f64, a: f64, theta: f64) -> f64 {
    // With σ = `sign` and the slope q, the equation of `along_parabola` is θ = (a + σ) q + (a/6 − σ/3) q³ + (σ/5 −
    // a/40) q⁵ + …. The first terms of the inverse of this series give q.
    let rate = a + sign;
    let linear = theta / rate;
    let square = linear * linear;
    let cubic = square * (a / 6.0 - sign / 3.0) / rate;
    if cubic.abs() < 0.1 {
        let quintic = square * square * (sign / 5.0 - a / 40.0) / rate;
        return linear * (1.0 - cubic + 3.0 * cubic * cubic - quintic);
    }
    // For large slopes q, the arc-length function S(q) approaches q²/2, and atan q is about 1.2 rad or more. Therefore
    // θ is about 1.2 σ + a q²/2, where σ is `sign`.
    let y = ((theta - 1.2 * sign) / a).max(linear.min(1.0));
    y / libm::hypot(0.5 * y, 1.0).sqrt()
}

/// A bracket of the root of an increasing function, and the current estimate of the root.
struct Bracket {
    low: f64,
    high: f64,
    at: f64,
}

impl Bracket {
    fn new(at: f64) -> Self {
        Self {
            low: 0.0,
            high: f64::INFINITY,
            at,
        }
    }

    /// Narrows the bracket of the root, using the sign of the function's value `excess`. Then moves the estimate of the
    /// root by `−step`, but not out of the bracket.
    fn step(&mut self, excess: f64, step: f64) {
        if excess > 0.0 {
            self.high = self.at;
        } else {
            self.low = self.at;
        }
        let next = self.at - step;
        self.at = if excess == 0.0 || (next > self.low && next < self.high) {
            next
        } else if self.high.is_finite() {
            0.5 * (self.low + self.high)
        } else {
            2.0 * self.at
        };
    }
}

/// The arc length of an ellipse from its pole to the parameter `t >= 0`. The half-axes are `a` perpendicular to the
/// axis of revolution and `c` along it; both are positive.
///
/// From the pole of `r = a sin t`, `height = c cos t`, the arc length is `a E(t, m)` with `m = 1 − (c/a)²`, computed as
///
/// ```text
/// E(t, m) = s R_F − (m/3) s³ R_D,     s = sin t,     R(cos² t, 1 − m s², 1),     |t| ≤ π/2
/// ```
///
/// by Carlson's duplication ("Numerical computation of real or complex elliptic integrals", 1995).
fn arc_length(a: f64, c: f64, t: f64) -> f64 {
    let half_turns = (t / PI).round();
    let rest = quarter_arc(a, c, t - half_turns * PI);
    if half_turns == 0.0 {
        rest
    } else {
        rest + 2.0 * half_turns * quarter_arc(a, c, FRAC_PI_2)
    }
}

fn quarter_arc(a: f64, c: f64, t: f64) -> f64 {
    let (sin, cos) = libm::sincos(t);
    let ratio = c / a;
    let [x, y] = [cos * cos, cos * cos + ratio * sin * (ratio * sin)];
    let (first, second) = integrals(x, y);
    let m = (1.0 - ratio) * (1.0 + ratio);
    a * sin * (first - m / 3.0 * sin * sin * second)
}

/// Carlson's integrals `R_F(x, y, 1)` and `R_D(x, y, 1)`. At most one of the arguments may be 0.
fn integrals(mut x: f64, mut y: f64) -> (f64, f64) {
    let mut z = 1.0;
    let (mut sum, mut share) = (0.0, 1.0);
    for _ in 0..MAX_DUPLICATIONS {
        let mean = (x + y + 3.0 * z) / 5.0;
        let difference = (x - mean).abs().max((y - mean).abs()).max((z - mean).abs());
        if difference <= MAX_DIFFERENCE * mean {
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

/// Carlson's integral `R_F` for nearly equal arguments, computed from its power series.
fn first_kind(x: f64, y: f64, z: f64) -> f64 {
    let mean = (x + y + z) / 3.0;
    let (dx, dy) = (1.0 - x / mean, 1.0 - y / mean);
    let dz = -dx - dy;
    let e2 = dx * dy - dz * dz;
    let e3 = dx * dy * dz;
    let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 / 44.0 * e2 * e3;
    series / mean.sqrt()
}

/// Carlson's integral `R_D` for nearly equal arguments, computed from its power series.
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

    /// The larger of two relative errors of `along_parabola`, for a probe of radius 1: of the arc length s, and of the
    /// roll angle α + s, where α is the slope angle. The error of the roll angle is relative to |α| + s.
    fn error(c: f64, theta: f64) -> f64 {
        let (r, arc) = along_parabola(c, 1.0, theta).unwrap();
        let slope = 2.0 * c * r;
        let alpha = libm::atan(slope);
        let closed = 0.5 * r * (libm::hypot(slope, 1.0) + libm::asinh(slope) / slope);
        let off = (alpha + arc - theta).abs() / (alpha.abs() + arc);
        off.max((arc / closed - 1.0).abs())
    }

    #[test]
    fn parabolas_from_flat_to_sharp_at_any_distance() {
        for exponent in -12..=12 {
            for mantissa in [1.0, 2.3, 4.999] {
                let c = mantissa * 10.0_f64.powi(exponent);
                // A probe with the radius R₁ = 1 fits into a bowl (negative c) only if 1/R₁ + 2c > 0.
                for c in [c, -c].into_iter().filter(|c| 1.0 + 2.0 * c > 0.0) {
                    for theta in [
                        1e-12, 1e-6, 0.1, 0.5, 1.0, 1.5, 1.6, 2.0, 3.0, 6.0, 100.0, 1e9,
                    ] {
                        let off = error(c, theta);
                        assert!(off < 1e-14, "c = {c:e}, θ = {theta:e}: {off:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_parabola_without_curvature_is_a_plane() {
        for c in [0.0, -0.0, 1e-300, -1e-300] {
            assert_eq!(along_parabola(c, 2.0, 0.7), Some((1.4, 1.4)));
        }
    }

    #[test]
    fn a_bowl_that_hardly_fits() {
        // For the paraboloid z = −c r² and the probe's radius R₁: as 1/R₁ + 2c tends to 0, the roll angle θ tends to
        // q³/2, where q is the slope. So q is proportional to the cube root of θ, and a small rotation moves the
        // contact far.
        let (r, _) = along_parabola(-0.5, 1.0, 1e-9).unwrap();
        assert!((r / libm::cbrt(2e-9_f64) - 1.0).abs() < 1e-5, "{r}");
    }

    #[test]
    fn integrals_of_the_literature() {
        // The expected values are from Carlson 1995, section 3: R_F(2, 3, 4), R_D(2, 3, 4), R_D(0, 2, 1), and R_F(1, 2,
        // 0) = R_F(0, 2, 1).
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
        // A quarter of the perimeter of an ellipse with the half-axes 2 and 1 is 2 E(3/4), with the complete elliptic
        // integral E. The perimeter does not depend on the order of the half-axes.
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
        // If the half-axes a > b are very different, the length of a quarter of the ellipse is approximately a +
        // (b²/a)(ln(4a/b) − ½)/2.
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
