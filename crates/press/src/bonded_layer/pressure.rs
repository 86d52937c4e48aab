//! Computes the pressure of a frictionless rigid paraboloid on a layer from the contact's radius.
//!
//! Lengths are in units of the layer's thickness, and displacements are for a relative curvature of 1. α is the
//! contact's radius, and D is the indentation. The Hankel transform of the pressure is written as Q(k) = ∫₀^α φ(t)
//! cos(kt) dt with a function φ. The pressure is then zero beyond α. The condition that the displacement within the
//! contact is D − r²/2 becomes a Fredholm equation of the second kind for φ (Copson's method; Lebedev and Ufliand
//! 1958):
//!
//! ```text
//! φ(t) − (2/π) ∫₀^α φ(s) ∫₀^∞ g(k) cos kt cos ks dk ds = (2/π)(D − t²)
//! ```
//!
//! with g of [`reflection::at_surface`](super::reflection::at_surface). The equation is solved at Gauss nodes for the
//! right-hand sides 1 and t². The indentation D follows from the condition that the pressure is zero at the edge, φ(α)
//! = 0. If the contact becomes wider, the pressure of a flat punch is added: ∂φ/∂α = (2/π) D' φ₁, where φ₁ is the
//! solution for the right-hand side 1. From φ(α) = 0 for the wider contact follows D' = −(π/2) φ'(α)/φ₁(α).

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use std::num::NonZeroUsize;

use gauss_quad::GaussLegendre;
use nalgebra::{DMatrix, DVector};

use super::pressure_field::Term;
use super::reflection;
use crate::PressError;

/// Smallest number of wavenumbers in a quadrature. It is sufficient for an integrand that decays smoothly and does not
/// oscillate.
const SMOOTH: f64 = 48.0;
/// Threshold for rounding errors. The last coefficients of a series are discarded if their ratio to the largest
/// coefficient is below this value.
const ROUNDING: f64 = 3e-14;

/// Pressure of a contact on a bonded layer: the solution of the integral equation for one contact radius.
#[derive(Clone, Debug)]
pub(super) struct Pressure {
    /// Radius α of the contact.
    pub(super) contact: f64,
    /// Indentation for a relative curvature of 1. The unit of length is the thickness of the layer.
    pub(super) indentation: f64,
    /// Derivative of the indentation with respect to the contact's radius.
    pub(super) slope: f64,
    /// ∫ φ dt, which is the force divided by π E* C_r, with the effective modulus E* and the relative curvature C_r.
    pub(super) force: f64,
    /// −∫ φ'/t dt, which is the pressure in the middle of the contact divided by E* C_r/2, with the effective modulus
    /// E* and the relative curvature C_r.
    pub(super) peak: f64,
    /// Coefficients of two series of Legendre polynomials: of φ, the function that describes the pressure, and of
    /// ∂φ/∂α.
    pub(super) terms: Vec<Term>,
    /// Quadrature nodes t of the function φ that describes the pressure. Each entry contains t, φ(t) and ∂φ/∂α; both
    /// function values are multiplied by the weight of the node.
    nodes: Vec<[f64; 3]>,
}

