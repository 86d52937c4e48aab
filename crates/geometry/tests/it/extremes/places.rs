//! Forms at poles, on rims, far out, and on surfaces of extreme ratios.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_geometry::{Parameters, Surface, SurfaceError};
use palpate_verdict::{Answer, Precise, decades, rows};

const RADII: [f64; 3] = [1e-9, 1.0, 1e9];
const SPHERE: &str = "geometry::Sphere::contact_at";
const CYLINDER: &str = "geometry::Cylinder::contact_at";
const DISH: &str = "geometry::Dish::chart_geometry";
const ELLIPSOID: &str = "geometry::Ellipsoid::level_set";
const TORUS: &str = "geometry::Torus::level_set";

rows! {
    "geometry::Sphere::chart_geometry", "radius {radius:e}, {short:e} rad from the pole" => near_pole(radius, short),
        for radius in RADII, for short in [1e-1, 1e-4, 1e-8, 1e-12, 1e-14];
    DISH, "radius {radius:e}, {u:e} rad from the equator" => dish(radius, u),
        for radius in RADII, for u in [0.0, 1.0, FRAC_PI_2 - 1e-8];
    DISH, "radius {radius:e}, {u:e} rad from the equator: at a pole or past it", "chart-singular" => dish(radius, u),
        for radius in RADII, for u in [FRAC_PI_2, -FRAC_PI_2, FRAC_PI_2.next_up(), 2.0];
    SPHERE, "radius {radius:e}, {short:e} of it from the rim" => on_sphere(radius, radius * (1.0 - short)),
        for radius in RADII, for short in [1e-3, 1e-8, 1e-15];
    CYLINDER, "radius {radius:e}, {short:e} of it from where it is steep" =>
        on_cylinder(radius, radius * (1.0 - short)), for radius in RADII, for short in [1e-3, 1e-8, 1e-15];
    CYLINDER, "radius {radius:e}, just beside it", "off-domain" => on_cylinder(radius, radius.next_up()),
        for radius in RADII;
    ELLIPSOID, "size {size:e}, at its top" => top(size), for size in RADII;
    ELLIPSOID, "size {size:e}, at its centre", "off-domain" => ellipsoid(size).level_set(&Point3::origin()),
        for size in RADII;
    TORUS, "size {size:e}, on its outer equator" => equator(size), for size in RADII;
    TORUS, "size {size:e}, on its axis", "off-domain" => on_axis(size), for size in RADII;
    "geometry::Torus::chart_geometry", "tube of 1/{ratio:e} of the ring" => torus(ratio),
        for ratio in decades(3, 12, 3);
    "geometry::Ellipsoid::chart_geometry", "one semi-axis of ratio {ratio:e}" => stretched(ratio),
        for ratio in decades(-12, 12, 3);
    "geometry::Graph::curvature_along", "paraboloid of c = 1 at r = {ratio:e}" => far_out(ratio),
        for ratio in decades(-12, 12, 3);
    "geometry::Graph::chart_geometry", "saddle of a = 1 at x = y = {ratio:e}" => far_diagonal(ratio),
        for ratio in decades(-12, 12, 3);
}

/// Near a pole of the Gauss map the torsion `−tan(u)/R` grows without bound.
fn near_pole(radius: f64, short: f64) -> Result<Answer, SurfaceError> {
    let u = FRAC_PI_2 - short;
    let truth = -(Precise::new(u).tan() / radius).to_f64();
    let sphere = Sphere::new(radius).unwrap();
    let found = sphere.chart_geometry(Parameters::new(u, 0.7))?;
    let form = found.curvature;
    let pairs = [
        (found.torsion[1], truth),
        (form.k_uu, 1.0 / radius),
        (form.k_vv, 1.0 / radius),
    ];
    Ok(Answer::all_near(pairs).within(1e-14))
}

fn dish(radius: f64, u: f64) -> Result<Answer, SurfaceError> {
    let dish = Dish::new(radius).unwrap();
    let form = dish.chart_geometry(Parameters::new(u, 0.7))?.curvature;
    let pairs = [(form.k_uu, -1.0 / radius), (form.k_vv, -1.0 / radius)];
    Ok(Answer::all_near(pairs).within(1e-15).also([form.k_uv]))
}

/// On the rim the height is a root of a small difference: `z² = R² − x²` errs by a few units of R².
fn on_sphere(radius: f64, x: f64) -> Result<Answer, SurfaceError> {
    let found = Sphere::new(radius).unwrap().contact_at(0.0, x)?;
    Ok(height(&found, radius, x))
}

