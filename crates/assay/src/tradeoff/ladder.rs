//! Ladders. A ladder is a list of models or settings, called rungs. They answer the same question about a scene, at
//! different costs and with different errors.

use anyhow::Result;

use crate::timing::Evaluation;

/// How easy it is for the rungs (models or settings) of a ladder to be accurate on a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ease {
    Easy,
    Typical,
    Hard,
}

impl Ease {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Easy => "easy",
            Self::Typical => "typical",
            Self::Hard => "hard",
        }
    }
}

/// A ladder: several models or settings (rungs) among which a user can choose, because they answer the same question.
/// They are measured on three scenes.
pub(super) struct Ladder {
    pub(super) name: &'static str,
    /// The question that all models or settings of this ladder answer, in one line.
    pub(super) title: &'static str,
    /// Definition of the error of a model or setting: the quantity that has the error, and the scale to which the error
    /// is relative.
    pub(super) error: &'static str,
    /// Description of the computation whose cost is measured.
    pub(super) evaluation: &'static str,
    pub(super) scenes: Vec<SceneRungs>,
}

/// A scene, and the rungs (models or settings) of its ladder.
pub(super) struct SceneRungs {
    /// How easy it is for the ladder's rungs to be accurate on this scene.
    pub(super) ease: Ease,
    pub(super) scene: String,
    pub(super) rungs: Vec<Rung>,
}

impl SceneRungs {
    pub(super) fn new(ease: Ease, scene: &str, rungs: Vec<Rung>) -> Self {
        let scene = scene.to_owned();
        Self { ease, scene, rungs }
    }
}

/// Error of a rung (a model or setting), as defined by [`Ladder::error`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RungError {
    pub(super) error: f64,
    /// Standard error of `error`; `None` if the error is not computed from trials.
    pub(super) std: Option<f64>,
}

impl From<f64> for RungError {
    fn from(error: f64) -> Self {
        Self { error, std: None }
    }
}

/// A rung: one way to answer the question of a ladder, such as a model with a setting.
pub(super) struct Rung {
    /// Name of the model, sensor or method, with its setting.
    pub(super) name: String,
    /// Value of the setting that differs between the rungs, for example a number of steps, a tolerance or a pitch;
    /// `None` if the setting is not a number.
    pub(super) setting: Option<f64>,
    /// Computes the error of this model or setting. The function is called at most once, and never in the process in
    /// which instructions are counted.
    pub(super) error: Box<dyn FnOnce() -> Result<RungError>>,
    /// The computation whose cost is measured for this model or setting. Its first run includes the set-up of the
    /// scene.
    pub(super) evaluation: Evaluation,
}

impl Rung {
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

    #[must_use]
    pub(super) fn set(mut self, setting: impl Into<Option<f64>>) -> Self {
        self.setting = setting.into();
        self
    }

    #[must_use]
    pub(super) fn evaluations_per_run(mut self, evaluations: u32) -> Self {
        self.evaluation = self.evaluation.evaluations_per_run(evaluations);
        self
    }
}
