//! Forms at poles, on rims, far out, and on surfaces of extreme ratios.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_geometry::{Parameters, Surface, SurfaceError};

use super::super::precise::Precise;
use super::super::{Answer, Case};

const MADE: &str = "sizes between 1e-100 and 1e100 make surfaces";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for radius in [1e-9, 1.0, 1e9] {
        cases.extend(poles(radius));
        cases.extend(rims(radius));
        cases.extend(centres(radius));
    }
    for exponent in [-12, -9, -6, -3, 0, 3, 6, 9, 12] {
        let ratio = 10f64.powi(exponent);
        if ratio > 1.0 {
            cases.push(Case::value(
                "geometry::Torus::chart_geometry",
                format!("tube of 1/{ratio:e} of the ring"),
                move || torus(ratio),
            ));
        }
        cases.push(Case::value(
            "geometry::Ellipsoid::chart_geometry",
            format!("one semi-axis of ratio {ratio:e}"),
            move || ellipsoid(ratio),
        ));
        cases.push(Case::value(
            "geometry::Graph::curvature_along",
            format!("paraboloid of c = 1 at r = {ratio:e}"),
            move || far_out(ratio),
        ));
        cases.push(Case::value(
            "geometry::Graph::chart_geometry",
            format!("saddle of a = 1 at x = y = {ratio:e}"),
            move || far_diagonal(ratio),
        ));
    }
    cases
}

/// Near a pole of the Gauss map the torsion `−tan(u)/R` grows without bound.
fn poles(radius: f64) -> Vec<Case> {
    let short = [1e-1, 1e-4, 1e-8, 1e-12, 1e-14];
    let mut cases: Vec<Case> = (short.into_iter())
        .map(|short| {
            let input = format!("radius {radius:e}, {short:e} rad from the pole");
            Case::value("geometry::Sphere::chart_geometry", input, move || {
                let u = FRAC_PI_2 - short;
                let truth = -((Precise::new(u)).tan() / radius).to_f64();
                let sphere = Sphere::new(radius).expect(MADE);
                let found = sphere.chart_geometry(Parameters::new(u, 0.7))?;
                let form = found.curvature;
                let pairs = [
                    (found.torsion[1], truth),
                    (form.k_uu, 1.0 / radius),
                    (form.k_vv, 1.0 / radius),
                ];
                Ok::<_, SurfaceError>(Answer::all_near(pairs).within(1e-14))
            })
        })
        .collect();
    cases.push(Case::refusal(
        "geometry::Dish::chart_geometry",
        format!("radius {radius:e}, at both poles and past them"),
        move || {
            let dish = Dish::new(radius).expect(MADE);
            let places = [FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2.next_up(), 2.0];
            let asked = places.map(|u| dish.chart_geometry(Parameters::new(u, 0.7)));
            let first = asked[0];
            asked.into_iter().find(Result::is_ok).unwrap_or(first)
        },
    ));
    for u in [0.0, 1.0, FRAC_PI_2 - 1e-8] {
        let input = format!("radius {radius:e}, {u:e} rad from the equator");
        cases.push(Case::value(
            "geometry::Dish::chart_geometry",
            input,
            move || {
                let dish = Dish::new(radius).expect(MADE);
                let form = dish.chart_geometry(Parameters::new(u, 0.7))?.curvature;
                let pairs = [(form.k_uu, -1.0 / radius), (form.k_vv, -1.0 / radius)];
                Ok::<_, SurfaceError>(Answer::all_near(pairs).within(1e-15).also([form.k_uv]))
            },
        ));
    }
    cases
}

/// On the rim the height is a root of a small difference: `z² = R² − x²` errs by a few units of R².
fn rims(radius: f64) -> Vec<Case> {
    let short = [1e-3, 1e-8, 1e-15];
    let inside = short.map(|short| {
        let input = format!("radius {radius:e}, {short:e} of it from the rim");
        Case::value("geometry::Sphere::contact_at", input, move || {
            let x = radius * (1.0 - short);
            let rest = (Precise::new(radius) - x) * (Precise::new(radius) + x);
            let sphere = Sphere::new(radius).expect(MADE);
            let found = sphere.contact_at(0.0, x)?;
            let answer = Answer::near(found.z, rest.sqrt().to_f64()).within(1e-15);
            Ok::<_, SurfaceError>(answer.also([found.x, found.y]))
        })
    });
    let of_cylinders = short.map(|short| {
        let input = format!("radius {radius:e}, {short:e} of it from where it is steep");
        Case::value("geometry::Cylinder::contact_at", input, move || {
            let y = radius * (1.0 - short);
            let rest = (Precise::new(radius) - y) * (Precise::new(radius) + y);
            let cylinder = Cylinder::new(radius, 0.0).expect(MADE);
            let found = cylinder.contact_at(3.0 * radius, y)?;
            let answer = Answer::near(found.z, rest.sqrt().to_f64()).within(1e-15);
            Ok::<_, SurfaceError>(answer.also([found.x, found.y]))
        })
    });
    let beside = Case::refusal(
        "geometry::Cylinder::contact_at",
        format!("radius {radius:e}, just beside it"),
        move || {
            let cylinder = Cylinder::new(radius, 0.0).expect(MADE);
            cylinder.contact_at(0.0, radius.next_up())
        },
    );
    inside
        .into_iter()
        .chain(of_cylinders)
        .chain([beside])
        .collect()
}

