//! Plan of a press before a camera: the optics, the markers at rest, and what the press shows.

use palpate_chromatouch::{Blemishes, Camera, Colours, Lens, MarkerMotion, Optics};
use palpate_press::PressError;
use palpate_sensing::GaussianError;
use palpate_study::config::{
    CameraConfig, CentroidNoise, HueNoise, PixelNoise, PressNoiseConfig, SizeNoise,
};
use palpate_tracking::{Equidistant, Marker};

use super::super::camera::{AT_REST, CameraModel, CameraSensor, Eye, SightError};
use super::super::failure::PressFailure;
use super::super::pressed::Pressed;
use super::super::readings::{count_of, gaussian};
use super::super::seen::{CameraPress, Shows};
use super::calibrated::{CalibratedCamera, CalibrationPresses};
use super::discs::DiscMarkers;
use crate::marker_sphere::{MarkerSphere, of_optics};
use crate::plan::PlanError;

/// A camera and markers with discs, ready to be looked at.
pub(super) struct CameraPlan<'a> {
    pub(super) sphere: &'a MarkerSphere<'a>,
    pub(super) camera: &'a CameraConfig,
    /// Whether frames are rendered.
    pub(super) is_rendered: bool,
    pub(super) noise: &'a PressNoiseConfig,
    pub(super) seed: u64,
    pub(super) places: &'a [[f64; 2]],
    pub(super) discs: DiscMarkers<'a>,
}

impl CameraPlan<'_> {
    /// The press before the camera. The outer error is the config's; the inner one where there is no press.
    pub(super) fn press(
        &self,
        pressed: &Pressed,
    ) -> Result<Result<CameraPress, PressError>, PlanError> {
        let eye = self.eye()?;
        let motions = match self.discs.motions(pressed) {
            Ok(motions) => motions,
            Err(error) => return Ok(Err(error)),
        };
        let lost = self.noise.lost_markers.as_ref().map(|lost| lost.count);
        let lost_markers = count_of(lost, "lost_markers", self.places.len())?;
        let rest = self
            .at_rest(&eye)
            .map_err(|error| PlanError::at("scene.sensor", error))?;
        let seen = rest.iter().flatten().count();
        if seen == 0 {
            let message = "the camera sees no marker: see `scene.sensor.field_deg`";
            return Err(PlanError::at("scene.sensor", message));
        }
        let presses = CalibrationPresses {
            camera: self.camera,
            discs: &self.discs,
            eye: &eye,
            rest: &rest,
            indentation: pressed.indentation,
        };
        let CalibratedCamera { calibration, stds } = presses.calibrated()?;
        let under_contact = self.discs.nearest(pressed.at).unwrap_or(0);
        Ok(Ok(CameraPress {
            shown: exact(&eye, &motions, under_contact),
            seen: seen.saturating_sub(lost_markers),
            sensor: CameraSensor {
                eye,
                rest,
                calibration,
                stds,
            },
            motions,
            lost_markers,
            under_contact,
        }))
    }

    /// The markers at rest, the mean of several frames where these differ.
    fn at_rest(&self, eye: &Eye) -> Result<Vec<Option<Marker>>, PressFailure> {
        let frames = match eye.is_random {
            true => u64::from(self.camera.calibration.rest_frames),
            false => 1,
        };
        let first = eye.at_rest(Some(AT_REST))?;
        let mut means: Vec<Option<Mean>> = first.iter().map(|one| one.map(Mean::of)).collect();
        for frame in 1..frames {
            for (mean, marker) in means.iter_mut().zip(eye.at_rest(Some(AT_REST - frame))?) {
                if let (Some(mean), Some(marker)) = (mean, marker) {
                    mean.add(marker);
                }
            }
        }
        Ok(means
            .iter()
            .map(|mean| mean.as_ref().map(Mean::marker))
            .collect())
    }

    fn eye(&self) -> Result<Eye, PlanError> {
        let CameraConfig {
            size_px,
            field_deg,
            frames,
            light_at_rim,
            blur_px,
            seam_width,
            ..
        } = *self.camera;
        let pixel = self.noise.pixel.as_ref();
        let pixel = gaussian(pixel.map(|PixelNoise::Gaussian { std }| *std), "pixel")?;
        let camera =
            Camera::new(Lens::Fisheye, size_px, field_deg).map_err(|error| of_optics(&error))?;
        let blemishes = Blemishes {
            light_at_rim,
            blur_px,
            seams: self.sphere.seams(seam_width),
            pixel_std: pixel.averaged(frames).std(),
        };
        let array = self.sphere.made(self.places, self.seed)?;
        let optics = Optics::new(array, camera, Colours::default(), blemishes)
            .map_err(|error| of_optics(&error))?;
        let (model, is_random) = if self.is_rendered {
            (CameraModel::Rendered, pixel.is_random())
        } else {
            let error = sight_error(self.noise)?.averaged(frames);
            (CameraModel::Projected(error), error.is_random())
        };
        let lens = Equidistant::new(camera.centre_px(), camera.px_per_rad())
            .map_err(|error| PlanError::at("scene.sensor", error))?;
        Ok(Eye {
            optics,
            lens,
            model,
            is_random,
            seed: self.seed,
        })
    }
}

/// Picture of a marker without errors and pixels, as it changed in the press.
fn exact(eye: &Eye, motions: &[MarkerMotion], marker: usize) -> Option<Shows> {
    let none = GaussianError::new(0.0).ok()?;
    let exact = Eye {
        model: CameraModel::Projected(SightError {
            hue: none,
            centroid: none,
            size: none,
        }),
        ..eye.clone()
    };
    let rest = exact.at_rest(None).ok()?;
    let motions: Vec<_> = motions.iter().copied().map(Some).collect();
    let sight = exact.sight(&rest, &motions, None).ok()?;
    Shows::of(&exact, &sight, marker)
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

fn sight_error(noise: &PressNoiseConfig) -> Result<SightError, PlanError> {
    let hue = noise.hue.as_ref();
    let centroid = noise.centroid.as_ref();
    let size = noise.size.as_ref();
    Ok(SightError {
        hue: gaussian(hue.map(|HueNoise::Gaussian { std }| *std), "hue")?,
        centroid: gaussian(
            centroid.map(|CentroidNoise::Gaussian { std }| *std),
            "centroid",
        )?,
        size: gaussian(size.map(|SizeNoise::Gaussian { std }| *std), "size")?,
    })
}
