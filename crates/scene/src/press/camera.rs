//! A camera in the sensor's centre: turns the displacements of each marker's discs into readings.

use std::sync::Arc;

use palpate_chromatouch::{MarkerMotion, Optics, SeenMarker};
use palpate_estimators::marker_image;
use palpate_press::Seen;
use palpate_sensing::{Channel, GaussianError, Stream};
use palpate_tracking::{
    Calibration, Equidistant, Finder, FinderSettings, Found, Ground, Marker, MarkerErrors, Mask,
    Status, Track, match_markers,
};

use super::failure::PressFailure;

/// Trial number that seeds the noise of the first frame at rest; further frames count down from it.
pub(super) const AT_REST: u64 = u64::MAX;

/// A camera, its pictures of the markers at rest, and its calibration.
#[derive(Clone, Debug)]
pub(super) struct CameraSensor {
    pub(super) eye: Eye,
    /// Picture of each marker of the layout at rest; `None` if it is not visible.
    pub(super) rest: Arc<[Option<Marker>]>,
    pub(super) calibration: Calibration,
    /// Standard deviations of normal and tangential displacements near a contact, if the calibration yields them.
    pub(super) stds: [Option<f64>; 2],
}

/// The camera: its optics, and the fidelity level of its simulation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Eye {
    pub(super) optics: Optics,
    /// The lens model that tracking uses.
    pub(super) lens: Equidistant,
    pub(super) model: CameraModel,
    /// Whether pictures of the same markers differ because of noise.
    pub(super) is_random: bool,
    pub(super) seed: u64,
}

/// Fidelity level of the camera's simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CameraModel {
    /// The picture of each marker is computed directly, without pixels.
    Projected(SightError),
    /// Frames are rendered; markers are found and tracked in them.
    Rendered,
}

/// Errors of a marker's picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SightError {
    /// Error of the mean hue, turns.
    pub(super) hue: GaussianError,
    /// Error of each coordinate of the centroid, px.
    pub(super) centroid: GaussianError,
    /// Relative error of the size.
    pub(super) size: GaussianError,
}

impl SightError {
    pub(super) fn is_random(&self) -> bool {
        self.hue.is_random() || self.centroid.is_random() || self.size.is_random()
    }

    /// Covariance of the errors of a marker's picture.
    pub(super) fn errors(&self) -> MarkerErrors {
        // An exact picture has only numerical errors.
        const EXACT: [f64; 4] = [1e-7, 1e-7, 1e-9, 1e-8];
        let stds = [self.centroid, self.centroid, self.hue, self.size].map(|error| error.std());
        let mut covariance = [[0.0; 4]; 4];
        for number in 0..4 {
            covariance[number][number] = stds[number].max(EXACT[number]).powi(2);
        }
        MarkerErrors { covariance }
    }

    pub(super) fn averaged(self, frames: u32) -> Self {
        Self {
            hue: self.hue.averaged(frames),
            centroid: self.centroid.averaged(frames),
            size: self.size.averaged(frames),
        }
    }
}

/// The camera's reading of all markers in a press.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sight {
    /// Track of each marker from rest to press; `None` if it is not visible at rest.
    pub(super) tracks: Vec<Option<Track>>,
    /// Number of markers that were matched to a wrong marker.
    pub(super) wrong_matches: usize,
    /// Errors of each marker in the press; `None` if it was not found as a single marker.
    pub(super) errors: Vec<Option<MarkerErrors>>,
}

/// A marker's picture, and the covariance of its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spotted {
    pub(super) marker: Marker,
    pub(super) errors: MarkerErrors,
}

impl Spotted {
    /// The image of the marker with its errors, as a fit takes it.
    pub(super) fn image(&self) -> Seen {
        marker_image(&self.marker, &self.errors)
    }
}

impl Eye {
    /// Pictures of the markers at rest, with the noise of trial number `draw`, if any.
    pub(super) fn at_rest(&self, draw: Option<u64>) -> Result<Vec<Option<Spotted>>, PressFailure> {
        let motions = vec![Some(MarkerMotion::default()); self.optics.array().len()];
        let images = self.images(&motions)?;
        match self.model {
            CameraModel::Projected(error) => {
                let seen = self.erring(images, error, draw).into_iter();
                let errors = error.errors();
                Ok(seen
                    .map(|marker| marker.map(|marker| Spotted { marker, errors }))
                    .collect())
            }
            CameraModel::Rendered => {
                let found = self.found(&motions, draw)?;
                let mut rest = vec![None; motions.len()];
                for (marker, errors) in found.markers.into_iter().zip(found.errors) {
                    if let Some(nearest) = nearest(&images, marker.centroid_px) {
                        rest[nearest] = Some(Spotted { marker, errors });
                    }
                }
                Ok(rest)
            }
        }
    }

