//! Computes the contacts of round fingertips from the positions that the tips report.

use nalgebra::{Matrix2, Point3, SymmetricEigen, Vector2, Vector3};

use crate::error::LARGEST;
use crate::patch::direction;
use crate::{Contact, Ep2Error, Method, Patch};

/// The point of a round tip whose position is reported in the readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TipPoint {
    /// The point of the tip that is farthest in the direction opposite to the object's outward direction. For a finger
    /// that comes from above, it is the lowest point.
    #[default]
    Lowest,
    /// The readings report the centre of the tip.
    Centre,
}

/// A round fingertip whose readings report its centre or its lowest point instead of the contact.
///
/// The centres of a tip of radius r lie on a surface that is offset from the object by r along the normals. Therefore
/// the contact is at the distance r from the centre, along the normal of the offset surface, which is also the normal
/// of the object.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use palpate_ep2::{Contact, Penalised, RoundTip, TipPoint};
///
/// // The centre of a tip of radius 1 on a ball of radius 4, 30 degrees from its top.
/// let normal = Vector3::new(0.5, 0.0, 0.75_f64.sqrt());
/// let told = [Contact::new(0, Point3::from(normal * 5.0), Some(normal))];
/// let tip = RoundTip { radius: 1.0, point: TipPoint::Centre };
/// let contacts = tip.contacts(&told, &Vector3::z(), &Penalised::default())?;
/// assert!((contacts[0].position.coords.norm() - 4.0).abs() < 1e-12);
/// # Ok::<(), palpate_ep2::Ep2Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundTip {
    /// Radius of the tip, ≥ 0.
    pub radius: f64,
    /// The point of the tip whose position is reported.
    pub point: TipPoint,
}

impl RoundTip {
    /// Positions of the fingertip's centre, computed from `readings`.
    ///
    /// # Errors
    /// [`Ep2Error`] `bad-setting` if the direction is invalid.
    pub fn centres(
        &self,
        readings: &[Contact],
        outward: &Vector3<f64>,
    ) -> Result<Vec<Contact>, Ep2Error> {
        let to_centre = match self.point {
            TipPoint::Lowest => direction(outward)?.normalize() * self.radius,
            TipPoint::Centre => Vector3::zeros(),
        };
        let centre = |contact: &Contact| Contact {
            position: contact.position + to_centre,
            ..*contact
        };
        Ok(readings.iter().map(centre).collect())
    }

    /// Computes the contacts from the reported positions. If the readings have normals, these must be the normals of
    /// the object. If they have none, `method` fits a surface to the centres of the tip, and the contacts are computed
    /// with the normals of this surface. The returned contacts then have no normals.
    ///
    /// `outward` points out of the object, opposite to the direction in which the fingers approach it.
    ///
    /// # Errors
    /// [`Ep2Error`]: `bad-setting` for the radius or the direction; `tip-too-large` if the path of the centres is more
    /// curved than is possible for a tip of this radius; without normals also the errors of `method`.
    pub fn contacts(
        &self,
        readings: &[Contact],
        outward: &Vector3<f64>,
        method: &dyn Method,
    ) -> Result<Vec<Contact>, Ep2Error> {
        let is_good = (0.0..=LARGEST).contains(&self.radius);
        Ep2Error::unless_good("tip_radius", self.radius, is_good, ">= 0 and at most 1e150")?;
        let up = direction(outward)?.normalize();
        if self.radius == 0.0 {
            return Ok(readings.to_vec());
        }
        let centres = self.centres(readings, outward)?;
        let has_normals = readings.iter().any(|contact| contact.normal.is_some());
        let normals: Vec<Vector3<f64>> = if has_normals {
            // A missing or invalid normal is replaced by a zero vector, which `Patch::new` rejects later.
            let normals = readings.iter().map(|reading| unit(reading.normal));
            normals.collect()
        } else {
            let fit = method.fit(&Patch::new(&centres, outward)?)?;
            let places: Vec<Point3<f64>> = centres.iter().map(|centre| centre.position).collect();
            let points = fit.points_at(&places)?;
            points.iter().map(|point| point.normal).collect()
        };
        let parts = centres.iter().zip(normals);
        let contacts: Vec<Contact> = parts
            .map(|(centre, normal)| Contact {
                position: centre.position - normal * self.radius,
                ..*centre
            })
            .collect();
        match self.reversal_radius(&centres, &contacts, up) {
            Some(turns) => Err(Ep2Error::TipTooLarge {
                tip_radius: self.radius,
                turns,
            }),
            None => Ok(contacts),
        }
    }

