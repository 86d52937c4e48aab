//! Statistics of trials whose numbers are extreme.

mod searches;

use palpate_sweep::{
    Cell, CellStatistics, NEGATIVE_STD, NOT_FINITE, Observation, Record, RunOptions, Summary,
    SweepError, UNKNOWN_QUANTITY, run,
};
use palpate_verdict::{Answer, Precise, rows};

use crate::{Function, observation, observing, run_cell};

const RUN: &str = "sweep::run";
const OBSERVE: &str = "sweep::Record::observe";
/// Rounding of the moments, as the documentation of `Summary` states it.
const BOUND: f64 = 1e-13;
/// How far quantiles may be off, of the distance to the truth.
const QUANTILE: f64 = 0.004;
const UNITS: [f64; 8] = [1e-320, 1e-300, 1e-150, 1e-9, 1.0, 1e9, 1e150, 1e300];
const TRUTHS: [f64; 6] = [0.0, -0.0, f64::from_bits(1), 1e-300, 1e300, f64::MAX];
const IN_TURN: [(&str, f64, f64); 5] = [
    ("huge and subnormal", 1e308, f64::from_bits(1)),
    ("of opposite signs and huge", 8e307, -8e307),
    ("0 and -0", 0.0, -0.0),
    ("1e300 and 1", 1e300, 1.0),
    ("subnormal", f64::from_bits(1), f64::from_bits(2)),
];

rows! {
    RUN, "errors of 1 to {trials} times {unit:e}" => sequence(unit, trials),
        for unit in UNITS, for trials in [2, 1000, 5000];
    RUN, "quantiles of errors of -1000 to 1000 times {unit:e}" => quantiles(unit), for unit in UNITS;
    RUN, "5000 estimates of {unit:e}, all alike: no spread" => alike(unit), for unit in UNITS;
    RUN, "spread of 1 ulp around {offset:e}" => spread_of_ulps(offset), for offset in [1e3, 1e9, 1e15, 1e100];
    RUN, "{trials} errors, {name} in turn: mean" => in_turn(trials, one, other),
        for (name, one, other) in IN_TURN, for trials in [1, 2, 3000];
    RUN, "estimates of half a truth of {truth:e}: bias and stated deviation" => half(truth), for truth in TRUTHS;
    OBSERVE, "an estimate of NaN: trials fail by kind" => failing([f64::NAN, 0.0, 0.0], NOT_FINITE);
    OBSERVE, "an infinite estimate: trials fail by kind" => failing([f64::INFINITY, 0.0, 0.0], NOT_FINITE);
    OBSERVE, "a truth of NaN: trials fail by kind" => failing([0.0, f64::NAN, 0.0], NOT_FINITE);
    OBSERVE, "an error beyond the doubles: trials fail by kind" => failing([f64::MAX, -f64::MAX, 0.0], NOT_FINITE);
    OBSERVE, "a standard deviation of NaN: trials fail by kind" => failing([0.0, 0.0, f64::NAN], NOT_FINITE);
    OBSERVE, "a negative standard deviation: trials fail by kind" => failing([0.0, 0.0, -1.0], NEGATIVE_STD);
    OBSERVE, "a subnormal negative one: trials fail by kind" => failing([0.0, 0.0, -f64::from_bits(1)], NEGATIVE_STD);
    OBSERVE, "quantity {quantity} of one: trials fail by kind" =>
        failures(observation(1.0, 1.0, None), quantity, UNKNOWN_QUANTITY), for quantity in [1, usize::MAX];
    RUN, "{trials} errors, one of four {unit:e}, the others 0: how exact their rms is" => of_rms(trials, unit),
        for trials in [4, 4096, 5000], for unit in UNITS;
    RUN, "no trial: nothing is defined" => undefined();
    RUN, "more trials than can be counted", "too-many-trials" => uncountable();
    RUN, "intervals of which {share} hold the truth: coverage" => covered(share), for share in [0.0, 0.05, 0.95, 1.0];
    RUN, "standard deviations of 0 and errors of 0: all intervals hold the truth" => exact();
}

