//! Derivatives of the direction and the angular radius of a disc, as viewed from the camera. The derivatives are with
//! respect to the disc's motion and to the sensor's parameters. All derivatives are computed by exact formulas.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::array::{Layer, MarkerArray, MarkerSight, Sight, Stand};
use super::sines::sinc_and_cosine;
use super::{DiscMotion, MarkerMotion, Pose};

/// Index of the column of [`SightSlopes::by`] with the derivatives with respect to the disc's inward motion.
pub(super) const INWARD: usize = 0;
/// Index of the first of two columns of [`SightSlopes::by`] with the derivatives with respect to the disc's motion
/// along the two axes of the skin.
pub(super) const X: usize = 1;
/// Index of the column of [`SightSlopes::by`] with the derivatives with respect to the disc's depth.
pub(super) const DEEPER: usize = 3;
/// Index of the column of [`SightSlopes::by`] with the derivatives with respect to the logarithm of the disc's
/// diameter.
pub(super) const WIDER: usize = 4;
/// Index of the first of three columns of [`SightSlopes::by`] with the derivatives with respect to the camera's
/// position.
pub(super) const PLACE: usize = 5;
/// Index of the first of three columns of [`SightSlopes::by`] with the derivatives with respect to the camera's
/// rotation.
pub(super) const TURN: usize = 8;
pub(super) const COLUMNS: usize = 11;

pub(super) struct SightSlopes {
    across: [Vector3<f64>; 2],
    /// Derivatives, one column per variable (see [`INWARD`] to [`TURN`]). The first two rows are the derivatives of the
    /// direction along the two vectors `across`. The third row is the derivative of the logarithm of the tangent of the
    /// angular radius.
    pub(super) by: SMatrix<f64, 3, COLUMNS>,
}

impl SightSlopes {
    /// Returns `sight` after a small step `step` of one value of the disc `disc` (0: magenta, 1: yellow). The values 0
    /// and 1 of `number` select a component of the disc's direction. The value 2 selects the logarithm of the tangent
    /// of the disc's angular radius.
    pub(super) fn beside(
        &self,
        sight: &MarkerSight,
        disc: usize,
        number: usize,
        step: f64,
    ) -> MarkerSight {
        let mut beside = *sight;
        let changed = [&mut beside.magenta, &mut beside.yellow];
        let [magenta, yellow] = changed;
        let changed = if disc == 0 { magenta } else { yellow };
        match self.across.get(number) {
            Some(across) => changed.direction += across * step,
            None => {
                let tangent = changed.sine / changed.cosine * (1.0 + step);
                let slant = (1.0 + tangent * tangent).sqrt();
                changed.sine = tangent / slant;
                changed.cosine = slant.recip();
            }
        }
        beside
    }
}

impl MarkerArray {
    /// Derivatives of the directions and angular radii of both discs of a marker, as viewed from a camera with the pose
    /// `pose`. `turns` contains the derivatives of the camera's rotation matrix.
    pub(super) fn sight_slopes(
        &self,
        marker: usize,
        sight: &MarkerSight,
        motion: &MarkerMotion,
        pose: &Pose,
        turns: &[Matrix3<f64>; 3],
    ) -> [SightSlopes; 2] {
        let stand = self.stand(marker);
        let [magenta, yellow] = self.layers();
        let offset = stand.misalignment;
        [
            magenta.slopes(
                stand,
                &sight.magenta,
                &motion.magenta,
                [0.0; 2],
                pose,
                turns,
            ),
            yellow.slopes(stand, &sight.yellow, &motion.yellow, offset, pose, turns),
        ]
    }
}

impl Layer {
    fn slopes(
        &self,
        stand: &Stand,
        sight: &Sight,
        motion: &DiscMotion,
        offset: [f64; 2],
        pose: &Pose,
        turns: &[Matrix3<f64>; 3],
    ) -> SightSlopes {
        let aside = [0, 1].map(|axis| motion.tangential[axis] / self.distance);
        let [x, y] = motion.moved_offset(aside, offset);
        let (normal, by_angles) = stand.towards(x, y);
        let away = self.distance - motion.normal;
        let ray = normal * away - pose.place;
        let distance = ray.norm();
        let towards = ray / distance;
        let facing = towards.dot(&normal);
        let direction = sight.direction;
        let across = across(&direction);
        let mut by = SMatrix::zeros();
        // `set` computes one column of the matrix of derivatives, that is, the derivatives with respect to one
        // variable. `ray` is the derivative of the vector from the camera to the disc with respect to this variable,
        // and `turned` is the derivative of the disc's normal.
        let mut set = |column: usize, ray: Vector3<f64>, turned: Vector3<f64>| {
            let nearer = towards.dot(&ray);
            let step = (ray - towards * nearer) / distance;
            let seen = pose.turned(&step);
            let facing_more = step.dot(&normal) + towards.dot(&turned);
            by[(0, column)] = seen.dot(&across[0]);
            by[(1, column)] = seen.dot(&across[1]);
            by[(2, column)] = 0.5 * facing_more / facing - nearer / distance;
        };
        set(INWARD, -normal, Vector3::zeros());
        let mut deeper = Vector3::zeros();
        for axis in 0..2 {
            let turned = by_angles[axis] / self.distance;
            set(X + axis, turned * away, turned);
            // A deeper disc is nearer to the sensor's centre, so the same displacement along the skin changes the
            // disc's direction by a larger angle. Add this effect.
            deeper += turned * aside[axis];
        }
        set(DEEPER, deeper * away - normal, deeper);
        for axis in 0..3 {
            let mut place = Vector3::zeros();
            place[axis] = -1.0;
            set(PLACE + axis, place, Vector3::zeros());
        }
        by[(2, WIDER)] = 1.0;
        for (axis, turn) in turns.iter().enumerate() {
            let seen = turn * towards;
            by[(0, TURN + axis)] = seen.dot(&across[0]);
            by[(1, TURN + axis)] = seen.dot(&across[1]);
        }
        SightSlopes { across, by }
    }
}

impl Stand {
    /// Unit vector at the angles `x` and `y` (rad) from the marker's direction, along the marker's two axes. The second
    /// result contains the derivatives of this vector with respect to the two angles.
    fn towards(&self, x: f64, y: f64) -> (Vector3<f64>, [Vector3<f64>; 2]) {
        let square = x * x + y * y;
        let (sinc, cosine) = sinc_and_cosine(square);
        // `bend` is the derivative of sin θ / θ with respect to θ, divided by θ, where θ² = x² + y².
        let bend = if square < 1e-4 {
            -1.0 / 3.0 + square / 30.0
        } else {
            (cosine - sinc) / square
        };
        let along = self.x_axis * x + self.y_axis * y;
        let slope = |angle: f64, axis: &Vector3<f64>| {
            axis * sinc + along * (bend * angle) - self.direction * (sinc * angle)
        };
        (
            self.direction * cosine + along * sinc,
            [slope(x, &self.x_axis), slope(y, &self.y_axis)],
        )
    }
}

fn across(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let axis = if direction.x.abs() < 0.5 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let one = (axis - direction * direction.dot(&axis)).normalize();
    [one, direction.cross(&one)]
}
