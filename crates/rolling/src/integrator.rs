//! Integrators of fixed size, without allocation in a step.

mod dop853;
mod rk4;

pub use dop853::{Dop853,STEPS};
pub use rk4::Rk4;

use crate::error::RollFault;

/// An autonomous system of `N` ordinary differential equations.
pub trait System<const N: usize> {
    /// How many of the leading components the derivative reads. The others are integrals along the
    /// way, which are not combined at every stage: there they mean nothing.
    const READ: usize = N;

    /// Writes `dy/dt` at `state` to `rate`.
    ///
    /// # Errors
    /// Where the state has left the domain of the equations; `rate` then means nothing.
    fn derivative(&self, state: &[f64; N], rate: &mut [f64; N]) -> Result<(), RollFault>;

    /// What an error in each component is multiplied by before it is compared with the tolerance.
    fn error_weights(&self) -> [f64; N] {
        [1.0; N]
    }
}

/// What an integration reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrated<const N: usize> {
    /// The state at the end.
    pub state: [f64; N],
    /// How often the derivative was asked for.
    pub evaluations: usize,
}

/// An integration that could not go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped<const N: usize> {
    /// Why.
    pub fault: RollFault,
    /// Time since the start.
    pub time_s: f64,
    /// The last good state.
    pub state: [f64; N],
}

/// `y + h Σ aᵢ kᵢ` in the leading components, as many as the derivative reads.
#[inline(always)]
fn stage<const N: usize, const T: usize, S: System<N>>(
    _system: &S,
    y: &[f64; N],
    h: f64,
    terms: [(f64, &[f64; N]); T],
) -> [f64; N] {
    let mut state = [0.0; N];
    for i in 0..S::READ {
        state[i] = y[i] + h * weighted(i, terms);
    }
    state
}

/// `Σ aᵢ kᵢ` in one component.
#[inline(always)]
fn weighted<const N: usize, const T: usize>(i: usize, terms: [(f64, &[f64; N]); T]) -> f64 {
    let (a, k) = terms[0];
    let mut sum = a * k[i];
    for (a, k) in &terms[1..] {
        sum += a * k[i];
    }
    sum
}
