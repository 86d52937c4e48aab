//! Regimes of contact between a spherical sensor and an object, and limits of the theory.

use strum::IntoStaticStr;

use crate::PressError;

/// How a sphere touches an object of some curvature (2020 paper, Fig. 2).
///
/// ```
/// use palpate_press::ContactRegime;
///
/// // A sensor of radius 20 on a bulge and in two hollows.
/// let on = |object_radius: f64| ContactRegime::of(1.0 / 20.0, 1.0 / object_radius);
/// assert_eq!(on(80.0), ContactRegime::Convex);
/// assert_eq!(on(-80.0), ContactRegime::Concave);
/// assert_eq!(on(-10.0), ContactRegime::Edge);
/// ```
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum ContactRegime {
    /// The object bulges towards the sensor.
    Convex,
    /// The object is flat.
    Flat,
    /// The object is hollow with less curvature than the sensor: the first contact is one point.
    Concave,
    /// The object is hollow with the curvature of the sensor: the surfaces fit, and no point is touched first.
    Conforming,
    /// The object is hollow with more curvature than the sensor: the sensor touches its edge.
    Edge,
}

/// Relative curvatures below this, relative to the sensor's own curvature, count as 0.
const RELATIVE_TOLERANCE: f64 = 1e-12;

impl ContactRegime {
    /// The regime of a sensor of curvature `sensor > 0` on an object of curvature `object`, positive where convex.
    pub fn of(sensor: f64, object: f64) -> Self {
        let relative = sensor + object;
        if relative.abs() <= RELATIVE_TOLERANCE * sensor {
            Self::Conforming
        } else if relative < 0.0 {
            Self::Edge
        } else if object < 0.0 {
            Self::Concave
        } else if object > 0.0 {
            Self::Convex
        } else {
            Self::Flat
        }
    }

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Limit of small-strain theory: its errors are noticeable if the ratio of the contact's radius to the radius of the sensor or
/// of the object is larger.
pub const LARGE_CONTACT: f64 = 0.3;

/// Largest allowed ratio of the contact's radius to the radius of a convex object.
const MAX_CONTACT: f64 = 0.9;

/// Sneddon's relation for a rigid sphere of radius R and any contact radius a < R: δ = (a/2) ln((R + a)/(R − a)).
///
/// Its limit for a ≪ R is δ = a²/R of Hertz theory.
///
/// ```
/// use palpate_press::sneddon_indentation;
///
/// let indentation = sneddon_indentation(2.0, 1.0)?;
/// assert!((indentation - 0.5 * libm::log(3.0)).abs() < 1e-15);
/// // Near Hertz's a²/R where the contact is small.
/// assert!((sneddon_indentation(2.0, 1e-3)? / 5e-7 - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PressError::BadSetting`] unless 0 <= a < R, both finite.
pub fn sneddon_indentation(radius: f64, a: f64) -> Result<f64, PressError> {
    let good = radius > 0.0 && radius.is_finite();
    PressError::unless_good("radius", radius, good, "finite and > 0")?;
    let good = (0.0..radius).contains(&a);
    PressError::unless_good("contact_radius", a, good, "at least 0 and below the radius")?;
    // The area tangent of a/R, from R − a, which has all its digits.
    Ok(0.5 * a * libm::log1p(2.0 * a / (radius - a)))
}

/// Checks that a contact of this radius (length) is narrow enough for an object of this curvature (1/length).
///
/// # Errors
/// [`PressError::TooWide`] if the object is convex and the contact radius exceeds 0.9 of its radius.
pub fn within_object(object_curvature: f64, contact_radius: f64) -> Result<(), PressError> {
    let limit = MAX_CONTACT / object_curvature;
    if object_curvature > 0.0 && contact_radius > limit {
        let what = "0.9 of the object's radius";
        return Err(PressError::TooWide {
            radius: contact_radius,
            limit,
            what,
        });
    }
    Ok(())
}
