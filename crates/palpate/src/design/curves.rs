//! Trials of a study's cells at the values of a field.

use std::collections::{BTreeMap, BTreeSet};

use palpate_scene::{Scene, Scenes, quantities_of};
use palpate_study::config::{ConfigError, Study};
use palpate_sweep::{Batches, CERTAIN, Curves, Growth, Runner, ScoreRequest, Scores};

use super::field::Field;
use super::measure::{Measure, NoValue};
use super::question::{DesignError, MOST_CELLS, Question};
use crate::trial::SceneTrial;

/// Number of the first trial that a search does not see.
const FRESH: u64 = 1 << 40;
/// Scenes that are kept for more trials; those of a camera are large.
const KEPT: usize = 64;

/// Trials of the cells of a study at values of a field, as far as they have been asked for.
pub(crate) struct CellCurves<'a> {
    source: Source<'a>,
    runner: &'a Runner,
    /// Told the number of values and of trials so far.
    progress: &'a dyn Fn(usize, u64),
    cells: usize,
    /// Scenes by value and cell.
    scenes: BTreeMap<Place, Setup>,
    pub(crate) samples: BTreeMap<(Place, bool), Sampled>,
}

/// Study with the field at a value.
#[derive(Clone, Copy)]
struct Source<'a> {
    question: &'a Question,
    study: &'a Study,
    field: &'a Field,
}

/// Value, by its bits, and cell.
pub(crate) type Place = (u64, usize);

/// Scene of a cell at a value.
enum Setup {
    /// A scene, with the target in it.
    Ready(Box<SceneTrial>, Measure),
    /// The readings can tell nothing.
    NotEstimable,
}

/// Trials of a cell at a value, and what they tell.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    batches: Batches,
    /// Statistic of the target with its standard error; `None` where it is undefined.
    pub(crate) statistic: Option<(f64, f64)>,
    pub(crate) failed: u64,
    pub(crate) trials: u64,
}

impl<'a> CellCurves<'a> {
    pub(crate) fn new(
        study: &'a Study,
        question: &'a Question,
        field: &'a Field,
        runner: &'a Runner,
        progress: &'a dyn Fn(usize, u64),
    ) -> Result<Self, DesignError> {
        let mut curves = Self {
            source: Source {
                question,
                study,
                field,
            },
            runner,
            progress,
            cells: 0,
            scenes: BTreeMap::new(),
            samples: BTreeMap::new(),
        };
        let first = match field.listed.is_empty() {
            true => field.span.from,
            false => 0.0,
        };
        curves.cells = curves.study_at(first)?.cell_count();
        match curves.cells {
            cells if cells > MOST_CELLS => Err(DesignError::TooManyCells(cells)),
            _ => Ok(curves),
        }
    }

    /// The study with the field at a value; its cells are those that are to meet the target together.
    pub(crate) fn study_at(&self, value: f64) -> Result<Study, ConfigError> {
        self.source.study_at(value)
    }

    /// Field that is varied.
    pub(crate) fn field(&self) -> &Field {
        self.source.field
    }

    /// Sets up the scenes of what is asked for.
    fn set_up(&mut self, places: &BTreeSet<Place>) -> Result<(), DesignError> {
        if self.scenes.len() > KEPT {
            self.scenes.retain(|place, _| places.contains(place));
        }
        let missing = places
            .iter()
            .filter(|place| !self.scenes.contains_key(place));
        let missing: Vec<Place> = missing.copied().collect();
        let mut values: Vec<u64> = missing.iter().map(|(value, _)| *value).collect();
        values.dedup();
        let source = self.source;
        let study = |place: usize| source.study_at(f64::from_bits(values[place]));
        let studies: Result<Vec<Study>, ConfigError> =
            self.runner.map(values.len(), study).into_iter().collect();
        let studies: BTreeMap<u64, Study> = values.iter().copied().zip(studies?).collect();
        let setups = self.runner.map(missing.len(), |place| {
            let (value, cell) = missing[place];
            source.setup(&studies[&value], cell)
        });
        for (place, setup) in missing.into_iter().zip(setups) {
            self.scenes.insert(place, setup?);
        }
        Ok(())
    }
}

impl Source<'_> {
    fn study_at(&self, value: f64) -> Result<Study, ConfigError> {
        let set = self.question.set.iter();
        let mut fields: Vec<_> = set
            .map(|(path, value)| (path.clone(), vec![value.clone()]))
            .collect();
        fields.push((self.field.path.clone(), vec![self.field.written(value)]));
        self.study.varied(&fields)
    }

    fn setup(&self, study: &Study, cell: usize) -> Result<Setup, DesignError> {
        let Question {
            target,
            max_failures,
            ..
        } = self.question;
        let scene = study.scene(cell)?;
        if scene.estimable().is_err() {
            return Ok(Setup::NotEstimable);
        }
        let measure = Measure::of(*target, *max_failures, scene.quantities());
        let measure = measure.map_or_else(|| Err(no_quantity(study, cell, self.question)), Ok)?;
        Ok(Setup::Ready(Box::new(SceneTrial::new(scene)), measure))
    }
}

