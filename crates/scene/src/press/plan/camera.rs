//! Builds a press with a camera: its optics, markers at rest, calibration and readings.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, Lens, MarkerMotion, OddTerms, Optics, Pose,
};
use palpate_press::PressError;
use palpate_sensing::GaussianError;
use palpate_study::config::{
    CameraConfig, CentroidNoise, HueNoise, PixelNoise, PressModelConfig, PressNoiseConfig,
    SizeNoise,
};
use palpate_tracking::Equidistant;

use super::super::camera::{CameraModel, CameraSensor, Eye, SightError};
use super::super::departed::Redrawn;
use super::super::looks::RestLook;
use super::super::parts::Parts;
use super::super::pressed::Pressed;
use super::super::readings::{count_of, gaussian};
use super::super::seen::{CameraPress, Shows};
use super::calibrated::{CalibratedCamera, CalibrationPresses, planes};
use super::discs::DiscMarkers;
use palpate_estimators::{MarkerSphere, optics_error};
use palpate_study::FieldError;

/// A camera, and the markers with discs that it images.
pub(super) struct CameraPlan<'a> {
    pub(super) sphere: &'a MarkerSphere<'a>,
    pub(super) camera: &'a CameraConfig,
    /// Whether frames are rendered.
    pub(super) is_rendered: bool,
    pub(super) noise: &'a PressNoiseConfig,
    /// Model of the body, never `auto`.
    pub(super) model: &'a PressModelConfig,
    pub(super) seed: u64,
    pub(super) places: &'a [[f64; 2]],
    pub(super) discs: DiscMarkers<'a>,
    pub(super) parts: &'a Parts,
}

impl CameraPlan<'_> {
    /// Builds the press with a camera. The outer error is for the config, the inner one for an impossible press.
    pub(super) fn press(
        &self,
        pressed: &Pressed,
    ) -> Result<Result<CameraPress, PressError>, FieldError> {
        let eye = self.eye()?;
        let motions = match self.discs.motions(pressed) {
            Ok(motions) => motions,
            Err(error) => return Ok(Err(error)),
        };
        let lost = self.noise.lost_markers.as_ref().map(|lost| lost.count);
        let lost_markers = count_of(lost, "lost_markers", self.places.len())?;
        let look = RestLook::new(&eye, self.camera.calibration.rest_frames);
        let rest = self
            .parts
            .at_rest(&look)
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        let seen = rest.iter().flatten().count();
        if seen == 0 {
            let message = "the camera sees no marker: see `scene.sensor.field_deg`";
            return Err(FieldError::at("scene.sensor", message));
        }
        let presses = CalibrationPresses {
            camera: self.camera,
            discs: &self.discs,
            parts: self.parts,
            look: &look,
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
            redrawn: self.redrawn(pressed)?,
            motions,
            lost_markers,
            under_contact,
        }))
    }

    fn redrawn(&self, pressed: &Pressed) -> Result<Option<Redrawn>, FieldError> {
        let Some(noise) = &self.noise.sensor else {
            return Ok(None);
        };
        let DiscDepths { magenta, yellow } = self.sphere.disc_depths()?;
        let calibration = &self.camera.calibration;
        let made = (
            calibration.rest_frames,
            planes(calibration, pressed.indentation),
            self.sphere.misalignment(),
        );
        Redrawn::new(
            noise,
            self.model,
            self.sphere.radius,
            self.discs.markers,
            [magenta, yellow],
            pressed,
            made,
        )
        .map(Some)
    }

    fn eye(&self) -> Result<Eye, FieldError> {
        let CameraConfig {
            size_px,
            field_deg,
            k3,
            k5,
            frames,
            light_at_rim,
            blur_px,
            seam_width,
            ..
        } = *self.camera;
        let pixel = self.noise.pixel.as_ref();
        let pixel = gaussian(pixel.map(|PixelNoise::Gaussian { std }| *std), "pixel")?;
        let lens = Lens::fisheye(OddTerms { k3, k5 });
        let camera = Camera::new(lens, size_px, field_deg).map_err(|error| optics_error(&error))?;
        let blemishes = Blemishes {
            light_at_rim,
            blur_px,
            seams: self.sphere.seams(seam_width),
            pixel_std: pixel.averaged(frames).std(),
        };
        let array = self.sphere.made(self.places, self.seed)?;
        let pose = Pose::new(self.camera.place, self.camera.turn_deg.map(f64::to_radians));
        let optics = Optics::new(array, camera, Colours::default(), blemishes)
            .and_then(|optics| optics.seen_from(pose))
            .map_err(|error| optics_error(&error))?;
        let (model, is_random) = if self.is_rendered {
            (CameraModel::Rendered, pixel.is_random())
        } else {
            let error = sight_error(self.noise)?.averaged(frames);
            (CameraModel::Projected(error), error.is_random())
        };
        let lens = Equidistant::new(camera.centre_px(), camera.px_per_rad())
            .and_then(|lens| lens.with_odd_terms([k3, k5]))
            .map_err(|error| FieldError::at("scene.sensor", error))?;
        Ok(Eye {
            optics,
            lens,
            model,
            is_random,
            seed: self.seed,
        })
    }
}

/// Change of a marker's picture in the press, without noise and pixels.
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
    let spotted = exact.at_rest(None).ok()?;
    let rest: Vec<_> = spotted.iter().map(|one| Some((*one)?.marker)).collect();
    let motions: Vec<_> = motions.iter().copied().map(Some).collect();
    let sight = exact.sight(&rest, &motions, None).ok()?;
    Shows::of(&exact, &sight, marker)
}

fn sight_error(noise: &PressNoiseConfig) -> Result<SightError, FieldError> {
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
