//! Ladders: rungs that answer the same question about a scene, each at its own cost and error.

use anyhow::Result;

use crate::measured::Evaluation;

/// Difficulty of a scene for the rungs of a ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ease {
    /// A scene for which the cheapest rungs were made.
    Easy,
    /// A scene like those of most users.
    Typical,
    /// A scene at which some rungs fail.
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

/// The rungs of one choice that users have, on three scenes.
pub(super) struct Ladder {
    /// Lower-case words joined by hyphens.
    pub(super) name: &'static str,
    /// The question, in a line.
    pub(super) title: &'static str,
    /// Words for the quantity that errs and for the scale that its error is relative to.
    pub(super) error: &'static str,
    /// Words for one evaluation, whose cost is measured.
    pub(super) evaluation: &'static str,
    /// Three scenes: easy, typical and hard.
    pub(super) scenes: Vec<SceneRungs>,
}

/// A scene, and the rungs that can do it.
pub(super) struct SceneRungs {
    /// Difficulty of the scene.
    pub(super) ease: Ease,
    /// The scene in a few words.
    pub(super) scene: String,
    /// In the order of the ladder.
    pub(super) rungs: Vec<Rung>,
}

/// Error of a rung.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Erring {
    pub(super) error: f64,
    /// Standard deviation of the error over sets of trials; `None` where no trials are drawn.
    pub(super) std: Option<f64>,
}

impl From<f64> for Erring {
    fn from(error: f64) -> Self {
        Self { error, std: None }
    }
}

/// One way to answer.
pub(super) struct Rung {
    /// Name of the rung, with its setting.
    pub(super) name: String,
    /// Setting that is a number, where there is one: steps, a tolerance, a pitch.
    pub(super) setting: Option<f64>,
    /// Computation of the relative error against the truth. It runs once, and not in the process that counts
    /// instructions.
    pub(super) error: Box<dyn FnOnce() -> Result<Erring>>,
    /// Work whose cost is measured. Whatever it needs beforehand is made at its first run.
    pub(super) evaluation: Evaluation,
}

impl Rung {
    /// A rung without a number that is set.
    pub(super) fn new<T, E: Into<Erring>>(
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

    /// Adds the setting of the rung.
    #[must_use]
    pub(super) fn set(mut self, setting: impl Into<Option<f64>>) -> Self {
        self.setting = setting.into();
        self
    }

    /// Sets the number of evaluations that each run makes.
    #[must_use]
    pub(super) fn in_a_row(mut self, evaluations: u32) -> Self {
        self.evaluation = self.evaluation.in_a_row(evaluations);
        self
    }
}
