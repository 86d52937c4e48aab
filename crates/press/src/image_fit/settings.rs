//! Settings of a fit of pictures.

use super::told::{Known, Told};
use super::view::View;
use crate::{Body, Markers, PressError};

/// A least-squares fit of the pictures of one press: over relative curvature, place of the contact, indentation and,
/// where it may be, the object's sideways shift.
#[derive(Clone, Debug)]
pub struct ImageFit<V> {
    /// How the camera sees the markers.
    pub view: V,
    /// Markers, with their places under the skin.
    pub markers: Markers,
    /// The forward law at the depths of the magenta and the yellow discs.
    pub bodies: [Body; 2],
    /// The forward law where the discs lie deeper by this length, which is of use where their depths are not exact.
    pub deeper: Option<(f64, [Body; 2])>,
    /// Standard deviations of the departures of [`SensorState::common`](super::view::SensorState); 0 for exact ones.
    pub common_stds: Vec<f64>,
    /// Departures among these whose joint covariance something else tells.
    pub told: Option<Told>,
    /// Standard deviation of either component of a marker's misalignment, rad; 0 where the discs are aligned.
    pub misalignment_std: f64,
    /// Standard deviation of either component of a sideways shift of the object after it touched, length; 0 where it
    /// does not move sideways. Of half-spaces alone.
    pub shift_std: f64,
}

impl<V: View> ImageFit<V> {
    /// Refuses settings that are out of range.
    pub(super) fn validate(&self) -> Result<(), PressError> {
        for std in &self.common_stds {
            squarable("common_stds", *std)?;
        }
        squarable("misalignment_std", self.misalignment_std)?;
        squarable("shift_std", self.shift_std)?;
        self.known()?;
        if let Some((deeper, _)) = self.deeper {
            let good = deeper > 0.0 && deeper <= 1e50;
            PressError::unless_good("deeper", deeper, good, "> 0 and at most 1e50")?;
        }
        Ok(())
    }

    /// Departures that something else tells, if any are.
    pub(super) fn known(&self) -> Result<Option<Known>, PressError> {
        let told = self.told.as_ref();
        told.map(|told| told.known(&self.common_stds)).transpose()
    }

    /// Numbers of the common departures that are not exact, with their standard deviations.
    pub(super) fn free_stds(&self) -> Vec<(usize, f64)> {
        let stds = self.common_stds.iter().copied().enumerate();
        stds.filter(|(_, std)| *std > 0.0).collect()
    }

    /// Numbers of the common departures that are not exact.
    pub(super) fn free(&self) -> Vec<usize> {
        let free = self.free_stds().into_iter();
        free.map(|(number, _)| number).collect()
    }
}

fn squarable(setting: &'static str, std: f64) -> Result<(), PressError> {
    let good = std == 0.0 || (1e-100..=1e100).contains(&std);
    PressError::unless_good(setting, std, good, "0 or from 1e-100 to 1e100").map(|_| ())
}
