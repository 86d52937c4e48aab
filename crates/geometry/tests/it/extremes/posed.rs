//! Spheres that are moved and turned, from not at all to as far as poses go.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{InvalidShape, Parameters, Posed, Surface, SurfaceError};
use palpate_verdict::{Answer, NOT_FINITE, rows};

const NEW: &str = "geometry::Posed::new";
const CLOSEST: &str = "geometry::Posed::closest_point";
const LEVEL_SET: &str = "geometry::Posed::level_set";
const FAR: [f64; 7] = [0.0, -0.0, f64::from_bits(1), 1e-300, 1e-9, 1.0, 1e9];
const RADII: [f64; 3] = [1e-9, 1.0, 1e9];
/// Away from all axes.
const TURN: Vector3<f64> = Vector3::new(0.3, -1.1, 0.7);

rows! {
    NEW, "moved by {bad:e} along axis {axis}", "invalid-shape" => posed(1.0, Isometry3::new(along(axis, bad), TURN)),
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e150, -f64::MAX], for axis in 0..3;
    NEW, "part {part} of the turn is {bad:e}", "invalid-shape" => mistaken(part, bad),
        for bad in NOT_FINITE, for part in 0..4;
    CLOSEST, "a sphere of {radius:e}, moved by {far:e} of it and turned: on the line to its centre" =>
        closest(radius, far), for far in FAR, for radius in RADII;
    LEVEL_SET, "a sphere of {radius:e}, moved by {far:e} of it and turned: normal and curvature" =>
        level_set(radius, far), for far in FAR, for radius in RADII;
    CLOSEST, "a sphere of 1, moved by {far:e}, from a place 2 above its centre", "no-closest-point" =>
        closest(1.0, far), for far in [1e17, 1e100, 1e150];
    "geometry::Posed::curvature", "a sphere of 1, moved by {far:e}: in its own chart" => in_its_chart(far),
        for far in [1e17, 1e100, 1e150];
    "geometry::Posed::contact_at", "a sphere of 1, turned by {angle:e} rad about x: its top" => turned(angle),
        for angle in [1e-300, 1e-9, 3.0, 1e6, 1e15];
}

fn posed(radius: f64, pose: Isometry3<f64>) -> Result<Posed<Sphere>, InvalidShape> {
    Posed::new(Sphere::new(radius).unwrap(), pose)
}

fn along(axis: usize, far: f64) -> Vector3<f64> {
    Vector3::ith(axis, far)
}

fn mistaken(part: usize, bad: f64) -> Result<Posed<Sphere>, InvalidShape> {
    let mut turn = Quaternion::identity();
    turn.coords[part] = bad;
    let turn = UnitQuaternion::new_unchecked(turn);
    posed(1.0, Isometry3::from_parts(Translation3::identity(), turn))
}

/// A sphere that is moved by `far` radii along each axis, its centre, and a direction from there.
fn moved(radius: f64, far: f64) -> (Posed<Sphere>, Point3<f64>, Vector3<f64>) {
    let centre = Vector3::repeat(far * radius);
    let sphere = posed(radius, Isometry3::new(centre, TURN)).unwrap();
    (sphere, centre.into(), Vector3::new(0.36, -0.48, 0.8))
}

/// The last place of where it is counts for more the farther it is.
fn closest(radius: f64, far: f64) -> Result<Answer, SurfaceError> {
    let (sphere, centre, up) = moved(radius, far);
    let found = sphere.closest_point(&(centre + up * (2.0 * radius)))?;
    let off = (found - centre) / radius;
    let pairs = (0..3).map(|axis| (off[axis], up[axis]));
    let answer = Answer::all_at_scale(pairs, 1.0).within(1e-15);
    Ok(answer.conditioned(1.0 + far.abs()).or_no_digits())
}

/// The level set's normal is outward, and `II = I/R` across it, in the world's axes.
fn level_set(radius: f64, far: f64) -> Result<Answer, SurfaceError> {
    let (sphere, centre, up) = moved(radius, far);
    let found = sphere.level_set(&(centre + up * radius))?;
    let across = found.second_form * Vector3::new(0.8, 0.6, 0.0) * radius;
    let normals = (0..3).map(|axis| (found.normal[axis], up[axis]));
    let truth = [0.8, 0.6, 0.0];
    let forms = (0..3).map(|axis| (across[axis], truth[axis]));
    let answer = Answer::all_at_scale(normals.chain(forms), 1.0).within(2e-15);
    Ok(answer.conditioned(1.0 + far.abs()).or_no_digits())
}

/// Geometry of a moved sphere in its chart, which must not depend on where the sphere stands.
fn in_its_chart(far: f64) -> Result<Answer, SurfaceError> {
    let (sphere, ..) = moved(1.0, far);
    let found = sphere.chart_geometry(Parameters::new(0.4, 0.9))?;
    let form = found.curvature;
    let pairs = [
        (form.k_uu, 1.0),
        (form.k_uv, 0.0),
        (form.k_vv, 1.0),
        (found.frame.normal.norm(), 1.0),
    ];
    let answer = Answer::all_at_scale(pairs, 1.0).within(2e-15);
    Ok(answer.also(found.point.iter().copied()))
}

/// `(0, −sin a, cos a)`.
fn turned(angle: f64) -> Result<Answer, SurfaceError> {
    let pose = Isometry3::rotation(Vector3::x() * angle);
    let sphere = posed(1.0, pose).unwrap();
    let found = sphere.contact_at(0.0, 0.0)?;
    let truth = [0.0, -libm::sin(angle), libm::cos(angle)];
    let pairs = (0..3).map(|axis| (found[axis], truth[axis]));
    Ok(Answer::all_at_scale(pairs, 1.0).within(2e-15))
}
