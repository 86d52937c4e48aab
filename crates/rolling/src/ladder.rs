//! The models that compute rolls, ordered by cost, and the choice of one of them. The list of the models is called a
//! ladder, and each model a rung.

use palpate_geometry::{Shape, Surface};

use crate::closed_form::ClosedForm;
use crate::integration::{Integration, Method};
use crate::integrator::{Dop853, Rk4};
use crate::ladder_errors::{Unmeasured, finer};
use crate::meridian::MeridianRung;
use crate::roller::Bodies;
use crate::{Chart, Choice, Contact, InvalidRoll, Model, Rolls};

/// Error bound of the model "closed form". Errors of positions are divided by the contact's length scale, that is, by
/// the displacement of the contact per radian of rolling.
pub(crate) const CLOSED_FORM_ERROR: f64 = 1e-14;
/// Error bound of the meridian model. Errors of positions are divided by the contact's length scale, that is, by the
/// displacement of the contact per radian of rolling.
pub(crate) const MERIDIAN_ERROR: f64 = 1e-13;
/// Tolerance of a single step divided by the tolerance of a whole roll. It is below 1, because the error of a step may
/// grow during the rest of the roll.
const STEP_SHARE: f64 = 0.1;
/// Smallest tolerance of a step of DOP853.
const MIN_STEP_TOLERANCE: f64 = 1e-15;
const MAX_STEPS: usize = 100_000;

/// Reason in [`Choice`] for a model that the user has set.
const SET_IN_CONFIG: &str = "named in the config";

#[derive(Clone, Debug)]
pub(crate) enum Rung {
    ClosedForm(ClosedForm),
    Meridian(MeridianRung),
    Integrated(Integration),
}

/// The bodies and their contact at the start. Together with the rolls, they determine the choice of a model.
pub(crate) struct Setting<'a> {
    pub(crate) bodies: Bodies<'a, Shape>,
    pub(crate) first: Contact,
    pub(crate) closed_form: ClosedForm,
}

/// The integrator RK4 for one form of the contact equations, with the [`Choice`] that describes it.
pub(crate) fn rk4(
    steps: usize,
    chart: Chart,
    reason: String,
    error_bound: Option<f64>,
) -> (Rung, Choice) {
    let method = rk4_method(steps);
    let rung = Rung::Integrated(Integration { method, chart });
    (
        rung,
        choice(Model::Rk4 { steps, chart }, reason, error_bound),
    )
}

/// The integrator DOP853 for one form of the contact equations, with the [`Choice`] that describes it.
pub(crate) fn dop853(
    tolerance: f64,
    chart: Chart,
    reason: String,
    error_bound: Option<f64>,
) -> (Rung, Choice) {
    let method = dop853_method(tolerance);
    let rung = Rung::Integrated(Integration { method, chart });
    let model = Model::Dop853 { tolerance, chart };
    (rung, choice(model, reason, error_bound))
}

fn choice(model: Model, reason: String, error_bound: Option<f64>) -> Choice {
    Choice {
        rung: model.name(),
        model,
        reason,
        error_bound,
    }
}

pub(crate) const fn rk4_method(steps: usize) -> Method {
    Method::Rk4(Rk4 { steps })
}

/// DOP853 with the step tolerance for which the error of a whole roll is within `tolerance`.
pub(crate) const fn dop853_method(tolerance: f64) -> Method {
    Method::Dop853(Dop853 {
        tolerance: (STEP_SHARE * tolerance).max(MIN_STEP_TOLERANCE),
        most_steps: MAX_STEPS,
    })
}

/// The integrator for motions that the chosen model (closed form or meridian) cannot compute. Such motions arise only
/// from noise, because the model was chosen for the rolls without noise.
pub(crate) const FALLBACK: Integration = Integration {
    method: dop853_method(MERIDIAN_ERROR),
    chart: Chart::Free,
};

