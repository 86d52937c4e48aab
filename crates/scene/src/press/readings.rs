//! Readings of a press.

use super::camera::Sight;

/// What a sensor tells of one press, and what the estimator is told with it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MarkerReadings {
    /// Indices of the tracked markers, in ascending order; `None` if all are tracked.
    pub(super) tracked: Option<Vec<usize>>,
    pub(super) normal: Vec<f64>,
    pub(super) tangential: Vec<[f64; 2]>,
    /// Indentation as it is told.
    pub(super) indentation: f64,
    /// Markers as a camera saw them; `None` with a direct sensor.
    pub(super) sight: Option<Sight>,
}

impl MarkerReadings {
    /// Leaves out the markers that were not tracked.
    pub(super) fn keep_tracked(&mut self) {
        if let Some(tracked) = &self.tracked {
            self.normal = tracked.iter().map(|&marker| self.normal[marker]).collect();
            self.tangential = tracked
                .iter()
                .map(|&marker| self.tangential[marker])
                .collect();
        }
    }
}
