//! Ladders: rungs that answer the same question about a scene, with different costs and errors.

use anyhow::Result;

use crate::timing::Evaluation;

/// Difficulty of a scene for the rungs of a ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ease {
    /// A scene for which the cheapest rungs are accurate.
    Easy,
    /// A scene like those of most users.
    Typical,
    /// A scene on which some rungs fail.
    Hard,
}

impl Ease {
    /// Name of the difficulty in the tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Easy => "easy",
            Self::Typical => "typical",
            Self::Hard => "hard",
        }
    }
}

/// The rungs of one choice of the user, on three scenes.
pub(super) struct Ladder {
    /// Name in the tables: lower-case words with hyphens.
    pub(super) name: &'static str,
    /// The question, in one line.
    pub(super) title: &'static str,
    /// Definition of the error: the quantity and the scale.
    pub(super) error: &'static str,
    /// The evaluation whose cost is measured, in words.
    pub(super) evaluation: &'static str,
    /// Three scenes: easy, typical and hard.
    pub(super) scenes: Vec<SceneRungs>,
}

/// A scene and its rungs.
pub(super) struct SceneRungs {
    /// Difficulty of the scene.
    pub(super) ease: Ease,
    /// The scene in a few words.
    pub(super) scene: String,
    /// In the order of the ladder.
    pub(super) rungs: Vec<Rung>,
}

#[cfg(test)]
impl SceneRungs {
    /// Errors of all rungs.
    pub(super) fn errors(self) -> Vec<f64> {
        let errors = self.rungs.into_iter().map(|rung| (rung.error)());
        errors.map(|error| error.unwrap().error).collect()
    }
}

/// Error of a rung.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RungError {
    pub(super) error: f64,
    /// Standard deviation of the error over sets of trials; `None` without trials.
    pub(super) std: Option<f64>,
}

impl From<f64> for RungError {
    fn from(error: f64) -> Self {
        Self { error, std: None }
    }
}

/// One answer to the question of a ladder.
pub(super) struct Rung {
    /// Name of the rung, with its setting.
    pub(super) name: String,
    /// Setting of the rung if it is a number: steps, a tolerance, a pitch.
    pub(super) setting: Option<f64>,
    /// Computes the error. It runs once, and not in the process that counts instructions.
    pub(super) error: Box<dyn FnOnce() -> Result<RungError>>,
    /// Work whose cost is measured. The first run sets up everything that it needs.
    pub(super) evaluation: Evaluation,
}

impl Rung {
    /// A rung without a setting.
    pub(super) fn new<T, E: Into<RungError>>(
        name: impl Into<String>,
        error: impl FnOnce() -> Result<E> + 'static,
        evaluate: impl FnMut() -> T + 'static,
    ) -> Self {
        let name = name.into();
        Self {
            evaluation: Evaluation::new(name.clone(), evaluate),
            name,
            setting: None,
            error: Box::new(|| error().map(E::into)),
        }
    }

    /// Adds the setting.
    #[must_use]
    pub(super) fn set(mut self, setting: impl Into<Option<f64>>) -> Self {
        self.setting = setting.into();
        self
    }

    /// Sets the number of evaluations per run.
    #[must_use]
    pub(super) fn evaluations_per_run(mut self, evaluations: u32) -> Self {
        self.evaluation = self.evaluation.evaluations_per_run(evaluations);
        self
    }
}
