//! Tests surfaces and formulas with extreme sizes, ratios and distances, from the smallest double to 1e300. Each error
//! bound states how many digits the result may lose.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::Vector3;
use palpate_geometry::{
    CurvatureForm, Cylinder, Dish, Ellipsoid, Formula, Graph, Meridian, Parameters, Plane, Shape,
    Sphere, Surface, SurfaceError, Torus,
};
use proptest::prelude::*;

#[test]
fn a_chart_ends_at_its_poles() {
    fn ends(surface: &impl Surface, size: f64) {
        for (u, side) in [(FRAC_PI_2, 1.0), (-FRAC_PI_2, -1.0)] {
            for v in [0.0, 1.0, -3.0] {
                let at = Parameters::new(u, v);
                let singular = Err(SurfaceError::ChartSingular { u, v });
                assert_eq!(surface.chart_geometry(at), singular);
                // Only the chart is singular at the pole; the surface is regular there.
                let pole = surface.chart(at).unwrap().point;
                assert!((pole.x.abs() - size).abs() <= f64::EPSILON * size);
                let level_set = surface.level_set(&pole).unwrap();
                assert_relative_eq!(level_set.normal.x.abs(), 1.0);

                let past = if side > 0.0 {
                    u.next_up()
                } else {
                    u.next_down()
                };
                let beyond = Parameters::new(past, v);
                let singular = SurfaceError::ChartSingular { u: beyond.u, v };
                assert_eq!(surface.chart(beyond), Err(singular));
                assert_eq!(surface.chart_geometry(beyond), Err(singular));

                for short in [1e-3, 1e-8, 1e-13] {
                    let near = Parameters::new(u - side * short, v);
                    let here = surface.chart_geometry(near).unwrap();
                    let level_set = surface.level_set(&here.point).unwrap();
                    assert_relative_eq!(here.normal, level_set.normal, epsilon = 1e-14);
                    let form = level_set.curvature(&here.x_axis, &here.y_axis).matrix();
                    let epsilon = 1e-13 * form.norm();
                    assert_relative_eq!(here.curvature.matrix(), form, epsilon = epsilon);
                }
            }
        }
    }
    for size in [1e-9, 1.0, 1e9] {
        ends(&Sphere::new(size).unwrap(), size);
        ends(&Dish::new(size).unwrap(), size);
        ends(
            &Ellipsoid::new([size, 2.0 * size, 0.5 * size]).unwrap(),
            size,
        );
    }
    // The charts of a cylinder and a torus have no poles.
    for (u, v) in [(FRAC_PI_2, FRAC_PI_2), (-PI, PI), (1e3, 1e4)] {
        let at = Parameters::new(u, v);
        assert!(Cylinder::new(1e-9, 0.3).unwrap().chart_geometry(at).is_ok());
        assert!(Torus::new(1e9, 1e-3).unwrap().chart_geometry(at).is_ok());
    }
}

#[test]
fn heights_near_a_rim_keep_their_digits() {
    let (sphere, cylinder) = (Sphere::new(3.0).unwrap(), Cylinder::new(3.0, 0.0).unwrap());
    for short in [1e-3, 1e-8, 1e-15] {
        let off: f64 = 3.0 * (1.0 - short);
        // `off` is close to 3, so the difference `3.0 - off` has no rounding error.
        let height = ((3.0 - off) * (3.0 + off)).sqrt();
        for found in [sphere.contact_at(0.0, off), cylinder.contact_at(9.0, off)] {
            assert_relative_eq!(found.unwrap().z, height, max_relative = 1e-15);
        }
    }
    assert!(cylinder.contact_at(9.0, 3.0_f64.next_up()).is_err());
}

#[test]
fn near_an_umbilic_principal_curvatures_differ_by_what_the_form_does() {
    for off in [1e-15, 1e-9, 1e-3, 1.0] {
        let form = CurvatureForm {
            k_uu: 1.0,
            k_uv: off,
            k_vv: 1.0,
        };
        let found = form.principal();
        assert_abs_diff_eq!(found.k_min, 1.0 - off, epsilon = 1e-15);
        assert_abs_diff_eq!(found.k_max, 1.0 + off, epsilon = 1e-15);
        let index = FRAC_2_PI * libm::atan(1.0 / off);
        assert_abs_diff_eq!(
            form.principal().shape_index().unwrap(),
            index,
            epsilon = 2e-15
        );
    }
}

