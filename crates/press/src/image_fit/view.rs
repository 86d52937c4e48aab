//! Camera model: pictures of the markers and their slopes.
//!
//! The picture of a marker has four numbers: both coordinates of its centroid, its hue and the logarithm of its size.

use nalgebra::{DMatrix, Matrix4, Matrix4x2, Matrix4x3, Vector3, Vector4};

use super::ImageFit;
use crate::{MarkerDisplacement, PressError};

/// Count of numbers of a marker's picture: both coordinates of the centroid, px; hue, turns; logarithm of the size.
pub(super) const NUMBERS: usize = 4;
/// Index of the hue, which is periodic.
const HUE: usize = 2;
/// Index of the size.
pub(super) const SIZE: usize = 3;

/// Steps of differences: of departures, in their standard deviations; of misalignments, rad; of displacements, in radii of the
/// skin.
const DEPARTURE_STEP: f64 = 1e-2;
const MISALIGNMENT_STEP: f64 = 1e-6;
const DISPLACEMENT_STEP: f64 = 1e-6;

/// Relative error of a picture's numbers by rounding in a model; absolute error of numbers below 1.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Reading of a marker's picture by the tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Both coordinates of the centroid, px; hue of the summed light, turns; natural logarithm of the size in px².
    pub picture: [f64; 4],
    /// Covariance of the errors of these numbers, positive definite.
    pub covariance: Matrix4<f64>,
}

impl Seen {
    /// Rejects an invalid reading of this marker.
    pub(super) fn check(&self, marker: usize) -> Result<(), PressError> {
        let mut numbers = self.picture.iter().chain(&self.covariance);
        if !numbers.all(|number| number.abs() <= 1e50) {
            return Err(PressError::NotFinite { marker });
        }
        let good = self.covariance.cholesky().is_some();
        let least = self.covariance.diagonal().min();
        let expected = "positive, the least variance of a positive definite matrix for each marker";
        PressError::unless_good("covariance", least, good, expected).map(|_| ())
    }

    /// Covariance of the errors of these numbers, with variances at least those of rounding: a fit with smaller variances has no
    /// clear minimum.
    pub(super) fn errors(&self) -> Matrix4<f64> {
        let mut errors = self.covariance;
        for (at, number) in self.picture.iter().enumerate() {
            let rounding = ROUNDING * number.abs().max(1.0);
            errors[(at, at)] = errors[(at, at)].max(rounding * rounding);
        }
        errors
    }
}

/// Values of the uncertain parameters of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState<'a> {
    /// Departures common to all markers from the nominal parameters. The first two are the additional depths of the magenta and
    /// of the yellow discs, lengths; the [`View`] defines the others.
    pub common: &'a [f64],
    /// Misalignment of each marker's discs, rad at the sensor's centre.
    pub misalignments: &'a [[f64; 2]],
}

/// Upper limit of a misalignment, rad.
pub(super) const MAX_MISALIGNMENT: f64 = 0.5;

/// A sensor: departures common to all markers, and misalignments.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub(super) common: Vec<f64>,
    pub(super) misalignments: Vec<[f64; 2]>,
}

impl Sensor {
    /// Adds the difference between two sensors to the departures and misalignments.
    pub(super) fn shift(&mut self, to: &Self, from: &Self) {
        for ((one, to), from) in self.common.iter_mut().zip(&to.common).zip(&from.common) {
            *one += to - from;
        }
        let all = self
            .misalignments
            .iter_mut()
            .zip(&to.misalignments)
            .zip(&from.misalignments);
        for ((one, to), from) in all {
            for axis in 0..2 {
                one[axis] += to[axis] - from[axis];
            }
        }
    }

    pub(super) fn state(&self) -> SensorState<'_> {
        SensorState {
            common: &self.common,
            misalignments: &self.misalignments,
        }
    }
}

/// Scales of the parameters of slopes, for views that compute slopes by differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps<'a> {
    /// Numbers, from 0, of the departures for which slopes are requested, with the standard deviation of each, > 0.
    pub departures: &'a [(usize, f64)],
    /// Radius of the skin, length.
    pub radius: f64,
}

