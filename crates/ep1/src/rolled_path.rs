//! The path of the contact over the probe during a roll, for an object whose curvature changes along the path.
//!
//! Lengths are in radii of the probe. The contact frame moves along the path on the object by parallel transport, so it
//! does not spin on the object. Relative to the probe, it turns about the contact normal by the negative of the probe's
//! spin. In this frame, the object's curvature form is a polynomial in the contact's position x on the object. By the
//! equations of Codazzi, the derivatives of the form are symmetric tensors. Therefore the drive g = (−Δθ_y, Δθ_x),
//! which is the rotation vector, turned by 90° and summed over the path, is the gradient of one polynomial:
//!
//! ```text
//! g(x) = x + Σ_m T_m x^(m−1) / (m−1)! ,   m = 2, 3, …
//! ```
//!
//! T₂ is the curvature form at the start, and T₃ contains its first derivatives.

use nalgebra::{Matrix2, Matrix3, Rotation3, SMatrix, UnitQuaternion, Vector2, Vector3};

use crate::symmetric::is_rolling;

/// Largest number of terms of the polynomial that describes the curvature along a path.
pub(crate) const MAX_TERMS: usize = 6;
/// Number of coefficients of a polynomial with [`MAX_TERMS`] terms.
pub(crate) const MAX_COEFFICIENTS: usize = coefficients(MAX_TERMS);
/// Largest number of Newton steps that solve for the position of the contact.
const NEWTON_STEPS: usize = 4;
/// If a Newton step is shorter than this value, the iteration ends. The remaining error is about the square of the
/// step, which is negligible.
const SMALL_STEP: f64 = 1e-5;
/// Smallest rotation about the contact normal during a roll that counts as a spin (rad).
pub(crate) const MIN_ANGLE: f64 = 0.02;

/// Number of coefficients of a polynomial with `terms` terms: 3 for the curvature form, 4 more for its first
/// derivatives, and so on.
pub(crate) const fn coefficients(terms: usize) -> usize {
    terms * (terms + 5) / 2
}

/// A polynomial model of the object near the common start of the rolls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalShape {
    pub(crate) terms: usize,
    /// Entries of the symmetric tensors T₂, T₃, … one tensor after the other. The entry j (from 0) of a tensor has j
    /// indices v; its other indices are u.
    pub(crate) tensors: [f64; MAX_COEFFICIENTS],
}

/// Derivatives of the drive (rotation vector, turned by 90°) with respect to the coefficients of a [`LocalShape`].
pub(crate) type Basis = [[f64; 2]; MAX_COEFFICIENTS];

impl LocalShape {
    /// A flat object.
    pub(crate) const FLAT: Self = Self {
        terms: 1,
        tensors: [0.0; MAX_COEFFICIENTS],
    };

    pub(crate) fn of_mobility(mobility: &Matrix2<f64>) -> Option<Self> {
        let form = mobility.try_inverse()? - Matrix2::identity();
        let mut tensors = [0.0; MAX_COEFFICIENTS];
        tensors[..3].copy_from_slice(&[form[(0, 0)], form[(0, 1)], form[(1, 1)]]);
        Some(Self { terms: 1, tensors })
    }

    /// The sum of the curvature forms of probe and object at the start of the rolls.
    pub(crate) fn relative(&self) -> Matrix2<f64> {
        let [uu, uv, vv, ..] = self.tensors;
        Matrix2::new(1.0 + uu, uv, uv, 1.0 + vv)
    }

    /// Change of the curvature form from the start of the rolls to `x`, in units of the probe's curvature.
    pub(crate) fn change(&self, x: &Vector2<f64>) -> f64 {
        (self.drive(x).1 - self.relative()).norm()
    }

    /// Derivatives of the drive (rotation vector, turned by 90°) at the contact position `x` with respect to the
    /// coefficients of the polynomial.
    pub(crate) fn basis(terms: usize, x: &Vector2<f64>) -> Basis {
        let (along, across) = (powers(x.x), powers(x.y));
        let mut basis = [[0.0; 2]; MAX_COEFFICIENTS];
        for term in 0..terms {
            let (power, from) = (term + 1, coefficients(term));
            for j in 0..=power {
                let monomial = along[power - j] * across[j];
                basis[from + j][0] += monomial;
                basis[from + j + 1][1] += monomial;
            }
        }
        basis
    }

