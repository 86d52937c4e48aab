//! Start values of planes, spheres and cylinders, by linear least squares.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector2, Vector3, Vector4};

use super::pose::{Cloud, Pose};
use crate::Shape;

/// Number of directions that are compared as the axis of a cylinder, evenly distributed over the hemisphere.
const DIRECTIONS: usize = 60;
/// Number of axis directions from which fits of a cylinder start. They are the directions whose cylinders fit the
/// contacts best.
const BEST_DIRECTIONS: usize = 4;

pub(super) fn middle(cloud: &Cloud) -> Vector3<f64> {
    let sum: Vector3<f64> = cloud.places.iter().sum();
    sum / cloud.places.len().max(1) as f64
}

pub(super) fn starts(shape: Shape, cloud: &Cloud) -> Vec<Pose> {
    let middle = middle(cloud);
    let mut moment = Matrix3::zeros();
    for place in &cloud.places {
        moment += (place - middle) * (place - middle).transpose();
    }
    let axes = SymmetricEigen::new(moment).eigenvectors;
    let principal: Vec<Vector3<f64>> = axes.column_iter().map(Into::into).collect();
    let normal = match cloud
        .normals
        .iter()
        .sum::<Vector3<f64>>()
        .try_normalize(0.1)
    {
        Some(mean) => mean,
        None => smallest_axis(&moment),
    };
    let flat = |axis: Vector3<f64>| Pose::new(shape, middle, normal, axis, 0.0);
    let poses = match shape {
        Shape::Plane => vec![flat(Vector3::x())],
        Shape::Sphere => vec![flat(Vector3::x())]
            .into_iter()
            .chain(sphere(cloud, &middle))
            .collect(),
        Shape::Cylinder => {
            let mut spread = Matrix3::zeros();
            for normal in &cloud.normals {
                spread += normal * normal.transpose();
            }
            let bends = quadric_directions(cloud, &middle, &normal);
            let mut directions = principal;
            if !cloud.normals.is_empty() {
                directions.push(smallest_axis(&spread));
            }
            directions.extend((0..DIRECTIONS).map(hemisphere));
            let mut scored: Vec<(f64, Pose)> = directions
                .iter()
                .filter_map(|axis| circle(cloud, &middle, axis))
                .collect();
            scored.sort_by(|(one, _), (other, _)| one.total_cmp(other));
            scored.truncate(BEST_DIRECTIONS);
            let of_bends = bends.into_iter().flat_map(|axis| {
                let (_, pose) = circle(cloud, &middle, &axis).unzip();
                [Some(flat(axis)), pose]
            });
            let poses = scored.into_iter().map(|(_, pose)| pose);
            poses.chain(of_bends.flatten()).collect()
        }
    };
    poses.into_iter().map(|pose| outward(pose, cloud)).collect()
}

/// The pose, with inside and outside exchanged if the measured normals point inwards.
fn outward(pose: Pose, cloud: &Cloud) -> Pose {
    let pairs = cloud.places.iter().zip(&cloud.normals);
    let agreement: f64 = pairs
        .map(|(place, normal)| pose.normal_at(place).dot(normal))
        .sum();
    if agreement < 0.0 {
        pose.reversed()
    } else {
        pose
    }
}

fn smallest_axis(moment: &Matrix3<f64>) -> Vector3<f64> {
    let eigen = SymmetricEigen::new(*moment);
    eigen.eigenvectors.column(eigen.eigenvalues.imin()).into()
}

/// The direction with the index `index` of [`DIRECTIONS`] directions. They lie on a spiral and are evenly distributed
/// over the hemisphere.
fn hemisphere(index: usize) -> Vector3<f64> {
    let height = (index as f64 + 0.5) / DIRECTIONS as f64;
    let turn = index as f64 * PI * (3.0 - 5.0_f64.sqrt());
    let radius = (1.0 - height * height).sqrt();
    Vector3::new(radius * libm::cos(turn), radius * libm::sin(turn), height)
}

/// The sphere with the smallest algebraic residual (Kåsa's fit) through the contacts.
fn sphere(cloud: &Cloud, middle: &Vector3<f64>) -> Option<Pose> {
    let (mut gram, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for place in &cloud.places {
        let q = place - middle;
        let row = Vector4::new(q.x, q.y, q.z, 1.0);
        gram += row * row.transpose();
        right += row * q.norm_squared();
    }
    let solved = gram.cholesky()?.solve(&right);
    let centre = middle + 0.5 * solved.xyz();
    let radius = (solved.w + 0.25 * solved.xyz().norm_squared())
        .max(0.0)
        .sqrt();
    let normal = (middle - centre)
        .try_normalize(1e-3 * radius)
        .unwrap_or_else(Vector3::z);
    let is_good = radius > 1e-6 && radius < 1e6;
    let pose = Pose::new(
        Shape::Sphere,
        centre + normal * radius,
        normal,
        Vector3::x(),
        radius.recip(),
    );
    is_good.then_some(pose)
}

/// Fits a cylinder with the axis direction `axis` to the contacts, by an algebraic fit. Returns two results: the sum of
/// the contacts' squared distances from the cylinder, and the cylinder.
fn circle(cloud: &Cloud, middle: &Vector3<f64>, axis: &Vector3<f64>) -> Option<(f64, Pose)> {
    let frame = Pose::new(Shape::Cylinder, *middle, *axis, Vector3::x(), 0.0);
    let (one, other) = (frame.axis(0), frame.axis(1));
    let (mut gram, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for place in &cloud.places {
        let q = place - middle;
        let plane = Vector2::new(q.dot(&one), q.dot(&other));
        let row = Vector3::new(plane.x, plane.y, 1.0);
        gram += row * row.transpose();
        right += row * plane.norm_squared();
    }
    let solved = gram.cholesky()?.solve(&right);
    let centre = 0.5 * (one * solved.x + other * solved.y);
    let radius = (solved.z + centre.norm_squared()).max(0.0).sqrt();
    let normal = (-centre).try_normalize(1e-3 * radius).unwrap_or(one);
    if !(radius > 1e-6 && radius < 1e6) {
        return None;
    }
    let point = middle + centre + normal * radius;
    let pose = Pose::new(Shape::Cylinder, point, normal, *axis, radius.recip());
    let squares = cloud
        .places
        .iter()
        .map(|place| pose.distance(place).powi(2));
    Some((squares.sum(), pose))
}

/// Principal directions of a quadric that is fitted to the contacts, as a graph over the plane perpendicular to
/// `normal`.
fn quadric_directions(
    cloud: &Cloud,
    middle: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Vec<Vector3<f64>> {
    let frame = Pose::new(Shape::Plane, *middle, *normal, Vector3::x(), 0.0);
    let (mut gram, mut right) = (nalgebra::Matrix6::zeros(), nalgebra::Vector6::zeros());
    for place in &cloud.places {
        let q = frame.axes * (place - middle);
        let row = nalgebra::Vector6::new(1.0, q.x, q.y, q.x * q.x, q.x * q.y, q.y * q.y);
        gram += row * row.transpose();
        right += row * q.z;
    }
    let Some(factor) = gram.cholesky() else {
        return Vec::new();
    };
    let solved = factor.solve(&right);
    let turn = 0.5 * libm::atan2(solved[4], solved[3] - solved[5]);
    let [one, other] = [turn, turn + 0.5 * PI]
        .map(|turn| frame.axis(0) * libm::cos(turn) + frame.axis(1) * libm::sin(turn));
    vec![one, other]
}
