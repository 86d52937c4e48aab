//! Dormand and Prince's method of order 8, with error estimates of order 5 and 3.
//!
//! Coefficients and error estimate after Hairer, Nørsett and Wanner, *Solving Ordinary Differential
//! Equations I*, second edition, section II.5 and the program DOP853.

// Keep the published digits, although a double does not store all of them.
#![allow(clippy::excessive_precision)]

use super::{Integrated, Stopped, System, stage, weighted};
use crate::RollFault;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dop853 {
    /// Largest accepted local error of a step: the root mean square of the weighted errors of the state's components.
    pub(crate) tolerance: f64,
    /// Largest number of steps, including rejected steps, after which the integration fails.
    pub(crate) most_steps: usize,
}

/// Determines the length of the first step. The first step changes the state by about this number times the eighth root
/// of the tolerance. The change of the state is the root mean square of the weighted changes of its components.
const FIRST_CHANGE: f64 = 2.0;
/// Safety factor: the next step is this factor times the longest step that the error estimate allows.
const SAFETY: f64 = 0.8;
const SHRINK: f64 = 1.0 / 3.0;
const GROW: f64 = 6.0;
/// If fewer than this number of steps remain until the end of a motion, these steps are made equally long.
const LAST_FEW: f64 = 3.0;
/// Smallest allowed step, relative to the time since the start of the motion.
const SHORTEST: f64 = 1e-12;
/// Smallest allowed step, relative to the duration of the motion. The larger of this limit and [`SHORTEST`] applies.
const SHORTEST_OF_ALL: f64 = 1e-18;

impl Dop853 {
    /// Integrates from `state` over `duration_s`.
    ///
    /// If a step leaves the domain of the system, its end time becomes a barrier, and the next step is half as long. No
    /// step goes beyond the barrier, and the first step that reaches the barrier removes it. If the steps become
    /// shorter than 1e-12 of the elapsed time before the barrier is reached, the fault that created the barrier is
    /// returned.
    ///
    /// # Errors
    /// [`Stopped`] with the last valid state.
    pub(crate) fn integrate<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        let weights = system.error_weights();
        let mut y = state;
        let mut time_s = 0.0;
        let mut slopes = [[0.0; N]; 12];
        let stopped = |fault, time_s, state| {
            Box::new(Stopped {
                fault,
                time_s,
                state,
            })
        };
        system
            .derivative(&y, &mut slopes[0])
            .map_err(|fault| stopped(fault, time_s, y))?;
        let mut evaluations = 1;
        let mut barrier: Option<(f64, RollFault)> = None;
        let mut h = self.first_step(&slopes[0], &weights, duration_s);
        if h.is_nan() || h == 0.0 {
            return Err(stopped(RollFault::NotFinite, time_s, y));
        }
        let mut grow = GROW;
        for _ in 0..self.most_steps {
            let goal = barrier.map_or(duration_s, |(time_s, _)| time_s);
            let ahead = goal - time_s;
            let reaches = h >= ahead * (1.0 - 1e-12);
            if reaches {
                h = ahead;
            } else if LAST_FEW * h > ahead {
                h = ahead / (ahead / h).ceil();
            }
            evaluations += 11;
            let tried = stages(system, &y, h, &mut slopes);
            let (end, square_error) = end_of_step(&y, h, &slopes, &weights);
            // `excess` is the square of the ratio of error to tolerance.
            let excess = square_error / (self.tolerance * self.tolerance);
            let fault = match tried {
                Err(fault) => Some(fault),
                Ok(()) if !accepts(excess) => {
                    h *= factor(excess, 1.0);
                    None
                }
                Ok(()) if reaches && goal >= duration_s => {
                    let state = end;
                    return Ok(Integrated { state, evaluations });
                }
                Ok(()) => {
                    evaluations += 1;
                    match system.derivative(&end, &mut slopes[0]) {
                        Ok(()) => {
                            y = end;
                            time_s += h;
                            if reaches {
                                time_s = goal;
                                barrier = None;
                            }
                            h *= factor(excess, grow);
                            grow = GROW;
                            continue;
                        }
                        Err(fault) => {
                            // The step failed, so the integration continues from the last valid state. The slope at
                            // this state was overwritten, so compute it again.
                            evaluations += 1;
                            system
                                .derivative(&y, &mut slopes[0])
                                .map_err(|fault| stopped(fault, time_s, y))?;
                            Some(fault)
                        }
                    }
                }
            };
            if let Some(fault) = fault {
                barrier = Some((time_s + h, fault));
                h *= 0.5;
            }
            grow = 1.0;
            if h <= (SHORTEST * time_s).max(SHORTEST_OF_ALL * duration_s) {
                let fault = barrier.map_or(RollFault::Singular, |(_, fault)| fault);
                return Err(stopped(fault, time_s, y));
            }
        }
        let steps = self.most_steps;
        Err(stopped(RollFault::TooManySteps { steps }, time_s, y))
    }

    fn first_step<const N: usize>(
        &self,
        slope: &[f64; N],
        weights: &[f64; N],
        duration_s: f64,
    ) -> f64 {
        let change = (square(slope, weights, duration_s) / N as f64).sqrt();
        let eighth_root = inverse_sixteenth_root(1.0 / (self.tolerance * self.tolerance));
        FIRST_CHANGE * eighth_root / change * duration_s
    }
}

