//! One press, written down.

use image::RgbImage;

use super::{PressFailure, PressReadings, PressScene, PressSensor};
use crate::tracks::of_tracks;
use palpate_study::Table;
use palpate_study::config::LengthUnit;

/// Trace of a press: the true displacements of the markers, and the readings of the sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct PressTrace {
    /// Truth: `marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y`, the radial position counted
    /// from the contact.
    pub contacts: Table,
    /// Readings, in the form that `estimate press` accepts.
    pub readings: Table,
    /// Pictures of a camera; `None` with a direct sensor.
    pub seen: Option<SeenPress>,
}

/// Pictures of a press that a camera took.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenPress {
    /// The sight of each marker: `marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status`.
    pub markers: Table,
    /// The frames at rest and pressed, if they were rendered.
    pub frames: Option<[RgbImage; 2]>,
}

impl PressScene {
    /// The indentation that an estimator is given where it is known: the truth, or in trial number `trial`.
    pub fn told_indentation(&self, trial: Option<u64>) -> f64 {
        let error = trial.map_or(0.0, |trial| self.noise.of_indentation(self.seed, trial));
        self.indentation + error
    }

    /// Pixels per radian of the camera, if there is one.
    pub fn px_per_rad(&self) -> Option<f64> {
        match &self.sensor {
            PressSensor::Camera(Ok(camera)) => Some(camera.sensor.eye.lens.px_per_rad()),
            PressSensor::Camera(Err(_)) | PressSensor::Direct => None,
        }
    }

    /// Presses once: noiseless, or as in trial number `trial`.
    ///
    /// # Errors
    /// [`PressFailure`] where there is no press, or none to be seen.
    pub fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<PressTrace, PressFailure> {
        let truth = self.truth.as_ref().map_err(|error| *error)?;
        let named = |name: &&str| format!("{name}_{}", unit.as_str());
        let truths = ["x", "y", "radial_position", "normal_displacement"];
        let tangential = ["tangential_x", "tangential_y"];
        let header = truths.iter().chain(&tangential).map(named);
        let mut contacts = Table::new(std::iter::once("marker".to_owned()).chain(header));
        let distances = self.markers.distances(self.at);
        let rows = self.places.iter().zip(distances).zip(&truth.markers);
        for (marker, (([x, y], distance), moved)) in rows.enumerate() {
            let [along_x, along_y] = moved.tangential;
            contacts.push(marker, [*x, *y, distance, moved.normal, along_x, along_y]);
        }

        let read = self.readings(trial)?;
        let sensed = self.tangential.then_some(&tangential);
        let header = ["x", "y", "normal_displacement"];
        let header = header.iter().chain(sensed.into_iter().flatten()).map(named);
        let mut readings = Table::new(header);
        let all: Vec<usize> = (0..self.places.len()).collect();
        let markers = read.tracked.as_ref().unwrap_or(&all);
        let rows = markers.iter().zip(read.normal.iter().zip(&read.tangential));
        for (&marker, (&normal, along)) in rows {
            let [x, y] = self.places[marker];
            let mut row = vec![x, y, normal];
            if self.tangential {
                row.extend(along);
            }
            readings.push_numbers(row);
        }
        Ok(PressTrace {
            contacts,
            readings,
            seen: self.seen(&read, trial)?,
        })
    }

    fn seen(
        &self,
        read: &PressReadings,
        trial: Option<u64>,
    ) -> Result<Option<SeenPress>, PressFailure> {
        match (&self.sensor, &read.sight) {
            (PressSensor::Camera(Ok(camera)), Some(sight)) => Ok(Some(SeenPress {
                markers: of_tracks(sight.tracks.iter().map(Option::as_ref)),
                frames: camera.frames(trial)?,
            })),
            _ => Ok(None),
        }
    }
}
