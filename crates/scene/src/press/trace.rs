//! One press, written down.

use palpate_press::PressError;

use super::PressScene;
use crate::Table;
use crate::config::LengthUnit;

/// What a press does to the markers, and what the sensor says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct PressTrace {
    /// Truth: `marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y`, the radial position counted
    /// from the contact.
    pub contacts: Table,
    /// What `estimate press` accepts.
    pub readings: Table,
}

impl PressScene {
    /// The indentation that an estimator is given where it is known: the truth, or in trial number `trial`.
    pub fn told_indentation(&self, trial: Option<u64>) -> f64 {
        let error = trial.map_or(0.0, |trial| self.noise.of_indentation(self.seed, trial));
        self.indentation + error
    }

    /// Presses once: noiseless, or as in trial number `trial`.
    ///
    /// # Errors
    /// [`PressError`] where there is no press.
    pub fn trace(&self, trial: Option<u64>, unit: LengthUnit) -> Result<PressTrace, PressError> {
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
        let sensed = self.sensor.tangential.then_some(&tangential);
        let header = ["x", "y", "normal_displacement"];
        let header = header.iter().chain(sensed.into_iter().flatten()).map(named);
        let mut readings = Table::new(header);
        for (marker, [x, y]) in self.places.iter().enumerate() {
            let mut row = vec![*x, *y, read.normal[marker]];
            if self.sensor.tangential {
                row.extend(read.tangential[marker]);
            }
            readings.push_numbers(row);
        }
        Ok(PressTrace { contacts, readings })
    }
}
