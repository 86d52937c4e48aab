//! The skin of a spherical sensor or of a flat pad, and places on it.

use nalgebra::{UnitVector3, Vector2, Vector3};

use crate::regime::within_object;
use crate::{Body, Contact, ContactRegime, EllipticContact, PressError};

/// Range of allowed radii (length) of the skin. Products of a few such lengths are within the range of double-precision
/// numbers.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// The skin of a sensor: a sphere, with coordinates relative to its apex. The skin of a flat pad is a sphere with an
/// infinite radius.
///
/// The coordinates (x, y) of a place are its logarithm map from the apex. The vector (x, y) points from the apex
/// towards the place, and √(x² + y²) is the distance along the skin. The components of tangential displacements are
/// along the axes at the apex, transported along the meridian to the place.
///
/// ```
/// use palpate_press::{Body, Skin};
///
/// // A sensor of radius 20 pressed by 1 on a ball of radius 80: C_r = 1/20 + 1/80 = 1/16.
/// let skin = Skin::new(20.0)?;
/// let body = Body::half_space(0.5, 0.0)?;
/// let contact = skin.contact(&body, 1.0 / 80.0, 1.0)?;
/// assert!((contact.relative_curvature - 1.0 / 16.0).abs() < 1e-15);
/// assert!((contact.radius - 4.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skin {
    radius: f64,
}

/// A place on the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Direction of the place from the sensor's centre.
    pub(crate) direction: UnitVector3<f64>,
    /// The x axis of the apex, transported to this place.
    pub(crate) x_axis: Vector3<f64>,
    /// The y axis of the apex, transported to this place.
    pub(crate) y_axis: Vector3<f64>,
}

impl Skin {
    /// The skin of a sensor with the radius `radius`, which is infinite for a flat pad.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for `radius` unless it is between 1e-50 and 1e50, or infinite.
    pub fn new(radius: f64) -> Result<Self, PressError> {
        let good = LENGTHS.contains(&radius) || radius == f64::INFINITY;
        PressError::unless_good(
            "radius",
            radius,
            good,
            "between 1e-50 and 1e50, or infinite",
        )
        .map(|radius| Self { radius })
    }

    /// Radius of the skin; infinite for a flat pad.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Radius of the sphere on which places are computed. For a flat pad, it is so large that the sphere is practically
    /// a plane.
    pub(crate) const fn place_radius(&self) -> f64 {
        self.radius.min(*LENGTHS.end())
    }

    /// Curvature of the skin, 1/R_s (1/length), where R_s is the radius of the skin.
    pub fn curvature(&self) -> f64 {
        self.radius.recip()
    }

    /// The place with the coordinates (x, y). Coordinates that correspond to more than half a turn around the sphere
    /// are reduced by whole turns. If x/R_s and y/R_s, with the skin's radius R_s, are not finite angles, the result is
    /// the apex.
    pub(crate) fn place(&self, [x, y]: [f64; 2]) -> Place {
        let [x, y] = [x, y].map(|along| along / self.place_radius());
        let angle = libm::hypot(x, y);
        let (angle, along) = if angle > 0.0 && angle.is_finite() {
            (angle, Vector2::new(x / angle, y / angle))
        } else {
            (0.0, Vector2::x())
        };
        let (sine, cosine) = libm::sincos(angle);
        let meridian = Vector3::new(along.x * cosine, along.y * cosine, -sine);
        let across = Vector3::new(-along.y, along.x, 0.0);
        Place {
            direction: UnitVector3::new_normalize(Vector3::new(
                along.x * sine,
                along.y * sine,
                cosine,
            )),
            x_axis: meridian * along.x - across * along.y,
            y_axis: meridian * along.y + across * along.x,
        }
    }

    /// Coordinates of a place on the skin. `direction` is a vector of any length from the sensor's centre to the place.
    /// If the vector is 0 or not finite, the result is the apex.
    pub(crate) fn chart(&self, direction: &Vector3<f64>) -> [f64; 2] {
        let largest = direction.amax();
        let is_one = largest > 0.0 && direction.iter().all(|part| part.is_finite());
        if !is_one {
            return [0.0; 2];
        }
        let direction = direction / largest;
        let across = libm::hypot(direction.x, direction.y);
        if across == 0.0 {
            let turn = if direction.z < 0.0 {
                std::f64::consts::PI
            } else {
                0.0
            };
            return [self.place_radius() * turn, 0.0];
        }
        let distance = self.place_radius() * libm::atan2(across, direction.z);
        [
            distance * (direction.x / across),
            distance * (direction.y / across),
        ]
    }