/// Compares values and slopes with numbers that mpmath computed with 60 digits.
#[test]
fn formulas_keep_their_digits_where_values_are_tiny_or_huge() {
    let jet = |text: &str, x: f64| {
        let formula = Formula::parse(text, &BTreeMap::new()).unwrap();
        formula.jet(x, 0.3)
    };
    for (text, x, value, slope) in [
        ("sqrt(x)", 1e-100, 1e-50, 0.5e50),
        ("atan(x)", 1e100, FRAC_PI_2, 1e-200),
        ("atan(x)", 1e-300, 1e-300, 1.0),
        ("ln(x)", 1e300, 690.7755278982137, 1e-300),
        ("1/(1 + x^2)", 1e70, 1e-140, -2e-210),
        ("tanh(x)", 300.0, 1.0, 1.0601586212017243e-260),
        ("x^0.3", 1e300, 9.999999999999924e89, 2.999999999999977e-211),
        ("hypot(x, 3e200)", 4e200, 5e200, 0.8),
        ("x^3/1e200", 1e100, 1e100, 3.0),
        ("sin(3*x)", 1e6, -0.8784900581447479, 1.433281884231967),
    ] {
        let found = jet(text, x);
        assert!(found.is_finite(), "{text}: {found:?}");
        assert_relative_eq!(found.value, value, max_relative = 1e-15);
        assert_relative_eq!(found.gradient[0], slope, max_relative = 2e-15);
    }
    // At these x, the second derivatives of the functions exceed the range of doubles.
    for (text, x) in [("sqrt(x)", 1e-300), ("ln(x)", f64::MIN_POSITIVE)] {
        assert!(!jet(text, x).is_finite(), "{text}");
    }
}

/// Compares meridians with numbers that mpmath computed with 60 digits.
#[test]
fn meridians_keep_their_digits_from_flat_to_sharp() {
    // A nearly flat spheroid (c = 1e-12) at 0.2 turns, and a needle-like spheroid at 1000.2 turns.
    for (c, t, [outward, along], slope) in [
        (
            1e-12,
            1.2566370614359172,
            [3.0776835371752527e-12, 1.0],
            3.0776835371752527e-12,
        ),
        (
            1e12,
            6284.441944241023,
            [1.0, 3.2491969623266656e-13],
            6284.756103506381,
        ),
    ] {
        let meridian = Meridian::Spheroid { a: 1.0, c };
        let normal = meridian.at(t).normal;
        assert_relative_eq!(normal[0], outward, max_relative = 1e-15);
        assert_relative_eq!(normal[1], along, max_relative = 1e-15);
        let found = meridian.slope(t).slope_rad;
        assert_relative_eq!(found, slope, max_relative = 1e-15);
    }
}

#[test]
fn principal_directions_lie_in_their_half_turn() {
    for tiny in [0.0, -0.0, 1e-300, -1e-300, 5e-324, -5e-324] {
        let form = CurvatureForm {
            k_uu: -1.0,
            k_uv: tiny,
            k_vv: 1.0,
        };
        let angle = form.principal().angle_of_max_rad;
        assert!(
            angle > -FRAC_PI_2 && angle <= FRAC_PI_2,
            "{angle} for {tiny}"
        );
    }
}

