//! Reasons why a press told nothing.

use palpate_chromatouch::OpticsError;
use palpate_press::PressError;
use palpate_tracking::TrackingError;
use strum::IntoStaticStr;
use thiserror::Error;

/// Why a press, or a trial of it, told nothing.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
pub enum PressFailure {
    /// There is no press, or its readings fit none.
    #[error(transparent)]
    #[strum(transparent)]
    Press(#[from] PressError),
    /// The markers moved where no camera follows.
    #[error(transparent)]
    #[strum(transparent)]
    Optics(#[from] OpticsError),
    /// The camera's frame shows no markers.
    #[error(transparent)]
    #[strum(transparent)]
    Camera(#[from] TrackingError),
}

impl PressFailure {
    /// The stable name.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
