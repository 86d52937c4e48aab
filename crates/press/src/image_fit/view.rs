//! Pictures of markers that a camera sees, as a fit is told them.

use nalgebra::Matrix4;

use crate::MarkerDisplacement;

/// Numbers of a marker's picture: both coordinates of the centroid, px; hue, turns; logarithm of the size.
pub(super) const NUMBERS: usize = 4;
/// The hue among them, which goes round.
const HUE: usize = 2;

/// A marker as the tracker reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Both coordinates of the centroid, px; mean hue, turns; natural logarithm of the size in px².
    pub picture: [f64; 4],
    /// Covariance of the errors of these numbers.
    pub covariance: Matrix4<f64>,
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
    pub(super) fn state(&self) -> SensorState<'_> {
        SensorState {
            common: &self.common,
            misalignments: &self.misalignments,
        }
    }
}

/// Law by which a camera sees markers whose discs were displaced.
pub trait View {
    /// Picture of each marker, as [`Seen`] has it, after the displacements of its magenta and its yellow disc; `None`
    /// for markers that are not seen. `None` altogether where there is no such sensor or no such motion.
    fn pictures(
        &self,
        sensor: &SensorState<'_>,
        moved: &[[MarkerDisplacement; 2]],
    ) -> Option<Vec<Option<[f64; 4]>>>;
}

/// One picture less another.
pub(super) fn difference(one: &[f64; NUMBERS], other: &[f64; NUMBERS]) -> [f64; NUMBERS] {
    let mut difference = std::array::from_fn(|number| one[number] - other[number]);
    let turn: f64 = difference[HUE];
    difference[HUE] = turn - (turn + 0.5).floor();
    difference
}
