//! The rolling probe: the bodies in contact, and the [`Roller`] that computes their contact.

use nalgebra::Matrix2;
use palpate_geometry::{Shape, Sphere, Surface};

use crate::closed_form::ClosedForm;
use crate::contact_equations::contact_velocities;
use crate::ladder::{FALLBACK, Rung, Setting};
use crate::{Choice, Contact, InvalidRoll, Model, Motion, RollError, RollFault, Rolls, Shift};

/// Limit for the relative curvature, divided by the probe's curvature. If a motion is singular and the smallest
/// relative curvature is below this limit, the reported error is [`RollFault::Conforming`]: the bodies touch along a
/// line or an area.
const CONFORMING_CURVATURE: f64 = 1e-3;

#[derive(Debug)]
pub(crate) struct Bodies<'a, S> {
    pub(crate) probe: Sphere,
    pub(crate) object: &'a S,
    /// Length scale of the contact: the smallest displacement of the contact per radian of rolling at the start. Errors
    /// of positions are relative to this length.
    pub(crate) length_scale: f64,
}

impl<'a, S> Bodies<'a, S> {
    /// The same probe and length scale with `object`, which may be of another Rust type than the previous object.
    pub(crate) fn with<T>(&self, object: &'a T) -> Bodies<'a, T> {
        Bodies {
            probe: self.probe,
            object,
            length_scale: self.length_scale,
        }
    }
}

impl<S: Surface> Bodies<'_, S> {
    /// Replaces `fault` by its cause, if the cause can be found. If the bodies conform, the contact moves infinitely
    /// fast, so the integrator reports a singular motion. The cause is then [`RollFault::Conforming`].
    pub(crate) fn cause(&self, fault: RollFault, last: Result<Contact, RollFault>) -> RollFault {
        if fault == RollFault::Singular
            && let Ok(contact) = last
            && let Ok((_, curvature)) = self
                .object
                .curvature_along(&contact.on_object, &contact.x_axis)
        {
            let radius = self.probe.radius();
            let relative_curvature = 1.0 / radius + curvature.principal().k_min;
            if relative_curvature * radius < CONFORMING_CURVATURE {
                return RollFault::Conforming { relative_curvature };
            }
        }
        fault
    }
}

/// A probe on an object, with a first contact and the model that computes its rolls.
///
/// ```
/// use palpate_geometry::{Shape, Sphere};
/// use palpate_rolling::{Model, Motion, Roller, Rolls};
///
/// // A probe of radius 1 rolls by 0.1 rad along x on a ball of radius 3.
/// let rolls = [vec![Motion::rolling(0.0, 0.1, 1.0)]];
/// let (probe, ball) = (Sphere::new(1.0)?, Shape::Sphere(Sphere::new(3.0)?));
/// let roller = Roller::new(probe, ball, (0.0, 0.0), Model::ClosedForm, Rolls::exact(&rolls))?;
/// // The contact moves by the angle divided by the relative curvature, 1/1 + 1/3.
/// let shift = roller.shift(&rolls[0])?;
/// assert!((shift.displacement.x - 0.075).abs() < 1e-15);
/// assert!(shift.displacement.y.abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Roller {
    probe: Sphere,
    object: Shape,
    first: Contact,
    /// Smallest displacement of the contact per radian of rolling at the first contact (length). Errors of the contact
    /// are relative to it.
    length_scale: f64,
    closed_form: ClosedForm,
    rung: Rung,
    choice: Choice,
}