impl Pressure {
    /// Solves the equations for a contact with the radius `contact`. If `resolution` is 1, the relative error is about
    /// 1e-11, and neighbouring quadrature nodes are less than half the thickness apart.
    pub(super) fn solve(contact: f64, resolution: f64) -> Result<Self, PressError> {
        palpate_statistics::work::solved_layer(1);
        let count = (resolution * (16.0 + 5.0 * contact)).ceil() as usize;
        let shares = positive_gauss(count);
        let waves = wavenumbers(reflection::SURFACE_REACH, 2.0 * contact, resolution);
        // Multiply the rows and columns of the matrix by the square roots of the quadrature weights, which makes the
        // matrix symmetric. The matrix is positive definite, because the relative effect g of the rigid base
        // (`reflection::at_surface`) is less than 1 at every wavenumber.
        let ripples = DMatrix::from_fn(count, waves.len(), |row, column| {
            let ([share, weight], [k, dk]) = (shares[row], waves[column]);
            let strength = FRAC_2_PI * contact * weight * dk * reflection::at_surface(k);
            strength.sqrt() * libm::cos(k * contact * share)
        });
        let mut matrix = DMatrix::identity(count, count);
        for ripple in ripples.column_iter() {
            // Only the lower triangle is computed, because the Cholesky factorisation needs no more.
            matrix.syger(-1.0, &ripple, &ripple, 1.0);
        }
        let solved = matrix.cholesky().ok_or(PressError::OutOfRange)?;
        let solve = |right: fn(f64) -> f64| {
            let weighted = shares
                .iter()
                .map(|[share, weight]| weight.sqrt() * right(*share));
            let solution = solved.solve(&DVector::from_iterator(count, weighted));
            let values = solution.iter().zip(&shares);
            values
                .map(|(value, [_, weight])| value / weight.sqrt())
                .collect::<Vec<_>>()
        };
        let (ones, squares) = (solve(|_| 1.0), solve(|share| share * share));
        Ok(Self::assemble(contact, &shares, &ones, &squares))
    }

    fn assemble(contact: f64, shares: &[[f64; 2]], ones: &[f64], squares: &[f64]) -> Self {
        let (one, square) = (legendre(shares, ones), legendre(shares, squares));
        let edge: f64 = one.iter().sum();
        // `indentation` is the ratio of the indentation to the squared contact radius.
        let indentation = square.iter().sum::<f64>() / edge;
        let unit = contact * contact;
        let values: Vec<f64> = ones
            .iter()
            .zip(squares)
            .map(|(one, square)| FRAC_2_PI * (indentation * one - square))
            .collect();
        let scaled = legendre(shares, &values);
        // The slope of the solution φ at the edge of the contact follows from P_n'(1) = n(n+1)/2 for the Legendre
        // polynomials P_n.
        let edge_slope: f64 = scaled
            .iter()
            .enumerate()
            .map(|(j, c)| c * (j * (2 * j + 1)) as f64)
            .sum();
        let slope = -FRAC_PI_2 * edge_slope / edge * contact;
        let nodes = shares.iter().zip(&values).zip(ones);
        Self {
            contact,
            indentation: indentation * unit,
            slope,
            force: scaled[0] * unit * contact,
            peak: contact * middle(&scaled),
            terms: terms(&scaled, unit, &one, FRAC_2_PI * slope),
            nodes: nodes
                .map(|(([share, weight], value), one)| {
                    [
                        contact * share,
                        contact * weight * unit * value,
                        contact * weight * FRAC_2_PI * slope * one,
                    ]
                })
                .collect(),
        }
    }

    /// The Hankel transform Q(k) of the pressure at the wavenumber k, and its derivative ∂Q/∂α.
    pub(super) fn transform(&self, k: f64) -> [f64; 2] {
        self.nodes
            .iter()
            .fold([0.0; 2], |[curved, flat], [t, phi, per_contact]| {
                let wave = libm::cos(k * t);
                [curved + phi * wave, flat + per_contact * wave]
            })
    }
}

/// A value that is proportional to the pressure in the middle of a contact of radius 1. The function φ(t) of the contact
/// is a series of the even Legendre polynomials P_n (n = 2j) on [0, 1], with the coefficients `coefficients`; φ jumps to 0
/// at t = 1. The value is −∫ φ'/t dt over [0, 1], including the jump. It is the sum of the coefficients, each multiplied
/// by a weight. The weight is 1 for j = 0 (a flat punch), −2 for j = 1, and (−1)ʲ n (2/3)(4/5) ⋯ ((n−2)/(n−1)) for j ≥ 2.
fn middle(coefficients: &[f64]) -> f64 {
    let (mut product, mut sign) = (1.0, -1.0);
    let mut sum = coefficients[0];
    for (j, coefficient) in coefficients.iter().enumerate().skip(1) {
        let n = 2.0 * j as f64;
        sum += sign * coefficient * n * product;
        product *= n / (n + 1.0);
        sign = -sign;
    }
    sum
}