    /// The drive (rotation vector, turned by 90°) that moves the contact to `x`. The second result is the derivative of
    /// the drive, which is the sum of the curvature forms of both bodies.
    fn drive(&self, x: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let mut relative = self.relative();
        let (along, across) = (powers(x.x), powers(x.y));
        let mut drive = relative * x;
        for term in 1..self.terms {
            let tensor = &self.tensors[coefficients(term)..];
            for j in 0..=term {
                let monomial = along[term - j] * across[j];
                relative +=
                    Matrix2::new(tensor[j], tensor[j + 1], tensor[j + 1], tensor[j + 2]) * monomial;
            }
            for j in 0..=term + 1 {
                let monomial = along[term + 1 - j] * across[j];
                drive += Vector2::new(tensor[j], tensor[j + 1]) * monomial;
            }
        }
        (drive, relative)
    }
}

/// The numbers `x^k / k!` for k = 0, 1, …
fn powers(x: f64) -> [f64; MAX_TERMS + 1] {
    let mut powers = [1.0; MAX_TERMS + 1];
    for power in 1..=MAX_TERMS {
        powers[power] = powers[power - 1] * x / power as f64;
    }
    powers
}

/// The rotations of a roll at the samples that a fit uses.
#[derive(Clone, Debug, Default)]
pub(crate) struct RollRotations {
    rotations: Vec<Vector3<f64>>,
    /// Rotation vectors from one sample to the next. Empty if the measured rotation about the normal is not used. Then
    /// rolls are assumed not to spin.
    steps: Vec<Vector3<f64>>,
}

/// The contact at one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathPoint {
    /// Orientation of the contact frame on the probe, relative to the contact frame at the start of the roll.
    frame: Matrix3<f64>,
    /// Position of the contact on the object, in the carried frame.
    pub(crate) x: Vector2<f64>,
    /// The drive (rotation vector, turned by 90°), summed over the path from the start.
    drive: Vector2<f64>,
    /// Mobility (contact travel per radian): the inverse of the sum of the curvature forms of both bodies at the
    /// contact.
    pub(crate) mobility: Matrix2<f64>,
    /// Angle by which the probe has rotated about the contact normal since the start of the roll.
    spin: f64,
}

impl RollRotations {
    /// The rotations of a roll. `rotations` contains, for each sample, the rotation vector since the start of the roll.
    pub(crate) fn new(rotations: Vec<Vector3<f64>>, has_spin: bool) -> Self {
        let used: &[_] = if has_spin { &rotations } else { &[] };
        Self {
            steps: steps(used.iter().copied()),
            rotations,
        }
    }

    /// The rotation vectors of the samples since the start of the roll.
    pub(crate) fn rotations(&self) -> &[Vector3<f64>] {
        &self.rotations
    }

    /// Whether the measured rotations about the contact normal are used.
    pub(crate) fn has_spin(&self) -> bool {
        !self.steps.is_empty()
    }

    /// Whether the probe spins. If it spins, the drive at a contact depends on where the contact is. Only differences
    /// of paths include this effect.
    pub(crate) fn is_spun(&self) -> bool {
        let mut used = self.rotations.iter().filter(|_| self.has_spin());
        used.any(|one| one.z.abs() > MIN_ANGLE)
    }

    /// Computes the contacts at all samples and writes them to `path`. `error` is the error of the measured drive
    /// (rotation vector, turned by 90°), divided by the magnitude of the measured drive. `None` if the contact cannot
    /// follow the rotations, because it would not roll on this shape.
    pub(crate) fn path(
        &self,
        shape: &LocalShape,
        error: &Vector2<f64>,
        path: &mut Vec<PathPoint>,
    ) -> Option<()> {
        path.clear();
        let mut at = PathPoint {
            frame: Matrix3::identity(),
            x: Vector2::zeros(),
            drive: Vector2::zeros(),
            mobility: shape.relative().try_inverse().filter(is_rolling)?,
            spin: 0.0,
        };
        let turned = Vector3::new(error.y, -error.x, 0.0);
        let rotations = self.rotations.iter();
        let rotations = rotations.map(|one| one - turned * drive_of(one).norm());
        if self.has_spin() {
            let corrected = (turned != Vector3::zeros()).then(|| steps(rotations.clone()));
            for step in corrected.as_ref().unwrap_or(&self.steps) {
                at = at.after(shape, &at.turn_of(step))?;
                path.push(at);
            }
            return Some(());
        }
        let mut last = Vector3::zeros();
        for rotation in rotations {
            let (turn, normal_part) = at.turn_without_spin(&last, &rotation.xy())?;
            last = rotation.xy().push(normal_part);
            at = at.after(shape, &turn)?;
            path.push(at);
        }
        Some(())
    }
}

