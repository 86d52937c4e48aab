//! Rotations of a probe in the forms that files use: vectors, quaternions, matrices, and axes with angles.

use std::f64::consts::TAU;
use std::str::FromStr;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use palpate_statistics::Number;
use palpate_study::readings::{COLUMNS, Column};

use super::header::Header;
use super::table_format::pair;

/// Largest accepted error in the length of a quaternion or of an axis, and in the scalar products of a matrix's axes.
/// Such errors occur because files contain rounded numbers.
const MAX_ERROR: f64 = 1e-3;

/// Frame of reference for rotations. The axes u and v of the contact are the x and y axes of this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RotationFrame {
    /// The probe's frame at the start of the roll.
    #[default]
    Probe,
    /// The fixed frame in which the file states orientations.
    World,
}

impl FromStr for RotationFrame {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "probe" => Ok(Self::Probe),
            "world" => Ok(Self::World),
            _ => Err("must be probe or world".to_owned()),
        }
    }
}

/// Form in which a table states rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RotationForm {
    Vector,
    /// A rotation vector with three components, including the component along the normal.
    WholeVector,
    Quaternion,
    Matrix,
    AxisAngle,
}

impl RotationForm {
    /// All forms, in the order in which a table is searched for their columns.
    pub(super) const ALL: [Self; 5] = [
        Self::WholeVector,
        Self::Vector,
        Self::Quaternion,
        Self::Matrix,
        Self::AxisAngle,
    ];

    /// The form in which a table states rotations. The first form that meets one of three criteria is used, in this
    /// order: the table has all columns of the form; names in the table resemble all columns of the form; the table has
    /// at least one column of a form with more than three columns. Otherwise, the form is a rotation vector.
    pub(super) fn of(header: &Header<'_>) -> Self {
        let has = |column: &Column| header.has(column);
        let find = |fits: &dyn Fn(&[Column]) -> bool| {
            let mut all = Self::ALL.into_iter();
            all.find(|form| fits(form.columns()))
        };
        find(&|columns| columns.iter().all(has))
            .or_else(|| find(&|columns| header.offers(columns)))
            .or_else(|| find(&|columns| columns.len() > 3 && columns.iter().any(has)))
            .unwrap_or(Self::Vector)
    }

    pub(super) const fn columns(self) -> &'static [Column] {
        match self {
            Self::Vector => COLUMNS.rotation_vector.split_at(2).0,
            Self::WholeVector => &COLUMNS.rotation_vector,
            Self::Quaternion => &COLUMNS.quaternion,
            Self::Matrix => &COLUMNS.matrix,
            Self::AxisAngle => &COLUMNS.axis_angle,
        }
    }

    pub(super) const fn is_vector(self) -> bool {
        matches!(self, Self::Vector | Self::WholeVector)
    }

    /// The rotation that a row states. `numbers` contains the row's numbers in the columns [`Self::columns`].
    pub(super) fn rotation(self, numbers: &[f64]) -> Result<UnitQuaternion<f64>, String> {
        let of_length_1 = |length: f64, columns: &str, what: &str| {
            let is_unit = (length - 1.0).abs() <= MAX_ERROR;
            is_unit.then_some(()).ok_or_else(|| {
                format!(
                    "columns {columns}: a rotation needs {what} of length 1 within {MAX_ERROR}, but the length is {length:.5}"
                )
            })
        };
        match *numbers {
            [x, y] => Ok(UnitQuaternion::from_scaled_axis(Vector3::new(x, y, 0.0))),
            [x, y, z] => Ok(UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z))),
            [x, y, z, w] if self == Self::Quaternion => {
                let quaternion = nalgebra::Quaternion::new(w, x, y, z);
                of_length_1(quaternion.norm(), "`qx` to `qw`", "a quaternion")?;
                Ok(UnitQuaternion::from_quaternion(quaternion))
            }
            [x, y, z, angle] => {
                let axis = Vector3::new(x, y, z);
                if angle == 0.0 {
                    return Ok(UnitQuaternion::identity());
                }
                of_length_1(axis.norm(), "`axis_x` to `axis_z`", "about an axis")?;
                Ok(UnitQuaternion::from_scaled_axis(axis.normalize() * angle))
            }
            _ => matrix(Matrix3::from_row_slice(numbers)),
        }
    }
}

