//! Curvature along a single stroke, whose contacts lie on one curve. The curvature across the curve is not determined.

use nalgebra::{
    Cholesky, Const, Matrix4, Point3, SMatrix, SVector, SymmetricEigen, Vector3, Vector4,
};
use palpate_statistics::student_half_width;

use crate::Contact;
use crate::effective_readings::{correlation_time, distinct_contacts};

/// Number of fitted parameters: height, slope, and the derivatives of order 2 to 6 along the stroke.
const UNKNOWNS: usize = 7;
const CURVATURE: usize = 2;
/// Degrees of freedom that the fit removes from the residuals. The prior nearly fixes the derivatives of order 5 and 6.
const FITTED: f64 = 5.0;
const MIN_CONTACTS: usize = 8;
const PROBABILITY: f64 = 0.95;
/// The contacts form a single stroke only if the ratio of their scatter across the stroke to their noise is at most
/// this value.
const MAX_SPREAD_RATIO: f64 = 2.5;
/// Assumed standard deviation of the error of the stated outward direction (rad). The error is a rotation about the
/// direction of the stroke.
const OUTWARD_STD: f64 = 0.1;
/// Largest root-mean-square distance of the contacts from the fitted curve, relative to half of the stroke's length.
const MAX_SPREAD: f64 = 0.1;
/// Smallest standard deviation that is assumed for slopes, and for heights relative to half of the stroke's length.
const MIN_STD: f64 = 1e-6;
/// Additional standard error of the curvature, divided by the curvature. It accounts for derivatives of order 7 and
/// higher, which the fit neglects.
const MODEL_ERROR: f64 = 1e-3;
const ITERATIONS: usize = 5;

type Row = SVector<f64, UNKNOWNS>;
type Gram = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Normal curvature along a single stroke, in the middle of the stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeCurvature {
    /// Normal curvature along the stroke, 1/length; positive if the object is convex.
    pub value: f64,
    /// Standard error of the normal curvature, 1/length; `None` if the outer side is only assumed.
    pub std: Option<f64>,
    /// 95 % interval of the normal curvature, 1/length.
    pub interval95: [f64; 2],
    /// Curvature of the stroke along the surface, 1/length: the part of its curvature in space that is perpendicular to
    /// the normal.
    pub bend: f64,
    /// Rotation of the normal about the direction of the stroke, per length along the stroke (1/length); 0 for contacts
    /// without normals.
    pub twist: f64,
    /// Unit vector along the stroke; the opposite vector is equivalent.
    pub direction: Vector3<f64>,
}

impl StrokeCurvature {
    /// The curvature, for contacts whose outer side is uncertain. The normal curvature is the component, along the
    /// surface normal, of the stroke's curvature in space. The normal is unknown here. The interval contains the normal
    /// curvature for any normal within a right angle of the assumed normal.
    #[must_use]
    pub fn for_any_side(self) -> Self {
        let [low, high] = self.interval95;
        let (bend, half) = (self.bend.abs(), 0.5 * (high - low));
        let whole = self.value.hypot(bend);
        let [other, whole] = [bend, whole].map(|one| (one + half).copysign(self.value));
        Self {
            std: None,
            interval95: [whole.min(-other), whole.max(-other)],
            ..self
        }
    }

    /// The curvature of the object, for a stroke of the centres of a fingertip with the radius `radius`. An end of the
    /// interval is infinite if the object may be infinitely sharp; `None` if the centres turn too sharply for the tip.
    /// The centre of the tip moves by the vector (1, 0) along the stroke. The normal then changes by the vector
    /// (k, t), with the curvature k and the twist t, and the contact moves by (1 − r k, −r t), with the radius r.
    #[must_use]
    pub fn without_tip(self, radius: f64) -> Option<Self> {
        let turn = radius * self.twist;
        let of_object = |curvature: f64| match 1.0 - radius * curvature {
            step if step > 0.0 => {
                (step * curvature - turn * self.twist) / (step * step + turn * turn)
            }
            _ => f64::INFINITY,
        };
        let value = of_object(self.value);
        let stretch = (1.0 - radius * self.value).powi(-2);
        value.is_finite().then(|| Self {
            value,
            std: self.std.map(|std| std * stretch),
            interval95: self.interval95.map(of_object),
            ..self
        })
    }

