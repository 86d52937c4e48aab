//! The frame in which a patch is a graph.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Rotation3, SymmetricEigen, Vector3};

use crate::patch::FingerMap;
use crate::{Contact, Ep2Error};

/// A spread across a line, or a plane, of this share of that along it is rounding.
const ROUNDING: f64 = 1e-12;
/// Normals that cancel to less than this share of themselves have no mean direction.
const LEAST_MEAN_NORMAL: f64 = 0.1;
/// Points that spread more than this across their principal plane, relative to the smaller spread
/// within it, have no plane.
const MOST_SPREAD_ACROSS: f64 = 0.7;
/// An outward direction nearer than this to the patch's plane fixes no side of it, rad: noise of the contacts turns the
/// plane by as much.
const LEAST_SIDE_RAD: f64 = 0.02;
/// Ratio of the spreads along and across a patch from which on the spread determines the directions of its sides.
const LONG: f64 = 1.15;
/// Ratio of the variations along and across the travel from which on the contacts belong to travelling fingers.
const LEAST_TRAVEL: f64 = 2.0;

/// The frame of a patch: w along its mean normal (or, without normals, across its principal
/// plane), u along the mean travel of the fingers (or, where they have none, along a side of the
/// patch), the origin at the mean contact, and lengths in half the patch's larger side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchFrame {
    origin: Point3<f64>,
    patch_from_world: Rotation3<f64>,
    scale: f64,
}

impl PatchFrame {
    /// The frame of contacts whose numbers are sound, except for its scale.
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

    /// This frame, with `scale` as the length that counts as 1.
    pub(crate) const fn with_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Half the patch's larger side: the length that counts as 1 in the patch.
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// A point of the world in the patch.
    #[inline]
    pub(crate) fn point(&self, world: &Point3<f64>) -> Vector3<f64> {
        self.patch_from_world * (world - self.origin) / self.scale
    }

    /// A direction of the world in the patch.
    #[inline]
    pub(crate) fn direction(&self, world: &Vector3<f64>) -> Vector3<f64> {
        self.patch_from_world * world
    }

    /// A point of the patch in the world.
    #[inline]
    pub(crate) fn point_in_world(&self, patch: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.direction_in_world(&(patch * self.scale))
    }

    /// A direction of the patch in the world.
    #[inline]
    pub(crate) fn direction_in_world(&self, patch: &Vector3<f64>) -> Vector3<f64> {
        self.patch_from_world.inverse() * patch
    }
}

/// The spread of the contacts.
struct Cloud {
    centre: Point3<f64>,
    /// Largest distance of a coordinate from the centre: moments are of lengths in it.
    extent: f64,
    /// Principal axes, in columns, by ascending spread.
    axes: Matrix3<f64>,
    /// Root-mean-square spreads, ascending, in `extent`.
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
        // Products of places are squares: their rounding shows as its root.
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

    /// The direction of the mean of the unit normals, if there are any.
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

    /// The normal of the principal plane, on the side of `outward`.
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

    /// A unit tangent along a side of a patch that is longer than wide, or nearly square.
    ///
    /// Of a long patch it is the principal direction. The fourth moments of a square show its
    /// diagonals: Σ r⁴ cos 4(φ − φ₀) is largest where φ₀ lies along one.
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
            // (x + iy)⁴.
            let (square, product) = (x * x - y * y, 2.0 * x * y);
            cosine += square * square - product * product;
            sine += 2.0 * square * product;
        }
        let (sin, cos) = libm::sincos(0.25 * (libm::atan2(sine, cosine) - PI));
        Some(principal * cos + across * sin)
    }
}

/// Root-mean-square distance from the line through `centre` along `axis`.
fn distance_across(contacts: &[Contact], centre: &Point3<f64>, axis: &Vector3<f64>) -> f64 {
    let square: f64 = contacts
        .iter()
        .map(|contact| (contact.position - centre).cross(axis).norm_squared())
        .sum();
    (square / contacts.len() as f64).sqrt()
}

/// The axis along which the contacts of a finger spread within the plane of `normal`, for all
/// fingers together, in the sense in which the first finger travels. Order does not matter, so that
/// fingers may slide to and fro. `None` where they spread nearly as far across.
fn travel(contacts: &[Contact], cloud: &Cloud, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    #[derive(Default)]
    struct Finger {
        contacts: f64,
        positions: Vector3<f64>,
        /// Σ order · position.
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
    // One of the eigenvalues is that of the normal, 0.
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

/// The unit tangent along `direction`, unless `direction` is parallel to `normal`.
fn tangent(direction: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let projected = direction - normal * normal.dot(direction);
    (projected.norm() > 1e-6 * direction.norm()).then(|| projected.normalize())
}
