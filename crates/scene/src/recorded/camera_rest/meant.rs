//! The sensor that a study states, as a frame at rest is held against it.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, Departure, Lens, OddTerms, Optics, OpticsError, Pose,
};
use palpate_press::{Body, ImageFit, Markers, Skin};
use palpate_study::config::{CameraConfig, PressConfig, SensorNoise};
use palpate_tracking::Found;

use crate::marker_sphere::{MarkerSphere, of_optics};
use crate::plan::PlanError;
use crate::press::{PictureLaw, sensor_stds};

/// Standard deviations to which a camera is known beforehand: of the image's centre, px; of pixels per radian, a share; of
/// its place, a share of the sensor's radius; of its turn, degrees.
const BEFORE: [f64; 4] = [0.5, 0.1, 0.1, 5.0];
/// Standard deviations to which the odd terms of a lens are known beforehand, k3 and k5: the projections that fisheyes are made
/// to, from orthographic to stereographic, lie within two.
pub(super) const TERMS_BEFORE: [f64; 2] = [0.1, 0.05];
/// Numbers of a departure that are the odd terms.
pub(super) const TERMS: [usize; 2] = [19, 20];
/// Standard deviations to which discs are known where the study does not say it: depth, a share of the sensor's radius; diameter and colours,
/// shares.
const OF_DISCS: [f64; 3] = [0.002, 0.02, 0.03];
/// The sensor as it is meant to be.
#[derive(Clone)]
pub(super) struct Meant<'a> {
    sphere: MarkerSphere<'a>,
    camera: &'a CameraConfig,
    places: Vec<[f64; 2]>,
    markers: Markers,
    pub(super) stds: [f64; Departure::NUMBERS],
    misalignment_std: f64,
}

impl<'a> Meant<'a> {
    pub(super) fn of(press: &'a PressConfig, camera: &'a CameraConfig) -> Result<Self, PlanError> {
        let sphere = MarkerSphere::of(&press.probe);
        let places = sphere.places()?;
        let skin = Skin::new(sphere.radius);
        let markers = skin.and_then(|skin| Markers::new(skin, &places));
        let markers = markers.map_err(|error| PlanError::at("scene.probe", error))?;
        let [centre_px, scale, place, turn_deg] = BEFORE;
        let [disc_depth, disc_diameter, colour] = OF_DISCS;
        let stated = press.noise.sensor.clone();
        let known = SensorNoise {
            centre_px,
            scale,
            place: place * sphere.radius,
            turn_deg,
            disc_depth: disc_depth * sphere.radius,
            disc_diameter,
            colour,
        };
        let known = stated.map_or(known.clone(), |stated| SensorNoise {
            disc_depth: stated.disc_depth,
            disc_diameter: stated.disc_diameter,
            colour: stated.colour,
            ..known
        });
        let yellow = sphere.disc_depths()?.yellow;
        let misalignment_std =
            0.5 * sphere.misalignment() * sphere.diameters()?.yellow / (sphere.radius - yellow);
        Ok(Self {
            stds: sensor_stds(&known),
            sphere,
            camera,
            places,
            markers,
            misalignment_std,
        })
    }

    /// This sensor with the first so many odd terms of its lens unknown.
    pub(super) fn with_terms(&self, unknown: usize) -> Self {
        let mut other = self.clone();
        for (number, std) in TERMS.into_iter().zip(TERMS_BEFORE).take(unknown) {
            other.stds[number] = std;
        }
        other
    }

    /// Whether the odd terms of the lens are known.
    pub(super) fn knows_lens(&self) -> bool {
        TERMS.iter().all(|&number| self.stds[number] == 0.0)
    }

    /// Optics with the middle of the image where the frame has it.
    pub(super) fn optics(&self, found: &Found) -> Result<Optics, PlanError> {
        let CameraConfig {
            size_px,
            field_deg,
            k3,
            k5,
            place,
            turn_deg,
            ..
        } = *self.camera;
        let middle = 0.5 * (f64::from(size_px) - 1.0);
        let offset = found.mask.centre_px.map(|centre| centre - middle);
        let made = || -> Result<Optics, OpticsError> {
            let camera = Camera::new(Lens::fisheye(OddTerms { k3, k5 }), size_px, field_deg)?;
            let camera = camera.adjusted(offset, camera.px_per_rad())?;
            let array = self
                .sphere
                .array(&self.places)
                .map_err(|_| OpticsError::WrongCount {
                    motions: 0,
                    markers: self.places.len(),
                })?;
            let optics = Optics::new(array, camera, Colours::default(), Blemishes::default())?;
            optics.seen_from(Pose::new(place, turn_deg.map(f64::to_radians)))
        };
        self.sphere.array(&self.places)?;
        made().map_err(|error| of_optics(&error))
    }

    pub(super) fn fit(&self, optics: &Optics) -> Result<ImageFit<PictureLaw>, String> {
        let body = || Body::half_space(0.5, self.sphere.marker_depth);
        let body = || body().map_err(|error| error.to_string());
        Ok(ImageFit {
            view: PictureLaw {
                optics: optics.clone(),
            },
            markers: self.markers.clone(),
            // Nothing is pressed.
            bodies: [body()?, body()?],
            deeper: None,
            common_stds: self.stds.to_vec(),
            misalignment_std: self.misalignment_std,
            shift_std: 0.0,
        })
    }
}