/// A share p of ones among n: the mean square is p, its variance p (1 − p)/(n − 1).
fn of_rms(trials: u64, unit: f64) -> Answer {
    let summary = summary(trials, |trial| {
        observation(if trial % 4 == 3 { unit } else { 0.0 }, 0.0, None)
    });
    let share = 0.25;
    let std = Precise::new(share * (1.0 - share) / (trials - 1) as f64).sqrt();
    let of_rms = std / Precise::new(2.0 * f64::sqrt(share)) * Precise::new(unit);
    let scale = unit.max(f64::MIN_POSITIVE);
    Answer::at_scale(value(summary.rms_error_std), of_rms.to_f64(), scale).within(BOUND)
}

fn summary(trials: u64, of: impl Fn(u64) -> Observation + Sync) -> Summary {
    run_cell(trials, &observing(of)).quantities[0]
}

/// All numbers of a summary that are defined.
fn numbers(summary: &Summary) -> Vec<f64> {
    let all = [
        summary.truth,
        summary.mean,
        summary.std,
        summary.bias,
        summary.rms_error,
        summary.rms_error_std,
        summary.mean_abs_error,
        summary.relative_rms_error,
        summary.relative_mean_abs_error,
        summary.q05,
        summary.q50,
        summary.q95,
        summary.mean_reported_std,
        summary.coverage50,
        summary.coverage80,
        summary.coverage95,
    ];
    all.into_iter().flatten().collect()
}

