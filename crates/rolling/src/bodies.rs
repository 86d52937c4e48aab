//! Bodies of a roll: the probe, and the object on which it rolls.

use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{InvalidShape, Surface};

use crate::{Contact, RollFault};

/// Relative curvature, in units of the probe's, below which a singular motion is put down to conforming.
const NEARLY_CONFORMING: f64 = 1e-3;

/// A spherical fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    pub(crate) sphere: Sphere,
}

impl Probe {
    /// A probe of `radius`.
    ///
    /// # Errors
    /// [`InvalidShape`] unless the radius is finite and positive.
    pub fn new(radius: f64) -> Result<Self, InvalidShape> {
        Ok(Self {
            sphere: Sphere::new(radius)?,
        })
    }

    /// Its radius.
    pub const fn radius(&self) -> f64 {
        self.sphere.radius()
    }
}

/// A probe and the object on which it rolls.
#[derive(Debug)]
pub(crate) struct Bodies<'a, S> {
    pub(crate) probe: Probe,
    pub(crate) object: &'a S,
    /// The scale on which errors of position count.
    pub(crate) length_scale: f64,
}

impl<'a, S> Bodies<'a, S> {
    /// Probe on an object of another type.
    pub(crate) fn with<T>(&self, object: &'a T) -> Bodies<'a, T> {
        Bodies {
            probe: self.probe,
            object,
            length_scale: self.length_scale,
        }
    }
}

impl<S: Surface> Bodies<'_, S> {
    /// A singular motion is named by its cause: the contact speeds up without bound as the bodies
    /// come to conform.
    pub(crate) fn cause(&self, fault: RollFault, last: Result<Contact, RollFault>) -> RollFault {
        if fault == RollFault::Singular
            && let Ok(contact) = last
            && let Ok((_, curvature)) = self
                .object
                .curvature_along(&contact.on_object, &contact.x_axis)
        {
            let radius = self.probe.radius();
            let relative_curvature = 1.0 / radius + curvature.principal().k_min;
            if relative_curvature * radius < NEARLY_CONFORMING {
                return RollFault::Conforming { relative_curvature };
            }
        }
        fault
    }
}
