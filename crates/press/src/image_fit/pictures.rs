//! Pictures of a sensor, with their slopes by what is not known of it.

use nalgebra::{Matrix4x2, Vector3};

use super::settings::ImageFit;
use super::view::{NUMBERS, PictureSlopes, SensorState, Steps, View};
use crate::MarkerDisplacement;

impl<V: View> ImageFit<V> {
    /// Pictures of all markers; `None` where there is no such sensor or no such motion.
    pub(super) fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; NUMBERS]>>> {
        let pictures = self.view.pictures(sensor, moved);
        pictures.filter(|pictures| pictures.len() == moved.len())
    }

    /// Pictures with their slopes by displacements and misalignments, and by some departures with their standard deviations.
    pub(super) fn slopes_by(
        &self,
        departures: &[(usize, f64)],
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<PictureSlopes> {
        let steps = Steps {
            departures,
            radius: self.markers.skin().radius(),
        };
        let slopes = self.view.slopes(sensor, moved, &steps);
        slopes.filter(|slopes| slopes.are_of(moved.len(), departures.len()))
    }

    /// Pictures with their slopes by what is not known of the sensor: by free departures, in their standard deviations, and by
    /// misalignments. The markers move by `moved`, and where the discs of one colour lie deeper by what `per_depth` tells per
    /// length.
    pub(super) fn slopes(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
        per_depth: Option<&[[MarkerDisplacement; 2]]>,
    ) -> Option<PictureSlopes> {
        let departures = self.free_stds();
        let mut slopes = self.slopes_by(&departures, sensor, moved)?;
        for (column, &(number, std)) in departures.iter().enumerate() {
            for (marker, both) in per_depth.unwrap_or_default().iter().enumerate() {
                let Some(deeper) = both.get(number) else {
                    break;
                };
                let [x, y] = deeper.tangential;
                let more = slopes.displacements[marker][number] * Vector3::new(deeper.normal, x, y);
                let mut rows = slopes
                    .common
                    .fixed_view_mut::<NUMBERS, 1>(NUMBERS * marker, column);
                rows += more;
            }
            slopes.common.column_mut(column).scale_mut(std);
        }
        if self.misalignment_std == 0.0 {
            slopes.misalignments.fill(Matrix4x2::zeros());
        }
        Some(slopes)
    }
}
