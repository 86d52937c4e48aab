//! Montana's contact equations in charts.
//!
//! The index 1 is the probe, and 2 is the object. Each body has chart parameters `u`, a metric `M`, a curvature form
//! `K` and a torsion form `T`. The contact angle is `ψ`, and `R_ψ` converts vectors between the frames of the two
//! bodies. The probe turns with the angular velocity `ω` and slides with the velocity `v`:
//!
//! ```text
//! u̇₁ = M₁⁻¹ (K₁ + K̃₂)⁻¹ ([−ω_y, ω_x]ᵀ − K̃₂ v)
//! u̇₂ = M₂⁻¹ R_ψ (K₁ + K̃₂)⁻¹ ([−ω_y, ω_x]ᵀ + K₁ v)
//! ψ̇  = ω_z + T₁ M₁ u̇₁ + T₂ M₂ u̇₂ ,      K̃₂ = R_ψ K₂ R_ψ
//! ```
//!
//! A chart has no poles on its equator. Therefore the probe's chart is placed so that the contact starts at the centre
//! of the chart and first moves along its equator.

use nalgebra::{Matrix2, Matrix3, Point3, Rotation2, Rotation3, UnitQuaternion, Vector2, Vector3};
use palpate_geometry::{ChartGeometry, CurvatureForm, Parameters, Sphere, Surface, TangentForm};

use crate::contact_equations::{ContactEquations, contact_velocity};
use crate::error::RollFault;
use crate::integrator::System;
use crate::roller::Bodies;
use crate::{Contact, HeldAxis, Motion};

/// Number of state components: the chart parameters `u₁, v₁` on the probe and `u₂, v₂` on the object, the contact angle
/// ψ, an angle φ, and the arc length of the path. φ is the angle from the probe's Gauss frame to the frame in which the
/// components of the probe's motion are constant. The x axis of the Gauss frame is along a coordinate line of the
/// chart.
pub(crate) const STATE: usize = 7;

pub(crate) struct ChartForm<'a, S> {
    probe: Sphere,
    object: &'a S,
    motion: &'a Motion,
    held: HeldAxis,
    body_from_chart: Rotation3<f64>,
    weights: [f64; STATE],
}

impl<'a, S: Surface> ChartForm<'a, S> {
    /// Returns the contact equations for `motion`, and their state at the start of the motion. The motion starts at the
    /// contact `from`.
    pub(crate) fn new(
        bodies: &Bodies<'a, S>,
        from: &Contact,
        motion: &'a Motion,
        held: HeldAxis,
    ) -> Result<(Self, [f64; STATE]), RollFault> {
        let path = motion.drive();
        let path = path.try_normalize(0.0).unwrap_or_else(Vector2::x);
        // Axes of the probe's chart in the contact frame. The y axis is along the path, and the z axis points out of
        // the probe.
        let chart_axes = Matrix3::from_columns(&[
            Vector3::new(path.y, -path.x, 0.0),
            Vector3::new(path.x, path.y, 0.0),
            Vector3::z(),
        ]);
        let body_from_chart = from.body_from_contact.to_rotation_matrix()
            * Rotation3::from_matrix_unchecked(chart_axes);

        let object_at = bodies.object.parameters(&from.on_object);
        let object = bodies.object.chart_geometry(object_at)?;
        let x1 = from.x_axis * path.y - from.y_axis() * path.x;
        let psi = libm::atan2(-x1.dot(&object.y_axis), x1.dot(&object.x_axis));
        let phi = libm::atan2(path.x, path.y);

        let state = [
            0.0,
            0.0,
            object_at.u,
            object_at.v,
            psi,
            phi,
            from.arc_length,
        ];
        let scale = 1.0 / bodies.length_scale;
        let on_probe = bodies.probe.radius() * scale;
        let weights = [
            on_probe,
            on_probe,
            object.metric[(0, 0)] * scale,
            libm::hypot(object.metric[(0, 1)], object.metric[(1, 1)]) * scale,
            1.0,
            1.0,
            scale,
        ];
        let form = Self {
            probe: bodies.probe,
            object: bodies.object,
            motion,
            held,
            body_from_chart,
            weights,
        };
        Ok((form, state))
    }
}

