//! A press: a soft spherical sensor touches an object once, and the object's curvature is estimated from how the markers
//! under its skin move.

mod noise;
mod plan;
mod profile;
mod trace;
mod words;

pub use profile::ProfileTable;
pub use trace::PressTrace;
pub(crate) use words::large_contact;

use palpate_press::{
    Body, Bounds, Contact, Estimated, ForwardFit, MarkerDisplacement, Markers, Measured,
    PressError, PressEstimate, Reading, Skin,
};

use crate::{Outcome, PlanError, Quantity, Unit};
use noise::ReadingNoise;

/// What a press estimates. The last only of objects that have a radius.
pub const QUANTITIES: [Quantity; 7] = [
    Quantity {
        name: "relative_curvature",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "effective_radius",
        unit: Unit::Length,
    },
    Quantity {
        name: "object_curvature",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "indentation",
        unit: Unit::Length,
    },
    Quantity {
        name: "contact_radius",
        unit: Unit::Length,
    },
    Quantity {
        name: "r_squared",
        unit: Unit::One,
    },
    Quantity {
        name: "object_radius",
        unit: Unit::Length,
    },
];

/// A press that is ready to run: the truth, the sensor, the noise and the method of a cell.
#[derive(Clone, Debug)]
pub struct PressScene {
    seed: u64,
    /// Chart coordinates of the markers.
    places: Vec<[f64; 2]>,
    markers: Markers,
    body: Body,
    object: PressedObject,
    indentation: f64,
    /// Chart coordinates of the contact.
    at: [f64; 2],
    /// What the press does, or why there is none: then every trial fails.
    truth: Result<TruePress, PressError>,
    sensor: PressSensor,
    noise: ReadingNoise,
    method: PressMethod,
    bounds: Option<Bounds>,
    /// What the scene is made of, in words.
    needs: Vec<String>,
}

/// The object, as far as a press feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PressedObject {
    /// 1/R_o, positive where convex.
    curvature: f64,
    /// R_o, negative for a dish; `None` for a plane.
    radius: Option<f64>,
}

/// What a press does.
#[derive(Clone, Debug, PartialEq)]
struct TruePress {
    contact_radius: f64,
    markers: Vec<MarkerDisplacement>,
}

/// What of a press is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PressSensor {
    /// Whether displacements along the skin are.
    tangential: bool,
    /// How many readings are averaged.
    frames: u32,
}

/// How curvature follows from the readings.
#[derive(Clone, Debug)]
struct PressMethod {
    /// The fit, or why there is none: then every trial fails.
    fit: Result<ForwardFit, PressError>,
    /// Standard deviation ascribed to the given indentation; `None` where none is given.
    known_indentation: Option<f64>,
}

/// What is read of a press.
#[derive(Clone, Debug, PartialEq)]
struct PressReadings {
    normal: Vec<f64>,
    tangential: Vec<[f64; 2]>,
}

