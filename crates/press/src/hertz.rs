//! Relations at the surface beside Hertz's own: that of the 2020 paper, and one that holds for large contacts.

use crate::PressError;

/// Limit of small-strain theory: its errors are noticeable if the contact's radius is a larger share of the
/// sensor's or the object's radius.
pub const LARGE_CONTACT: f64 = 0.3;

/// Largest allowed ratio of the contact's radius to the radius of a convex object.
pub const MAX_CONTACT: f64 = 0.9;

/// Sneddon's relation for a rigid sphere of radius R and any contact radius a < R: δ = (a/2) ln((R + a)/(R − a)).
///
/// Hertz theory has δ = a²/R, which is its limit for a ≪ R. Within 1e-15 of it.
///
/// ```
/// use palpate_press::hertz::sneddon_indentation;
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
