//! The estimator that fits what the camera sees.

use std::sync::{Arc, OnceLock};

use palpate_press::{
    Doubt, ImageFit, KnownPress, MarkerDisplacement, Measured, PressError, PressEstimate, Rest,
    Seen,
};
use palpate_tracking::{MarkerErrors, Track};

use super::picture_law::{PictureLaw, seen_of};

/// Pictures of the markers that a fit is given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pictures {
    /// The markers at rest; `None` where all trials share them.
    pub(crate) own_rest: Option<Arc<[Option<Seen>]>>,
    /// Presses that calibrate the sensor of this trial; none where it is known as it is.
    pub(crate) calibrating: Vec<KnownPress>,
    /// The markers pressed.
    pub(crate) pressed: Vec<Option<Seen>>,
}

/// A fit of pictures, and the frame at rest that trials share.
#[derive(Clone, Debug)]
pub(crate) struct PictureMethod {
    fit: ImageFit<PictureLaw>,
    rest: Vec<Option<Seen>>,
    fitted: OnceLock<Result<Rest, PressError>>,
}

impl PictureMethod {
    pub(crate) fn new(fit: ImageFit<PictureLaw>, rest: Vec<Option<Seen>>) -> Self {
        Self {
            fit,
            rest,
            fitted: OnceLock::new(),
        }
    }

    pub(crate) fn estimate(
        &self,
        pictures: &Pictures,
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.estimate(rest, &pictures.pressed, indentation)
        })
    }

    /// Ways in which the pictures contradict the model, of an estimate from them.
    pub(crate) fn doubts(
        &self,
        pictures: &Pictures,
        indentation: Option<Measured>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressError> {
        self.with_rest(pictures, |rest| {
            let seen = &pictures.pressed;
            self.fit.doubts(rest, seen, indentation, estimate)
        })
    }

    /// Displacements of the markers beyond those of an estimated press, as their own pictures tell them.
    pub(crate) fn beyond(
        &self,
        pictures: &Pictures,
        press: &PressEstimate,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.beyond(rest, &pictures.pressed, press)
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
                own = self.fit.calibrated(rest, &pictures.calibrating)?;
                &own
            }
            None => self.rest()?,
        };
        then(rest)
    }

    /// The sensor as the frame at rest that trials share shows it.
    pub(crate) fn rest(&self) -> Result<&Rest, PressError> {
        let fitted = self.fitted.get_or_init(|| self.fit.at_rest(&self.rest));
        fitted.as_ref().map_err(|error| *error)
    }
}

/// The pictures of markers that were found again as they were, with the errors of what is seen pressed.
pub(crate) fn pressed(
    tracks: &[Option<Track>],
    errors: &[Option<MarkerErrors>],
) -> Vec<Option<Seen>> {
    let pairs = tracks.iter().zip(errors);
    pairs
        .map(|(track, errors)| {
            let track = (*track)?;
            track.change()?;
            Some(seen_of(&track.pressed?, errors.as_ref()?))
        })
        .collect()
}
