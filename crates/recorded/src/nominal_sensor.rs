//! The nominal sensor: the sensor that a study states. Frames at rest are compared with it.

use std::sync::Arc;

use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, Lens, MarkerMotion, OddTerms, Optics, Pose,
};
use palpate_press::{Body, ImageFit, Markers, Seen};
use palpate_statistics::Number;
use palpate_study::config::{CameraConfig, PressConfig, ReadingNoise, SensorNoise};
use palpate_tracking::{Finder, Found};

use super::layout_matching::nearest;
use palpate_estimators::{ImageModel, MarkerSphere, departure_stds, marker_image, optics_error};
use palpate_study::FieldError;

/// Prior standard deviations of camera parameters: image centre (px), pixels per radian (relative), position (as a
/// share of the sensor's radius) and rotation (degrees).
const CAMERA_STDS: [f64; 4] = [0.5, 0.1, 0.1, 5.0];
/// Prior standard deviations of the odd terms of a lens, k3 and k5. The terms of all usual fisheye projections, from
/// orthographic to stereographic, differ from 0 by at most two of these standard deviations.
pub(super) const TERM_STDS: [f64; 2] = [0.1, 0.05];
/// Indices of the odd terms k3 and k5 of the lens in a [`Departure`], the list of all sensor parameters' differences
/// from their nominal values.
pub(super) const TERMS: [usize; 2] = [19, 20];
/// Prior standard deviations of disc parameters, used if the study states none: depth (as a share of the sensor's
/// radius), diameter (relative) and colours (relative).
const DISC_STDS: [f64; 3] = [0.002, 0.02, 0.03];
/// Number of simulated frames from which the effect of uneven light and blur on markers' images is computed. The
/// average over several frames reduces the influence of pixel noise.
const BLEMISHED_FRAMES: u64 = 4;

#[derive(Clone)]
pub(super) struct NominalSensor<'a> {
    pub(super) sphere: MarkerSphere<'a>,
    pub(super) camera: &'a CameraConfig,
    pub(super) places: Vec<[f64; 2]>,
    pub(super) markers: Markers,
    pub(super) stds: [f64; Departure::NUMBERS],
    misalignment_std: f64,
    pixel_std: f64,
    /// Change of each marker's image at rest that is due to uneven light and blur: changes of both centroid coordinates
    /// (px), of the hue (turns), and of the logarithm of the size. Empty if the sensor has neither uneven light nor
    /// blur.
    blemished: Vec<[f64; 4]>,
}

/// Geometry of a camera: its pose, the centre and scale of its image, and the coefficients k3 and k5 (odd terms) of its
/// lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CameraGeometry {
    pub(super) centre_px: [f64; 2],
    pub(super) px_per_rad: f64,
    pub(super) place: [f64; 3],
    /// Rotation of the camera (degrees) about three axes: the x and y axes of the skin at the apex, and the direction
    /// toward the apex.
    pub(super) turn_deg: [f64; 3],
    pub(super) odd_terms: OddTerms,
}

impl<'a> NominalSensor<'a> {
    /// The nominal sensor of a press. It does not contain the effect of uneven light and blur on the images.
    ///
    /// # Errors
    /// [`FieldError`] if the sensor has no camera or no discs.
    pub(super) fn of(press: &'a PressConfig) -> Result<Self, FieldError> {
        let none = || FieldError::at("scene.sensor", "must have a camera");
        let (camera, _) = press.sensor.camera().ok_or_else(none)?;
        let sphere = MarkerSphere::from(&press.probe);
        let (markers, places) = sphere.markers()?;
        let [centre_px, scale, place, turn_deg] = CAMERA_STDS;
        let [disc_depth, disc_diameter, colour] = DISC_STDS;
        let mut prior = press.noise.sensor.clone().unwrap_or(SensorNoise {
            disc_depth: disc_depth * sphere.radius,
            disc_diameter,
            colour,
            ..SensorNoise::default()
        });
        prior = SensorNoise {
            centre_px,
            scale,
            place: place * sphere.radius,
            turn_deg,
            ..prior
        };
        let misalignment_std = sphere.misalignment_std()?;
        Ok(Self {
            stds: departure_stds(&prior),
            sphere,
            camera,
            places,
            markers,
            misalignment_std,
            pixel_std: press
                .noise
                .pixel
                .map_or(0.0, |ReadingNoise::Gaussian { std }| std.0),
            blemished: Vec::new(),
        })
    }

    /// This sensor, with the effect of uneven light and blur on the images of its markers at rest. The effect is
    /// computed from simulated frames.
    ///
    /// # Errors
    /// [`FieldError`] if light or blur hide the markers.
    pub(super) fn through_blemishes(self) -> Result<Self, FieldError> {
        let CameraConfig {
            light_at_rim,
            blur_px,
            ..
        } = *self.camera;
        let clear = Blemishes {
            pixel_std: self.pixel_std,
            ..Blemishes::default()
        };
        let blemishes = Blemishes {
            light_at_rim,
            blur_px,
            ..clear
        };
        if clear == blemishes {
            return Ok(self);
        }
        let [clear, blemished] = [clear, blemishes].map(|blemishes| self.pictures(blemishes));
        let (clear, blemished) = (clear?, blemished?);
        let frames = clear.iter().zip(&blemished);
        let mut changes = vec![[0.0; 4]; self.places.len()];
        for (clear, blemished) in frames {
            for ((change, clear), blemished) in changes.iter_mut().zip(clear).zip(blemished) {
                let (Some(clear), Some(blemished)) = (clear, blemished) else {
                    continue;
                };
                let mut off: [f64; 4] =
                    std::array::from_fn(|number| blemished[number] - clear[number]);
                // Hues are in turns, so their difference is reduced to at most half a turn.
                off[2] -= (off[2] + 0.5).floor();
                for (change, off) in change.iter_mut().zip(off) {
                    *change += off / BLEMISHED_FRAMES as f64;
                }
            }
        }
        Ok(Self {
            blemished: changes,
            ..self
        })
    }

