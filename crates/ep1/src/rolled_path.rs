//! The path of the contact over the probe during a roll, for an object whose curvature changes along the path.
//!
//! Lengths are in radii of the probe. The contact frame is carried along the path on both bodies. In this frame, the
//! object's curvature form is a polynomial in the contact's position x on the object. By the equations of Codazzi, the
//! derivatives of the form are symmetric tensors, so that the drive g = (−Δθ_y, Δθ_x), summed over the path, is the
//! gradient of one polynomial:
//!
//! ```text
//! g(x) = x + Σ_m T_m x^(m−1) / (m−1)! ,   m = 2, 3, …
//! ```
//!
//! T₂ is the curvature form at the start, and T₃ contains its first derivatives.

use nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, UnitQuaternion, Vector2, Vector3};

/// Largest number of terms of the curvature along a path.
pub(crate) const MAX_TERMS: usize = 4;
/// Number of coefficients of the largest number of terms.
pub(crate) const MAX_COEFFICIENTS: usize = coefficients(MAX_TERMS);
/// Number of Newton steps that solve for the position of the contact. The first guess is accurate to second order.
const NEWTON_STEPS: usize = 3;

/// Number of coefficients of this number of terms: 3 for the form, 4 for its first derivatives, and so on.
pub(crate) const fn coefficients(terms: usize) -> usize {
    terms * (terms + 5) / 2
}

/// A polynomial model of the object near the common start of the rolls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalShape {
    pub(crate) terms: usize,
    /// Entries of the tensors T₂, T₃, … For each tensor, entry j has j indices v.
    pub(crate) tensors: [f64; MAX_COEFFICIENTS],
}

/// The derivatives of the drive with respect to the coefficients.
pub(crate) type Basis = [[f64; 2]; MAX_COEFFICIENTS];

impl LocalShape {
    pub(crate) fn of_mobility(mobility: &Matrix2<f64>) -> Option<Self> {
        let form = mobility.try_inverse()? - Matrix2::identity();
        let mut tensors = [0.0; MAX_COEFFICIENTS];
        tensors[..3].copy_from_slice(&[form[(0, 0)], form[(0, 1)], form[(1, 1)]]);
        Some(Self { terms: 1, tensors })
    }

    /// The sum of the curvature forms of probe and object at the start.
    pub(crate) fn relative(&self) -> Matrix2<f64> {
        let [uu, uv, vv, ..] = self.tensors;
        Matrix2::new(1.0 + uu, uv, uv, 1.0 + vv)
    }

    /// Derivatives of the drive at `x` with respect to the coefficients.
    pub(crate) fn basis(terms: usize, x: &Vector2<f64>) -> Basis {
        let mut basis = [[0.0; 2]; MAX_COEFFICIENTS];
        basis[0] = [x.x, 0.0];
        basis[1] = [x.y, x.x];
        basis[2] = [0.0, x.y];
        for term in 1..terms {
            // Entry j of the tensor of order m has the factor x^(m−1−j) y^j C(m−1, j) / (m−1)! along u.
            let power = term + 1;
            let from = coefficients(term);
            let mut monomial = [0.0; MAX_TERMS + 1];
            for (j, monomial) in monomial[..=power].iter_mut().enumerate() {
                let parts = factorial(j) * factorial(power - j);
                *monomial = x.x.powi((power - j) as i32) * x.y.powi(j as i32) / parts;
            }
            for j in 0..=power {
                basis[from + j][0] += monomial[j];
                basis[from + j + 1][1] += monomial[j];
            }
        }
        basis
    }

    /// The drive of a contact at `x`, and its derivative, which is the sum of the curvature forms of both bodies.
    fn drive(&self, x: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        if self.terms == 1 {
            let relative = self.relative();
            return (relative * x, relative);
        }
        let mut drive = *x;
        let basis = Self::basis(self.terms, x);
        let count = coefficients(self.terms);
        for (basis, tensor) in basis.iter().zip(&self.tensors).take(count) {
            drive.x += basis[0] * tensor;
            drive.y += basis[1] * tensor;
        }
        let mut relative = self.relative();
        for term in 1..self.terms {
            let from = coefficients(term);
            for j in 0..=term {
                let parts = factorial(j) * factorial(term - j);
                let monomial = x.x.powi((term - j) as i32) * x.y.powi(j as i32) / parts;
                let [uu, uv, vv] = [0, 1, 2].map(|more| self.tensors[from + j + more] * monomial);
                relative += Matrix2::new(uu, uv, uv, vv);
            }
        }
        (drive, relative)
    }
}

