//! Round fingertips: from the point of the tip that is told to the contact.

use nalgebra::{Matrix2, Point3, SymmetricEigen, Vector2, Vector3};

use crate::error::LARGEST;
use crate::patch::direction;
use crate::{Contact, Ep2Error, Method, Patch};

/// Point of a round tip of which readings tell the place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TipPoint {
    /// The point that is farthest against the outward direction of the object: the lowest of a finger that comes down
    /// on it.
    #[default]
    Lowest,
    /// The tip's centre.
    Centre,
}

/// Round fingertip of which readings tell another point than the contact.
///
/// The centres of a tip of radius r lie on the surface that is offset from the object by r along its normals. So the
/// contact is r from the centre, along the normal of either surface.
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use palpate_ep2::{Contact, Penalised, RoundTip, TipPoint};
///
/// // The centre of a tip of radius 1 on a ball of radius 4, 30 degrees from its top.
/// let normal = Vector3::new(0.5, 0.0, 0.75_f64.sqrt());
/// let told = [Contact::new(0, Point3::from(normal * 5.0), Some(normal))];
/// let tip = RoundTip { radius: 1.0, told: TipPoint::Centre };
/// let contacts = tip.contacts(&told, &Vector3::z(), &Penalised::default())?;
/// assert!((contacts[0].position.coords.norm() - 4.0).abs() < 1e-12);
/// # Ok::<(), palpate_ep2::Ep2Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundTip {
    /// Radius of the tip, ≥ 0.
    pub radius: f64,
    /// Point that is told.
    pub told: TipPoint,
}

impl RoundTip {
    /// The contacts, from those whose positions are of the told point. Their normals are those of the object; where they
    /// have none, those of the surface that `method` fits to the tip's centres take their place, and the contacts that are
    /// made have none either.
    ///
    /// `outward` is out of the object, along which the fingers come down.
    ///
    /// # Errors
    /// [`Ep2Error`]: `bad-setting` of the radius and the direction; `tip-too-large` where the centres turn more sharply than
    /// a tip of that radius can on any object; without normals, where the centres do not tell their
    /// surface.
    pub fn contacts(
        &self,
        told: &[Contact],
        outward: &Vector3<f64>,
        method: &dyn Method,
    ) -> Result<Vec<Contact>, Ep2Error> {
        let is_good = (0.0..=LARGEST).contains(&self.radius);
        Ep2Error::unless_good("tip_radius", self.radius, is_good, ">= 0 and at most 1e150")?;
        let up = direction(outward)?.normalize();
        if self.radius == 0.0 {
            return Ok(told.to_vec());
        }
        let to_centre = match self.told {
            TipPoint::Lowest => up * self.radius,
            TipPoint::Centre => Vector3::zeros(),
        };
        let centres: Vec<Contact> = told
            .iter()
            .map(|contact| Contact {
                position: contact.position + to_centre,
                ..*contact
            })
            .collect();
        let has_normals = told.iter().any(|contact| contact.normal.is_some());
        let normals: Vec<Vector3<f64>> = if has_normals {
            // One that is missing or none stays where it is: the patch refuses it.
            told.iter().map(|contact| unit(contact.normal)).collect()
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
        match self.reversal(&centres, &contacts, up) {
            Some(turns) => Err(Ep2Error::TipTooLarge {
                tip_radius: self.radius,
                turns,
            }),
            None => Ok(contacts),
        }
    }

    /// Radius of curvature of the path of the tip's centre, where it is smaller than the tip: then contacts lie the other
    /// way round than the centres that they are of.
    ///
    /// Contacts follow their centres by I − r K, where K is the curvature of the surface of the centres, which on an
    /// object is less than 1/r. So a linear regression of the ones on the others has a negative eigenvalue only by noise.
    fn reversal(&self, centres: &[Contact], contacts: &[Contact], up: Vector3<f64>) -> Option<f64> {
        /// Standard errors by which an eigenvalue is surely negative: chance brings one in 30,000.
        const SURELY: f64 = 4.0;
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
        (eigenvalue + SURELY * error < 0.0).then(|| self.radius / (1.0 - eigenvalue))
    }
}

/// Deviations from the mean point, along two axes.
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

/// Sum of the products of components, one of each of two sets of vectors.
fn products(ones: &[Vector2<f64>], others: &[Vector2<f64>]) -> Matrix2<f64> {
    let pairs = ones.iter().zip(others);
    pairs.fold(Matrix2::zeros(), |sum, (one, other)| {
        sum + one * other.transpose()
    })
}

/// The unit vector along a normal; 0 where there is none that is sound.
fn unit(normal: Option<Vector3<f64>>) -> Vector3<f64> {
    let normal = normal.unwrap_or_default();
    let length = normal.abs().sum();
    if length > 0.0 && length <= LARGEST {
        (normal / normal.amax()).normalize()
    } else {
        Vector3::zeros()
    }
}