    /// The contact between `body` and an object. `object_curvature` is positive for a convex object, and 0 for a plane.
    ///
    /// # Errors
    /// [`PressError::Conforming`] and [`PressError::EdgeContact`] if the relative curvature is not positive;
    /// [`PressError::NoIndentation`] if the indentation is not positive; [`PressError::TooDeep`] if the indentation
    /// reaches the sensor's centre or the layer's base; [`PressError::TooWide`] if the contact would be wider than the
    /// sensor; [`PressError::LayerTooThin`] if the layer is too thin for the equations to be solved.
    pub fn contact<'b>(
        &self,
        body: &'b Body,
        object_curvature: f64,
        indentation: f64,
    ) -> Result<Contact<'b>, PressError> {
        let relative_curvature = self.relative_curvature(object_curvature)?;
        self.press(body, relative_curvature, indentation)
    }

    /// Contact of a half-space with an object that has two principal curvatures, the smaller one first.
    ///
    /// # Errors
    /// The errors of [`Skin::contact`], and [`PressError::TooWide`] if the contact is too wide for the larger
    /// curvature.
    pub(crate) fn elliptic_contact(
        &self,
        poisson: f64,
        [smaller, larger]: [f64; 2],
        indentation: f64,
    ) -> Result<EllipticContact, PressError> {
        let relative = [self.relative_curvature(smaller)?, self.curvature() + larger];
        self.holds_indentation(indentation)?;
        let contact = EllipticContact::new(poisson, relative, indentation);
        let contact = contact.map_err(|error| match error {
            PressError::BadSetting(_) => PressError::OutOfRange,
            other => other,
        })?;
        self.holds_contact(contact.semi_axes[0])?;
        within_object(larger, contact.semi_axes[1])?;
        Ok(contact)
    }

    pub(crate) fn press<'b>(
        &self,
        body: &'b Body,
        relative_curvature: f64,
        indentation: f64,
    ) -> Result<Contact<'b>, PressError> {
        self.holds_indentation(indentation)?;
        let contact = body.press(relative_curvature, indentation)?;
        self.holds_contact(contact.radius)?;
        Ok(contact)
    }

    /// Sum of the curvatures of the skin and the object. Returns an error if skin and object do not first touch at a
    /// single point.
    fn relative_curvature(&self, object_curvature: f64) -> Result<f64, PressError> {
        let relative_curvature = self.curvature() + object_curvature;
        match ContactRegime::of(self.curvature(), object_curvature) {
            ContactRegime::Conforming => Err(PressError::Conforming { relative_curvature }),
            ContactRegime::Edge => Err(PressError::EdgeContact { relative_curvature }),
            ContactRegime::Convex | ContactRegime::Flat | ContactRegime::Concave => {
                Ok(relative_curvature)
            }
        }
    }

    fn holds_indentation(&self, indentation: f64) -> Result<(), PressError> {
        if indentation >= self.radius {
            return Err(PressError::TooDeep {
                indentation,
                limit: self.radius,
                what: "the sensor's radius",
            });
        }
        Ok(())
    }

    pub(crate) fn holds_contact(&self, radius: f64) -> Result<(), PressError> {
        if radius >= self.radius {
            return Err(PressError::TooWide {
                radius,
                limit: self.radius,
                what: "the sensor's radius",
            });
        }
        Ok(())
    }

    /// Direction from the sensor's centre to a point of the skin near `place`. The path from `place` to the point along
    /// the skin has the components `along` (length, in the direction of the x axis of `place`) and `across` (in the
    /// direction of its y axis). The components must not both be 0.
    pub(crate) fn beyond(&self, place: &Place, along: f64, across: f64) -> Vector3<f64> {
        let tangent = place.x_axis * along + place.y_axis * across;
        let angle = tangent.norm() / self.place_radius();
        place.direction.as_ref() * libm::cos(angle) + tangent.normalize() * libm::sin(angle)
    }

    pub(crate) fn place_at(&self, direction: &Vector3<f64>) -> Place {
        self.place(self.chart(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_whose_square_overflows_has_chart_coordinates() {
        let skin = Skin::new(2.0).unwrap();
        let [x, y] = skin.chart(&Vector3::new(1e308, 0.0, 1e308));
        assert!((x - std::f64::consts::FRAC_PI_2).abs() < 1e-15 && y == 0.0);
        assert_eq!(skin.chart(&Vector3::new(f64::NAN, 1.0, 0.0)), [0.0; 2]);
    }

    #[test]
    fn chart_coordinates_invert_positions_at_any_size() {
        for radius in [1e-40, 1.0, 1e40] {
            let skin = Skin::new(radius).unwrap();
            for angle in [1e-200, 1e-6, 1.0, 3.1] {
                for (sine, cosine) in [0.0_f64, 0.7, -3.0].map(libm::sincos) {
                    let place = [angle * cosine, angle * sine].map(|along| along * radius);
                    let chart = skin.chart(skin.place(place).direction.as_ref());
                    let off = libm::hypot(chart[0] - place[0], chart[1] - place[1]);
                    assert!(off <= 3e-14 * angle * radius, "{angle:e}: {off:e}");
                }
            }
        }
    }
}
