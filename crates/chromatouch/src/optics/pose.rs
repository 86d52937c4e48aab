//! Pose of a camera that is not exactly in the sensor's centre.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::OpticsError;

/// Step of the camera's rotation for finite differences, rad.
const TURN: f64 = 1e-5;

/// Pose of a camera: its position and its rotation. By default, the camera is in the sensor's centre, and its axis
/// passes through the apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the camera relative to the sensor's centre (length): along the x and y axes at the apex, and toward
    /// the apex.
    pub place: Vector3<f64>,
    turn: Vector3<f64>,
    to_camera: Rotation3<f64>,
}

impl Default for Pose {
    fn default() -> Self {
        Self::new([0.0; 3], [0.0; 3])
    }
}

impl Pose {
    /// Pose of a camera at the position `place` relative to the sensor's centre (length), with the rotation vector
    /// `turn_rad` (rad). The components of both vectors are along the x and y axes at the apex, and toward the apex.
    pub fn new(place: [f64; 3], turn_rad: [f64; 3]) -> Self {
        let turn = Vector3::from(turn_rad);
        let angle = turn.norm();
        // Use Rodrigues' formula with functions of libm, because these give the same result on every computer.
        let (sine, cosine) = libm::sincos(angle);
        let to_camera = if angle > 0.0 {
            let axis = turn / angle;
            let cross = axis.cross_matrix();
            let matrix =
                nalgebra::Matrix3::identity() - cross * sine + cross * cross * (1.0 - cosine);
            Rotation3::from_matrix_unchecked(matrix)
        } else {
            Rotation3::identity()
        };
        Self {
            place: Vector3::from(place),
            turn,
            to_camera,
        }
    }

    /// Rotation vector of the camera, rad.
    pub fn turn_rad(&self) -> [f64; 3] {
        self.turn.into()
    }

    pub(super) fn moved(&self, place: [f64; 3], turn_rad: [f64; 3]) -> Self {
        let place = self.place + Vector3::from(place);
        let turn = self.turn + Vector3::from(turn_rad);
        Self::new(place.into(), turn.into())
    }

    /// Checks this pose. Returns `None` for the default pose. Returns an error if the camera is farther than `farthest`
    /// from the sensor's centre, or if its rotation is out of range.
    pub(super) fn checked(self, farthest: f64) -> Result<Option<Self>, OpticsError> {
        let distance = self.place.norm();
        let good = distance <= farthest;
        OpticsError::unless(
            good,
            "place",
            distance,
            "at most 0.9 of the discs' distance from the centre",
        )?;
        for part in self.turn.iter() {
            let good = part.abs() <= 1.0;
            OpticsError::unless(good, "turn_rad", *part, "from -1 to 1 rad")?;
        }
        let is_central = distance == 0.0 && self.turn == Vector3::zeros();
        Ok((!is_central).then_some(self))
    }

    /// Derivatives of the rotation matrix `to_camera` with respect to the three components of the rotation vector, per
    /// rad.
    pub(super) fn per_turn(&self) -> [Matrix3<f64>; 3] {
        std::array::from_fn(|axis| {
            let turned = |step: f64| {
                let mut turn = [0.0; 3];
                turn[axis] = step;
                *self.moved([0.0; 3], turn).to_camera.matrix()
            };
            (turned(TURN) - turned(-TURN)) / (2.0 * TURN)
        })
    }

    #[inline]
    pub(super) fn turned(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.to_camera * direction
    }
}
