//! States from which a fit of pictures begins.

use nalgebra::Vector3;

use super::law::State;
use super::problem::Problem;
use super::view::{View, difference};
use crate::PressError;

/// Radii of the contact that are tried, in radii of the sensor.
const RADII: [f64; 4] = [0.08, 0.14, 0.22, 0.35];
/// The size among a picture's numbers.
const SIZE: usize = 3;
/// Markers that moved most at which contacts are tried too.
const BESIDE: usize = 2;

impl<V: View> Problem<'_, V> {
    /// States, the likeliest first.
    pub(super) fn starts(&self) -> Result<Vec<State>, PressError> {
        let skin = self.fit.markers.skin();
        let at_rest = &self.rest.slopes.pictures;
        // Seen from the centre, a disc that comes nearer by a share of its distance grows by that share.
        let mut inward: Vec<(f64, usize)> = Vec::new();
        for &marker in &self.counting {
            if let (Some(seen), Some(rest)) = (&self.seen[marker], &at_rest[marker]) {
                let growth = 0.5 * difference(&seen.picture, rest)[SIZE];
                inward.push((-skin.radius() * libm::expm1(-growth), marker));
            }
        }
        inward.sort_by(|one, other| other.0.total_cmp(&one.0));
        let Some(&(most, _)) = inward.first() else {
            return Ok(Vec::new());
        };
        let places = self.fit.markers.places();
        let direction = |marker: usize| *places[marker].direction.as_ref();
        let among = inward.iter().filter(|(moved, _)| *moved > 0.4 * most);
        let mean: Vector3<f64> = among
            .map(|&(moved, marker)| direction(marker) * (moved * moved))
            .sum();
        let known = self.indentation.map(|known| known.value);
        let deepest = known.unwrap_or(1.15 * most);
        let state = |direction: &Vector3<f64>, share: f64| {
            let [unit, _] = self.fit.bodies[0]
                .indentation_of(share * skin.radius())
                .ok()?;
            let state = State {
                log_curvature: libm::log(deepest / unit),
                place: skin.place_at(direction),
                indentation: deepest,
                shift: [0.0; 2],
            };
            let residuals = self.residuals(&state).ok()?;
            Some((self.cost(&state, &residuals).ok()?, share, state))
        };
        let mut states: Vec<_> = RADII
            .iter()
            .filter_map(|&share| state(&mean, share))
            .collect();
        // The width that serves best there is tried at the markers that moved most.
        let best = states.iter().min_by(|one, other| one.0.total_cmp(&other.0));
        if let Some(&(_, width, _)) = best {
            let beside = inward.iter().take(BESIDE);
            states.extend(beside.filter_map(|one| state(&direction(one.1), width)));
        }
        states.sort_by(|one, other| one.0.total_cmp(&other.0));
        Ok(states.into_iter().map(|(_, _, state)| state).collect())
    }
}
