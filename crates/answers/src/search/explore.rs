//! Explores a range of values. It first tests values all over the range, and then more values around each crossing. At
//! a crossing, the values change from meeting the target to missing it, or back.

use super::limits::{Effort, FIRST, MAX_LOOKS, Rules, SCANNED};
use super::points::{Point, Points};
use super::span::Span;
use super::{Curves, ScoreRequest};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SearchRange {
    /// A range; the search may test all numbers in it.
    Span(Span),
    /// A list with this number of values. The values are tested independently of each other.
    Listed(usize),
}

/// Reason why a search for values that meet a target ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EndReason {
    /// Every gap between values that meet the target and values that miss it is small enough. For all tested values
    /// outside of these gaps, it is decided whether they meet the target.
    Known,
    /// The search reached the largest number of trials, or the largest number of tests.
    Trials,
    /// The time budget of the search was used up.
    Time,
}

/// Share of a search's time budget for the exploration; the rest is for the verification.
const EXPLORATION_SHARE: f64 = 0.6;
/// Usual factor by which a round of trials increases the number of trials at a value for which it is undecided whether
/// it meets the target.
const GROWTH: f64 = 4.0;
/// Largest factor by which one round increases the number of trials at undecided values within a crossing (a change
/// between meeting and missing the target).
const MOST_GROWTH: f64 = 16.0;
/// Smallest factor by which a round increases the number of trials. If the time budget is too short for a larger
/// factor, the factor is halved repeatedly. The exploration ends when the factor would be smaller than this.
const LEAST_GROWTH: f64 = 1.5;
/// Largest distance between neighbouring tested values within a crossing (a change between meeting and missing the
/// target), as a share of the crossing's width. If two neighbours are farther apart, a value between them is tested.
const MAX_SPACING: f64 = 0.34;
/// Width to which the search tries to reduce the range of undecided values at a crossing, as a share of the allowed
/// gap. A crossing is a change between meeting and missing the target.
const UNDECIDED_SHARE: f64 = 0.6;

/// Tests values until each crossing (change from meeting the target to missing it, or back) is located accurately
/// enough.
pub(super) fn explore<C: Curves + ?Sized>(
    curves: &mut C,
    among: SearchRange,
    rules: &Rules,
    effort: &mut Effort<'_>,
) -> Result<(Points, EndReason), C::Error> {
    let cells = curves.cells();
    let mut points = Points::default();
    let values: Vec<f64> = match among {
        SearchRange::Span(span) => span.spread(SCANNED, rules.gap),
        SearchRange::Listed(count) => (0..count).map(|place| place as f64).collect(),
    };
    // Measure the time of a trial in the second of these two rounds. The time of the first round also includes the
    // set-up of the scenes.
    for trials in [FIRST / 2, FIRST] {
        let mut asks: Vec<ScoreRequest> = Vec::new();
        for &value in &values {
            asks.extend((0..cells).map(|cell| ScoreRequest {
                value,
                cell,
                trials: trials.min(rules.most_trials),
                fresh: false,
            }));
        }
        request(curves, &mut points, &asks, effort)?;
    }
    loop {
        let mut growth = MOST_GROWTH;
        let asks = loop {
            let asks = round(&points, among, rules, growth);
            if asks.is_empty() {
                let is_open = match among {
                    SearchRange::Listed(_) => points.sides(rules).contains(&None),
                    SearchRange::Span(span) => is_open(&points, &span, rules),
                };
                let ended = if is_open {
                    EndReason::Trials
                } else {
                    EndReason::Known
                };
                return Ok((points, ended));
            }
            if effort.allows(points.added(&asks), EXPLORATION_SHARE) {
                break asks;
            }
            growth *= 0.5;
            if growth < LEAST_GROWTH {
                return Ok((points, EndReason::Time));
            }
        };
        let mut values: Vec<f64> = asks.iter().map(|ask| ask.value).collect();
        values.dedup();
        if points.looks + values.len() > MAX_LOOKS {
            return Ok((points, EndReason::Trials));
        }
        request(curves, &mut points, &asks, effort)?;
    }
}

/// Computes the scores that `asks` requests, and stores them in `points`.
fn request<C: Curves + ?Sized>(
    curves: &mut C,
    points: &mut Points,
    asks: &[ScoreRequest],
    effort: &mut Effort<'_>,
) -> Result<(), C::Error> {
    let cells = curves.cells();
    let scores = effort.timed(points.added(asks), || curves.scores(asks))?;
    points.store(asks, &scores, cells);
    Ok(())
}

/// Whether the search must continue: a gap between values that meet the target and values that miss it is too large, or
/// a value outside of the gaps is undecided.
fn is_open(points: &Points, span: &Span, rules: &Rules) -> bool {
    stretches(points, rules)
        .into_iter()
        .any(|stretch| match stretch {
            Stretch::Open(_, _) => true,
            Stretch::Crossing(low, high) => !is_known(&points.points[low..=high], span, rules),
        })
}