impl PathPoint {
    /// Returns the rotation vector of the probe between two samples (`step`) in the coordinates of the contact frame.
    /// The contact frame turns during the step, so the result is the mean over the step.
    fn turn_of(&self, step: &Vector3<f64>) -> Vector3<f64> {
        let turn_of_frame = |turn: &Vector3<f64>| {
            let along = self.mobility * drive_of(turn);
            Vector3::new(-along.y, along.x, -turn.z)
        };
        let at_start = self.frame.tr_mul(step);
        // The frame's rate of rotation changes during the step. To second order in the step, the mean over the step
        // depends only on the rate at one third of the step.
        let at_third = at_start - turn_of_frame(&at_start).cross(&at_start) / 3.0;
        let turn = turn_of_frame(&at_third);
        let once = turn.cross(&at_start);
        at_start - once * 0.5 + turn.cross(&once) / 6.0
    }

    /// Computes the next step of a roll without spin. The rotation vectors are counted from the start of the roll.
    /// `last` is the rotation vector at the beginning of the step, and `tangential` its tangential part at the end of the
    /// step. Returns the rotation of the step in the contact
    /// frame, and the normal component of the rotation vector at the end of the step.
    fn turn_without_spin(
        &self,
        last: &Vector3<f64>,
        tangential: &Vector2<f64>,
    ) -> Option<(Vector3<f64>, f64)> {
        let step = tangential - last.xy();
        let frame =
            self.frame * rolled(&(self.mobility * Vector2::new(-step.y, step.x) * 0.5), 0.0);
        // Without spin, the normal component of the rotation vector follows from its tangential part. Its value at the
        // middle of the step is needed to first order.
        let turned = frame * step.push(0.0);
        let mut middle = last + step.push(turned.z) * 0.5;
        middle.z += 0.25 * middle.xy().perp(&turned.xy());
        // `slopes` is the derivative of the rotation vector with respect to a small rotation of the probe.
        let square = middle.norm_squared();
        let of_square = 1.0 / 12.0 + square * (1.0 / 720.0 + square / 30_240.0);
        let slopes = middle * (middle.transpose() * of_square) + middle.cross_matrix() * 0.5;
        let slopes = slopes + Matrix3::from_diagonal_element(1.0 - of_square * square);
        let slopes = slopes * frame.fixed_columns::<2>(0);
        let turn = slopes.fixed_rows::<2>(0).try_inverse()? * step;
        let normal_part = last.z + slopes.row(2).tr_dot(&turn);
        Some((turn.push(0.0), normal_part))
    }

    /// The contact after the probe has rotated by `turn`, a rotation vector in the contact frame.
    fn after(&self, shape: &LocalShape, turn: &Vector3<f64>) -> Option<Self> {
        let drive = self.drive + drive_of(turn);
        let (mut x, mut mobility) = (self.x, self.mobility);
        if shape.terms == 1 {
            // If the polynomial of the curvature has only one term, the curvature is constant, and so is the mobility
            // (contact travel per radian).
            x = mobility * drive;
        } else {
            for _ in 0..NEWTON_STEPS {
                let (at_x, relative) = shape.drive(&x);
                mobility = relative.try_inverse().filter(is_rolling)?;
                let step = mobility * (drive - at_x);
                x += step;
                if step.amax() < SMALL_STEP {
                    break;
                }
            }
        }
        let frame = self.frame * rolled(&(x - self.x), turn.z);
        let is_finite = x.norm() < std::f64::consts::PI;
        is_finite.then_some(Self {
            frame,
            x,
            drive,
            mobility,
            spin: self.spin + turn.z,
        })
    }
}

