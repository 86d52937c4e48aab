//! Looks that a camera takes before its first trial: at its markers at rest, and at those of the presses that calibrate it.

use std::sync::Arc;

use palpate_chromatouch::MarkerMotion;
use palpate_tracking::{Change, Marker};

use super::camera::{AT_REST, Eye, Spotted};
use super::failure::PressFailure;

/// The number of the trial whose errors the first press has, below as many frames at rest as there may be.
const FIRST: u64 = AT_REST - 1000;

/// Look at the markers at rest, with all that it depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestLook {
    pub(super) eye: Eye,
    /// Number of frames that are averaged.
    frames: u32,
}

impl RestLook {
    /// Look by the mean of so many frames, or by one where they would be alike.
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

    /// The markers as they are seen; `None` for those that are not.
    pub(super) fn markers(&self) -> Result<Vec<Option<Marker>>, PressFailure> {
        let spotted = self.spotted(AT_REST)?;
        Ok(spotted
            .iter()
            .map(|one| one.map(|one| one.marker))
            .collect())
    }

    /// The markers as they are seen, with their errors; the frames have the errors of the trials from `first` down.
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

/// The markers as a camera sees them; `None` for those that it does not find.
pub(super) type Seen = Arc<[Option<Marker>]>;

/// Looks at presses, with all that they depend on.
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

    /// Changes since the markers were seen at rest, as `rest` has them.
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

/// The mean of several sights of a marker.
struct Mean {
    first: Marker,
    count: f64,
    /// Sums of what others differ by: centroid, hue, size.
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
