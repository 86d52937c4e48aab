//! Verifies the ranges of values that a search has found, with trials that the search has not used.

use palpate_report::Stretch;

use super::explore::SearchRange;
use super::limits::{ATTEMPTS, Effort, FRESH, Rules};
use super::points::{Points, Side};
use super::{Curves, ScoreRequest};

/// A range of neighbouring values that all meet the target, or all miss it. Fresh trials must still verify the range.
struct Candidate {
    first: usize,
    last: usize,
    side: Side,
}

struct End {
    run: usize,
    kind: Kind,
    /// Indices of the values that are tried as this end of the range, one after the other: first the outermost value of
    /// the range, then values farther inside.
    places: Vec<usize>,
    attempt: u32,
    /// Index of the value at which fresh trials confirmed this end of the range; `None` if they have not confirmed the
    /// end yet.
    verified: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Low,
    High,
    /// The least certain value of the range: the value with the smallest absolute score. It is verified instead of the
    /// ends if the range has no ends, because it covers the whole explored range or is a single listed value.
    Weakest,
}

/// Verifies the ends of all ranges with fresh trials (trials that the search has not used). If they do not confirm an
/// end, the end is moved inwards and verified there. Returns the verified ranges, and the number of ends that were
/// moved or dropped.
pub(super) fn verify<C: Curves + ?Sized>(
    curves: &mut C,
    points: &Points,
    among: SearchRange,
    rules: &Rules,
    effort: &mut Effort<'_>,
) -> Result<(Vec<Stretch>, usize), C::Error> {
    let found = candidates(points, among, rules);
    let mut ends = ends(points, &found, among, rules);
    let count = ends.len();
    for attempt in 0..ATTEMPTS {
        let enough = rules.verifies(count, attempt);
        let open: Vec<usize> = (0..ends.len())
            .filter(|&end| {
                let end = &ends[end];
                end.verified.is_none() && (end.attempt as usize) < end.places.len()
            })
            .collect();
        if open.is_empty() {
            break;
        }
        let asks = |part: f64| -> Vec<ScoreRequest> {
            let of_end = |&end: &usize| asks_of(&ends[end], &found, points, part);
            open.iter().flat_map(of_end).collect()
        };
        let trials = |asks: &[ScoreRequest]| {
            let trials = asks.iter().map(|ask| ask.trials);
            trials.fold(0, u64::saturating_add)
        };
        let asked = asks(effort.part(trials(&asks(1.0))));
        let scores = effort.timed(trials(&asked), || curves.scores(&asked))?;
        let mut all_scores = scores.into_iter();
        for end in open {
            let place = place_of(&ends[end]);
            let (side, count) = match found[ends[end].run].side {
                Side::Meets => (Side::Meets, points.points[place].cells.len()),
                Side::Misses => (Side::Misses, 1),
            };
            let scores: Vec<_> = all_scores.by_ref().take(count).collect();
            let score = match side {
                Side::Meets => scores
                    .iter()
                    .flatten()
                    .copied()
                    .fold(f64::INFINITY, f64::min),
                Side::Misses => {
                    let (_, condition) = points.points[place].worst();
                    scores.first().map_or(0.0, |scores| -scores[condition])
                }
            };
            let end = &mut ends[end];
            end.attempt += 1;
            end.verified = (score >= enough).then_some(place);
        }
    }
    let moved = |end: &&End| end.verified.is_none() || end.attempt > 1;
    let narrowed = ends.iter().filter(moved).count();
    Ok((verified_runs(points, &found, &ends), narrowed))
}

fn place_of(end: &End) -> usize {
    end.places[end.attempt as usize]
}

