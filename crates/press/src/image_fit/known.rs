//! Presses that are known, and that calibrate a sensor beside its frame at rest.

use nalgebra::Matrix4;

use super::frame::{KnownFrame, weights};
use super::law::State;
use super::outcome::WRONG;
use super::rest::Rest;
use super::settings::ImageFit;
use super::view::{Seen, View};
use crate::{MarkerDisplacement, PressError};

/// At most one in so many markers of a frame is left out.
const MOST_WRONG: usize = 8;

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
    /// are not seen. Markers of a press that contradict the others are left out of it.
    ///
    /// # Errors
    /// Errors of [`ImageFit::at_rest`], and of [`Body::press`](crate::Body::press) for a press that cannot be.
    pub fn calibrated(
        &self,
        at_rest: &[Option<Seen>],
        presses: &[KnownPress],
    ) -> Result<Rest, PressError> {
        self.validate()?;
        let markers = at_rest.len();
        let rest = KnownFrame {
            seen: at_rest.to_vec(),
            weights: self.weights(at_rest)?,
            moved: vec![[MarkerDisplacement::default(); 2]; at_rest.len()],
            per_depth: None,
        };
        if rest.weights.iter().flatten().count() == 0 {
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
        let mut rest = self.told_by(frames.clone())?;
        // One at a time: a wrong marker makes others seem wrong.
        for _ in 0..frames.len() * markers.div_ceil(MOST_WRONG) {
            let Some((frame, marker)) = self.worst(&rest, &frames)? else {
                break;
            };
            frames[frame].weights[marker] = None;
            rest = self.told_by(frames.clone())?;
        }
        Ok(rest)
    }

    /// The marker of a press that contradicts the sensor most, by its frame and number; `None` where none does.
    fn worst(
        &self,
        rest: &Rest,
        frames: &[KnownFrame],
    ) -> Result<Option<(usize, usize)>, PressError> {
        let sensor = rest.sensor();
        let (mut most, mut worst) = (WRONG, None);
        for (number, frame) in frames.iter().enumerate().skip(1) {
            let moved = frame.moved_at(&sensor.common);
            let pictures = self.view.pictures(&sensor.state(), &moved);
            let pictures = pictures.ok_or(PressError::OutOfRange)?;
            for (marker, weight) in frame.weights.iter().enumerate() {
                if let (Some(weight), Some(residual)) = (weight, frame.residual(marker, &pictures))
                {
                    let square = residual.dot(&(weight * residual));
                    if square > most {
                        (most, worst) = (square, Some((number, marker)));
                    }
                }
            }
        }
        Ok(worst)
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
