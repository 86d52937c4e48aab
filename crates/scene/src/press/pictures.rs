//! The estimator that fits the camera's pictures of the markers.

use std::sync::{Arc, OnceLock};

use palpate_press::{
    Doubt, ImageFit, KnownPress, MarkerDisplacement, Measured, PressError, PressEstimate, Rest,
    Seen,
};
use palpate_tracking::{MarkerErrors, Track};

use super::picture_law::{PictureLaw, seen_of};

/// Input of a fit of pictures: the pictures of the markers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pictures {
    /// The markers at rest; `None` if all trials share one reading at rest.
    pub(crate) own_rest: Option<Arc<[Option<Seen>]>>,
    /// Calibration presses of this trial's sensor; empty if it is not calibrated.
    pub(crate) calibrating: Vec<KnownPress>,
    /// The markers in the press.
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

    /// Warnings that the pictures contradict the model of the estimate.
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

    /// Residual displacements of the markers: estimated from their own pictures, minus those of the estimated press.
    pub(crate) fn beyond(
        &self,
        pictures: &Pictures,
        press: &PressEstimate,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.beyond(rest, &pictures.pressed, press)
        })
    }

    /// Cramér–Rao bound on the standard deviation of the relative curvature, for a press with this relative
    /// curvature, chart coordinates and indentation.
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

    /// The sensor as estimated from the frame at rest that trials share.
    pub(crate) fn rest(&self) -> Result<&Rest, PressError> {
        let fitted = self.fitted.get_or_init(|| self.fit.at_rest(&self.rest));
        fitted.as_ref().map_err(|error| *error)
    }
}

/// Pictures of the tracked markers in the press, with their errors; `None` for other markers.
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
