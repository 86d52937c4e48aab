//! What the rungs err by, and what they cost, on the noiseless rolls.

use super::{Rung, Setting, dop853, dop853_method, rk4, rk4_method};
use crate::integration::{Integration, Method};
use crate::integrator::Dop853;
use crate::{Chart, Choice, Contact, InvalidRoll, Model, RollFault, Roller, Rolls};

/// What is measured is trusted with this margin.
const MARGIN: f64 = 1.25;
/// How much finer than the tolerance the integration is that others are judged against.
const FINER: f64 = 1e-3;
/// Evaluations of a step of DOP853.
const STAGES: usize = 12;
/// An evaluation by DOP853, with its share of what holds the step to its tolerance, costs so many by RK4: by instructions 2.1
/// on a saddle, 1.5 on an ellipsoid, less on a formula.
const DEARER: f64 = 1.5;
/// Settings that are tried, cheapest first.
const RK4_STEPS: [usize; 12] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];
const DOP853_TOLERANCES: [f64; 14] = [
    1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14,
];

/// Choosing takes a few integrations of all rolls: none of them asks for more evaluations than this many, or this
/// many of each motion, which is a few steps.
const AFFORDABLE: usize = 20_000;
const AFFORDABLE_PER_MOTION: usize = 60;

/// DOP853's on a ladder that is shown.
const LADDER_TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A rung of the ladder, with what it errs by and costs on the noiseless rolls.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRung {
    /// The model that names the rung: never [`Model::Auto`].
    pub model: Model,
    /// The rung with its setting, in words.
    pub name: String,
    /// The largest error of a contact at the end of a roll, relative to its length scale, as held
    /// against DOP853 at the smallest tolerance; or why the rung cannot do these rolls.
    pub outcome: Result<f64, String>,
    /// How often all rolls together evaluate the contact equations; a closed form does not.
    pub evaluations: usize,
}

/// Why no rung is measured on the noiseless rolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unmeasured {
    /// A roll ends before its motions do, or never begins.
    Ends,
    /// They ask for more evaluations than a choice is worth.
    TooLong,
}

/// One integrator on all rolls.
struct Ends {
    contacts: Vec<Contact>,
    evaluations: usize,
}

/// The tolerance of the integration that others are judged against.
pub(super) fn finer(tolerance: f64) -> f64 {
    (FINER * tolerance).max(Model::SMALLEST_TOLERANCE)
}

impl Method {
    /// The same, giving up where it would take more evaluations than these; RK4 takes as many as it is told.
    fn within(self, evaluations: usize) -> Self {
        match self {
            Self::Rk4(_) => self,
            Self::Dop853(method) => Self::Dop853(Dop853 {
                most_steps: method.most_steps.min(evaluations / STAGES),
                ..method
            }),
        }
    }
}

