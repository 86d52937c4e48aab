//! The frame of a patch, in which the patch is a graph w(u, v).

use std::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Rotation3, SymmetricEigen, Vector3};

use crate::patch::FingerMap;
use crate::{Contact, Ep2Error};

/// The contacts count as lying on a line or a plane if the ratio of their spread across it to their spread along it is
/// at most this value. A spread that is this small may be only a rounding error.
const ROUNDING: f64 = 1e-12;
/// Smallest length of the mean of the unit normals. If the mean is shorter, the normals have no mean direction.
const LEAST_MEAN_NORMAL: f64 = 0.1;
/// Largest accepted ratio of the contacts' spread across their principal plane to the smaller spread within the plane.
/// At a larger ratio, the contacts have no mean plane.
const MOST_SPREAD_ACROSS: f64 = 0.7;
/// The outward direction determines which side of the patch's plane is outside only if its angle to the plane is at
/// least this value (rad). At smaller angles, the noise of the contacts could exchange the sides.
const LEAST_SIDE_RAD: f64 = 0.02;
/// A patch counts as elongated if the rms spread of its contacts along their first principal axis is more than this
/// factor times the rms spread along their second. A side of an elongated patch is assumed to be parallel to the first
/// principal axis.
const LONG: f64 = 1.15;
/// The fingers have a common direction of travel only if their contacts scatter more along this direction than across
/// it. This constant is the smallest ratio of two sums of squared distances of the contacts from the mean of their
/// finger: the sum along the direction, divided by the sum across it.
const LEAST_TRAVEL: f64 = 2.0;

/// The frame of a patch. Its w axis is the mean normal (without normals, the normal of the principal plane). Its u axis
/// is the mean direction in which the fingers travel. If the fingers have no common direction, the u axis is parallel
/// to a side of the patch. The origin is the mean contact, and the unit of length is half the patch's larger side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchFrame {
    origin: Point3<f64>,
    patch_from_world: Rotation3<f64>,
    scale: f64,
}

impl PatchFrame {
    /// The frame of the patch that `contacts` span, with a preliminary unit of length. The coordinates and normals of
    /// the contacts must be valid.
    ///
    /// # Errors
    /// [`Ep2Error`]: `coincident`, `collinear`, `no-plane`, `no-side`.
    pub(crate) fn of(contacts: &[Contact], outward: &Vector3<f64>) -> Result<Self, Ep2Error> {
        let cloud = Cloud::of(contacts)?;
        let normal = match cloud.mean_normal(contacts)? {
            Some(normal) => normal,
            None => cloud.plane_normal(outward)?,
        };
        let along = travel(contacts, &cloud, &normal)
            .and_then(|travel| tangent(&travel, &normal))
            .or_else(|| cloud.side(contacts, &normal))
            .ok_or(Ep2Error::OutOfRange)?;
        let across = normal.cross(&along);
        let axes = Matrix3::from_rows(&[along.transpose(), across.transpose(), normal.transpose()]);
        Ok(Self {
            origin: cloud.centre,
            patch_from_world: Rotation3::from_matrix_unchecked(axes),
            scale: cloud.extent,
        })
    }

    pub(crate) const fn with_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// The unit of length in the patch: half the patch's larger side.
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// Converts a point from the frame of the readings to the patch's frame.
    #[inline]
    pub(crate) fn point(&self, world: &Point3<f64>) -> Vector3<f64> {
        self.patch_from_world * (world - self.origin) / self.scale
    }

    #[inline]
    pub(crate) fn direction(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.patch_from_world * world
    }

    #[inline]
    pub(crate) fn point_in_world(&self, patch: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.direction_in_world(&(patch * self.scale))
    }

    #[inline]
    pub(crate) fn direction_in_world(&self, patch: &Vector3<f64>) -> Vector3<f64> {
        self.patch_from_world.inverse() * patch
    }
}

struct Cloud {
    centre: Point3<f64>,
    /// Largest difference between a coordinate of a contact and the same coordinate of the mean contact. It is the unit
    /// of length of `spreads`.
    extent: f64,
    /// Principal axes of the contacts as columns, sorted by ascending spread along them.
    axes: Matrix3<f64>,
    /// Root-mean-square spreads of the contacts along the principal axes, ascending, in units of `extent`.
    spreads: [f64; 3],
}

impl Cloud {
    fn of(contacts: &[Contact]) -> Result<Self, Ep2Error> {
        let count = contacts.len() as f64;
        let anchor = contacts[0].position;
        let mean = contacts
            .iter()
            .map(|contact| (contact.position - anchor) / count)
            .sum::<Vector3<f64>>();
        let centre = anchor + mean;
        let extent = contacts
            .iter()
            .map(|contact| (contact.position - centre).amax())
            .fold(0.0, f64::max);
        if extent <= ROUNDING * centre.coords.amax() {
            let contacts = contacts.len();
            return Err(Ep2Error::Coincident { contacts, extent });
        }
        let mut moment = Matrix3::zeros();
        for contact in contacts {
            let place = (contact.position - centre) / extent;
            moment += place * place.transpose() / count;
        }
        let eigen = SymmetricEigen::new(moment);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let spreads = order.map(|index| eigen.eigenvalues[index].max(0.0).sqrt());
        let axes = order.map(|index| eigen.eigenvectors.column(index).into_owned());
        // A spread is the square root of a moment. Therefore a rounding error of 1e-12 in a moment becomes an error of
        // 1e-6 in a spread. If the ratio of two spreads is below this error, compute the width of the patch directly.
        let spread = spreads[1] / spreads[2];
        if spread <= ROUNDING.sqrt() {
            let across = distance_across(contacts, &centre, &axes[2]) / (extent * spreads[2]);
            if across <= ROUNDING {
                let contacts = contacts.len();
                return Err(Ep2Error::Collinear {
                    contacts,
                    spread: across,
                });
            }
        }
        Ok(Self {
            centre,
            extent,
            axes: Matrix3::from_columns(&axes),
            spreads,
        })
    }