/// Requests for the fresh trials that verify the end `end` of a range. If the range meets the target, trials of all
/// cells of the study are requested. If the range misses the target, only trials of the cell that misses it most
/// clearly are requested. `part` is the share of the requested trials that the time budget allows, at most 1.
fn asks_of(end: &End, found: &[Candidate], points: &Points, part: f64) -> Vec<ScoreRequest> {
    let place = place_of(end);
    let point = &points.points[place];
    // If a range covers all tried values, it has no ends. Then the value with the smallest absolute score is verified
    // instead (`Weakest`). If an attempt fails, the next attempt verifies the same value with more trials.
    let again = match end.kind {
        Kind::Weakest => FRESH * f64::from(end.attempt + 1),
        Kind::Low | Kind::High => FRESH,
    };
    let ask = |cell: usize| ScoreRequest {
        value: point.value,
        cell,
        trials: ((point.cells[cell].trials as f64 * again * part) as u64).max(1),
        fresh: true,
    };
    match found[end.run].side {
        Side::Meets => (0..point.cells.len()).map(ask).collect(),
        Side::Misses => vec![ask(point.worst().0)],
    }
}

/// The ranges of neighbouring values that all meet the target, or all miss it, in the trials of the search. Each listed
/// value is a range of its own.
fn candidates(points: &Points, among: SearchRange, rules: &Rules) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for (place, side) in points.sides(rules).into_iter().enumerate() {
        let Some(side) = side else { continue };
        match found.last_mut() {
            Some(run)
                if matches!(among, SearchRange::Span(_))
                    && run.side == side
                    && run.last + 1 == place =>
            {
                run.last = place;
            }
            _ => found.push(Candidate {
                first: place,
                last: place,
                side,
            }),
        }
    }
    found
}

fn ends(points: &Points, found: &[Candidate], among: SearchRange, rules: &Rules) -> Vec<End> {
    let end = |run: usize, kind: Kind, places: Vec<usize>| End {
        run,
        kind,
        places,
        attempt: 0,
        verified: None,
    };
    let mut ends = Vec::new();
    for (run, Candidate { first, last, .. }) in found.iter().enumerate() {
        let SearchRange::Span(span) = among else {
            ends.push(end(run, Kind::Weakest, vec![*first; ATTEMPTS as usize]));
            continue;
        };
        let value = |place: usize| points.points[place].value;
        // Keep only values whose distance from the previous value is at least half of the requested gap, because closer
        // values would give nearly the same result.
        let apart = |places: &mut dyn Iterator<Item = usize>| {
            let mut kept: Vec<usize> = Vec::new();
            for place in places {
                let is_far = kept.last().is_none_or(|&before| {
                    let (low, high) = (value(place.min(before)), value(place.max(before)));
                    span.gap(low, high) >= 0.5 * rules.gap
                });
                if is_far {
                    kept.push(place);
                }
            }
            kept
        };
        if *first == 0 && last + 1 == points.points.len() {
            let score = |place: &usize| points.points[*place].score().abs();
            let weakest = (*first..=*last).min_by(|a, b| score(a).total_cmp(&score(b)));
            let weakest = weakest.unwrap_or(*first);
            ends.push(end(run, Kind::Weakest, vec![weakest; ATTEMPTS as usize]));
            continue;
        }
        if *first > 0 {
            ends.push(end(run, Kind::Low, apart(&mut (*first..=*last))));
        }
        if last + 1 < points.points.len() {
            ends.push(end(run, Kind::High, apart(&mut (*first..=*last).rev())));
        }
    }
    ends
}

fn verified_runs(points: &Points, found: &[Candidate], ends: &[End]) -> Vec<Stretch> {
    let value = |place: usize| points.points[place].value;
    let run = |(number, found): (usize, &Candidate)| {
        let mut places = (found.first, found.last);
        for end in ends.iter().filter(|end| end.run == number) {
            let verified = end.verified?;
            match end.kind {
                Kind::Low => places.0 = verified,
                Kind::High => places.1 = verified,
                Kind::Weakest => {}
            }
        }
        (places.0 <= places.1).then(|| Stretch {
            from: value(places.0),
            to: value(places.1),
            meets: found.side == Side::Meets,
        })
    };
    found.iter().enumerate().filter_map(run).collect()
}