impl Setting<'_> {
    /// The cheapest setting of an integrator that meets the tolerance on the noiseless rolls, or the
    /// most accurate one.
    ///
    /// DOP853's first setting that does is its cheapest: the coarser, the fewer evaluations, on noisy rolls as well.
    pub(super) fn cheapest_integrator(
        &self,
        tolerance: f64,
        chart: Chart,
        rolls: Rolls<'_>,
    ) -> Result<(Rung, Choice), Unmeasured> {
        if !rolls.all_run() {
            return Err(Unmeasured::Ends);
        }
        let finest = finer(tolerance);
        let reference = self.ends(rolls, dop853_method(finest), chart)?;
        let error = |ends: &Ends| MARGIN * self.distance(ends, &reference);
        let reason = |error: f64| {
            let measured = error / MARGIN;
            format!("no closed form; errs by {measured:.1e} on the noiseless rolls")
        };

        let mut adaptive = (finest, reference.evaluations, finest);
        for setting in DOP853_TOLERANCES {
            if setting < finest {
                break;
            }
            let ends = self.ends(rolls, dop853_method(setting), chart)?;
            let error = error(&ends);
            if error <= tolerance {
                adaptive = (setting, ends.evaluations, error);
                break;
            }
        }
        let (setting, evaluations, bound) = adaptive;
        let bound = bound.max(Model::SMALLEST_TOLERANCE);
        let motions: usize = rolls.rolls.iter().map(Vec::len).sum();
        for steps in RK4_STEPS {
            if (4 * steps * motions) as f64 >= DEARER * evaluations as f64 {
                break;
            }
            // Steps may be too long for the surface where shorter ones are not.
            let Ok(ends) = self.ends(rolls, rk4_method(steps), chart) else {
                continue;
            };
            let error = error(&ends);
            if error <= tolerance {
                return Ok(rk4(steps, chart, reason(error), Some(error)));
            }
        }
        Ok(dop853(setting, chart, reason(bound), Some(bound)))
    }

    /// Ends of all rolls by one integrator.
    fn ends(&self, rolls: Rolls<'_>, method: Method, chart: Chart) -> Result<Ends, Unmeasured> {
        let mut ends = Ends {
            contacts: Vec::new(),
            evaluations: 0,
        };
        let motions: usize = rolls.rolls.iter().map(Vec::len).sum();
        let affordable = AFFORDABLE.max(AFFORDABLE_PER_MOTION.saturating_mul(motions));
        for roll in rolls.rolls {
            let mut contact = self.first;
            for motion in roll {
                let method = method.within(affordable.saturating_sub(ends.evaluations));
                let (next, evaluations) = Integration { method, chart }
                    .advance(&self.bodies, &contact, motion)
                    .map_err(|error| match error.fault {
                        RollFault::TooManySteps { .. } => Unmeasured::TooLong,
                        _ => Unmeasured::Ends,
                    })?;
                contact = next;
                ends.evaluations += evaluations;
            }
            ends.contacts.push(contact);
        }
        Ok(ends)
    }

    fn distance(&self, one: &Ends, other: &Ends) -> f64 {
        let radius = self.bodies.probe.radius();
        let distance = |(a, b): (&Contact, &Contact)| {
            let on_object = (a.on_object - b.on_object).norm();
            let on_probe = (a.on_probe(radius) - b.on_probe(radius)).norm();
            on_object.max(on_probe) / self.bodies.length_scale
        };
        let pairs = one.contacts.iter().zip(&other.contacts);
        pairs.map(distance).fold(0.0, f64::max)
    }
}

impl Roller {
    /// The rungs on which these rolls, without noise, can be computed, cheapest first; the one that
    /// is taken is among them. `chart` is for the integrators.
    pub fn ladder(&self, chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let rk4 = (0..=6).map(|power| Model::Rk4 {
            steps: 1 << power,
            chart,
        });
        let dop853 = LADDER_TOLERANCES.map(|tolerance| Model::Dop853 { tolerance, chart });
        let mut models = vec![Model::ClosedForm, Model::Meridian];
        models.extend(rk4.chain(dop853));
        let taken = self.choice().model;
        if !models.contains(&taken) {
            models.push(taken);
        }
        let mut rungs = self.measured(&models, chart, rolls);
        rungs.sort_by_key(|rung| rung.evaluations);
        rungs
    }

    /// What each of these models errs by and costs on these rolls. `chart` is for the integrator
    /// that they are held against.
    pub fn measured(&self, models: &[Model], chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let reference = self.ends_on(
            Model::Dop853 {
                tolerance: Model::SMALLEST_TOLERANCE,
                chart,
            },
            rolls,
        );
        let setting = self.setting();
        models
            .iter()
            .map(|model| {
                let ends = self.ends_on(*model, rolls);
                let evaluations = ends.as_ref().map_or(0, |ends| ends.evaluations);
                MeasuredRung {
                    model: *model,
                    name: model.name(),
                    outcome: ends.and_then(|ends| {
                        let reference = reference.as_ref().map_err(Clone::clone)?;
                        Ok(setting.distance(&ends, reference))
                    }),
                    evaluations,
                }
            })
            .collect()
    }

    fn ends_on(&self, model: Model, rolls: Rolls<'_>) -> Result<Ends, String> {
        let roller = self.on(model, rolls).map_err(|error| match error {
            InvalidRoll::Unsupported { reason, .. } => reason,
            error => error.to_string(),
        })?;
        let mut ends = Ends {
            contacts: Vec::new(),
            evaluations: 0,
        };
        for roll in rolls.rolls {
            let (contact, evaluations) = roller.follow(roll).map_err(|error| error.to_string())?;
            ends.contacts.push(contact);
            ends.evaluations += evaluations;
        }
        Ok(ends)
    }
}
