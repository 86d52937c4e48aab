//! Workloads of image fits. An image fit estimates a press from the images of 77 markers, while some parameters of the
//! sensor are uncertain.

use std::hint::black_box;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use nalgebra::Matrix4;
use palpate_chromatouch::Departure;
use palpate_estimators::ImageModel;
use palpate_press::{Body, ImageFit, MarkerDisplacement, Rest, Seen, SensorState};
use palpate_sensing::{Channel, Stream};

use super::camera_frames::optics;
use super::marker_presses::{AT, INDENTATION, OBJECT, SKIN, markers};
use crate::timing::Evaluation;

/// Depths (mm) of the magenta and the yellow discs under the skin.
const DEPTHS: [f64; 2] = [3.0, 1.0];
/// Step (mm) of a disc's depth for finite differences with respect to this depth.
const DEPTH_STEP: f64 = 1e-3 * SKIN;
/// Standard deviations of the parameters of a [`Departure`], which describes how a real sensor differs from its config.
/// The parameters are the depths and diameters of the discs, the image centre, the focal length, the position and
/// rotation of the camera, and colours. The coefficients k3 and k5 of the lens have standard deviations of 0, because
/// they do not differ from the config.
const DEPARTURE_STDS: [f64; Departure::NUMBERS] = [
    0.03, 0.03, 0.01, 0.01, 0.3, 0.3, 0.002, 0.05, 0.05, 0.05, 0.005, 0.005, 0.005, 0.01, 0.01,
    0.01, 0.01, 0.01, 0.01, 0.0, 0.0,
];
/// Standard deviation (rad) of each of the two misalignment angles of a disc. The largest misalignment is 0.3 of the
/// disc's diameter of 2 mm. Half of it is divided by 19 mm, the distance of a yellow disc from the skin's centre.
const MISALIGNMENT_STD: f64 = 0.5 * 0.3 * 2.0 / 19.0;
/// Standard deviations of the tracker's readings: the two coordinates of the centroid (px), the hue (turns), and the
/// logarithm of the size.
const READING_STDS: [f64; 4] = [0.008, 0.008, 3e-4, 1.5e-3];

/// Function that returns one soft body for each depth of markers.
pub type Bodies = fn(&[f64]) -> Result<Vec<Body>>;

/// Incompressible half-spaces, one for each depth of markers.
///
/// # Errors
/// An error if a depth is out of range.
pub fn half_spaces(depths: &[f64]) -> Result<Vec<Body>> {
    let bodies = depths
        .iter()
        .map(|depth| Ok(Body::half_space(0.5, *depth)?));
    bodies.collect()
}

/// Bonded layers with a thickness of 5 mm, one for each depth of markers.
///
/// # Errors
/// An error if a depth is out of range.
pub fn layers(depths: &[f64]) -> Result<Vec<Body>> {
    Ok(Body::bonded_layers(5.0, depths)?)
}

/// A press that a camera observes.
pub struct CameraPress {
    fit: ImageFit,
    at_rest: Vec<Option<Seen>>,
    pressed: Vec<Option<Seen>>,
}

/// A step of an image fit.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// Correct the sensor's parameters, with a frame that was recorded without a press.
    Rest,
    /// Fit the press to the images of the markers.
    Fit,
    /// Test whether the readings contradict the fit.
    Misfits,
}

impl CameraPress {
    /// A press of an object onto the soft bodies that `bodies` returns.
    ///
    /// # Errors
    /// An error if the press is impossible.
    pub fn new(bodies: Bodies) -> Result<Self> {
        let (nominal, deeper) = pairs(bodies)?;
        let optics = optics(640)?;
        let misalignments = optics.array().misalignments();
        let fit = ImageFit {
            view: Arc::new(ImageModel {
                optics: optics.misaligned(&[[0.0; 2]; 77])?,
            }),
            markers: markers()?,
            bodies: nominal,
            deeper: Some((DEPTH_STEP, deeper)),
            common_stds: DEPARTURE_STDS.to_vec(),
            departure_prior: None,
            misalignment_std: MISALIGNMENT_STD,
            shift_std: 0.0,
        };
        let mut noise = Stream::new(1, 1, Channel::Position);
        let common = DEPARTURE_STDS.map(|std| std * noise.standard_normal());
        let contact = |disc: usize| -> Result<Vec<MarkerDisplacement>> {
            let bodies = bodies(&[DEPTHS[disc] + common[disc]])?;
            let contact = fit.markers.skin();
            let contact = contact.contact(&bodies[0], OBJECT, INDENTATION)?;
            Ok(fit.markers.displacements(&contact, AT))
        };
        let moved = contact(0)?.into_iter().zip(contact(1)?).map(Into::into);
        let state = SensorState {
            common: &common,
            misalignments: &misalignments,
        };
        let mut seen = |moved: &[[MarkerDisplacement; 2]]| -> Result<Vec<Option<Seen>>> {
            let pictures = fit.view.pictures(&state, moved).context("no such sensor")?;
            let mut read = |picture: [f64; 4]| Seen {
                picture: std::array::from_fn(|number| {
                    picture[number] + READING_STDS[number] * noise.standard_normal()
                }),
                covariance: Matrix4::from_diagonal(&READING_STDS.map(|std| std * std).into()),
            };
            Ok(pictures
                .into_iter()
                .map(|picture| picture.map(&mut read))
                .collect())
        };
        let at_rest = seen(&[[MarkerDisplacement::default(); 2]; 77])?;
        let pressed = seen(&moved.collect::<Vec<_>>())?;
        Ok(Self {
            fit,
            at_rest,
            pressed,
        })
    }

    fn rest(&self) -> Result<Rest> {
        Ok(self.fit.at_rest(&self.at_rest)?)
    }
}

/// Two pairs of soft bodies. The first pair is at the depths of a marker's two discs, the second pair is deeper by
/// [`DEPTH_STEP`].
fn pairs(bodies: Bodies) -> Result<([Body; 2], [Body; 2])> {
    let [magenta, yellow] = DEPTHS;
    let bodies = bodies(&[magenta, yellow, magenta + DEPTH_STEP, yellow + DEPTH_STEP])?;
    match <[Body; 4]>::try_from(bodies) {
        Ok([one, other, deep_one, deep_other]) => Ok(([one, other], [deep_one, deep_other])),
        Err(bodies) => bail!("{} bodies instead of 4", bodies.len()),
    }
}

/// The workload of one step of the image fit of a press whose indentation is unknown.
///
/// # Errors
/// An error if the press is impossible.
pub fn workload(name: &str, bodies: Bodies, step: Step) -> Result<Evaluation> {
    let press = CameraPress::new(bodies)?;
    let rest = press.rest()?;
    let estimate = press.fit.estimate(&rest, &press.pressed, None)?;
    Ok(match step {
        Step::Rest => Evaluation::new(name, move || press.fit.at_rest(black_box(&press.at_rest))),
        Step::Fit => Evaluation::new(name, move || {
            press.fit.estimate(&rest, black_box(&press.pressed), None)
        }),
        Step::Misfits => Evaluation::new(name, move || {
            let pressed = black_box(&press.pressed);
            press.fit.misfits(&rest, pressed, None, &estimate)
        }),
    })
}
