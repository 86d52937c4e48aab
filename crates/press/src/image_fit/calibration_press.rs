//! Calibration of a sensor by presses on known objects, together with its frame at rest.

use nalgebra::{Matrix4, Vector4};

use super::image_search::WRONG;
use super::view::{NUMBERS, Seen, View, difference};
use super::{ImageFit, Rest};
use crate::state::State;
use crate::{MarkerDisplacement, PressError};

/// A press with known object, place and indentation, and the readings of its markers.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationPress {
    /// One reading per marker; `None` for markers that are not visible.
    pub seen: Vec<Option<Seen>>,
    /// Relative curvature, 1/length.
    pub relative_curvature: f64,
    /// Chart coordinates of the contact, length.
    pub at: [f64; 2],
    /// Indentation, length.
    pub indentation: f64,
}

/// Readings of the markers in a frame with known displacements: at rest, or in a calibration press.
#[derive(Clone, Debug)]
pub(super) struct CalibrationFrame {
    pub(super) seen: Vec<Option<Seen>>,
    /// Inverse covariances of the readings; `None` for markers that are not used.
    pub(super) weights: Vec<Option<Matrix4<f64>>>,
    /// Displacements of the discs at their nominal depths.
    pub(super) moved: Vec<[MarkerDisplacement; 2]>,
    /// Derivatives of the displacements by the depths; `None` if they are 0.
    pub(super) per_depth: Option<Vec<[MarkerDisplacement; 2]>>,
}

/// At most one in this many markers of a frame may be an outlier.
const MARKERS_PER_OUTLIER: usize = 8;

impl CalibrationFrame {
    /// Number of the used markers.
    pub(super) fn markers(&self) -> usize {
        self.weights.iter().flatten().count()
    }

    /// Largest allowed number of outliers; if there are more, the frame is wrong.
    pub(super) fn max_outliers(&self) -> usize {
        (self.markers() / MARKERS_PER_OUTLIER).max(1)
    }

    /// Displacements of the discs with the first two of these departures, which are depths.
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

    /// Difference between the reading of a marker and its predicted picture.
    pub(super) fn residual(
        &self,
        marker: usize,
        pictures: &[Option<[f64; NUMBERS]>],
    ) -> Option<Vector4<f64>> {
        let (seen, picture) = (self.seen[marker]?, pictures[marker]?);
        Some(Vector4::from(difference(&seen.picture, &picture)))
    }
}

impl<V: View> ImageFit<V> {
    /// Calibrates the sensor by its markers at rest and by calibration presses: one reading per marker, `None` for markers that
    /// are not visible. Outliers are removed from each frame, at most one in eight markers, or one if there are fewer; a marker
    /// that is removed at rest counts as not visible there. Without presses no marker is removed.
    ///
    /// # Errors
    /// Errors of [`ImageFit::at_rest`], except [`PressError::HiddenMarker`] if there are presses, and of
    /// [`Body::press`](crate::Body::press) for an impossible press; [`PressError::ContradictingPress`] and
    /// [`PressError::ContradictingRest`] if a frame has too many outliers.
    pub fn calibrated(
        &self,
        at_rest: &[Option<Seen>],
        presses: &[CalibrationPress],
    ) -> Result<Rest, PressError> {
        self.validate()?;
        let rest = CalibrationFrame {
            seen: at_rest.to_vec(),
            weights: self.weights(at_rest)?,
            moved: vec![[MarkerDisplacement::default(); 2]; at_rest.len()],
            per_depth: None,
        };
        if rest.markers() == 0 {
            return Err(PressError::TooFewMarkers {
                markers: 0,
                equations: 0,
                needed: 1,
            });
        }
        let mut frames = vec![rest];
        for press in presses {
            frames.push(self.pressed(press)?);
        }
        if presses.is_empty() {
            let rest = self.fit_frames(frames)?;
            if rest.chi_squared.is_finite() {
                return Ok(rest);
            }
            let hidden = self.worst(&rest, &rest.frames)?;
            let named = |(_, marker)| PressError::HiddenMarker { marker };
            return Err(hidden.map_or(PressError::OutOfRange, named));
        }
        self.without_outliers(&frames)
    }

    /// Fits the sensor to frames, without outliers.
    fn without_outliers(&self, frames: &[CalibrationFrame]) -> Result<Rest, PressError> {
        let mut kept = frames.to_vec();
        let mut left_out = vec![0; frames.len()];
        loop {
            let rest = self.fit_frames(kept.clone())?;
            // One at a time, because an outlier makes other markers look wrong.
            let Some((frame, marker)) = self.worst(&rest, &kept)? else {
                return Ok(rest);
            };
            left_out[frame] += 1;
            if left_out[frame] > frames[frame].max_outliers() {
                return Err(self.contradiction(frames, &left_out)?);
            }
            kept[frame].weights[marker] = None;
        }
    }

