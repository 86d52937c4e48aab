//! Mathematical laws that hold for every surface.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Matrix2, Matrix2x3, Matrix3x2, Point3, Vector2, Vector3};
use palpate_geometry::{ChartGeometry, Parameters, Shape, Surface, SurfaceError};

use crate::specimens::{self, Specimen, point};

#[test]
fn every_surface_obeys_the_laws() {
    for specimen in specimens::all() {
        println!("{}", specimen.name);
        obeys_the_laws(&specimen.shape, &specimen);
    }
}

fn obeys_the_laws(surface: &Shape, specimen: &Specimen) {
    let points: Vec<_> = specimen.at.iter().map(|&at| point(surface, at)).collect();
    for &at in &specimen.at {
        let here = Place::new(surface, specimen, at);
        here.the_frame_is_orthonormal_and_right_handed();
        here.the_normal_points_out_of_the_solid();
        here.the_forms_are_those_of_the_chart();
        here.the_level_set_agrees_with_the_chart();
        here.the_form_along_any_tangent_is_that_of_the_level_set();
        here.parameters_invert_the_chart();
        here.the_contact_at_a_place_seen_from_above_is_the_place();
        here.a_point_within_reach_falls_back_on_its_foot();
        here.none_of_these_is_closer(&points);
        here.a_homogeneous_surface_curves_everywhere_the_same();
    }
    the_default_contact_is_on_the_upper_side(surface);
}

struct Place<'a, S> {
    surface: &'a S,
    specimen: &'a Specimen,
    at: Parameters,
    geometry: ChartGeometry,
    /// Differences of lengths up to this value count as rounding errors.
    tiny: f64,
}

impl<'a, S: Surface> Place<'a, S> {
    fn new(surface: &'a S, specimen: &'a Specimen, at: Parameters) -> Self {
        let geometry = surface.chart_geometry(at).unwrap();
        let tiny = 1e-13 * (specimen.size + geometry.point.coords.norm());
        Self {
            surface,
            specimen,
            at,
            geometry,
            tiny,
        }
    }

    fn the_frame_is_orthonormal_and_right_handed(&self) {
        let frame = &self.geometry;
        let (x, y, n) = (frame.x_axis, frame.y_axis, frame.normal);
        for unit in [x, y, n] {
            assert_relative_eq!(unit.norm(), 1.0, epsilon = 1e-14);
        }
        assert_abs_diff_eq!(x.dot(&y), 0.0, epsilon = 1e-14);
        assert_relative_eq!(x.cross(&y), n, epsilon = 1e-14);
    }

    fn the_normal_points_out_of_the_solid(&self) {
        let step = self.geometry.normal * (1e-3 * self.specimen.reach);
        let is_in_solid = |p| (self.specimen.solid)(&p);
        assert!(!is_in_solid(self.geometry.point + step));
        assert!(is_in_solid(self.geometry.point - step));
    }

    /// Checks the equations M = Eᵀ J, K = Eᵀ N M⁻¹ and T = yᵀ X M⁻¹. M is the metric, K the curvature form and T the
    /// torsion form. E contains the axes x and y of the Gauss frame. The derivatives J of the point, N of the normal
    /// and X of the axis x are computed by finite differences.
    fn the_forms_are_those_of_the_chart(&self) {
        let [unit_u, unit_v] = self.specimen.unit;
        let to = |du: f64, dv: f64| {
            let at = Parameters::new(self.at.u + du * unit_u, self.at.v + dv * unit_v);
            self.surface.chart_geometry(at).unwrap()
        };
        let derivatives = |f: &dyn Fn(ChartGeometry) -> Vector3<f64>| {
            Matrix3x2::from_columns(&[
                difference(|h| f(to(h, 0.0))) / unit_u,
                difference(|h| f(to(0.0, h))) / unit_v,
            ])
        };
        let jacobian = derivatives(&|g| g.point.coords);
        let normals = derivatives(&|g| g.normal);
        let tangents = derivatives(&|g| g.x_axis);

        let ChartGeometry {
            x_axis,
            y_axis,
            metric,
            curvature,
            torsion,
            ..
        } = self.geometry;
        let in_frame = Matrix2x3::from_rows(&[x_axis.transpose(), y_axis.transpose()]);
        let units = Matrix2::from_diagonal(&Vector2::new(unit_u, unit_v));
        let inverse = metric.try_inverse().unwrap();
        let size = self.specimen.size;
        assert_relative_eq!(
            metric * units,
            in_frame * jacobian * units,
            epsilon = 1e-9 * size
        );
        assert_eq!(metric.m21, 0.0);
        assert!(metric.m11 > 0.0 && metric.m22 > 0.0);

        // The stored curvature form has only one mixed term, `k_uv`. Therefore the comparison also checks that the form
        // from finite differences is symmetric.
        let (form, turn) = (
            in_frame * normals * inverse,
            y_axis.transpose() * tangents * inverse,
        );
        let largest = form.norm().max(1.0 / size);
        assert_relative_eq!(curvature.matrix(), form, epsilon = 1e-9 * largest);
        assert_relative_eq!(torsion, turn, epsilon = 1e-9 * turn.norm().max(1.0 / size));
    }

