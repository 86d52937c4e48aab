//! Tests of the search. The true rms error is a given function of the searched value, so it crosses the limit of the
//! target at given values. Simulated trials add noise to it.

use std::collections::HashMap;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use palpate_report::Stretch;
use palpate_sweep::{
    Batches, Growth, Observation, Record, RunOptions, Runner, Trial, share_at_most,
};
use proptest::prelude::*;

use crate::search::{
    Curves, EndReason, ScoreRequest, Scores, Search, SearchRange, SearchResult, Side, Span,
    TestedValue, search,
};

fn runner(threads: usize) -> Runner {
    let threads = NonZeroUsize::new(threads);
    let options = RunOptions {
        threads,
        ..RunOptions::default()
    };
    Runner::new(&options).unwrap()
}

/// Pseudo-random number in (0, 1) for an index (SplitMix64). Different indices give independent numbers.
fn uniform(index: u64) -> f64 {
    let mut bits = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    ((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// Standard normal number for an index (Box and Muller). Different indices give independent numbers.
fn normal(index: u64) -> f64 {
    let (radius, angle) = (uniform(2 * index + 1), uniform(2 * index + 2));
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
}

/// A trial whose error is a normally distributed random number times `scale`. The trial fails with the probability
/// `fails`.
struct Noisy {
    seed: u64,
    scale: f64,
    fails: f64,
}

impl Trial for Noisy {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        let number = (self.seed << 44) ^ trial;
        record.observe(
            0,
            Observation {
                estimate: self.scale * normal(number),
                truth: 0.0,
                std: None,
                interval_holds: None,
            },
        );
        (uniform(!number) >= self.fails)
            .then_some(())
            .ok_or("slipped")
    }
}

/// Function of the searched value. It returns the standard deviation of the errors, and the probability that a trial
/// fails.
type Curve = fn(f64) -> (f64, f64);

/// Rms error of [`Noisy`] trials as a function of the searched value. The target is an rms error of at most 1 with at
/// most 5 % failures.
struct Noise<'a> {
    runner: &'a Runner,
    seed: u64,
    cells: Vec<Curve>,
    known: HashMap<(u64, usize, bool), Batches>,
    trials: u64,
}

impl<'a> Noise<'a> {
    fn new(runner: &'a Runner, seed: u64, cells: &[Curve]) -> Self {
        Self {
            runner,
            seed,
            cells: cells.to_vec(),
            known: HashMap::new(),
            trials: 0,
        }
    }

    fn meets(&self, value: f64) -> bool {
        self.cells.iter().all(|cell| {
            let (scale, fails) = cell(value);
            scale <= 1.0 && fails <= 0.05
        })
    }
}

impl Curves for Noise<'_> {
    type Error = Infallible;

    fn cells(&self) -> usize {
        self.cells.len()
    }

    fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Infallible> {
        let score = |ask: &ScoreRequest| {
            let (scale, fails) = self.cells[ask.cell](ask.value);
            let trial = Noisy {
                seed: self.seed,
                scale,
                fails,
            };
            let first = if ask.fresh { 1 << 40 } else { 0 };
            let key = (ask.value.to_bits(), ask.cell, ask.fresh);
            let batches = self
                .known
                .entry(key)
                .or_insert(Batches::from_trial(first, None));
            let before = batches.statistics().trials;
            let trials = ask.trials;
            self.runner.grow(vec![Growth {
                trial: &trial,
                batches,
                trials,
            }]);
            self.trials += batches.statistics().trials - before;
            let of_rms = batches
                .estimate(|all| all.quantities[0].rms_error)
                .and_then(|rms| rms.map(libm::log))
                .map_or(0.0, |rms| rms.score(0.0, 1.0));
            let failed = batches.statistics().failed();
            [
                of_rms,
                share_at_most(failed, batches.statistics().trials, 0.05),
            ]
        };
        Ok(requests.iter().map(score).collect())
    }
}

fn searched(curve: &mut Noise<'_>, among: SearchRange, most_trials: u64) -> SearchResult {
    let settings = Search {
        among,
        gap: 0.05,
        most_trials,
        budget: None,
        wrong: 0.05,
    };
    let Ok(found) = search(curve, &settings, &|| Duration::ZERO);
    found
}

