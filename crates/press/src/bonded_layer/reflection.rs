//! The rigid base's effect: the difference from a half-space's displacement, wavenumber by wavenumber.
//!
//! In units of the thickness, with H the wavenumber, ζ the depth and x = H(1 − ζ), a pressure of Hankel transform Q
//! moves the layer by ∫ Q N J₀ dk inward and ∫ Q R J₁ dk outward,
//!
//! ```text
//! N = [(cosh H + H sinh H)(sinh x − x cosh x) + H cosh H · x sinh x] / (cosh² H + H²)      R = ∂N/∂x likewise
//! ```
//!
//! and the half-space by N = (1 + Hζ) e^{−Hζ}, R = Hζ e^{−Hζ}. Their difference decays as e^{−(2−ζ)H}; it is
//! formed below from its own terms in e^{−2H} and e^{−2x}, so that nothing cancels where it is small.

/// Exponent beyond which a term e^{−x} is neglected.
const NEGLIGIBLE: f64 = 36.0;

/// Half-space less layer at the surface, as a share of the half-space: 1 − (sinh 2H − 2H)/(cosh 2H + 2H² + 1).
pub(super) fn at_surface(wavenumber: f64) -> f64 {
    let h = wavenumber;
    let q = libm::exp(-2.0 * h);
    2.0 * q * (1.0 + 2.0 * h + 2.0 * h * h + q) / ((1.0 + q) * (1.0 + q) + 4.0 * h * h * q)
}

/// The wavenumber beyond which [`at_surface`] is negligible.
pub(super) const SURFACE_REACH: f64 = NEGLIGIBLE / 2.0;

/// Layer less half-space at a depth: inward under J₀, outward under J₁.
pub(super) fn at_depth(wavenumber: f64, depth: f64) -> [f64; 2] {
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

/// The wavenumber beyond which [`at_depth`] is negligible.
pub(super) fn reach(depth: f64) -> f64 {
    NEGLIGIBLE / (2.0 - depth)
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