fn on_cylinder(radius: f64, y: f64) -> Result<Answer, SurfaceError> {
    let cylinder = Cylinder::new(radius, 0.0).unwrap();
    let found = cylinder.contact_at(3.0 * radius, y)?;
    Ok(height(&found, radius, y))
}

fn height(found: &Point3<f64>, radius: f64, off: f64) -> Answer {
    let rest = (Precise::new(radius) - off) * (Precise::new(radius) + off);
    let answer = Answer::near(found.z, rest.sqrt().to_f64()).within(1e-15);
    answer.also([found.x, found.y])
}

fn ellipsoid(size: f64) -> Ellipsoid {
    Ellipsoid::new([size, 2.0 * size, 3.0 * size]).unwrap()
}

/// c/a² and c/b².
fn top(size: f64) -> Result<Answer, SurfaceError> {
    let found = ellipsoid(size).level_set(&Point3::new(0.0, 0.0, 3.0 * size))?;
    let pairs = [
        (found.second_form.m11 * size, 3.0),
        (found.second_form.m22 * size, 0.75),
        (found.normal.z, 1.0),
    ];
    Ok(Answer::all_near(pairs).within(1e-15))
}

/// 1/(R + r) along the equator, 1/r across it.
fn equator(size: f64) -> Result<Answer, SurfaceError> {
    let torus = Torus::new(size, 0.25 * size).unwrap();
    let found = torus.level_set(&Point3::new(1.25 * size, 0.0, 0.0))?;
    let pairs = [
        (found.second_form.m22 * size, 0.8),
        (found.second_form.m33 * size, 4.0),
        (found.normal.x, 1.0),
    ];
    Ok(Answer::all_near(pairs).within(2e-15))
}

fn on_axis(size: f64) -> Result<palpate_geometry::LevelSet, SurfaceError> {
    let torus = Torus::new(size, 0.3 * size).unwrap();
    torus.level_set(&Point3::new(0.0, 0.0, 0.1 * size))
}

/// `K = diag(1/r, sin u/(R + r sin u))`.
fn torus(ratio: f64) -> Result<Answer, SurfaceError> {
    let u = -1.2;
    let sin = Precise::new(u).sin();
    let across = (&sin / (&sin + ratio)).to_f64();
    let torus = Torus::new(ratio, 1.0).unwrap();
    let form = torus.chart_geometry(Parameters::new(u, 2.0))?.curvature;
    Ok(Answer::all_near([(form.k_uu, 1.0), (form.k_vv, across)]).within(1e-14))
}

/// `K = p⁴/(a b c)²` with p the distance of the tangent plane from the centre,
/// `1/p² = Σ (x/a²)²`; a difference of products as large as H².
fn stretched(ratio: f64) -> Result<Answer, SurfaceError> {
    let axes = [ratio, 1.0, 1.5];
    let (u, v) = (0.4, 0.9);
    let [[sin_u, cos_u], [sin_v, cos_v]] = [u, v]
        .map(Precise::new)
        .map(|angle| [angle.sin(), angle.cos()]);
    let unit = [sin_u, &cos_u * sin_v, &cos_u * cos_v];
    let inverse_square = (unit.into_iter().zip(axes))
        .map(|(x, axis)| (x / axis).squared())
        .fold(Precise::new(0.0), |sum, term| sum + term);
    let product = Precise::new(axes[0]) * axes[1] * axes[2];
    let truth = 1.0 / (inverse_square * &product).squared();
    let surface = Ellipsoid::new(axes).unwrap();
    let form = surface.chart_geometry(Parameters::new(u, v))?.curvature;
    let condition = form.mean_curvature().powi(2) / truth.to_f64();
    let answer = Answer::near(form.gaussian_curvature(), truth.to_f64()).within(1e-14);
    Ok(answer.conditioned(condition))
}

/// Up the slope `2c/w³`, along the level line `2c/w`, `w² = 1 + (2 c r)²`.
fn far_out(r: f64) -> Result<Answer, SurfaceError> {
    let w = ((2.0 * Precise::new(r)).squared() + 1.0).sqrt();
    let across = 2.0 / &w;
    let along = &across / &w / &w;
    let hill = Graph::paraboloid(1.0).unwrap();
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
    let truth = -4.0 / ((Precise::new(x) * x) * 8.0 + 1.0).squared();
    let saddle = Graph::saddle(1.0).unwrap();
    let form = saddle.chart_geometry(Parameters::new(x, x))?.curvature;
    let answer = Answer::near(form.gaussian_curvature(), truth.to_f64()).within(1e-14);
    Ok(answer
        .conditioned(1.0 + x * x)
        .also([form.mean_curvature()]))
}
