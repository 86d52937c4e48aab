//! Choosing a rung of the ladder, and rolling on it.

use nalgebra::Matrix2;
use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{InvalidShape, Shape, Surface, SurfaceError};
use thiserror::Error;

use crate::chart::{ChartForm, HeldAxis};
use crate::chart_free::{ChartFree, GRAPH, SPACE, contact_velocities};
use crate::closed_form;
use crate::error::{RollError, RollFault};
use crate::integrator::{Dop853, Integrated, Rk4, Stopped, System};
use crate::meridian::MeridianRung;
use crate::{Contact, Motion, Shift};

/// A spherical fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    sphere: Sphere,
}

impl Probe {
    /// # Errors
    /// [`InvalidShape`] unless the radius is finite and positive.
    pub fn new(radius: f64) -> Result<Self, InvalidShape> {
        Ok(Self { sphere: Sphere::new(radius)? })
    }

    /// Its radius.
    pub const fn radius(&self) -> f64 {
        self.sphere.radius()
    }
}

/// Which equations an integrator works on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Chart {
    /// Chart-free: no poles.
    #[default]
    Free,
    /// Montana's chart form, with the motion steady in the given frame.
    Montana(HeldAxis),
}

/// How to obtain the truth of a roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// The cheapest rung whose error, relative to the contact's length scale, is within
    /// `tolerance`.
    Auto {
        /// At least [`Model::SMALLEST_TOLERANCE`].
        tolerance: f64,
        /// For the integrators, if one is taken.
        chart: Chart,
    },
    /// Closed form or nothing.
    ClosedForm,
    /// Meridian or nothing.
    Meridian,
    /// RK4 with this many steps per motion.
    Rk4 {
        /// At least 1.
        steps: usize,
        /// The equations.
        chart: Chart,
    },
    /// DOP853 with this tolerance.
    Dop853 {
        /// At least [`Model::SMALLEST_TOLERANCE`].
        tolerance: f64,
        /// The equations.
        chart: Chart,
    },
}

impl Model {
    /// Below this, rounding rules.
    pub const SMALLEST_TOLERANCE: f64 = 1e-14;
}

/// Error bounds of the rungs that have no setting, relative to the contact's length scale.
const CLOSED_FORM_ERROR: f64 = 1e-14;
const MERIDIAN_ERROR: f64 = 1e-13;
/// The contact's error may grow over a roll; a step is held to this part of the tolerance.
const LOCAL_SHARE: f64 = 0.1;
/// RK4 is trusted with this margin between its measured error and the tolerance.
const RK4_MARGIN: f64 = 4.0;
/// Step counts that `auto` tries for RK4.
const RK4_STEPS: [usize; 4] = [1, 2, 4, 8];
const MOST_STEPS: usize = 100_000;
/// DOP853's first step, in radians at tolerance 1; it scales with the eighth root.
const FIRST_STEP_RAD: f64 = 16.0;

/// The rung that was taken, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// `closed form`, `meridian`, `RK4`, `DOP853`, with its setting.
    pub rung: String,
    /// Why this one, in words.
    pub reason: String,
    /// Bound on the error of the contact, relative to its length scale; `None` for RK4 on demand.
    pub error_bound: Option<f64>,
}

/// What will be rolled: one or more motions in a row for each roll, without noise.
#[derive(Clone, Copy, Debug)]
pub struct Rolls<'a> {
    /// The rolls.
    pub rolls: &'a [Vec<Motion>],
}