/// Converts a rotation matrix, which must be orthogonal and right-handed, to a quaternion.
fn matrix(matrix: Matrix3<f64>) -> Result<UnitQuaternion<f64>, String> {
    let determinant = Number::rounded(matrix.determinant());
    let error = (matrix.transpose() * matrix - Matrix3::identity()).amax();
    if error > MAX_ERROR {
        let error = Number::rounded(error);
        return Err(format!(
            "columns `r11` to `r33`: the axes of a rotation matrix are orthogonal and of length 1; their products here differ by {error}"
        ));
    }
    if matrix.determinant() < 0.0 {
        return Err(format!(
            "columns `r11` to `r33`: the matrix is left-handed, with a determinant of {determinant}; that of a rotation is 1"
        ));
    }
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    Ok(UnitQuaternion::from_rotation_matrix(&rotation))
}

/// Rotation vector of the rotation from the orientation at the start of a roll to the orientation at its end.
pub(super) fn between(
    start: &UnitQuaternion<f64>,
    end: &UnitQuaternion<f64>,
    frame: RotationFrame,
) -> Vector3<f64> {
    let rotation = match frame {
        RotationFrame::Probe => start.inverse() * end,
        RotationFrame::World => end * start.inverse(),
    };
    rotation.scaled_axis()
}

/// The rotation vector of the same orientation as `turned` that is nearest to `earlier`, the rotation vector of the
/// sample before. Orientations alone do not distinguish rotations by more than half a turn from shorter ones.
pub(super) fn unwrapped(turned: Vector3<f64>, earlier: &Vector3<f64>) -> Vector3<f64> {
    let angle = turned.norm();
    let axis = turned / angle.max(f64::MIN_POSITIVE);
    axis * (((earlier.dot(&axis) - angle) / TAU).round() * TAU) + turned
}

/// Orders in which a file may list the components of a quaternion. Each constant contains the positions of x, y, z and
/// w in the file. With `SCALAR_LAST`, the scalar part w is last; with `SCALAR_FIRST`, it is first.
pub(super) const SCALAR_LAST: [usize; 4] = [0, 1, 2, 3];
pub(super) const SCALAR_FIRST: [usize; 4] = [1, 2, 3, 0];

/// Value of the setting `columns` that assigns the file's columns `names` to the components of a quaternion. `order`
/// contains the positions of x, y, z and w in `names`.
pub(super) fn scalar_names(order: [usize; 4], names: [&str; 4]) -> String {
    let pairs = COLUMNS.quaternion.iter().zip(order);
    let pairs: Vec<String> = pairs
        .map(|(column, place)| pair(column.name, names[place]))
        .collect();
    pairs.join(",")
}

/// Rotation vector of a roll (rad), and the shift of the contact on the probe (length).
pub(super) type Turned = (Vector3<f64>, [f64; 2]);

/// Two limits for readings that count as rolls. `MAX_SPIN` is the largest ratio of the rotation about the normal to the
/// rotation about the tangents (root mean squares). `MIN_CORRELATION` is the smallest correlation between the measured
/// shifts and the shifts that the same rotations cause on a plane.
const MAX_SPIN: f64 = 0.3;
const MIN_CORRELATION: f64 = 0.5;

/// Whether the measured shifts are consistent with a probe that rolls by the stated rotations. In a roll, a negative
/// rotation about v moves the contact towards +u.
pub(super) fn is_rolling(rolls: &[Turned]) -> bool {
    let sum = |term: &dyn Fn(&Turned) -> f64| rolls.iter().map(term).sum::<f64>();
    let spin = sum(&|(turned, _)| turned.z * turned.z);
    let turn = sum(&|(turned, _)| turned.xy().norm_squared());
    let along = sum(&|(turned, [u, v])| turned.x * v - turned.y * u);
    let shift = sum(&|(_, [u, v])| u * u + v * v);
    turn > 0.0
        && spin <= MAX_SPIN * MAX_SPIN * turn
        && along >= MIN_CORRELATION * (turn * shift).sqrt()
}
