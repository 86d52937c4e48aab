//! The camera model: converts pixels to directions.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use crate::{CalibrationError, Change, Marker, Track};

/// An equidistant fisheye camera in the centre of a spherical sensor. Its axis passes through the apex. A direction at
/// the angle θ from the axis has its image at the distance r = f θ from the image's centre, where f is the focal
/// length. If the lens has odd terms, r = f (θ + k3 θ³ + k5 θ⁵).
///
/// A place is a direction from the sensor's centre. Its two coordinates (x, y) are the logarithm map from the apex, in
/// radians: √(x² + y²) is the angle from the apex, and (x, y) points from the apex to the place. Image columns increase
/// along x, and image rows increase along −y. The components of a displacement are along the axes at the apex,
/// parallel-transported along the meridian to the place.
///
/// ```
/// use palpate_tracking::Equidistant;
///
/// let camera = Equidistant::new([319.5, 319.5], 230.0, [0.0; 2])?;
/// // 23 columns to the right and 46 rows up, at 230 px per radian; rows count downward, y upward.
/// let place = camera.place([342.5, 273.5]);
/// assert!((place[0] - 0.1).abs() < 1e-12 && (place[1] - 0.2).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equidistant {
    centre_px: [f64; 2],
    px_per_rad: f64,
    terms: Option<OddTerms>,
}

impl Equidistant {
    /// Creates a camera that shows the apex at `centre_px`. Its lens has the focal length f = `px_per_rad` and the odd
    /// terms `k3` and `k5`: r = f (θ + k3 θ³ + k5 θ⁵). Here r is the distance from the image's centre, and θ the angle
    /// from the axis. Image points beyond the angle at which r stops increasing show no valid place on the skin.
    ///
    /// # Errors
    /// [`CalibrationError::OutOfRange`] unless both coordinates of the centre are from -1e12 to 1e12 px, `px_per_rad`
    /// is from 1e-6 to 1e12, and the odd terms are from -100 to 100.
    pub fn new(
        centre_px: [f64; 2],
        px_per_rad: f64,
        [k3, k5]: [f64; 2],
    ) -> Result<Self, CalibrationError> {
        let centre = centre_px.map(|one| {
            (
                "a coordinate of the image's centre",
                one,
                one.abs() <= 1e12,
                "between -1e12 and 1e12",
            )
        });
        let scale = (
            "the camera's px per rad",
            px_per_rad,
            (1e-6..=1e12).contains(&px_per_rad),
            "between 1e-6 and 1e12",
        );
        let terms = [("the lens's k3", k3), ("the lens's k5", k5)]
            .map(|(what, value)| (what, value, value.abs() <= 100.0, "between -100 and 100"));
        for (what, value, is_good, needed) in centre.into_iter().chain([scale]).chain(terms) {
            if !is_good {
                return Err(CalibrationError::out_of_range(what, value, needed));
            }
        }
        let terms = Some([k3, k5]).filter(|terms| *terms != [0.0; 2]);
        Ok(Self {
            centre_px,
            px_per_rad,
            terms: terms.map(|[k3, k5]| OddTerms::new(k3, k5)),
        })
    }

    /// Place on the skin that the camera shows at an image point: two coordinates in rad, which are 0 at the apex. If
    /// the lens model assigns no place to the point, the result is the apex.
    pub fn place(&self, point_px: [f64; 2]) -> [f64; 2] {
        self.finite_place(point_px).unwrap_or_default()
    }

    fn finite_place(&self, point_px: [f64; 2]) -> Option<[f64; 2]> {
        let place = [
            (point_px[0] - self.centre_px[0]) / self.px_per_rad,
            (self.centre_px[1] - point_px[1]) / self.px_per_rad,
        ];
        let scaled = libm::hypot(place[0], place[1]);
        match self.terms {
            Some(terms) if scaled > 0.0 => {
                let angle = terms.angle(scaled)?;
                Some(place.map(|part| part * (angle / scaled)))
            }
            _ => scaled.is_finite().then_some(place),
        }
    }

