//! Position and size of a plane, a sphere or a cylinder, and the distances of contacts from this shape.
//!
//! Let q = p − o, where p is the position of a contact and o is a point of the surface. n is the surface normal at o, a
//! is the unit vector along the axis of a cylinder, and k is the curvature. Let f = k |q|²/2 + q·n; for a cylinder,
//! |q|² is replaced by |q|² − (q·a)². Then the signed distance is d = 2 f / (1 + √(1 + 2 k f)). This formula is exact.
//! It is smooth at k = 0, where the shape is a plane (Marshall, Lukacs and Martin 2001).

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};
use palpate_statistics::evenly_spaced;

use crate::Shape;
use crate::noise::Resolution;

/// Number of fitted parameters: rotations about the axes a and b and the normal n, a shift along n, and the curvature.
pub(super) const UNKNOWNS: usize = 5;
pub(super) const CURVATURE: usize = 4;

pub(super) type Row = SVector<f64, UNKNOWNS>;
pub(super) type Gram = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Positions and unit normals of contacts, in the unit of the contacts' spread.
#[derive(Clone, Debug, Default)]
pub(super) struct Cloud {
    pub(super) places: Vec<Vector3<f64>>,
    /// Unit normal of each contact; empty if the contacts have no normals.
    pub(super) normals: Vec<Vector3<f64>>,
    /// Steps between the values of the coordinates, if these are rounded.
    pub(super) resolution: Resolution,
    /// Variance of the distances from the shape that rounding causes. Smaller residuals do not show the noise.
    pub(super) rounding_variance: f64,
}

/// Largest number of contacts from which the mean direction of the normals is computed.
const MAX_FACING_CONTACTS: usize = 600;

impl Cloud {
    /// An evenly spaced selection of at most `most` contacts.
    pub(super) fn thinned(&self, most: usize) -> Self {
        self.part(|all| {
            let selection = evenly_spaced(all.len(), most);
            selection.map(|contact| all[contact]).collect()
        })
    }

    pub(super) fn selected(&self, is_used: &[bool]) -> Self {
        self.part(|all| {
            let pairs = all.iter().zip(is_used);
            pairs
                .filter_map(|(one, used)| used.then_some(*one))
                .collect()
        })
    }

    fn part(&self, select: impl Fn(&[Vector3<f64>]) -> Vec<Vector3<f64>>) -> Self {
        Self {
            places: select(&self.places),
            normals: select(&self.normals),
            ..*self
        }
    }

    /// For each coordinate, the variance of the distances from the fitted shape that rounding causes, and the step of
    /// rounding that is assumed.
    pub(super) fn rounding(&self, pose: &Pose) -> (Vector3<f64>, Vector3<f64>) {
        let (mut squares, mut facing) = (Vector3::zeros(), Vector3::zeros());
        let thinned = self.thinned(MAX_FACING_CONTACTS);
        let share = 1.0 / thinned.places.len() as f64;
        for place in &thinned.places {
            let normal = pose.normal_at(place).abs();
            facing += normal * share;
            squares += normal.component_mul(&normal) * share;
        }
        let steps = self.resolution.steps(&facing);
        let variances = squares.component_mul(&steps).component_mul(&steps) / 12.0;
        (variances, steps)
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) shape: Shape,
    /// A point of the shape's surface: the origin of `axes`.
    pub(super) point: Vector3<f64>,
    /// The axes a and b along the surface and the normal n, as rows.
    pub(super) axes: Matrix3<f64>,
    /// Curvature of the shape, > 0 if it is convex, 0 for a plane.
    pub(super) curvature: f64,
}

/// Distance of a contact from the fitted surface, and surface normal at the contact, with their derivatives with
/// respect to the fitted parameters.
pub(super) struct Deviation {
    pub(super) distance: f64,
    pub(super) distance_row: Row,
    pub(super) normal: Vector3<f64>,
    normal_rows: SMatrix<f64, 3, UNKNOWNS>,
}

