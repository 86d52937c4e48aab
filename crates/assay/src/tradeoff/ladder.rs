//! Ladders of models or settings. The rungs of a ladder answer the same question about a scene, at different costs and
//! with different errors.

use anyhow::Result;

use crate::timing::Evaluation;

/// How hard it is for the rungs of a ladder to be accurate on a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ease {
    /// A scene on which even the cheapest rungs are accurate.
    Easy,
    /// A scene similar to the scenes of most users.
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

/// A ladder: the rungs from which a user can choose, on three scenes.
pub(super) struct Ladder {
    /// Name of the ladder in the tables: lower-case words with hyphens.
    pub(super) name: &'static str,
    /// The question that the rungs answer, in one line.
    pub(super) title: &'static str,
    /// Definition of the rungs' error: the quantity that has the error, and the scale to which the error is relative.
    pub(super) error: &'static str,
    /// Description of the evaluation whose cost is measured.
    pub(super) evaluation: &'static str,
    /// Three scenes: an easy, a typical and a hard scene.
    pub(super) scenes: Vec<SceneRungs>,
}

/// A scene and its rungs.
pub(super) struct SceneRungs {
    /// Difficulty of the scene.
    pub(super) ease: Ease,
    /// Short description of the scene.
    pub(super) scene: String,
    /// The rungs, in the order of the ladder.
    pub(super) rungs: Vec<Rung>,
}

#[cfg(test)]
impl SceneRungs {
    /// Computes the errors of all rungs.
    pub(super) fn errors(self) -> Vec<f64> {
        let errors = self.rungs.into_iter().map(|rung| (rung.error)());
        errors.map(|error| error.unwrap().error).collect()
    }
}

/// Error of a rung, in the sense of [`Ladder::error`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RungError {
    pub(super) error: f64,
    /// Standard error of the rung's error; `None` if the error is not computed from trials.
    pub(super) std: Option<f64>,
}

impl From<f64> for RungError {
    fn from(error: f64) -> Self {
        Self { error, std: None }
    }
}

/// A rung: one way to answer the question of a ladder, such as a model with a setting.
pub(super) struct Rung {
    /// Name of the rung, with its setting.
    pub(super) name: String,
    /// Setting of the rung if it is a number, for example a number of steps, a tolerance or a pitch.
    pub(super) setting: Option<f64>,
    /// Computes the error of the rung. The function is called at most once, and never in the process in which
    /// instructions are counted.
    pub(super) error: Box<dyn FnOnce() -> Result<RungError>>,
    /// The computation whose cost is measured. Its first run includes the set-up of the scene.
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

    /// Adds the setting of the rung, as a number.
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
