//! Pictures of markers that a camera sees, as a fit is told them.

use nalgebra::{DMatrix, Matrix4, Matrix4x2, Matrix4x3, Vector4};

use crate::{MarkerDisplacement, PressError};

/// Numbers of a marker's picture: both coordinates of the centroid, px; hue, turns; logarithm of the size.
pub(super) const NUMBERS: usize = 4;
/// The hue among them, which goes round.
const HUE: usize = 2;

/// Steps of differences: of departures, in their standard deviations; of misalignments, rad; of displacements, in radii of the
/// skin.
const SHARE: f64 = 1e-2;
const MISALIGNED: f64 = 1e-6;
const DISPLACED: f64 = 1e-6;

/// Relative error of a picture's numbers, or error of those below 1, by the rounding of all that a law computes them by.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A marker as the tracker reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Both coordinates of the centroid, px; mean hue, turns; natural logarithm of the size in px².
    pub picture: [f64; 4],
    /// Covariance of the errors of these numbers, positive definite.
    pub covariance: Matrix4<f64>,
}

impl Seen {
    /// Refuses what is no reading of this marker.
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

    /// Covariance of the errors of these numbers, none of which is less than rounding leaves: fits to less have no minimum.
    pub(super) fn errors(&self) -> Matrix4<f64> {
        let mut errors = self.covariance;
        for (at, number) in self.picture.iter().enumerate() {
            let rounding = ROUNDING * number.abs().max(1.0);
            errors[(at, at)] = errors[(at, at)].max(rounding * rounding);
        }
        errors
    }
}

/// Properties of a sensor that are known only roughly, at some values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState<'a> {
    /// Departures common to all markers from what calibration knows. The first two are the lengths by which the
    /// magenta and the yellow discs lie deeper; the others are as the [`View`] has them.
    pub common: &'a [f64],
    /// Misalignment of each marker's discs, rad at the sensor's centre.
    pub misalignments: &'a [[f64; 2]],
}

/// No disc is misaligned by more than it can be told at all, rad.
pub(super) const MOST_MISALIGNED: f64 = 0.5;

/// A sensor: departures common to all markers, and misalignments.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub(super) common: Vec<f64>,
    pub(super) misalignments: Vec<[f64; 2]>,
}

impl Sensor {
    /// Departs further, by what one sensor departs from another.
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

/// Sizes of what pictures have slopes by, for those who find them by differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps<'a> {
    /// Numbers of the departures that slopes are sought by, from 0, with the standard deviation of each, > 0.
    pub departures: &'a [(usize, f64)],
    /// Radius of the skin, length.
    pub radius: f64,
}

/// Pictures of all markers with their slopes: four rows of each marker, in the order of a picture's numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSlopes {
    /// Picture of each marker, as of [`View::pictures`].
    pub pictures: Vec<Option<[f64; 4]>>,
    /// Slopes of each marker in turn, by the departures that are asked for, a column each; 0 for markers that are not seen.
    pub common: DMatrix<f64>,
    /// Slopes by both components of each marker's misalignment, per rad.
    pub misalignments: Vec<Matrix4x2<f64>>,
    /// Slopes by the displacements of each marker's magenta and yellow disc, per length: inward, and along both axes.
    pub displacements: Vec<[Matrix4x3<f64>; 2]>,
}

impl PictureSlopes {
    /// Whether there are so many markers, and slopes by so many departures.
    pub(super) fn are_of(&self, markers: usize, departures: usize) -> bool {
        self.pictures.len() == markers
            && self.common.shape() == (NUMBERS * markers, departures)
            && self.misalignments.len() == markers
            && self.displacements.len() == markers
    }
}

/// Law by which a camera sees markers whose discs were displaced. What is of another number of markers than was moved counts
/// as no pictures.
pub trait View {
    /// Picture of each marker, as [`Seen`] has it, after the displacements of its magenta and its yellow disc; `None`
    /// for markers that are not seen. `None` altogether where there is no such sensor or no such motion.
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>>;

    /// These pictures with their slopes; by differences, unless the law knows better.
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
            let step = SHARE * std;
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
                misalignment[axis] += MISALIGNED;
            }
            let state = SensorState {
                misalignments: &misaligned,
                ..*sensor
            };
            let beside = self.pictures(&state, moved)?;
            for (marker, by) in misalignments.iter_mut().enumerate() {
                by.set_column(axis, &slopes(MISALIGNED, &beside, marker));
            }
        }
        let step = DISPLACED * steps.radius;
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

/// One picture less another.
pub(super) fn difference(one: &[f64; NUMBERS], other: &[f64; NUMBERS]) -> [f64; NUMBERS] {
    let mut difference = std::array::from_fn(|number| one[number] - other[number]);
    let turn: f64 = difference[HUE];
    difference[HUE] = turn - (turn + 0.5).floor();
    difference
}
