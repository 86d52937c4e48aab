//! The contact with a bonded layer, lengths in units of its thickness.
//!
//! ```text
//! φ(t) − (2/π) ∫₀^α φ(s) ∫₀^∞ g(k) cos kt cos ks dk ds = (2/π)(D − t²),   φ(α) = 0
//! ```
//!
//! with g = 1 − (sinh 2k − 2k)/(cosh 2k + 2k² + 1).

use std::f64::consts::FRAC_2_PI;

use anyhow::{Context, Result, bail};
use nalgebra::{DMatrix, DVector};

use super::quadrature::{on_panels, over};
use super::{NEGLIGIBLE, PHASE, abel, sum};

/// Steps of the secant method, which takes eight or so.
const MOST_STEPS: usize = 60;

/// A contact.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) thickness: f64,
    /// Radius of the contact, α.
    pub(super) contact: f64,
    /// The indentation over the relative curvature, D.
    indentation: f64,
    /// Nodes t, and φ there times their weights.
    nodes: Vec<[f64; 2]>,
}

impl Layer {
    /// The contact of this D, in units of length.
    pub(super) fn pressed(thickness: f64, indentation_over_curvature: f64) -> Result<Self> {
        let wanted = indentation_over_curvature / (thickness * thickness);
        let solve = |contact: f64| Self::solved(thickness, contact);
        // Logarithms of D and α lie almost on a line.
        let [mut before, mut here] = [solve(wanted.sqrt())?, solve(1.2 * wanted.sqrt())?];
        for _ in 0..MOST_STEPS {
            let slope =
                (here.contact / before.contact).ln() / (here.indentation / before.indentation).ln();
            let missing = (wanted / here.indentation).ln();
            if missing.abs() < 1e-14 || !slope.is_finite() {
                return Ok(here);
            }
            let next = solve(here.contact * (slope * missing).exp())?;
            before = std::mem::replace(&mut here, next);
        }
        match (here.indentation / wanted - 1.0).abs() {
            off if off < 1e-12 => Ok(here),
            off => bail!("no contact with D = {wanted:e}: off by {off:e}"),
        }
    }

    fn solved(thickness: f64, contact: f64) -> Result<Self> {
        let intervals = 2 * (10.0 + 4.0 * contact).ceil() as usize;
        let places: Vec<[f64; 2]> = over(0.0, contact, intervals).collect();
        let waves: Vec<[f64; 2]> = on_panels(reach(), panel(2.0 * contact)).collect();
        let cosines = DMatrix::from_fn(places.len(), waves.len(), |row, column| {
            (waves[column][0] * places[row][0]).cos()
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
        let nodes = places.iter().zip(phi.iter());
        Ok(Self {
            thickness,
            contact,
            indentation,
            nodes: nodes.map(|([t, weight], phi)| [*t, weight * phi]).collect(),
        })
    }

    /// Q(k).
    fn transform(&self, k: f64) -> f64 {
        self.nodes.iter().map(|[t, phi]| phi * (k * t).cos()).sum()
    }

    /// Displacements inward and outward per unit relative curvature.
    pub(super) fn field(&self, depth: f64, distances: &[f64]) -> Vec<[f64; 2]> {
        if depth > 0.0 {
            let waves = |k: f64| shares(k, depth).map(|share| share * self.transform(k));
            return sum(NEGLIGIBLE / depth, 1.0, self.contact, distances, waves);
        }
        // The half-space's share does not decay; what the core takes from it does.
        let waves = |k: f64| {
            let transform = self.transform(k);
            [-reflected(k) * transform, shares(k, 0.0)[1] * transform]
        };
        let phi: Vec<[f64; 2]> = on_panels(reach(), panel(2.0 * self.contact))
            .map(|[k, weight]| [k, weight * reflected(k) * self.transform(k)])
            .collect();
        let phi = |t: f64| {
            let echo: f64 = phi.iter().map(|[k, echo]| echo * (k * t).cos()).sum();
            FRAC_2_PI * (self.indentation - t * t + echo)
        };
        let taken = sum(reach(), 1.0, self.contact, distances, waves);
        let taken = taken.iter().zip(distances);
        taken
            .map(|([normal, radial], r)| [abel(phi, self.contact, *r) + normal, *radial])
            .collect()
    }
}

/// Where g ends.
fn reach() -> f64 {
    0.6 * NEGLIGIBLE
}

fn panel(distance: f64) -> f64 {
    (PHASE / distance).min(1.0)
}

/// g: the share of a half-space's surface that the core takes.
fn reflected(k: f64) -> f64 {
    let q = (-2.0 * k).exp();
    2.0 * q * (1.0 + q + 2.0 * k + 2.0 * k * k) / (1.0 + q * q + 4.0 * k * k * q + 2.0 * q)
}

/// N and R: e^{H} and e^{x} taken out of every hyperbolic function.
fn shares(k: f64, depth: f64) -> [f64; 2] {
    let (h, x) = (k, k * (1.0 - depth));
    let (q, p) = ((-2.0 * h).exp(), (-2.0 * x).exp());
    let [cosh_h, sinh_h] = [0.5 * (1.0 + q), 0.5 * (1.0 - q)];
    let [cosh_x, sinh_x] = [0.5 * (1.0 + p), 0.5 * (1.0 - p)];
    // cosh H sinh x − sinh H cosh x = (q − p)/2 and cosh H cosh x − sinh H sinh x = (q + p)/2.
    let normal = cosh_h * (sinh_x - x * cosh_x) + h * sinh_h * sinh_x + 0.5 * h * x * (q - p);
    let radial = (h - x) * cosh_h * sinh_x + 0.5 * h * x * (q + p);
    let scale = (-h * depth).exp() / (cosh_h * cosh_h + h * h * q);
    [scale * normal, scale * radial]
}
