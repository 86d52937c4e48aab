//! The ladder of rungs, and the choice of one.

use nalgebra::Matrix2;
use palpate_geometry::{Shape, Surface};

use crate::integration::{Bodies, Integration, Method};
use crate::integrator::{Dop853, Rk4};
use crate::meridian::MeridianRung;
use crate::{Chart, Choice, Contact, InvalidRoll, Model, Rolls};

/// Error bounds of the rungs that have no setting, relative to the contact's length scale.
const CLOSED_FORM_ERROR: f64 = 1e-14;
const MERIDIAN_ERROR: f64 = 1e-13;
/// The contact's error may grow over a roll; a step is held to this part of the tolerance.
const LOCAL_SHARE: f64 = 0.1;
const SMALLEST_LOCAL: f64 = 1e-15;
/// RK4 is trusted with this margin between its measured error and the tolerance.
const RK4_MARGIN: f64 = 4.0;
/// Step counts that `auto` tries for RK4.
const RK4_STEPS: [usize; 4] = [1, 2, 4, 8];
/// DOP853 gives up after this many steps, and RK4 takes no more.
const MOST_STEPS: usize = 100_000;

/// A rung of the ladder, ready to roll.
#[derive(Clone, Debug)]
pub(crate) enum Rung {
    ClosedForm { mobility: Matrix2<f64> },
    Meridian(MeridianRung),
    Integrated(Integration),
}

/// What the choice of a rung looks at.
pub(crate) struct Setting<'a> {
    pub(crate) bodies: Bodies<'a, Shape>,
    pub(crate) first: Contact,
    /// As in [`crate::closed_form::mobility`].
    pub(crate) mobility: Matrix2<f64>,
}

enum RungKind {
    ClosedForm,
    Meridian,
    Rk4,
    Dop853,
}

/// The order in which `auto` tries the rungs: cheapest first.
const LADDER: [RungKind; 4] = [
    RungKind::ClosedForm,
    RungKind::Meridian,
    RungKind::Rk4,
    RungKind::Dop853,
];

