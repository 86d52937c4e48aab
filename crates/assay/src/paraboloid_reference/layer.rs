//! Contact of a paraboloid with a bonded layer. The auxiliary function φ of the pressure satisfies the following
//! integral equation for 0 ≤ t ≤ α, where α is the contact radius. Lengths are in units of the layer's thickness, and D
//! is the indentation divided by the relative curvature.
//!
//! ```text
//! φ(t) − (2/π) ∫₀^α φ(s) ∫₀^∞ g(k) cos kt cos ks dk ds = (2/π)(D − t²),   φ(α) = 0
//! ```
//!
//! with g = 1 − (sinh 2k − 2k)/(cosh 2k + 2k² + 1).

use std::f64::consts::FRAC_2_PI;

use anyhow::{Context, Result, bail};
use nalgebra::{Complex, ComplexField, DMatrix, DVector};

use super::quadrature::{NEGLIGIBLE, PHASE, abel, around, on_panels, over, sum};

/// Maximum number of steps of the secant method for the contact radius; usually about eight steps are needed.
const MAX_STEPS: usize = 60;

/// The contact of a paraboloid with the layer.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) thickness: f64,
    /// Contact radius, in units of the layer's thickness: α in the integral equation for φ(t).
    pub(super) contact: f64,
    /// Ratio of indentation to relative curvature, in units of the squared thickness of the layer: D in the integral
    /// equation for φ(t).
    indentation: f64,
    nodes: Vec<Node>,
}

/// A node of the quadrature over the contact area, at the distance t from the middle of the contact.
#[derive(Debug)]
struct Node {
    place: f64,
    weight: f64,
    phi: f64,
}

impl Layer {
    /// The contact for which the ratio of indentation to relative curvature is `indentation_over_curvature` (length²).
    /// The thickness `thickness` of the layer must be in the same unit of length.
    pub(super) fn at_indentation(thickness: f64, indentation_over_curvature: f64) -> Result<Self> {
        let wanted = indentation_over_curvature / (thickness * thickness);
        let solve = |contact: f64| Self::with_radius(thickness, contact);
        // The secant method finds the contact radius α (`contact`) for which D (`indentation`, the ratio of indentation
        // to relative curvature) equals `wanted`. It uses logarithms, because ln D is almost a linear function of ln α.
        let [mut before, mut here] = [solve(wanted.sqrt())?, solve(1.2 * wanted.sqrt())?];
        for _ in 0..MAX_STEPS {
            let slope = libm::log(here.contact / before.contact)
                / libm::log(here.indentation / before.indentation);
            let missing = libm::log(wanted / here.indentation);
            if missing.abs() < 1e-14 || !slope.is_finite() {
                return Ok(here);
            }
            let next = solve(here.contact * libm::exp(slope * missing))?;
            before = std::mem::replace(&mut here, next);
        }
        match (here.indentation / wanted - 1.0).abs() {
            off if off < 1e-12 => Ok(here),
            off => bail!(
                "the search for the contact radius did not converge: the ratio of indentation to relative curvature should be {wanted:e} thickness², and the last ratio has the relative error {off:e}"
            ),
        }
    }

    /// The contact whose radius α is `contact`, in units of the layer's thickness.
    fn with_radius(thickness: f64, contact: f64) -> Result<Self> {
        let intervals = 2 * (12.0 + 8.0 * contact).ceil() as usize;
        let places: Vec<[f64; 2]> = over(0.0, contact, intervals).collect();
        let waves: Vec<[f64; 2]> = on_panels(reach(), panel(2.0 * contact)).collect();
        let cosines = DMatrix::from_fn(places.len(), waves.len(), |row, column| {
            libm::cos(waves[column][0] * places[row][0])
        });
        let weighted = DMatrix::from_fn(waves.len(), places.len(), |row, column| {
            let ([k, of_k], [_, of_t]) = (waves[row], places[column]);
            FRAC_2_PI * of_k * reflected(k) * of_t * cosines[(column, row)]
        });
        let matrix = DMatrix::identity(places.len(), places.len()) - &cosines * weighted;
        let decomposed = matrix.lu();
        let solve = |right: fn(f64) -> f64| {
            let right = places.iter().map(|[t, _]| right(*t));
            let right = DVector::from_iterator(places.len(), right);
            decomposed.solve(&right).context("a singular contact")
        };
        let (ones, squares) = (solve(|_| 1.0)?, solve(|t| t * t)?);
        let edge = places.len() - 1;
        let indentation = squares[edge] / ones[edge];
        let phi = (ones * indentation - squares) * FRAC_2_PI;
        let node = |([place, weight], phi): (&[f64; 2], &f64)| Node {
            place: *place,
            weight: *weight,
            phi: *phi,
        };
        Ok(Self {
            thickness,
            contact,
            indentation,
            nodes: places.iter().zip(phi.iter()).map(node).collect(),
        })
    }

    /// The Hankel transform Q of the pressure at the wavenumber k.
    fn transform(&self, k: f64) -> f64 {
        let nodes = self.nodes.iter();
        nodes
            .map(|node| node.weight * node.phi * libm::cos(k * node.place))
            .sum()
    }

