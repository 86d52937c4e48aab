//! Displacements along a radius, true and estimated, written down.

use std::fmt::Write;

use palpate_press::Displacement;

use super::{PressFailure, PressScene};
use palpate_study::config::LengthUnit;

/// Profiles as CSV: displacements against the distance from the contact, of the model and of an estimate. What an
/// estimate does not know is empty.
#[derive(Clone, Debug)]
pub struct ProfileTable {
    csv: String,
}

/// Places of a profile, from the contact's middle to three times its radius.
const PLACES: u32 = 121;
const REACH: f64 = 3.0;

impl ProfileTable {
    /// A table of the profiles of a study's cells.
    pub fn of_cells(unit: LengthUnit) -> Self {
        let unit = unit.as_str();
        let csv = format!(
            "cell,radial_position_{unit},normal_displacement_{unit},radial_displacement_{unit},\
             estimated_normal_displacement_{unit},estimated_radial_displacement_{unit}\n"
        );
        Self { csv }
    }

    /// The table as CSV text.
    pub fn into_csv(self) -> String {
        self.csv
    }

    fn push(
        &mut self,
        cell: usize,
        position: f64,
        truth: Displacement,
        estimate: [Option<f64>; 2],
    ) {
        let _ = write!(self.csv, "{cell}");
        let numbers = [position, truth.normal, truth.radial].map(Some);
        for number in numbers.into_iter().chain(estimate) {
            self.csv.push(',');
            if let Some(number) = number {
                // Zero without a sign.
                let _ = write!(self.csv, "{}", number + 0.0);
            }
        }
        self.csv.push('\n');
    }
}

impl PressScene {
    /// Adds the profile of this scene, with the estimate of trial number `trial`.
    ///
    /// # Errors
    /// Why there is no press, and so no row; or why the trial failed, and rows have the truth alone.
    pub fn profile(
        &self,
        cell: usize,
        trial: u64,
        table: &mut ProfileTable,
    ) -> Result<(), PressFailure> {
        let contact = self.contact()?;
        let estimated = self.estimated_displacement(trial);
        for place in 0..PLACES {
            let share = f64::from(place) / f64::from(PLACES - 1);
            let position = REACH * contact.radius * share;
            let estimate = match &estimated {
                Ok(displacement) => displacement(position),
                Err(_) => [None, None],
            };
            table.push(cell, position, contact.displacement(position), estimate);
        }
        estimated.map(drop)
    }

    /// The normal and radial displacement that a trial's estimate has at a distance from its contact.
    fn estimated_displacement(
        &self,
        trial: u64,
    ) -> Result<impl Fn(f64) -> [Option<f64>; 2], PressFailure> {
        let estimate = self.estimate(Some(trial))?;
        let body = &self.method.fit.as_ref().map_err(|error| *error)?.body;
        let contact = body.press(
            estimate.relative_curvature.value,
            estimate.indentation.value,
        )?;
        let moves_tangentially = body.moves_tangentially();
        // The gain of a body is the sensor's; that of a Gaussian is its amplitude.
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