/// The positive nodes of the Gauss–Legendre rule with 2 `count` nodes on [−1, 1], with their weights. For even
/// functions, the positive half of the nodes is enough.
fn positive_gauss(count: usize) -> Vec<[f64; 2]> {
    let degree = NonZeroUsize::new(2 * count).expect("the contact has at least one node");
    let rule = GaussLegendre::new(degree);
    rule.iter()
        .filter(|(node, _)| *node > 0.0)
        .map(|(node, weight)| [*node, *weight])
        .collect()
}

/// Nodes and weights of a quadrature over the wavenumbers from 0 to `reach`. The integrand is a smooth decaying
/// function, multiplied by a Bessel function of the product of wavenumber and distance. The integrals are accurate for
/// distances up to `distance`.
pub(super) fn wavenumbers(reach: f64, distance: f64, resolution: f64) -> Vec<[f64; 2]> {
    let count = (resolution * (0.27 * reach * distance + SMOOTH)).ceil() as usize;
    let degree = NonZeroUsize::new(count).expect("the contact has at least one node");
    let half = 0.5 * reach;
    let rule = GaussLegendre::new(degree);
    rule.iter()
        .map(|(node, weight)| [half * (node + 1.0), half * weight])
        .collect()
}

/// Coefficients of the Legendre polynomials P₀, P₂, … for an even function, computed from its values at the nodes of
/// [`positive_gauss`].
fn legendre(shares: &[[f64; 2]], values: &[f64]) -> Vec<f64> {
    let mut coefficients = vec![0.0; shares.len()];
    for ([share, weight], value) in shares.iter().zip(values) {
        let (mut before, mut here) = (0.0, 1.0);
        for (j, coefficient) in coefficients.iter_mut().enumerate() {
            let n = 2.0 * j as f64;
            *coefficient += weight * value * (2.0 * n + 1.0) * here;
            let odd = ((2.0 * n + 1.0) * share * here - n * before) / (n + 1.0);
            let even = ((2.0 * n + 3.0) * share * odd - (n + 1.0) * here) / (n + 2.0);
            (before, here) = (odd, even);
        }
    }
    let largest = coefficients
        .iter()
        .fold(0.0_f64, |largest, c| largest.max(c.abs()));
    let kept = coefficients
        .iter()
        .rposition(|c| c.abs() > ROUNDING * largest);
    coefficients.truncate(kept.map_or(1, |last| last + 1));
    coefficients
}

/// Combines two series of Legendre polynomials into one list of terms: `curved`, the series of φ, and `flat`, the
/// series of ∂φ/∂a. The coefficient j of a series is multiplied by the factor of this series and by (−1)ʲ.
fn terms(curved: &[f64], curved_factor: f64, flat: &[f64], flat_factor: f64) -> Vec<Term> {
    let at = |series: &[f64], j: usize| series.get(j).copied().unwrap_or(0.0);
    let count = curved.len().max(flat.len());
    let terms = (0..count).map(|j| {
        let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
        [
            sign * curved_factor * at(curved, j),
            sign * flat_factor * at(flat, j),
        ]
    });
    terms.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_nodes_change_nothing() {
        for (contact, tolerance) in [
            (1e-9, 1e-11),
            (0.1, 1e-11),
            (1.0, 1e-11),
            (6.0, 1e-10),
            (12.0, 1e-9),
            (50.0, 1e-8),
        ] {
            let numbers = |finer| {
                let solved = Pressure::solve(contact, finer).expect("a solvable contact");
                [
                    solved.indentation,
                    solved.force,
                    solved.peak,
                    solved.transform(1.7 / contact)[0],
                ]
            };
            for (coarse, fine) in numbers(1.0).into_iter().zip(numbers(1.7)) {
                assert!(
                    (coarse / fine - 1.0).abs() < tolerance,
                    "{contact}: {coarse} {fine}"
                );
            }
        }
    }
}