impl<S: Surface> ContactEquations<STATE> for ChartForm<'_, S> {
    fn contact(&self, state: &[f64; STATE]) -> Result<Contact, RollFault> {
        let [u1, v1, u2, v2, psi, phi, arc_length] = *state;
        let probe = self.probe.chart_geometry(Parameters::new(u1, v1))?;
        let object = self.object.chart_geometry(Parameters::new(u2, v2))?;
        let (x2, y2) = (object.x_axis, object.y_axis);
        let (sin, cos) = libm::sincos(psi);
        let (x1, y1) = (x2 * cos - y2 * sin, -x2 * sin - y2 * cos);
        let (sin, cos) = libm::sincos(phi);
        let in_chart = Matrix3::from_columns(&[
            probe.x_axis * cos + probe.y_axis * sin,
            probe.y_axis * cos - probe.x_axis * sin,
            probe.normal,
        ]);
        let body_from_contact = self.body_from_chart * Rotation3::from_matrix_unchecked(in_chart);
        Ok(Contact {
            on_object: object.point,
            normal: object.normal,
            x_axis: x1 * cos + y1 * sin,
            body_from_contact: UnitQuaternion::from_rotation_matrix(&body_from_contact),
            arc_length,
        })
    }

    fn place(&self, state: &[f64; STATE]) -> Option<Point3<f64>> {
        let at = Parameters::new(state[2], state[3]);
        Some(self.object.chart(at).ok()?.point)
    }
}

/// Rates of the chart parameters of a point that moves with `velocity` in the Gauss frame: `M⁻¹` times `velocity`,
/// where `M` is the upper triangular metric of the chart.
fn parameter_rate(geometry: &ChartGeometry, velocity: &Vector2<f64>) -> Vector2<f64> {
    let m = &geometry.metric;
    let v = velocity.y / m[(1, 1)];
    Vector2::new((velocity.x - m[(0, 1)] * v) / m[(0, 0)], v)
}

impl<S: Surface> System<STATE> for ChartForm<'_, S> {
    fn derivative(&self, state: &[f64; STATE], rate: &mut [f64; STATE]) -> Result<(), RollFault> {
        let [u1, v1, u2, v2, psi, phi, _] = *state;
        let probe = self.probe.chart_geometry(Parameters::new(u1, v1))?;
        let object = self.object.chart_geometry(Parameters::new(u2, v2))?;
        // Seen from the probe, the object's normal points in the opposite direction, and its axes are rotated by the
        // contact angle ψ.
        let (sin, cos) = libm::sincos(psi);
        let reflection = Matrix2::new(cos, -sin, -sin, -cos);
        let form = reflection * object.curvature.matrix() * reflection;
        let object_curvature = CurvatureForm {
            k_uu: form[(0, 0)],
            k_uv: 0.5 * (form[(0, 1)] + form[(1, 0)]),
            k_vv: form[(1, 1)],
        };
        let into_gauss = Rotation2::new(phi);
        let c = contact_velocity(
            1.0 / self.probe.radius(),
            &TangentForm::of_unit_normal(Vector3::z(), object_curvature),
            &(into_gauss * self.motion.drive_on_object(self.probe.radius())),
        )?;
        let p = c - into_gauss * self.motion.sliding;
        let on_object = reflection * c;
        let rate1 = parameter_rate(&probe, &p);
        let rate2 = parameter_rate(&object, &on_object);
        let probe_twist = (probe.torsion * p).x;
        let object_twist = (object.torsion * on_object).x;
        *rate = [
            rate1.x,
            rate1.y,
            rate2.x,
            rate2.y,
            self.motion.angular_velocity.z + probe_twist + object_twist,
            match self.held {
                HeldAxis::Transported => -probe_twist,
                HeldAxis::Chart => 0.0,
            },
            p.norm(),
        ];
        Ok(())
    }

    fn error_weights(&self) -> [f64; STATE] {
        self.weights
    }
}
