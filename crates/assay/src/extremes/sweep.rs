//! Statistics of trials whose numbers are extreme.

use std::num::NonZeroUsize;

use palpate_sweep::{
    Cell, CellStatistics, NEGATIVE_STD, NOT_FINITE, Observation, Record, RunOptions, Summary,
    SweepError, Trial, UNKNOWN_QUANTITY, run,
};

use super::Precise;
use super::{Answer, Case};

/// Rounding of the moments, as the documentation of `Summary` states it.
const BOUND: f64 = 1e-13;
/// How far quantiles may be off, of the distance to the truth.
const QUANTILE: f64 = 0.004;

/// A trial of one quantity.
struct Observing<F>(F);

impl<F: Fn(u64) -> Observation + Sync> Trial for Observing<F> {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        record.observe(0, (self.0)(trial));
        Ok(())
    }
}

const fn observation(estimate: f64, truth: f64, std: Option<f64>) -> Observation {
    Observation {
        estimate,
        truth,
        std,
        interval_holds: None,
    }
}

fn statistics(trials: u64, trial: &dyn Trial) -> Result<CellStatistics, SweepError> {
    let threads = NonZeroUsize::new(2);
    let cells = [Cell { trials, trial }];
    let mut all = run(&cells, &RunOptions { threads }, &|_| ())?;
    Ok(all.remove(0))
}

fn summary(trials: u64, of: impl Fn(u64) -> Observation + Sync) -> Result<Summary, SweepError> {
    Ok(statistics(trials, &Observing(of))?.quantities[0])
}

