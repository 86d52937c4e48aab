//! Computes the motion of the skin under an object that sticks to the skin and moves sideways.
//!
//! If the contact (a disc of radius a) shifts a little without slip, all points of the contact move equally. On an
//! elastic half-space, the traction is then q₀/√(1 − r²/a²) (Mindlin 1949), whose Hankel transform is q₀ a sin(ka)/k. A
//! wave of traction with the amplitude q̄ and the wavenumber k displaces the material at the depth z. In units of q̄
//! e^{−kz}/(2Gk), with the shear modulus G, the displacement has three components: 2(1−ν) − kz along the direction of
//! the wave, 2 across it, and (1−2ν) + kz inward. The inward component is shifted by a quarter of a wavelength. The
//! shift of the contact is π(2−ν) q₀ a/(4G). For a shift by one unit of length, with the azimuth φ relative to the
//! direction of the shift:
//!
//! ```text
//! along  = s [2(2−ν) A₀ − z B₀ + cos 2φ (2ν A₂ + z B₂)]     across = s sin 2φ (2ν A₂ + z B₂)
//! inward = 2s cos φ [(1−2ν) A₁ + z B₁]                      s = 1/(π(2−ν))
//! A_m = ∫ sin(ka) e^{−kz} J_m(kr) dk/k                      B_m = ∫ sin(ka) e^{−kz} J_m(kr) dk
//! ```
//!
//! With the complex distance ρ = √(r² + ζ²), ζ = z − ia, and t = r/(ρ + ζ), A_m is Im tᵐ/m and B_m is Im tᵐ/ρ. A₀ is
//! asin(a/l), where l is half the sum of the distances from the point to both ends of the contact's diameter.

use std::f64::consts::PI;

use crate::PressError;
use crate::half_space::Spheroidal;

/// Displacement of a point of the skin if the contact shifts by one unit of length without slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct StuckShift {
    pub(crate) along: f64,
    /// Component of the displacement along the skin and perpendicular to the shift, in the direction of increasing
    /// azimuth.
    pub(crate) across: f64,
    pub(crate) normal: f64,
}

/// Displacement of a point of the skin while a contact with the radius `contact_radius` shifts by one unit of length
/// without slip. The point is at the depth `depth >= 0` and at the distance `r >= 0` from the middle of the contact.
/// `azimuth` is the angle between the shift and the direction from the contact to the point, rad. At the surface, all
/// points of the contact move by one unit of length. Far away, the displacement is the same as under a point force
/// (Cerruti).
///
/// # Errors
/// [`PressError::BadSetting`] unless `poisson` is from 0 to 0.5, `depth` and `distance` from 0 to 1e50,
/// `contact_radius` from 1e-50 to 1e50, and `azimuth` finite.
pub(crate) fn stuck_shift(
    poisson: f64,
    depth: f64,
    contact_radius: f64,
    r: f64,
    azimuth: f64,
) -> Result<StuckShift, PressError> {
    let good = (0.0..=0.5).contains(&poisson);
    PressError::unless_good("poisson", poisson, good, "from 0 to 0.5")?;
    for (setting, value) in [("depth", depth), ("distance", r)] {
        let good = (0.0..=1e50).contains(&value);
        PressError::unless_good(setting, value, good, "at least 0 and at most 1e50")?;
    }
    let good = (1e-50..=1e50).contains(&contact_radius);
    PressError::unless_good("contact_radius", contact_radius, good, "from 1e-50 to 1e50")?;
    PressError::unless_good("azimuth", azimuth, azimuth.is_finite(), "finite")?;

    let z = depth / contact_radius;
    let waves = Waves::new(z, Spheroidal::new(contact_radius, depth, r));
    let scale = 1.0 / (PI * (2.0 - poisson));
    let (sine, cosine) = libm::sincos(azimuth);
    let uniform = 2.0 * (2.0 - poisson) * waves.a[0] - z * waves.b[0];
    let turning = 2.0 * poisson * waves.a[2] + z * waves.b[2];
    let inward = (1.0 - 2.0 * poisson) * waves.a[1] + z * waves.b[1];
    Ok(StuckShift {
        along: scale * (uniform + (cosine - sine) * (cosine + sine) * turning),
        across: scale * 2.0 * sine * cosine * turning,
        normal: 2.0 * scale * cosine * inward,
    })
}

/// The integrals A_m and B_m for m = 0, 1, 2, as in the description of this module. Lengths are in units of the
/// contact's radius.
struct Waves {
    a: [f64; 3],
    b: [f64; 3],
}

impl Waves {
    fn new(z: f64, place: Spheroidal) -> Self {
        let Spheroidal { xi, eta, r, .. } = place;
        // With the spheroidal coordinates ξ and η, the complex distance is ρ = ξ − iη, and the complex depth is ζ = z −
        // i.
        let (real, imaginary) = (xi + z, eta + 1.0);
        let share = r / (real * real + imaginary * imaginary);
        let t = [share * real, share * imaginary];
        let t_squared = [(t[0] - t[1]) * (t[0] + t[1]), 2.0 * t[0] * t[1]];
        let size = place.edge.max(f64::MIN_POSITIVE);
        let over_distance = |[real, imaginary]: [f64; 2]| (imaginary * xi + real * eta) / size;
        Self {
            a: [libm::atan2(1.0_f64, xi), t[1], 0.5 * t_squared[1]],
            b: [[1.0, 0.0], t, t_squared].map(over_distance),
        }
    }
}
