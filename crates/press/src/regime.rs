//! Regimes of contact between a spherical sensor and an object, and limits of the contact radius for which the contact
//! theory is valid.

use strum::IntoStaticStr;

use crate::PressError;

/// The way in which a spherical sensor touches an object, which depends on the object's curvature (2020 paper, Fig. 2).
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
    /// The object is convex.
    Convex,
    /// The object is flat.
    Flat,
    /// The object is concave with a smaller curvature than the sensor. The first contact is one point.
    Concave,
    /// The object is concave with the curvature of the sensor. The surfaces touch everywhere at once, so there is no
    /// first contact point.
    Conforming,
    /// The object is concave with a larger curvature than the sensor. The sensor touches the object's edge.
    Edge,
}

/// Tolerance for a relative curvature of 0. The relative curvature counts as 0 if its absolute value, divided by the
/// sensor's curvature, is below this value.
const RELATIVE_TOLERANCE: f64 = 1e-12;

impl ContactRegime {
    /// The regime for a sensor with the curvature `sensor >= 0` and an object with the curvature `object`, which is
    /// positive for a convex object.
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
}

/// Largest allowed ratio of the contact's radius to the radius of a convex object.
const MAX_CONTACT: f64 = 0.9;

/// Indentation δ of an elastic half-space by a rigid sphere of radius R, for a contact radius a < R: Sneddon's relation
/// δ = (a/2) ln((R + a)/(R − a)).
///
/// For a ≪ R, this becomes Hertz's relation δ = a²/R.
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
    PressError::unless_good(
        "contact_radius",
        a,
        good,
        "at least 0 and below the object's radius",
    )?;
    // Half of the logarithm is artanh(a/R), with the contact radius a and the object's radius R. It is computed from
    // the exact difference R − a, because a/R loses digits near 1.
    Ok(0.5 * a * libm::log1p(2.0 * a / (radius - a)))
}

/// Checks that a contact with the radius `contact_radius` (length) is narrow enough for an object with the curvature
/// `object_curvature` (1/length).
///
/// # Errors
/// [`PressError::TooWide`] if the object is convex and the contact radius exceeds 0.9 times the object's radius.
pub(crate) fn within_object(object_curvature: f64, contact_radius: f64) -> Result<(), PressError> {
    let limit = MAX_CONTACT / object_curvature;
    if object_curvature > 0.0 && contact_radius > limit {
        let what = "0.9 times the object's radius";
        return Err(PressError::TooWide {
            radius: contact_radius,
            limit,
            what,
        });
    }
    Ok(())
}