/// Normals and curvatures at a top; at a centre, on an axis, there are none.
fn centres(size: f64) -> Vec<Case> {
    let ellipsoid = Ellipsoid::new([size, 2.0 * size, 3.0 * size]).expect(MADE);
    let torus = Torus::new(size, 0.3 * size).expect(MADE);
    vec![
        Case::value(
            "geometry::Ellipsoid::level_set",
            format!("size {size:e}, at its top"),
            move || {
                let ellipsoid = Ellipsoid::new([size, 2.0 * size, 3.0 * size]).expect(MADE);
                let found = ellipsoid.level_set(&Point3::new(0.0, 0.0, 3.0 * size))?;
                // c/a² and c/b².
                let pairs = [
                    (found.second_form.m11 * size, 3.0),
                    (found.second_form.m22 * size, 0.75),
                    (found.normal.z, 1.0),
                ];
                Ok::<_, SurfaceError>(Answer::all_near(pairs).within(1e-15))
            },
        ),
        Case::value(
            "geometry::Torus::level_set",
            format!("size {size:e}, on its outer equator"),
            move || {
                let torus = Torus::new(size, 0.25 * size).expect(MADE);
                let found = torus.level_set(&Point3::new(1.25 * size, 0.0, 0.0))?;
                // 1/(R + r) along the equator, 1/r across it.
                let pairs = [
                    (found.second_form.m22 * size, 0.8),
                    (found.second_form.m33 * size, 4.0),
                    (found.normal.x, 1.0),
                ];
                Ok::<_, SurfaceError>(Answer::all_near(pairs).within(2e-15))
            },
        ),
        Case::refusal(
            "geometry::Ellipsoid::level_set",
            format!("size {size:e}, at its centre"),
            move || ellipsoid.level_set(&Point3::origin()),
        ),
        Case::refusal(
            "geometry::Torus::level_set",
            format!("size {size:e}, on its axis"),
            move || torus.level_set(&Point3::new(0.0, 0.0, 0.1 * size)),
        ),
    ]
}

/// `K = diag(1/r, sin u/(R + r sin u))`.
fn torus(ratio: f64) -> Result<Answer, SurfaceError> {
    let u = -1.2;
    let sin = (Precise::new(u)).sin();
    let across = (&sin / (&sin + ratio)).to_f64();
    let torus = Torus::new(ratio, 1.0).expect(MADE);
    let found = torus.chart_geometry(Parameters::new(u, 2.0))?;
    let pairs = [(found.curvature.k_uu, 1.0), (found.curvature.k_vv, across)];
    Ok(Answer::all_near(pairs).within(1e-14))
}

/// `K = p⁴/(a b c)²` with p the distance of the tangent plane from the centre,
/// `1/p² = Σ (x/a²)²`; a difference of products as large as H².
fn ellipsoid(ratio: f64) -> Result<Answer, SurfaceError> {
    let axes = [ratio, 1.0, 1.5];
    let (u, v) = (0.4, 0.9);
    let [sin_u, cos_u] = [(Precise::new(u)).sin(), (Precise::new(u)).cos()];
    let [sin_v, cos_v] = [(Precise::new(v)).sin(), (Precise::new(v)).cos()];
    let unit = [sin_u, &cos_u * sin_v, &cos_u * cos_v];
    let inverse_square = (unit.into_iter().zip(axes))
        .map(|(x, axis)| (x / axis).squared())
        .fold(Precise::new(0.0), |sum, term| sum + term);
    let product = Precise::new(axes[0]) * axes[1] * axes[2];
    let truth = Precise::new(1.0) / (inverse_square * &product).squared();
    let surface = Ellipsoid::new(axes).expect(MADE);
    let form = surface.chart_geometry(Parameters::new(u, v))?.curvature;
    let condition = form.mean_curvature().powi(2) / truth.to_f64();
    let answer = Answer::near(form.gaussian_curvature(), truth.to_f64()).within(1e-14);
    Ok(answer.conditioned(condition))
}

/// Up the slope `2c/w³`, along the level line `2c/w`, `w² = 1 + (2 c r)²`.
fn far_out(r: f64) -> Result<Answer, SurfaceError> {
    let w = ((Precise::new(2.0) * r).squared() + 1.0).sqrt();
    let across = Precise::new(2.0) / &w;
    let along = &across / &w / &w;
    let hill = Graph::paraboloid(1.0).expect(MADE);
    let (normal, form) = hill.curvature_along(&hill.contact_at(r, 0.0)?, &Vector3::y())?;
    let pairs = [
        (form.k_uu, across.to_f64()),
        (form.k_vv, along.to_f64()),
        (form.k_uv, 0.0),
        (normal.z / across.to_f64(), 0.5),
    ];
    Ok(Answer::all_at_scale(pairs, across.to_f64()).within(1e-15))
}

/// `K = −4a²/w⁴`, H = 0 on the diagonal, where x and y slope alike; `w² = 1 + 8 a² x²`. The chart's
/// tangents are nearly parallel there.
fn far_diagonal(x: f64) -> Result<Answer, SurfaceError> {
    let w_squared = (Precise::new(x) * x) * 8.0 + 1.0;
    let truth = Precise::new(-4.0) / w_squared.squared();
    let saddle = Graph::saddle(1.0).expect(MADE);
    let found = saddle.chart_geometry(Parameters::new(x, x))?;
    let condition = 1.0 + x * x;
    let form = found.curvature;
    let answer = Answer::near(form.gaussian_curvature(), truth.to_f64()).within(1e-14);
    Ok(answer.conditioned(condition).also([form.mean_curvature()]))
}
