//! Search for the values at which a target is met: a scan, then ever closer looks about each crossing.

use super::curve::{Ask, Curves};
use super::effort::Effort;
use super::points::{Point, Points};
use super::rules::{FIRST, MOST_LOOKS, Rules, SCANNED};
use super::span::Span;

/// Values among which is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Among {
    /// Numbers of a range.
    Span(Span),
    /// So many values, each by itself.
    Listed(usize),
}

/// Reason why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Every gap is as small as it is to be, and every value that was looked at lies on one side.
    Known,
    /// More trials, or looks, are not taken.
    Trials,
    /// Time is up.
    Time,
}

/// Share of the time after which nothing new is explored; the rest is for the verification.
const EXPLORING: f64 = 0.6;
/// Growth of trials where a value is open, and the most that a crossing may ask for; where there is no time for so much, it
/// is halved, down to the least.
const GROWTH: f64 = 4.0;
const MOST_GROWTH: f64 = 16.0;
const LEAST_GROWTH: f64 = 1.5;
/// Part of a crossing's width above which the distance of two neighbours is halved.
const COARSE: f64 = 0.34;
/// Part of the gap that the values which stay open are to fill.
const FILLED: f64 = 0.6;

/// Looks at values until their sides are known closely enough.
pub(super) fn explore<C: Curves + ?Sized>(
    curves: &mut C,
    among: Among,
    rules: &Rules,
    effort: &mut Effort<'_>,
) -> Result<(Points, Ended), C::Error> {
    let cells = curves.cells();
    let mut points = Points::default();
    let values: Vec<f64> = match among {
        Among::Span(span) => span.spread(SCANNED, rules.gap),
        Among::Listed(count) => (0..count).map(|place| place as f64).collect(),
    };
    // Twice, so that the second tells what trials take once their scenes are set up.
    for trials in [FIRST / 2, FIRST] {
        let mut asks: Vec<Ask> = Vec::new();
        for &value in &values {
            asks.extend((0..cells).map(|cell| Ask {
                value,
                cell,
                trials: trials.min(rules.most_trials),
                fresh: false,
            }));
        }
        look(curves, &mut points, &asks, effort)?;
    }
    loop {
        let mut growth = MOST_GROWTH;
        let asks = loop {
            let asks = round(&points, among, rules, growth);
            if asks.is_empty() {
                let is_open = match among {
                    Among::Listed(_) => points.sides(rules).contains(&None),
                    Among::Span(span) => is_open(&points, &span, rules),
                };
                let ended = if is_open { Ended::Trials } else { Ended::Known };
                return Ok((points, ended));
            }
            if effort.allows(points.added(&asks), EXPLORING) {
                break asks;
            }
            growth *= 0.5;
            if growth < LEAST_GROWTH {
                return Ok((points, Ended::Time));
            }
        };
        let mut values: Vec<f64> = asks.iter().map(|ask| ask.value).collect();
        values.dedup();
        if points.looks + values.len() > MOST_LOOKS {
            return Ok((points, Ended::Trials));
        }
        look(curves, &mut points, &asks, effort)?;
    }
}

/// Asks, and notes what is told.
fn look<C: Curves + ?Sized>(
    curves: &mut C,
    points: &mut Points,
    asks: &[Ask],
    effort: &mut Effort<'_>,
) -> Result<(), C::Error> {
    let cells = curves.cells();
    let told = effort.timed(points.added(asks), || curves.look(asks))?;
    points.take(asks, &told, cells);
    Ok(())
}

/// Whether a value of a span is open that does not lie in a small gap of a crossing, or some gap is not small.
fn is_open(points: &Points, span: &Span, rules: &Rules) -> bool {
    stretches(points, rules)
        .into_iter()
        .any(|stretch| match stretch {
            Stretch::Open(_, _) => true,
            Stretch::Crossing(low, high) => !is_known(&points.points[low..=high], span, rules),
        })
}

/// Neighbouring values about which something is open.
enum Stretch {
    /// Values that are open, from one place to another; those around them are on the same side, or none.
    Open(usize, usize),
    /// Values between one place and another, which are on different sides.
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

/// Whether the values of a crossing, both its ends included, are close enough.
fn is_known(crossing: &[Point], span: &Span, rules: &Rules) -> bool {
    let [low, .., high] = crossing else {
        return true;
    };
    let is_close = span.gap(low.value, high.value) <= rules.gap;
    is_close || crossing.len() == 2 && span.between(low.value, high.value, rules.gap).is_none()
}

/// Questions of the next round, in which trials grow at most so many times.
fn round(points: &Points, among: Among, rules: &Rules, growth: f64) -> Vec<Ask> {
    let mut asks = Vec::new();
    let all = &points.points;
    let Among::Span(span) = among else {
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

/// Asks for values within a crossing where its neighbours are far from each other, else for more trials of those that are
/// open.
fn closer(crossing: &[Point], span: &Span, rules: &Rules, growth: f64, asks: &mut Vec<Ask>) {
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
        if share(&pair[1]) - share(&pair[0]) <= COARSE * wide {
            continue;
        }
        if let Some(value) = span.between(pair[0].value, pair[1].value, rules.gap) {
            asks.extend((0..low.cells.len()).map(|cell| Ask {
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
    // Trials by which the values that stay open become as few as the gap has room for.
    let spacing = wide / (crossing.len() - 1) as f64;
    let open_wide = share(last) - share(first) + spacing;
    let gap = wide * rules.gap / span.gap(low.value, high.value);
    let wanted = open_wide / (FILLED * gap);
    let factor = (wanted * wanted).max(GROWTH).min(growth);
    open.iter()
        .for_each(|point| point.grown(factor, rules, asks));
}