fn lengths() -> impl Strategy<Value = f64> {
    (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn round_surfaces_of_any_size(radius in lengths(), u in -1.57..1.57_f64, v in -3.1..3.1_f64) {
        let signed = [
            (Shape::Sphere(Sphere::new(radius).unwrap()), 1.0, [1.0, 1.0]),
            (Shape::Dish(Dish::new(radius).unwrap()), 1.0, [-1.0, -1.0]),
            (Shape::Cylinder(Cylinder::new(radius, 0.3).unwrap()), radius, [0.0, 1.0]),
            (Shape::Plane(Plane), 1.0, [0.0, 0.0]),
        ];
        for (shape, unit_u, [k_uu, k_vv]) in signed {
            let here = shape.chart_geometry(Parameters::new(u * unit_u, v)).unwrap();
            let (_, form) = shape.curvature_along(&here.point, &here.x_axis).unwrap();
            for form in [here.curvature, form] {
                assert_relative_eq!(form.k_uu * radius, k_uu, epsilon = 1e-14);
                assert_relative_eq!(form.k_vv * radius, k_vv, epsilon = 1e-14);
                assert_relative_eq!(form.k_uv * radius, 0.0, epsilon = 1e-14);
            }
            let foot = shape.closest_point(&(here.point + here.normal * radius * 0.5));
            assert_relative_eq!(foot.unwrap(), here.point, epsilon = 1e-14 * (radius + 2.0));
        }
    }

    #[test]
    fn tori_of_any_ratio(
        minor in lengths(),
        ratio in (0.001..12.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        u in -3.1..3.1_f64,
        v in -3.1..3.1_f64,
    ) {
        let major = minor * ratio;
        let torus = Torus::new(major, minor).unwrap();
        let here = torus.chart_geometry(Parameters::new(u, v)).unwrap();
        let rho = major + minor * libm::sin(u);
        let across = libm::sin(u) / rho;
        assert_relative_eq!(here.curvature.k_uu, 1.0 / minor, max_relative = 1e-13);
        assert_relative_eq!(here.curvature.k_vv, across, max_relative = 1e-13);
        // Bound on the rounding error of the point's coordinates, relative to the tube's radius. If the hole of the
        // torus is narrow, the error is amplified near its centre.
        let blur = 1e-14 * ratio / (ratio - 1.0) + 1e-15 * ratio;
        let local = torus.level_set(&here.point).unwrap();
        let form = local.curvature(&here.x_axis, &here.y_axis);
        assert_relative_eq!(local.normal, here.normal, epsilon = blur);
        assert_relative_eq!(form.k_uu * minor, 1.0, epsilon = blur);
        assert_relative_eq!(form.k_vv * minor, across * minor, epsilon = blur);
        let offset = here.normal * (0.5 * minor.min(major - minor));
        let foot = torus.closest_point(&(here.point + offset)).unwrap();
        prop_assert!((foot - here.point).norm() < blur * minor);
    }

    #[test]
    fn ellipsoids_of_any_ratio(
        exponents in [-6.0..6.0_f64, -6.0..6.0, -6.0..6.0],
        u in -1.57..1.57_f64,
        v in -3.1..3.1_f64,
    ) {
        let semi_axes = exponents.map(|exponent| libm::pow(10.0_f64, exponent));
        let ellipsoid = Ellipsoid::new(semi_axes).unwrap();
        let here = ellipsoid.chart_geometry(Parameters::new(u, v)).unwrap();
        let frame = here;
        assert_relative_eq!(frame.x_axis.cross(&frame.y_axis), frame.normal, epsilon = 1e-14);
        let local = ellipsoid.level_set(&here.point).unwrap();
        assert_relative_eq!(local.normal, frame.normal, epsilon = 1e-13, max_relative = 1e-13);

        // Let a, b and c be the semi-axes, and p the distance of the tangent plane from the centre. The Gaussian
        // curvature is K = p⁴/(abc)². The mean curvature is H = p³ S/(2 (abc)²), with S = a² + b² + c² − x² − y² − z².
        // On the ellipsoid, a² − x² = a² (y²/b² + z²/c²), and likewise for the other axes. Therefore `rest`, whose sum
        // is S, is computed without cancellation.
        let axes = Vector3::from(semi_axes);
        let unit = here.point.coords.component_div(&axes);
        let p = 1.0 / unit.component_div(&axes).norm();
        let shares = unit.component_mul(&unit);
        let others = Vector3::new(shares.y + shares.z, shares.z + shares.x, shares.x + shares.y);
        let rest = axes.component_mul(&axes).component_mul(&others);
        let product = axes.product();
        let mean = 0.5 * (p / product).powi(2) * p * rest.sum();
        let gaussian = (p * p / product).powi(2);
        for form in [here.curvature, local.curvature(&frame.x_axis, &frame.y_axis)] {
            assert_relative_eq!(form.mean_curvature(), mean, max_relative = 1e-12);
            // The tolerance of the Gaussian curvature K is relative to the squared mean curvature H². The reason is
            // that K is computed as a difference of two products that are as large as H².
            let epsilon = 1e-12 * mean * mean;
            assert_relative_eq!(form.gaussian_curvature(), gaussian, epsilon = epsilon);
        }
        let difference = local.curvature(&frame.x_axis, &frame.y_axis).matrix() - here.curvature.matrix();
        prop_assert!(difference.norm() <= 1e-12 * mean, "{difference}");
    }

    /// On the paraboloid `z = −c (x² + y²)` at the distance `r` from its axis, the normal curvature is `2c/w³` up the
    /// slope and `2c/w` along the level line. Here `w² = 1 + (2 c r)²`.
    #[test]
    fn graphs_far_from_their_apex(exponent in -12.0..12.0_f64, size in lengths()) {
        let r = libm::pow(10.0_f64, exponent);
        let hill = Graph::paraboloid(1.0 / size).unwrap();
        let foot = hill.contact_at(r * size, 0.0).unwrap();
        let (normal, form) = hill.curvature_along(&foot, &Vector3::y()).unwrap();
        let w = libm::hypot(1.0, 2.0 * r);
        let across = 2.0 / w;
        assert_relative_eq!(form.k_uu * size, across, max_relative = 1e-14);
        assert_abs_diff_eq!(form.k_vv * size, across / w / w, epsilon = 1e-14 * across);
        assert_relative_eq!(normal.z, 0.5 * across, max_relative = 1e-14);
        // `inside` is half a radius of curvature below the surface, so `foot` is the point of the surface closest to
        // it.
        let inside = foot - normal * (0.25 * size * w);
        if r < 1.0 {
            let found = hill.closest_point(&inside).unwrap();
            assert_abs_diff_eq!(found / size, foot / size, epsilon = 1e-13);
        }
        // On the diagonal of a saddle, the tangents of the chart are nearly parallel, so the Gaussian curvature could
        // lose digits. At the point (r, r) of z = a (x² − y²), its exact value is −4a²/w⁴ with w² = 1 + 8a²r². Here a
        // is 1.
        let saddle = Graph::saddle(1.0).unwrap();
        let form = saddle.chart_geometry(Parameters::new(r, r)).unwrap().curvature;
        let truth = -(2.0 / (1.0 + 8.0 * r * r)).powi(2);
        assert_relative_eq!(form.gaussian_curvature(), truth, max_relative = 1e-13);
    }
}