/// Whether a step is accepted. `excess` is the squared error of the step divided by the squared tolerance. The result
/// is false for NaN.
fn accepts(excess: f64) -> bool {
    excess <= 1.0
}

/// Ratio of the next step's length to that of the current step; `most` is the largest allowed ratio. `excess` is the
/// squared error of the current step divided by the squared tolerance.
#[inline]
fn factor(excess: f64, most: f64) -> f64 {
    (SAFETY * inverse_sixteenth_root(excess)).clamp(SHRINK, most)
}

/// `x^(−1/16)` for `x >= 0`, within 7 %. This accuracy is enough for a step size. Exact roots take so long that they
/// would delay the next step. The function is faster, because it uses a property of doubles: the bits, read as an
/// integer, are nearly a linear function of the logarithm. The result is tiny for infinity and NaN.
#[inline]
fn inverse_sixteenth_root(x: f64) -> f64 {
    let one = 1.0_f64.to_bits();
    f64::from_bits(one + one / 16 - x.to_bits() / 16)
}

/// The slopes at the start of a step and at its eleven further stages.
type Slopes<const N: usize> = [[f64; N]; 12];

#[inline]
fn stages<const N: usize>(
    system: &impl System<N>,
    y: &[f64; N],
    h: f64,
    slopes: &mut Slopes<N>,
) -> Result<(), RollFault> {
    let [k1, k2, k3, k4, k5, k6, k7, k8, k9, k10, k11, k12] = slopes;
    system.derivative(&stage(system, y, h, &A2, [k1]), k2)?;
    system.derivative(&stage(system, y, h, &A3, [&*k1, k2]), k3)?;
    system.derivative(&stage(system, y, h, &A4, [&*k1, k3]), k4)?;
    system.derivative(&stage(system, y, h, &A5, [&*k1, k3, k4]), k5)?;
    system.derivative(&stage(system, y, h, &A6, [&*k1, k4, k5]), k6)?;
    system.derivative(&stage(system, y, h, &A7, [&*k1, k4, k5, k6]), k7)?;
    system.derivative(&stage(system, y, h, &A8, [&*k1, k4, k5, k6, k7]), k8)?;
    system.derivative(&stage(system, y, h, &A9, [&*k1, k4, k5, k6, k7, k8]), k9)?;
    system.derivative(
        &stage(system, y, h, &A10, [&*k1, k4, k5, k6, k7, k8, k9]),
        k10,
    )?;
    system.derivative(
        &stage(system, y, h, &A11, [&*k1, k4, k5, k6, k7, k8, k9, k10]),
        k11,
    )?;
    system.derivative(
        &stage(system, y, h, &A12, [&*k1, k4, k5, k6, k7, k8, k9, k10, k11]),
        k12,
    )
}

/// The state after the step, and the squared error of the step. The error of each weighted component combines the error
/// estimates of orders 5 and 3 by Hairer's formula. The squared error is the mean square of these errors over the
/// components.
#[inline]
fn end_of_step<const N: usize>(
    y: &[f64; N],
    h: f64,
    slopes: &Slopes<N>,
    weights: &[f64; N],
) -> ([f64; N], f64) {
    let [k1, _, _, _, _, k6, k7, k8, k9, k10, k11, k12] = slopes;
    let mut end = *y;
    let (mut fifth, mut third) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        let slope = weighted(i, &B, &[k1, k6, k7, k8, k9, k10, k11, k12]);
        end[i] += h * slope;
        fifth[i] = weighted(i, &E5, &[k1, k6, k7, k8, k9, k10, k11, k12]);
        third[i] = slope - weighted(i, &B3, &[k1, k9, k12]);
    }
    let (fifth, third) = (square(&fifth, weights, h), square(&third, weights, h));
    let blend = fifth + 0.01 * third;
    // If both error estimates are 0, `blend` is 0. If a slope is not finite, `blend` is NaN, and the result must be NaN
    // too.
    let share = if blend > 0.0 { fifth / blend } else { blend };
    (end, fifth * share / N as f64)
}

