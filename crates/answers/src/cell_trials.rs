//! Runs and stores the trials of a search for the values of a field that meet a target. Each cell of the study (one
//! combination of the values that the study sweeps) has its own trials at each tested value of the searched field.

use std::collections::{BTreeMap, BTreeSet};

use palpate_scene::{Arch, SceneTrial, Scenes};
use palpate_study::config::{ConfigError, Study};
use palpate_sweep::{Batches, CERTAIN, CellStatistics, Growth, Runner, TrialMeans};

use crate::error::AnswerError;
use crate::region::{Region, Sample};
use crate::search::{Curves, ScoreRequest, Scores};
use crate::target_score::{NoValue, SceneTarget};
use crate::words::percent;

/// Number of the first trial that is run only to verify an answer (a fresh trial). The search for the answer uses
/// trials with smaller numbers.
const FIRST_FRESH_TRIAL: u64 = 1 << 40;
/// Largest number of scenes that are stored for later trials. A scene with a camera needs much memory. So if more
/// scenes are stored, all scenes that the next trials do not need are dropped.
const MAX_CACHED_SCENES: usize = 64;
/// Kind of failure that is reported for a scene whose readings, even without noise, do not determine an estimate.
const UNDETERMINED: &str = "undetermined";

pub(crate) struct CellTrials<'a> {
    source: Source<'a>,
    runner: &'a Runner,
    /// Function that receives the progress: the number of tested values and the number of trials so far.
    progress: &'a dyn Fn(usize, u64),
    scenes: BTreeMap<Place, Setup>,
    /// Trials of each cell of the study at each tested value of the searched field. The flag in the key is `true` for
    /// the fresh trials that verify the answer, and `false` for the trials of the search.
    samples: BTreeMap<(Place, bool), (Batches, Sample)>,
}

/// Creates the scenes of the study for one combination of values of the varied fields that are not searched. These
/// fields have the fixed values `fixed`.
struct Source<'a> {
    study: &'a Study,
    region: &'a Region,
    fixed: Vec<(String, Vec<toml::Value>)>,
}

/// Key under which a scene or its trials are stored: the value of the searched field, as the bits of the number, and
/// the index of the study's cell.
type Place = (u64, usize);

/// The scene of a cell of the study at a value of the searched field, or the reason why this scene cannot be estimated.
enum Setup {
    Scene(Box<SceneTrial>, SceneTarget),
    /// The readings do not determine an estimate. The text names the kind of failure.
    NotEstimable(&'static str),
}

impl<'a> CellTrials<'a> {
    /// Creates a store without trials. Each varied field that is not searched has one value in this store; `place`
    /// contains these values.
    pub(crate) fn new(
        study: &'a Study,
        region: &'a Region,
        place: &[f64],
        runner: &'a Runner,
        progress: &'a dyn Fn(usize, u64),
    ) -> Self {
        Self {
            source: Source {
                study,
                region,
                fixed: region.fixed_at(place),
            },
            runner,
            progress,
            scenes: BTreeMap::new(),
            samples: BTreeMap::new(),
        }
    }

    /// Results of all cells of the study if the searched field has the value `value`. They come from the fresh trials,
    /// which verify the answer, if `is_fresh` is true; otherwise from the trials of the search.
    pub(crate) fn samples_at(&self, value: f64, is_fresh: bool) -> Vec<Sample> {
        let bits = value.to_bits();
        let at_value = self
            .samples
            .range(((bits, 0), false)..=((bits, usize::MAX), true));
        let chosen = at_value.filter(|((_, fresh), _)| *fresh == is_fresh);
        chosen.map(|(_, (_, sample))| *sample).collect()
    }

    fn set_up(&mut self, places: &BTreeSet<Place>) -> Result<(), AnswerError> {
        if self.scenes.len() > MAX_CACHED_SCENES {
            self.scenes.retain(|place, _| places.contains(place));
        }
        let missing = places
            .iter()
            .filter(|place| !self.scenes.contains_key(place));
        let missing: Vec<Place> = missing.copied().collect();
        let mut values: Vec<u64> = missing.iter().map(|(value, _)| *value).collect();
        values.dedup();
        let source = &self.source;
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

    /// The error [`AnswerError::Undefined`]: the target's statistic cannot be computed at the requested value and cell,
    /// for the reason `why`.
    fn undefined(&self, ask: &ScoreRequest, why: &'static str) -> AnswerError {
        let found = self.source.study_at(ask.value);
        let found = found.and_then(|study| Ok((study.cell(ask.cell)?.coordinates, study)));
        let (coordinates, study) = match found {
            Ok(found) => found,
            Err(error) => return error.into(),
        };
        let pairs = study.paths.iter().zip(coordinates);
        let place: Vec<String> = pairs
            .map(|(path, text)| format!("{path} = {text}"))
            .collect();
        let target = &self.source.region.question.target;
        AnswerError::Undefined {
            statistic: target.statistic.name(),
            quantity: target.quantity.map_or("", |quantity| quantity.name),
            place: place.join(", "),
            why,
        }
    }
}

impl Source<'_> {
    fn study_at(&self, value: f64) -> Result<Study, ConfigError> {
        let searched = self.region.searched.fixed_at(value);
        self.study.varied(&[&self.fixed[..], &[searched]].concat())
    }

