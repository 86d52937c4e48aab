//! Verification of what a search has found, by trials that it has not seen.

use super::curve::{Ask, Curves};
use super::effort::Effort;
use super::explore::Among;
use super::points::{Points, Side};
use super::rules::{ATTEMPTS, FRESH, Rules};

/// Neighbouring values that lie on one side of the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Least of them that has been verified, or the least of the range.
    pub from: f64,
    /// Largest of them that has been verified, or the largest of the range.
    pub to: f64,
    /// Side on which they lie.
    pub side: Side,
}

/// Places of neighbouring values on one side.
struct Found {
    first: usize,
    last: usize,
    side: Side,
}

/// End of a run, which is to be verified.
struct End {
    run: usize,
    kind: Kind,
    /// Places that are tried one after the other, from the crossing on.
    places: Vec<usize>,
    attempt: u32,
    /// Place that has been verified.
    verified: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Low,
    High,
    /// The run is all there is: its weakest value stands for it.
    Weakest,
}

/// Verifies the ends of all runs of values that lie on one side. An end that fails is moved away from the crossing, and
/// verified there. Gives the runs that are left, and how many ends were moved or given up.
pub(super) fn verify<C: Curves + ?Sized>(
    curves: &mut C,
    points: &Points,
    among: Among,
    rules: &Rules,
    effort: &mut Effort<'_>,
) -> Result<(Vec<Run>, usize), C::Error> {
    let found = found(points, among, rules);
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
        let asks = |part: f64| -> Vec<Ask> {
            let of_end = |&end: &usize| asks_of(&ends[end], &found, points, part);
            open.iter().flat_map(of_end).collect()
        };
        let planned = asks(1.0)
            .iter()
            .map(|ask| ask.trials)
            .fold(0, u64::saturating_add);
        let asked = asks(effort.part(planned));
        let trials = asked
            .iter()
            .map(|ask| ask.trials)
            .fold(0, u64::saturating_add);
        let told = effort.timed(trials, || curves.look(&asked))?;
        let mut told = told.into_iter();
        for end in open {
            let place = place_of(&ends[end]);
            let (side, count) = match found[ends[end].run].side {
                Side::Meets => (Side::Meets, points.points[place].cells.len()),
                Side::Misses => (Side::Misses, 1),
            };
            let scores: Vec<_> = told.by_ref().take(count).collect();
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
    Ok((left(points, &found, &ends), narrowed))
}

/// Place that an end is verified at now.
fn place_of(end: &End) -> usize {
    end.places[end.attempt as usize]
}

/// Questions that verify an end: all cells where it is to meet the target, else the one that misses it most.
fn asks_of(end: &End, found: &[Found], points: &Points, part: f64) -> Vec<Ask> {
    let place = place_of(end);
    let point = &points.points[place];
    // More of the same trials where there is nowhere to go.
    let again = match end.kind {
        Kind::Weakest => FRESH * f64::from(end.attempt + 1),
        Kind::Low | Kind::High => FRESH,
    };
    let ask = |cell: usize| Ask {
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

/// Neighbouring values on one side; listed values have no neighbours.
fn found(points: &Points, among: Among, rules: &Rules) -> Vec<Found> {
    let mut found: Vec<Found> = Vec::new();
    for (place, side) in points.sides(rules).into_iter().enumerate() {
        let Some(side) = side else { continue };
        match found.last_mut() {
            Some(run)
                if matches!(among, Among::Span(_)) && run.side == side && run.last + 1 == place =>
            {
                run.last = place;
            }
            _ => found.push(Found {
                first: place,
                last: place,
                side,
            }),
        }
    }
    found
}

fn ends(points: &Points, found: &[Found], among: Among, rules: &Rules) -> Vec<End> {
    let end = |run: usize, kind: Kind, places: Vec<usize>| End {
        run,
        kind,
        places,
        attempt: 0,
        verified: None,
    };
    let mut ends = Vec::new();
    for (run, Found { first, last, .. }) in found.iter().enumerate() {
        let Among::Span(span) = among else {
            ends.push(end(run, Kind::Weakest, vec![*first; ATTEMPTS as usize]));
            continue;
        };
        let value = |place: usize| points.points[place].value;
        // Places that are half a gap from each other.
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

/// Runs between their verified ends.
fn left(points: &Points, found: &[Found], ends: &[End]) -> Vec<Run> {
    let value = |place: usize| points.points[place].value;
    let run = |(number, found): (usize, &Found)| {
        let mut places = (found.first, found.last);
        for end in ends.iter().filter(|end| end.run == number) {
            let verified = end.verified?;
            match end.kind {
                Kind::Low => places.0 = verified,
                Kind::High => places.1 = verified,
                Kind::Weakest => {}
            }
        }
        (places.0 <= places.1).then(|| Run {
            from: value(places.0),
            to: value(places.1),
            side: found.side,
        })
    };
    found.iter().enumerate().filter_map(run).collect()
}