/// Images of all markers with their derivatives (slopes): four rows per marker, in the order of the four numbers of
/// its image.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSlopes {
    /// Picture of each marker, see [`View::pictures`].
    pub pictures: Vec<Option<[f64; 4]>>,
    /// Slopes of all markers, one after the other, by the requested departures, one column each; 0 for markers that are not
    /// visible.
    pub common: DMatrix<f64>,
    /// Slopes by both components of each marker's misalignment, per rad.
    pub misalignments: Vec<Matrix4x2<f64>>,
    /// Slopes by the displacements of each marker's magenta and yellow disc, per length: inward, and along both axes.
    pub displacements: Vec<[Matrix4x3<f64>; 2]>,
}

impl PictureSlopes {
    /// Whether the sizes match these numbers of markers and departures.
    pub(super) fn are_of(&self, markers: usize, departures: usize) -> bool {
        self.pictures.len() == markers
            && self.common.shape() == (NUMBERS * markers, departures)
            && self.misalignments.len() == markers
            && self.displacements.len() == markers
    }
}

/// A camera model: pictures of markers with displaced discs. A result with a wrong number of markers counts as no result.
pub trait View {
    /// Picture of each marker, as in [`Seen`], after the displacements of its magenta and its yellow disc; `None` for markers
    /// that are not visible. The result is `None` for an impossible sensor or motion.
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>>;

    /// These pictures with their slopes. The default computes the slopes by differences.
    fn slopes(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
        steps: &Steps<'_>,
    ) -> Option<PictureSlopes> {
        let pictures = self.pictures(sensor, moved)?;
        let markers = pictures.len();
        let slopes = |step: f64, beside: &[Option<[f64; 4]>], marker: usize| -> Vector4<f64> {
            match (beside.get(marker), &pictures[marker]) {
                (Some(Some(beside)), Some(at)) => Vector4::from(difference(beside, at)) / step,
                _ => Vector4::zeros(),
            }
        };
        let mut common = DMatrix::zeros(NUMBERS * markers, steps.departures.len());
        for (column, &(number, std)) in steps.departures.iter().enumerate() {
            let step = DEPARTURE_STEP * std;
            let mut departed = sensor.common.to_vec();
            *departed.get_mut(number)? += step;
            let state = SensorState {
                common: &departed,
                ..*sensor
            };
            let beside = self.pictures(&state, moved)?;
            for marker in 0..markers {
                let mut rows = common.fixed_view_mut::<NUMBERS, 1>(NUMBERS * marker, column);
                rows.copy_from(&slopes(step, &beside, marker));
            }
        }
        let mut misalignments = vec![Matrix4x2::zeros(); markers];
        for axis in 0..2 {
            let mut misaligned = sensor.misalignments.to_vec();
            for misalignment in &mut misaligned {
                misalignment[axis] += MISALIGNMENT_STEP;
            }
            let state = SensorState {
                misalignments: &misaligned,
                ..*sensor
            };
            let beside = self.pictures(&state, moved)?;
            for (marker, by) in misalignments.iter_mut().enumerate() {
                by.set_column(axis, &slopes(MISALIGNMENT_STEP, &beside, marker));
            }
        }
        let step = DISPLACEMENT_STEP * steps.radius;
        let mut displacements = vec![[Matrix4x3::zeros(); 2]; markers];
        for disc in 0..2 {
            for component in 0..3 {
                let mut displaced = moved.to_vec();
                for both in &mut displaced {
                    match component {
                        0 => both[disc].normal += step,
                        _ => both[disc].tangential[component - 1] += step,
                    }
                }
                let beside = self.pictures(sensor, &displaced)?;
                for (marker, by) in displacements.iter_mut().enumerate() {
                    by[disc].set_column(component, &slopes(step, &beside, marker));
                }
            }
        }
        Some(PictureSlopes {
            pictures,
            common,
            misalignments,
            displacements,
        })
    }
}

impl<V: View> ImageFit<V> {
    /// Pictures of all markers; `None` for an impossible sensor or motion.
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

    /// Pictures with their slopes by the uncertain parameters of the sensor: by free departures, in their standard deviations,
    /// and by misalignments. The markers move by `moved`; `per_depth` has the derivatives of their displacements by the depths
    /// of the discs.
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

/// Difference of two pictures.
pub(super) fn difference(one: &[f64; NUMBERS], other: &[f64; NUMBERS]) -> [f64; NUMBERS] {
    let mut difference = std::array::from_fn(|number| one[number] - other[number]);
    let turn: f64 = difference[HUE];
    difference[HUE] = turn - (turn + 0.5).floor();
    difference
}
