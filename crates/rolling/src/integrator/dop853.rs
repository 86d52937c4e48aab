//! Dormand and Prince's method of order 8 with error estimates of order 5 and 3.
//!
//! Coefficients and step control after Hairer, Nørsett and Wanner, *Solving Ordinary Differential
//! Equations I*, second edition, section II.5 and the program DOP853.

// The published digits are kept even where they exceed what a double holds.
#![allow(clippy::excessive_precision)]

use super::{Integrated, Stopped, System, stage, weighted};
use crate::RollFault;

/// DOP853 with adaptive steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dop853 {
    /// Bound on the weighted local error of a step (root mean square over the components).
    pub tolerance: f64,
    /// The first step to try; it is shortened to the duration and as errors demand.
    pub first_step_s: f64,
    /// Give up after this many steps.
    pub most_steps: usize,
}

/// Shortest step, relative to the duration, before a fault in a stage is taken for real.
const SHORTEST: f64 = 1e-14;
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 1.0 / 3.0;
const GROW: f64 = 6.0;

impl Dop853 {
    /// Integrates from `state` over `duration_s`.
    ///
    /// A stage that leaves the system's domain shortens the step; the fault is reported once the
    /// step cannot get shorter, so that its time and place are those of the boundary.
    ///
    /// # Errors
    /// [`Stopped`] with the last good state.
    #[allow(missing_docs)]
    pub fn integrate<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        let weights = system.error_weights();
        let mut y = state;
        let mut time_s = 0.0;
        let mut evaluations = 1;
        let stopped = |fault, time_s, state| Box::new(Stopped { fault, time_s, state });
        let mut slopes = [[0.0; N]; 12];
        system.derivative(&y, &mut slopes[0]).map_err(|fault| stopped(fault, 0.0, y))?;
        let mut h = self.first_step_s.min(duration_s);
        let mut grow = GROW;
        let mut steps = 0;
        let p = params();
        let mut old = p[4];
        loop {
            let remaining = duration_s - time_s;
            let last = h >= remaining * (1.0 - 1e-12);
            if last {
                h = remaining;
            }
            if steps == self.most_steps {
                return Err(stopped(RollFault::TooManySteps { steps }, time_s, y));
            }
            steps += 1;
            STEPS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            evaluations += 11;
            let fault = match stages(system, &y, h, &mut slopes) {
                Ok(()) => {
                    let (end, error) = end_of_step(&y, h, &slopes, &weights);
                    let error = error / self.tolerance;
                    if error <= 1.0 {
                        y = end;
                        if last {
                            
                            return Ok(Integrated { state: y, evaluations });
                        }
                        time_s += h;
                        system.derivative(&y, &mut slopes[0]).map_err(|fault| stopped(fault, time_s, y))?;
                        evaluations += 1;
                        h *= (p[0] * error.powf(-p[1]) * old.powf(p[2])).clamp(SHRINK, grow);
                        let left = (duration_s - time_s) / h;
                        if left < p[3] { h = (duration_s - time_s) / left.ceil(); }
                        old = error.max(p[5]);
                        grow = GROW;
                        continue;
                    }
                    
                    h *= if error.is_finite() { (p[6] * error.powf(-0.125)).clamp(SHRINK, 1.0) } else { 0.25 };
                    RollFault::Singular
                }
                Err(fault) => { h *= 0.25; fault }
            };
            grow = 1.0;
            if h <= SHORTEST * duration_s {
                return Err(stopped(fault, time_s, y));
            }
        }
    }
}

/// The slopes of a step: of its start, and of eleven stages.
type Slopes<const N: usize> = [[f64; N]; 12];