impl Setting<'_> {
    pub(crate) fn rung(
        &self,
        model: Model,
        rolls: Rolls<'_>,
    ) -> Result<(Rung, Choice), InvalidRoll> {
        let unsupported = |rung, reason| InvalidRoll::Unsupported { rung, reason };
        match model {
            Model::Auto { tolerance, chart } => LADDER
                .iter()
                .find_map(|kind| self.attempt(kind, tolerance, chart, rolls))
                .ok_or(InvalidRoll::Tolerance { tolerance }),
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
                Ok(rk4(steps, chart, "named in the config".to_owned(), None))
            }
            Model::Dop853 { tolerance, chart } => {
                Ok(dop853(tolerance, chart, "named in the config".to_owned()))
            }
        }
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
        Ok(Rung::ClosedForm {
            mobility: self.mobility,
        })
    }

    fn closed_form_choice(&self) -> Choice {
        Choice {
            rung: format!("closed form: sphere on {}", self.bodies.object.name()),
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
        MeridianRung::new(meridian, self.bodies.probe.radius())
            .map(Rung::Meridian)
            .ok_or_else(|| "the spheroid is too eccentric for the quadrature".to_owned())
    }

    fn meridian_choice(&self) -> Choice {
        Choice {
            rung: format!(
                "meridian: sphere through the apex of a {}",
                self.bodies.object.name()
            ),
            reason: "the contact runs along a line of symmetry".to_owned(),
            error_bound: Some(MERIDIAN_ERROR),
        }
    }

    /// The rung of this kind, if it can do the rolls within the tolerance.
    fn attempt(
        &self,
        kind: &RungKind,
        tolerance: f64,
        chart: Chart,
        rolls: Rolls<'_>,
    ) -> Option<(Rung, Choice)> {
        match kind {
            RungKind::ClosedForm if tolerance >= CLOSED_FORM_ERROR => {
                Some((self.closed_form(rolls).ok()?, self.closed_form_choice()))
            }
            // An axis held in the chart follows a meridian too: it is a line of symmetry.
            RungKind::Meridian if tolerance >= MERIDIAN_ERROR => {
                Some((self.meridian(rolls).ok()?, self.meridian_choice()))
            }
            RungKind::ClosedForm | RungKind::Meridian => None,
            RungKind::Rk4 => self.rk4(tolerance, chart, rolls),
            RungKind::Dop853 => {
                let reason = "no closed form, and RK4 would cost more".to_owned();
                Some(dop853(tolerance, chart, reason))
            }
        }
    }

    /// RK4 where few steps suffice, judged against a finer integration of the noiseless rolls.
    fn rk4(&self, tolerance: f64, chart: Chart, rolls: Rolls<'_>) -> Option<(Rung, Choice)> {
        if !rolls.all_run() {
            return None;
        }
        let ends = |method| self.ends(rolls, Integration { method, chart });
        let finer = (0.01 * tolerance).max(Model::SMALLEST_TOLERANCE);
        let reference = ends(dop853_method(finer))?;
        let rival = ends(dop853_method(tolerance))?;
        for steps in RK4_STEPS {
            let ends = ends(Method::Rk4(Rk4 { steps }))?;
            if ends.evaluations >= rival.evaluations {
                return None;
            }
            let error = ends
                .contacts
                .iter()
                .zip(&reference.contacts)
                .map(|(end, truth)| self.distance(end, truth))
                .fold(0.0, f64::max);
            if RK4_MARGIN * error <= tolerance {
                let reason = format!(
                    "no closed form; {steps} steps err by {error:.1e} on the noiseless rolls"
                );
                return Some(rk4(steps, chart, reason, Some(RK4_MARGIN * error)));
            }
        }
        None
    }

    /// Ends of all rolls by one integrator; `None` if any roll ends early.
    fn ends(&self, rolls: Rolls<'_>, integration: Integration) -> Option<Ends> {
        let mut ends = Ends {
            contacts: Vec::new(),
            evaluations: 0,
        };
        for roll in rolls.rolls {
            let mut contact = self.first;
            for motion in roll {
                let (next, evaluations) =
                    integration.advance(&self.bodies, &contact, motion).ok()?;
                contact = next;
                ends.evaluations += evaluations;
            }
            ends.contacts.push(contact);
        }
        Some(ends)
    }

    fn distance(&self, a: &Contact, b: &Contact) -> f64 {
        let on_object = (a.on_object - b.on_object).norm();
        let radius = self.bodies.probe.radius();
        let on_probe = (a.on_probe(radius) - b.on_probe(radius)).norm();
        on_object.max(on_probe) / self.bodies.length_scale
    }
}

struct Ends {
    contacts: Vec<Contact>,
    evaluations: usize,
}

fn rk4(steps: usize, chart: Chart, reason: String, error_bound: Option<f64>) -> (Rung, Choice) {
    let method = Method::Rk4(Rk4 { steps });
    let choice = Choice {
        rung: format!("RK4, {steps} steps{}", chart_name(chart)),
        reason,
        error_bound,
    };
    (Rung::Integrated(Integration { method, chart }), choice)
}

fn dop853(tolerance: f64, chart: Chart, reason: String) -> (Rung, Choice) {
    let method = dop853_method(tolerance);
    let choice = Choice {
        rung: format!("DOP853, tolerance {tolerance:e}{}", chart_name(chart)),
        reason,
        error_bound: Some(tolerance),
    };
    (Rung::Integrated(Integration { method, chart }), choice)
}

const fn dop853_method(tolerance: f64) -> Method {
    Method::Dop853(Dop853 {
        tolerance: (LOCAL_SHARE * tolerance).max(SMALLEST_LOCAL),
        most_steps: MOST_STEPS,
    })
}

const fn chart_name(chart: Chart) -> &'static str {
    match chart {
        Chart::Free => ", chart-free",
        Chart::Montana(_) => ", in charts",
    }
}

/// For motions that a closed form or a meridian does not cover, though the noiseless rolls asked
/// for no such motion.
pub(crate) const RESERVE: Integration = Integration {
    method: dop853_method(MERIDIAN_ERROR),
    chart: Chart::Free,
};
