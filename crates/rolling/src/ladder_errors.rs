//! Errors and costs of the models, measured on rolls without noise. They determine which integrator is chosen.

use crate::integration::{Integration, Method};
use crate::integrator::Dop853;
use crate::ladder::{Rung, Setting, dop853, dop853_method, rk4, rk4_method};
use crate::{Chart, Choice, Contact, InvalidRoll, Model, RollFault, Roller, Rolls, TOLERANCES};

/// Safety factor by which a measured error is multiplied before it is compared with a tolerance.
const MARGIN: f64 = 1.25;
/// Tolerance of the reference integration with which models are compared, relative to the required tolerance.
const REFERENCE_SHARE: f64 = 1e-3;
/// Number of evaluations of the contact equations per step of DOP853.
const STAGES: usize = 12;
/// Cost of an evaluation of the contact equations in DOP853, including the step control, relative to its cost in RK4.
/// The measured ratio of processor instructions per evaluation is 2.1 on a saddle, 1.5 on an ellipsoid, and less on a
/// height field from a formula.
const RELATIVE_COST: f64 = 1.5;
/// Numbers of steps per motion that are tried for RK4, in ascending order of the cost.
const RK4_STEPS: [usize; 12] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];

/// Largest number of evaluations of the contact equations in one integration of all rolls, when the errors of models
/// are measured. Longer rolls are not measured, because this would take too long.
const MAX_EVALUATIONS: usize = 20_000;
/// Number of evaluations that is allowed for each motion, even if all motions together need more than
/// [`MAX_EVALUATIONS`]. So rolls that consist of many short motions are measured too.
const MAX_EVALUATIONS_PER_MOTION: usize = 60;
/// Tolerances of the DOP853 models in the list that [`Roller::ladder`] returns.
const LADDER_TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A roll model with its error and cost on a scene's rolls without noise.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRung {
    /// The roll model; never [`Model::Auto`].
    pub model: Model,
    /// Displayed name of the model, including the number of steps or the tolerance of an integrator.
    pub name: String,
    /// The largest error of a contact at the end of a roll, relative to the contact's length scale (the smallest
    /// displacement of the contact per radian of rolling). The reference is DOP853 at the smallest tolerance. `Err`
    /// contains the reason if the model cannot compute these rolls.
    pub outcome: Result<f64, String>,
    /// Number of evaluations of the contact equations in all rolls. It is 0 for the closed form and the meridian model.
    pub evaluations: usize,
}

impl Roller {
    /// All models with their errors on the rolls `rolls`, which have no noise. The models are sorted by their number of
    /// evaluations. The chosen model is one of them; models that cannot compute these rolls are included. `chart` is
    /// the form of the equations that the integrators use.
    pub fn ladder(&self, chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let rk4 = (0..=6).map(|power| Model::Rk4 {
            steps: 1 << power,
            chart,
        });
        let dop853 = LADDER_TOLERANCES.map(|tolerance| Model::Dop853 { tolerance, chart });
        let mut models = vec![Model::ClosedForm, Model::Meridian];
        models.extend(rk4.chain(dop853));
        let chosen = self.choice().model;
        if !models.contains(&chosen) {
            models.push(chosen);
        }
        let mut rungs = self.measure(&models, chart, rolls);
        rungs.sort_by_key(|rung| rung.evaluations);
        rungs
    }

    /// Error and cost of each of the models `models` on the rolls `rolls`. `chart` is the form of the equations that
    /// the reference integrator uses.
    pub fn measure(&self, models: &[Model], chart: Chart, rolls: Rolls<'_>) -> Vec<MeasuredRung> {
        let tolerance = Model::SMALLEST_TOLERANCE;
        let reference = self.ends_on(Model::Dop853 { tolerance, chart }, rolls);
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
        let mut ends = Ends::default();
        for roll in rolls.rolls {
            let (contact, evaluations) = roller.follow(roll).map_err(|error| error.to_string())?;
            ends.contacts.push(contact);
            ends.evaluations += evaluations;
        }
        Ok(ends)
    }
}

/// Reasons why the errors of models cannot be measured on a scene's rolls without noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unmeasured {
    /// A roll cannot begin, or it ends before all of its motions are complete.
    Ends,
    /// Measuring the errors on these rolls would need more evaluations of the contact equations than are allowed.
    TooLong,
}

/// The contacts at the ends of all rolls, and the number of evaluations of the contact equations that the rolls needed.
#[derive(Default)]
struct Ends {
    contacts: Vec<Contact>,
    evaluations: usize,
}

/// Tolerance of the reference integration: a thousandth of the required `tolerance`, but not below the smallest
/// tolerance of the models.
pub(crate) fn finer(tolerance: f64) -> f64 {
    (REFERENCE_SHARE * tolerance).max(Model::SMALLEST_TOLERANCE)
}

impl Method {
    /// The same integrator with a limit on the number of evaluations. RK4 does not change, because its number of steps
    /// fixes the number of evaluations.
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
    /// The cheapest integrator (RK4 with a number of steps, or DOP853 with a tolerance) whose error on the rolls
    /// without noise is within the tolerance. If no integrator meets the tolerance, the result is DOP853 with the
    /// tolerance of the reference integration.
    ///
    /// DOP853 is cheapest with its largest tolerance that meets the required tolerance, also for rolls with noise.
    pub(crate) fn cheapest_integrator(
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
            format!("no closed form; error {measured:.1e} on the noiseless rolls")
        };

        let mut adaptive = (finest, reference.evaluations, finest);
        for setting in TOLERANCES {
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
            if (4 * steps * motions) as f64 >= RELATIVE_COST * evaluations as f64 {
                break;
            }
            // If the integration fails, its steps may be too long for the surface. Try more steps, which are shorter.
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

    /// Computes the contacts at the ends of all rolls with the integrator `method`.
    fn ends(&self, rolls: Rolls<'_>, method: Method, chart: Chart) -> Result<Ends, Unmeasured> {
        let mut ends = Ends::default();
        let motions: usize = rolls.rolls.iter().map(Vec::len).sum();
        let most = MAX_EVALUATIONS.max(MAX_EVALUATIONS_PER_MOTION.saturating_mul(motions));
        for roll in rolls.rolls {
            let mut contact = self.first;
            for motion in roll {
                let method = method.within(most.saturating_sub(ends.evaluations));
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

    /// Largest distance between corresponding contacts of two integrations, on the object or on the probe, relative to
    /// the contact's length scale.
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