/// A statistic, NaN where it is not defined.
fn value(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

fn half(truth: f64) -> Answer {
    let half = 0.5 * truth;
    let summary = summary(100, |_| observation(half, truth, Some(truth.abs())));
    let pairs = [
        (value(summary.bias), half - truth),
        (value(summary.rms_error), (half - truth).abs()),
        (value(summary.mean_reported_std), truth),
    ];
    let scale = truth.max(f64::MIN_POSITIVE);
    let answer = Answer::all_at_scale(pairs, scale).within(BOUND);
    answer.also(numbers(&summary))
}

fn undefined() -> Answer {
    let summary = summary(0, |_| observation(1.0, 1.0, None));
    Answer::at_scale(numbers(&summary).len() as f64, 0.0, 1.0)
}

fn uncountable() -> Result<Vec<CellStatistics>, SweepError> {
    let trial = &observing(|_| observation(1.0, 1.0, None));
    let trials = u64::MAX;
    run(
        &[Cell { trials, trial }; 2],
        &RunOptions::default(),
        &|_| (),
    )
}

fn exact() -> Answer {
    let summary = summary(2000, |_| observation(3.0, 3.0, Some(0.0)));
    Answer::near(value(summary.coverage95), 1.0)
}

/// 1, 2, … n has mean (n + 1)/2, mean square (n + 1)(2n + 1)/6 and variance n(n + 1)/12, in the unit.
fn sequence(unit: f64, trials: u64) -> Answer {
    let n = Precise::new(trials as f64);
    let unit_precise = Precise::new(unit);
    let mean = ((&n + 1.0) * &unit_precise * 0.5).to_f64();
    let square = (&n + 1.0) * (&n * 2.0 + 1.0) / 6.0;
    let rms = (square.sqrt() * &unit_precise).to_f64();
    let std = ((&n * (&n + 1.0) / 12.0).sqrt() * &unit_precise).to_f64();
    let found = summary(trials, |trial| {
        observation((trial + 1) as f64 * unit, 0.0, None)
    });
    // Subnormal numbers are whole multiples of the least one.
    let least = f64::from_bits(1) / unit;
    Answer::all_near([
        (value(found.bias), mean),
        (value(found.mean_abs_error), mean),
        (value(found.mean), mean),
        (value(found.rms_error), rms),
        (value(found.std), std),
    ])
    .within(BOUND.max(2.0 * least))
    .also(numbers(&found))
}

/// Within 0.4 % of the distance to the truth; below 2.3e-308 numbers count as 0.
fn quantiles(unit: f64) -> Answer {
    let found = summary(2001, |trial| {
        observation((trial as f64 - 1000.0) * unit, 0.0, None)
    });
    let far = 900.0 * unit;
    let side = if far < f64::MIN_POSITIVE { 0.0 } else { 1.0 };
    let pairs = [(found.q05, -side), (found.q50, 0.0), (found.q95, side)];
    let pairs = pairs.map(|(found, truth)| (value(found) / far, truth));
    Answer::all_at_scale(pairs, 1.0).within(QUANTILE)
}

fn alike(unit: f64) -> Answer {
    let found = summary(5000, |_| observation(unit, 0.0, Some(unit)));
    let near = [
        found.mean,
        found.bias,
        found.rms_error,
        found.mean_abs_error,
        found.mean_reported_std,
    ];
    let mut pairs = vec![(value(found.std) / unit, 0.0)];
    pairs.extend(near.map(|found| (value(found) / unit, 1.0)));
    Answer::all_at_scale(pairs, 1.0).within(BOUND)
}

fn alternating(trials: u64, one: f64, other: f64) -> Summary {
    summary(trials, |trial| {
        observation(if trial.is_multiple_of(2) { one } else { other }, 0.0, None)
    })
}

/// Estimates alternate between a number and the next double.
fn spread_of_ulps(offset: f64) -> Answer {
    let next = offset.next_up();
    let found = alternating(4000, offset, next);
    let n = 4000.0_f64;
    let truth = 0.5 * (next - offset) * (n / (n - 1.0)).sqrt();
    Answer::near(value(found.std), truth)
        .within(1e-12)
        .also(numbers(&found))
}

fn in_turn(trials: u64, one: f64, other: f64) -> Answer {
    let found = alternating(trials, one, other);
    let ones = trials.div_ceil(2);
    let sum = Precise::new(one) * ones as f64 + Precise::new(other) * (trials - ones) as f64;
    let truth = (sum / trials as f64).to_f64();
    let scale = one.abs().max(other.abs()).max(f64::MIN_POSITIVE);
    Answer::at_scale(value(found.bias), truth, scale)
        .within(BOUND)
        .also(numbers(&found))
}

/// Failures of an estimate of a truth with a standard deviation.
fn failing([estimate, truth, std]: [f64; 3], kind: &'static str) -> Answer {
    failures(observation(estimate, truth, Some(std)), 0, kind)
}

/// Every other trial fails by this kind and leaves nothing.
fn failures(bad: Observation, quantity: usize, kind: &'static str) -> Answer {
    let trial = Function {
        quantities: 1,
        function: |trial: u64, record: &mut Record| {
            if trial.is_multiple_of(2) {
                record.observe(0, observation(2.0, 1.0, None));
            } else {
                record.observe(0, observation(5.0, 1.0, None));
                record.observe(quantity, bad);
            }
            Ok(())
        },
    };
    let found = run_cell(3000, &trial);
    let failed: u64 = found
        .failures
        .iter()
        .filter(|failure| failure.kind == kind)
        .map(|one| one.count)
        .sum();
    let summary = found.quantities[0];
    Answer::all_near([
        (failed as f64, 1500.0),
        (summary.observations as f64, 1500.0),
        (value(summary.bias), 1.0),
    ])
}

fn covered(share: f64) -> Answer {
    let holds = |trial: u64| ((trial % 100) as f64) < 100.0 * share;
    let found = summary(10_000, |trial| Observation {
        interval_holds: Some([holds(trial); 3]),
        ..observation(1e300, 0.0, None)
    });
    Answer::at_scale(value(found.coverage95), share, 1.0).within(1e-15)
}
