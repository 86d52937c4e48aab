//! The camera model: images of the markers and their derivatives.
//!
//! Four numbers describe the image of a marker: the two coordinates of its centroid, its hue, and the logarithm of its
//! size.

use std::fmt::Debug;

use nalgebra::{DMatrix, Matrix4, Matrix4x2, Matrix4x3, Vector3, Vector4};

use super::ImageFit;
use crate::{MarkerDisplacement, PressError};

/// Number of values that describe the image of a marker: two coordinates of the centroid (px), hue (turns) and
/// logarithm of the size.
pub(super) const NUMBERS: usize = 4;
/// Index of the hue among the four numbers that describe the image of a marker. The hue is an angle in turns, so 0 and
/// 1 are the same hue.
const HUE: usize = 2;
pub(super) const SIZE: usize = 3;

/// Step of numerical derivatives with respect to a sensor parameter, in standard deviations of its prior.
const DEPARTURE_STEP: f64 = 1e-2;
/// Step of numerical derivatives with respect to the misalignments of discs, rad.
const MISALIGNMENT_STEP: f64 = 1e-6;
/// Step of numerical derivatives with respect to the displacements of discs, as a share of the skin's radius.
const DISPLACEMENT_STEP: f64 = 1e-6;

/// Rounding error of the four numbers that the model computes for a marker's image: relative to the number, or absolute
/// for numbers below 1.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The image of a marker, as measured by the tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Four numbers that describe the image: both coordinates of the centroid (px), hue of the summed light (turns),
    /// and natural logarithm of the size in px².
    pub picture: [f64; 4],
    /// Covariance of the errors of the four numbers in `picture`. It must be positive definite.
    pub covariance: Matrix4<f64>,
}

impl Seen {
    pub(super) fn check(&self, marker: usize) -> Result<(), PressError> {
        let mut numbers = self.picture.iter().chain(&self.covariance);
        if !numbers.all(|number| number.abs() <= 1e50) {
            return Err(PressError::NotFinite { marker });
        }
        let good = self.covariance.cholesky().is_some();
        let least = self.covariance.diagonal().min();
        let expected = "positive definite (the value shown is its smallest diagonal entry)";
        PressError::unless_good("covariance", least, good, expected).map(|_| ())
    }

    /// Covariance of the errors of the four numbers of the image. Each variance is at least the squared rounding error,
    /// because chi-squared would otherwise have no clear minimum.
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
    /// Deviations of the parameters from their nominal values (sensor deviations), common to all markers. The first two
    /// are the additional depths (length) of the magenta and of the yellow discs. The [`View`] defines the other
    /// deviations.
    pub common: &'a [f64],
    /// Misalignment of each marker's two discs, as angles at the sensor's centre, rad.
    pub misalignments: &'a [[f64; 2]],
}

/// Upper limit of the misalignment between a marker's two discs, rad.
pub(super) const MAX_MISALIGNMENT: f64 = 0.5;

/// The parameters of a sensor: deviations from the nominal values that are common to all markers, and the misalignment
/// of each marker.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub(super) common: Vec<f64>,
    pub(super) misalignments: Vec<[f64; 2]>,
}

impl Sensor {
    /// Adds the difference between the parameters of two sensors, `to` minus `from`, to the parameters of this sensor.
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

/// Scales of the sensor parameters, from which a camera model chooses the steps of numerical derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps<'a> {
    /// Indices (in [`SensorState::common`]) of the sensor deviations for which derivatives are requested, each with the
    /// standard deviation (> 0) of its prior.
    pub departures: &'a [(usize, f64)],
    /// Radius (length) of the sensor's skin.
    pub radius: f64,
}

/// Images of all markers with their derivatives (slopes). The matrices have four rows per marker, in the order of the
/// four numbers of its image.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSlopes {
    /// The image of each marker, as returned by [`View::pictures`]; `None` for markers that are not visible.
    pub pictures: Vec<Option<[f64; 4]>>,
    /// Derivatives of the images with respect to the requested deviations of the sensor's parameters. There are four
    /// rows per marker and one column per deviation. The rows of markers that are not visible are 0.
    pub common: DMatrix<f64>,
    /// Derivatives of the images with respect to the two components of each marker's misalignment, per rad.
    pub misalignments: Vec<Matrix4x2<f64>>,
    /// Derivatives of the images with respect to the displacements of each marker's magenta and yellow disc, per
    /// length. The displacements are inward and along both axes of the skin.
    pub displacements: Vec<[Matrix4x3<f64>; 2]>,
}

impl PictureSlopes {
    pub(super) fn are_of(&self, markers: usize, departures: usize) -> bool {
        self.pictures.len() == markers
            && self.common.shape() == (NUMBERS * markers, departures)
            && self.misalignments.len() == markers
            && self.displacements.len() == markers
    }
}

/// A camera model that computes the images of markers with displaced discs. A result with a wrong number of markers is
/// treated like `None`.
pub trait View: Debug + Send + Sync {
    /// The image of each marker, as in [`Seen`], after the displacements of its magenta and its yellow disc; `None` for
    /// markers that are not visible. The whole result is `None` if the sensor's parameters or a displacement are
    /// impossible.
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>>;

    /// The images of all markers as in [`Self::pictures`], with their derivatives. The default implementation computes
    /// numerical derivatives.
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

impl ImageFit {
    pub(super) fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; NUMBERS]>>> {
        let pictures = self.view.pictures(sensor, moved);
        pictures.filter(|pictures| pictures.len() == moved.len())
    }

    /// The images of all markers, with their derivatives with respect to displacements, misalignments and some sensor
    /// deviations. `departures` contains the index and the standard deviation of each of these sensor deviations.
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

    /// Images of the markers, and the derivatives of these images with respect to the uncertain parameters of the
    /// sensor. These parameters are the deviations from the nominal values (in standard deviations) and the
    /// misalignments. `moved` contains the displacements of the discs, and `per_depth` the derivatives of these
    /// displacements with respect to the depths of the discs.
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

/// Difference between two images of a marker, as four numbers. Hues are periodic, so the difference between the hues is
/// reduced by whole turns.
pub(super) fn difference(one: &[f64; NUMBERS], other: &[f64; NUMBERS]) -> [f64; NUMBERS] {
    let mut difference = std::array::from_fn(|number| one[number] - other[number]);
    let turn: f64 = difference[HUE];
    difference[HUE] = turn - (turn + 0.5).floor();
    difference
}
