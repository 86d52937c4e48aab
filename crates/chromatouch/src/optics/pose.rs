//! Stand of a camera that is not in the sensor's very centre.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::OpticsError;

/// Step of a turn by which slopes are found, rad.
const TURN: f64 = 1e-5;

/// Stand of a camera: where it is and how it is turned. By default it is in the sensor's centre and looks at the apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Place from the sensor's centre, length: along the apex's x and y axes, and toward the apex.
    pub place: Vector3<f64>,
    /// Turn of the camera as a rotation vector along the same axes, rad.
    turn: Vector3<f64>,
    /// Rotation from the sensor's axes to the camera's.
    to_camera: Rotation3<f64>,
}

impl Default for Pose {
    fn default() -> Self {
        Self::new([0.0; 3], [0.0; 3])
    }
}

impl Pose {
    /// A camera at a place, length, turned by a rotation vector, rad, along the apex's x and y axes and toward the apex.
    pub fn new(place: [f64; 3], turn_rad: [f64; 3]) -> Self {
        let turn = Vector3::from(turn_rad);
        let angle = turn.norm();
        // Rodrigues, by functions that are the same on every host.
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

    /// Turn of the camera as a rotation vector, rad.
    pub fn turn_rad(&self) -> [f64; 3] {
        self.turn.into()
    }

    /// This stand moved and turned by a little more.
    pub(super) fn moved(&self, place: [f64; 3], turn_rad: [f64; 3]) -> Self {
        let place = self.place + Vector3::from(place);
        let turn = self.turn + Vector3::from(turn_rad);
        Self::new(place.into(), turn.into())
    }

    /// `None` for the very centre, looking at the apex.
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

    /// Slopes of the rotation to the camera's axes by the turn of the camera, per rad.
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

    /// A direction in the sensor's axes, in the camera's.
    #[inline]
    pub(super) fn turned(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.to_camera * direction
    }
}