    /// Images of the markers at rest in several simulated frames with the imperfections `blemishes` (uneven light and
    /// blur); `None` for a marker that is not found. Frames with different imperfections have the same pixel noise, so
    /// that the noise does not affect their difference.
    fn pictures(&self, blemishes: Blemishes) -> Result<Vec<Vec<Option<[f64; 4]>>>, FieldError> {
        let optics = self.optics_with(&self.geometry()?, blemishes)?;
        let still = vec![Some(MarkerMotion::default()); self.places.len()];
        let projected = optics
            .project(&still)
            .map_err(|error| optics_error(&error))?;
        let expected: Vec<Option<[f64; 2]>> = projected
            .iter()
            .map(|marker| Some(marker.as_ref()?.centroid_px))
            .collect();
        let mut finder = Finder::default();
        let mut pictures = |number: u64| {
            let frame = optics.render(&still, Some((0, number)));
            let frame = frame.map_err(|error| optics_error(&error))?;
            let found = finder.find(&frame).map_err(|_| {
                let [light, blur] = [blemishes.light_at_rim, blemishes.blur_px].map(Number);
                let message = format!(
                    "the study's camera shows no markers by `light_at_rim` {light}, `blur_px` {blur} and its noise of pixels"
                );
                FieldError::at("scene.sensor", message)
            })?;
            let image = |marker: usize| marker_image(&found.markers[marker], &found.errors[marker]);
            let nearest = nearest(&expected, &found).into_iter();
            Ok(nearest.map(|marker| Some(image(marker?).picture)).collect())
        };
        (0..BLEMISHED_FRAMES).map(&mut pictures).collect()
    }

    pub(super) fn is_blemished(&self) -> bool {
        !self.blemished.is_empty()
    }

    pub(super) fn clear(&self, marker: usize, image: Seen) -> Seen {
        let change = self.blemished.get(marker).copied().unwrap_or_default();
        Seen {
            picture: std::array::from_fn(|number| image.picture[number] - change[number]),
            ..image
        }
    }

    /// This sensor, with the first `free` of its lens coefficients (k3, k5) as parameters of the fit.
    pub(super) fn with_terms(&self, free: usize) -> Self {
        let mut other = self.clone();
        for (number, std) in TERMS.into_iter().zip(TERM_STDS).take(free) {
            other.stds[number] = std;
        }
        other
    }

    /// Whether neither of the lens coefficients k3 and k5 is a parameter of the fit.
    pub(super) fn has_exact_lens(&self) -> bool {
        TERMS.iter().all(|&number| self.stds[number] == 0.0)
    }

    /// Optics with nominal parameters, except for the image centre, which is measured in the frame.
    pub(super) fn optics(&self, found: &Found) -> Result<Optics, FieldError> {
        self.optics_of(&CameraGeometry {
            centre_px: found.mask.centre_px,
            ..self.geometry()?
        })
    }

    fn lens(&self, odd_terms: OddTerms) -> Result<Camera, FieldError> {
        let CameraConfig {
            size_px, field_deg, ..
        } = *self.camera;
        let lens = Lens::from(odd_terms);
        Camera::new(lens, size_px, field_deg).map_err(|error| optics_error(&error))
    }

    pub(super) fn geometry(&self) -> Result<CameraGeometry, FieldError> {
        let CameraConfig { k3, k5, .. } = *self.camera;
        let odd_terms = OddTerms { k3, k5 };
        let lens = self.lens(odd_terms)?;
        Ok(CameraGeometry {
            centre_px: lens.centre_px(),
            px_per_rad: lens.px_per_rad(),
            place: self.camera.place,
            turn_deg: self.camera.turn_deg,
            odd_terms,
        })
    }

    pub(super) fn optics_of(&self, geometry: &CameraGeometry) -> Result<Optics, FieldError> {
        self.optics_with(geometry, Blemishes::default())
    }

    fn optics_with(
        &self,
        geometry: &CameraGeometry,
        blemishes: Blemishes,
    ) -> Result<Optics, FieldError> {
        let lens = self.lens(geometry.odd_terms)?;
        let middle = lens.centre_px();
        let offset = [0, 1].map(|axis| geometry.centre_px[axis] - middle[axis]);
        let array = self.sphere.array(&self.places, None)?;
        let pose = Pose::new(geometry.place, geometry.turn_deg.map(f64::to_radians));
        lens.adjusted(offset, geometry.px_per_rad)
            .and_then(|lens| Optics::new(array, lens, Colours::default(), blemishes))
            .and_then(|optics| optics.seen_from(pose))
            .map_err(|error| optics_error(&error))
    }

    pub(super) fn fit(&self, optics: &Optics) -> Result<ImageFit, String> {
        let body = || Body::half_space(0.5, self.sphere.marker_depth);
        let body = || body().map_err(|error| error.to_string());
        Ok(ImageFit {
            view: Arc::new(ImageModel {
                optics: optics.clone(),
            }),
            markers: self.markers.clone(),
            // This fit only computes images at rest, which do not depend on the soft body. So any body can be used for
            // both discs.
            bodies: [body()?, body()?],
            deeper: None,
            departure_prior: None,
            common_stds: self.stds.to_vec(),
            misalignment_std: self.misalignment_std,
            shift_std: 0.0,
        })
    }
}
