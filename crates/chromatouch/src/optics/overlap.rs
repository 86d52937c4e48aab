//! Overlap of two discs as viewed from the camera.
//!
//! A disc is a cap on the sphere of directions. A stereographic projection maps a cap to a circle in a plane. An area
//! on the sphere is, to second order, the area in the plane times 1 − p²/2. Here p is the distance from the centre of
//! the projection. The overlap of two circles consists of one segment of each circle. The moments of a segment are
//! computed by exact formulas.

use nalgebra::Vector3;

use super::array::Sight;
use super::lens::{Local, Region};

pub(super) enum Overlap {
    None,
    AllOfMagenta,
    AllOfYellow,
    Part(Part),
}

/// Overlap of two discs whose edges cross. The discs lie on the unit sphere of viewing directions. The moments of the
/// overlap are computed about the viewing direction `direction`, which is inside the overlap.
pub(super) struct Part {
    pub(super) direction: Vector3<f64>,
    /// Unit vector from the middle of the magenta disc towards the middle of the yellow disc, perpendicular to
    /// `direction`.
    pub(super) axis: Vector3<f64>,
    moments: Moments,
    /// Half-angles of the two segments that form the overlap. The first is a segment of the magenta disc, the second of
    /// the yellow disc.
    pub(super) angles: [HalfAngle; 2],
}

/// Area and moments of a region that is symmetric about an axis. The moments are about a point on this axis.
#[derive(Clone, Copy)]
struct Moments {
    area: f64,
    first: f64,
    second_along: f64,
    second_across: f64,
}

/// Half of the central angle of a circle's segment. `sine` and `cosine` are the sine and cosine of the half-angle, both
/// multiplied by the same positive factor.
#[derive(Clone, Copy)]
pub(super) struct HalfAngle {
    angle: f64,
    sine: f64,
    cosine: f64,
}

impl HalfAngle {
    fn new(sine: f64, cosine: f64) -> Self {
        Self {
            angle: libm::atan2(sine, cosine),
            sine,
            cosine,
        }
    }

    /// Half-angle with the sine `sine` and the cosine `cosine`. If the result is close to `self`, it is computed from
    /// `self` by a short series, which is faster than an arctangent.
    fn beside(&self, sine: f64, cosine: f64) -> Self {
        let [across, along] = [
            sine * self.cosine - cosine * self.sine,
            cosine * self.cosine + sine * self.sine,
        ];
        if across.abs() < 1e-3 * along {
            let tangent = across / along;
            // `tangent` is the tangent of the small angle between `self` and the new half-angle. The power series of
            // the arctangent computes this angle with a relative error of 1e-13.
            let step = tangent * (1.0 - tangent * tangent * (1.0 / 3.0 - 0.2 * tangent * tangent));
            return Self {
                angle: self.angle + step,
                sine,
                cosine,
            };
        }
        Self::new(sine, cosine)
    }
}

/// Overlap of the two discs of a marker. `near` contains the half-angles of a similar overlap; they make the
/// computation of the new half-angles faster.
#[inline]
pub(super) fn overlap(magenta: &Sight, yellow: &Sight, near: Option<&[HalfAngle; 2]>) -> Overlap {
    let step = yellow.direction - magenta.direction;
    let square = step.norm_squared();
    let chord = square.sqrt();
    let products = [
        magenta.sine * yellow.cosine,
        magenta.cosine * yellow.sine,
        magenta.cosine * yellow.cosine,
        magenta.sine * yellow.sine,
    ];
    let difference = chord_of(products[0] - products[1], products[2] + products[3]);
    if chord <= difference.abs() {
        return if difference < 0.0 {
            Overlap::AllOfMagenta
        } else {
            Overlap::AllOfYellow
        };
    }
    if chord >= chord_of(products[0] + products[1], products[2] - products[3]) {
        return Overlap::None;
    }
    Overlap::Part(part(magenta, yellow, &step, square, near))
}

/// Chord 2 sin(α/2) of an angle α between −180° and 180°, computed from sin α and cos α.
#[inline]
fn chord_of(sine: f64, cosine: f64) -> f64 {
    sine * (2.0 / (1.0 + cosine)).sqrt()
}