#[inline]
fn stages<const N: usize>(
    system: &impl System<N>,
    y: &[f64; N],
    h: f64,
    slopes: &mut Slopes<N>,
) -> Result<(), RollFault> {
    let [k1, k2, k3, k4, k5, k6, k7, k8, k9, k10, k11, k12] = slopes;
    system.derivative(&stage(system, y, h, [(A21, k1)]), k2)?;
    system.derivative(&stage(system, y, h, [(A31, k1), (A32, k2)]), k3)?;
    system.derivative(&stage(system, y, h, [(A41, k1), (A43, k3)]), k4)?;
    system.derivative(&stage(system, y, h, [(A51, k1), (A53, k3), (A54, k4)]), k5)?;
    system.derivative(&stage(system, y, h, [(A61, k1), (A64, k4), (A65, k5)]), k6)?;
    let terms = [(A71, &*k1), (A74, k4), (A75, k5), (A76, k6)];
    system.derivative(&stage(system, y, h, terms), k7)?;
    let terms = [(A81, &*k1), (A84, k4), (A85, k5), (A86, k6), (A87, k7)];
    system.derivative(&stage(system, y, h, terms), k8)?;
    let terms = [(A91, &*k1), (A94, k4), (A95, k5), (A96, k6), (A97, k7), (A98, k8)];
    system.derivative(&stage(system, y, h, terms), k9)?;
    let terms = [
        (A101, &*k1),
        (A104, k4),
        (A105, k5),
        (A106, k6),
        (A107, k7),
        (A108, k8),
        (A109, k9),
    ];
    system.derivative(&stage(system, y, h, terms), k10)?;
    let terms = [
        (A111, &*k1),
        (A114, k4),
        (A115, k5),
        (A116, k6),
        (A117, k7),
        (A118, k8),
        (A119, k9),
        (A1110, k10),
    ];
    system.derivative(&stage(system, y, h, terms), k11)?;
    let terms = [
        (A121, &*k1),
        (A124, k4),
        (A125, k5),
        (A126, k6),
        (A127, k7),
        (A128, k8),
        (A129, k9),
        (A1210, k10),
        (A1211, k11),
    ];
    system.derivative(&stage(system, y, h, terms), k12)
}

/// The state after the step, and Hairer's blend of the two error estimates, root mean square over
/// the weighted components.
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
        let slope = weighted(i, [
            (B1, k1),
            (B6, k6),
            (B7, k7),
            (B8, k8),
            (B9, k9),
            (B10, k10),
            (B11, k11),
            (B12, k12),
        ]);
        end[i] += h * slope;
        third[i] = weights[i] * (slope - weighted(i, [(BHH1, k1), (BHH2, k9), (BHH3, k12)]));
        fifth[i] = weights[i] * weighted(i, [
            (E1, k1),
            (E6, k6),
            (E7, k7),
            (E8, k8),
            (E9, k9),
            (E10, k10),
            (E11, k11),
            (E12, k12),
        ]);
    }
    let square = |error: &[f64; N]| error.iter().map(|e| e * e).sum::<f64>();
    let (fifth, third) = (square(&fifth), square(&third));
    let blend = fifth + 0.01 * third;
    let error = if blend > 0.0 { h * fifth / (blend * N as f64).sqrt() } else { blend };
    (end, error)
}

const A21: f64 = 0.0526001519587677318785587544488;
const A31: f64 = 0.0197250569845378994544595329183;
const A32: f64 = 0.0591751709536136983633785987549;
const A41: f64 = 0.0295875854768068491816892993775;
const A43: f64 = 0.0887627564304205475450678981324;
const A51: f64 = 0.241365134159266685502369798665;
const A53: f64 = -0.884549479328286085344864962717;
const A54: f64 = 0.924834003261792003115737966543;
const A61: f64 = 0.037037037037037037037037037037;
const A64: f64 = 0.170828608729473871279604482173;
const A65: f64 = 0.125467687566822425016691814123;
const A71: f64 = 0.037109375;
const A74: f64 = 0.170252211019544039314978060272;
const A75: f64 = 0.0602165389804559606850219397283;
const A76: f64 = -0.017578125;
const A81: f64 = 0.0370920001185047927108779319836;
const A84: f64 = 0.170383925712239993810214054705;
const A85: f64 = 0.107262030446373284651809199168;
const A86: f64 = -0.0153194377486244017527936158236;
const A87: f64 = 0.00827378916381402288758473766002;
const A91: f64 = 0.624110958716075717114429577812;
const A94: f64 = -3.36089262944694129406857109825;
const A95: f64 = -0.868219346841726006818189891453;
const A96: f64 = 27.5920996994467083049415600797;
const A97: f64 = 20.1540675504778934086186788979;
const A98: f64 = -43.4898841810699588477366255144;
const A101: f64 = 0.477662536438264365890433908527;
const A104: f64 = -2.48811461997166764192642586468;
const A105: f64 = -0.590290826836842996371446475743;
const A106: f64 = 21.2300514481811942347288949897;
const A107: f64 = 15.2792336328824235832596922938;
const A108: f64 = -33.2882109689848629194453265587;
const A109: f64 = -0.0203312017085086261358222928593;
const A111: f64 = -0.93714243008598732571704021658;
const A114: f64 = 5.18637242884406370830023853209;
const A115: f64 = 1.09143734899672957818500254654;
const A116: f64 = -8.14978701074692612513997267357;
const A117: f64 = -18.5200656599969598641566180701;
const A118: f64 = 22.7394870993505042818970056734;
const A119: f64 = 2.49360555267965238987089396762;
const A1110: f64 = -3.0467644718982195003823669022;
const A121: f64 = 2.27331014751653820792359768449;
const A124: f64 = -10.5344954667372501984066689879;
const A125: f64 = -2.00087205822486249909675718444;
const A126: f64 = -17.9589318631187989172765950534;
const A127: f64 = 27.9488845294199600508499808837;
const A128: f64 = -2.85899827713502369474065508674;
const A129: f64 = -8.87285693353062954433549289258;
const A1210: f64 = 12.3605671757943030647266201528;
const A1211: f64 = 0.643392746015763530355970484046;
const B1: f64 = 0.0542937341165687622380535766363;
const B6: f64 = 4.45031289275240888144113950566;
const B7: f64 = 1.89151789931450038304281599044;
const B8: f64 = -5.8012039600105847814672114227;
const B9: f64 = 0.31116436695781989440891606237;
const B10: f64 = -0.152160949662516078556178806805;
const B11: f64 = 0.201365400804030348374776537501;
const B12: f64 = 0.0447106157277725905176885569043;
const BHH1: f64 = 0.244094488188976377952755905512;
const BHH2: f64 = 0.733846688281611857341361741547;
const BHH3: f64 = 0.0220588235294117647058823529412;
const E1: f64 = 0.01312004499419488073250102996;
const E6: f64 = -1.225156446376204440720569753;
const E7: f64 = -0.4957589496572501915214079952;
const E8: f64 = 1.664377182454986536961530415;
const E9: f64 = -0.3503288487499736816886487290;
const E10: f64 = 0.3341791187130174790297318841;
const E11: f64 = 0.08192320648511571246570742613;
const E12: f64 = -0.02235530786388629525884427845;