    /// Adds normals to the contacts of the stroke. They are the normals of a surface that has the fitted curvature
    /// along the stroke, and no curvature across the stroke. The normal in the middle of the stroke is the part of
    /// `outward` that is perpendicular to the stroke.
    pub fn with_normals(&self, contacts: &[Contact], outward: &Vector3<f64>) -> Vec<Contact> {
        let middle = contacts
            .iter()
            .map(|one| one.position.coords / contacts.len() as f64);
        let middle = middle.sum::<Vector3<f64>>();
        let up = outward - self.direction * self.direction.dot(outward);
        let up = up.try_normalize(0.0).unwrap_or(*outward);
        let normal = |contact: &Contact| {
            let along = self.direction.dot(&(contact.position.coords - middle));
            let normal = Some(up + self.direction * (self.value * along));
            Contact { normal, ..*contact }
        };
        contacts.iter().map(normal).collect()
    }
}

/// Computes the curvature along contacts that form a single stroke. `None` if the contacts scatter across the stroke,
/// or if there are fewer than 8 contacts. Copies and the contacts of a resting finger count as one contact. Positions
/// and normals must be finite. Without normals, `outward` is used as the normal of the surface.
pub fn stroke_curvature(contacts: &[Contact], outward: &Vector3<f64>) -> Option<StrokeCurvature> {
    if contacts.len() < MIN_CONTACTS {
        return None;
    }
    let curvature = Stroke::new(contacts, outward)?.curvature()?;
    let distinct = distinct_contacts(contacts).contacts;
    match distinct.len() {
        ..MIN_CONTACTS => None,
        count if count == contacts.len() => Some(curvature),
        _ => Stroke::new(&distinct, outward)?.curvature(),
    }
}

/// Contacts in the frame of the stroke: u along the stroke, w along the mean normal. The unit of length is half the
/// stroke's length.
struct Stroke {
    places: Vec<Vector3<f64>>,
    slopes: Vec<[f64; 2]>,
    half_length: f64,
    direction: Vector3<f64>,
}

impl Stroke {
    fn new(contacts: &[Contact], outward: &Vector3<f64>) -> Option<Self> {
        let anchor: Point3<f64> = contacts[0].position;
        let share = 1.0 / contacts.len() as f64;
        let mean: Vector3<f64> = contacts
            .iter()
            .map(|one| (one.position - anchor) * share)
            .sum();
        let places = contacts.iter().map(|one| one.position - anchor - mean);
        let places: Vec<Vector3<f64>> = places.collect();
        let extent = places.iter().map(|place| place.amax()).fold(0.0, f64::max);
        if extent <= 1e-12 * anchor.coords.amax() {
            return None;
        }
        let moment = places
            .iter()
            .map(|place| (place / extent) * (place / extent).transpose());
        let eigen = SymmetricEigen::new(moment.sum::<SMatrix<f64, 3, 3>>());
        let along: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
        let normals = contacts
            .iter()
            .filter_map(|one| one.normal?.try_normalize(0.0));
        let normals: Vec<Vector3<f64>> = normals.collect();
        let up: Vector3<f64> = match normals.len() == places.len() {
            true => normals.iter().sum(),
            false => *outward,
        };
        let up = up.try_normalize(0.0)?;
        let up = (up - along * along.dot(&up)).try_normalize(1e-3)?;
        let axes = [along, up.cross(&along), up].map(|axis| axis.transpose());
        let frame = SMatrix::<f64, 3, 3>::from_rows(&axes);
        let turned: Vec<Vector3<f64>> = places.iter().map(|place| frame * place).collect();
        let half_length = turned.iter().map(|place| place.x.abs()).fold(0.0, f64::max);
        let slopes = normals.iter().map(|normal| frame * normal);
        let slopes = slopes.map(|normal| {
            let height = normal.z.max(0.1);
            [-normal.x / height, -normal.y / height]
        });
        Some(Self {
            places: turned.iter().map(|place| place / half_length).collect(),
            slopes: slopes.collect(),
            half_length,
            direction: along,
        })
    }