enum Stretch {
    /// Indices of the first and the last of several consecutive undecided values that are not at a crossing. Either
    /// they are at an end of the searched range, or the decided values before and after them both meet the target or
    /// both miss it.
    Open(usize, usize),
    /// Indices of two tested values, in ascending order: one meets the target, the other misses it. All tested values
    /// between them are undecided.
    Crossing(usize, usize),
}

fn stretches(points: &Points, rules: &Rules) -> Vec<Stretch> {
    let sides = points.sides(rules);
    let mut stretches = Vec::new();
    let mut known: Option<usize> = None;
    for (place, side) in sides.iter().enumerate() {
        if side.is_none() {
            continue;
        }
        match known {
            Some(before) if sides[before] != *side => {
                stretches.push(Stretch::Crossing(before, place));
            }
            Some(before) if place > before + 1 => {
                stretches.push(Stretch::Open(before + 1, place - 1));
            }
            None if place > 0 => stretches.push(Stretch::Open(0, place - 1)),
            _ => {}
        }
        known = Some(place);
    }
    let first_open = known.map_or(0, |known| known + 1);
    if first_open < sides.len() {
        stretches.push(Stretch::Open(first_open, sides.len() - 1));
    }
    stretches
}

/// Whether a crossing (a change between meeting and missing the target) is located accurately enough: the gap between
/// its ends is small enough, or no further value fits into the gap.
fn is_known(crossing: &[Point], span: &Span, rules: &Rules) -> bool {
    let [low, .., high] = crossing else {
        return true;
    };
    let is_close = span.gap(low.value, high.value) <= rules.gap;
    is_close || crossing.len() == 2 && span.between(low.value, high.value, rules.gap).is_none()
}

/// Requests for the next round of trials. No value gets more than `growth` times its previous number of trials.
fn round(points: &Points, among: SearchRange, rules: &Rules, growth: f64) -> Vec<ScoreRequest> {
    let mut asks = Vec::new();
    let all = &points.points;
    let SearchRange::Span(span) = among else {
        let open = all.iter().filter(|point| point.side(rules).is_none());
        open.for_each(|point| point.grown(GROWTH.min(growth), rules, &mut asks));
        return asks;
    };
    for stretch in stretches(points, rules) {
        match stretch {
            Stretch::Open(first, last) => {
                let open = all[first..=last].iter();
                open.for_each(|point| point.grown(GROWTH.min(growth), rules, &mut asks));
            }
            Stretch::Crossing(low, high) => {
                let crossing = &all[low..=high];
                if !is_known(crossing, &span, rules) {
                    closer(crossing, &span, rules, growth, &mut asks);
                }
            }
        }
    }
    asks
}

/// Adds requests for trials that locate a crossing (a change between meeting and missing the target) more accurately.
/// If two neighbouring values are too far apart, values between them are requested. Otherwise, more trials are
/// requested at the undecided values.
fn closer(
    crossing: &[Point],
    span: &Span,
    rules: &Rules,
    growth: f64,
    asks: &mut Vec<ScoreRequest>,
) {
    let [low, .., high] = crossing else {
        return;
    };
    let share = |point: &Point| span.share(point.value);
    let wide = share(high) - share(low);
    let trials = |cell: usize| {
        let trials = crossing.iter().map(|point| point.cells[cell].trials);
        trials.max().unwrap_or(FIRST)
    };
    let before = asks.len();
    for pair in crossing.windows(2) {
        if share(&pair[1]) - share(&pair[0]) <= MAX_SPACING * wide {
            continue;
        }
        if let Some(value) = span.between(pair[0].value, pair[1].value, rules.gap) {
            asks.extend((0..low.cells.len()).map(|cell| ScoreRequest {
                value,
                cell,
                trials: trials(cell),
                fresh: false,
            }));
        }
    }
    if asks.len() > before {
        return;
    }
    let open = &crossing[1..crossing.len() - 1];
    let (Some(first), Some(last)) = (open.first(), open.last()) else {
        return;
    };
    // The width of the range of undecided values is inversely proportional to the square root of the number of trials.
    // The width must shrink from `open_wide` to `UNDECIDED_SHARE` times the requested `gap`. So the number of trials is
    // multiplied by the square of the ratio (present width)/(required width).
    let spacing = wide / (crossing.len() - 1) as f64;
    let open_wide = share(last) - share(first) + spacing;
    let gap = wide * rules.gap / span.gap(low.value, high.value);
    let wanted = open_wide / (UNDECIDED_SHARE * gap);
    let factor = (wanted * wanted).max(GROWTH).min(growth);
    open.iter()
        .for_each(|point| point.grown(factor, rules, asks));
}
