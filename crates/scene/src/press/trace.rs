//! Tables of one press.

use super::failure::PressFailure;
use super::readings::MarkerReadings;
use super::scene::{PressScene, PressSensor};
use crate::trace::{SeenPress, Trace, counted};
use palpate_estimators::tracks_table;
use palpate_study::Table;
use palpate_study::config::LengthUnit;

impl PressScene {
    /// Records one press: in trial number `trial`, or without noise if it is `None`.
    pub(super) fn followed(
        &self,
        trial: Option<u64>,
        unit: LengthUnit,
    ) -> Result<Trace, PressFailure> {
        let truth = self.truth.as_ref().map_err(|error| *error)?;
        let unit = unit.as_str();
        let named = |name: &&str| format!("{name}_{unit}");
        let truths = ["x", "y", "radial_position", "normal_displacement"];
        let tangential = ["tangential_x", "tangential_y"];
        let header = truths.iter().chain(&tangential).map(named);
        let mut contacts = Table::new(std::iter::once("marker".to_owned()).chain(header));
        let distances = self.markers.distances(self.pressed.at);
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
        let camera = match &self.sensor {
            PressSensor::Camera(Ok(camera)) => {
                let px_per_rad = camera.sensor.eye.lens.px_per_rad();
                format!(", seen with {px_per_rad:.3} px per rad")
            }
            PressSensor::Camera(Err(_)) | PressSensor::Direct => String::new(),
        };
        let some = match readings.rows.len() {
            all if all == contacts.rows.len() => String::new(),
            some => format!("{some} of "),
        };
        Ok(Trace {
            what: format!(
                "{some}{} under an indentation told as {} {unit}{camera}",
                counted(contacts.rows.len(), "marker"),
                read.indentation
            ),
            contacts,
            readings,
            seen: self.seen(&read, trial)?,
        })
    }

    fn seen(
        &self,
        read: &MarkerReadings,
        trial: Option<u64>,
    ) -> Result<Option<SeenPress>, PressFailure> {
        match (&self.sensor, &read.sight) {
            (PressSensor::Camera(Ok(camera)), Some(sight)) => Ok(Some(SeenPress {
                markers: tracks_table(sight.tracks.iter().map(Option::as_ref)),
                frames: camera.frames(trial)?,
            })),
            _ => Ok(None),
        }
    }
}