    /// Great-circle displacement (rad) between the places that the camera shows at two image points, along the axes at
    /// the first place. The displacement is 0 if the lens model assigns no place to one of the points.
    ///
    /// In the radial direction of the image, this displacement is the distance in pixels divided by the focal length.
    /// In the perpendicular direction, it is smaller by the factor θ/sin θ, by which the lens stretches the image at
    /// the angle θ from its axis.
    fn shift(&self, rest_px: [f64; 2], pressed_px: [f64; 2]) -> [f64; 2] {
        match (self.finite_place(rest_px), self.finite_place(pressed_px)) {
            (Some(rest), Some(pressed)) => great_circle(rest, pressed),
            _ => [0.0; 2],
        }
    }

    /// Change of a tracked marker, corrected for the distortion of the lens. The shift (px) is the angle by which the
    /// marker moved, multiplied by the focal length (px per radian). The growth is half the change of ln Ω, where Ω is
    /// the solid angle of the marker as seen from the camera. `None` unless the marker was tracked, the lens model
    /// assigns places to both of its images, and all numbers are finite.
    pub fn change(&self, track: &Track) -> Option<Change> {
        let (rest, pressed) = (track.rest?, track.pressed?);
        let change = track.change()?;
        let is_place = |marker: &Marker| self.finite_place(marker.centroid_px).is_some();
        if self.terms.is_some() && !(is_place(&rest) && is_place(&pressed)) {
            return None;
        }
        let shift = self.shift(rest.centroid_px, pressed.centroid_px);
        let stretched = |marker: &Marker| {
            let [x, y] = self.place(marker.centroid_px);
            libm::log(self.stretching(libm::hypot(x, y)))
        };
        let change = Change {
            shift_px: shift.map(|angle| self.px_per_rad * angle),
            growth: change.growth - 0.5 * (stretched(&pressed) - stretched(&rest)),
            ..change
        };
        Some(change).filter(Change::is_finite)
    }

    /// Factor by which the lens enlarges the image at the angle `angle` (rad) from the camera's axis: the image area of
    /// a small solid angle, divided by the image area of the same solid angle on the axis.
    fn stretching(&self, angle: f64) -> f64 {
        let [even, slope] = self.terms.map_or([1.0; 2], |terms| terms.stretches(angle));
        stretching(angle) * (even * slope)
    }
}

/// Factor θ/sin θ by which an equidistant lens enlarges the image at the angle θ (`angle`, rad) from its axis: the
/// image area of a small solid angle, divided by the image area of the same solid angle on the axis. Beyond a right
/// angle, the factor stays constant.
fn stretching(angle: f64) -> f64 {
    let angle = angle.min(FRAC_PI_2);
    if angle < 1e-8 {
        1.0
    } else {
        angle / libm::sin(angle)
    }
}

/// Direction (unit vector) of a place on the skin, and the axes at this place: the x and y axes of the skin at the
/// apex, parallel-transported along the meridian to the place.
fn frame([x, y]: [f64; 2]) -> [Vector3<f64>; 3] {
    let angle = libm::hypot(x, y);
    let [along_x, along_y] = if angle > 0.0 {
        [x / angle, y / angle]
    } else {
        [1.0, 0.0]
    };
    let (sine, cosine) = libm::sincos(angle);
    let meridian = Vector3::new(along_x * cosine, along_y * cosine, -sine);
    let across = Vector3::new(-along_y, along_x, 0.0);
    [
        Vector3::new(along_x * sine, along_y * sine, cosine),
        meridian * along_x - across * along_y,
        meridian * along_y + across * along_x,
    ]
}

/// Great-circle displacement (rad) from the place `from` to the place `to` (logarithm map), along the axes at `from`.
pub(crate) fn great_circle(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let [start, x_axis, y_axis] = frame(from);
    let [end, ..] = frame(to);
    // Compute the angle from the chord between the two places, because this computation is accurate even for short
    // chords.
    let chord = end - start;
    let [x, y] = [chord.dot(&x_axis), chord.dot(&y_axis)];
    let across = libm::hypot(x, y);
    let angle = libm::atan2(across, start.dot(&end));
    if across > 0.0 {
        [angle * (x / across), angle * (y / across)]
    } else {
        [angle, 0.0]
    }
}

