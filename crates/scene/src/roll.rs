//! A roll: probes roll from a first contact, and EP1 estimates the curvature there.

mod noise;
mod plan;
mod sensor;
mod trace;

pub use plan::PlanError;
pub use trace::{RollTrace, TraceError};

use nalgebra::Vector2;
use palpate_ep1::{Estimate, LeastSquares, Measured, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;
use palpate_rolling::{Motion, Roller, Shift};

use crate::{Outcome, Quantity, Unit};
use noise::MotionNoise;
use sensor::{RollSensor, SensorTrial};

/// What a roll estimates.
pub const QUANTITIES: [Quantity; 5] = [
    Quantity {
        name: "normal_curvature_u",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "normal_curvature_v",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "gaussian_curvature",
        unit: Unit::PerLengthSquared,
    },
    Quantity {
        name: "mean_curvature",
        unit: Unit::PerLength,
    },
    Quantity {
        name: "arc_length",
        unit: Unit::Length,
    },
];

/// A roll that is ready to run: the truth, the noise, the sensor and the estimator of a cell.
#[derive(Clone, Debug)]
pub struct RollScene {
    seed: u64,
    roller: Roller,
    /// What each probe is told to do.
    commands: Vec<Motion>,
    /// What each probe reports of its rotation if nothing errs.
    rotations: Vec<Vector2<f64>>,
    noise: MotionNoise,
    sensor: RollSensor,
    encoder: Option<palpate_sensing::Encoder>,
    reading_noise: ReadingNoise,
    truth: Truth,
}

/// The object's curvature at the first contact, and the noiseless length of the rolls.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Truth {
    curvature: CurvatureForm,
    arc_length: f64,
}

impl RollScene {
    /// Whether trials differ.
    pub fn is_random(&self) -> bool {
        self.noise.is_random() || self.sensor.is_random()
    }

    /// The rung of the forward law that was taken, and why.
    pub const fn roller(&self) -> &Roller {
        &self.roller
    }

    /// What each probe is told to do.
    pub fn commands(&self) -> &[Motion] {
        &self.commands
    }

    /// The true values, in the order of [`QUANTITIES`].
    pub fn truths(&self) -> [f64; 5] {
        let Truth {
            curvature,
            arc_length,
        } = &self.truth;
        [
            curvature.k_uu,
            curvature.k_vv,
            curvature.gaussian_curvature(),
            curvature.mean_curvature(),
            *arc_length,
        ]
    }

    /// One trial, from truth to estimate; see [`crate::Scene::trial`].
    ///
    /// # Errors
    /// The stable name of what went wrong.
    #[inline]
    pub fn trial(
        &self,
        trial: u64,
        mut observe: impl FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        let mut sums = LeastSquares::new(self.roller.probe().radius(), self.reading_noise);
        let mut noise = self.noise.begin(self.seed, trial);
        let mut sensor = self.sensor.begin(self.seed, trial);
        for (command, rotation) in self.commands.iter().zip(&self.rotations) {
            let (shift, mut rotation) = noise
                .roll(&self.roller, command, rotation)
                .map_err(|error| error.fault.name())?;
            if let Some(encoder) = &self.encoder {
                rotation = encoder.read(&rotation);
            }
            let shift = read(&mut sensor, &shift)?;
            sums.add(&ProbeReading { rotation, shift });
        }
        let estimate = sums.estimate().map_err(|error| error.name())?;
        self.report(&estimate, &mut observe);
        Ok(())
    }

    #[inline]
    fn report(&self, estimate: &Estimate, observe: &mut impl FnMut(usize, Outcome)) {
        let estimates = [
            estimate.normal_curvature_u,
            estimate.normal_curvature_v,
            estimate.gaussian_curvature,
            estimate.mean_curvature,
            Measured {
                value: estimate.arc_length,
                std: None,
            },
        ];
        for (index, (measured, truth)) in estimates.into_iter().zip(self.truths()).enumerate() {
            observe(
                index,
                Outcome {
                    estimate: measured.value,
                    truth,
                    std: measured.std,
                },
            );
        }
    }

    /// The models that the scene needs and why, one line each.
    pub fn needs(&self) -> Vec<String> {
        let choice = self.roller.choice();
        let bound = choice.error_bound.map_or_else(String::new, |bound| {
            format!(", error at most {bound:.0e} of the contact's scale")
        });
        let mut lines = vec![format!("{} ({}{bound})", choice.rung, choice.reason)];
        lines.extend(self.noise.need());
        lines.push(self.sensor.need());
        if self.encoder.is_some() {
            lines.push("encoders: the rotation is reported in steps".to_owned());
        }
        lines.push(format!("least squares over {} probes", self.commands.len()));
        let half_turn = std::f64::consts::PI * self.roller.probe().radius();
        if self.truth.arc_length > half_turn {
            lines.push(
                "warning: the contact passes half way round the probe, where a shift no longer \
                 tells the length of the roll"
                    .to_owned(),
            );
        }
        lines
    }
}

#[inline]
fn read(sensor: &mut SensorTrial<'_>, shift: &Shift) -> Result<Vector2<f64>, &'static str> {
    sensor
        .read(&shift.displacement)
        .map_err(|error| error.name())
}
