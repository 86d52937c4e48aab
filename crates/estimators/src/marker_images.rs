//! The estimator that fits the images of the markers in a camera's frames.

use std::sync::{Arc, OnceLock};

use palpate_press::{
    ImageFit, MarkerDisplacement, Measured, Misfit, PressError, PressEstimate, Rest, Seen,
};
use palpate_study::{Column, Table, number};
use palpate_tracking::{MarkerErrors, Track};

use crate::image_model::marker_image;

/// Input of [`ImageEstimator`]: the images of the markers.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerImages {
    /// Images of the markers at rest in this trial; `None` if all trials use the same images at rest.
    pub own_rest: Option<Arc<[Option<Seen>]>>,
    /// Images of the markers in the press; `None` for markers without an image in the press.
    pub pressed: Vec<Option<Seen>>,
}

/// Estimates presses by a fit to marker images. All trials share the images of the markers at rest, unless
/// [`MarkerImages::own_rest`] contains other images.
#[derive(Clone, Debug)]
pub struct ImageEstimator {
    fit: ImageFit,
    rest: Vec<Option<Seen>>,
    fitted: OnceLock<Result<Rest, PressError>>,
}

impl ImageEstimator {
    /// An estimator that uses the fit `fit`. `rest` contains the images of the markers at rest, which are the same for
    /// all trials.
    pub fn new(fit: ImageFit, rest: Vec<Option<Seen>>) -> Self {
        Self {
            fit,
            rest,
            fitted: OnceLock::new(),
        }
    }

    /// Estimates the press from images of the markers.
    ///
    /// # Errors
    /// [`PressError`] of the fit to the press, or of the fit to the markers at rest.
    pub fn estimate(
        &self,
        pictures: &MarkerImages,
        indentation: Option<Measured>,
    ) -> Result<PressEstimate, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.estimate(rest, &pictures.pressed, indentation)
        })
    }

    /// Compares a stated indentation with the indentation estimated from the images alone.
    ///
    /// # Errors
    /// The reason why the images alone do not determine the indentation.
    pub fn check_indentation(
        &self,
        pictures: &MarkerImages,
        indentation: Option<Measured>,
    ) -> Result<Option<Misfit>, PressError> {
        self.with_rest(pictures, |rest| {
            let seen = &pictures.pressed;
            self.fit.check_indentation(rest, seen, indentation)
        })
    }

    /// Contradictions between the images and the model of the estimator, such as outliers.
    pub fn misfits(
        &self,
        pictures: &MarkerImages,
        indentation: Option<Measured>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Misfit>, PressError> {
        self.with_rest(pictures, |rest| {
            let seen = &pictures.pressed;
            self.fit.misfits(rest, seen, indentation, estimate)
        })
    }

    /// Residual displacement of each marker: the displacement that is estimated from the marker's own image, minus the
    /// displacement that is predicted from the estimated press.
    pub fn beyond(
        &self,
        pictures: &MarkerImages,
        press: &PressEstimate,
    ) -> Result<Vec<Option<MarkerDisplacement>>, PressError> {
        self.with_rest(pictures, |rest| {
            self.fit.beyond(rest, &pictures.pressed, press)
        })
    }

    fn with_rest<T>(
        &self,
        pictures: &MarkerImages,
        then: impl FnOnce(&Rest) -> Result<T, PressError>,
    ) -> Result<T, PressError> {
        let own;
        let rest = match &pictures.own_rest {
            Some(rest) => {
                own = self.fit.at_rest(rest)?;
                &own
            }
            None => self.rest()?,
        };
        then(rest)
    }

    /// The estimated parameters of the sensor. They are estimated only once, from the images at rest that all trials
    /// share.
    pub fn rest(&self) -> Result<&Rest, PressError> {
        let fitted = self.fitted.get_or_init(|| self.fit.at_rest(&self.rest));
        fitted.as_ref().map_err(|error| *error)
    }
}

/// Images of the tracked markers in the press, with their errors; `None` for markers that are not tracked.
pub fn pressed_images(
    tracks: &[Option<Track>],
    errors: &[Option<MarkerErrors>],
) -> Vec<Option<Seen>> {
    let pairs = tracks.iter().zip(errors);
    pairs
        .map(|(track, errors)| {
            let track = (*track)?;
            track.change()?;
            Some(marker_image(&track.pressed?, errors.as_ref()?))
        })
        .collect()
}

/// Table with one row per marker. The row contains the marker's position and hues at rest. If the marker is visible
/// only in the pressed frame, the row contains its position and hues in this frame instead. If the marker was tracked,
/// the row also contains the changes between the two frames. Values that were not measured are left empty.
pub fn tracks_table<'a>(tracks: impl Iterator<Item = Option<&'a Track>>) -> Table {
    let mut table = Table::new([
        Column::count("marker"),
        Column::number("x_px", "px"),
        Column::number("y_px", "px"),
        Column::number("hue_turns", "turn"),
        Column::number("dx_px", "px"),
        Column::number("dy_px", "px"),
        Column::number("dhue_turns", "turn"),
        Column::text("status"),
        Column::number("mean_hue_turns", "turn"),
        Column::number("dmean_hue_turns", "turn"),
    ]);
    for (marker, track) in tracks.enumerate() {
        let image = track.and_then(|track| track.rest.or(track.pressed));
        let change = track.and_then(Track::change);
        let text = |one: Option<f64>| one.map_or_else(String::new, number);
        let numbers = [
            image.map(|image| image.centroid_px[0]),
            image.map(|image| image.centroid_px[1]),
            image.map(|image| image.hue_turns),
            change.map(|change| change.shift_px[0]),
            change.map(|change| change.shift_px[1]),
            change.map(|change| change.hue_turns),
        ];
        let status = track.map_or("not-seen", |track| track.status.into());
        let mut row = vec![marker.to_string()];
        row.extend(numbers.map(text));
        row.push(status.to_owned());
        row.push(text(image.map(|image| image.mean_hue_turns)));
        row.push(text(change.and_then(|_| track?.mean_hue_change())));
        table.rows.push(row);
    }
    table
}
