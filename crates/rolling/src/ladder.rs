//! The choice of a rung.

mod integrators;

use palpate_geometry::Surface;

use crate::meridian::MeridianRung;
use crate::rung::{CLOSED_FORM_ERROR, MERIDIAN_ERROR, MOST_STEPS, Rung, Setting, dop853, rk4};
use crate::{Chart, Choice, InvalidRoll, Model, Rolls};
use integrators::{Unmeasured, finer};

pub(crate) use integrators::Ends;

/// Reason for a rung that was not chosen from the ladder.
const NAMED: &str = "named in the config";

impl Setting<'_> {
    pub(crate) fn rung(
        &self,
        model: Model,
        rolls: Rolls<'_>,
    ) -> Result<(Rung, Choice), InvalidRoll> {
        if let Model::Auto { tolerance, .. } | Model::Dop853 { tolerance, .. } = model
            && !(Model::SMALLEST_TOLERANCE..=Model::LARGEST_TOLERANCE).contains(&tolerance)
        {
            return Err(InvalidRoll::Tolerance { tolerance });
        }
        let unsupported = |rung, reason| InvalidRoll::Unsupported { rung, reason };
        match model {
            Model::Auto { tolerance, chart } => Ok(self.cheapest(tolerance, chart, rolls)),
            Model::ClosedForm => {
                let rung = self
                    .closed_form(rolls)
                    .map_err(|why| unsupported("closed form", why))?;
                Ok((rung, self.closed_form_choice()))
            }
            Model::Meridian => {
                let rung = self
                    .meridian(rolls)
                    .map_err(|why| unsupported("meridian", why))?;
                Ok((rung, self.meridian_choice()))
            }
            Model::Rk4 { steps, chart } => {
                if !(1..=MOST_STEPS).contains(&steps) {
                    let reason = format!("{steps} steps are not from 1 to {MOST_STEPS}");
                    return Err(unsupported("RK4", reason));
                }
                Ok(rk4(steps, chart, NAMED.to_owned(), None))
            }
            Model::Dop853 { tolerance, chart } => {
                Ok(dop853(tolerance, chart, NAMED.to_owned(), Some(tolerance)))
            }
        }
    }

    /// The cheapest rung that errs by at most the tolerance.
    fn cheapest(&self, tolerance: f64, chart: Chart, rolls: Rolls<'_>) -> (Rung, Choice) {
        if tolerance >= CLOSED_FORM_ERROR
            && let Ok(rung) = self.closed_form(rolls)
        {
            return (rung, self.closed_form_choice());
        }
        // An axis held in the chart follows a meridian too: it is a line of symmetry.
        if tolerance >= MERIDIAN_ERROR
            && let Ok(rung) = self.meridian(rolls)
        {
            return (rung, self.meridian_choice());
        }
        self.cheapest_integrator(tolerance, chart, rolls)
            .unwrap_or_else(|why| match why {
                Unmeasured::Ends => {
                    let reason = "no closed form; a roll that does not end cannot be measured";
                    dop853(tolerance, chart, reason.to_owned(), Some(tolerance))
                }
                // Errors add up along the way, and grow with it.
                Unmeasured::TooLong => {
                    let reason = "no closed form; the rolls are too long to try others";
                    let finer = finer(tolerance / rolls.turns().max(1.0));
                    dop853(finer, chart, reason.to_owned(), Some(tolerance))
                }
            })
    }

    fn closed_form(&self, rolls: Rolls<'_>) -> Result<Rung, String> {
        if !self.bodies.object.is_homogeneous() {
            return Err(format!(
                "a {} has no closed form",
                self.bodies.object.name()
            ));
        }
        if rolls.spin() {
            return Err("the motion spins".to_owned());
        }
        Ok(Rung::ClosedForm(self.closed_form))
    }

    fn closed_form_choice(&self) -> Choice {
        Choice {
            rung: format!("closed form: sphere on {}", self.bodies.object.name()),
            model: Model::ClosedForm,
            reason: "the contact runs along geodesics of both bodies".to_owned(),
            error_bound: Some(CLOSED_FORM_ERROR),
        }
    }

    fn meridian(&self, rolls: Rolls<'_>) -> Result<Rung, String> {
        let meridian = self
            .bodies
            .object
            .meridian(&self.first.on_object)
            .ok_or_else(|| {
                "the first contact is not the apex of a surface of revolution".to_owned()
            })?;
        if rolls.spin() || rolls.slide() {
            return Err("the motion spins or slides".to_owned());
        }
        if rolls.in_pieces() {
            return Err("the motion changes on the way".to_owned());
        }
        let rung = MeridianRung::new(meridian, self.bodies.probe.radius());
        Ok(Rung::Meridian(rung))
    }

    fn meridian_choice(&self) -> Choice {
        Choice {
            rung: format!(
                "meridian: sphere through the apex of a {}",
                self.bodies.object.name()
            ),
            model: Model::Meridian,
            reason: "the contact runs along a line of symmetry".to_owned(),
            error_bound: Some(MERIDIAN_ERROR),
        }
    }
}