    /// Reads markers that moved by `motions` (`None`: lost), with the noise of trial number `draw`, if any.
    pub(super) fn sight(
        &self,
        rest: &[Option<Marker>],
        motions: &[Option<MarkerMotion>],
        draw: Option<u64>,
    ) -> Result<Sight, PressFailure> {
        let images = self.images(motions)?;
        match self.model {
            CameraModel::Projected(error) => {
                let seen = self.erring(images, error, draw);
                let errors = seen.iter().map(|seen| seen.map(|_| error.errors()));
                let errors = errors.collect();
                let tracks = rest.iter().zip(seen);
                Ok(Sight {
                    tracks: tracks
                        .map(|(rest, seen)| rest.map(|rest| track(rest, seen)))
                        .collect(),
                    wrong_matches: 0,
                    errors,
                })
            }
            CameraModel::Rendered => {
                let known: Vec<usize> =
                    (0..rest.len()).filter(|&one| rest[one].is_some()).collect();
                let at_rest: Vec<Marker> = rest.iter().flatten().copied().collect();
                let found = self.found(motions, draw)?;
                let matched = match_markers(&at_rest, &found.markers);
                let mut tracks = vec![None; rest.len()];
                let mut errors = vec![None; rest.len()];
                let mut wrong_matches = 0;
                for (&marker, track) in known.iter().zip(matched) {
                    let is_other = track.change().is_some()
                        && track
                            .pressed
                            .and_then(|pressed| nearest(&images, pressed.centroid_px))
                            != Some(marker);
                    wrong_matches += usize::from(is_other);
                    errors[marker] = track.pressed.and_then(|marker| found.errors_of(&marker));
                    tracks[marker] = Some(track);
                }
                Ok(Sight {
                    tracks,
                    wrong_matches,
                    errors,
                })
            }
        }
    }

    /// Standard deviation of the pixel noise, in levels of 255; `None` without frames or noise.
    pub(super) fn pixel_std(&self) -> Option<f64> {
        let std = self.optics.blemishes().pixel_std;
        let is_rendered = matches!(self.model, CameraModel::Rendered);
        Some(std).filter(|&std| is_rendered && std > 0.0)
    }

    /// Number of pixels rendered per frame.
    pub(super) fn pixels(&self) -> f64 {
        match self.model {
            CameraModel::Projected(_) => 0.0,
            CameraModel::Rendered => f64::from(self.optics.camera().size_px()).powi(2),
        }
    }

    /// Renders a frame, with the pixel noise of trial number `draw`, if any.
    pub(super) fn frame(
        &self,
        motions: &[Option<MarkerMotion>],
        draw: Option<u64>,
    ) -> Result<image::RgbImage, PressFailure> {
        let mut stream = draw.map(|trial| Stream::new(self.seed, trial, Channel::Pixel));
        Ok(self.optics.rendered(motions, stream.as_mut())?)
    }

    /// Picture of each marker, computed without pixels; `None` if it is not visible.
    fn images(
        &self,
        motions: &[Option<MarkerMotion>],
    ) -> Result<Vec<Option<SeenMarker>>, PressFailure> {
        Ok(self.optics.projected(motions)?)
    }

    fn erring(
        &self,
        images: Vec<Option<SeenMarker>>,
        error: SightError,
        draw: Option<u64>,
    ) -> Vec<Option<Marker>> {
        let exact = |seen: SeenMarker| Marker {
            centroid_px: seen.centroid_px,
            hue_turns: seen.hue_turns,
            size_px2: seen.size_px2,
            pixels: 0,
        };
        let Some(trial) = draw.filter(|_| error.is_random()) else {
            return images.into_iter().map(|seen| seen.map(exact)).collect();
        };
        let [mut of_hue, mut of_centroid, mut of_size] =
            [Channel::Hue, Channel::Centroid, Channel::Size]
                .map(|channel| Stream::new(self.seed, trial, channel));
        // Draw for every marker, visible or not, so that scenes share random numbers.
        let erring = |seen: Option<SeenMarker>| {
            let hue = error.hue.draw(&mut of_hue);
            let centroid = [(); 2].map(|()| error.centroid.draw(&mut of_centroid));
            let size = error.size.draw(&mut of_size);
            let seen = exact(seen?);
            Some(Marker {
                centroid_px: [0, 1].map(|axis| seen.centroid_px[axis] + centroid[axis]),
                hue_turns: (seen.hue_turns + hue).rem_euclid(1.0),
                size_px2: seen.size_px2 * libm::exp(size),
                ..seen
            })
        };
        images.into_iter().map(erring).collect()
    }

    /// Finds the markers in a rendered frame.
    fn found(
        &self,
        motions: &[Option<MarkerMotion>],
        draw: Option<u64>,
    ) -> Result<Found, PressFailure> {
        let camera = self.optics.camera();
        let mut finder = Finder::new(FinderSettings {
            mask: Some(Mask {
                centre_px: camera.centre_px(),
                radius_px: camera.rim_px(),
            }),
            ground: Some(Ground::Bright),
            ..FinderSettings::default()
        })?;
        Ok(finder.find(&self.frame(motions, draw)?)?)
    }
}

impl CameraSensor {
    /// Displacements of the tracked markers: index, normal and tangential displacement (lengths).
    pub(super) fn displacements(&self, sight: &Sight) -> Vec<(usize, f64, [f64; 2])> {
        let tracks = sight.tracks.iter().enumerate();
        tracks
            .filter_map(|(marker, track)| {
                let change = self.eye.lens.change(track.as_ref()?)?;
                let normal = self.calibration.normal(marker, &change)?;
                let tangential = self.calibration.tangential(change.shift_px, normal)?;
                Some((marker, normal, tangential))
            })
            .collect()
    }
}

fn track(rest: Marker, pressed: Option<Marker>) -> Track {
    Track {
        rest: Some(rest),
        pressed,
        status: match pressed {
            Some(_) => Status::Tracked,
            None => Status::Lost,
        },
    }
}

/// Index of the marker nearest to a place in the image.
fn nearest(images: &[Option<SeenMarker>], [x, y]: [f64; 2]) -> Option<usize> {
    let distance =
        |seen: &SeenMarker| libm::hypot(seen.centroid_px[0] - x, seen.centroid_px[1] - y);
    let seen = images.iter().enumerate();
    seen.filter_map(|(marker, seen)| Some((marker, distance(seen.as_ref()?))))
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .map(|(marker, _)| marker)
}
