//! Fits of what a camera sees of a press: 77 markers, of a sensor that is known only roughly.

use std::hint::black_box;

use anyhow::{Context, Result, bail};
use nalgebra::Matrix4;
use palpate_chromatouch::Departure;
use palpate_estimators::ImageModel;
use palpate_press::{Body, ImageFit, MarkerDisplacement, Rest, Seen, SensorState, View};
use palpate_sensing::{Channel, Stream};

use super::camera::optics;
use super::presses::{AT, INDENTATION, OBJECT, SKIN, markers};
use crate::measured::Evaluation;

/// Depths of the magenta and the yellow discs under the skin, mm.
const DEPTHS: [f64; 2] = [3.0, 1.0];
/// Depth by which discs lie deeper where slopes are found, mm.
const DEEPER: f64 = 1e-3 * SKIN;
/// Standard deviations of the numbers of a [`Departure`]: depths, diameters, image's centre, pixels per radian, place and
/// turn of the camera, and colours, but not of the odd terms of its lens.
const ROUGHLY: [f64; Departure::NUMBERS] = [
    0.03, 0.03, 0.01, 0.01, 0.3, 0.3, 0.002, 0.05, 0.05, 0.05, 0.005, 0.005, 0.005, 0.01, 0.01,
    0.01, 0.01, 0.01, 0.01, 0.0, 0.0,
];
/// Standard deviation of either component of a misalignment, rad: discs of 2 mm, misaligned by up to 0.3 of that.
const MISALIGNED: f64 = 0.5 * 0.3 * 2.0 / 19.0;
/// Standard deviations of what the tracker reads: centroid, px; hue, turns; logarithm of the size.
const STDS: [f64; 4] = [0.008, 0.008, 3e-4, 1.5e-3];

/// Bodies at each of some depths, as they are made for a fit.
pub type Bodies = fn(&[f64]) -> Result<Vec<Body>>;

/// An incompressible half-space at some depths.
///
/// # Errors
/// A depth that is out of range.
pub fn half_spaces(depths: &[f64]) -> Result<Vec<Body>> {
    let bodies = depths
        .iter()
        .map(|depth| Ok(Body::half_space(0.5, *depth)?));
    bodies.collect()
}

/// A layer of 5 mm at some depths.
///
/// # Errors
/// A depth that is out of range.
pub fn layers(depths: &[f64]) -> Result<Vec<Body>> {
    Ok(Body::bonded_layers(5.0, depths)?)
}

/// A press before a camera.
pub struct Seeing {
    fit: ImageFit<ImageModel>,
    at_rest: Vec<Option<Seen>>,
    pressed: Vec<Option<Seen>>,
}

/// Task with the pictures.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// The sensor is told by its frame at rest.
    Rest,
    /// The press is fitted, by bodies that were just made.
    Cold,
    /// The press is fitted.
    Fit,
    /// The fit's doubts are sought.
    Doubts,
}

impl Seeing {
    /// The press, of bodies that are made for these depths.
    ///
    /// # Errors
    /// If the body cannot be pressed so.
    pub fn new(bodies: Bodies) -> Result<Self> {
        let (meant, deeper) = pairs(bodies)?;
        let optics = optics(640)?;
        let misalignments = optics.array().misalignments();
        let fit = ImageFit {
            view: ImageModel {
                optics: optics.misaligned(&[[0.0; 2]; 77])?,
            },
            markers: markers()?,
            bodies: meant,
            deeper: Some((DEEPER, deeper)),
            common_stds: ROUGHLY.to_vec(),
            told: None,
            misalignment_std: MISALIGNED,
            shift_std: 0.0,
        };
        let mut noise = Stream::new(1, 1, Channel::Position);
        let common = ROUGHLY.map(|std| std * noise.standard_normal());
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
                    picture[number] + STDS[number] * noise.standard_normal()
                }),
                covariance: Matrix4::from_diagonal(&STDS.map(|std| std * std).into()),
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

    /// The fit with bodies that no fit has used.
    fn anew(&self, bodies: Bodies) -> Result<ImageFit<ImageModel>> {
        let (meant, deeper) = pairs(bodies)?;
        Ok(ImageFit {
            bodies: meant,
            deeper: Some((DEEPER, deeper)),
            ..self.fit.clone()
        })
    }
}

/// Bodies at the depths of the discs, and where these lie deeper.
fn pairs(bodies: Bodies) -> Result<([Body; 2], [Body; 2])> {
    let [magenta, yellow] = DEPTHS;
    let bodies = bodies(&[magenta, yellow, magenta + DEEPER, yellow + DEEPER])?;
    match <[Body; 4]>::try_from(bodies) {
        Ok([one, other, deep_one, deep_other]) => Ok(([one, other], [deep_one, deep_other])),
        Err(bodies) => bail!("{} bodies instead of 4", bodies.len()),
    }
}

/// Work on the pictures of 77 markers under a press, the indentation unknown.
///
/// # Errors
/// If the body cannot be pressed so.
pub fn worked(name: &str, bodies: Bodies, step: Step) -> Result<Evaluation> {
    let seeing = Seeing::new(bodies)?;
    let rest = seeing.rest()?;
    let estimate = seeing.fit.estimate(&rest, &seeing.pressed, None)?;
    Ok(match step {
        Step::Rest => Evaluation::new(name, move || seeing.fit.at_rest(black_box(&seeing.at_rest))),
        Step::Cold => Evaluation::new(name, move || {
            let fit = seeing.anew(bodies)?;
            Ok::<_, anyhow::Error>(fit.estimate(&rest, &seeing.pressed, None)?)
        }),
        Step::Fit => Evaluation::new(name, move || {
            seeing.fit.estimate(&rest, black_box(&seeing.pressed), None)
        }),
        Step::Doubts => Evaluation::new(name, move || {
            let pressed = black_box(&seeing.pressed);
            seeing.fit.doubts(&rest, pressed, None, &estimate)
        }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law of pictures whose slopes are told by differences.
    #[derive(Clone)]
    struct Differences(ImageModel);

    impl View for Differences {
        fn pictures(
            &self,
            sensor: &SensorState<'_>,
            moved: &[[MarkerDisplacement; 2]],
        ) -> Option<Vec<Option<[f64; 4]>>> {
            self.0.pictures(sensor, moved)
        }
    }

    #[test]
    fn slopes_in_closed_form_fit_as_differences_do() {
        for bodies in [half_spaces as Bodies, layers] {
            let seeing = Seeing::new(bodies).unwrap();
            let rest = seeing.rest().unwrap();
            let own = seeing.fit.estimate(&rest, &seeing.pressed, None).unwrap();
            let fit = seeing.fit;
            let fit = ImageFit {
                view: Differences(fit.view),
                markers: fit.markers,
                bodies: fit.bodies,
                deeper: fit.deeper,
                common_stds: fit.common_stds,
                told: fit.told,
                misalignment_std: fit.misalignment_std,
                shift_std: fit.shift_std,
            };
            let rest = fit.at_rest(&seeing.at_rest).unwrap();
            let other = fit.estimate(&rest, &seeing.pressed, None).unwrap();
            let [own, other] = [own, other].map(|one| one.relative_curvature);
            let off = (own.value - other.value).abs() / own.std;
            let of_std = (own.std / other.std - 1.0).abs();
            assert!(off < 1e-3 && of_std < 1e-4, "{off} {of_std}");
        }
    }
}