fn factorial(number: usize) -> f64 {
    (1..=number).map(|factor| factor as f64).product()
}

/// The rotations of a roll at the samples that a fit uses.
#[derive(Clone, Debug, Default)]
pub(crate) struct RollRotations {
    /// Rotation vectors between successive samples, in the axes of the probe's body.
    steps: Vec<Vector3<f64>>,
    /// Whether the measured rotation about the normal is used. With noise, rolls are assumed not to spin, because an
    /// error of the spin would turn the rest of the path.
    has_spin: bool,
}

/// The contact at one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathPoint {
    /// The contact frame, relative to the contact frame at the start.
    frame: Matrix3<f64>,
    /// Position of the contact on the object, in the carried frame.
    pub(crate) x: Vector2<f64>,
    /// The measured drive, summed over the path.
    pub(crate) drive: Vector2<f64>,
    /// Inverse of the sum of the curvature forms of both bodies at the contact.
    pub(crate) mobility: Matrix2<f64>,
    /// Angle by which the probe has spun about the normal.
    spin: f64,
}

impl RollRotations {
    /// The rotations at samples with these rotation vectors since the start.
    pub(crate) fn new(rotations: impl Iterator<Item = Vector3<f64>>, has_spin: bool) -> Self {
        let mut last = Vector3::zeros();
        let steps = rotations.map(|rotation| {
            // Parallel rotation vectors are subtracted, which is exact and faster than a product of quaternions.
            let across = last.cross(&rotation).norm_squared();
            let scale = last.norm_squared() * rotation.norm_squared();
            let step = match across <= 1e-24 * scale {
                true => rotation - last,
                false => {
                    let [from, to] = [last, rotation].map(UnitQuaternion::from_scaled_axis);
                    (from.inverse() * to).scaled_axis()
                }
            };
            last = rotation;
            step
        });
        Self {
            steps: steps.collect(),
            has_spin,
        }
    }

    /// The contacts at all samples. `error` is an error of the measured drive, relative to the true drive, and `ratio`
    /// is the ratio of the true to the measured drive. `None` if the contact cannot follow the rotations.
    pub(crate) fn path(
        &self,
        shape: &LocalShape,
        error: &Vector2<f64>,
        ratio: f64,
        path: &mut Vec<PathPoint>,
    ) -> Option<()> {
        path.clear();
        let start = PathPoint {
            frame: Matrix3::identity(),
            x: Vector2::zeros(),
            drive: Vector2::zeros(),
            mobility: shape.relative().try_inverse()?,
            spin: 0.0,
        };
        let mut at = start;
        for step in &self.steps {
            at = at.after(shape, step, self.has_spin, error * ratio)?;
            path.push(at);
        }
        Some(())
    }
}

impl PathPoint {
    fn after(
        &self,
        shape: &LocalShape,
        step: &Vector3<f64>,
        has_spin: bool,
        error: Vector2<f64>,
    ) -> Option<Self> {
        let drive_of = |turn: &Vector3<f64>| Vector2::new(-turn.y, turn.x);
        let mut in_frame = self.frame.tr_mul(step);
        let half = self.mobility * drive_of(&in_frame) * 0.5;
        let tilt = Vector3::new(-half.y, half.x, 0.0);
        if !has_spin {
            in_frame.z = tilt.x * in_frame.y - tilt.y * in_frame.x;
        }
        let once = tilt.cross(&in_frame);
        let turn = in_frame - once + tilt.cross(&once) * 0.5;
        let turned = if has_spin { turn.z } else { 0.0 };
        let spin = self.spin + turned;
        let mean_spin = self.spin + 0.5 * turned;
        let drive = self.drive + spun(&drive_of(&turn), mean_spin);
        let true_drive = drive - error * drive.norm();
        let mut x = self.x;
        let mut mobility = self.mobility;
        for _ in 0..if shape.terms == 1 { 1 } else { NEWTON_STEPS } {
            let (at_x, relative) = shape.drive(&x);
            mobility = relative.try_inverse()?;
            if mobility.determinant() <= 0.0 || mobility.trace() <= 0.0 {
                return None;
            }
            x += mobility * (true_drive - at_x);
        }
        let along = spun(&(x - self.x), -mean_spin);
        let frame = self.frame * rolled(&along);
        let is_finite = x.norm() < std::f64::consts::PI;
        is_finite.then_some(Self {
            frame,
            x,
            drive,
            mobility,
            spin,
        })
    }
}