    fn setup(&self, study: &Study, cell: usize) -> Result<Setup, AnswerError> {
        let question = &self.region.question;
        let scene = study.scene(cell)?;
        if scene.estimable().is_err() {
            let failure = scene.trial(0, |_, _| ()).err();
            return Ok(Setup::NotEstimable(failure.unwrap_or(UNDETERMINED)));
        }
        let quantities = scene.quantities();
        let target = SceneTarget::new(question.target, question.max_failures, quantities);
        let Some(target) = target else {
            let kind = study.cell(cell)?.config.scene.kind();
            let name = question
                .target
                .quantity
                .map_or("", |quantity| quantity.name);
            return Err(AnswerError::no_quantity(kind, name, quantities));
        };
        let arch = Arch::new();
        Ok(Setup::Scene(Box::new(SceneTrial { scene, arch }), target))
    }
}

impl Curves for CellTrials<'_> {
    type Error = AnswerError;

    fn cells(&self) -> usize {
        self.source.region.cells.len()
    }

    fn scores(&mut self, asked: &[ScoreRequest]) -> Result<Vec<Scores>, AnswerError> {
        let place = |ask: &ScoreRequest| (ask.value.to_bits(), ask.cell);
        let places: BTreeSet<Place> = asked.iter().map(place).collect();
        self.set_up(&places)?;
        let (scenes, samples) = (&self.scenes, &mut self.samples);
        let mut wanted: BTreeMap<(Place, bool), u64> = BTreeMap::new();
        for ask in asked {
            let key = (place(ask), ask.fresh);
            wanted.insert(key, ask.trials);
            let first = if ask.fresh { FIRST_FRESH_TRIAL } else { 0 };
            let (batches, counts) = match &scenes[&key.0] {
                Setup::Scene(_, target) => (target.batches(first), TrialCounts::default()),
                Setup::NotEstimable(kind) => (
                    Batches::from_trial(first, None),
                    TrialCounts::not_estimable(kind),
                ),
            };
            let sample = Sample {
                cell: ask.cell,
                counts,
                statistic: None,
            };
            samples.entry(key).or_insert((batches, sample));
        }
        let mut growths: Vec<Growth<'_, SceneTrial>> = Vec::new();
        for (key, (batches, _)) in samples.iter_mut() {
            if let (Some(&trials), Some(Setup::Scene(trial, _))) =
                (wanted.get(key), scenes.get(&key.0))
            {
                growths.push(Growth {
                    trial,
                    batches,
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
            let (batches, _) = &samples[&(place(ask), ask.fresh)];
            target.scores(&trial.scene, batches)
        });
        let mut all_scores = Vec::with_capacity(asked.len());
        for (ask, scored) in asked.iter().zip(scored) {
            let (scores, estimate) = scored.map_err(|NoValue(why)| self.undefined(ask, why))?;
            let key = (place(ask), ask.fresh);
            if let (Some((batches, sample)), Setup::Scene(..)) =
                (self.samples.get_mut(&key), &self.scenes[&key.0])
            {
                sample.statistic = estimate.map(|one| (one.value, one.std_error()));
                sample.counts = (&batches.statistics()).into();
            }
            all_scores.push(scores);
        }
        let values: BTreeSet<u64> = self.samples.keys().map(|((value, _), _)| *value).collect();
        let all_samples = self.samples.values();
        let trials = all_samples.map(|(_, sample)| sample.counts.trials).sum();
        (self.progress)(values.len(), trials);
        Ok(all_scores)
    }
}

/// Number of trials of a cell of the study, and number of its failed trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrialCounts {
    /// Number of trials of the cell of the study; 0 if no trial was run because the readings do not determine an
    /// estimate.
    pub trials: u64,
    /// Number of failed trials of the cell.
    pub failed: u64,
    /// The most frequent kind of failure, and the number of trials that failed in this way.
    pub main_failure: Option<(&'static str, u64)>,
}

impl TrialCounts {
    pub(crate) fn not_estimable(kind: &'static str) -> Self {
        Self {
            main_failure: Some((kind, 0)),
            ..Self::default()
        }
    }

    pub(crate) fn failure_rate(&self) -> f64 {
        match self.trials {
            0 => 1.0,
            trials => self.failed as f64 / trials as f64,
        }
    }

    /// Text that states the share of failed trials and the share of the most frequent kind of failure. In the text,
    /// trials are called `trials` (for example `presses`), and `at` describes the cell.
    pub(crate) fn failures_in_words(&self, trials: &str, at: &str) -> String {
        let kind = |share: String| match self.main_failure {
            Some((kind, _)) => format!(" (`{kind}`{share})"),
            None => String::new(),
        };
        if self.trials == 0 {
            return format!(
                "no estimate is possible from the readings at {at}{}",
                kind(String::new())
            );
        }
        let main = self.main_failure.map_or(0, |(_, count)| count);
        let share = match main == self.failed {
            true => String::new(),
            false => format!(" {} %", percent(main as f64 / self.trials as f64)),
        };
        let failing = percent(self.failure_rate());
        format!("{failing} % of {trials} fail at {at}{}", kind(share))
    }
}

impl From<&CellStatistics> for TrialCounts {
    fn from(all: &CellStatistics) -> Self {
        let kinds = all.failures.iter().rev();
        let main = kinds.max_by_key(|failure| failure.count);
        Self {
            trials: all.trials,
            failed: all.failed(),
            main_failure: main.map(|main| (main.kind, main.count)),
        }
    }
}

impl From<&[TrialMeans]> for TrialCounts {
    fn from(trials: &[TrialMeans]) -> Self {
        let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
        for kind in trials.iter().filter_map(|trial| trial.err()) {
            *kinds.entry(kind).or_default() += 1;
        }
        Self {
            trials: trials.len() as u64,
            failed: kinds.values().sum(),
            main_failure: kinds.into_iter().rev().max_by_key(|(_, count)| *count),
        }
    }
}