/// A roll that cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum InvalidRoll {
    /// No first contact there.
    #[error("no first contact: {0}")]
    FirstContact(#[from] SurfaceError),
    /// The first contact is no single point.
    #[error("no rolling contact: {0}")]
    Fault(#[from] RollFault),
    /// A rung was asked for that cannot do this.
    #[error("the {rung} rung cannot do this: {reason}")]
    Unsupported {
        /// Which.
        rung: &'static str,
        /// Why not.
        reason: String,
    },
    /// A tolerance that means nothing.
    #[error("tolerance is {tolerance}; it must be from {} to 0.1", Model::SMALLEST_TOLERANCE)]
    Tolerance {
        /// Its value.
        tolerance: f64,
    },
}

#[derive(Clone, Debug)]
enum Rung {
    ClosedForm { mobility: Matrix2<f64> },
    Meridian(MeridianRung),
    Rk4 { steps: usize, chart: Chart },
    Dop853 { tolerance: f64, chart: Chart },
}

/// A probe, an object, a first contact and a rung: rolls on demand, from truth.
#[derive(Clone, Debug)]
pub struct Roller {
    probe: Probe,
    object: Shape,
    first: Contact,
    /// How far the contact moves per radian at first, at least: the scale of errors.
    length_scale: f64,
    rung: Rung,
    choice: Choice,
}

impl Roller {
    /// Sets up `rolls` of `probe` on `object`, first touching at `(x, y)`.
    ///
    /// # Errors
    /// [`InvalidRoll`] where there is no first contact, the bodies conform there, the tolerance is
    /// out of range, or a forced rung cannot do it.
    pub fn new(
        probe: Probe,
        object: Shape,
        first_contact: (f64, f64),
        model: Model,
        rolls: Rolls<'_>,
    ) -> Result<Self, InvalidRoll> {
        if let Model::Auto { tolerance, .. } | Model::Dop853 { tolerance, .. } = model
            && !(Model::SMALLEST_TOLERANCE..=0.1).contains(&tolerance)
        {
            return Err(InvalidRoll::Tolerance { tolerance });
        }
        let first = Contact::first(&object, first_contact.0, first_contact.1)?;
        let curvature = object
            .level_set(&first.on_object)?
            .curvature(&first.x_axis, &first.y_axis());
        let mobility = closed_form::mobility(probe.radius(), &curvature)?;
        let principal = curvature.principal();
        let sharpest = principal.k_min.abs().max(principal.k_max.abs());
        let setting = Setting {
            probe,
            object: &object,
            first,
            mobility,
            length_scale: 1.0 / (1.0 / probe.radius() + sharpest),
        };
        let (rung, choice) = setting.rung(model, rolls)?;
        let length_scale = setting.length_scale;
        Ok(Self { probe, object, first, length_scale, rung, choice })
    }

    /// The rung that was taken, and why.
    pub const fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The probe.
    pub const fn probe(&self) -> Probe {
        self.probe
    }

    /// The object.
    pub const fn object(&self) -> &Shape {
        &self.object
    }

    /// The first contact.
    pub const fn first_contact(&self) -> &Contact {
        &self.first
    }

    /// The contact after `motions`, one after the other, from the first contact.
    ///
    /// # Errors
    /// [`RollError`] with the time since the first motion began.
    pub fn roll(&self, motions: &[Motion]) -> Result<Contact, RollError> {
        let mut contact = self.first;
        let mut elapsed = 0.0;
        for motion in motions {
            contact = self.advance(&contact, motion).map_err(|mut error| {
                error.time_s += elapsed;
                error
            })?;
            elapsed += motion.duration_s;
        }
        Ok(contact)
    }

    /// Where `motions` bring the contact on the probe: all that EP1 needs of a roll. Cheaper than
    /// [`Roller::roll`] in closed form and along meridians.
    ///
    /// # Errors
    /// As [`Roller::roll`].
    #[inline]
    pub fn shift(&self, motions: &[Motion]) -> Result<Shift, RollError> {
        if let [motion] = motions
            && motion.angular_velocity.z == 0.0
            && motion.sliding == nalgebra::Vector2::zeros()
        {
            match &self.rung {
                Rung::ClosedForm { mobility } => {
                    let path = mobility * motion.drive() * motion.duration_s;
                    return Ok(Shift::along_great_circle(path, self.probe.radius()));
                }
                Rung::Meridian(rung) => {
                    return rung
                        .shift(motion)
                        .map_err(|fault| stopped_at(fault, 0.0, &self.first));
                }
                Rung::Rk4 { .. } | Rung::Dop853 { .. } => {}
            }
        }
        Ok(self.roll(motions)?.shift_from(&self.first, self.probe.radius()))
    }

    /// How long `motion` (its own duration is ignored) must last for the contact's path on the
    /// probe to be `arc_length` long.
    ///
    /// # Errors
    /// The [`RollError`] that ends the roll before it is that long.
    pub fn duration_for_arc(&self, motion: &Motion, arc_length: f64) -> Result<f64, RollError> {
        let speed = |contact: &Contact| -> Result<f64, RollFault> {
            let local = self.object.level_set(&contact.on_object)?;
            let curvature = local.curvature(&contact.x_axis, &contact.y_axis());
            let probe_curvature = 1.0 / self.probe.radius();
            let (_, p) =
                contact_velocities(probe_curvature, &curvature, &motion.drive(), &motion.sliding)?;
            Ok(p.norm())
        };
        let at = |fault, time_s| stopped_at(fault, time_s, &self.first);
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut duration_s = arc_length / speed(&self.first).map_err(|fault| at(fault, 0.0))?;
        if !duration_s.is_finite() {
            return Err(at(RollFault::NotFinite, 0.0));
        }
        for _ in 0..200 {
            let reached = self.roll(&[Motion { duration_s, ..*motion }]);
            let next = match reached {
                Ok(contact) => {
                    let excess = contact.arc_length - arc_length;
                    if excess > 0.0 {
                        high = duration_s;
                    } else {
                        low = duration_s;
                    }
                    let rate = speed(&contact).map_err(|fault| at(fault, duration_s))?;
                    duration_s - excess / rate
                }
                // Overshot the end of the contact: come back, unless that is where it ends.
                Err(error) if duration_s - low < 1e-9 * duration_s => return Err(error),
                Err(_) => {
                    high = duration_s;
                    0.5 * (low + high)
                }
            };
            let next = if next > low && next < high {
                next
            } else if high.is_finite() {
                0.5 * (low + high)
            } else {
                2.0 * duration_s
            };
            if (next - duration_s).abs() <= 4.0 * f64::EPSILON * duration_s {
                return Ok(next);
            }
            duration_s = next;
        }
        Ok(duration_s)
    }

    fn advance(&self, from: &Contact, motion: &Motion) -> Result<Contact, RollError> {
        let at_start = |fault| stopped_at(fault, 0.0, from);
        if !motion.is_finite() {
            return Err(at_start(RollFault::NotFinite));
        }
        if motion.duration_s <= 0.0 {
            return Ok(*from);
        }
        let contact = match &self.rung {
            Rung::ClosedForm { .. } => {
                closed_form::advance(&self.object, self.probe.radius(), from, motion)
                    .map_err(at_start)
            }
            Rung::Meridian(rung) => rung.advance(from, motion).map_err(at_start),
            Rung::Rk4 { steps, chart } => {
                self.integrate(from, motion, *chart, &Rk4 { steps: *steps }).map(|(end, _)| end)
            }
            Rung::Dop853 { tolerance, chart } => {
                let solver = dop853(*tolerance, motion, self.length_scale);
                self.integrate(from, motion, *chart, &solver).map(|(end, _)| end)
            }
        }?;
        let sum = contact.on_object.coords.sum() + contact.arc_length;
        if sum.is_finite() { Ok(contact) } else { Err(at_start(RollFault::NotFinite)) }
    }

    fn integrate(
        &self,
        from: &Contact,
        motion: &Motion,
        chart: Chart,
        solver: &impl Solver,
    ) -> Result<(Contact, usize), RollError> {
        integrate(&self.object, self.probe, self.length_scale, from, motion, chart, solver)
    }
}

fn stopped_at(fault: RollFault, time_s: f64, contact: &Contact) -> RollError {
    RollError { fault, time_s, on_object: contact.on_object }
}

fn dop853(tolerance: f64, motion: &Motion, length_scale: f64) -> Dop853 {
    let local = (LOCAL_SHARE * tolerance).max(1e-15);
    let rate = motion.angular_velocity.norm() + motion.sliding.norm() / length_scale;
    Dop853 {
        tolerance: local,
        first_step_s: FIRST_STEP_RAD * local.powf(0.125) / rate.max(f64::MIN_POSITIVE),
        most_steps: MOST_STEPS,
    }
}

/// Either integrator, for systems of any size.
trait Solver {
    fn solve<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>>;
}

impl Solver for Rk4 {
    #[inline]
    fn solve<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        self.integrate(system, state, duration_s)
    }
}

