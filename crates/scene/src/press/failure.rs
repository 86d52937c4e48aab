//! Reasons why a press told nothing.

use palpate_chromatouch::OpticsError;
use palpate_press::PressError;
use palpate_tracking::TrackingError;
use thiserror::Error;

/// Why a press, or a trial of it, told nothing.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PressFailure {
    /// There is no press, or its readings fit none.
    #[error(transparent)]
    Press(#[from] PressError),
    /// The markers moved where no camera follows.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// The camera's frame shows no markers.
    #[error(transparent)]
    Camera(#[from] TrackingError),
}

impl PressFailure {
    /// The stable name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Press(error) => error.name(),
            Self::Optics(error) => error.name(),
            Self::Camera(error) => error.name(),
        }
    }
}