/// Smallest allowed slope dr/dθ of a lens, relative to its slope on the axis. Here r is the distance from the image's
/// centre, and θ the angle from the axis. With a smaller slope, θ cannot be computed accurately from r.
const MIN_SLOPE: f64 = 0.01;
/// Maximum number of Newton steps of [`OddTerms::angle`]. A step that would leave the interval of the solution is
/// replaced by a bisection.
const MAX_STEPS: usize = 64;

/// The odd terms of a fisheye lens, r = f (θ + k3 θ³ + k5 θ⁵), where k3 and k5 may have any finite size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OddTerms {
    k3: f64,
    k5: f64,
    /// Largest valid angle from the axis (rad, at most half a turn). Up to this angle, the relative slope of the lens
    /// is at least [`MIN_SLOPE`].
    max_angle: f64,
}

impl OddTerms {
    fn new(k3: f64, k5: f64) -> Self {
        let terms = Self {
            k3,
            k5,
            max_angle: PI,
        };
        Self {
            max_angle: terms.first_root(),
            ..terms
        }
    }

    /// Largest angle θ up to which the slope d(r/f)/dθ of the lens is at least [`MIN_SLOPE`]. With u = θ², the angle is
    /// computed from the smallest positive root of 5 k5 u² + 3 k3 u + 1 − `MIN_SLOPE`.
    fn first_root(self) -> f64 {
        let (square, linear, constant) = (5.0 * self.k5, 3.0 * self.k3, 1.0 - MIN_SLOPE);
        let inside = linear * linear - 4.0 * square * constant;
        if inside < 0.0 {
            return PI;
        }
        let sum = -0.5 * (linear + inside.sqrt().copysign(linear));
        let roots = [sum / square, constant / sum];
        let positive = roots.into_iter().filter(|root| *root > 0.0);
        positive.fold(PI * PI, f64::min).sqrt().min(PI)
    }

    /// The ratios r / (f θ) and r′ / f at an angle θ from the axis. Here r is the distance from the image's centre, r′
    /// its derivative with respect to θ, and f the focal length.
    fn stretches(self, angle: f64) -> [f64; 2] {
        let square = angle.min(self.max_angle).powi(2);
        let term =
            |third: f64, fifth: f64| 1.0 + square * (third * self.k3 + square * (fifth * self.k5));
        [term(1.0, 1.0), term(3.0, 5.0)]
    }