impl PressScene {
    /// What is estimated.
    pub fn quantities(&self) -> &'static [Quantity] {
        match self.object.radius {
            Some(_) => &QUANTITIES,
            None => &QUANTITIES[..6],
        }
    }

    /// Whether trials differ.
    pub fn is_random(&self) -> bool {
        let knows = self.method.known_indentation.is_some();
        self.noise.is_random(self.sensor.tangential, knows)
    }

    /// Whether the readings have enough markers, and the method settings that can be, to tell a press. Where there is no
    /// press, or none to be seen, the scene can still be run: its trials fail.
    ///
    /// # Errors
    /// [`PlanError`] at what keeps them from it.
    pub fn estimable(&self) -> Result<(), PlanError> {
        match self.estimate(None) {
            Err(error @ PressError::TooFewMarkers { .. }) => {
                Err(PlanError::at("scene.probe.layout", error))
            }
            Err(error @ PressError::BadSetting { setting, .. }) => {
                Err(PlanError::at(format!("scene.estimator.{setting}"), error))
            }
            Ok(_) | Err(_) => Ok(()),
        }
    }

    fn skin(&self) -> &Skin {
        self.markers.skin()
    }

    /// The true contact.
    fn contact(&self) -> Result<Contact<'_>, PressError> {
        let object = self.object.curvature;
        self.skin().contact(&self.body, object, self.indentation)
    }

    /// What the sensor reads: without noise, or in trial number `trial`.
    fn readings(&self, trial: Option<u64>) -> Result<PressReadings, PressError> {
        let truth = self.truth.as_ref().map_err(|error| *error)?;
        let mut readings = PressReadings {
            normal: truth.markers.iter().map(|marker| marker.normal).collect(),
            tangential: truth.markers.iter().map(|one| one.tangential).collect(),
        };
        if let Some(trial) = trial {
            self.noise.add_to(&mut readings, self.seed, trial);
        }
        Ok(readings)
    }

    fn estimate(&self, trial: Option<u64>) -> Result<PressEstimate, PressError> {
        let fit = self.method.fit.as_ref().map_err(|error| *error)?;
        let readings = self.readings(trial)?;
        fit.estimate(&Reading {
            markers: &self.markers,
            normal: &readings.normal,
            tangential: self.sensor.tangential.then_some(&readings.tangential),
            indentation: self.method.known_indentation.map(|std| Measured {
                value: self.told_indentation(trial),
                std,
            }),
        })
    }

    /// One trial, from truth to estimate; see [`crate::Scene::trial`].
    ///
    /// # Errors
    /// The stable name of what went wrong.
    pub fn trial(
        &self,
        trial: u64,
        mut observe: impl FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        let estimate = self.estimate(Some(trial)).map_err(|error| error.name())?;
        let curvature = estimate.object_curvature();
        for (quantity, estimated) in [
            estimate.relative_curvature,
            estimate.effective_radius(),
            curvature,
            estimate.indentation,
            estimate.contact_radius,
        ]
        .into_iter()
        .enumerate()
        {
            if let Some(truth) = self.truth(quantity) {
                observe(quantity, outcome(&estimated, truth));
            }
        }
        observe(
            5,
            Outcome {
                estimate: estimate.r_squared,
                truth: 1.0,
                std: None,
                interval_holds: None,
            },
        );
        // The radius of what is taken for flat is no number.
        let radius = estimate.most_likely_object_curvature().recip();
        if let Some(truth) = self.object.radius
            && radius.is_finite()
        {
            let of_curvature = outcome(&curvature, self.object.curvature);
            observe(
                6,
                Outcome {
                    estimate: radius,
                    truth,
                    std: finite(curvature.std * radius * radius),
                    interval_holds: of_curvature.interval_holds,
                },
            );
        }
        Ok(())
    }

    /// The true value of a quantity, where it has one.
    pub fn truth(&self, quantity: usize) -> Option<f64> {
        let relative_curvature = self.skin().curvature() + self.object.curvature;
        match quantity {
            0 => Some(relative_curvature),
            1 => (relative_curvature > 0.0).then(|| relative_curvature.recip()),
            2 => Some(self.object.curvature),
            3 => Some(self.indentation),
            4 => self.truth.as_ref().ok().map(|truth| truth.contact_radius),
            5 => Some(1.0),
            6 => self.object.radius,
            _ => None,
        }
    }

    /// The Cramér–Rao bound on the standard deviation of a quantity, where it has one: what the readings can tell by the
    /// scene's own body and noise. What the estimator has to find out itself counts as unknown; of what it is told, the
    /// noise that is drawn, else that which it is told of.
    pub fn std_bound(&self, quantity: usize) -> Option<f64> {
        let bounds = self.bounds?;
        let square = |radius: f64| radius * radius;
        let bound = match quantity {
            0 | 2 => bounds.relative_curvature,
            1 => bounds.relative_curvature * square(self.truth(1)?),
            3 => bounds.indentation,
            4 => bounds.contact_radius,
            6 => bounds.relative_curvature * square(self.object.radius?),
            _ => return None,
        };
        finite(bound)
    }

    /// The models that the scene needs and why, one line each.
    pub fn needs(&self) -> Vec<String> {
        let mut needs = self.needs.clone();
        if let (Ok(_), Err(error)) = (&self.truth, self.estimate(None)) {
            needs.push(format!(
                "warning: even without noise the estimate fails as `{}`: {error}",
                error.name()
            ));
        }
        needs
    }
}

fn outcome(estimated: &Estimated, truth: f64) -> Outcome {
    Outcome {
        estimate: estimated.value,
        truth,
        std: finite(estimated.std),
        interval_holds: Some(estimated.interval.holds(truth)),
    }
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
