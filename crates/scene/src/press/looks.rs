//! Camera readings before the first trial: the markers at rest and in the calibration presses.

use std::sync::Arc;

use palpate_chromatouch::MarkerMotion;
use palpate_tracking::{Change, Marker};

use super::camera::{AT_REST, Eye, Spotted};
use super::failure::PressFailure;

/// Calibration presses use the trial numbers below this for their noise; frames at rest use those above.
const FIRST: u64 = AT_REST - 1000;

/// Reading of the markers at rest, with all its inputs: a cache key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestLook {
    pub(super) eye: Eye,
    /// Number of frames that are averaged.
    frames: u32,
}

impl RestLook {
    /// Averages `frames` frames, or uses one if frames have no noise.
    pub(super) fn new(eye: &Eye, frames: u32) -> Self {
        Self {
            eye: eye.clone(),
            frames: if eye.is_random { frames } else { 1 },
        }
    }

    /// Number of markers.
    pub(super) fn size(&self) -> usize {
        self.eye.optics.array().len()
    }

    /// Pictures of the markers; `None` for invisible ones.
    pub(super) fn markers(&self) -> Result<Vec<Option<Marker>>, PressFailure> {
        let spotted = self.spotted(AT_REST)?;
        Ok(spotted
            .iter()
            .map(|one| one.map(|one| one.marker))
            .collect())
    }

    /// Pictures of the markers with their errors; the trial numbers from `first` down seed the noise of the frames.
    pub(super) fn spotted(&self, first: u64) -> Result<Vec<Option<Spotted>>, PressFailure> {
        let spotted = self.eye.at_rest(Some(first))?;
        let mean = |one: &Option<Spotted>| one.map(|one| Mean::of(one.marker));
        let mut means: Vec<Option<Mean>> = spotted.iter().map(mean).collect();
        for frame in 1..u64::from(self.frames) {
            for (mean, one) in means
                .iter_mut()
                .zip(self.eye.at_rest(Some(first.wrapping_sub(frame)))?)
            {
                if let (Some(mean), Some(one)) = (mean, one) {
                    mean.add(one.marker);
                }
            }
        }
        let pairs = means.iter().zip(&spotted);
        Ok(pairs
            .map(|(mean, first)| {
                Some(Spotted {
                    marker: mean.as_ref()?.marker(),
                    errors: (*first)?.errors.averaged(self.frames),
                })
            })
            .collect())
    }
}

/// Picture of each marker; `None` if the camera does not find it.
pub(super) type Seen = Arc<[Option<Marker>]>;

/// Camera readings of presses, with all their inputs: a cache key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PressLooks {
    pub(super) rest: RestLook,
    /// Displacements of the discs of each marker in each press.
    pub(super) motions: Vec<Vec<MarkerMotion>>,
}

/// Changes of each marker's picture in each press; `None` where it was not tracked.
pub(super) type Changes = Arc<[Vec<Option<Change>>]>;

impl PressLooks {
    /// Number of markers in all presses and at rest.
    pub(super) fn size(&self) -> usize {
        self.rest.size() * (1 + self.motions.len())
    }

    /// Changes of the markers' pictures from `rest` to each press.
    pub(super) fn changes(&self, rest: &[Option<Marker>]) -> Result<Changes, PressFailure> {
        let eye = &self.rest.eye;
        let change = |(motions, press): (&Vec<MarkerMotion>, u64)| {
            let motions: Vec<_> = motions.iter().copied().map(Some).collect();
            let sight = eye.sight(rest, &motions, Some(FIRST - press))?;
            let tracks = sight.tracks.iter();
            Ok(tracks
                .map(|track| eye.lens.change(track.as_ref()?))
                .collect())
        };
        self.motions.iter().zip(1..).map(change).collect()
    }
}

/// The mean of several pictures of a marker.
struct Mean {
    first: Marker,
    count: f64,
    /// Sums of the differences from `first`: centroid, hue, size.
    sums: [f64; 4],
}

impl Mean {
    fn of(first: Marker) -> Self {
        Self {
            first,
            count: 1.0,
            sums: [0.0; 4],
        }
    }

    fn add(&mut self, marker: Marker) {
        let turn = marker.hue_turns - self.first.hue_turns;
        let differences = [
            marker.centroid_px[0] - self.first.centroid_px[0],
            marker.centroid_px[1] - self.first.centroid_px[1],
            turn - (turn + 0.5).floor(),
            marker.size_px2 - self.first.size_px2,
        ];
        for (sum, difference) in self.sums.iter_mut().zip(differences) {
            *sum += difference;
        }
        self.count += 1.0;
    }

    fn marker(&self) -> Marker {
        let [x, y, hue, size] = self.sums.map(|sum| sum / self.count);
        Marker {
            centroid_px: [self.first.centroid_px[0] + x, self.first.centroid_px[1] + y],
            hue_turns: (self.first.hue_turns + hue).rem_euclid(1.0),
            size_px2: self.first.size_px2 + size,
            ..self.first
        }
    }
}