    /// The auxiliary function φ of the pressure at the distance t from the middle of the contact. It is interpolated by
    /// a polynomial through its values at the Chebyshev nodes.
    fn phi(&self, t: f64) -> f64 {
        let last = self.nodes.len() - 1;
        let (mut sum, mut weights) = (0.0, 0.0);
        for (index, node) in self.nodes.iter().enumerate() {
            if t == node.place {
                return node.phi;
            }
            let size = if index == 0 || index == last {
                0.5
            } else {
                1.0
            };
            let sign = if index % 2 == 0 { size } else { -size };
            let weight = sign / (t - node.place);
            sum += weight * node.phi;
            weights += weight;
        }
        sum / weights
    }

    /// Inward and outward displacements per unit of relative curvature, for each of the `distances` from the middle of
    /// the contact. A displacement is the sum of two parts: the displacement of a half-space under the same pressure,
    /// and the effect of the rigid core.
    pub(super) fn field(&self, depth: f64, distances: &[f64]) -> Vec<[f64; 2]> {
        let waves = |k: f64| core_effect(k, depth).map(|share| share * self.transform(k));
        let reach = NEGLIGIBLE / (2.0 - depth);
        let effect = sum(reach, 1.0, self.contact, distances, waves);
        let parts = effect.iter().zip(distances);
        parts
            .map(|([normal, radial], r)| {
                let [solid_normal, solid_radial] = self.solid(depth, *r);
                [solid_normal + normal, solid_radial + radial]
            })
            .collect()
    }

    /// Displacements of a half-space under the pressure of this contact. The contribution of each position t in the
    /// contact follows from ∫ cos kt e^{−kz} J₀(kr) dk = Re 1/ρ and ∫ k cos kt e^{−kz} J₁(kr) dk = Re r/ρ³ with ρ² = r²
    /// + (z + it)². Here z is the depth, and r the distance from the middle of the contact.
    fn solid(&self, depth: f64, r: f64) -> [f64; 2] {
        if depth == 0.0 {
            return [abel(|t| self.phi(t), self.contact, r), 0.0];
        }
        around(self.contact, r, depth).fold([0.0; 2], |[normal, radial], [t, weight]| {
            let below = Complex::new(depth, t);
            let root = ComplexField::sqrt(below * below + r * r);
            let cube = root * root * root;
            let phi = weight * self.phi(t);
            [
                normal + phi * (root.inv() + below * depth / cube).re,
                radial + phi * depth * r * cube.inv().re,
            ]
        })
    }
}

/// Wavenumber beyond which the kernel g of the integral equation is negligible.
fn reach() -> f64 {
    0.6 * NEGLIGIBLE
}

fn panel(distance: f64) -> f64 {
    (PHASE / distance).min(1.0)
}

/// The kernel g(k) of the integral equation: the difference between the surface displacements of a half-space and of
/// the layer under the same pressure, divided by the displacement of the half-space.
fn reflected(k: f64) -> f64 {
    let q = libm::exp(-2.0 * k);
    2.0 * q * (1.0 + q + 2.0 * k + 2.0 * k * k) / (1.0 + q * q + 4.0 * k * k * q + 2.0 * q)
}

/// The kernels N (inward displacement) and R (outward displacement) in a layer, minus the kernels of a half-space.
fn core_effect(k: f64, depth: f64) -> [f64; 2] {
    if depth == 0.0 {
        return [-reflected(k), shares(k, 0.0)[1]];
    }
    let [normal, radial] = shares(k, depth);
    let (kz, decay) = (k * depth, libm::exp(-k * depth));
    [normal - (1.0 + kz) * decay, radial - kz * decay]
}

/// The kernels N (inward displacement) and R (outward displacement) in a layer. `h` is the wavenumber, and `x` is the
/// wavenumber times the distance from the core. Every hyperbolic function is multiplied by e^{−h} or e^{−x}, to avoid
/// overflow.
fn shares(k: f64, depth: f64) -> [f64; 2] {
    let (h, x) = (k, k * (1.0 - depth));
    let (q, p) = (libm::exp(-2.0 * h), libm::exp(-2.0 * x));
    let [cosh_h, sinh_h] = [0.5 * (1.0 + q), 0.5 * (1.0 - q)];
    let [cosh_x, sinh_x] = [0.5 * (1.0 + p), 0.5 * (1.0 - p)];
    // With q = e^{−2h} and p = e^{−2x}, the scaled functions satisfy cosh h sinh x − sinh h cosh x = (q − p)/2 and cosh
    // h cosh x − sinh h sinh x = (q + p)/2. The last terms of `normal` and of `radial` use these equations.
    let normal = cosh_h * (sinh_x - x * cosh_x) + h * sinh_h * sinh_x + 0.5 * h * x * (q - p);
    let radial = (h - x) * cosh_h * sinh_x + 0.5 * h * x * (q + p);
    let scale = libm::exp(-h * depth) / (cosh_h * cosh_h + h * h * q);
    [scale * normal, scale * radial]
}
