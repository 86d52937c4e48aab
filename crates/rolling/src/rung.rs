//! Rungs of the ladder.

use palpate_geometry::Shape;

use crate::bodies::Bodies;
use crate::closed_form::ClosedForm;
use crate::integration::{Integration, Method};
use crate::integrator::{Dop853, Rk4};
use crate::meridian::MeridianRung;
use crate::{Chart, Choice, Contact, Model};

/// Error bounds of the rungs that have no setting, relative to the contact's length scale.
pub(crate) const CLOSED_FORM_ERROR: f64 = 1e-14;
pub(crate) const MERIDIAN_ERROR: f64 = 1e-13;
/// The contact's error may grow over a roll; a step is held to this part of the tolerance.
const LOCAL_SHARE: f64 = 0.1;
const SMALLEST_LOCAL: f64 = 1e-15;
/// Largest number of steps of an integration: DOP853 gives up after so many, and RK4 takes no more.
pub(crate) const MOST_STEPS: usize = 100_000;

/// A rung of the ladder, ready to roll.
#[derive(Clone, Debug)]
pub(crate) enum Rung {
    ClosedForm(ClosedForm),
    Meridian(MeridianRung),
    Integrated(Integration),
}

/// The setting from which a rung is chosen: the bodies and their first contact.
pub(crate) struct Setting<'a> {
    pub(crate) bodies: Bodies<'a, Shape>,
    pub(crate) first: Contact,
    pub(crate) closed_form: ClosedForm,
}

/// RK4 on a form of the equations, and the choice that states it.
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

/// DOP853 on a form of the equations, and the choice that states it.
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

/// RK4 with so many steps per motion.
pub(crate) const fn rk4_method(steps: usize) -> Method {
    Method::Rk4(Rk4 { steps })
}

/// DOP853 with a share of the tolerance in each step.
pub(crate) const fn dop853_method(tolerance: f64) -> Method {
    Method::Dop853(Dop853 {
        tolerance: (LOCAL_SHARE * tolerance).max(SMALLEST_LOCAL),
        most_steps: MOST_STEPS,
    })
}

/// The integration that rolls motions which a chosen closed form or meridian does not cover; the
/// noiseless rolls had none such when the rung was chosen.
pub(crate) const RESERVE: Integration = Integration {
    method: dop853_method(MERIDIAN_ERROR),
    chart: Chart::Free,
};