#[cfg(test)]
mod tests {
    use super::*;

    struct Oscillator;

    impl System<2> for Oscillator {
        fn derivative(&self, y: &[f64; 2], rate: &mut [f64; 2]) -> Result<(), RollFault> {
            *rate = [y[1], -y[0]];
            Ok(())
        }
    }

    /// Undefined beyond y = 1.
    struct Wall;

    impl System<1> for Wall {
        fn derivative(&self, y: &[f64; 1], rate: &mut [f64; 1]) -> Result<(), RollFault> {
            *rate = [1.0];
            if y[0] <= 1.0 { Ok(()) } else { Err(RollFault::NotFinite) }
        }
    }

    fn solver(tolerance: f64, first_step_s: f64) -> Dop853 {
        Dop853 { tolerance, first_step_s, most_steps: 10_000 }
    }

    #[test]
    fn meets_its_tolerance() {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let end = solver(tolerance, 10.0).integrate(&Oscillator, [0.0, 1.0], 10.0).unwrap();
            let error = (end.state[0] - 10.0_f64.sin()).abs();
            assert!(error < 20.0 * tolerance, "{tolerance}: {error}");
        }
    }

    #[test]
    fn one_step_is_of_eighth_order() {
        let error = |h: f64| {
            let end = solver(f64::INFINITY, h).integrate(&Oscillator, [0.0, 1.0], h).unwrap();
            (end.state[0] - h.sin()).abs()
        };
        let order = (error(1.0) / error(0.5)).log2();
        assert!(order > 8.5, "local order {order}");
    }

    #[test]
    fn a_fault_is_located() {
        let stopped = solver(1e-9, 10.0).integrate(&Wall, [0.0], 10.0).unwrap_err();
        assert!((stopped.time_s - 1.0).abs() < 1e-9, "{stopped:?}");
    }

    #[test]
    fn steps_are_bounded() {
        let few = Dop853 { most_steps: 3, ..solver(1e-12, 0.1) };
        let stopped = few.integrate(&Oscillator, [0.0, 1.0], 1e3).unwrap_err();
        assert_eq!(stopped.fault, RollFault::TooManySteps { steps: 3 });
    }
}

fn params() -> &'static [f64; 8] {
    static P: std::sync::OnceLock<[f64; 8]> = std::sync::OnceLock::new();
    P.get_or_init(|| {
        let mut p = [0.9, 0.125, 0.0, 0.0, 1.0, 1e-4, 0.9, 0.0];
        if let Ok(text) = std::env::var("P") {
            for (p, t) in p.iter_mut().zip(text.split(',')) { *p = t.parse().unwrap(); }
        }
        p
    })
}
#[allow(missing_docs)]
pub static STEPS: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