impl Setting<'_> {
    pub(crate) fn rung(
        &self,
        model: Model,
        rolls: Rolls<'_>,
    ) -> Result<(Rung, Choice), InvalidRoll> {
        if let Model::Auto { tolerance, .. } | Model::Dop853 { tolerance, .. } = model {
            Model::checked(tolerance).map_err(InvalidRoll::Tolerance)?;
        }
        let unsupported = |rung, reason| InvalidRoll::Unsupported { rung, reason };
        match model {
            Model::Auto { tolerance, chart } => Ok(self.cheapest(tolerance, chart, rolls)),
            Model::ClosedForm => {
                let rung = self.closed_form(rolls);
                let rung = rung.map_err(|why| unsupported("closed form", why))?;
                Ok((rung, self.closed_form_choice()))
            }
            Model::Meridian => {
                let rung = self
                    .meridian(rolls)
                    .map_err(|why| unsupported("meridian", why))?;
                Ok((rung, self.meridian_choice()))
            }
            Model::Rk4 { steps, chart } => {
                if !(1..=MAX_STEPS).contains(&steps) {
                    let reason = format!("{steps} steps are not from 1 to {MAX_STEPS}");
                    return Err(unsupported("RK4", reason));
                }
                Ok(rk4(steps, chart, SET_IN_CONFIG.to_owned(), None))
            }
            Model::Dop853 { tolerance, chart } => Ok(dop853(
                tolerance,
                chart,
                SET_IN_CONFIG.to_owned(),
                Some(tolerance),
            )),
        }
    }

    /// The cheapest model whose error on `rolls` is within `tolerance`, and the reason for the choice.
    fn cheapest(&self, tolerance: f64, chart: Chart, rolls: Rolls<'_>) -> (Rung, Choice) {
        if tolerance >= CLOSED_FORM_ERROR
            && let Ok(rung) = self.closed_form(rolls)
        {
            return (rung, self.closed_form_choice());
        }
        // The components of a motion are constant either in the contact frame or in the frame of the chart. The
        // meridian model is valid in both cases: along a meridian, which is a line of symmetry, the two frames are
        // equal.
        if tolerance >= MERIDIAN_ERROR
            && let Ok(rung) = self.meridian(rolls)
        {
            return (rung, self.meridian_choice());
        }
        self.cheapest_integrator(tolerance, chart, rolls)
            .unwrap_or_else(|why| match why {
                Unmeasured::Ends => {
                    let reason = "no closed form; the roll ends early, so errors cannot be \
                         measured";
                    dop853(tolerance, chart, reason.to_owned(), Some(tolerance))
                }
                // The errors of integration steps add up along the path, so the tolerance is divided by the number of
                // turns of the probe.
                Unmeasured::TooLong => {
                    let reason = "no closed form; the rolls are too long to try other models";
                    let finer = finer(tolerance / rolls.turns().max(1.0));
                    dop853(finer, chart, reason.to_owned(), Some(tolerance))
                }
            })
    }

    fn closed_form(&self, rolls: Rolls<'_>) -> Result<Rung, String> {
        if !self.bodies.object.is_homogeneous() {
            let name = self.bodies.object.name();
            return Err(format!("a {name} has no closed form"));
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
        let rung = MeridianRung::new(self.bodies.object, &self.first, self.bodies.probe.radius());
        if !rolls.motions().all(|motion| rung.section(motion).is_some()) {
            let reason = "the first contact is not the apex of a surface of revolution, nor of a line of symmetry along the motion";
            return Err(reason.to_owned());
        }
        if rolls.has_noise && !rung.is_revolved() {
            return Err("noise moves the probe off the line of symmetry".to_owned());
        }
        if rolls.spin() || rolls.slide() {
            return Err("the motion spins or slides".to_owned());
        }
        if rolls.rolls.iter().any(|roll| roll.len() > 1) {
            return Err("the motion changes on the way".to_owned());
        }
        Ok(Rung::Meridian(rung))
    }

    fn meridian_choice(&self) -> Choice {
        let name = self.bodies.object.name();
        Choice {
            rung: format!("meridian: sphere through the apex of a {name}"),
            model: Model::Meridian,
            reason: "the contact runs along a line of symmetry".to_owned(),
            error_bound: Some(MERIDIAN_ERROR),
        }
    }
}
