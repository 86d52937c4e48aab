//! Tables of one press: its trace (true values and readings), and the profile of its displacements along a radius.

use palpate_estimators::tracks_table;
use palpate_press::ObjectContact;
use palpate_study::config::{LengthUnit, PressEstimatorConfig};
use palpate_study::number::shortest;
use palpate_study::readings::{COLUMNS, table_columns};
use palpate_study::{Column, Table, Unit};

use super::PressFailure;
use super::trial::PressScene;
use crate::trace::{CameraTrace, Trace, counted};

/// Number of points of a profile. A profile is a table of the displacement as a function of the distance from the
/// middle of the contact.
const PLACES: u32 = 121;
/// Length of a profile (displacement as a function of the distance from the contact), in contact radii. The profile
/// begins at the centre of the contact; for an elliptic contact, it runs along the longer axis.
const REACH: f64 = 3.0;

impl PressScene {
    /// Records the true displacements and the readings of one press. The readings have the noise of trial number
    /// `trial`; they have no noise if `trial` is `None`.
    pub(super) fn record(
        &self,
        trial: Option<u64>,
        unit: LengthUnit,
    ) -> Result<Trace, PressFailure> {
        let (truth, sensor) = self.case.press()?;
        let truths = ["x", "y", "radial_position", "normal_displacement"];
        let truths = Column::in_length(truths, Unit::Length, unit);
        let tangential = Column::in_length(["tangential_x", "tangential_y"], Unit::Length, unit);
        let columns = std::iter::once(Column::count("marker")).chain(truths);
        let mut contacts = Table::new(columns.chain(tangential));
        let distances = self.markers.distances(self.geometry.at);
        let rows = self.places.iter().zip(distances).zip(&truth.markers);
        for (marker, (([x, y], distance), moved)) in rows.enumerate() {
            let [along_x, along_y] = moved.tangential;
            contacts.push(marker, [*x, *y, distance, moved.normal, along_x, along_y]);
        }

        let reading = self.reading(trial)?;
        let columns = if self.has_tangential { 5 } else { 3 };
        let mut readings = Table::new(table_columns(&COLUMNS.presses[..columns], unit));
        for (marker, normal, tangential) in reading.markers() {
            let [x, y] = self.places[marker];
            let row = [x, y, normal].into_iter().chain(tangential);
            readings.push_numbers(row.take(columns));
        }
        let scale = sensor.camera().map_or_else(String::new, |sensor| {
            let px_per_rad = sensor.camera.optics.camera().px_per_rad();
            format!(", camera with {px_per_rad:.3} px per rad")
        });
        let count = match readings.rows.len() {
            all if all == contacts.rows.len() => String::new(),
            some => format!("{some} of "),
        };
        let camera = match (sensor.camera(), reading.camera) {
            (Some(sensor), Some(camera)) => Some(CameraTrace {
                markers: tracks_table(camera.tracks.tracks.iter().map(Option::as_ref)),
                frames: sensor.frames(truth, trial)?,
            }),
            _ => None,
        };
        Ok(Trace {
            what: format!(
                "{count}{} under a stated indentation of {} {}{scale}",
                counted(contacts.rows.len(), "marker"),
                reading.indentation,
                unit.as_str()
            ),
            contacts,
            readings,
            camera,
        })
    }

    /// Empty table of profiles. A profile contains true and estimated displacements as functions of the distance from
    /// the contact. Fields stay empty if there is no estimate.
    pub(crate) fn profile_table(unit: LengthUnit) -> Table {
        let names = [
            "radial_position",
            "normal_displacement",
            "radial_displacement",
            "estimated_normal_displacement",
            "estimated_radial_displacement",
        ];
        let lengths = Column::in_length(names, Unit::Length, unit);
        Table::new(std::iter::once(Column::count("cell")).chain(lengths))
    }

    /// Adds the displacement profile of this scene to the table, with the estimate of trial number `trial`.
    ///
    /// # Errors
    /// [`PressFailure`] if the press is impossible or the trial failed. If the press is impossible, no row is added. If
    /// the trial failed, the rows contain only true values.
    pub(super) fn push_profile(
        &self,
        cell: usize,
        trial: u64,
        table: &mut Table,
    ) -> Result<(), PressFailure> {
        let contact = self.geometry.contact(&self.body, &self.markers)?;
        let estimated = self.estimated_displacement(trial);
        for place in 0..PLACES {
            let share = f64::from(place) / f64::from(PLACES - 1);
            let position = REACH * contact.radius() * share;
            let estimate = estimated.as_ref();
            let estimate = estimate.map_or([None, None], |displacement| displacement(position));
            let truth = contact.displacement(position);
            let numbers = [position, truth.normal, truth.radial].map(Some).into_iter();
            let numbers = numbers.chain(estimate);
            let texts = numbers.map(|number| number.map_or_else(String::new, shortest));
            table
                .rows
                .push([cell.to_string()].into_iter().chain(texts).collect());
        }
        estimated.map(drop)
    }

    /// Estimated normal and radial displacement in a trial, as functions of the distance from the estimated contact.
    fn estimated_displacement(
        &self,
        trial: u64,
    ) -> Result<impl Fn(f64) -> [Option<f64>; 2], PressFailure> {
        let estimate = self.estimate(&self.reading(Some(trial))?)?;
        let body = &self.estimator.fit()?.body;
        let contact = match (&estimate.principal, self.body.sideways()) {
            (Some(principal), Some((_, depth))) => {
                ObjectContact::Elliptic(principal.contact, depth)
            }
            _ => ObjectContact::Round(body.press(
                estimate.relative_curvature.value,
                estimate.indentation.value,
            )?),
        };
        let estimator = &self.config.estimator;
        let moves_tangentially = !matches!(estimator, PressEstimatorConfig::Gaussian { .. });
        // If the estimator fits a Gaussian, the estimated gain is the amplitude of the displacement. For other
        // estimators, the estimated gain is a property of the sensor, which does not change the displacement.
        let amplitude = estimate
            .gain
            .filter(|_| !moves_tangentially)
            .map_or(1.0, |gain| gain.value);
        Ok(move |distance| {
            let moved = contact.displacement(distance);
            [
                Some(amplitude * moved.normal),
                moves_tangentially.then_some(moved.radial),
            ]
        })
    }
}
