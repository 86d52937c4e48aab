//! Trials of the cells of a study at the values of the searched field.

use std::collections::{BTreeMap, BTreeSet};

use palpate_scene::Scenes;
use palpate_study::config::{ConfigError, Study};
use palpate_sweep::{Batches, CERTAIN, Curves, Growth, Runner, ScoreRequest, Scores};

use super::feasible_region::Sample;
use super::field::{Field, single_values};
use super::question::{DesignError, MAX_CELLS, Question};
use super::target_score::{NoValue, SceneTarget};
use crate::trial::SceneTrial;

/// Number of the first trial that verifies an answer. The search uses the trials before.
const FIRST_FRESH_TRIAL: u64 = 1 << 40;
/// Largest number of scenes that are stored for further trials. Scenes with a camera are large.
const MAX_CACHED_SCENES: usize = 64;

/// Trials of the cells of a study at values of the searched field, as far as the search has run them.
pub(super) struct CellCurves<'a> {
    source: Source<'a>,
    runner: &'a Runner,
    /// Receives the number of values and of trials so far.
    progress: &'a dyn Fn(usize, u64),
    cells: usize,
    /// Scenes by value and cell.
    scenes: BTreeMap<Place, Setup>,
    /// Trials by value and cell, those of the search (`false`) and fresh ones (`true`).
    samples: BTreeMap<(Place, bool), CellTrials>,
}

/// Study with the field at a value.
#[derive(Clone, Copy)]
struct Source<'a> {
    question: &'a Question,
    study: &'a Study,
    field: &'a Field,
}

/// Value, by its bits, and cell.
type Place = (u64, usize);

/// Scene of a cell at a value.
enum Setup {
    /// A scene, and the target in it.
    Scene(Box<SceneTrial>, SceneTarget),
    /// Nothing can be estimated from the readings.
    NotEstimable,
}

/// Trials of a cell at a value, and their statistics.
struct CellTrials {
    batches: Batches,
    sample: Sample,
}

impl<'a> CellCurves<'a> {
    pub(super) fn new(
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
        curves.cells = curves.source.study_at(field.first())?.cell_count();
        match curves.cells {
            cells if cells > MAX_CELLS => Err(DesignError::TooManyCells(cells)),
            _ => Ok(curves),
        }
    }

    /// Trials of each cell at a value: those of the search, or fresh ones.
    pub(super) fn samples_at(&self, value: f64, is_fresh: bool) -> Vec<Sample> {
        let bits = value.to_bits();
        let at_value = self
            .samples
            .range(((bits, 0), false)..=((bits, usize::MAX), true));
        let chosen = at_value.filter(|((_, fresh), _)| *fresh == is_fresh);
        chosen.map(|(_, trials)| trials.sample).collect()
    }

    /// Sets up the scenes of values and cells that have none yet.
    fn set_up(&mut self, places: &BTreeSet<Place>) -> Result<(), DesignError> {
        if self.scenes.len() > MAX_CACHED_SCENES {
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
        let mut fields = single_values(&self.question.set);
        fields.push((
            self.field.path.clone(),
            vec![self.field.config_value(value)],
        ));
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
        let quantities = scene.quantities();
        let Some(target) = SceneTarget::new(*target, *max_failures, quantities) else {
            let known: Vec<&str> = quantities.iter().map(|one| one.name).collect();
            return Err(DesignError::NoQuantity {
                scene: study.cell(cell)?.config.scene.kind(),
                name: target.quantity.map_or("", |quantity| quantity.name),
                known: known.join(", "),
            });
        };
        Ok(Setup::Scene(Box::new(SceneTrial::new(scene)), target))
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
            let first = if ask.fresh { FIRST_FRESH_TRIAL } else { 0 };
            let batches = match &scenes[&place(ask)] {
                Setup::Scene(_, target) => target.batches(first),
                Setup::NotEstimable => Batches::from_trial(first),
            };
            let sample = Sample {
                cell: ask.cell,
                trials: 0,
                failed: 0,
                statistic: None,
            };
            let trials = CellTrials { batches, sample };
            samples.entry((place(ask), ask.fresh)).or_insert(trials);
        }
        let wanted: BTreeMap<(Place, bool), u64> = asked
            .iter()
            .map(|ask| ((place(ask), ask.fresh), ask.trials))
            .collect();
        let mut growths: Vec<Growth<'_, SceneTrial>> = Vec::new();
        for (key, cell_trials) in samples.iter_mut() {
            if let (Some(&trials), Some(Setup::Scene(trial, _))) =
                (wanted.get(key), scenes.get(&key.0))
            {
                growths.push(Growth {
                    trial,
                    batches: &mut cell_trials.batches,
                    trials,
                });
            }
        }
        self.runner.grow(growths);
        let scored = self.runner.map(asked.len(), |number| {
            let ask = &asked[number];
            let Some(Setup::Scene(trial, target)) = scenes.get(&place(ask)) else {
                return Ok(([-CERTAIN; 2], None));
            };
            let batches = &samples[&(place(ask), ask.fresh)].batches;
            target.scores(&trial.scene, batches)
        });
        let mut all_scores = Vec::with_capacity(asked.len());
        for (ask, scored) in asked.iter().zip(scored) {
            let (scores, estimate) = scored.map_err(|NoValue(why)| self.undefined(ask, why))?;
            if let Some(CellTrials { batches, sample }) =
                self.samples.get_mut(&(place(ask), ask.fresh))
            {
                let all = batches.statistics();
                sample.statistic = estimate.map(|one| (one.value, one.std_error()));
                (sample.trials, sample.failed) = (all.trials, all.failed());
            }
            all_scores.push(scores);
        }
        let values: BTreeSet<u64> = self.samples.keys().map(|((value, _), _)| *value).collect();
        let trials = self.samples.values().map(|cell| cell.sample.trials).sum();
        (self.progress)(values.len(), trials);
        Ok(all_scores)
    }
}

impl CellCurves<'_> {
    /// Error for a statistic without a value.
    fn undefined(&self, ask: &ScoreRequest, why: &'static str) -> DesignError {
        let study = match self.source.study_at(ask.value) {
            Ok(study) => study,
            Err(error) => return error.into(),
        };
        let cell = study.cell(ask.cell);
        let coordinates = cell.map_or(Vec::new(), |cell| cell.coordinates);
        let pairs = study.paths.iter().zip(coordinates);
        let place: Vec<String> = pairs
            .map(|(path, text)| format!("{path} = {text}"))
            .collect();
        let quantity = match self.scenes.get(&(ask.value.to_bits(), ask.cell)) {
            Some(Setup::Scene(_, target)) => target.quantity().name,
            _ => "",
        };
        DesignError::Undefined {
            statistic: self.source.question.target.statistic.name(),
            quantity,
            place: place.join(", "),
            why,
        }
    }
}
