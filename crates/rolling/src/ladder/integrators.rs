//! The choice of an integrator, by errors and costs measured on the noiseless rolls.

use crate::integration::{Integration, Method};
use crate::integrator::Dop853;
use crate::rung::{Rung, Setting, dop853, dop853_method, rk4, rk4_method};
use crate::{Chart, Choice, Contact, Model, RollFault, Rolls, TOLERANCES};

/// Factor by which a measured error is enlarged before it is held against a tolerance.
const MARGIN: f64 = 1.25;
/// Tolerance of the integration that others are judged against, as a share of the tolerance asked for.
const FINER: f64 = 1e-3;
/// Evaluations of a step of DOP853.
const STAGES: usize = 12;
/// Cost of an evaluation by DOP853, with its share of the control of the step, in evaluations by RK4: counted in
/// instructions it is 2.1 on a saddle, 1.5 on an ellipsoid, less on a formula.
const DEARER: f64 = 1.5;
/// Settings that are tried, cheapest first.
const RK4_STEPS: [usize; 12] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];

/// Choosing takes a few integrations of all rolls: none of them asks for more evaluations than this many, or this
/// many of each motion, which is a few steps.
const AFFORDABLE: usize = 20_000;
const AFFORDABLE_PER_MOTION: usize = 60;

/// Reasons for which no rung is measured on the noiseless rolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unmeasured {
    /// A roll ends before its motions do, or never begins.
    Ends,
    /// They ask for more evaluations than a choice is worth.
    TooLong,
}

/// Contacts at the ends of all rolls, and how often the contact equations were evaluated on the way.
#[derive(Default)]
pub(crate) struct Ends {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) evaluations: usize,
}

/// The tolerance of the integration that others are judged against.
pub(super) fn finer(tolerance: f64) -> f64 {
    (FINER * tolerance).max(Model::SMALLEST_TOLERANCE)
}

impl Method {
    /// This method, made to give up beyond so many evaluations of the derivative; RK4 stays as it is, since its
    /// number is fixed.
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
        let mut ends = Ends::default();
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

    /// Largest distance between contacts on either body, relative to the length scale.
    pub(crate) fn distance(&self, one: &Ends, other: &Ends) -> f64 {
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
