//! A press: the object, the indentation, and the place of the contact on the skin.

use palpate_statistics::Number;
use palpate_study::config::{PressMotionConfig, PressObjectConfig};

use palpate_study::FieldError;

/// The properties of the object that affect a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TouchedObject {
    /// 1/R_o, positive where convex.
    pub(super) curvature: f64,
    /// R_o, negative for a dish; `None` for a plane.
    pub(super) radius: Option<f64>,
}

impl TouchedObject {
    const PLANE: Self = Self {
        curvature: 0.0,
        radius: None,
    };

    fn of(config: &PressObjectConfig) -> Self {
        let round = |radius: f64| Self {
            curvature: radius.recip(),
            radius: Some(radius),
        };
        match *config {
            PressObjectConfig::Sphere { radius } => round(radius),
            PressObjectConfig::Dish { radius } => round(-radius),
            PressObjectConfig::Plane {} => Self::PLANE,
        }
    }
}

/// The true values of one press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pressed {
    pub(super) object: TouchedObject,
    pub(super) indentation: f64,
    /// Chart coordinates of the contact.
    pub(super) at: [f64; 2],
    /// Sideways displacement of the object after it touched, along x.
    pub(super) shift: f64,
}

impl Pressed {
    /// Builds the press of a config; `radius` is the sensor's.
    pub(super) fn of(
        object: &PressObjectConfig,
        motion: &PressMotionConfig,
        radius: f64,
    ) -> Result<Self, FieldError> {
        if motion.shift.abs() >= radius {
            let [radius, shift] = [radius, motion.shift].map(Number);
            let message =
                format!("|shift| must be less than the sensor's radius {radius}, is {shift}");
            return Err(FieldError::at("scene.motion.shift", message));
        }
        Ok(Self {
            object: TouchedObject::of(object),
            indentation: motion.indentation,
            at: contact_place(motion.contact_deg, radius)?,
            shift: motion.shift,
        })
    }

    /// A press of the apex on a plane.
    pub(super) const fn on_plane(indentation: f64) -> Self {
        Self {
            object: TouchedObject::PLANE,
            indentation,
            at: [0.0; 2],
            shift: 0.0,
        }
    }
}

/// Chart coordinates of a polar angle and an azimuth.
fn contact_place([polar, azimuth]: [f64; 2], radius: f64) -> Result<[f64; 2], FieldError> {
    if !(0.0..=180.0).contains(&polar) {
        let message = format!(
            "the polar angle must be from 0 to 180, is {}",
            Number(polar)
        );
        return Err(FieldError::at("scene.motion.contact_deg", message));
    }
    let distance = radius * polar.to_radians();
    let (sine, cosine) = libm::sincos(azimuth.to_radians());
    Ok([distance * cosine, distance * sine])
}
