//! Rolling through the apex of a surface of revolution.
//!
//! The contact runs along a meridian of the object and a great circle of the probe. With α the
//! angle by which the object's normal has turned and s the arc length, the probe has turned by
//! `θ = α + s/R₁`, which is solved for the meridian's parameter.

use gauss_quad::GaussLegendre;
use nalgebra::{UnitQuaternion, Vector2};
use palpate_geometry::Meridian;

use crate::closed_form::roll_on_probe;
use crate::error::RollFault;
use crate::{Contact, Motion, Shift};

/// Spheroids flatter or longer than this are left to the integrators: the quadrature would need
/// more nodes than it is worth.
const LARGEST_ASPECT: f64 = 8.0;
/// Nodes per eighth of a meridian; with the aspect bounded this is exact to rounding.
const NODES: usize = 24;

#[derive(Clone, Debug)]
pub(crate) struct MeridianRung {
    meridian: Meridian,
    radius: f64,
    /// Nodes and weights on [0, 1], for meridians without a closed arc length.
    quadrature: Vec<(f64, f64)>,
}

impl MeridianRung {
    /// `None` where the meridian is too eccentric.
    ///
    /// # Errors
    /// [`RollFault::Conforming`] where the probe does not fit at the apex.
    pub(crate) fn new(meridian: Meridian, radius: f64) -> Result<Option<Self>, RollFault> {
        let relative_curvature = 1.0 / radius + meridian.apex_curvature();
        if relative_curvature <= 4.0 * f64::EPSILON / radius {
            return Err(RollFault::Conforming { relative_curvature });
        }
        let quadrature = match meridian {
            Meridian::Paraboloid { .. } => Vec::new(),
            Meridian::Spheroid { a, c } => {
                if a.max(c) > LARGEST_ASPECT * a.min(c) {
                    return Ok(None);
                }
                let Some(degree) = std::num::NonZeroUsize::new(NODES) else {
                    return Ok(None);
                };
                GaussLegendre::new(degree)
                    .iter()
                    .map(|(node, weight)| (0.5 + 0.5 * node, 0.5 * weight))
                    .collect()
            }
        };
        Ok(Some(Self { meridian, radius, quadrature }))
    }

    /// Arc length from parameter `from` to `to`, at most an eighth turn apart if by quadrature.
    fn arc_between(&self, from: f64, to: f64) -> f64 {
        if let (Some(a), Some(b)) = (self.meridian.arc_length(from), self.meridian.arc_length(to)) {
            return b - a;
        }
        let panels = ((to - from).abs() / std::f64::consts::FRAC_PI_4).ceil().max(1.0);
        let width = (to - from) / panels;
        let mut sum = 0.0;
        for panel in 0..panels as usize {
            let start = from + width * panel as f64;
            for (node, weight) in &self.quadrature {
                sum += weight * self.meridian.at(start + width * node).arc_per_parameter;
            }
        }
        sum * width
    }

    /// The parameter and the arc length at which the probe has turned by `theta >= 0`.
    ///
    /// θ grows with the parameter (the relative curvature is positive at the apex, where a
    /// meridian of this kind is most hollow), so Newton's method is kept inside a bracket.
    fn solve(&self, theta: f64) -> Result<(f64, f64), RollFault> {
        if theta == 0.0 {
            return Ok((0.0, 0.0));
        }
        let apex = self.meridian.at(0.0);
        let rate = apex.slope_per_parameter + apex.arc_per_parameter / self.radius;
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut t = theta / rate;
        let (mut known, mut arc) = (0.0, 0.0);
        for _ in 0..200 {
            arc += self.arc_between(known, t);
            known = t;
            let point = self.meridian.at(t);
            let excess = point.slope_rad + arc / self.radius - theta;
            if excess == 0.0 {
                break;
            }
            if excess > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let slope = point.slope_per_parameter + point.arc_per_parameter / self.radius;
            let step = excess / slope;
            let mut next = t - step;
            if !(next > low && next < high) {
                next = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * t };
            }
            if (next - t).abs() <= 1e-15 * t {
                // The last correction, to first order.
                arc -= step * point.arc_per_parameter;
                t = next;
                break;
            }
            t = next;
        }
        if t.is_finite() && arc.is_finite() {
            Ok((t, arc))
        } else {
            Err(RollFault::NotFinite)
        }
    }

    pub(crate) fn shift(&self, motion: &Motion) -> Result<Shift, RollFault> {
        let drive = motion.drive();
        let rate = drive.norm();
        if rate == 0.0 {
            return Ok(Shift::default());
        }
        let (_, arc) = self.solve(rate * motion.duration_s)?;
        Ok(Shift::along_great_circle(drive * (arc / rate), self.radius))
    }

    /// The contact after `motion` from the apex.
    pub(crate) fn advance(&self, apex: &Contact, motion: &Motion) -> Result<Contact, RollFault> {
        let drive = motion.drive();
        let rate = drive.norm();
        if rate == 0.0 {
            return Ok(*apex);
        }
        let (t, arc) = self.solve(rate * motion.duration_s)?;
        let point = self.meridian.at(t);
        let direction: Vector2<f64> = drive / rate;
        let outward = apex.x_axis * direction.x + apex.y_axis() * direction.y;
        let turn = apex.normal.cross(&outward) * point.slope_rad;
        let rotation = UnitQuaternion::from_scaled_axis(turn);
        Ok(Contact {
            on_object: apex.on_object + outward * point.r + apex.normal * point.height,
            normal: rotation * apex.normal,
            x_axis: rotation * apex.x_axis,
            body_from_contact: roll_on_probe(apex, direction * arc, self.radius),
            arc_length: apex.arc_length + arc,
        })
    }
}