    fn the_level_set_agrees_with_the_chart(&self) {
        let level_set = self.surface.level_set(&self.geometry.point).unwrap();
        assert_relative_eq!(level_set.normal, self.geometry.normal, epsilon = 1e-12);
        let form = level_set.curvature(&self.geometry.x_axis, &self.geometry.y_axis);
        let chart = self.geometry.curvature.matrix();
        let epsilon = 1e-12 * (chart.norm() + 1.0 / self.specimen.size);
        assert_relative_eq!(form.matrix(), chart, epsilon = epsilon);
    }

    fn the_form_along_any_tangent_is_that_of_the_level_set(&self) {
        let (p, frame) = (&self.geometry.point, &self.geometry);
        let level_set = self.surface.level_set(p).unwrap();
        for angle in [0.0_f64, 0.3, 1.7, 2.9, -1.1] {
            let x = frame.x_axis * libm::cos(angle) + frame.y_axis * libm::sin(angle);
            let (normal, form) = self.surface.curvature_along(p, &x).unwrap();
            assert_relative_eq!(normal, level_set.normal, epsilon = 1e-14);
            let expected = level_set.curvature(&x, &x.cross(&normal)).matrix();
            let epsilon = 1e-13 * level_set.second_form.norm();
            assert_relative_eq!(form.matrix(), expected, epsilon = epsilon);

            let raw = self.surface.tangent_form(p, &x).unwrap();
            let steepness = raw.gradient.norm();
            assert_relative_eq!(raw.steepness, steepness, max_relative = 1e-14);
            assert_relative_eq!(
                raw.steepness_squared,
                steepness * steepness,
                max_relative = 1e-14
            );
        }
    }

    fn parameters_invert_the_chart(&self) {
        let parameters = self.surface.parameters(&self.geometry.point);
        let back = point(self.surface, parameters);
        assert_abs_diff_eq!(back, self.geometry.point, epsilon = self.tiny);
    }

    fn the_contact_at_a_place_seen_from_above_is_the_place(&self) {
        let (place, up) = (self.geometry.point, self.geometry.normal.z);
        let touched = self.surface.contact_at(place.x, place.y).unwrap();
        // If the normal points down at this point, `contact_at` returns the point vertically above it at which the
        // normal points up.
        let same = (touched - self.geometry.point).norm() < self.tiny / up.abs().min(1.0);
        assert_eq!(same, up > 0.0, "{touched} is not {}", self.geometry.point);
    }

    fn a_point_within_reach_falls_back_on_its_foot(&self) {
        let ChartGeometry {
            point: foot,
            normal,
            ..
        } = self.geometry;
        for share in [-0.9, -0.5, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.5, 0.9] {
            let offset = normal * (share * self.specimen.reach);
            let closest = self.surface.closest_point(&(foot + offset)).unwrap();
            assert_abs_diff_eq!(closest, foot, epsilon = 10.0 * self.tiny);
        }
    }

    /// Checks that no point in `points` is closer to the query point than the closest point that the surface computes.
    /// The query points of a graph are at most the distance `reach` away from it.
    fn none_of_these_is_closer(&self, points: &[Point3<f64>]) {
        let is_graph = matches!(
            self.specimen.shape,
            Shape::Paraboloid(_) | Shape::Saddle(_) | Shape::HeightField(_)
        );
        let ChartGeometry {
            point: foot,
            normal,
            ..
        } = self.geometry;
        let far = if is_graph {
            0.99 * self.specimen.reach
        } else {
            5.0 * self.specimen.size
        };
        for distance in [-far, -0.2 * far, 0.2 * far, far] {
            let from = foot + normal * distance;
            let closest = match self.surface.closest_point(&from) {
                Ok(closest) => closest,
                Err(SurfaceError::NoClosestPoint { .. }) if !is_graph => continue,
                Err(error) => panic!("{error}"),
            };
            let back = point(self.surface, self.surface.parameters(&closest));
            assert_abs_diff_eq!(back, closest, epsilon = 10.0 * self.tiny);
            let length = (closest - from).norm();
            let nearest = points
                .iter()
                .map(|p| (p - from).norm())
                .fold(f64::MAX, f64::min);
            assert!(
                length <= nearest + 10.0 * self.tiny,
                "{length} is longer than {nearest}"
            );
        }
    }

    fn a_homogeneous_surface_curves_everywhere_the_same(&self) {
        let Some(everywhere) = self.surface.constant_curvature() else {
            return;
        };
        let (a, b) = (everywhere.principal(), self.geometry.curvature.principal());
        let difference = (a.k_min - b.k_min).abs() + (a.k_max - b.k_max).abs();
        assert!(difference * self.specimen.size < 1e-13);
    }
}

fn the_default_contact_is_on_the_upper_side(surface: &impl Surface) {
    let (x, y) = surface.default_contact();
    let touched = surface.contact_at(x, y).unwrap();
    let normal = surface.level_set(&touched).unwrap().normal;
    assert!(normal.z > 0.5);
}

/// The derivative of `f` at 0, by central differences of fourth order.
fn difference(f: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    let h = 1e-3;
    ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}
