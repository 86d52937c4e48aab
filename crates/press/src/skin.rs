//! Points on the skin of a spherical sensor.

use nalgebra::{UnitVector3, Vector2, Vector3};

use crate::{Body, Contact, ContactRegime, EllipticContact, PressError, within_object};

/// Lengths whose products of a few factors stay in the range of doubles.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// The skin: a sphere, with coordinates from its apex.
///
/// A place has chart coordinates (x, y), its logarithm map from the apex: it lies √(x² + y²) along the skin in the
/// direction (x, y). Tangential displacements are counted along the axes of the apex, carried along the meridian.
///
/// ```
/// use palpate_press::{Body, Skin};
///
/// // A sensor of radius 20 pressed by 1 on a ball of radius 80: C_r = 1/20 + 1/80 = 1/16.
/// let skin = Skin::new(20.0)?;
/// let body = Body::hertz(0.5)?;
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
pub struct Place {
    /// Direction from the sensor's centre.
    pub direction: UnitVector3<f64>,
    /// The apex's x axis, carried here.
    pub x_axis: Vector3<f64>,
    /// The apex's y axis, carried here.
    pub y_axis: Vector3<f64>,
}

impl Skin {
    /// The skin of a sensor of this radius.
    ///
    /// # Errors
    /// [`PressError::BadSetting`] for `radius` unless it is between 1e-50 and 1e50.
    pub fn new(radius: f64) -> Result<Self, PressError> {
        let good = LENGTHS.contains(&radius);
        PressError::unless_good("radius", radius, good, "between 1e-50 and 1e50")
            .map(|radius| Self { radius })
    }

    /// The radius.
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The curvature, 1/R_s.
    pub fn curvature(&self) -> f64 {
        self.radius.recip()
    }

    /// The place at chart coordinates (x, y); places more than half a turn away wrap around, and coordinates whose
    /// angle is not finite count as the apex.
    pub fn place(&self, [x, y]: [f64; 2]) -> Place {
        let [x, y] = [x / self.radius, y / self.radius];
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

    /// The chart coordinates of a vector from the centre, of any length; those of the apex if the vector is 0 or not finite.
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
            return [self.radius * turn, 0.0];
        }
        let distance = self.radius * libm::atan2(across, direction.z);
        [
            distance * (direction.x / across),
            distance * (direction.y / across),
        ]
    }

    /// The contact with an object of this curvature (positive if convex, 0 if flat) at this indentation of `body`.
    ///
    /// # Errors
    /// [`PressError::Conforming`] and [`PressError::EdgeContact`] where the relative curvature is not positive;
    /// [`PressError::NoIndentation`]; [`PressError::TooDeep`] where the indentation reaches the sensor's centre or the
    /// layer's base; [`PressError::TooWide`] where the contact would be wider than the sensor;
    /// [`PressError::LayerTooThin`].
    pub fn contact<'b>(
        &self,
        body: &'b Body,
        object_curvature: f64,
        indentation: f64,
    ) -> Result<Contact<'b>, PressError> {
        let relative_curvature = self.relative_curvature(object_curvature)?;
        self.press(body, relative_curvature, indentation)
    }

    /// The contact of a half-space with an object of these principal curvatures, the smaller first.
    ///
    /// # Errors
    /// Those of [`Skin::contact`], and [`PressError::TooWide`] where the contact is too wide for the larger curvature.
    pub fn elliptic_contact(
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

    /// The contact at this relative curvature.
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

    /// The sum of the skin's curvature and an object's, where there is a contact at one point.
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

    /// Rejects an indentation that reaches the sensor's centre.
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

    /// Rejects a contact that is wider than the sensor.
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

    /// The direction from the centre that lies this far along the skin from a place; the lengths, not both zero, go
    /// along the place's axes.
    pub(crate) fn beyond(&self, place: &Place, along: f64, across: f64) -> Vector3<f64> {
        let tangent = place.x_axis * along + place.y_axis * across;
        let angle = tangent.norm() / self.radius;
        place.direction.as_ref() * libm::cos(angle) + tangent.normalize() * libm::sin(angle)
    }

    /// The place at a direction from the centre.
    pub(crate) fn place_at(&self, direction: &Vector3<f64>) -> Place {
        self.place(self.chart(direction))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_whose_square_overflows_has_chart_coordinates() {
        let skin = Skin { radius: 2.0 };
        let [x, y] = skin.chart(&Vector3::new(1e308, 0.0, 1e308));
        assert!((x - std::f64::consts::FRAC_PI_2).abs() < 1e-15 && y == 0.0);
        assert_eq!(skin.chart(&Vector3::new(f64::NAN, 1.0, 0.0)), [0.0; 2]);
    }

    #[test]
    fn chart_coordinates_invert_positions_at_any_size() {
        for radius in [1e-40, 1.0, 1e40] {
            let skin = Skin { radius };
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