/// Error of a target whose quantity a cell does not have.
fn no_quantity(study: &Study, cell: usize, question: &Question) -> DesignError {
    let config = match study.cell(cell) {
        Ok(cell) => cell.config,
        Err(error) => return error.into(),
    };
    let known: Vec<&str> = quantities_of(&config.scene)
        .iter()
        .map(|one| one.name)
        .collect();
    DesignError::NoQuantity {
        scene: config.scene.kind(),
        name: question
            .target
            .quantity
            .map_or("", |quantity| quantity.name),
        known: known.join(", "),
    }
}

impl Curves for CellCurves<'_> {
    type Error = DesignError;

    fn cells(&self) -> usize {
        self.cells
    }

    fn scores(&mut self, asked: &[ScoreRequest]) -> Result<Vec<Scores>, DesignError> {
        let place = |ask: &ScoreRequest| (ask.value.to_bits(), ask.cell);
        let places: BTreeSet<Place> = asked.iter().map(place).collect();
        self.set_up(&places)?;
        let (scenes, samples) = (&self.scenes, &mut self.samples);
        for ask in asked {
            let first = if ask.fresh { FRESH } else { 0 };
            let batches = match &scenes[&place(ask)] {
                Setup::Ready(_, measure) => measure.batches(first),
                Setup::NotEstimable => Batches::from_trial(first),
            };
            let sampled = Sampled {
                batches,
                statistic: None,
                failed: 0,
                trials: 0,
            };
            samples.entry((place(ask), ask.fresh)).or_insert(sampled);
        }
        let wanted: BTreeMap<(Place, bool), u64> = asked
            .iter()
            .map(|ask| ((place(ask), ask.fresh), ask.trials))
            .collect();
        let mut growths: Vec<Growth<'_, SceneTrial>> = Vec::new();
        for (key, sampled) in samples.iter_mut() {
            if let (Some(&trials), Some(Setup::Ready(trial, _))) =
                (wanted.get(key), scenes.get(&key.0))
            {
                growths.push(Growth {
                    trial,
                    batches: &mut sampled.batches,
                    trials,
                });
            }
        }
        self.runner.grow(growths);
        let judged = self.runner.map(asked.len(), |number| {
            let ask = &asked[number];
            let Some(Setup::Ready(trial, measure)) = scenes.get(&place(ask)) else {
                return Ok(([-CERTAIN; 2], None));
            };
            let batches = &samples[&(place(ask), ask.fresh)].batches;
            measure.judge(&trial.scene, batches)
        });
        let mut told = Vec::with_capacity(asked.len());
        for (ask, judged) in asked.iter().zip(judged) {
            let (scores, estimate) = judged.map_err(|NoValue(why)| self.undefined(ask, why))?;
            if let Some(sampled) = self.samples.get_mut(&(place(ask), ask.fresh)) {
                let all = sampled.batches.statistics();
                sampled.statistic = estimate.map(|one| (one.value, one.std_error()));
                (sampled.trials, sampled.failed) = (all.trials, all.failed());
            }
            told.push(scores);
        }
        let values: BTreeSet<u64> = self.samples.keys().map(|((value, _), _)| *value).collect();
        let trials = self.samples.values().map(|sampled| sampled.trials).sum();
        (self.progress)(values.len(), trials);
        Ok(told)
    }
}

impl CellCurves<'_> {
    /// Error of a statistic without a value.
    fn undefined(&self, ask: &ScoreRequest, why: &'static str) -> DesignError {
        let study = match self.study_at(ask.value) {
            Ok(study) => study,
            Err(error) => return error.into(),
        };
        let cell = study.cell(ask.cell);
        let coordinates = cell.map_or(Vec::new(), |cell| cell.coordinates);
        let pairs = study.paths.iter().zip(coordinates);
        let place: Vec<String> = pairs
            .map(|(path, text)| format!("{path} = {text}"))
            .collect();
        let Question { target, .. } = self.source.question;
        let quantity = study.scene(ask.cell).ok().and_then(|scene: Scene| {
            let measure = Measure::of(*target, 1.0, scene.quantities())?;
            Some(measure.quantity().name)
        });
        DesignError::Undefined {
            statistic: target.statistic.name(),
            quantity: quantity.unwrap_or_default(),
            place: place.join(", "),
            why,
        }
    }
}
