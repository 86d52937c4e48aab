//! Integrators for systems of differential equations of fixed size. A step does not allocate memory.

mod dop853;
mod rk4;

pub(crate) use dop853::Dop853;
pub(crate) use rk4::Rk4;

use crate::error::RollFault;

/// An autonomous system of `N` ordinary differential equations.
pub(crate) trait System<const N: usize> {
    /// Number of leading components of the state on which the derivative depends. The other components are integrals
    /// along the path; in the states of intermediate stages, they have no meaning.
    const READ: usize = N;

    /// Writes `dy/dt` at `state` to `rate`.
    ///
    /// # Errors
    /// An error if the state is outside of the domain of the equations. The contents of `rate` then have no meaning.
    fn derivative(&self, state: &[f64; N], rate: &mut [f64; N]) -> Result<(), RollFault>;

    /// Factors by which the errors of the state's components are multiplied before they are compared with the
    /// tolerance.
    fn error_weights(&self) -> [f64; N] {
        [1.0; N]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Integrated<const N: usize> {
    pub(crate) state: [f64; N],
    pub(crate) evaluations: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stopped<const N: usize> {
    pub(crate) fault: RollFault,
    /// Time from the start to the last valid state, s.
    pub(crate) time_s: f64,
    /// The last state that was valid.
    pub(crate) state: [f64; N],
}

/// The state `y + h Σ aⱼ kⱼ` of an intermediate stage: y is the state at the start of the step, h the step, and aⱼ the
/// weights of the slopes kⱼ. Only the components that the derivative needs are computed.
///
/// The newest slope is added last, so that the processor can compute the rest of the sum before this slope is
/// available.
#[inline(always)]
fn stage<const N: usize, const T: usize, S: System<N>>(
    _: &S,
    y: &[f64; N],
    h: f64,
    a: &[f64; T],
    k: [&[f64; N]; T],
) -> [f64; N] {
    let mut state = [0.0; N];
    for i in 0..S::READ {
        state[i] = y[i];
        if T > 1 {
            state[i] += h * weighted(i, &a[..T - 1], &k[..T - 1]);
        }
        state[i] += h * a[T - 1] * k[T - 1][i];
    }
    state
}

/// Component `i` of the weighted sum `Σ aⱼ kⱼ` of the slopes kⱼ with the weights aⱼ.
#[inline(always)]
fn weighted<const N: usize>(i: usize, a: &[f64], k: &[&[f64; N]]) -> f64 {
    let mut sum = a[0] * k[0][i];
    for (a, k) in a[1..].iter().zip(&k[1..]) {
        sum += a * k[i];
    }
    sum
}