impl Pose {
    /// The pose with the given point of the surface, the normal at this point, the curvature and, for a cylinder, the
    /// direction of the axis.
    pub(super) fn new(
        shape: Shape,
        point: Vector3<f64>,
        normal: Vector3<f64>,
        axis: Vector3<f64>,
        curvature: f64,
    ) -> Self {
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let along = axis - normal * normal.dot(&axis);
        let along = along.try_normalize(1e-6).unwrap_or_else(|| {
            let mut other = Vector3::zeros();
            other[normal.iamin()] = 1.0;
            (other - normal * normal.dot(&other)).normalize()
        });
        let across = normal.cross(&along);
        let axes = [along, across, normal].map(|axis| axis.transpose());
        Self {
            shape,
            point,
            axes: Matrix3::from_rows(&axes),
            curvature,
        }
    }

    pub(super) fn axis(&self, row: usize) -> Vector3<f64> {
        self.axes.row(row).transpose()
    }

    pub(super) const fn unknowns(&self) -> usize {
        self.shape.unknowns()
    }

    /// Whether the shape has the fitted parameter with the index `unknown`. A plane has no curvature, for example.
    pub(super) fn has(&self, unknown: usize) -> bool {
        match unknown {
            2 => self.shape == Shape::Cylinder,
            CURVATURE => self.shape != Shape::Plane,
            _ => true,
        }
    }

    /// Returns four results. The first is the vector q to the position `place`. The second is the part of q across the
    /// axis of a cylinder; for other shapes, it is q itself. The third is √(1 + 2 k f), and the fourth the signed
    /// distance d. The vectors are in the axes of the pose. The description of the module defines the symbols.
    #[inline]
    fn at(&self, place: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>, f64, f64) {
        let q = self.axes * (place - self.point);
        let across = match self.shape {
            Shape::Cylinder => Vector3::new(0.0, q.y, q.z),
            Shape::Sphere | Shape::Plane => q,
        };
        let f = 0.5 * self.curvature * across.norm_squared() + q.z;
        // `s` is the length of the vector n + k·`across`, where n is the normal of the pose and k the curvature.
        // `across` is the position q without its component along the axis of a cylinder. The length is 0 on the axis of
        // a cylinder and in the centre of a sphere.
        let s = (1.0 + 2.0 * self.curvature * f).max(1e-18).sqrt();
        (q, across, s, 2.0 * f / (1.0 + s))
    }

    #[inline]
    pub(super) fn distance(&self, place: &Vector3<f64>) -> f64 {
        self.at(place).3
    }

    pub(super) fn normal_at(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let (_, across, s, _) = self.at(place);
        self.axes.transpose() * (Vector3::z() + across * self.curvature) / s
    }

    /// Distance of a position from the surface and surface normal there, with their derivatives with respect to the
    /// fitted parameters.
    #[inline]
    pub(super) fn deviation(&self, place: &Vector3<f64>, with_normal: bool) -> Deviation {
        let k = self.curvature;
        let (q, across, s, distance) = self.at(place);
        let (is_cylinder, is_plane) = (self.shape == Shape::Cylinder, self.shape == Shape::Plane);
        let steep = 1.0 + k * q.z;
        let mut distance_row = Row::zeros();
        distance_row[0] = -q.y;
        distance_row[1] = if is_cylinder { steep * q.x } else { q.x };
        distance_row[2] = if is_cylinder { -k * q.y * q.x } else { 0.0 };
        distance_row[3] = -steep;
        let bend = 0.5 * (across.norm_squared() - distance * distance);
        distance_row[4] = if is_plane { 0.0 } else { bend };
        distance_row /= s;
        let mut deviation = Deviation {
            distance,
            distance_row,
            normal: Vector3::zeros(),
            normal_rows: SMatrix::zeros(),
        };
        if with_normal {
            let normal = (Vector3::z() + across * k) / s;
            let columns = [
                Vector3::new(0.0, -1.0, 0.0),
                match is_cylinder {
                    true => Vector3::new(steep, 0.0, k * q.x),
                    false => Vector3::x(),
                },
                match is_cylinder {
                    true => Vector3::new(-k * q.y, -k * q.x, 0.0),
                    false => Vector3::zeros(),
                },
                Vector3::new(0.0, 0.0, -k),
                if is_plane { Vector3::zeros() } else { across },
            ];
            let columns = columns.map(|change| (change - normal * normal.dot(&change)) / s);
            deviation.normal = normal;
            deviation.normal_rows = SMatrix::from_columns(&columns);
        }
        deviation
    }

