//! A glide: fingers slide over a patch, and EP2 estimates its curvature.

mod ladder;
mod map;
mod method;
mod plan;
mod sensor;
mod trace;

pub use map::MapTable;
pub(crate) use method::AnyMethod;
pub use trace::GlideTrace;

use nalgebra::Vector3;
use palpate_ep2::{Contact, Ep2Error, Fit, Method, Patch};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_rolling::Touch;
use palpate_sensing::{Channel, NormalError, PositionError, Stream};

use crate::{Outcome, PlanError};
use palpate_study::{Quantity, Unit};

/// Quantities that a glide estimates, at every place of its grid.
pub const QUANTITIES: [Quantity; 3] = [
    Quantity {
        name: "gaussian_curvature",
        unit: Unit::PerLengthSquared,
    },
    Quantity {
        name: "mean_curvature",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "class",
        unit: Unit::One,
    },
];

/// A glide that is ready to run: the truth, the sensor, the noise and the method of a cell.
#[derive(Clone, Debug)]
pub struct GlideScene {
    seed: u64,
    /// The true contacts.
    touches: Vec<FingerTouch>,
    /// Contacts as the sensor reports them, without noise.
    sensed: Vec<Contact>,
    noise: ReadingNoise,
    method: AnyMethod,
    grid: TrueGrid,
    needs: Vec<String>,
}

/// A contact of a finger.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FingerTouch {
    finger: usize,
    touch: Touch,
}

/// Errors of positions and normals; `None` where they have none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ReadingNoise {
    position: Option<PositionError>,
    normal: Option<NormalError>,
}

/// Places at which estimates are held against the truth.
#[derive(Clone, Debug, PartialEq)]
struct TrueGrid {
    /// Places along each side.
    side: usize,
    /// The true surface there, x slowest.
    places: Vec<TruePlace>,
    thresholds: ShapeThresholds,
}

/// A place of the true surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TruePlace {
    point: nalgebra::Point3<f64>,
    gaussian: f64,
    mean: f64,
    class: ShapeClass,
}

impl GlideScene {
    /// Whether trials differ.
    pub fn is_random(&self) -> bool {
        self.noise.position.is_some() || self.noise.normal.is_some()
    }

    /// How many fingers slide.
    pub fn fingers(&self) -> usize {
        self.touches.last().map_or(0, |last| last.finger + 1)
    }

    /// Whether the contacts tell the patch at all, without noise.
    ///
    /// # Errors
    /// [`PlanError`] at what keeps them from it.
    pub fn estimable(&self) -> Result<(), PlanError> {
        let fit = self.fit(None);
        fit.map(drop).map_err(|error| plan::of_fit(&error))
    }

    /// Contacts as the fingers report them: without noise, or in trial number `trial`.
    fn readings(&self, trial: Option<u64>) -> Vec<Contact> {
        let mut contacts = self.sensed.clone();
        let Some(trial) = trial else {
            return contacts;
        };
        if let Some(error) = &self.noise.position {
            let mut stream = Stream::new(self.seed, trial, Channel::Position);
            for contact in &mut contacts {
                contact.position = error.read(&mut stream, &contact.position);
            }
        }
        if let Some(error) = &self.noise.normal {
            let mut stream = Stream::new(self.seed, trial, Channel::Normal);
            for normal in contacts.iter_mut().filter_map(|one| one.normal.as_mut()) {
                *normal = error.read(&mut stream, normal);
            }
        }
        contacts
    }

    /// The surface that the method makes of these readings.
    fn fit(&self, trial: Option<u64>) -> Result<Fit, Ep2Error> {
        let patch = Patch::new(&self.readings(trial), &Vector3::z())?;
        self.method.fit(&patch)
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
        let fit = self.fit(Some(trial)).map_err(|error| error.name())?;
        for place in &self.grid.places {
            let curvature = fit
                .curvature_at(&place.point)
                .map_err(|error| error.name())?;
            let uncertainty = curvature.uncertainty;
            let is_right = curvature.class(&self.grid.thresholds) == place.class;
            observe(
                0,
                Outcome {
                    estimate: curvature.gaussian,
                    truth: place.gaussian,
                    std: uncertainty.map(|one| one.gaussian_std),
                    interval_holds: None,
                },
            );
            observe(
                1,
                Outcome {
                    estimate: curvature.mean,
                    truth: place.mean,
                    std: uncertainty.map(|one| one.mean_std),
                    interval_holds: None,
                },
            );
            observe(
                2,
                Outcome {
                    estimate: f64::from(u8::from(is_right)),
                    truth: 1.0,
                    std: None,
                    interval_holds: None,
                },
            );
        }
        Ok(())
    }

    /// The true value of a quantity, where it is the same at every place.
    pub fn truth(&self, quantity: usize) -> Option<f64> {
        let value = |place: &TruePlace| match quantity {
            0 => Some(place.gaussian),
            1 => Some(place.mean),
            2 => Some(1.0),
            _ => None,
        };
        let first = value(self.grid.places.first()?)?;
        let same = self
            .grid
            .places
            .iter()
            .all(|place| value(place) == Some(first));
        same.then_some(first)
    }

    /// The models that the scene needs and why, one line each.
    pub fn needs(&self) -> Vec<String> {
        self.needs.clone()
    }
}