    /// Frame and number of the marker that contradicts the sensor most; `None` if none does.
    fn worst(
        &self,
        rest: &Rest,
        frames: &[CalibrationFrame],
    ) -> Result<Option<(usize, usize)>, PressError> {
        let sensor = rest.sensor();
        let (mut most, mut worst) = (WRONG, None);
        for (number, frame) in frames.iter().enumerate() {
            let moved = frame.moved_at(&sensor.common);
            let pictures = self.pictures(&sensor.state(), &moved);
            let pictures = pictures.ok_or(PressError::OutOfRange)?;
            for (marker, weight) in frame.weights.iter().enumerate() {
                let Some(weight) = weight else { continue };
                // A marker with a reading cannot be hidden.
                let residual = frame.residual(marker, &pictures);
                let square = residual.map_or(f64::INFINITY, |off| off.dot(&(weight * off)));
                if square > most {
                    (most, worst) = (square, Some((number, marker)));
                }
            }
        }
        Ok(worst)
    }

    /// The error of frames that contradict each other, with the number of markers that were removed from each. It names the
    /// frame without which the others agree best; of one press and the frame at rest, it names the press.
    fn contradiction(
        &self,
        frames: &[CalibrationFrame],
        left_out: &[usize],
    ) -> Result<PressError, PressError> {
        let skipped = usize::from(frames.len() == 2);
        let mut named = PressError::ContradictingRest {
            markers: left_out[0],
            most: frames[0].max_outliers(),
        };
        let mut least = f64::INFINITY;
        for (number, (frame, left_out)) in frames.iter().zip(left_out).enumerate().skip(skipped) {
            let mut others = frames.to_vec();
            others.remove(number);
            // There may be no sensor that fits the others.
            let Ok(rest) = self.fit_frames(others) else {
                continue;
            };
            let off = self.off(&rest, frame)?;
            let (markers, most) = (*left_out.max(&off), frame.max_outliers());
            let share = rest.chi_squared / rest.freedom as f64;
            if markers > most && share < least {
                least = share;
                named = match number.checked_sub(1) {
                    Some(press) => PressError::ContradictingPress {
                        press,
                        markers,
                        most,
                    },
                    None => PressError::ContradictingRest { markers, most },
                };
            }
        }
        Ok(named)
    }

    /// Number of a frame's markers that contradict the sensor fitted to other frames, with regard to the noise and the
    /// uncertainty of the sensor.
    fn off(&self, rest: &Rest, frame: &CalibrationFrame) -> Result<usize, PressError> {
        let impossible = PressError::OutOfRange;
        let sensor = rest.sensor();
        let moved = frame.moved_at(&sensor.common);
        let slopes = self.slopes(&sensor.state(), &moved, frame.per_depth.as_deref());
        let slopes = slopes.ok_or(impossible)?;
        let unknown = rest.covariance().ok_or(impossible)?;
        let is_off = |marker: usize| {
            let (seen, local) = (frame.seen[marker]?, rest.local[marker].as_ref()?);
            let Some(residual) = frame.residual(marker, &slopes.pictures) else {
                return Some(true);
            };
            let by_local = slopes.misalignments[marker];
            let by_common =
                slopes.common.fixed_rows::<NUMBERS>(NUMBERS * marker) + by_local * &local.follows;
            let covariance = seen.covariance
                + &by_common * &unknown * by_common.transpose()
                + by_local * local.spread * by_local.transpose();
            let square = residual.dot(&covariance.cholesky()?.solve(&residual));
            Some(square > WRONG)
        };
        let markers = 0..frame.seen.len();
        Ok(markers
            .filter(|&marker| is_off(marker) == Some(true))
            .count())
    }

    fn pressed(&self, press: &CalibrationPress) -> Result<CalibrationFrame, PressError> {
        let CalibrationPress {
            seen,
            relative_curvature,
            at,
            indentation,
        } = press;
        let good = *relative_curvature > 0.0 && *relative_curvature <= 1e50;
        PressError::unless_good(
            "curvature",
            *relative_curvature,
            good,
            "> 0 and at most 1e50",
        )?;
        if !(at.iter().all(|along| along.abs() <= 1e50) && (0.0..=1e50).contains(indentation)) {
            return Err(PressError::OutOfRange);
        }
        let state = State::new(
            *relative_curvature,
            self.markers.skin().place(*at),
            *indentation,
            [0.0; 2],
        );
        let moved = self.moved(&state)?;
        Ok(CalibrationFrame {
            seen: seen.clone(),
            weights: self.weights(seen)?,
            per_depth: self.per_depth(&state, &moved)?,
            moved,
        })
    }

    /// Inverse covariance of each marker's reading.
    fn weights(&self, seen: &[Option<Seen>]) -> Result<Vec<Option<Matrix4<f64>>>, PressError> {
        let good = seen.len() == self.markers.places().len();
        PressError::unless_good("readings", seen.len() as f64, good, "one for each marker")?;
        let weight = |(marker, seen): (usize, &Option<Seen>)| {
            let Some(seen) = seen else { return Ok(None) };
            seen.check(marker)?;
            let factor = seen.errors().cholesky();
            let factor = factor.ok_or(PressError::NotFinite { marker })?;
            Ok(Some(factor.inverse()))
        };
        seen.iter().enumerate().map(weight).collect()
    }
}
