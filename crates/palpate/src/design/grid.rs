//! Grid of the fields that are not searched: all combinations of their values.

use palpate_study::config::Study;
use palpate_sweep::SearchRange;

use super::field::Field;
use super::question::{DesignError, MAX_COLUMNS, Survey};

/// Number of values of a range on the grid, by the number of fields on the grid.
const VALUES_PER_FIELD: [usize; 3] = [9, 5, 3];
/// Number of times that the grid is refined around the best value.
pub(super) const REFINEMENTS: usize = 3;

/// Fields of a grid, and the field that is searched at each combination of their values.
pub(super) struct Grid {
    pub(super) fields: Vec<Field>,
    pub(super) searched: Field,
    /// Combinations; the last field varies fastest. Without fields, a single empty one.
    pub(super) places: Vec<Vec<f64>>,
    gap: f64,
}

impl Grid {
    pub(super) fn new(study: &Study, survey: &Survey) -> Result<Self, DesignError> {
        let question = &survey.question;
        let mut set = question.set.clone();
        let mut fields: Vec<Field> = Vec::new();
        for vary in &survey.grid {
            let field = Field::new(study, &set, vary)?;
            set.push((field.path.clone(), field.config_value(field.first())));
            fields.push(field);
        }
        let searched = Field::new(study, &set, &question.vary)?;
        let count = VALUES_PER_FIELD[fields.len().clamp(1, VALUES_PER_FIELD.len()) - 1];
        let mut places: Vec<Vec<f64>> = vec![Vec::new()];
        for field in &fields {
            let values = match field.among() {
                SearchRange::Listed(count) => (0..count).map(|place| place as f64).collect(),
                SearchRange::Span(span) if span.from == span.to => vec![span.from],
                SearchRange::Span(span) => span.spread(count, question.gap),
            };
            let all = places.len().saturating_mul(values.len());
            if all > MAX_COLUMNS {
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
        grid.check_order(survey)?;
        Ok(grid)
    }

    /// Rejects a sought field whose values are not numbers.
    fn check_order(&self, survey: &Survey) -> Result<(), DesignError> {
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

    /// Whether the grid is refined around the best value: if the searched field is the sought one.
    pub(super) fn is_refined(&self, survey: &Survey) -> bool {
        let sought = survey.sought.as_ref();
        sought.is_some_and(|sought| sought.path == self.searched.path)
    }

    /// Largest number of combinations that are searched, with those around the best value.
    pub(super) fn max_columns(&self, survey: &Survey) -> usize {
        let ranges = self.fields.iter().filter(|field| !field.is_listed());
        match self.is_refined(survey) {
            true => self.places.len() + 2 * REFINEMENTS * ranges.count(),
            false => self.places.len(),
        }
    }

    /// Combinations midway between the best one and its neighbours along each range.
    pub(super) fn neighbours(&self, best: &[f64], known: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut midway = Vec::new();
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
                midway.push(place);
            }
        }
        midway
    }
}