#[inline]
fn part(
    magenta: &Sight,
    yellow: &Sight,
    step: &Vector3<f64>,
    square: f64,
    near: Option<&[HalfAngle; 2]>,
) -> Part {
    let chord = square.sqrt();
    // The moments are computed about a direction approximately half-way between the two edges of the overlap. The
    // direction need not be exact.
    let wider = chord_of(magenta.sine, magenta.cosine) - chord_of(yellow.sine, yellow.cosine);
    let share = (0.5 + 0.5 * wider / chord).clamp(0.0, 1.0);
    let rest = 1.0 - share;
    let between = magenta.direction + step * share;
    let scale = 1.0 / (1.0 - share * rest * square).sqrt();
    let direction = between * scale;
    let along = step - direction * direction.dot(step);
    // `direction` divides the line between the middles of the discs in the ratio of `share` to `rest`. `sine` is the
    // sine of the angle between the middles.
    let sine = chord * (1.0 - 0.25 * square).max(0.0).sqrt();
    let circle = |disc: &Sight, side: f64, away: f64| {
        let cosine = (1.0 - 0.5 * away * square) * scale;
        let scale_there = 2.0 / (cosine + disc.cosine);
        let centre = side * away * sine * scale * scale_there;
        (centre, disc.sine * scale_there)
    };
    let (moments, angles) = lens(
        circle(magenta, -1.0, share),
        circle(yellow, 1.0, rest),
        near,
    );
    Part {
        direction,
        axis: along / along.norm(),
        moments,
        angles,
    }
}

/// Moments of the overlap of two circles whose edges cross, and the half-angles of its two segments. Each circle is
/// given by two numbers: the position of its centre on the axis, and its radius. The centre of the second circle has
/// the larger position.
#[inline]
fn lens(
    (first, first_radius): (f64, f64),
    (second, second_radius): (f64, f64),
    near: Option<&[HalfAngle; 2]>,
) -> (Moments, [HalfAngle; 2]) {
    let distance = second - first;
    let power = (first_radius - second_radius) / distance * (first_radius + second_radius);
    let [to_first, to_second] = [0.5 * (distance + power), 0.5 * (distance - power)];
    let half_square = (first_radius - to_first) * (first_radius + to_first);
    let half = half_square.max(0.0).sqrt();
    let angles = match near {
        Some([one, other]) => [one.beside(half, to_first), other.beside(half, to_second)],
        None => [to_first, to_second].map(|to_chord| HalfAngle::new(half, to_chord)),
    };
    let one = segment(first_radius, &angles[0]).about(first);
    let other = segment(second_radius, &angles[1]).mirrored().about(second);
    let moments = Moments {
        area: one.area + other.area,
        first: one.first + other.first,
        second_along: one.second_along + other.second_along,
        second_across: one.second_across + other.second_across,
    };
    (moments, angles)
}

/// Moments of a segment of a circle about the circle's centre. In `half_angle`, the sine and the cosine are multiplied
/// by the radius. Therefore `sine` is half the length of the chord, and `cosine` is the distance between the chord and
/// the centre. The segment lies at positive coordinates of the axis.
#[inline]
fn segment(radius: f64, half_angle: &HalfAngle) -> Moments {
    let (half, to_chord) = (half_angle.sine, half_angle.cosine);
    let square = radius * radius;
    // `triangle` is the product r² sin β cos β, and `half_square` is r² sin² β. Here r is the radius of the disc, and β
    // is half of the angle that the segment covers.
    let (triangle, half_square) = (half * to_chord, half * half);
    let area = square * half_angle.angle - triangle;
    let fourth = half_square * triangle;
    Moments {
        area,
        first: 2.0 / 3.0 * half * half_square,
        second_along: 0.25 * square * area + 0.5 * fourth,
        second_across: 0.25 * square * area - fourth / 6.0,
    }
}

impl Moments {
    fn mirrored(self) -> Self {
        Self {
            first: -self.first,
            ..self
        }
    }

    /// Converts moments about the point at the position `point` on the axis of symmetry to moments about the origin.
    fn about(self, point: f64) -> Self {
        Self {
            area: self.area,
            first: self.first + point * self.area,
            second_along: self.second_along + point * (2.0 * self.first + point * self.area),
            second_across: self.second_across,
        }
    }
}

impl Part {
    /// Image of the area with these moments. `local` is the expansion of the lens at the direction about which the
    /// moments are computed. The axis of symmetry of the area has the components `outward` (away from the lens's axis)
    /// and `around` (in the azimuthal direction).
    #[inline]
    pub(super) fn seen(&self, local: &Local, [outward, around]: [f64; 2]) -> Region {
        let moments = self.moments;
        let first = [outward, around].map(|part| moments.first * part);
        let (second_along, second_across) = (moments.second_along, moments.second_across);
        let [outer, middle, inner] = [
            second_along * outward * outward + second_across * around * around,
            (second_along - second_across) * outward * around,
            second_along * around * around + second_across * outward * outward,
        ];
        let solid = moments.area - 0.5 * (second_along + second_across);
        let curved = local.area_curve * outer + local.area_bend * inner;
        let moved = 2.0 * local.area_slope * local.radial + local.area * local.radial_slope;
        let turned = local.area_slope * local.lateral + local.area * local.lateral_slope;
        Region {
            area: local.area * solid + local.area_slope * first[0] + 0.5 * curved,
            moment: [
                local.area * local.radial * first[0]
                    + 0.5 * (moved * outer + local.area * local.bend * inner),
                local.area * local.lateral * first[1] + turned * middle,
            ],
        }
    }
}
