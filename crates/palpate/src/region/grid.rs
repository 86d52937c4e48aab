//! Values of the fields that are not searched, in all their combinations.

use palpate_study::config::Study;
use palpate_sweep::SearchRange;

use super::survey::{Extreme, Survey};
use crate::design::{DesignError, Field, MOST_COLUMNS};

/// Values of a range on a grid, by the number of fields that make it.
const PER_FIELD: [usize; 3] = [9, 5, 3];
/// Times that the grid is made finer about the best value.
const ROUNDS: usize = 3;

/// Fields of a grid, and what is searched at each of their combinations.
pub(super) struct Grid {
    pub(super) fields: Vec<Field>,
    /// The field that is searched.
    pub(super) searched: Field,
    /// Combinations, the last field fastest.
    pub(super) places: Vec<Vec<f64>>,
    gap: f64,
}

impl Grid {
    pub(super) fn of(study: &Study, survey: &Survey) -> Result<Self, DesignError> {
        let question = &survey.question;
        let mut set = question.set.clone();
        let mut fields: Vec<Field> = Vec::new();
        for vary in &survey.grid {
            if set.iter().any(|(path, _)| *path == vary.path) {
                return Err(DesignError::Twice(vary.path.clone()));
            }
            let field = Field::of(study, &set, vary)?;
            let first = match field.is_listed() {
                true => 0.0,
                false => field.span.from,
            };
            set.push((field.path.clone(), field.written(first)));
            fields.push(field);
        }
        if set.iter().any(|(path, _)| *path == question.vary.path) {
            return Err(DesignError::Twice(question.vary.path.clone()));
        }
        let searched = Field::of(study, &set, &question.vary)?;
        let count = PER_FIELD[fields.len().clamp(1, PER_FIELD.len()) - 1];
        let mut places: Vec<Vec<f64>> = vec![Vec::new()];
        for field in &fields {
            let values = match field.among() {
                SearchRange::Listed(count) => (0..count).map(|place| place as f64).collect(),
                SearchRange::Span(span) if span.from == span.to => vec![span.from],
                SearchRange::Span(span) => span.spread(count, question.gap),
            };
            let all = places.len().saturating_mul(values.len());
            if all > MOST_COLUMNS {
                return Err(DesignError::TooManyColumns(all));
            }
            let with = |place: &Vec<f64>| {
                let one = |value: &f64| [place.as_slice(), &[*value]].concat();
                values.iter().map(one).collect::<Vec<_>>()
            };
            places = places.iter().flat_map(with).collect();
        }
        let grid = Self {
            fields,
            searched,
            places,
            gap: question.gap,
        };
        grid.ordered(survey)?;
        Ok(grid)
    }

    /// Refuses to look for the best of values that are no numbers.
    fn ordered(&self, survey: &Survey) -> Result<(), DesignError> {
        let Some(sought) = &survey.sought else {
            return Ok(());
        };
        let all = || self.fields.iter().chain([&self.searched]);
        let field = all().find(|field| field.path == sought.path);
        let field = field.ok_or_else(|| DesignError::NotVaried(sought.path.clone()))?;
        let odd = (0..field.listed.len()).find(|place| field.number(*place as f64).is_none());
        match odd {
            Some(place) => Err(DesignError::NoOrder {
                path: sought.path.clone(),
                text: field.text(place as f64),
            }),
            None => Ok(()),
        }
    }

    /// Whether the grid is made finer about the best value of what is sought.
    pub(super) fn is_refined(&self, survey: &Survey) -> bool {
        let sought = survey.sought.as_ref();
        sought.is_some_and(|sought| sought.path == self.searched.path)
    }

    /// Most combinations that are searched, those about the best value included.
    pub(super) fn most(&self, survey: &Survey) -> usize {
        let ranges = self.fields.iter().filter(|field| !field.is_listed());
        match self.is_refined(survey) {
            true => self.places.len() + 2 * ROUNDS * ranges.count(),
            false => self.places.len(),
        }
    }

    /// Combinations midway between the best one and its neighbours along each range.
    pub(super) fn closer(&self, best: &[f64], known: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut closer = Vec::new();
        for (axis, field) in self.fields.iter().enumerate() {
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
                    .and_then(|low| field.span.between(low, here, self.gap)),
                above
                    .reduce(f64::min)
                    .and_then(|high| field.span.between(here, high, self.gap)),
            ];
            for value in between.into_iter().flatten() {
                let mut place = best.to_vec();
                place[axis] = value;
                closer.push(place);
            }
        }
        closer
    }

    /// Times that the grid is made finer.
    pub(super) const fn rounds(&self) -> usize {
        ROUNDS
    }

    /// Best value that there is of what is searched.
    pub(super) const fn end(&self, extreme: Extreme) -> f64 {
        match extreme {
            Extreme::Largest => self.searched.span.to,
            Extreme::Smallest => self.searched.span.from,
        }
    }
}
