//! A camera in the centre of the sensor. It images the markers after the press has displaced their discs.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, Layout, Lens, MarkerMotion, OddTerms, Optics, Pose, Seams,
    SeenMarker,
};
use palpate_estimators::{marker_image, optics_error};
use palpate_press::Seen;
use palpate_sensing::{Channel, GaussianError, Stream};
use palpate_study::FieldError;
use palpate_study::config::{CameraConfig, PressNoiseConfig, Pure, ReadingNoise};
use palpate_tracking::{
    Equidistant, Finder, Found, Ground, Marker, MarkerErrors, Mask, Status, Track, match_markers,
};

use super::PressFailure;
use super::plan::PressSetup;
use super::reading::gaussian;

/// Trial number that seeds the noise of the first frame at rest. Each further frame has the next smaller number.
pub(super) const AT_REST: u64 = u64::MAX;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct SimulatedCamera {
    pub(super) optics: Optics,
    /// Lens model with which the tracking converts pixels to directions.
    pub(super) lens: Equidistant,
    pub(super) model: CameraModel,
    pub(super) is_random: bool,
    pub(super) seed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CameraModel {
    Projected(ImageNoise),
    Rendered,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ImageNoise {
    /// Error (turns) of both hues of a marker: the hue of its summed light, and the mean hue of its pixels.
    hue: GaussianError,
    /// Error of each coordinate of a marker's centroid, px.
    centroid: GaussianError,
    /// Relative error of the size of a marker's image.
    size: GaussianError,
}

impl ImageNoise {
    /// Noise of the means over `frames` frames.
    fn new(config: &PressNoiseConfig, frames: u32) -> Result<Self, FieldError> {
        let pure = |noise: Option<ReadingNoise<Pure>>, key: &str| {
            let std = noise.map(|ReadingNoise::Gaussian { std }| std.0);
            Ok(gaussian(std, key)?.averaged(frames))
        };
        Ok(Self {
            hue: pure(config.hue, "hue")?,
            centroid: pure(config.centroid, "centroid")?,
            size: pure(config.size, "size")?,
        })
    }

    fn is_random(&self) -> bool {
        self.hue.is_random() || self.centroid.is_random() || self.size.is_random()
    }

    fn errors(&self) -> MarkerErrors {
        // Numerical errors of a computed image of a marker without noise: of both centroid coordinates (px), of the hue
        // (turns), and of the logarithm of the size.
        const EXACT: [f64; 4] = [1e-7, 1e-7, 1e-9, 1e-8];
        let stds = [self.centroid, self.centroid, self.hue, self.size].map(|error| error.std());
        let mut covariance = [[0.0; 4]; 4];
        for number in 0..4 {
            covariance[number][number] = stds[number].max(EXACT[number]).powi(2);
        }
        MarkerErrors { covariance }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct MarkerTracks {
    /// Track of each marker of the layout from the frame at rest to the pressed frame; `None` if the marker is not
    /// visible at rest.
    pub(super) tracks: Vec<Option<Track>>,
    /// Number of markers to which the tracking assigned the image of another marker in the pressed frame.
    pub(super) wrong_matches: usize,
    /// Errors of each marker's image in the pressed frame; `None` if the marker is lost or its image is merged with
    /// another.
    pub(super) errors: Vec<Option<MarkerErrors>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MarkerMeasurement {
    pub(super) marker: Marker,
    pub(super) errors: MarkerErrors,
}

impl MarkerMeasurement {
    pub(super) fn image(&self) -> Seen {
        marker_image(&self.marker, &self.errors)
    }
}

impl SimulatedCamera {
    /// Builds the camera of a config. If `is_rendered`, the camera renders frames. Otherwise, it computes the centroids
    /// and hues of the markers directly, without pixels.
    pub(super) fn new(
        setup: &PressSetup<'_>,
        config: &CameraConfig,
        is_rendered: bool,
    ) -> Result<Self, FieldError> {
        let (k3, k5, seam_width) = (config.k3, config.k5, config.seam_width);
        let noise = &setup.config.noise;
        let pixel = noise.pixel.map(|ReadingNoise::Gaussian { std }| std.0);
        let pixel = gaussian(pixel, "pixel")?;
        let lens = Lens::from(OddTerms { k3, k5 });
        let camera = Camera::new(lens, config.size_px, config.field_deg)
            .map_err(|error| optics_error(&error))?;
        let blemishes = Blemishes {
            light_at_rim: config.light_at_rim,
            blur_px: config.blur_px,
            seams: match setup.sphere.layout {
                Layout::Gores { gores, .. } if seam_width > 0.0 => Some(Seams {
                    gores,
                    width: seam_width,
                }),
                _ => None,
            },
            pixel_std: pixel.averaged(config.frames).std(),
        };
        let array = setup.sphere.array(setup.places, Some(setup.seed))?;
        let pose = Pose::new(config.place, config.turn_deg.map(f64::to_radians));
        let optics = Optics::new(array, camera, Colours::default(), blemishes)
            .and_then(|optics| optics.seen_from(pose))
            .map_err(|error| optics_error(&error))?;
        let (model, is_random) = if is_rendered {
            (CameraModel::Rendered, pixel.is_random())
        } else {
            let noise = ImageNoise::new(noise, config.frames)?;
            (CameraModel::Projected(noise), noise.is_random())
        };
        let lens = Equidistant::new(camera.centre_px(), camera.px_per_rad(), [k3, k5])
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        Ok(Self {
            optics,
            lens,
            model,
            is_random,
            seed: setup.seed,
        })
    }

    /// The same camera, but without noise, and with images of the markers that are computed directly, without pixels.
    pub(super) fn exact(&self) -> Self {
        Self {
            model: CameraModel::Projected(ImageNoise::default()),
            ..self.clone()
        }
    }

    /// Images of the markers at rest. The images have the noise of trial number `trial`; they have no noise if `trial`
    /// is `None`.
    pub(super) fn at_rest(
        &self,
        trial: Option<u64>,
    ) -> Result<Vec<Option<MarkerMeasurement>>, PressFailure> {
        let motions = vec![Some(MarkerMotion::default()); self.optics.array().places().len()];
        let images = self.optics.project(&motions)?;
        match self.model {
            CameraModel::Projected(noise) => {
                let markers = self.with_noise(images, noise, trial).into_iter();
                let errors = noise.errors();
                Ok(markers
                    .map(|marker| marker.map(|marker| MarkerMeasurement { marker, errors }))
                    .collect())
            }
            CameraModel::Rendered => {
                let found = self.find_markers(&motions, trial)?;
                let mut rest = vec![None; motions.len()];
                for (marker, errors) in found.markers.into_iter().zip(found.errors) {
                    if let Some(nearest) = nearest(&images, marker.centroid_px) {
                        rest[nearest] = Some(MarkerMeasurement { marker, errors });
                    }
                }
                Ok(rest)
            }
        }
    }

    /// Tracks the markers from rest to a press. `motions` contains the motion of each marker in the press; `None` for a
    /// lost marker. The images have the noise of trial number `trial`; they have no noise if `trial` is `None`.
    pub(super) fn track(
        &self,
        rest: &[Option<Marker>],
        motions: &[Option<MarkerMotion>],
        trial: Option<u64>,
    ) -> Result<MarkerTracks, PressFailure> {
        let images = self.optics.project(motions)?;
        match self.model {
            CameraModel::Projected(noise) => {
                let markers = self.with_noise(images, noise, trial);
                let errors = markers.iter().map(|marker| marker.map(|_| noise.errors()));
                let errors = errors.collect();
                let tracks = rest.iter().zip(markers);
                Ok(MarkerTracks {
                    tracks: tracks
                        .map(|(rest, pressed)| rest.map(|rest| exact_track(rest, pressed)))
                        .collect(),
                    wrong_matches: 0,
                    errors,
                })
            }
            CameraModel::Rendered => {
                let visible: Vec<usize> =
                    (0..rest.len()).filter(|&one| rest[one].is_some()).collect();
                let at_rest: Vec<Marker> = rest.iter().flatten().copied().collect();
                let found = self.find_markers(motions, trial)?;
                let matched = match_markers(&at_rest, &found.markers);
                let mut all = MarkerTracks {
                    tracks: vec![None; rest.len()],
                    wrong_matches: 0,
                    errors: vec![None; rest.len()],
                };
                for (&marker, track) in visible.iter().zip(matched) {
                    let is_other = track.change().is_some()
                        && track
                            .pressed
                            .and_then(|pressed| nearest(&images, pressed.centroid_px))
                            != Some(marker);
                    all.wrong_matches += usize::from(is_other);
                    all.errors[marker] = track.pressed.and_then(|marker| found.errors_of(&marker));
                    all.tracks[marker] = Some(track);
                }
                Ok(all)
            }
        }
    }

    pub(super) fn pixels(&self) -> f64 {
        match self.model {
            CameraModel::Projected(_) => 0.0,
            CameraModel::Rendered => f64::from(self.optics.camera().size_px()).powi(2),
        }
    }

    /// Renders a frame. It has the pixel noise of trial number `trial`; it has no noise if `trial` is `None`.
    pub(super) fn render(
        &self,
        motions: &[Option<MarkerMotion>],
        trial: Option<u64>,
    ) -> Result<image::RgbImage, PressFailure> {
        let noise = trial.map(|trial| (self.seed, trial));
        Ok(self.optics.render(motions, noise)?)
    }

    fn with_noise(
        &self,
        images: Vec<Option<SeenMarker>>,
        noise: ImageNoise,
        trial: Option<u64>,
    ) -> Vec<Option<Marker>> {
        let exact = |image: SeenMarker| Marker {
            centroid_px: image.centroid_px,
            hue_turns: image.hue_turns,
            mean_hue_turns: image.mean_hue_turns,
            size_px2: image.size_px2,
            pixels: 0,
        };
        let Some(trial) = trial.filter(|_| noise.is_random()) else {
            return images.into_iter().map(|image| image.map(exact)).collect();
        };
        let [mut hues, mut centroids, mut sizes] = [Channel::Hue, Channel::Centroid, Channel::Size]
            .map(|channel| Stream::new(self.seed, trial, channel));
        // Draw random numbers for every marker, even if it is invisible. Otherwise, the noise of a marker would depend
        // on the visibility of other markers.
        let noisy = |image: Option<SeenMarker>| {
            let hue = noise.hue.draw(&mut hues);
            let centroid = [(); 2].map(|()| noise.centroid.draw(&mut centroids));
            let size = noise.size.draw(&mut sizes);
            let image = exact(image?);
            Some(Marker {
                centroid_px: [0, 1].map(|axis| image.centroid_px[axis] + centroid[axis]),
                hue_turns: (image.hue_turns + hue).rem_euclid(1.0),
                mean_hue_turns: image.mean_hue_turns + hue,
                size_px2: image.size_px2 * libm::exp(size),
                ..image
            })
        };
        images.into_iter().map(noisy).collect()
    }

    fn find_markers(
        &self,
        motions: &[Option<MarkerMotion>],
        trial: Option<u64>,
    ) -> Result<Found, PressFailure> {
        let camera = self.optics.camera();
        let circle = Mask {
            centre_px: camera.centre_px(),
            radius_px: 0.5 * f64::from(camera.size_px()),
        };
        let mut finder = Finder::new(Some(circle), Some(Ground::Bright));
        Ok(finder.find(&self.render(motions, trial)?)?)
    }
}

fn exact_track(rest: Marker, pressed: Option<Marker>) -> Track {
    Track {
        rest: Some(rest),
        pressed,
        status: match pressed {
            Some(_) => Status::Tracked,
            None => Status::Lost,
        },
    }
}

fn nearest(images: &[Option<SeenMarker>], [x, y]: [f64; 2]) -> Option<usize> {
    let distance =
        |image: &SeenMarker| libm::hypot(image.centroid_px[0] - x, image.centroid_px[1] - y);
    images
        .iter()
        .enumerate()
        .filter_map(|(marker, image)| Some((marker, distance(image.as_ref()?))))
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .map(|(marker, _)| marker)
}