/// Sum of (h · weight · slope)² over all components, where `h` is the length of the step.
#[inline]
fn square<const N: usize>(slope: &[f64; N], weights: &[f64; N], h: f64) -> f64 {
    slope
        .iter()
        .zip(weights)
        .map(|(slope, weight)| (h * weight * slope).powi(2))
        .sum()
}

// The constant A2 contains the weights of the earlier slopes in stage 2, A3 those in stage 3, and so on. Zero weights
// are left out.
const A2: [f64; 1] = [0.0526001519587677318785587544488];
const A3: [f64; 2] = [
    0.0197250569845378994544595329183,
    0.0591751709536136983633785987549,
];
const A4: [f64; 2] = [
    0.0295875854768068491816892993775,
    0.0887627564304205475450678981324,
];
const A5: [f64; 3] = [
    0.241365134159266685502369798665,
    -0.884549479328286085344864962717,
    0.924834003261792003115737966543,
];
const A6: [f64; 3] = [
    0.037037037037037037037037037037,
    0.170828608729473871279604482173,
    0.125467687566822425016691814123,
];
const A7: [f64; 4] = [
    0.037109375,
    0.170252211019544039314978060272,
    0.0602165389804559606850219397283,
    -0.017578125,
];
const A8: [f64; 5] = [
    0.0370920001185047927108779319836,
    0.170383925712239993810214054705,
    0.107262030446373284651809199168,
    -0.0153194377486244017527936158236,
    0.00827378916381402288758473766002,
];
const A9: [f64; 6] = [
    0.624110958716075717114429577812,
    -3.36089262944694129406857109825,
    -0.868219346841726006818189891453,
    27.5920996994467083049415600797,
    20.1540675504778934086186788979,
    -43.4898841810699588477366255144,
];
const A10: [f64; 7] = [
    0.477662536438264365890433908527,
    -2.48811461997166764192642586468,
    -0.590290826836842996371446475743,
    21.2300514481811942347288949897,
    15.2792336328824235832596922938,
    -33.2882109689848629194453265587,
    -0.0203312017085086261358222928593,
];
const A11: [f64; 8] = [
    -0.93714243008598732571704021658,
    5.18637242884406370830023853209,
    1.09143734899672957818500254654,
    -8.14978701074692612513997267357,
    -18.5200656599969598641566180701,
    22.7394870993505042818970056734,
    2.49360555267965238987089396762,
    -3.0467644718982195003823669022,
];
const A12: [f64; 9] = [
    2.27331014751653820792359768449,
    -10.5344954667372501984066689879,
    -2.00087205822486249909675718444,
    -17.9589318631187989172765950534,
    27.9488845294199600508499808837,
    -2.85899827713502369474065508674,
    -8.87285693353062954433549289258,
    12.3605671757943030647266201528,
    0.643392746015763530355970484046,
];
/// Weights of the slopes 1 and 6 to 12 (of 12) in the mean slope, which moves the state to the end of a step. With
/// these weights, the method is of order 8.
const B: [f64; 8] = [
    0.0542937341165687622380535766363,
    4.45031289275240888144113950566,
    1.89151789931450038304281599044,
    -5.8012039600105847814672114227,
    0.31116436695781989440891606237,
    -0.152160949662516078556178806805,
    0.201365400804030348374776537501,
    0.0447106157277725905176885569043,
];
/// Weights of slopes 1 and 6 to 12 in the difference between the mean slopes of order 8 and order 5.
const E5: [f64; 8] = [
    0.01312004499419488073250102996,
    -1.225156446376204440720569753,
    -0.4957589496572501915214079952,
    1.664377182454986536961530415,
    -0.3503288487499736816886487290,
    0.3341791187130174790297318841,
    0.08192320648511571246570742613,
    -0.02235530786388629525884427845,
];
/// Weights of slopes 1, 9 and 12 in the mean slope of order 3.
const B3: [f64; 3] = [
    0.244094488188976377952755905512,
    0.733846688281611857341361741547,
    0.0220588235294117647058823529412,
];

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    struct Oscillator;

    impl System<2> for Oscillator {
        fn derivative(&self, y: &[f64; 2], rate: &mut [f64; 2]) -> Result<(), RollFault> {
            *rate = [y[1], -y[0]];
            Ok(())
        }
    }

    /// A system whose derivative is constant, and undefined beyond the position `wall`. It counts the evaluations of
    /// the derivative.
    struct Wall<'a> {
        wall: f64,
        asked: &'a Cell<usize>,
    }

    impl System<1> for Wall<'_> {
        fn derivative(&self, y: &[f64; 1], rate: &mut [f64; 1]) -> Result<(), RollFault> {
            self.asked.set(self.asked.get() + 1);
            *rate = [1.0];
            if y[0] <= self.wall {
                Ok(())
            } else {
                Err(RollFault::NotFinite)
            }
        }
    }

    fn solver(tolerance: f64) -> Dop853 {
        Dop853 {
            tolerance,
            most_steps: 10_000,
        }
    }

    #[test]
    fn meets_its_tolerance() {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let end = solver(tolerance)
                .integrate(&Oscillator, [0.0, 1.0], 10.0)
                .unwrap();
            let error = (end.state[0] - libm::sin(10.0_f64)).abs();
            assert!(error < 20.0 * tolerance, "{tolerance}: {error}");
        }
    }

    #[test]
    fn one_step_is_of_eighth_order() {
        let error = |h: f64| {
            let end = solver(f64::INFINITY)
                .integrate(&Oscillator, [0.0, 1.0], h)
                .unwrap();
            (end.state[0] - libm::sin(h)).abs()
        };
        let order = libm::log2(error(1.0) / error(0.5));
        assert!(order > 8.5, "local order {order}");
    }

    #[test]
    fn a_fault_is_located() {
        for wall in [1e-6, 1.0, 9.999] {
            let asked = Cell::new(0);
            let fault = solver(1e-9)
                .integrate(
                    &Wall {
                        wall,
                        asked: &asked,
                    },
                    [0.0],
                    10.0,
                )
                .unwrap_err();
            assert_eq!(fault.fault, RollFault::NotFinite);
            assert!((fault.time_s / wall - 1.0).abs() < 1e-9, "{fault:?}");
            assert!((fault.state[0] / wall - 1.0).abs() < 1e-9, "{fault:?}");
            assert!(asked.get() < 1000, "{asked:?} for {wall}");
        }
    }

    /// A system whose state decays fast towards the edge of its domain. Long integration steps leave the domain.
    struct Decay;

    impl System<1> for Decay {
        fn derivative(&self, y: &[f64; 1], rate: &mut [f64; 1]) -> Result<(), RollFault> {
            *rate = [-50.0 * y[0]];
            if y[0] >= -1e-3 {
                Ok(())
            } else {
                Err(RollFault::NotFinite)
            }
        }
    }

    #[test]
    fn a_stage_astray_is_no_fault() {
        let end = solver(0.1).integrate(&Decay, [1.0], 1.0).unwrap();
        assert!(end.state[0].abs() < 0.1, "{end:?}");
        let end = solver(1e-9).integrate(&Decay, [1.0], 0.1).unwrap();
        assert!((end.state[0] - libm::exp(-5.0_f64)).abs() < 1e-8, "{end:?}");
    }

    #[test]
    fn the_root_is_near_enough() {
        for exponent in -300..300 {
            for mantissa in [1.0, 1.4, 2.7, 7.5] {
                let x = mantissa * 10.0_f64.powi(exponent);
                let ratio = inverse_sixteenth_root(x) * libm::pow(x, 1.0 / 16.0);
                assert!((0.99..1.07).contains(&ratio), "{x:e}: {ratio}");
            }
        }
        assert!(inverse_sixteenth_root(0.0) > 1e15);
        assert!(inverse_sixteenth_root(f64::INFINITY) < 1e-15);
        assert!(inverse_sixteenth_root(f64::NAN) < 1e-15);
    }

    #[test]
    fn steps_are_bounded() {
        let few = Dop853 {
            most_steps: 3,
            ..solver(1e-12)
        };
        let stopped = few.integrate(&Oscillator, [0.0, 1.0], 1e3).unwrap_err();
        assert_eq!(stopped.fault, RollFault::TooManySteps { steps: 3 });
    }
}