    /// The radius of curvature of the surface on which the tip's centre moves, if this radius is smaller than the tip's
    /// radius; otherwise `None`. If the tip's radius is larger, the computed contacts move backwards when the centres
    /// move forwards.
    ///
    /// A displacement of the contact is the matrix I − r K times the displacement of the centre. Here I is the
    /// identity, r is the tip's radius, and K is the curvature of the surface on which the centre moves. On a real
    /// object, K is below 1/r, so the eigenvalues of the matrix are positive. A linear regression of the contacts on
    /// the centres estimates this matrix. It can then have a negative eigenvalue only because of noise.
    fn reversal_radius(
        &self,
        centres: &[Contact],
        contacts: &[Contact],
        up: Vector3<f64>,
    ) -> Option<f64> {
        /// An error is returned only if an eigenvalue is below 0 by at least this number of standard errors. On a real
        /// object, the probability of an error is then 1/30,000.
        const MIN_STANDARD_ERRORS: f64 = 4.0;
        let away = match up.iamin() {
            0 => Vector3::x(),
            1 => Vector3::y(),
            _ => Vector3::z(),
        };
        let across = up.cross(&away).normalize();
        let plane = [across, up.cross(&across)];
        let [centres, contacts] = [centres, contacts].map(|points| deviations(points, plane));
        let spread = SymmetricEigen::new(products(&centres, &centres));
        let mixed = products(&contacts, &centres) * spread.eigenvectors;
        let least = spread.eigenvalues.max() * f64::EPSILON;
        if !(least > 0.0 && spread.eigenvalues.min() > least) {
            return None;
        }
        let weights = spread.eigenvalues.map(f64::recip);
        let follow = mixed * Matrix2::from_diagonal(&weights) * spread.eigenvectors.transpose();
        let turned = SymmetricEigen::new((follow + follow.transpose()) * 0.5);
        let (which, eigenvalue) = turned.eigenvalues.argmin();
        let direction = turned.eigenvectors.column(which);
        let scatter = centres.iter().zip(&contacts).map(|(centre, contact)| {
            let left = direction.dot(&(contact - follow * centre));
            left * left
        });
        let variance = scatter.sum::<f64>() / (centres.len() as f64 - 3.0).max(1.0);
        let along = spread.eigenvectors.tr_mul(&direction);
        let error = (variance * along.component_mul(&along).dot(&weights)).sqrt();
        (eigenvalue + MIN_STANDARD_ERRORS * error < 0.0).then(|| self.radius / (1.0 - eigenvalue))
    }
}

fn deviations(points: &[Contact], axes: [Vector3<f64>; 2]) -> Vec<Vector2<f64>> {
    let count = points.len() as f64;
    let mean = points.iter().fold(Vector3::zeros(), |sum, point| {
        sum + point.position.coords / count
    });
    let deviation = |point: &Contact| {
        let from = point.position.coords - mean;
        Vector2::from(axes.map(|axis| axis.dot(&from)))
    };
    points.iter().map(deviation).collect()
}

fn products(ones: &[Vector2<f64>], others: &[Vector2<f64>]) -> Matrix2<f64> {
    let pairs = ones.iter().zip(others);
    pairs.fold(Matrix2::zeros(), |sum, (one, other)| {
        sum + one * other.transpose()
    })
}

fn unit(normal: Option<Vector3<f64>>) -> Vector3<f64> {
    let normal = normal.unwrap_or_default();
    let length = normal.abs().sum();
    if length > 0.0 && length <= LARGEST {
        (normal / normal.amax()).normalize()
    } else {
        Vector3::zeros()
    }
}
