//! Computes the effect of the rigid base as a sum over wavenumbers. This effect is the difference between the
//! displacements of the layer and the displacements of a half-space.
//!
//! Lengths are in units of the layer's thickness; H is the wavenumber, ζ the depth, and x = H(1 − ζ). A pressure with
//! the Hankel transform Q displaces the layer by ∫ Q N J₀ dH inward and by ∫ Q R J₁ dH outward. J₀ and J₁ are Bessel
//! functions of H times the distance, and N and R are
//!
//! ```text
//! N = [(cosh H + H sinh H)(sinh x − x cosh x) + H cosh H · x sinh x] / (cosh² H + H²)      R = ∂N/∂x likewise
//! ```
//!
//! For a half-space, N = (1 + Hζ) e^{−Hζ} and R = Hζ e^{−Hζ}. The difference between layer and half-space decays as
//! e^{−(2−ζ)H}. It is computed from its terms in e^{−2H} and e^{−2x}, so there is no cancellation where it is small.

use std::sync::OnceLock;

use super::pressure::{Pressure, wavenumbers};
use crate::body::Field;

/// A term e^{−x} counts as negligible if x exceeds this value.
const NEGLIGIBLE: f64 = 36.0;

/// Effect of the rigid base on displacements at the surface: the displacement of a half-space minus that of the layer,
/// divided by that of the half-space. With the wavenumber H, it is 1 − (sinh 2H − 2H)/(cosh 2H + 2H² + 1).
pub(super) fn at_surface(wavenumber: f64) -> f64 {
    let h = wavenumber;
    let q = libm::exp(-2.0 * h);
    2.0 * q * (1.0 + 2.0 * h + 2.0 * h * h + q) / ((1.0 + q) * (1.0 + q) + 4.0 * h * h * q)
}

/// The wavenumber beyond which the effect of the rigid base on displacements at the surface is negligible.
pub(super) const SURFACE_REACH: f64 = NEGLIGIBLE / 2.0;

/// Effect of the rigid base on displacements at the depth `depth`, for one wavenumber: the displacement of the layer
/// minus that of a half-space, so the sign is opposite to that of [`at_surface`]. Both are divided by the inward
/// displacement at the half-space's surface. The first value is for the inward displacement, which varies as the Bessel
/// function J₀, the second for the outward displacement, which varies as J₁.
fn at_depth(wavenumber: f64, depth: f64) -> [f64; 2] {
    let (h, x) = (wavenumber, wavenumber * (1.0 - depth));
    let (q, p) = (libm::exp(-2.0 * h), libm::exp(-2.0 * x));
    let decay = libm::exp(-h * depth);
    let denominator = (1.0 + q) * (1.0 + q) + 4.0 * h * h * q;
    let excess = q * (2.0 + q + 4.0 * h * h);
    let cross = 2.0 * h * x;
    let normal = q * (1.0 - h - x + cross)
        - p * (1.0 + h + x + cross)
        - p * q * (1.0 - h + x)
        - (1.0 + h - x) * excess;
    let radial = q * (h - x + cross) + p * (x - h + cross) + p * q * (x - h) - (h - x) * excess;
    [decay * normal / denominator, decay * radial / denominator]
}

/// The wavenumber beyond which the effect of the rigid base on displacements at the depth `depth` is negligible.
fn reach_at(depth: f64) -> f64 {
    NEGLIGIBLE / (2.0 - depth)
}

/// Distance from the contact's edge, in units of the layer's thickness, beyond which all displacements are below 1e-9
/// of the largest displacement. At the distance r, they decay as e^{−0.739 r}; the number 0.739 solves cos x = x.
pub(super) const BEYOND: f64 = 30.0;

/// Largest distance from the contact's edge, in units of the layer's thickness, at which the first sum over wavenumbers
/// is accurate. Each further sum is accurate up to twice the distance of the previous sum.
const FIRST_REACH: f64 = 4.0;

/// Effect of the rigid base on the displacements under a pressure, at one depth, as sums over wavenumbers.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    pressure: Pressure,
    depth: f64,
    resolution: f64,
    /// Sums over wavenumbers. Each sum is accurate up to a larger distance than the previous sum, and is computed when
    /// it is first needed.
    bands: Vec<OnceLock<Vec<Wave>>>,
}

/// One term of a sum over wavenumbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    pub(super) wavenumber: f64,
    /// Amplitudes of the wave: the factor of J₀ (inward displacement) and the factor of J₁ (outward displacement).
    pub(super) strength: [f64; 2],
    /// Derivatives of the two amplitudes in `strength` with respect to the contact's radius.
    pub(super) per_contact: [f64; 2],
}

