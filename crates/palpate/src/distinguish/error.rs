//! Why objects cannot be told apart at all.

use palpate_study::config::ConfigError;
use thiserror::Error;

/// Most cells; their trials' estimates are kept.
pub(crate) const MOST_CELLS: usize = 1000;

/// Objects that cannot be told apart at all.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DistinguishError {
    /// Config that makes no scene.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Study that sweeps no object.
    #[error(
        "no field of `scene.object` is swept, so that there is nothing to tell apart; \
         `--vary scene.object.radius=20,25,30` would be such a sweep"
    )]
    NoObjects,
    /// Scene that has no such quantity, or none that is estimated.
    #[error("a {scene} has no quantity {name:?} that tells objects apart (known: {known})")]
    NoQuantity {
        /// Kind of the scene.
        scene: &'static str,
        /// Name of the quantity.
        name: String,
        /// Quantities that it has.
        known: String,
    },
    /// Confidence that is out of its range.
    #[error("confidence is {0}; it must be above 0 and below 1")]
    Confidence(f64),
    /// More cells than are looked at.
    #[error("the study has {0} cells, and at most {MOST_CELLS} are looked at")]
    TooManyCells(usize),
}