impl Roller {
    /// A roller with `probe` on `object` and with the first contact at `(x, y)`. Its model is chosen for the `rolls`
    /// without noise.
    ///
    /// # Errors
    /// [`InvalidRoll`] if there is no first contact, if the bodies conform there, or if the tolerance is out of range.
    /// It is also an error if the model that the user has set cannot compute the rolls.
    pub fn new(
        probe: Sphere,
        object: Shape,
        first_contact: (f64, f64),
        model: Model,
        rolls: Rolls<'_>,
    ) -> Result<Self, InvalidRoll> {
        let first = Contact::first(&object, first_contact.0, first_contact.1)?;
        let (_, curvature) = object.curvature_along(&first.on_object, &first.x_axis)?;
        let closed_form = ClosedForm::new(probe.radius(), &curvature)?;
        let principal = curvature.principal();
        let sharpest = principal.k_min.abs().max(principal.k_max.abs());
        let length_scale = 1.0 / (1.0 / probe.radius() + sharpest);
        let bodies = Bodies {
            probe,
            object: &object,
            length_scale,
        };
        let setting = Setting {
            bodies,
            first,
            closed_form,
        };
        let (rung, choice) = setting.rung(model, rolls)?;
        Ok(Self {
            probe,
            object,
            first,
            length_scale,
            closed_form,
            rung,
            choice,
        })
    }

    /// A roller with the same probe, object and first contact, but with `model`.
    ///
    /// # Errors
    /// [`InvalidRoll`] if the tolerance is out of range, or if the model cannot compute the rolls.
    pub fn on(&self, model: Model, rolls: Rolls<'_>) -> Result<Self, InvalidRoll> {
        let (rung, choice) = self.setting().rung(model, rolls)?;
        Ok(Self {
            rung,
            choice,
            object: self.object.clone(),
            ..*self
        })
    }

    /// The chosen model of this roller, and the reason for the choice.
    pub const fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The probe that rolls.
    pub const fn probe(&self) -> Sphere {
        self.probe
    }

    /// The object on which the probe rolls.
    pub const fn object(&self) -> &Shape {
        &self.object
    }

    /// The contact at the start of each roll.
    pub const fn first_contact(&self) -> &Contact {
        &self.first
    }

    /// The contact after all `motions` in sequence. The roll begins at the roller's first contact.
    ///
    /// # Errors
    /// [`RollError`], whose time is measured from the start of the first motion.
    pub fn roll(&self, motions: &[Motion]) -> Result<Contact, RollError> {
        self.follow(motions).map(|(contact, _)| contact)
    }

    /// The last contact, as from [`Roller::roll`], and the number of evaluations of the contact equations.
    pub(crate) fn follow(&self, motions: &[Motion]) -> Result<(Contact, usize), RollError> {
        let mut contact = self.first;
        let mut evaluations = 0;
        let mut elapsed = 0.0;
        for motion in motions {
            let (next, more) = self.advance(&contact, motion).map_err(|error| RollError {
                time_s: error.time_s + elapsed,
                ..error
            })?;
            contact = next;
            evaluations += more;
            elapsed += motion.duration_s.max(0.0);
        }
        Ok((contact, evaluations))
    }

    /// Displacement of the contact on the probe after all `motions` in sequence. With the models `closed form` and
    /// `meridian`, this method is faster than [`Roller::roll`].
    ///
    /// # Errors
    /// Errors of [`Roller::roll`].
    #[inline]
    pub fn shift(&self, motions: &[Motion]) -> Result<Shift, RollError> {
        if let [motion] = motions
            && motion.duration_s > 0.0
            && !motion.spins()
            && !motion.slides()
        {
            let quick = match &self.rung {
                Rung::ClosedForm(closed_form) => {
                    let path = closed_form.mobility * motion.drive() * motion.duration_s;
                    Some(Shift::along_great_circle(path, self.probe.radius()))
                }
                Rung::Meridian(rung) => rung
                    .section(motion)
                    .and_then(|section| rung.shift(section, motion)),
                Rung::Integrated(_) => None,
            };
            if let Some(shift) = quick
                && shift.arc_length.is_finite()
            {
                palpate_statistics::work::rolled(1);
                return Ok(shift);
            }
        }
        Ok(self
            .roll(motions)?
            .shift_from(&self.first, self.probe.radius()))
    }

