//! Spheres that are moved and turned, from not at all to as far as poses go.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use palpate_geometry::surfaces::Sphere;
use palpate_geometry::{InvalidShape, Posed, Surface, SurfaceError};

use super::super::hostile::NOT_FINITE;
use super::super::{Answer, Case};

const MADE: &str = "a radius between 1e-100 and 1e100";
/// Away from all axes.
const TURN: Vector3<f64> = Vector3::new(0.3, -1.1, 0.7);

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for bad in NOT_FINITE.into_iter().chain([1.1e150, -f64::MAX]) {
        for axis in 0..3 {
            cases.push(Case::refusal(
                "geometry::Posed::new",
                format!("moved by {bad:e} along axis {axis}"),
                move || {
                    let mut by = Vector3::zeros();
                    by[axis] = bad;
                    posed(1.0, Isometry3::new(by, TURN))
                },
            ));
        }
    }
    for bad in NOT_FINITE {
        for part in 0..4 {
            cases.push(Case::refusal(
                "geometry::Posed::new",
                format!("part {part} of the turn is {bad:e}"),
                move || {
                    let mut turn = Quaternion::identity();
                    turn.coords[part] = bad;
                    let turn = UnitQuaternion::new_unchecked(turn);
                    posed(1.0, Isometry3::from_parts(Translation3::identity(), turn))
                },
            ));
        }
    }
    for far in [0.0, -0.0, f64::from_bits(1), 1e-300, 1e-9, 1.0, 1e9] {
        for radius in [1e-9, 1.0, 1e9] {
            let moved = format!("a sphere of {radius:e}, moved by {far:e} of it and turned");
            cases.push(Case::value(
                "geometry::Posed::closest_point",
                format!("{moved}: on the line to its centre"),
                move || closest(radius, far),
            ));
            cases.push(Case::value(
                "geometry::Posed::level_set",
                format!("{moved}: normal and curvature"),
                move || level_set(radius, far),
            ));
        }
    }
    for far in [1e17, 1e100, 1e150] {
        cases.push(Case::new(
            "geometry::Posed::closest_point",
            format!("a sphere of 1, moved by {far:e}, from a place 2 above its centre"),
            move || closest(1.0, far).into(),
        ));
        cases.push(Case::value(
            "geometry::Posed::curvature",
            format!("a sphere of 1, moved by {far:e}: in its own chart"),
            move || in_its_chart(far),
        ));
    }
    for angle in [1e-300, 1e-9, 3.0, 1e6, 1e15] {
        cases.push(Case::value(
            "geometry::Posed::contact_at",
            format!("a sphere of 1, turned by {angle:e} rad about x: its top"),
            move || turned(angle),
        ));
    }
    cases
}

fn posed(radius: f64, pose: Isometry3<f64>) -> Result<Posed<Sphere>, InvalidShape> {
    Posed::new(Sphere::new(radius).expect(MADE), pose)
}

/// A sphere that is moved by `far` radii along each axis, its centre, and a direction from there.
fn moved(radius: f64, far: f64) -> (Posed<Sphere>, Point3<f64>, Vector3<f64>) {
    let centre = Vector3::repeat(far * radius);
    let sphere = posed(radius, Isometry3::new(centre, TURN)).expect("a pose up to 1e150");
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
    let found = sphere.chart_geometry(palpate_geometry::Parameters::new(0.4, 0.9))?;
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
    let sphere = posed(1.0, pose).expect("a turn");
    let found = sphere.contact_at(0.0, 0.0)?;
    let truth = [0.0, -libm::sin(angle), libm::cos(angle)];
    let pairs = (0..3).map(|axis| (found[axis], truth[axis]));
    Ok(Answer::all_at_scale(pairs, 1.0).within(2e-15))
}
