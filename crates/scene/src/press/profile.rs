//! Tables of true and estimated displacements along a radius.

use super::failure::PressFailure;
use super::scene::PressScene;
use palpate_study::MapTable;
use palpate_study::config::LengthUnit;

/// Number of points of a profile, from the contact's centre to three times its radius.
const PLACES: u32 = 121;
const REACH: f64 = 3.0;

impl PressScene {
    /// Empty table of profiles: true and estimated displacements against the distance from the contact. Values that
    /// an estimate does not provide stay empty.
    pub(super) fn profile_table(unit: LengthUnit) -> MapTable {
        let unit = unit.as_str();
        let header = format!(
            "cell,radial_position_{unit},normal_displacement_{unit},radial_displacement_{unit},\
             estimated_normal_displacement_{unit},estimated_radial_displacement_{unit}"
        );
        MapTable::new(&header, "estimates of cells")
    }

    /// Adds the profile of this scene, with the estimate of trial number `trial`.
    ///
    /// # Errors
    /// [`PressFailure`] without a press (no row is added) or if the trial failed (rows have true values only).
    pub(super) fn push_profile(
        &self,
        cell: usize,
        trial: u64,
        table: &mut MapTable,
    ) -> Result<(), PressFailure> {
        let contact = self.body.contact(&self.markers, &self.pressed)?;
        let estimated = self.estimated_displacement(trial);
        for place in 0..PLACES {
            let share = f64::from(place) / f64::from(PLACES - 1);
            let position = REACH * contact.radius * share;
            let estimate = match &estimated {
                Ok(displacement) => displacement(position),
                Err(_) => [None, None],
            };
            let truth = contact.displacement(position);
            table.text(cell);
            let numbers = [position, truth.normal, truth.radial].map(Some);
            for number in numbers.into_iter().chain(estimate) {
                table.number(number);
            }
            table.end_row();
        }
        estimated.map(drop)
    }

    /// Estimated normal and radial displacement of a trial, as a function of the distance from its contact.
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
        // A Gaussian's gain is its amplitude; the gain of other bodies belongs to the sensor.
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