    /// Matrix (length/rad) for a steady roll without spin or sliding. Its product with the rotation `[−Δθ_y, Δθ_x]` is
    /// the contact's path on the probe. `None` for all models except the closed form: with other models, the path is
    /// not a linear function of the rotation.
    pub const fn linear(&self) -> Option<&Matrix2<f64>> {
        match &self.rung {
            Rung::ClosedForm(closed_form) => Some(&closed_form.mobility),
            Rung::Meridian(_) | Rung::Integrated(_) => None,
        }
    }

    /// Duration (s) of `motion` after which the contact's path on the probe has the length `arc_length`. The duration
    /// that `motion` states is ignored. If the model is the closed form, the relative error is at most 1e-14.
    ///
    /// # Errors
    /// The [`RollError`] that ends the roll before the path has this length.
    pub fn duration_for_arc(&self, motion: &Motion, arc_length: f64) -> Result<f64, RollError> {
        let speed = |contact: &Contact| -> Result<f64, RollFault> {
            let (_, curvature) = self
                .object
                .curvature_along(&contact.on_object, &contact.x_axis)?;
            let (_, p) = contact_velocities(self.probe.radius(), &curvature, motion)?;
            Ok(p.norm())
        };
        let at = |fault, time_s| RollError::new(fault, time_s, self.first.on_object);
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut duration_s = arc_length / speed(&self.first).map_err(|fault| at(fault, 0.0))?;
        if !(arc_length >= 0.0 && duration_s.is_finite() && (duration_s > 0.0 || arc_length == 0.0))
        {
            return Err(at(RollFault::NotFinite, 0.0));
        }
        for _ in 0..200 {
            let reached = self.roll(&[motion.lasting(duration_s)]);
            let next = match reached {
                // The path is so short that its squared length underflows to zero, and the first estimate of the
                // duration is exact.
                Ok(contact) if contact.arc_length == 0.0 => return Ok(duration_s),
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
                // If a roll needs too many steps, other durations would fail too.
                Err(error) if matches!(error.fault, RollFault::TooManySteps { .. }) => {
                    return Err(error);
                }
                // The roll ends before `duration_s`. If the end is already located with a relative accuracy of 1e-9,
                // return `Err`. Otherwise, try a shorter duration.
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

    pub(crate) fn advance(
        &self,
        from: &Contact,
        motion: &Motion,
    ) -> Result<(Contact, usize), RollError> {
        let at_start = |fault| RollError::new(fault, 0.0, from.on_object);
        if !motion.is_finite() {
            return Err(at_start(RollFault::NotFinite));
        }
        if motion.duration_s <= 0.0 {
            return Ok((*from, 0));
        }
        palpate_statistics::work::rolled(1);
        let (contact, evaluations) = match &self.rung {
            Rung::ClosedForm(closed_form) if !motion.spins() => {
                (closed_form.advance(self.probe.radius(), from, motion), 0)
            }
            Rung::Integrated(integration) => integration.advance(&self.bodies(), from, motion)?,
            Rung::ClosedForm(_) => FALLBACK.advance(&self.bodies(), from, motion)?,
            Rung::Meridian(rung) => {
                let is_along = *from == self.first && !motion.spins() && !motion.slides();
                let section = rung.section(motion).filter(|_| is_along);
                match section.and_then(|section| rung.advance(section, from, motion)) {
                    Some(contact) => (contact, 0),
                    None => FALLBACK.advance(&self.bodies(), from, motion)?,
                }
            }
        };
        if contact.is_finite() {
            Ok((contact, evaluations))
        } else {
            Err(at_start(RollFault::NotFinite))
        }
    }

    pub(crate) const fn rung(&self) -> &Rung {
        &self.rung
    }

    pub(crate) fn setting(&self) -> Setting<'_> {
        Setting {
            bodies: self.bodies(),
            first: self.first,
            closed_form: self.closed_form,
        }
    }

    const fn bodies(&self) -> Bodies<'_, Shape> {
        Bodies {
            probe: self.probe,
            object: &self.object,
            length_scale: self.length_scale,
        }
    }
}