/// The rotation vectors of the probe from each sample to the next. `rotations` are the rotation vectors since the start.
fn steps(rotations: impl Iterator<Item = Vector3<f64>>) -> Vec<Vector3<f64>> {
    let mut last = Vector3::zeros();
    let step = |rotation: Vector3<f64>| {
        // If two rotation vectors are parallel, the rotation between them is exactly their difference. The difference is
        // faster to compute than a product of quaternions.
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
    };
    rotations.map(step).collect()
}

/// The drive (−Δθ_y, Δθ_x): the x and y components of the rotation vector, turned by 90°.
pub(crate) fn drive_of(rotation: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(-rotation.y, rotation.x)
}

/// The plane vector `vector` after a rotation by `angle`.
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

/// The ratios `sin(a)/a` and `(1 − cos(a))/a²` for the angle a whose square is `square`.
fn sine_ratios(square: f64) -> (f64, f64) {
    if square < 0.25 {
        let series = |first: f64| {
            let terms = (0..6).rev().map(|term| 2.0 * f64::from(term) + first);
            terms.fold(1.0, |sum, n| 1.0 - square * (1.0 / (n * (n + 1.0))) * sum)
        };
        return (series(2.0), 0.5 * series(3.0));
    }
    let angle = square.sqrt();
    let (sin, cos) = libm::sincos(angle);
    (sin / angle, (1.0 - cos) / square)
}

/// The contact frame on the unit sphere after the contact has moved by `along` and the probe has spun by `spin`, relative
/// to the contact frame before this movement.
fn rolled(along: &Vector2<f64>, spin: f64) -> Matrix3<f64> {
    let turn = Vector3::new(-along.y, along.x, -spin);
    let square = turn.norm_squared();
    let (per_sin, per_cos) = sine_ratios(square);
    let frame = (turn * per_sin).cross_matrix() + turn * (turn * per_cos).transpose();
    frame + Matrix3::from_diagonal_element(1.0 - per_cos * square)
}

/// The start of a roll on the unit sphere, and the axes of the pads at the start. The axes are parallel-transported to
/// the start from the origin of the pads' coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartFrame {
    frame: Matrix3<f64>,
    /// Rotation vectors of `frame` if the start moves by one unit of length along u, and along v.
    turns: [Vector3<f64>; 2],
}

/// Position of a contact on the probe, and the derivatives of this position with respect to the start of the roll and
/// to the path on the object. The coordinates are those of the exponential map of the sphere at the point of the probe
/// where the coordinates of the pads are zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) place: Vector2<f64>,
    /// Derivatives of the contact's position on the probe with respect to the contact point at the start of the roll.
    pub(crate) by_start: Matrix2<f64>,
    /// Derivatives of the contact's position on the probe with respect to its position on the object.
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
        // If the direction of a path changes by a small angle, the end of the path moves to the side. On a sphere, this
        // displacement is shorter than on a plane, by the factor `narrow`.
        let square = at.x.norm_squared();
        let narrow = sine_ratios(square).0;
        let along = match square < 1e-12 {
            true => Vector2::x(),
            false => at.x / square.sqrt(),
        };
        // If the probe spins, the contact frame turns by the spin along the path. The mean of a vector that turns with
        // the frame is this vector at half of the spin, times sin(h)/h, where h is half of the spin. `at.frame` is the
        // frame at the end, so turn back by h.
        let half_spin = 0.5 * at.spin;
        let share = sine_ratios(half_spin * half_spin).0;
        let axes = self.frame * at.frame.fixed_columns::<2>(0) * share;
        let by_path = [Vector2::x(), Vector2::y()].map(|axis| {
            let part = along * along.dot(&axis);
            let displacement = spun(&(part + (axis - part) * narrow), half_spin);
            in_chart(&(axes * displacement))
        });
        Place {
            place: across * stretch,
            by_start: Matrix2::from_columns(&by_start),
            by_path: Matrix2::from_columns(&by_path),
        }
    }
}

/// Derivatives of the contact's position on the probe with respect to the first `N` coefficients of the shape. `x` is
/// the position of the contact on the object, without the errors of the measured rotation.
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
