//! The grid of a question: all combinations of values of those varied fields that are not searched.

use crate::error::AnswerError;
use crate::field::Field;
use crate::search::SearchRange;

pub(crate) const MAX_COLUMNS: usize = 64;
/// Number of values at which a field of the grid is sampled, if the question gives a range for the field. The grid
/// consists of the varied fields that are not searched. The numbers apply to a grid of one field, of two fields, and of
/// three or more fields.
const VALUES_PER_FIELD: [usize; 3] = [9, 5, 3];

/// All combinations of the grid fields' values. The value of the last field changes fastest. If `fields` is empty,
/// there is one empty combination. Values within a range are rounded. The rounding step is small compared with `gap`:
/// the largest gap that may remain in the answer between a value that meets the target and a value that misses it.
pub(crate) fn combinations(fields: &[Field], gap: f64) -> Result<Vec<Vec<f64>>, AnswerError> {
    let count = VALUES_PER_FIELD[fields.len().clamp(1, VALUES_PER_FIELD.len()) - 1];
    let mut places: Vec<Vec<f64>> = vec![Vec::new()];
    for field in fields {
        let values = match field.among() {
            SearchRange::Listed(count) => (0..count).map(|place| place as f64).collect(),
            SearchRange::Span(span) if span.from == span.to => vec![span.from],
            SearchRange::Span(span) => span.spread(count, gap),
        };
        let all = places.len().saturating_mul(values.len());
        if all > MAX_COLUMNS {
            return Err(AnswerError::TooManyColumns(all));
        }
        let with = |place: &Vec<f64>| {
            let one = |value: &f64| [place.as_slice(), &[*value]].concat();
            values.iter().map(one).collect::<Vec<_>>()
        };
        places = places.iter().flat_map(with).collect();
    }
    Ok(places)
}

/// New combinations around the combination `best`. Each one differs from `best` in a single field with a range. The new
/// value of this field is halfway between its value in `best` and the next smaller or larger value. This next value
/// comes from the `known` combinations that differ from `best` only in this field.
pub(crate) fn neighbours(
    fields: &[Field],
    gap: f64,
    best: &[f64],
    known: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let mut midway = Vec::new();
    for (axis, field) in fields.iter().enumerate() {
        if field.is_listed() {
            continue;
        }
        let is_beside = |place: &&Vec<f64>| {
            let mut others = place.iter().zip(best).enumerate();
            others.all(|(other, (value, best))| other == axis || value == best)
        };
        let along = known.iter().filter(is_beside).map(|place| place[axis]);
        let here = best[axis];
        let below = along.clone().filter(|value| *value < here);
        let above = along.filter(|value| *value > here);
        let between = [
            below
                .reduce(f64::max)
                .and_then(|low| field.span.between(low, here, gap)),
            above
                .reduce(f64::min)
                .and_then(|high| field.span.between(here, high, gap)),
        ];
        midway.extend(between.into_iter().flatten().map(|value| {
            let mut place = best.to_vec();
            place[axis] = value;
            place
        }));
    }
    midway
}
