//! The estimator that fits what the camera sees.

use std::sync::{Arc, OnceLock};

use palpate_press::{ImageFit, Measured, PressError, PressEstimate, Rest, Seen};

use super::camera::{Sight, Spotted};
use super::picture_law::{PictureLaw, seen};

/// Pictures of the markers that a fit is given.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pictures {
    /// The markers at rest; `None` where all trials share them.
    pub(super) own_rest: Option<Arc<[Option<Seen>]>>,
    /// The markers pressed.
    pub(super) pressed: Vec<Option<Seen>>,
}

/// A fit of pictures, and the frame at rest that trials share.
#[derive(Clone, Debug)]
pub(super) struct PictureMethod {
    fit: ImageFit<PictureLaw>,
    rest: Vec<Option<Seen>>,
    fitted: OnceLock<Result<Rest, PressError>>,
}

impl PictureMethod {
    pub(super) fn new(fit: ImageFit<PictureLaw>, rest: &[Option<Spotted>]) -> Self {
        Self {
            fit,
            rest: rest.iter().map(|one| Some(seen(one.as_ref()?))).collect(),
            fitted: OnceLock::new(),
        }
    }

    pub(super) fn estimate(
        &self,
        pictures: &Pictures,
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.estimate(rest, &pictures.pressed, indentation)
        })
    }

    /// The Cramér–Rao bound on the standard deviation of the relative curvature: of a press of this relative curvature at
    /// these chart coordinates, this deep.
    pub(super) fn std_bound(
        &self,
        pictures: &Pictures,
        indentation: Option<Measured>,
        (curvature, at, depth): (f64, [f64; 2], f64),
    ) -> Option<f64> {
        self.with_rest(pictures, |rest| {
            let seen = &pictures.pressed;
            self.fit
                .std_bound(rest, seen, indentation, (curvature, at, depth))
        })
        .ok()
    }

    fn with_rest<T>(
        &self,
        pictures: &Pictures,
        then: impl FnOnce(&Rest) -> Result<T, PressError>,
    ) -> Result<T, PressError> {
        let own;
        let rest = match &pictures.own_rest {
            Some(rest) => {
                own = self.fit.at_rest(rest)?;
                &own
            }
            None => {
                let fitted = self.fitted.get_or_init(|| self.fit.at_rest(&self.rest));
                fitted.as_ref().map_err(|error| *error)?
            }
        };
        then(rest)
    }
}

/// The pictures of markers that were found again as they were.
pub(super) fn pressed(sight: &Sight) -> Vec<Option<Seen>> {
    let pairs = sight.tracks.iter().zip(&sight.errors);
    pairs
        .map(|(track, errors)| {
            let track = (*track)?;
            track.change()?;
            Some(seen(&Spotted {
                marker: track.pressed?,
                errors: (*errors)?,
            }))
        })
        .collect()
}
