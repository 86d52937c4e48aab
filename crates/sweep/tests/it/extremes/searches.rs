//! Ranges, and searches in them, whose numbers are extreme.

use std::convert::Infallible;
use std::time::Duration;

use palpate_sweep::{Among, Ask, Curves, Scores, Search, Side, Span, search};
use palpate_verdict::{Answer, rows};

const SPREAD: &str = "sweep::Span::spread";
const BETWEEN: &str = "sweep::Span::between";
const SEARCH: &str = "sweep::search";
/// Ranges of all sizes, of whole numbers as well; some hold no whole number.
const ENDS: [(f64, f64); 9] = [
    (0.05, 2.0),
    (-1.0, 1.0),
    (0.0, 0.0),
    (0.2, 0.8),
    (-f64::MAX, f64::MAX),
    (1e-300, 1e300),
    (f64::from_bits(1), f64::from_bits(9)),
    (1.0, 1.0 + f64::EPSILON),
    (-0.0, f64::MIN_POSITIVE),
];
const GAPS: [f64; 3] = [0.05, 0.0, f64::NAN];

rows! {
    SPREAD, "{count} values from {from:e} to {to:e}, whole: {is_whole}, gap {gap:e}" => spread(Span::new(from, to, is_whole), count, gap),
        for (from, to) in ENDS, for is_whole in [false, true], for count in [0, 17], for gap in GAPS;
    BETWEEN, "{from:e} and {to:e}, whole: {is_whole}, gap {gap:e}" => between(Span::new(from, to, is_whole), gap),
        for (from, to) in ENDS, for is_whole in [false, true], for gap in GAPS;
    SEARCH, "wrong with a probability of {wrong:e}: no claim is wrong" => searched(wrong),
        for wrong in [f64::from_bits(1), 1e-300, 1e-9, 0.05, 0.5, 1.0 - f64::EPSILON];
    SEARCH, "wrong with a probability of {wrong:e}, which is none: no claim is wrong" => searched(wrong),
        for wrong in [0.0, -0.0, -1.0, 1.0, 2.0, f64::INFINITY, f64::NAN];
}

/// Values ascend within the range, and are whole where only whole numbers are values.
fn spread(span: Span, count: usize, gap: f64) -> Answer {
    let values = span.spread(count, gap);
    let is_value = |value: &f64| {
        (span.from..=span.to).contains(value) && (!span.is_whole || value.fract() == 0.0)
    };
    let ascend = values.windows(2).all(|pair| pair[0] < pair[1]);
    let is_bare = span.is_whole && span.from.ceil() > span.to.floor();
    let is_full = values.is_empty() == is_bare && values.len() <= 2 * count.max(2);
    Answer::holds(ascend && is_full && values.iter().all(is_value)).also(values)
}

/// Value between two others, which must lie between them.
fn between(span: Span, gap: f64) -> Answer {
    let found = span.between(span.from, span.to, gap);
    let is_value = |value: f64| {
        span.from < value && value < span.to && (!span.is_whole || value.fract() == 0.0)
    };
    Answer::holds(found.is_none_or(is_value)).also(found)
}

/// Meets its target below 1, and scores more with more trials.
struct BelowOne;

impl Curves for BelowOne {
    type Error = Infallible;

    fn cells(&self) -> usize {
        1
    }

    fn look(&mut self, asked: &[Ask]) -> Result<Vec<Scores>, Infallible> {
        let score = |ask: &Ask| [(1.0 - ask.value) * (ask.trials as f64).sqrt(), 40.0];
        Ok(asked.iter().map(score).collect())
    }
}

fn searched(wrong: f64) -> Answer {
    let among = Among::Span(Span::new(0.1, 10.0, false));
    let search_it = Search {
        among,
        gap: 0.2,
        most_trials: 1 << 16,
        budget: None,
        wrong,
    };
    let Ok(found) = search(&mut BelowOne, &search_it, &|| Duration::ZERO);
    let is_right = found.runs.iter().all(|run| match run.side {
        Side::Meets => run.to < 1.0,
        Side::Misses => run.from > 1.0,
    });
    let looked = found.looked.iter().map(|looked| looked.value);
    Answer::holds(is_right && found.looked.len() >= 16).also(looked)
}