/// A vector after a rotation by `angle`.
fn spun(vector: &Vector2<f64>, angle: f64) -> Vector2<f64> {
    if angle == 0.0 {
        return *vector;
    }
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(
        cos * vector.x - sin * vector.y,
        sin * vector.x + cos * vector.y,
    )
}

/// The contact frame after the contact has moved by `along` on the unit sphere, relative to the frame before.
fn rolled(along: &Vector2<f64>) -> Matrix3<f64> {
    let square = along.norm_squared();
    let angle = square.sqrt();
    let (sin, cos) = libm::sincos(angle);
    let (per_sin, per_cos) = match angle < 1e-9 {
        true => (1.0, 0.5),
        false => (sin / angle, (1.0 - cos) / square),
    };
    let (u, v) = (along.x, along.y);
    Matrix3::new(
        1.0 - per_cos * u * u,
        -per_cos * u * v,
        per_sin * u,
        -per_cos * u * v,
        1.0 - per_cos * v * v,
        per_sin * v,
        -per_sin * u,
        -per_sin * v,
        cos,
    )
}

/// The start of a roll on the unit sphere, with the axes of the pads carried there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartFrame {
    frame: Matrix3<f64>,
    /// Angular velocities of the frame if the start moves along u or along v.
    turns: [Vector3<f64>; 2],
}

/// A contact in the chart of the probe, with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) place: Vector2<f64>,
    /// Derivatives with respect to the start.
    pub(crate) by_start: Matrix2<f64>,
    /// Derivatives with respect to the position on the object.
    pub(crate) by_path: Matrix2<f64>,
}

impl StartFrame {
    pub(crate) fn new(start: &Vector2<f64>) -> Self {
        let turn = Vector3::new(-start.y, start.x, 0.0);
        let angle = start.norm();
        let (of_cross, of_square) = match angle < 1e-4 {
            true => (0.5, 1.0 / 6.0),
            false => {
                let (sin, cos) = libm::sincos(angle);
                ((1.0 - cos) / (angle * angle), (angle - sin) / angle.powi(3))
            }
        };
        let turns = [Vector3::y(), -Vector3::x()].map(|axis| {
            let cross = turn.cross(&axis);
            axis - cross * of_cross + turn.cross(&cross) * of_square
        });
        Self {
            frame: *Rotation3::from_scaled_axis(turn).matrix(),
            turns,
        }
    }

    pub(crate) fn place(&self, at: &PathPoint) -> Place {
        let local = at.frame.column(2).into_owned();
        let direction = self.frame * local;
        let across = direction.xy();
        let sine = across.norm();
        let angle = libm::atan2(sine, direction.z);
        let (radial, stretch) = match sine < 1e-12 {
            true => (Vector2::x(), 1.0),
            false => (across / sine, angle / sine),
        };
        let outward = Vector3::new(radial.x * direction.z, radial.y * direction.z, -sine);
        let around = Vector2::new(-radial.y, radial.x);
        let in_chart = |tangent: &Vector3<f64>| {
            radial * tangent.dot(&outward) + around * (stretch * tangent.xy().dot(&around))
        };
        let by_start = self
            .turns
            .map(|turn| in_chart(&(self.frame * turn.cross(&local))));
        // A displacement across a straight path is shorter on a sphere than on a plane.
        let length = at.x.norm();
        let (along, narrow) = match length < 1e-6 {
            true => (Vector2::x(), 1.0),
            false => (at.x / length, libm::sin(length) / length),
        };
        let axes = self.frame * at.frame.fixed_columns::<2>(0);
        let by_path = [Vector2::x(), Vector2::y()].map(|axis| {
            let part = along * along.dot(&axis);
            let displacement = spun(&(part + (axis - part) * narrow), -at.spin);
            in_chart(&(axes * displacement))
        });
        Place {
            place: across * stretch,
            by_start: Matrix2::from_columns(&by_start),
            by_path: Matrix2::from_columns(&by_path),
        }
    }
}

/// Derivatives of a place with respect to the first `N` coefficients of the shape. `x` is the position of the contact
/// without the errors of the measured drive.
pub(crate) fn by_coefficients<const N: usize>(
    terms: usize,
    x: &Vector2<f64>,
    by_drive: &Matrix2<f64>,
) -> SMatrix<f64, 2, N> {
    let basis = LocalShape::basis(terms, x);
    SMatrix::from_fn(|row, column| {
        let [u, v] = basis[column];
        -(by_drive[(row, 0)] * u + by_drive[(row, 1)] * v)
    })
}
