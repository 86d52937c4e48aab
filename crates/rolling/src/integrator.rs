//! Integrators for systems of differential equations of fixed size. A step does not allocate memory.

mod dop853;

use crate::error::RollFault;

pub(crate) use dop853::Dop853;

/// An autonomous system of `N` ordinary differential equations.
pub(crate) trait System<const N: usize> {
    /// Number of leading components of the state on which the derivative depends. The other components, such as the arc
    /// length, are integrals along the path. They are computed at the end of a step, but not in its intermediate
    /// stages.
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
    /// Time (s) from the start to the last valid state.
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

/// RK4 with a fixed number of equal steps of length h. Its global error is `O(h⁴)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rk4 {
    /// Number of steps. 0 counts as 1.
    pub(crate) steps: usize,
}

impl Rk4 {
    /// Integrates from `state` over `duration_s`.
    ///
    /// # Errors
    /// [`Stopped`] with the last valid state, if a step leaves the domain.
    pub(crate) fn integrate<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        let steps = self.steps.max(1);
        let h = duration_s / steps as f64;
        let mut y = state;
        for step in 0..steps {
            y = one_step(system, &y, h).map_err(|fault| {
                Box::new(Stopped {
                    fault,
                    time_s: h * step as f64,
                    state: y,
                })
            })?;
        }
        Ok(Integrated {
            state: y,
            evaluations: 4 * steps,
        })
    }
}

#[inline]
fn one_step<const N: usize>(
    system: &impl System<N>,
    y: &[f64; N],
    h: f64,
) -> Result<[f64; N], crate::RollFault> {
    let [mut k1, mut k2, mut k3, mut k4] = [[0.0; N]; 4];
    system.derivative(y, &mut k1)?;
    system.derivative(&stage(system, y, h, &[0.5], [&k1]), &mut k2)?;
    system.derivative(&stage(system, y, h, &[0.5], [&k2]), &mut k3)?;
    system.derivative(&stage(system, y, h, &[1.0], [&k3]), &mut k4)?;
    let slopes = [&k1, &k2, &k3, &k4];
    Ok(std::array::from_fn(|i| {
        y[i] + h / 6.0 * weighted(i, &[1.0, 2.0, 2.0, 1.0], &slopes)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RollFault;

    struct Oscillator;

    impl System<2> for Oscillator {
        fn derivative(&self, y: &[f64; 2], rate: &mut [f64; 2]) -> Result<(), RollFault> {
            *rate = [y[1], -y[0]];
            Ok(())
        }
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let error = |steps| {
            let end = Rk4 { steps }
                .integrate(&Oscillator, [0.0, 1.0], 2.0)
                .unwrap();
            (end.state[0] - libm::sin(2.0_f64)).abs()
        };
        let order = libm::log2(error(40) / error(80));
        assert!((order - 4.0).abs() < 0.1, "order {order}");
    }
}