/// All numbers of a summary that are defined.
fn numbers(summary: &Summary) -> Vec<f64> {
    let all = [
        summary.truth,
        summary.mean,
        summary.std,
        summary.bias,
        summary.rms_error,
        summary.mean_abs_error,
        summary.relative_rms_error,
        summary.relative_mean_abs_error,
        summary.q05,
        summary.q50,
        summary.q95,
        summary.mean_reported_std,
        summary.coverage95,
    ];
    all.into_iter().flatten().collect()
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for unit in [1e-320, 1e-300, 1e-150, 1e-9, 1.0, 1e9, 1e150, 1e300] {
        for trials in [2, 1000, 5000] {
            cases.push(Case::value(
                "sweep::run",
                format!("errors of 1 to {trials} times {unit:e}"),
                move || sequence(unit, trials),
            ));
        }
        cases.push(Case::value(
            "sweep::run",
            format!("quantiles of errors of -1000 to 1000 times {unit:e}"),
            move || quantiles(unit),
        ));
        cases.push(Case::value(
            "sweep::run",
            format!("5000 estimates of {unit:e}, all alike: no spread"),
            move || alike(unit),
        ));
    }
    for offset in [1e3, 1e9, 1e15, 1e100] {
        cases.push(Case::value(
            "sweep::run",
            format!("spread of 1 ulp around {offset:e}"),
            move || spread_of_ulps(offset),
        ));
    }
    for (name, one, other) in [
        ("huge and subnormal", 1e308, f64::from_bits(1)),
        ("of opposite signs and huge", 8e307, -8e307),
        ("0 and -0", 0.0, -0.0),
        ("1e300 and 1", 1e300, 1.0),
        ("subnormal", f64::from_bits(1), f64::from_bits(2)),
    ] {
        for trials in [1, 2, 3000] {
            cases.push(Case::value(
                "sweep::run",
                format!("{trials} errors, {name} in turn: mean"),
                move || in_turn(trials, one, other),
            ));
        }
    }
    for truth in [0.0, -0.0, f64::from_bits(1), 1e-300, 1e300, f64::MAX] {
        cases.push(Case::value(
            "sweep::run",
            format!("estimates of half a truth of {truth:e}: bias and stated deviation"),
            move || {
                let half = 0.5 * truth;
                let summary = summary(100, |_| observation(half, truth, Some(truth.abs())))?;
                let value = |value: Option<f64>| value.unwrap_or(f64::NAN);
                let pairs = [
                    (value(summary.bias), half - truth),
                    (value(summary.rms_error), (half - truth).abs()),
                    (value(summary.mean_reported_std), truth),
                ];
                let scale = truth.max(f64::MIN_POSITIVE);
                let answer = Answer::all_at_scale(pairs, scale).within(BOUND);
                Ok::<_, SweepError>(answer.also(numbers(&summary)))
            },
        ));
    }
    for (input, of, kind) in [
        (
            "an estimate of NaN",
            observation(f64::NAN, 0.0, None),
            NOT_FINITE,
        ),
        (
            "an infinite estimate",
            observation(f64::INFINITY, 0.0, None),
            NOT_FINITE,
        ),
        (
            "a truth of NaN",
            observation(0.0, f64::NAN, None),
            NOT_FINITE,
        ),
        (
            "an error beyond the doubles",
            observation(f64::MAX, -f64::MAX, None),
            NOT_FINITE,
        ),
        (
            "a standard deviation of NaN",
            observation(0.0, 0.0, Some(f64::NAN)),
            NOT_FINITE,
        ),
        (
            "a negative standard deviation",
            observation(0.0, 0.0, Some(-1.0)),
            NEGATIVE_STD,
        ),
        (
            "a subnormal negative one",
            observation(0.0, 0.0, Some(-f64::from_bits(1))),
            NEGATIVE_STD,
        ),
    ] {
        cases.push(Case::value(
            "sweep::Record::observe",
            format!("{input}: trials fail by kind"),
            move || failures(of, 0, kind),
        ));
    }
    for quantity in [1, usize::MAX] {
        cases.push(Case::value(
            "sweep::Record::observe",
            format!("quantity {quantity} of one: trials fail by kind"),
            move || failures(observation(1.0, 1.0, None), quantity, UNKNOWN_QUANTITY),
        ));
    }
    cases.push(Case::value(
        "sweep::run",
        "no trial: nothing is defined",
        || {
            let summary = summary(0, |_| observation(1.0, 1.0, None))?;
            Ok::<_, SweepError>(Answer::at_scale(numbers(&summary).len() as f64, 0.0, 1.0))
        },
    ));
    cases.push(Case::refusal(
        "sweep::run",
        "more trials than can be counted",
        || {
            let trial = Observing(|_| observation(1.0, 1.0, None));
            let cell = Cell {
                trials: u64::MAX,
                trial: &trial,
            };
            run(&[cell, cell], &RunOptions::default(), &|_| ())
        },
    ));
    for share in [0.0, 0.05, 0.95, 1.0] {
        cases.push(Case::value(
            "sweep::run",
            format!("intervals of which {share} hold the truth: coverage"),
            move || covered(share),
        ));
    }
    cases.push(Case::value(
        "sweep::run",
        "standard deviations of 0 and errors of 0: all intervals hold the truth",
        || {
            let summary = summary(2000, |_| observation(3.0, 3.0, Some(0.0)))?;
            Ok::<_, SweepError>(Answer::near(summary.coverage95.unwrap_or(f64::NAN), 1.0))
        },
    ));
    cases
}

/// 1, 2, … n has mean (n + 1)/2, mean square (n + 1)(2n + 1)/6 and variance n(n + 1)/12, in the unit.
fn sequence(unit: f64, trials: u64) -> Result<Answer, SweepError> {
    let n = Precise::new(trials as f64);
    let unit_precise = Precise::new(unit);
    let mean = ((&n + 1.0) * &unit_precise * 0.5).to_f64();
    let square = (&n + 1.0) * (&n * 2.0 + 1.0) / Precise::new(6.0);
    let rms = (square.sqrt() * &unit_precise).to_f64();
    let std = ((&n * (&n + 1.0) / Precise::new(12.0)).sqrt() * &unit_precise).to_f64();
    let found = summary(trials, |trial| {
        observation((trial + 1) as f64 * unit, 0.0, None)
    })?;
    let value = |value: Option<f64>| value.unwrap_or(f64::NAN);
    // Subnormal numbers are whole multiples of the least one.
    let least = f64::from_bits(1) / unit;
    Ok(Answer::all_near([
        (value(found.bias), mean),
        (value(found.mean_abs_error), mean),
        (value(found.mean), mean),
        (value(found.rms_error), rms),
        (value(found.std), std),
    ])
    .within(BOUND.max(2.0 * least))
    .also(numbers(&found)))
}

