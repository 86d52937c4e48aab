//! A press that is read by a camera.

use palpate_chromatouch::MarkerMotion;
use palpate_press::KnownPress;
use palpate_sensing::{Channel, Stream};

use super::camera::{AT_REST, CameraModel, CameraSensor, Eye, Sight};
use super::departed::{Departed, Redrawn};
use super::failure::PressFailure;
use super::readings::MarkerReadings;
use palpate_estimators::{MarkerImages, pressed_images};

/// A press that is read by a camera.
#[derive(Clone, Debug)]
pub(super) struct CameraPress {
    pub(super) sensor: CameraSensor,
    /// Displacements of the discs of each marker in the press.
    pub(super) motions: Vec<MarkerMotion>,
    /// Number of lost markers, chosen at random in every trial.
    pub(super) lost_markers: usize,
    /// Number of markers visible at rest, minus the lost ones.
    pub(super) seen: usize,
    /// The marker nearest to the contact.
    pub(super) under_contact: usize,
    /// Change of that marker's picture, without noise and pixels.
    pub(super) shown: Option<Shows>,
    /// Draws the sensor of each trial, if trials redraw it.
    pub(super) redrawn: Option<Redrawn>,
}

/// Smaller shifts are rounding errors and count as 0, px.
const ROUNDING_PX: f64 = 1e-9;

/// Change of a marker's picture in a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shows {
    /// Change of its mean hue, turns.
    pub(super) hue_turns: f64,
    /// Shift of its centroid, in pixels at the scale of the image centre.
    pub(super) shift_px: f64,
}

impl CameraPress {
    /// Whether readings differ between trials.
    pub(super) fn is_random(&self) -> bool {
        self.lost_markers > 0 || self.sensor.eye.is_random || self.redrawn.is_some()
    }

    /// Replaces the true displacements by the camera's readings.
    pub(super) fn read(
        &self,
        readings: &mut MarkerReadings,
        trial: Option<u64>,
    ) -> Result<(), PressFailure> {
        let departed = match (&self.redrawn, trial) {
            (Some(redrawn), Some(trial)) => Some(redrawn.sensor(&self.sensor.eye, trial)?),
            _ => None,
        };
        let sight = match &departed {
            Some(Departed {
                eye,
                motions,
                markers,
                ..
            }) => eye.sight(markers, &self.kept(motions, trial), trial)?,
            None => self.sight(trial)?,
        };
        readings.pictures = Some(MarkerImages {
            own_rest: departed.map(|departed| departed.rest),
            calibrating: Vec::new(),
            pressed: pressed_images(&sight.tracks, &sight.errors),
        });
        let mut tracked = Vec::new();
        for (marker, normal, tangential) in self.sensor.displacements(&sight) {
            readings.normal[marker] = normal;
            readings.tangential[marker] = tangential;
            tracked.push(marker);
        }
        readings.tracked = Some(tracked);
        readings.sight = Some(sight);
        Ok(())
    }

    /// Calibration presses of a trial's sensor, with its readings; none if all trials share a sensor.
    pub(super) fn calibrating(&self, trial: u64) -> Result<Vec<KnownPress>, PressFailure> {
        match &self.redrawn {
            Some(redrawn) => redrawn.calibrating(&self.sensor.eye, trial),
            None => Ok(Vec::new()),
        }
    }

    /// The camera's reading of the markers: without noise, or in trial number `trial`.
    pub(super) fn sight(&self, trial: Option<u64>) -> Result<Sight, PressFailure> {
        let motions = self.motions(trial);
        let CameraSensor { eye, rest, .. } = &self.sensor;
        eye.sight(rest, &motions, trial)
    }

    /// The frames at rest and pressed, if there are any.
    pub(super) fn frames(
        &self,
        trial: Option<u64>,
    ) -> Result<Option<[image::RgbImage; 2]>, PressFailure> {
        let eye = &self.sensor.eye;
        let rest = vec![Some(MarkerMotion::default()); self.motions.len()];
        if !matches!(eye.model, CameraModel::Rendered) {
            return Ok(None);
        }
        let at_rest = trial.map(|_| AT_REST);
        let pressed = eye.frame(&self.motions(trial), trial)?;
        Ok(Some([eye.frame(&rest, at_rest)?, pressed]))
    }

    /// Displacements of the discs; `None` for lost markers.
    fn motions(&self, trial: Option<u64>) -> Vec<Option<MarkerMotion>> {
        self.kept(&self.motions, trial)
    }

    fn kept(&self, motions: &[MarkerMotion], trial: Option<u64>) -> Vec<Option<MarkerMotion>> {
        let mut motions: Vec<_> = motions.iter().copied().map(Some).collect();
        if let Some(trial) = trial.filter(|_| self.lost_markers > 0) {
            let mut stream = Stream::new(self.sensor.eye.seed, trial, Channel::LostMarkers);
            for marker in stream.choose(self.lost_markers, motions.len()) {
                motions[marker] = None;
            }
        }
        motions
    }

    /// Change of the picture of the marker under the contact, if it is tracked.
    pub(super) fn under_contact(&self, sight: &Sight) -> Option<Shows> {
        Shows::of(&self.sensor.eye, sight, self.under_contact)
    }
}

impl Shows {
    pub(super) fn of(eye: &Eye, sight: &Sight, marker: usize) -> Option<Self> {
        let change = eye.lens.change(sight.tracks.get(marker)?.as_ref()?)?;
        let [x, y] = change.shift_px;
        Some(Self {
            hue_turns: change.hue_turns,
            shift_px: Some(libm::hypot(x, y))
                .filter(|&shift| shift > ROUNDING_PX)
                .unwrap_or(0.0),
        })
    }
}
