//! What a ladder is: rungs that answer the same question about a scene, each at its own cost and error.

use anyhow::Result;

use crate::measured::Evaluation;

/// How much a scene asks of a ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ease {
    /// The cheapest rungs were made for it.
    Easy,
    /// What users have.
    Typical,
    /// Where rungs give out.
    Hard,
}

impl Ease {
    /// As the tables say it.
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
    /// What the error is, and of what it is a share.
    pub(super) error: &'static str,
    /// What is evaluated once.
    pub(super) evaluation: &'static str,
    /// Easy, typical, hard.
    pub(super) scenes: Vec<SceneRungs>,
}

/// A scene, and the rungs that can do it.
pub(super) struct SceneRungs {
    /// How much it asks.
    pub(super) ease: Ease,
    /// The scene in a few words.
    pub(super) scene: String,
    /// In the order of the ladder.
    pub(super) rungs: Vec<Rung>,
}

/// One way to answer.
pub(super) struct Rung {
    /// What it is called, setting included.
    pub(super) name: String,
    /// The number that is set, where there is one: steps, a tolerance, a pitch.
    pub(super) setting: Option<f64>,
    /// Relative error against the truth. Asked for once, and not by the process that counts instructions.
    pub(super) error: Box<dyn FnOnce() -> Result<f64>>,
    /// What it costs. What it needs beforehand is made at its first run.
    pub(super) evaluation: Evaluation,
}

impl Rung {
    /// A rung without a number that is set.
    pub(super) fn new<T>(
        name: impl Into<String>,
        error: impl FnOnce() -> Result<f64> + 'static,
        evaluate: impl FnMut() -> T + 'static,
    ) -> Self {
        let name = name.into();
        Self {
            evaluation: Evaluation::new(name.clone(), evaluate),
            name,
            setting: None,
            error: Box::new(error),
        }
    }

    /// The same with what is set.
    #[must_use]
    pub(super) fn set(mut self, setting: impl Into<Option<f64>>) -> Self {
        self.setting = setting.into();
        self
    }

    /// The same whose evaluation is so many in a row.
    #[must_use]
    pub(super) fn in_a_row(mut self, evaluations: u32) -> Self {
        self.evaluation = self.evaluation.in_a_row(evaluations);
        self
    }
}
