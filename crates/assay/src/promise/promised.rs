//! Promises of `auto`: scenes with the model that it took.

use anyhow::{Context, Result};
use palpate_scene::{Rung, Scenes};
use palpate_study::config::{self, Study};

use super::cost;
use super::rivals::{Rival, Rivals};
use super::scenes::{Kind, text};
use crate::measured::Evaluation;

/// Scenes of each kind.
pub const SCENES: u64 = 50;
/// Largest ratio of the cost of the rung taken to that of the cheapest adequate rung.
pub(super) const MOST: f64 = 2.0;
/// Ratio of the numbers of evaluations of the contact equations from which on a roll is dearer for certain.
const DEARER: usize = 3;

/// Random scene with the model that `auto` took for it and the models that it could have taken.
#[derive(Debug)]
pub struct Promise {
    /// Kind of the scene.
    pub kind: Kind,
    /// Number of the scene among those of its kind.
    pub number: u64,
    study: Study,
    /// Models that can do the scene, with their errors against a truth that is computed in another way.
    pub rivals: Vec<Rival>,
    /// Index in `rivals` of the model that `auto` took.
    pub(super) taken: usize,
    /// Words for the truth that the errors are measured against.
    pub truth: &'static str,
    /// Tolerance that `auto` was given.
    pub tolerance: f64,
}

impl Promise {
    /// A scene of a kind by its number.
    ///
    /// # Errors
    /// If the scene cannot be set up, or its model does not choose.
    pub fn of(kind: Kind, number: u64) -> Result<Self> {
        let name = format!("{}-{number}.toml", kind.name());
        let study = config::parse(&name, &text(kind, number))?;
        let ladder = study
            .ladder(0)?
            .with_context(|| format!("{name} has no ladder"))?;
        let tolerance = ladder
            .tolerance
            .with_context(|| format!("{name} chooses no model"))?;
        let Rivals { all, taken, truth } =
            Rivals::of(&study, &ladder).with_context(|| name.clone())?;
        Ok(Self {
            kind,
            number,
            study,
            rivals: all,
            taken,
            truth,
            tolerance,
        })
    }

    /// The model that `auto` has taken.
    pub fn taken(&self) -> &Rung {
        &self.rivals[self.taken].rung
    }

    /// Whether the model that was taken errs by at most the tolerance.
    pub fn errs_within(&self) -> bool {
        self.is_adequate(self.taken)
    }

    /// How many other models would have done.
    pub fn competitors(&self) -> usize {
        let others = (0..self.rivals.len()).filter(|place| *place != self.taken);
        others.filter(|place| self.is_adequate(*place)).count()
    }

    /// Whether the truth is another computation than that of the model which was taken.
    pub fn is_judged_by_another(&self) -> bool {
        let method = |name: &str| name.split([' ', ',', ':']).next().map(str::to_owned);
        method(&self.taken().name) != method(self.truth)
    }

    /// Whether the model that was taken costs no more than it may, as far as that shows without counting instructions:
    /// a roll evaluates the contact equations at most twice as often as any other that would do; of glides and presses
    /// none earlier on the ladder that would do is of another method.
    pub fn seems_cheap(&self) -> bool {
        let evaluations = |place: usize| self.rivals[place].evaluations.unwrap_or(0) as f64;
        let taken = evaluations(self.taken);
        let mut adequate = (0..self.rivals.len()).filter(|place| self.is_adequate(*place));
        match self.kind {
            Kind::Roll => adequate.all(|place| taken <= MOST * evaluations(place)),
            Kind::Glide => self.taken == 0 || !self.is_adequate(0),
            Kind::Press => adequate.all(|place| place >= self.taken),
        }
    }

    pub(super) fn is_adequate(&self, place: usize) -> bool {
        matches!(self.rivals[place].rung.outcome, Ok(error) if error <= self.tolerance)
    }

    /// The models that would do and may be cheaper, and the one that is taken.
    pub(super) fn judged(&self) -> impl Iterator<Item = usize> {
        let taken = self.rivals[self.taken].evaluations;
        (0..self.rivals.len()).filter(move |&place| {
            let evaluations = self.rivals[place].evaluations;
            let is_dearer = evaluations > taken.map(|taken| DEARER * taken);
            place == self.taken || self.is_adequate(place) && !is_dearer
        })
    }

    pub(super) fn evaluations(&self) -> Result<Vec<Evaluation>> {
        self.judged().map(|place| self.evaluation(place)).collect()
    }

    /// Evaluation that computes the truth of the scene by the model at index `place` of `rivals`.
    fn evaluation(&self, place: usize) -> Result<Evaluation> {
        let rung = &self.rivals[place].rung;
        let mut run = cost::truth(&self.study, rung)?;
        let name = format!("{} {}: {}", self.kind.name(), self.number, rung.name);
        run().with_context(|| name.clone())?;
        Ok(Evaluation::new(name, run))
    }
}
