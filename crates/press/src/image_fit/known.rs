//! Presses that are known, and that calibrate a sensor beside its frame at rest.

use nalgebra::Matrix4;

use super::frame::{KnownFrame, weights};
use super::law::State;
use super::outcome::WRONG;
use super::rest::Rest;
use super::settings::ImageFit;
use super::view::{NUMBERS, Seen, Sensor, SensorState, View};
use crate::{MarkerDisplacement, PressError};

/// Press whose object, place and depth are known, with what was seen of it.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownPress {
    /// One reading per marker; `None` for those that are not seen.
    pub seen: Vec<Option<Seen>>,
    /// Relative curvature, 1/length.
    pub relative_curvature: f64,
    /// Chart coordinates of the contact, length.
    pub at: [f64; 2],
    /// Indentation, length.
    pub indentation: f64,
}

impl<V: View> ImageFit<V> {
    /// The sensor as its markers at rest and presses that are known show it: one reading per marker, `None` for those that
    /// are not seen. Markers of a frame that contradict the others are left out of it, at most one in eight of each frame,
    /// or one of fewer: a marker that is left out at rest counts as one that is not seen there. Without presses none is left out.
    ///
    /// # Errors
    /// Errors of [`ImageFit::at_rest`], but for [`PressError::HiddenMarker`] where there are presses, and of
    /// [`Body::press`](crate::Body::press) for a press that cannot be;
    /// [`PressError::ContradictingPress`] and [`PressError::ContradictingRest`] where more markers of a frame contradict.
    pub fn calibrated(
        &self,
        at_rest: &[Option<Seen>],
        presses: &[KnownPress],
    ) -> Result<Rest, PressError> {
        self.validate()?;
        let rest = KnownFrame {
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
            let rest = self.told_by(frames)?;
            if rest.chi_squared.is_finite() {
                return Ok(rest);
            }
            let hidden = self.worst(&rest, &rest.frames)?;
            let named = |(_, marker)| PressError::HiddenMarker { marker };
            return Err(hidden.map_or(PressError::OutOfRange, named));
        }
        self.agreeing(&frames)
    }

    /// The sensor as frames tell it without the markers that contradict it.
    fn agreeing(&self, frames: &[KnownFrame]) -> Result<Rest, PressError> {
        let mut kept = frames.to_vec();
        let mut left_out = vec![0; frames.len()];
        loop {
            let rest = self.told_by(kept.clone())?;
            // One at a time: a wrong marker makes others seem wrong.
            let Some((frame, marker)) = self.worst(&rest, &kept)? else {
                return Ok(rest);
            };
            left_out[frame] += 1;
            if left_out[frame] > frames[frame].most_wrong() {
                return Err(self.contradiction(frames, &left_out)?);
            }
            kept[frame].weights[marker] = None;
        }
    }

    /// The marker that contradicts the sensor most, by its frame and number; `None` where none does.
    fn worst(
        &self,
        rest: &Rest,
        frames: &[KnownFrame],
    ) -> Result<Option<(usize, usize)>, PressError> {
        let sensor = rest.sensor();
        let (mut most, mut worst) = (WRONG, None);
        for (number, frame) in frames.iter().enumerate() {
            let moved = frame.moved_at(&sensor.common);
            let pictures = self.pictures(&sensor.state(), &moved);
            let pictures = pictures.ok_or(PressError::OutOfRange)?;
            for (marker, weight) in frame.weights.iter().enumerate() {
                let Some(weight) = weight else { continue };
                // A marker that was seen cannot be out of sight.
                let residual = frame.residual(marker, &pictures);
                let square = residual.map_or(f64::INFINITY, |off| off.dot(&(weight * off)));
                if square > most {
                    (most, worst) = (square, Some((number, marker)));
                }
            }
        }
        Ok(worst)
    }

    /// The error of frames that contradict each other, of which so many markers were left out: it names the frame without
    /// which the others agree best. Of a press and a frame at rest alone it is the press.
    fn contradiction(
        &self,
        frames: &[KnownFrame],
        left_out: &[usize],
    ) -> Result<PressError, PressError> {
        let skipped = usize::from(frames.len() == 2);
        let mut named = PressError::ContradictingRest {
            markers: left_out[0],
            most: frames[0].most_wrong(),
        };
        let mut least = f64::INFINITY;
        for (number, (frame, left_out)) in frames.iter().zip(left_out).enumerate().skip(skipped) {
            let mut others = frames.to_vec();
            others.remove(number);
            // The others may tell no sensor at all.
            let Ok(rest) = self.told_by(others) else {
                continue;
            };
            let off = self.off(&rest, frame)?;
            let (markers, most) = (*left_out.max(&off), frame.most_wrong());
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

    /// Number of a frame's markers whose readings lie off the sensor that other frames tell, by the noise and by what these
    /// leave unknown.
    fn off(&self, rest: &Rest, frame: &KnownFrame) -> Result<usize, PressError> {
        let impossible = PressError::OutOfRange;
        let Sensor {
            common,
            misalignments,
        } = rest.sensor();
        let moved = frame.moved_at(&common);
        let state = SensorState {
            common: &common,
            misalignments: &misalignments,
        };
        let slopes = self.slopes(&state, &moved, frame.per_depth.as_deref());
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

    fn pressed(&self, press: &KnownPress) -> Result<KnownFrame, PressError> {
        let KnownPress {
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
        let state = State {
            log_curvature: libm::log(*relative_curvature),
            place: self.markers.skin().place(*at),
            indentation: *indentation,
            shift: [0.0; 2],
        };
        let moved = self.moved(&state)?;
        Ok(KnownFrame {
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
        weights(seen)
    }
}
