//! Frames of displacements that are known: at rest, and in presses that calibrate a sensor.

use nalgebra::{Matrix4, Vector4};

use super::view::{NUMBERS, Seen, difference};
use crate::{MarkerDisplacement, PressError};

/// Markers as they were read, where it is known how they moved.
#[derive(Clone, Debug)]
pub(super) struct KnownFrame {
    pub(super) seen: Vec<Option<Seen>>,
    /// Inverse covariances of what was read.
    pub(super) weights: Vec<Option<Matrix4<f64>>>,
    /// Displacements of discs that lie as deep as they are meant to.
    pub(super) moved: Vec<[MarkerDisplacement; 2]>,
    /// Displacements more per length by which discs lie deeper; `None` for none.
    pub(super) per_depth: Option<Vec<[MarkerDisplacement; 2]>>,
}

/// At most one in so many markers of a frame is left out.
const MOST_WRONG: usize = 8;

impl KnownFrame {
    /// Number of the markers that count.
    pub(super) fn markers(&self) -> usize {
        self.weights.iter().flatten().count()
    }

    /// Number of its markers that may be wrong; if more seem so, the frame is.
    pub(super) fn most_wrong(&self) -> usize {
        (self.markers() / MOST_WRONG).max(1)
    }

    /// Displacements of discs that lie deeper by the first two of these departures.
    pub(super) fn moved_at(&self, common: &[f64]) -> Vec<[MarkerDisplacement; 2]> {
        let mut moved = self.moved.clone();
        for (both, slopes) in moved.iter_mut().zip(self.per_depth.iter().flatten()) {
            for ((moved, slope), deeper) in both.iter_mut().zip(slopes).zip(common) {
                moved.normal += deeper * slope.normal;
                for axis in 0..2 {
                    moved.tangential[axis] += deeper * slope.tangential[axis];
                }
            }
        }
        moved
    }

    /// Difference of a marker's reading from its picture.
    pub(super) fn residual(
        &self,
        marker: usize,
        pictures: &[Option<[f64; NUMBERS]>],
    ) -> Option<Vector4<f64>> {
        let (seen, picture) = (self.seen[marker]?, pictures[marker]?);
        Some(Vector4::from(difference(&seen.picture, &picture)))
    }
}

/// Inverse covariance of each marker's reading.
pub(super) fn weights(seen: &[Option<Seen>]) -> Result<Vec<Option<Matrix4<f64>>>, PressError> {
    let weight = |(marker, seen): (usize, &Option<Seen>)| {
        let Some(seen) = seen else { return Ok(None) };
        seen.check(marker)?;
        let factor = seen.errors().cholesky();
        let factor = factor.ok_or(PressError::NotFinite { marker })?;
        Ok(Some(factor.inverse()))
    };
    seen.iter().enumerate().map(weight).collect()
}
