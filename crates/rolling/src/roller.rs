//! A probe that rolls on an object.

use nalgebra::Matrix2;
use palpate_geometry::{Shape, Surface};

use crate::bodies::Bodies;
use crate::chart_free::contact_velocities;
use crate::closed_form::ClosedForm;
use crate::rung::{RESERVE, Rung, Setting};
use crate::{
    Choice, Contact, InvalidRoll, Model, Motion, Probe, RollError, RollFault, Rolls, Shift,
};

/// A probe on an object, with a first contact and the rung by which its noiseless rolls are computed.
///
/// ```
/// use palpate_geometry::{Shape, surfaces::Sphere};
/// use palpate_rolling::{Model, Motion, Probe, Roller, Rolls};
///
/// // A probe of radius 1 rolls by 0.1 rad along x on a ball of radius 3.
/// let rolls = [vec![Motion::rolling(0.0, 0.1, 1.0)]];
/// let (probe, ball) = (Probe::new(1.0)?, Shape::Sphere(Sphere::new(3.0)?));
/// let roller = Roller::new(probe, ball, (0.0, 0.0), Model::ClosedForm, Rolls { rolls: &rolls })?;
/// // The contact moves by the angle over the relative curvature, 1/1 + 1/3.
/// let shift = roller.shift(&rolls[0])?;
/// assert!((shift.displacement.x - 0.075).abs() < 1e-15);
/// assert!(shift.displacement.y.abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Roller {
    probe: Probe,
    object: Shape,
    first: Contact,
    /// Smallest distance that the contact moves per radian at first, length: the scale on which errors of the contact
    /// are counted.
    length_scale: f64,
    closed_form: ClosedForm,
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

    /// A roller with this probe, object and first contact on the rung of `model`.
    ///
    /// # Errors
    /// [`InvalidRoll`] where the tolerance is out of range, or the rung cannot do it.
    pub fn on(&self, model: Model, rolls: Rolls<'_>) -> Result<Self, InvalidRoll> {
        let (rung, choice) = self.setting().rung(model, rolls)?;
        Ok(Self {
            rung,
            choice,
            object: self.object.clone(),
            ..*self
        })
    }

    /// The rung that was taken, and the reason for it.
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
        self.follow(motions).map(|(contact, _)| contact)
    }

    /// [`Roller::roll`]; also how often the contact equations were evaluated.
    pub(crate) fn follow(&self, motions: &[Motion]) -> Result<(Contact, usize), RollError> {
        let mut contact = self.first;
        let mut evaluations = 0;
        let mut elapsed = 0.0;
        for motion in motions {
            let (next, more) = self.advance(&contact, motion).map_err(|mut error| {
                error.time_s += elapsed;
                error
            })?;
            contact = next;
            evaluations += more;
            elapsed += motion.duration_s.max(0.0);
        }
        Ok((contact, evaluations))
    }

    /// Displacement of the contact on the probe by `motions`, which is all that EP1 needs of a roll. Cheaper
    /// than [`Roller::roll`] in closed form and along meridians.
    ///
    /// # Errors
    /// As [`Roller::roll`].
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
                Rung::Meridian(rung) => Some(
                    rung.shift(motion)
                        .map_err(|fault| RollError::new(fault, 0.0, self.first.on_object))?,
                ),
                Rung::Integrated(_) => None,
            };
            if let Some(shift) = quick
                && shift.arc_length.is_finite()
            {
                return Ok(shift);
            }
        }
        Ok(self
            .roll(motions)?
            .shift_from(&self.first, self.probe.radius()))
    }

    /// The matrix that takes `[−Δθ_y, Δθ_x]` (rad) of a steady roll without spin or sliding to the
    /// contact's path on the probe (length), if the rung is the closed form, where that is linear.
    pub const fn linear(&self) -> Option<&Matrix2<f64>> {
        match &self.rung {
            Rung::ClosedForm(closed_form) => Some(&closed_form.mobility),
            Rung::Meridian(_) | Rung::Integrated(_) => None,
        }
    }

    /// Duration (s) for which `motion`, whose own duration is ignored, must last for the contact's path on
    /// the probe to be `arc_length` long, within 1e-14 of itself where rolls are exact.
    ///
    /// # Errors
    /// The [`RollError`] that ends the roll before it is that long.
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
            let reached = self.roll(&[Motion {
                duration_s,
                ..*motion
            }]);
            let next = match reached {
                // Too short a path to be squared: the first estimate is exact.
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
                // A roll too long to follow does not get easier by trying others.
                Err(error) if matches!(error.fault, RollFault::TooManySteps { .. }) => {
                    return Err(error);
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

    fn advance(&self, from: &Contact, motion: &Motion) -> Result<(Contact, usize), RollError> {
        let at_start = |fault| RollError::new(fault, 0.0, from.on_object);
        if !motion.is_finite() {
            return Err(at_start(RollFault::NotFinite));
        }
        if motion.duration_s <= 0.0 {
            return Ok((*from, 0));
        }
        let (contact, evaluations) = match &self.rung {
            Rung::ClosedForm(closed_form) if !motion.spins() => {
                (closed_form.advance(self.probe.radius(), from, motion), 0)
            }
            Rung::Meridian(rung) if *from == self.first && !motion.spins() && !motion.slides() => {
                (rung.advance(from, motion).map_err(at_start)?, 0)
            }
            Rung::Integrated(integration) => integration.advance(&self.bodies(), from, motion)?,
            Rung::ClosedForm(_) | Rung::Meridian(_) => {
                RESERVE.advance(&self.bodies(), from, motion)?
            }
        };
        if contact.is_finite() {
            Ok((contact, evaluations))
        } else {
            Err(at_start(RollFault::NotFinite))
        }
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