    /// Angle (rad) from the camera's axis that belongs to a distance from the image's centre. `scaled` is this distance
    /// divided by the focal length. `None` if the lens does not reach this distance.
    fn angle(self, scaled: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, self.max_angle);
        let distance = |angle: f64| angle * self.stretches(angle)[0];
        let is_valid = scaled <= distance(high);
        if !is_valid {
            return None;
        }
        let mut angle = scaled.min(high);
        for _ in 0..MAX_STEPS {
            let error = distance(angle) - scaled;
            if error > 0.0 {
                high = angle;
            } else {
                low = angle;
            }
            let newton = angle - error / self.stretches(angle)[1];
            let next = if (low..=high).contains(&newton) {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - angle).abs() <= f64::EPSILON * next {
                return Some(next);
            }
            angle = next;
        }
        Some(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Status;
    use approx::assert_relative_eq;

    fn with_odd_terms(terms: [f64; 2]) -> Result<Equidistant, CalibrationError> {
        Equidistant::new([319.5, 319.5], 230.0, terms)
    }

    fn camera() -> Equidistant {
        with_odd_terms([0.0; 2]).expect("between the limits")
    }

    #[test]
    fn along_the_radius_a_pixel_is_an_angle_and_across_it_is_less() {
        let camera = camera();
        let rest = [319.5 + 230.0, 319.5];
        let along = camera.shift(rest, [rest[0] + 2.3, rest[1]]);
        assert_relative_eq!(along[0], 0.01, epsilon = 1e-12);
        assert_relative_eq!(along[1], 0.0, epsilon = 1e-12);
        // A place at 1 rad from the apex lies on a circle of radius sin 1 (on the unit sphere), but its image lies on a
        // circle with a radius of 1 focal length. So a pixel in the azimuthal direction corresponds to a smaller angle
        // than a pixel in the radial direction.
        let across = camera.shift(rest, [rest[0], rest[1] - 1e-3]);
        assert_relative_eq!(
            across[1],
            1e-3 / 230.0 * libm::sin(1.0_f64),
            max_relative = 1e-6
        );
    }

    #[test]
    fn odd_terms_come_back() {
        for [k3, k5] in [[0.05, -0.02], [-0.2, 0.03], [-0.04, 0.0], [0.0, 0.1]] {
            let camera = with_odd_terms([k3, k5]).expect("terms in range");
            for step in 0..=50 {
                let angle = 0.02 * f64::from(step);
                let radius = 230.0 * (angle + k3 * angle.powi(3) + k5 * angle.powi(5));
                let (up, along) = libm::sincos(0.3 * f64::from(step));
                let place = camera.place([319.5 + radius * along, 319.5 - radius * up]);
                assert_relative_eq!(place[0], angle * along, epsilon = 1e-12);
                assert_relative_eq!(place[1], angle * up, epsilon = 1e-12);
                // `area` is the ratio of an area in the image to the corresponding area on the sphere. `slope` is the
                // derivative of the distance from the image's centre with respect to the angle, computed as a finite
                // difference.
                let more = 1e-6;
                let distance = |angle: f64| angle + k3 * angle.powi(3) + k5 * angle.powi(5);
                if angle > 0.0 {
                    let slope = (distance(angle + more) - distance(angle - more)) / (2.0 * more);
                    let area = slope * distance(angle) / libm::sin(angle);
                    assert_relative_eq!(camera.stretching(angle), area, max_relative = 1e-9);
                }
            }
        }
        assert!(with_odd_terms([f64::NAN, 0.0]).is_err());
        assert!(with_odd_terms([0.0, 1e9]).is_err());
        // The slope d(r/f)/dθ = 1 − 3 θ² of this lens decreases to 0.01 at the angle θ = 0.574 rad. At this angle, the
        // distance from the middle of the image is 0.385 focal lengths. The lens model assigns no place to points
        // farther from the middle.
        let folded = with_odd_terms([-1.0, 0.0]).expect("terms in range");
        assert_eq!(folded.place([319.5 + 230.0 * 0.4, 319.5]), [0.0; 2]);
        assert!(folded.place([319.5 + 230.0 * 0.38, 319.5])[0] > 0.5);
    }

    #[test]
    fn at_the_apex_and_back() {
        let camera = camera();
        let [apex, point] = [[319.5, 319.5], [330.0, 301.5]];
        let there = camera.shift(apex, point);
        let back = camera.shift(point, apex);
        for axis in 0..2 {
            assert_relative_eq!(there[axis], camera.place(point)[axis], epsilon = 1e-14);
            // The displacement from the point to the apex is the negative of the displacement from the apex to the
            // point, because parallel transport along a meridian keeps the angle between the axes and the meridian.
            assert_relative_eq!(back[axis], -there[axis], epsilon = 1e-14);
        }
        assert_eq!(camera.shift(point, point), [0.0, 0.0]);
    }

    #[test]
    fn a_marker_that_only_moves_outward_does_not_grow() {
        let camera = camera();
        // `marker` returns the image of a marker at the angle `angle` from the axis. The marker's solid angle does not
        // depend on `angle`.
        let marker = |angle: f64| Marker {
            centroid_px: [319.5 + 230.0 * angle, 319.5],
            hue_turns: 0.9,
            mean_hue_turns: 0.9,
            size_px2: 500.0 * angle / libm::sin(angle),
            pixels: 500,
        };
        let track = Track {
            rest: Some(marker(0.5)),
            pressed: Some(marker(0.8)),
            status: Status::Tracked,
        };
        let change = camera.change(&track).expect("it was tracked");
        assert_relative_eq!(change.growth, 0.0, epsilon = 1e-12);
        assert_relative_eq!(change.shift_px[0], 69.0, epsilon = 1e-9);
        assert!(track.change().expect("it was tracked").growth > 0.01);
    }
}
