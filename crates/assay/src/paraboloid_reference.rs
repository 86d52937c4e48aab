//! Displacements under a frictionless rigid paraboloid, computed by quadrature over wavenumbers. They are the reference
//! for `palpate-press`, and do not use the closed-form solutions, series or tables of that crate.
//!
//! The pressure under a contact of radius a has the Hankel transform Q(k) = ∫₀^a φ(t) cos kt dt, where φ is an
//! auxiliary function on the contact area. The relative curvature is C_r. At the depth z and the distance r from the
//! middle of the contact, the inward displacement is C_r ∫ Q N J₀(kr) dk, and the outward displacement is C_r ∫ Q R
//! J₁(kr) dk. Here k is the wavenumber. The kernels N and R depend on the body and its Poisson's ratio ν:
//!
//! | body | N | R |
//! |---|---|---|
//! | half-space | (1 + kz/(2 − 2ν)) e^{−kz} | (kz − 1 + 2ν)/(2 − 2ν) e^{−kz} |
//! | layer on a core, ν = ½ | [(cosh H + H sinh H)(sinh x − x cosh x) + H cosh H x sinh x]/(cosh² H + H²) | ∂N/∂x |
//!
//! For the layer, lengths are in units of its thickness, H is the wavenumber in these units, and x = H(1 − z). Only the
//! difference between layer and half-space is integrated over wavenumbers. The part of the half-space is integrated
//! over the contact area. On a half-space φ = (2/π)(a² − t²); on a layer φ solves the integral equation of the second
//! kind of Lebedev and Ufliand (1958).

mod layer;
mod quadrature;

use std::f64::consts::FRAC_2_PI;

use anyhow::{Result, ensure};

use layer::Layer;
use quadrature::{NEGLIGIBLE, abel, sum};

/// The soft body into which the paraboloid is pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// An elastic half-space.
    HalfSpace {
        /// Poisson's ratio of the half-space.
        poisson: f64,
    },
    /// An incompressible layer bonded to a rigid core.
    Layer {
        /// Thickness of the layer.
        thickness: f64,
    },
}

/// The contact of a paraboloid with a soft body.
#[derive(Debug)]
pub struct ParaboloidPress {
    pressure: Pressure,
    relative_curvature: f64,
}

#[derive(Debug)]
enum Pressure {
    Hertz { poisson: f64, radius: f64 },
    Layer(Layer),
}

impl ParaboloidPress {
    /// The contact of an object that is pressed into the soft body `body`. `relative_curvature` is the sum of the
    /// curvatures of the object and of the body's skin.
    ///
    /// # Errors
    /// An error if the relative curvature or the indentation is not positive, or if the contact with a layer cannot be
    /// solved.
    pub fn new(body: Body, relative_curvature: f64, indentation: f64) -> Result<Self> {
        ensure!(
            relative_curvature > 0.0 && indentation > 0.0,
            "relative curvature and indentation must be > 0, but are {relative_curvature:e} and {indentation:e}"
        );
        let area = indentation / relative_curvature;
        let pressure = match body {
            Body::HalfSpace { poisson } => Pressure::Hertz {
                poisson,
                radius: area.sqrt(),
            },
            Body::Layer { thickness } => Pressure::Layer(Layer::at_indentation(thickness, area)?),
        };
        Ok(Self {
            pressure,
            relative_curvature,
        })
    }

    /// Radius of the contact area.
    pub fn radius(&self) -> f64 {
        match &self.pressure {
            Pressure::Hertz { radius, .. } => *radius,
            Pressure::Layer(layer) => layer.contact * layer.thickness,
        }
    }

    /// Inward and outward displacements of the body at the depth `depth`. There is one pair of displacements for each
    /// of the `distances` from the middle of the contact.
    ///
    /// # Errors
    /// An error at the surface of a compressible half-space, because the integral over wavenumbers does not converge
    /// there.
    pub fn displacements(&self, depth: f64, distances: &[f64]) -> Result<Vec<[f64; 2]>> {
        let (unit, at): (f64, Vec<[f64; 2]>) = match &self.pressure {
            Pressure::Hertz { poisson, radius } => {
                ensure!(
                    depth > 0.0 || *poisson == 0.5,
                    "the integral over wavenumbers does not converge at the surface of a compressible half-space"
                );
                (
                    self.relative_curvature,
                    hertz(*poisson, *radius, depth, distances),
                )
            }
            Pressure::Layer(layer) => {
                let unit = self.relative_curvature * layer.thickness * layer.thickness;
                let scaled: Vec<f64> = distances.iter().map(|r| r / layer.thickness).collect();
                (unit, layer.field(depth / layer.thickness, &scaled))
            }
        };
        Ok(at
            .iter()
            .map(|parts| parts.map(|part| unit * part))
            .collect())
    }
}

/// Largest difference between the displacements `found` and the true displacements `truth`, divided by the largest true
/// displacement.
pub fn largest_error(found: &[[f64; 2]], truth: &[[f64; 2]]) -> f64 {
    let pairs = truth.iter().flatten().zip(found.iter().flatten());
    let off = pairs.fold(0.0, |most: f64, (truth, one)| most.max((one - truth).abs()));
    let sizes = truth.iter().flatten();
    off / sizes.fold(0.0, |most: f64, one| most.max(one.abs()))
}

fn hertz(poisson: f64, a: f64, depth: f64, distances: &[f64]) -> Vec<[f64; 2]> {
    if depth == 0.0 {
        let phi = |t: f64| FRAC_2_PI * (a * a - t * t);
        return distances.iter().map(|r| [abel(phi, a, *r), 0.0]).collect();
    }
    let share = 0.5 / (1.0 - poisson);
    let waves = |k: f64| {
        let (kz, decay) = (k * depth, libm::exp(-k * depth));
        let transform = 2.0 * FRAC_2_PI * a.powi(3) * hump(k * a);
        let part = |part: f64| transform * decay * part;
        [
            part(1.0 + share * kz),
            part(share * (kz - 1.0 + 2.0 * poisson)),
        ]
    };
    sum(NEGLIGIBLE / depth, 1.0 / depth, a, distances, waves)
}

fn hump(x: f64) -> f64 {
    if x > 0.5 {
        return (libm::sin(x) - x * libm::cos(x)) / (x * x * x);
    }
    let s = x * x;
    let terms = [
        1.0 / 3.0,
        -1.0 / 30.0,
        1.0 / 840.0,
        -1.0 / 45_360.0,
        1.0 / 3_991_680.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| sum * s + term)
}
