//! The contact equations in two forms (with and without charts), and the velocity of the contact.

use nalgebra::{Point3, Vector2, Vector3};
use palpate_geometry::{CurvatureForm, TangentForm};

use crate::integrator::System;
use crate::{Contact, Motion, RollFault};

/// The form of the contact equations that an integrator solves: with or without charts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Chart {
    /// The equations in Cartesian coordinates, without charts. These equations have no singularities at the poles of a
    /// chart.
    #[default]
    Free,
    /// Montana's equations in charts of both bodies. The components of a steady motion are constant in the given frame.
    Montana(HeldAxis),
}

/// The frame in which the components of a steady motion are constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HeldAxis {
    /// The frame that is parallel-transported along the path. In this frame, the angular velocity of a steady motion is
    /// constant: the probe rotates about "a fixed axis in the instantaneous contact frame".
    #[default]
    Transported,
    /// The Gauss frame of the probe's chart, whose x axis is along a coordinate line. It rotates about the normal
    /// relative to the transported frame. Along a line of symmetry, both frames are equal.
    Chart,
}

impl Chart {
    /// Name of this form of the equations. In the names of models, it is written after the name of an integrator.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Free => "chart-free",
            Self::Montana(_) => "in charts",
        }
    }
}

pub(crate) trait ContactEquations<const N: usize>: System<N> {
    fn contact(&self, state: &[f64; N]) -> Result<Contact, RollFault>;

    /// The contact point on the object for this state. It is used in error messages that state where a roll ended.
    /// Therefore, unlike the method `contact`, it also returns a point for some invalid states.
    fn place(&self, state: &[f64; N]) -> Option<Point3<f64>>;
}

/// The velocity c of the contact point on the object, in the tangent basis `(x, y)` of `object`. In orthonormal axes, c
/// is the solution of `(K₁ + K₂) c = drive`, with the curvature forms K₁ of the probe and K₂ of the object. If the
/// probe does not slide, `drive` is the part `[−ω_y, ω_x]` of the angular velocity.
///
/// Let F be the level-set function of the object and `W = |∇F|`. The equations are multiplied by `W` along `x` and by
/// `W²` along `y`:
///
/// ```text
/// [ W/R₁ + F_xx        F_xy     ] [c_x]   [ W  drive_x ]
/// [     F_xy      W³/R₁ + F_yy  ] [c_y] = [ W² drive_y ]
/// ```
#[inline]
pub(crate) fn contact_velocity(
    probe_curvature: f64,
    object: &TangentForm,
    drive: &Vector2<f64>,
) -> Result<Vector2<f64>, RollFault> {
    let (w, ww) = (object.steepness, object.steepness_squared);
    let a11 = probe_curvature * w + object.xx;
    let a22 = probe_curvature * ww * w + object.yy;
    let a12 = object.xy;
    let determinant = a11 * a22 - a12 * a12;
    // The matrix of the contact equations must be positive definite. Therefore its determinant must be larger than the
    // rounding errors of its terms.
    let floor = 4.0 * f64::EPSILON * probe_curvature * w * (a11 * ww + a22);
    if !(a11 > 0.0 && determinant > floor) {
        return Err(conforming(probe_curvature, *object, determinant));
    }
    let (g1, g2) = (w * drive.x, ww * drive.y);
    Ok(Vector2::new(
        (a22 * g1 - a12 * g2) / determinant,
        (a11 * g2 - a12 * g1) / determinant,
    ))
}

/// The velocities of the contact point on the object and on the probe, in the contact frame.
pub(crate) fn contact_velocities(
    radius: f64,
    object: &CurvatureForm,
    motion: &Motion,
) -> Result<(Vector2<f64>, Vector2<f64>), RollFault> {
    let form = TangentForm::of_unit_normal(Vector3::z(), *object);
    let on_object = contact_velocity(1.0 / radius, &form, &motion.drive_on_object(radius))?;
    Ok((on_object, on_object - motion.sliding))
}

#[cold]
fn conforming(probe_curvature: f64, object: TangentForm, determinant: f64) -> RollFault {
    let relative_curvature = probe_curvature + object.curvature().principal().k_min;
    if determinant.is_finite() && relative_curvature.is_finite() {
        RollFault::Conforming { relative_curvature }
    } else {
        RollFault::NotFinite
    }
}