fn span(from: f64, to: f64) -> SearchRange {
    SearchRange::Span(Span::new(from, to, false))
}

/// For each range that the search found, whether it meets or misses the target. The second result is true if the
/// noiseless curve confirms this at both ends of every range.
fn sides(found: &SearchResult, curve: &Noise<'_>) -> (Vec<Side>, bool) {
    let right = |run: &Stretch| {
        let is = run.meets;
        curve.meets(run.from) == is && curve.meets(run.to) == is
    };
    let sides = found.runs.iter().map(Side::from).collect();
    (sides, found.runs.iter().all(right))
}

const MOST: u64 = 1 << 22;

#[test]
fn a_crossing_is_bracketed_closely_and_rightly() {
    let runner = runner(2);
    let (mut right, mut narrowed, mut most) = (0, 0, 0);
    for seed in 0..30 {
        let mut curve = Noise::new(&runner, seed, &[|x| (x, 0.0)]);
        let found = searched(&mut curve, span(0.1, 10.0), MOST);
        let (sides, is_right) = sides(&found, &curve);
        assert_eq!(sides, [Side::Meets, Side::Misses], "{seed}");
        let gap = found.runs[1].from / found.runs[0].to - 1.0;
        assert!(
            found.ended == EndReason::Known && (gap <= 0.05 || found.narrowed > 0),
            "{gap}"
        );
        right += u32::from(is_right);
        narrowed += u32::from(found.narrowed > 0);
        most = most.max(curve.trials);
    }
    assert!(right >= 29, "{right} of 30 are right");
    // If fresh trials do not confirm an end of a found range, the search narrows this range. Many narrowed ranges would
    // mean that the search decides whether a value meets the target after too few trials.
    assert!(narrowed <= 6, "{narrowed} of 30 were narrowed");
    assert!(most < 2_000_000, "{most} trials");
}

#[test]
fn noise_alone_never_splits_what_is_exactly_at_the_limit() {
    let runner = runner(2);
    for seed in 0..10 {
        let mut curve = Noise::new(&runner, seed, &[|_| (1.0, 0.0)]);
        let found = searched(&mut curve, span(0.1, 10.0), 1 << 12);
        assert_eq!(
            (found.runs.as_slice(), found.ended),
            (&[][..], EndReason::Trials),
            "{seed}"
        );
    }
}

#[test]
fn every_crossing_is_found() {
    let runner = runner(2);
    let curve: Curve = |x| (0.25 + (x - 3.0).abs(), 0.0);
    let mut curve = Noise::new(&runner, 1, &[curve]);
    let found = searched(&mut curve, span(0.0, 10.0), MOST);
    assert_eq!(
        sides(&found, &curve),
        (vec![Side::Misses, Side::Meets, Side::Misses], true)
    );
    let meets = found.runs[1];
    assert!(
        (meets.from - 2.25).abs() < 0.25 && (meets.to - 3.75).abs() < 0.25,
        "{meets:?}"
    );
}

#[test]
fn failures_belong_to_the_target() {
    let runner = runner(2);
    // The errors are always small, so a value can miss the target only because of its failed trials.
    let curve: Curve = |x| (0.1, x);
    let mut curve = Noise::new(&runner, 2, &[curve]);
    let found = searched(&mut curve, span(0.001, 1.0), MOST);
    assert_eq!(
        sides(&found, &curve),
        (vec![Side::Meets, Side::Misses], true)
    );
    assert!(
        found.runs[0].to > 0.045 && found.runs[1].from < 0.055,
        "{:?}",
        found.runs
    );
}

#[test]
fn the_worst_cell_decides() {
    let runner = runner(2);
    let mut curve = Noise::new(
        &runner,
        3,
        &[|x| (x, 0.0), |x| (0.1 * x, 0.0), |x| (2.0 * x, 0.0)],
    );
    let found = searched(&mut curve, span(0.1, 10.0), MOST);
    assert_eq!(
        sides(&found, &curve),
        (vec![Side::Meets, Side::Misses], true)
    );
    let misses = |looked: &&TestedValue| looked.side == Some(Side::Misses);
    let mut missing = found.tested.iter().filter(misses);
    assert!(missing.all(|looked| looked.worst == 2));
    // Cell 2 alone decides whether a value meets the target, because its score is always worse than the score of cell
    // 1. So the search must not run more trials of cell 1.
    let easy = curve
        .known
        .iter()
        .filter(|((_, cell, fresh), _)| *cell == 1 && !fresh);
    assert!(easy.map(|(_, batches)| batches.statistics().trials).max() < Some(10_000));
}

