//! The classical fourth-order Runge–Kutta method with equal steps.

use super::{Integrated, Stopped, System, stage, weighted};

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