    /// The pose after a change of its parameters by `step`. The reference point of the new pose is the point of the
    /// surface that is nearest to `middle`.
    pub(super) fn moved(&self, step: &Row, middle: &Vector3<f64>) -> Self {
        let turn = self.axes.transpose() * Vector3::new(step[0], step[1], step[2]);
        let turn = Rotation3::new(turn);
        let mut next = *self;
        next.point += self.axis(2) * step[3];
        next.curvature += step[CURVATURE];
        for row in 0..3 {
            next.axes.set_row(row, &(turn * self.axis(row)).transpose());
        }
        next.based_at(middle)
    }

    /// The same surface with the point nearest to `place` as reference point. Near the centre of a sphere or the axis
    /// of a cylinder, the reference point does not change.
    pub(super) fn based_at(&self, place: &Vector3<f64>) -> Self {
        let (_, _, s, distance) = self.at(place);
        if s < 0.05 || s.is_nan() {
            return *self;
        }
        let normal = self.normal_at(place);
        let point = place - normal * distance;
        Self::new(self.shape, point, normal, self.axis(0), self.curvature)
    }

    pub(super) fn reversed(&self) -> Self {
        let (normal, axis) = (-self.axis(2), self.axis(0));
        Self::new(self.shape, self.point, normal, axis, -self.curvature)
    }

    #[inline]
    pub(super) fn in_axes(&self, normal: &Vector3<f64>) -> Vector3<f64> {
        self.axes * normal
    }
}

impl Deviation {
    pub(super) fn normal_row(&self, unknown: usize) -> Vector3<f64> {
        self.normal_rows.column(unknown).into()
    }

    pub(super) fn normal_gram(&self) -> Gram {
        self.normal_rows.transpose() * self.normal_rows
    }
}

/// Sums of squares, and normal equations, for two kinds of deviations of the contacts from the shape: distances, and
/// differences of normals. All deviations are assumed to have variance 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations {
    pub(super) grams: [Gram; 2],
    /// The part of the second of `grams` that is due to the components of normals along the pose's first axis.
    pub(super) axial_gram: Gram,
    pub(super) gradients: [Row; 2],
    pub(super) squares: [f64; 2],
    /// Number of summed deviations: of distances, and of components of normals.
    pub(super) counts: [f64; 2],
}

impl Equations {
    pub(super) fn new(pose: &Pose, cloud: &Cloud) -> Self {
        let mut all = Self {
            grams: [Gram::zeros(); 2],
            axial_gram: Gram::zeros(),
            gradients: [Row::zeros(); 2],
            squares: [0.0; 2],
            counts: [cloud.places.len() as f64, 2.0 * cloud.normals.len() as f64],
        };
        let with_normals = !cloud.normals.is_empty();
        for (index, place) in cloud.places.iter().enumerate() {
            let one = pose.deviation(place, with_normals);
            all.grams[0] += one.distance_row * one.distance_row.transpose();
            all.gradients[0] -= one.distance_row * one.distance;
            all.squares[0] += one.distance * one.distance;
            if with_normals {
                let left = pose.in_axes(&cloud.normals[index]) - one.normal;
                all.grams[1] += one.normal_gram();
                let axial = one.normal_rows.row(0);
                all.axial_gram += axial.transpose() * axial;
                all.gradients[1] += one.normal_rows.transpose() * left;
                all.squares[1] += left.norm_squared();
            }
        }
        all
    }

    /// Returns −1/2 times the gradient of a contact's weighted sum of squared deviations (of distance and of normal),
    /// with respect to the fitted parameters.
    pub(super) fn gradient(pose: &Pose, cloud: &Cloud, index: usize, weights: [f64; 2]) -> Row {
        let normal = cloud.normals.get(index);
        let one = pose.deviation(&cloud.places[index], normal.is_some());
        let mut gradient = -one.distance_row * (one.distance * weights[0]);
        if let Some(normal) = normal {
            let left = pose.in_axes(normal) - one.normal;
            gradient += one.normal_rows.transpose() * left * weights[1];
        }
        gradient
    }
}