#[test]
fn all_or_nothing_and_a_single_value() {
    let runner = runner(2);
    for (from, to, side) in [
        (0.1, 0.5, Side::Meets),
        (2.0, 10.0, Side::Misses),
        (0.5, 0.5, Side::Meets),
        (2.0, 2.0, Side::Misses),
    ] {
        let mut curve = Noise::new(&runner, 5, &[|x| (x, 0.0)]);
        let found = searched(&mut curve, span(from, to), MOST);
        assert_eq!(
            found.runs,
            [Stretch {
                from,
                to,
                meets: side == Side::Meets
            }]
        );
        // The keys of `known` are (value, cell, fresh). At least one key must be `fresh`: fresh trials must verify the
        // result.
        assert!(curve.known.keys().any(|(_, _, fresh)| *fresh));
    }
}

#[test]
fn whole_numbers_and_lists() {
    let runner = runner(2);
    let mut curve = Noise::new(&runner, 7, &[|x| (10.5 / x, 0.0)]);
    let among = SearchRange::Span(Span::new(2.0, 40.0, true));
    let found = searched(&mut curve, among, MOST);
    let ends = found
        .runs
        .iter()
        .map(|run| (run.from, run.to, Side::from(run)));
    let expected = [(2.0, 10.0, Side::Misses), (11.0, 40.0, Side::Meets)];
    assert_eq!(ends.collect::<Vec<_>>(), expected);

    let scales: Curve = |place| ([0.5, 2.0, 1.0, 0.9][place as usize], 0.0);
    let mut curve = Noise::new(&runner, 8, &[scales]);
    let found = searched(&mut curve, SearchRange::Listed(4), 1 << 16);
    let sides: Vec<_> = found.tested.iter().map(|looked| looked.side).collect();
    assert_eq!(
        sides,
        [
            Some(Side::Meets),
            Some(Side::Misses),
            None,
            Some(Side::Meets)
        ]
    );
    assert_eq!((found.runs.len(), found.ended), (3, EndReason::Trials));
}

#[test]
fn fresh_trials_that_disagree_narrow_the_answer() {
    /// Scores with which search and verification disagree. In the trials of the search, values below 1 meet the target;
    /// in fresh trials, only values below `fresh_below` meet it.
    struct Disagreeing {
        fresh_below: f64,
    }
    impl Curves for Disagreeing {
        type Error = Infallible;
        fn cells(&self) -> usize {
            1
        }
        fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Infallible> {
            let limit = |ask: &ScoreRequest| if ask.fresh { self.fresh_below } else { 1.0 };
            let score = |ask: &ScoreRequest| [if ask.value < limit(ask) { 40.0 } else { -40.0 }; 2];
            Ok(requests.iter().map(score).collect())
        }
    }
    let settings = Search {
        among: span(0.1, 10.0),
        gap: 0.05,
        most_trials: MOST,
        budget: None,
        wrong: 0.05,
    };
    let found = |fresh_below: f64| {
        let mut curve = Disagreeing { fresh_below };
        let Ok(found) = search(&mut curve, &settings, &|| Duration::ZERO);
        found
    };
    let agreed = found(1.0);
    assert_eq!((agreed.narrowed, agreed.runs.len()), (0, 2));
    let moved = found(0.9);
    assert_eq!((moved.narrowed, moved.runs.len()), (1, 2));
    assert!(moved.runs[0].to < 0.9 && moved.runs[1].from < 1.05);
    // In the exploration, some values met the target, but with fresh trials no value meets it. The search must drop the
    // range of these values.
    let lost = found(0.0);
    assert_eq!((lost.narrowed, lost.runs.len()), (1, 1));
    assert!(!lost.runs[0].meets);
}