/// Wavenumbers with their quadrature weights. For each wavenumber, the spectrum contains the Hankel transform of the
/// contact's pressure, and the derivative of this transform with respect to the contact's radius.
pub(super) struct Spectrum {
    nodes: Vec<[f64; 2]>,
    transforms: Vec<[f64; 2]>,
}

impl Spectrum {
    /// All wavenumbers that contribute noticeably to the displacements at the depth `depth` under the pressure
    /// `pressure`. The wavenumbers are so close together that the sum is accurate for points at distances up to `reach`
    /// from the contact. Their number is multiplied by `resolution`, whose standard value is 1.
    pub(super) fn new(pressure: &Pressure, depth: f64, reach: f64, resolution: f64) -> Self {
        let distance = pressure.contact + reach;
        let nodes = wavenumbers(reach_at(depth), distance, resolution);
        let transforms = nodes
            .iter()
            .map(|[wavenumber, _]| pressure.transform(*wavenumber));
        Self {
            transforms: transforms.collect(),
            nodes,
        }
    }

    pub(super) fn waves(&self, depth: f64) -> Vec<Wave> {
        let pairs = self.nodes.iter().zip(&self.transforms);
        let waves = pairs.map(|(&[wavenumber, weight], [curved, flat])| {
            let share = at_depth(wavenumber, depth);
            Wave {
                wavenumber,
                strength: share.map(|share| weight * share * curved),
                per_contact: share.map(|share| weight * share * flat),
            }
        });
        waves.collect()
    }
}

impl Waves {
    pub(super) fn new(pressure: Pressure, depth: f64, resolution: f64) -> Self {
        let count = libm::log2((pressure.contact + BEYOND) / FIRST_REACH).ceil() as usize + 1;
        Self {
            pressure,
            depth,
            resolution,
            bands: vec![OnceLock::new(); count],
        }
    }

    pub(super) fn field(&self, r: f64) -> Field {
        let reaches = std::iter::successors(Some(FIRST_REACH), |reach| Some(2.0 * reach));
        let band = self
            .bands
            .iter()
            .zip(reaches)
            .find(|(_, reach)| r <= *reach);
        let Some((waves, reach)) = band else {
            return Field::default();
        };
        let waves = waves.get_or_init(|| {
            Spectrum::new(&self.pressure, self.depth, reach, self.resolution).waves(self.depth)
        });
        let mut field = Field::default();
        for wave in waves {
            let k = wave.wavenumber;
            let [j0, j1, j1_over] = bessel(k * r);
            field.normal += wave.strength[0] * j0;
            field.normal_per_r -= wave.strength[0] * k * j1;
            field.normal_per_a += wave.per_contact[0] * j0;
            field.radial += wave.strength[1] * j1;
            field.radial_per_r += wave.strength[1] * k * (j0 - j1_over);
            field.radial_per_a += wave.per_contact[1] * j1;
        }
        field
    }
}

/// The Bessel functions J₀(x) and J₁(x), and the quotient J₁(x)/x.
pub(super) fn bessel(x: f64) -> [f64; 3] {
    let j1 = libm::j1(x);
    let over = if x < 1e-8 { 0.5 } else { j1 / x };
    [libm::j0(x), j1, over]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_equal_the_quotients() {
        for (h, depth) in [(0.3_f64, 0.0), (1.0, 0.4), (2.5, 0.9), (4.0, 0.1)] {
            let x = h * (1.0 - depth);
            let denominator = libm::cosh(h).powi(2) + h * h;
            let stiff = libm::cosh(h) + h * libm::sinh(h);
            let normal =
                stiff * (libm::sinh(x) - x * libm::cosh(x)) + h * libm::cosh(h) * x * libm::sinh(x);
            let radial = -stiff * x * libm::sinh(x)
                + h * libm::cosh(h) * (libm::sinh(x) + x * libm::cosh(x));
            let half_space = libm::exp(-h * depth);
            let expected = [
                normal / denominator - (1.0 + h * depth) * half_space,
                radial / denominator - h * depth * half_space,
            ];
            let got = at_depth(h, depth);
            for (got, expected) in got.iter().zip(expected) {
                assert!((got - expected).abs() < 1e-13, "{got} {expected}");
            }
            let surface =
                (libm::sinh(2.0 * h) - 2.0 * h) / (libm::cosh(2.0 * h) + 2.0 * h * h + 1.0);
            assert!((1.0 - at_surface(h) - surface).abs() < 1e-13);
        }
    }
}