impl Solver for Dop853 {
    #[inline]
    fn solve<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        self.integrate(system, state, duration_s)
    }
}

/// One motion by an integrator; also how often it asked for the derivative.
fn integrate(
    object: &Shape,
    probe: Probe,
    length_scale: f64,
    from: &Contact,
    motion: &Motion,
    chart: Chart,
    solver: &impl Solver,
) -> Result<(Contact, usize), RollError> {
    let radius = probe.radius();
    let error = |fault, time_s| stopped_at(fault, time_s, from);
    match chart {
        Chart::Free => match object {
            Shape::Sphere(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Dish(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Plane(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Cylinder(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Ellipsoid(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Torus(surface) => free::<_, SPACE>(surface, radius, length_scale, from, motion, solver),
            Shape::Paraboloid(surface) => free::<_, GRAPH>(surface, radius, length_scale, from, motion, solver),
            Shape::Saddle(surface) => free::<_, GRAPH>(surface, radius, length_scale, from, motion, solver),
            Shape::HeightField(surface) => free::<_, GRAPH>(surface, radius, length_scale, from, motion, solver),
        },
        Chart::Montana(held) => {
            let (system, state) =
                ChartForm::new(object, probe.sphere, from, motion, held, length_scale)
                    .map_err(|fault| error(fault, 0.0))?;
            let end = solver.solve(&system, state, motion.duration_s).map_err(|stopped| {
                match system.contact(&stopped.state) {
                    Ok(contact) => ended(object, radius, &stopped, &contact),
                    Err(_) => error(stopped.fault, stopped.time_s),
                }
            })?;
            let contact = system
                .contact(&end.state)
                .map_err(|fault| error(fault, motion.duration_s))?;
            Ok((contact, end.evaluations))
        }
    }
}

fn free<S: Surface, const READ: usize>(
    object: &S,
    radius: f64,
    length_scale: f64,
    from: &Contact,
    motion: &Motion,
    solver: &impl Solver,
) -> Result<(Contact, usize), RollError> {
    let error = |fault, time_s| stopped_at(fault, time_s, from);
    let system = ChartFree::<S, READ>::new(object, radius, motion, length_scale);
    let end = solver
        .solve(&system, ChartFree::<S, READ>::state(from), motion.duration_s)
        .map_err(|stopped| match system.contact(&stopped.state) {
            Ok(contact) => ended(object, radius, &stopped, &contact),
            Err(_) => error(stopped.fault, stopped.time_s),
        })?;
    let contact = system
        .contact(&end.state)
        .map_err(|fault| error(fault, motion.duration_s))?;
    Ok((contact, end.evaluations))
}

/// The error of an integration that stopped at `contact`. A singular motion is named by its cause:
/// the contact speeds up without bound as the bodies come to conform.
fn ended<const N: usize>(
    object: &impl Surface,
    radius: f64,
    stopped: &Stopped<N>,
    contact: &Contact,
) -> RollError {
    let mut fault = stopped.fault;
    if fault == RollFault::Singular
        && let Ok(local) = object.level_set(&contact.on_object)
    {
        let curvature = local.curvature(&contact.x_axis, &contact.y_axis());
        let relative_curvature = 1.0 / radius + curvature.principal().k_min;
        if relative_curvature * radius < 1e-3 {
            fault = RollFault::Conforming { relative_curvature };
        }
    }
    stopped_at(fault, stopped.time_s, contact)
}

/// What the choice of a rung looks at.
struct Setting<'a> {
    probe: Probe,
    object: &'a Shape,
    first: Contact,
    mobility: Matrix2<f64>,
    length_scale: f64,
}

enum RungKind {
    ClosedForm,
    Meridian,
    Rk4,
    Dop853,
}

/// The order in which `auto` tries the rungs: cheapest first.
const LADDER: [RungKind; 4] =
    [RungKind::ClosedForm, RungKind::Meridian, RungKind::Rk4, RungKind::Dop853];

impl Setting<'_> {
    fn rung(&self, model: Model, rolls: Rolls<'_>) -> Result<(Rung, Choice), InvalidRoll> {
        let unsupported = |rung, reason| InvalidRoll::Unsupported { rung, reason };
        match model {
            Model::Auto { tolerance, chart } => LADDER
                .iter()
                .find_map(|kind| self.attempt(kind, tolerance, chart, rolls))
                .ok_or(InvalidRoll::Tolerance { tolerance }),
            Model::ClosedForm => {
                let rung = self.closed_form(rolls).map_err(|why| unsupported("closed form", why))?;
                Ok((rung, self.closed_form_choice()))
            }
            Model::Meridian => {
                let rung = self.meridian(rolls).map_err(|why| unsupported("meridian", why))?;
                Ok((rung, self.meridian_choice()))
            }
            Model::Rk4 { steps, chart } => {
                let rung = format!("RK4, {steps} steps{}", chart_name(chart));
                let reason = "named in the config".to_owned();
                let choice = Choice { rung, reason, error_bound: None };
                Ok((Rung::Rk4 { steps, chart }, choice))
            }
            Model::Dop853 { tolerance, chart } => {
                let reason = "named in the config".to_owned();
                Ok((Rung::Dop853 { tolerance, chart }, dop853_choice(tolerance, chart, reason)))
            }
        }
    }

    fn closed_form(&self, rolls: Rolls<'_>) -> Result<Rung, String> {
        if !self.object.is_homogeneous() {
            return Err(format!("a {} has no closed form", self.object.name()));
        }
        if rolls.spin() {
            return Err("the motion spins".to_owned());
        }
        Ok(Rung::ClosedForm { mobility: self.mobility })
    }

    fn closed_form_choice(&self) -> Choice {
        Choice {
            rung: format!("closed form: sphere on {}", self.object.name()),
            reason: "the contact runs along geodesics of both bodies".to_owned(),
            error_bound: Some(CLOSED_FORM_ERROR),
        }
    }

    fn meridian(&self, rolls: Rolls<'_>) -> Result<Rung, String> {
        let meridian = self.object.meridian(&self.first.on_object).ok_or_else(|| {
            "the first contact is not the apex of a surface of revolution".to_owned()
        })?;
        if rolls.spin() || rolls.slides() {
            return Err("the motion spins or slides".to_owned());
        }
        if rolls.in_pieces() {
            return Err("the motion changes on the way".to_owned());
        }
        MeridianRung::new(meridian, self.probe.radius())
            .map_err(|fault| fault.to_string())?
            .map(Rung::Meridian)
            .ok_or_else(|| "the spheroid is too eccentric for the quadrature".to_owned())
    }

    fn meridian_choice(&self) -> Choice {
        Choice {
            rung: format!("meridian: sphere through the apex of a {}", self.object.name()),
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
                let choice = dop853_choice(tolerance, chart, reason);
                Some((Rung::Dop853 { tolerance, chart }, choice))
            }
        }
    }

    /// RK4 where few steps suffice, judged against a finer integration of the noiseless rolls.
    fn rk4(&self, tolerance: f64, chart: Chart, rolls: Rolls<'_>) -> Option<(Rung, Choice)> {
        let reference_tolerance = (0.01 * tolerance).max(Model::SMALLEST_TOLERANCE);
        let reference = self.ends(rolls, chart, |motion| {
            dop853(reference_tolerance, motion, self.length_scale)
        })?;
        let rival = self.ends(rolls, chart, |motion| dop853(tolerance, motion, self.length_scale))?;
        for steps in RK4_STEPS {
            let ends = self.ends(rolls, chart, |_| Rk4 { steps })?;
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
                let choice = Choice {
                    rung: format!("RK4, {steps} steps{}", chart_name(chart)),
                    reason: format!(
                        "no closed form; {steps} steps err by {error:.1e} on the noiseless rolls"
                    ),
                    error_bound: Some(RK4_MARGIN * error),
                };
                return Some((Rung::Rk4 { steps, chart }, choice));
            }
        }
        None
    }

    /// Ends of all rolls by one integrator; `None` if any roll ends early.
    fn ends<T: Solver>(
        &self,
        rolls: Rolls<'_>,
        chart: Chart,
        solver: impl Fn(&Motion) -> T,
    ) -> Option<Ends> {
        let mut ends = Ends { contacts: Vec::new(), evaluations: 0 };
        for roll in rolls.rolls {
            let mut contact = self.first;
            for motion in roll {
                let (next, evaluations) = integrate(
                    self.object,
                    self.probe,
                    self.length_scale,
                    &contact,
                    motion,
                    chart,
                    &solver(motion),
                )
                .ok()?;
                contact = next;
                ends.evaluations += evaluations;
            }
            ends.contacts.push(contact);
        }
        Some(ends)
    }

    fn distance(&self, a: &Contact, b: &Contact) -> f64 {
        let on_object = (a.on_object - b.on_object).norm();
        let radius = self.probe.radius();
        let on_probe = (a.on_probe(radius) - b.on_probe(radius)).norm();
        on_object.max(on_probe) / self.length_scale
    }
}

struct Ends {
    contacts: Vec<Contact>,
    evaluations: usize,
}

fn dop853_choice(tolerance: f64, chart: Chart, reason: String) -> Choice {
    Choice {
        rung: format!("DOP853, tolerance {tolerance:e}{}", chart_name(chart)),
        reason,
        error_bound: Some(tolerance),
    }
}

fn chart_name(chart: Chart) -> &'static str {
    match chart {
        Chart::Free => ", chart-free",
        Chart::Montana(_) => ", in charts",
    }
}

impl Rolls<'_> {
    fn motions(&self) -> impl Iterator<Item = &Motion> {
        self.rolls.iter().flatten()
    }

    fn spin(&self) -> bool {
        self.motions().any(|motion| motion.angular_velocity.z != 0.0)
    }

    fn slides(&self) -> bool {
        self.motions().any(|motion| motion.sliding != nalgebra::Vector2::zeros())
    }

    fn in_pieces(&self) -> bool {
        self.rolls.iter().any(|roll| roll.len() > 1)
    }
}