#[test]
fn a_budget_ends_the_search_and_leaves_time_to_verify() {
    let runner = runner(1);
    // The clock of this test advances by one microsecond per trial.
    let trials = AtomicU64::new(0);
    struct Timed<'a>(Noise<'a>, &'a AtomicU64);
    impl Curves for Timed<'_> {
        type Error = Infallible;
        fn cells(&self) -> usize {
            self.0.cells()
        }
        fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Infallible> {
            let scores = self.0.scores(requests);
            self.1.store(self.0.trials, Ordering::Relaxed);
            scores
        }
    }
    let mut gaps = Vec::new();
    for budget in [
        Duration::from_millis(20),
        Duration::from_millis(100),
        Duration::from_secs(9),
    ] {
        trials.store(0, Ordering::Relaxed);
        let clock = || Duration::from_micros(trials.load(Ordering::Relaxed));
        let mut curve = Timed(Noise::new(&runner, 9, &[|x| (x, 0.0)]), &trials);
        let settings = Search {
            among: span(0.1, 10.0),
            gap: 0.02,
            most_trials: MOST,
            budget: Some(budget),
            wrong: 0.05,
        };
        let Ok(found) = search(&mut curve, &settings, &clock);
        let (sides, is_right) = sides(&found, &curve.0);
        assert!(is_right && sides.len() == 2, "{:?}", found.runs);
        assert!(clock() <= budget, "{:?} of {budget:?}", clock());
        gaps.push((found.runs[1].from / found.runs[0].to - 1.0, found.ended));
    }
    assert!(
        gaps[0].1 == EndReason::Time && gaps[2].1 == EndReason::Known,
        "{gaps:?}"
    );
    assert!(gaps[0].0 > gaps[1].0 && gaps[1].0 > gaps[2].0, "{gaps:?}");
}

/// A curve of scores that meets its target at values below 1. Its scores grow with the number of trials.
struct BelowOne;

impl Curves for BelowOne {
    type Error = Infallible;

    fn cells(&self) -> usize {
        1
    }

    fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Infallible> {
        let score = |ask: &ScoreRequest| [(1.0 - ask.value) * (ask.trials as f64).sqrt(), 40.0];
        Ok(requests.iter().map(score).collect())
    }
}

#[test]
fn no_claim_is_wrong_whatever_its_probability_may_be() {
    for wrong in [5e-324, 0.05, 1.0 - f64::EPSILON, 0.0, -1.0, 2.0, f64::NAN] {
        let search_it = Search {
            among: SearchRange::Span(Span::new(0.1, 10.0, false)),
            gap: 0.2,
            most_trials: 1 << 16,
            budget: None,
            wrong,
        };
        let Ok(found) = search(&mut BelowOne, &search_it, &|| Duration::ZERO);
        let is_right = found.runs.iter().all(|run| match run.meets {
            true => run.to < 1.0,
            false => run.from > 1.0,
        });
        assert!(is_right && found.tested.len() >= 16, "{wrong}: {found:?}");
        assert!(wrong != 0.05 || found.runs.len() == 2, "{found:?}");
    }
}

fn number() -> impl Strategy<Value = f64> {
    let extremes = [0.0, -0.0, 5e-324, 1.0 + f64::EPSILON, f64::MAX, -f64::MAX];
    prop_oneof![
        proptest::sample::select(extremes.to_vec()),
        any::<f64>(),
        -2.0..2.0,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_ascend_within_their_range(
        (one, other) in (number(), number()),
        is_whole in any::<bool>(),
        count in 0..20_usize,
        gap in prop_oneof![Just(0.0), Just(f64::NAN), 0.0..0.5],
    ) {
        let span = Span::new(one.min(other), one.max(other), is_whole);
        let is_value = |value: f64| {
            (span.from..=span.to).contains(&value) && (!is_whole || value.fract() == 0.0)
        };
        let values = span.spread(count, gap);
        prop_assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{values:?}");
        prop_assert!(values.iter().all(|value| is_value(*value)), "{values:?}");
        let is_bare = is_whole && span.from.ceil() > span.to.floor();
        prop_assert!(values.is_empty() == is_bare && values.len() <= 2 * count.max(2));
        let found = span.between(span.from, span.to, gap);
        let is_between = |value: f64| is_value(value) && span.from < value && value < span.to;
        prop_assert!(found.is_none_or(is_between), "{found:?}");
    }
}