/// Within 0.4 % of the distance to the truth; below 2.3e-308 numbers count as 0.
fn quantiles(unit: f64) -> Result<Answer, SweepError> {
    let found = summary(2001, |trial| {
        observation((trial as f64 - 1000.0) * unit, 0.0, None)
    })?;
    let value = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let far = 900.0 * unit;
    let side = if far < f64::MIN_POSITIVE { 0.0 } else { 1.0 };
    let pairs = [(found.q05, -side), (found.q50, 0.0), (found.q95, side)];
    let pairs = pairs.map(|(found, truth)| (value(found) / far, truth));
    Ok(Answer::all_at_scale(pairs, 1.0).within(QUANTILE))
}

fn alike(unit: f64) -> Result<Answer, SweepError> {
    let found = summary(5000, |_| observation(unit, 0.0, Some(unit)))?;
    let value = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let near = [
        found.mean,
        found.bias,
        found.rms_error,
        found.mean_abs_error,
        found.mean_reported_std,
    ];
    let mut pairs = vec![(value(found.std) / unit, 0.0)];
    pairs.extend(near.map(|found| (value(found) / unit, 1.0)));
    Ok(Answer::all_at_scale(pairs, 1.0).within(BOUND))
}

/// Estimates alternate between a number and the next double.
fn spread_of_ulps(offset: f64) -> Result<Answer, SweepError> {
    let next = offset.next_up();
    let found = summary(4000, |trial| {
        observation(
            if trial.is_multiple_of(2) {
                offset
            } else {
                next
            },
            0.0,
            None,
        )
    })?;
    let n = 4000.0_f64;
    let truth = 0.5 * (next - offset) * (n / (n - 1.0)).sqrt();
    Ok(Answer::near(found.std.unwrap_or(f64::NAN), truth)
        .within(1e-12)
        .also(numbers(&found)))
}

fn in_turn(trials: u64, one: f64, other: f64) -> Result<Answer, SweepError> {
    let found = summary(trials, |trial| {
        observation(if trial.is_multiple_of(2) { one } else { other }, 0.0, None)
    })?;
    let ones = trials.div_ceil(2);
    let sum = Precise::new(one) * ones as f64 + Precise::new(other) * (trials - ones) as f64;
    let truth = (sum / Precise::new(trials as f64)).to_f64();
    let scale = one.abs().max(other.abs()).max(f64::MIN_POSITIVE);
    Ok(
        Answer::at_scale(found.bias.unwrap_or(f64::NAN), truth, scale)
            .within(BOUND)
            .also(numbers(&found)),
    )
}

/// Every other trial fails by this kind and leaves nothing.
fn failures(bad: Observation, quantity: usize, kind: &'static str) -> Result<Answer, SweepError> {
    struct Failing(Observation, usize);
    impl Trial for Failing {
        fn quantities(&self) -> usize {
            1
        }

        fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
            if trial.is_multiple_of(2) {
                record.observe(0, observation(2.0, 1.0, None));
            } else {
                record.observe(0, observation(5.0, 1.0, None));
                record.observe(self.1, self.0);
            }
            Ok(())
        }
    }
    let found = statistics(3000, &Failing(bad, quantity))?;
    let failed: u64 = found
        .failures
        .iter()
        .filter(|failure| failure.kind == kind)
        .map(|one| one.count)
        .sum();
    let summary = found.quantities[0];
    Ok(Answer::all_near([
        (failed as f64, 1500.0),
        (summary.observations as f64, 1500.0),
        (summary.bias.unwrap_or(f64::NAN), 1.0),
    ]))
}

fn covered(share: f64) -> Result<Answer, SweepError> {
    let holds = |trial: u64| ((trial % 100) as f64) < 100.0 * share;
    let found = summary(10_000, |trial| Observation {
        interval_holds: Some(holds(trial)),
        ..observation(1e300, 0.0, None)
    })?;
    Ok(Answer::at_scale(found.coverage95.unwrap_or(f64::NAN), share, 1.0).within(1e-15))
}