    fn curvature(&self) -> Option<StrokeCurvature> {
        let count = self.places.len() as f64;
        let path = self.cubic(self.places.iter().map(|place| place.y))?;
        let spread = self
            .places
            .iter()
            .map(|place| place.y - path.dot(&powers(place.x)));
        let spread = (spread.map(|one| one * one).sum::<f64>() / (count - 4.0)).sqrt();
        if spread > MAX_SPREAD {
            return None;
        }
        // If the surface slopes across the stroke, a bend of the path also changes the heights along the stroke. `tilt`
        // describes this slope.
        let tilt = match self.slopes.is_empty() {
            true => Vector4::zeros(),
            false => self.cubic(self.slopes.iter().map(|slope| slope[1]))?,
        };
        let [turn, bend] = [path[1], 2.0 * path[2]];
        let slope = |index: usize, x: f64| {
            let turn = path[1] + 2.0 * path[2] * x + 3.0 * path[3] * x * x;
            self.slopes
                .get(index)
                .map(|slope| slope[0] + slope[1] * turn)
        };
        // If the path turns sideways on the surface, and the surface slopes across the path, this slope changes the
        // higher derivatives of the heights along the path. `of_path` is an upper bound of this change.
        let slopes = self.slopes.iter().map(|slope| 10.0 * slope[1].abs());
        let steepest = slopes.fold(if self.slopes.is_empty() { 1.0 } else { 0.0 }, f64::max);
        let of_path = (steepest * bend.abs()).max(1e-3);
        let floor = MIN_STD * MIN_STD;
        let mut variances = [(spread * spread).max(floor), 1e-4];
        let mut prior: f64 = 1.0;
        let mut found = None;
        for _ in 0..ITERATIONS {
            let (mut gram, mut right) = (Gram::zeros(), Row::zeros());
            for (index, place) in self.places.iter().enumerate() {
                let row = derivatives(place.x);
                gram += row * row.transpose() / variances[0];
                right += row * (place.z / variances[0]);
                if let Some(slope) = slope(index, place.x) {
                    let row = shifted(&row);
                    gram += row * row.transpose() / variances[1];
                    right += row * (slope / variances[1]);
                }
            }
            for unknown in CURVATURE + 1..UNKNOWNS {
                gram[(unknown, unknown)] += (prior * prior).recip();
            }
            let factor: Cholesky<f64, Const<UNKNOWNS>> = gram.cholesky()?;
            let solved = factor.solve(&right);
            let mut residuals = [const { Vec::new() }; 2];
            for (index, place) in self.places.iter().enumerate() {
                let row = derivatives(place.x);
                residuals[0].push(place.z - row.dot(&solved));
                let slope = slope(index, place.x);
                residuals[1].extend(slope.map(|slope| slope - shifted(&row).dot(&solved)));
            }
            variances = residuals.each_ref().map(|all| {
                let square: f64 = all.iter().map(|one| one * one).sum();
                (square / (count - FITTED)).max(floor)
            });
            prior = solved[CURVATURE].abs().max(of_path);
            found = Some((solved, factor.inverse()[(CURVATURE, CURVATURE)], residuals));
        }
        let (solved, variance, residuals) = found?;
        let height_std = variances[0].sqrt();
        let is_one = height_std <= MAX_SPREAD
            && spread <= (MAX_SPREAD_RATIO * height_std).max(2.0 * MIN_STD);
        if !is_one {
            return None;
        }
        // If the noise is correlated along the stroke, this number of consecutive contacts counts as one.
        let times = residuals.map(|all| correlation_time(&[all], FITTED as usize));
        let time = times[0].max(times[1]);
        // `stretch` is the square of the length along the surface per unit of length along u.
        let stretch = 1.0 + turn * turn + solved[1] * solved[1];
        let scale = (stretch * self.half_length).recip();
        let of_tilt = match self.slopes.is_empty() {
            true => OUTWARD_STD * OUTWARD_STD,
            false => variances[1] / count,
        };
        let std = scale * (time * variance.max(0.0) + bend * bend * of_tilt).sqrt();
        let value = scale * (bend * tilt[0] - solved[CURVATURE]);
        let std = std.hypot(MODEL_ERROR * value);
        let freedom = (count / time - FITTED).max(1.0);
        let half = student_half_width(PROBABILITY, freedom as usize) * std;
        let curvature = StrokeCurvature {
            value,
            std: Some(std),
            interval95: [value - half, value + half],
            bend: scale * bend,
            twist: scale * tilt[1],
            direction: self.direction,
        };
        (curvature.value.is_finite() && std.is_finite()).then_some(curvature)
    }

    fn cubic(&self, values: impl Iterator<Item = f64>) -> Option<Vector4<f64>> {
        let (mut gram, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for (place, value) in self.places.iter().zip(values) {
            let row = powers(place.x);
            gram += row * row.transpose();
            right += row * value;
        }
        Some(gram.cholesky()?.solve(&right))
    }
}

fn powers(u: f64) -> Vector4<f64> {
    Vector4::new(1.0, u, u * u, u * u * u)
}

/// The height at u is a linear function of the fitted parameters: the height and its derivatives in the middle of the
/// stroke. Returns the coefficients of this function.
fn derivatives(u: f64) -> Row {
    let mut row = Row::from_element(1.0);
    for order in 1..UNKNOWNS {
        row[order] = row[order - 1] * u / order as f64;
    }
    row
}

/// The slope at u is a linear function of the fitted parameters. Returns the coefficients of this function. `row`
/// contains the coefficients for the height at u.
fn shifted(row: &Row) -> Row {
    Row::from_fn(|order, _| if order == 0 { 0.0 } else { row[order - 1] })
}