    /// The direction of the mean of the contacts' unit normals; `None` if a contact has no normal.
    fn mean_normal(&self, contacts: &[Contact]) -> Result<Option<Vector3<f64>>, Ep2Error> {
        let mut sum = Vector3::zeros();
        for contact in contacts {
            match contact.normal {
                Some(normal) => sum += normal.normalize(),
                None => return Ok(None),
            }
        }
        let mean = sum.norm() / contacts.len() as f64;
        if mean < LEAST_MEAN_NORMAL {
            return Err(Ep2Error::NoPlane { spread: 1.0 - mean });
        }
        Ok(Some(sum.normalize()))
    }

    /// The normal of the contacts' principal plane, on the side of `outward`.
    fn plane_normal(&self, outward: &Vector3<f64>) -> Result<Vector3<f64>, Ep2Error> {
        let spread = self.spreads[0] / self.spreads[1];
        if spread > MOST_SPREAD_ACROSS {
            return Err(Ep2Error::NoPlane { spread });
        }
        let normal = self.axes.column(0).into_owned();
        let side = normal.dot(&outward.normalize());
        if libm::asin(side.abs()) <= LEAST_SIDE_RAD {
            return Err(Ep2Error::NoSide {
                angle_deg: libm::asin(side.abs()).to_degrees(),
            });
        }
        Ok(normal * side.signum())
    }

    /// A unit tangent along a side of the patch. The patch is assumed to be either elongated or nearly square.
    ///
    /// In an elongated patch, the tangent is the principal direction of the contacts. In a square patch, the fourth
    /// moments determine the diagonals: the sum Σ r⁴ cos 4(φ − φ₀) over the contacts is largest if φ₀ is the direction
    /// of a diagonal. Here (r, φ) are the polar coordinates of a contact about the mean contact.
    fn side(&self, contacts: &[Contact], normal: &Vector3<f64>) -> Option<Vector3<f64>> {
        let principal = (0..3)
            .rev()
            .find_map(|axis| tangent(&self.axes.column(axis).into_owned(), normal))?;
        if self.spreads[2] > LONG * self.spreads[1] {
            return Some(principal);
        }
        let across = normal.cross(&principal);
        let (mut cosine, mut sine) = (0.0, 0.0);
        for contact in contacts {
            let place = (contact.position - self.centre) / self.extent;
            let (x, y) = (principal.dot(&place), across.dot(&place));
            // The sum of (x + iy)⁴ over all contacts, with the real part `cosine` and the imaginary part `sine`,
            // determines the diagonals of a square patch.
            let (square, product) = (x * x - y * y, 2.0 * x * y);
            cosine += square * square - product * product;
            sine += 2.0 * square * product;
        }
        let (sin, cos) = libm::sincos(0.25 * (libm::atan2(sine, cosine) - PI));
        Some(principal * cos + across * sin)
    }
}

/// Root-mean-square distance of the contacts from the line through `centre` along `axis`.
fn distance_across(contacts: &[Contact], centre: &Point3<f64>, axis: &Vector3<f64>) -> f64 {
    let square: f64 = contacts
        .iter()
        .map(|contact| (contact.position - centre).cross(axis).norm_squared())
        .sum();
    (square / contacts.len() as f64).sqrt()
}

/// The direction along the surface in which the contacts of each finger scatter most, computed for all fingers
/// together. It is perpendicular to `normal` and points in the direction in which the first finger travels. The order
/// of the contacts determines only this sign, so fingers may slide to and fro. `None` if the contacts scatter nearly as
/// much across this direction.
fn travel(contacts: &[Contact], cloud: &Cloud, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    #[derive(Default)]
    struct Finger {
        contacts: f64,
        positions: Vector3<f64>,
        /// Sum over the contacts of their positions, each multiplied by the index of the contact within its finger
        /// (from 0).
        moments: Vector3<f64>,
    }
    let mut fingers: FingerMap<Finger> = FingerMap::default();
    let mut scatter = Matrix3::zeros();
    for contact in contacts {
        let finger = fingers.entry(contact.finger);
        let place = (contact.position - cloud.centre) / cloud.extent;
        let place = place - normal * normal.dot(&place);
        finger.positions += place;
        finger.moments += place * finger.contacts;
        finger.contacts += 1.0;
        scatter += place * place.transpose();
    }
    for finger in fingers.iter() {
        scatter -= finger.positions * finger.positions.transpose() / finger.contacts;
    }
    let eigen = SymmetricEigen::new(scatter);
    let strongest = eigen.eigenvalues.imax();
    let axis = eigen.eigenvectors.column(strongest).into_owned();
    // The eigenvalue of the normal is 0. So the sum of all eigenvalues minus the largest one is the smaller eigenvalue
    // in the tangent plane.
    let across = eigen.eigenvalues.sum() - eigen.eigenvalues[strongest];
    if eigen.eigenvalues[strongest] <= LEAST_TRAVEL * across.max(0.0) {
        return None;
    }
    let sense = fingers
        .iter()
        .map(|finger| {
            let mean_order = 0.5 * (finger.contacts - 1.0);
            (finger.moments - finger.positions * mean_order).dot(&axis)
        })
        .find(|along| *along != 0.0)?;
    Some(axis * sense.signum())
}

/// The unit tangent nearest to `direction`; `None` if `direction` is parallel to `normal`.
fn tangent(direction: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let projected = direction - normal * normal.dot(direction);
    (projected.norm() > 1e-6 * direction.norm()).then(|| projected.normalize())
}
