//! Curvature along a single stroke, whose contacts lie on one curve. The curvature across the curve is not determined.

use nalgebra::{
    Cholesky, Const, DMatrix, DVector, Point3, SMatrix, SVector, SymmetricEigen, Vector3,
};
use palpate_statistics::student_half_width;

use crate::Contact;
use crate::effective_readings::{correlation_time, distinct_contacts};

/// Highest order of the derivatives of the surface that are fitted.
const ORDER: usize = 6;
/// Number of fitted parameters: the height of the surface in the middle of the stroke, and its derivatives up to
/// [`ORDER`] along the stroke and across it.
const UNKNOWNS: usize = (ORDER + 1) * (ORDER + 2) / 2;
/// Lowest and highest degree of the polynomial that describes the path of the stroke in the plane of the patch.
const DEGREES: [usize; 2] = [3, 9];
/// Smallest number of contacts per coefficient of this polynomial, if its degree is above the lowest one.
const CONTACTS_PER_COEFFICIENT: usize = 3;
const MIN_CONTACTS: usize = 8;
const PROBABILITY: f64 = 0.95;
/// The contacts form a single stroke only if the ratio of their scatter across the stroke to their noise is at most
/// this value.
const MAX_SPREAD_RATIO: f64 = 2.5;
/// Assumed standard deviation of the error of the stated outward direction (rad). The error is a rotation about the
/// direction of the stroke.
const OUTWARD_STD: f64 = 0.2;
/// Assumed standard deviation of the second derivatives across the stroke, for half of the stroke's length as the unit.
/// A single straight stroke does not determine them.
const ACROSS_STD: f64 = 1.0;
/// Largest root-mean-square distance of the contacts from the fitted curve, relative to half of the stroke's length.
const MAX_SPREAD: f64 = 0.1;
/// Smallest standard deviation that is assumed for slopes, and for heights relative to half of the stroke's length.
const MIN_STD: f64 = 1e-6;
/// Additional standard error of the curvature, divided by the curvature. It accounts for derivatives of order 7 and
/// higher, which the fit neglects.
const MODEL_ERROR: f64 = 1e-3;
/// Largest slope of the path in the plane of the patch. A path that turns back, like that of a raster, is steeper.
const MAX_TURN: f64 = 4.0;
const ITERATIONS: usize = 6;
/// Degrees of freedom that the fit removes from the residuals along the stroke.
const FITTED: f64 = 5.0;
/// Orders of the derivatives along and across the stroke that the contacts contain: heights, and two slopes.
const OBSERVED: [[usize; 2]; 3] = [[0, 0], [1, 0], [0, 1]];

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
    /// Number of consecutive positions that count as one independent position, at least 1. It exceeds 1 if their noise
    /// is correlated along the stroke.
    pub correlation: f64,
    /// Unit vector along the stroke in its middle; the opposite vector is equivalent.
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
    /// Unit vectors of the frame, as columns.
    axes: SMatrix<f64, 3, 3>,
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
        let axes = SMatrix::<f64, 3, 3>::from_columns(&[along, up.cross(&along), up]);
        let turned: Vec<Vector3<f64>> = places.iter().map(|place| axes.tr_mul(place)).collect();
        let half_length = turned.iter().map(|place| place.x.abs()).fold(0.0, f64::max);
        let slopes = normals.iter().map(|normal| axes.tr_mul(normal));
        let slopes = slopes.map(|normal| {
            let height = normal.z.max(0.1);
            [-normal.x / height, -normal.y / height]
        });
        Some(Self {
            places: turned.iter().map(|place| place / half_length).collect(),
            slopes: slopes.collect(),
            half_length,
            axes,
        })
    }

    fn curvature(&self) -> Option<StrokeCurvature> {
        let count = self.places.len() as f64;
        let (path, [spread, turn_std]) = self.path()?;
        let slopes = path.iter().zip(0_u32..).skip(1);
        let slopes = slopes.map(|(one, power)| one * f64::from(power));
        let slopes: Vec<f64> = slopes.collect();
        let mut turns = self.places.iter().map(|place| value_of(&slopes, place.x));
        if spread > MAX_SPREAD || turns.any(|turn| turn.abs() > MAX_TURN) {
            return None;
        }
        // Noise changes the measured position across the path, but the height is still that of the true contact on the
        // path. Therefore use the fitted path instead of the measured position across it.
        let places = self
            .places
            .iter()
            .map(|place| [place.x, value_of(&path, place.x) - path[0]].map(scaled_powers));
        let places: Vec<[[f64; ORDER + 1]; 2]> = places.collect();
        let observed = |kind: usize| {
            places
                .iter()
                .enumerate()
                .filter_map(move |(index, powers)| {
                    let value = match kind {
                        0 => self.places[index].z,
                        _ => self.slopes.get(index)?[kind - 1],
                    };
                    Some((derivative(powers, OBSERVED[kind]), value))
                })
        };
        let sums = [0, 1, 2].map(|kind| {
            let (mut gram, mut right) = (Gram::zeros(), Row::zeros());
            for (row, value) in observed(kind) {
                gram.ger(1.0, &row, &row, 1.0);
                right += row * value;
            }
            (gram, right)
        });
        let has_normals = !self.slopes.is_empty();
        let floor = MIN_STD * MIN_STD;
        let mut variances = [(spread * spread).max(floor), 1e-4, 1e-4];
        let (mut prior, mut height_std, mut times): (f64, f64, [f64; 3]) = (1.0, 0.0, [1.0; 3]);
        let mut found = None;
        for _ in 0..ITERATIONS {
            let (mut gram, mut right) = (Gram::zeros(), Row::zeros());
            for (sums, variance) in sums.iter().zip(variances) {
                gram += sums.0 / variance;
                right += sums.1 / variance;
            }
            for (place, [along, across]) in terms().enumerate() {
                let std = match (along + across, across) {
                    (1, 1) if !has_normals => OUTWARD_STD,
                    (0 | 1, _) | (2, 0) => continue,
                    (2, _) => ACROSS_STD,
                    _ => prior,
                };
                gram[(place, place)] += (std * std).recip();
            }
            let factor: Cholesky<f64, Const<UNKNOWNS>> = gram.cholesky()?;
            let (solved, inverse) = (factor.solve(&right), factor.inverse());
            for kind in 0..3 {
                let residuals = observed(kind).map(|(row, value)| value - row.dot(&solved));
                let residuals: Vec<f64> = residuals.collect();
                let fitted = inverse.component_mul(&sums[kind].0).sum() / variances[kind];
                let left = (residuals.len() as f64 - fitted).max(1.0);
                let square = residuals.iter().map(|one| one * one).sum::<f64>() / left;
                if kind == 0 {
                    height_std = square.max(floor).sqrt();
                }
                // If the noise is correlated along the stroke, this number of consecutive contacts counts as one.
                times[kind] = correlation_time(&[residuals], fitted as usize);
                variances[kind] = (times[kind] * square).max(floor);
            }
            let bends = terms().zip(&solved);
            let bends = bends.filter(|(term, _)| term[0] + term[1] == 2 || *term == [3, 0]);
            prior = bends.fold(1e-3, |most, (_, one)| one.abs().max(most));
            found = Some((solved, inverse));
        }
        let (solved, inverse) = found?;
        if height_std > MAX_SPREAD || spread > (MAX_SPREAD_RATIO * height_std).max(2.0 * MIN_STD) {
            return None;
        }
        // The tangent of the path in the middle of the stroke, and the derivatives of the surface there.
        let turn = path[1];
        let [_, p, q, uu, uv, vv] = std::array::from_fn(|place| solved[place]);
        let rise = p + q * turn;
        let stretch = 1.0 + turn * turn + rise * rise;
        let scale = (stretch * (1.0 + p * p + q * q).sqrt() * self.half_length).recip();
        let mut weights = Row::zeros();
        (weights[3], weights[4], weights[5]) = (-scale, -2.0 * turn * scale, -turn * turn * scale);
        let value = weights.dot(&solved);
        let std = weights.dot(&(inverse * weights)).max(0.0).sqrt();
        let std = std.hypot(MODEL_ERROR * value);
        // If the tangent turns by an angle, the curvature along it changes by twice the twist per angle.
        let twist = scale * ((1.0 - turn * turn) * uv + turn * (vv - uu));
        let std = std.hypot(2.0 * twist * turn_std / (1.0 + turn * turn));
        let longest = times.into_iter().fold(1.0, f64::max);
        let freedom = (count / longest - FITTED).max(1.0);
        let half = student_half_width(PROBABILITY, freedom as usize) * std;
        let tangent = Vector3::new(1.0, turn, rise);
        let curvature = StrokeCurvature {
            value,
            std: Some(std),
            interval95: [value - half, value + half],
            bend: 2.0 * path[2] / (stretch * self.half_length),
            twist: if has_normals { twist } else { 0.0 },
            correlation: times[0],
            direction: (self.axes * tangent).normalize(),
        };
        (curvature.value.is_finite() && std.is_finite()).then_some(curvature)
    }

    /// The path of the stroke: the coefficients of a polynomial v(u), whose degree has the least Akaike information
    /// criterion. The other results are the root-mean-square distance of the contacts from the path, and the standard
    /// error of its slope at u = 0.
    fn path(&self) -> Option<(Vec<f64>, [f64; 2])> {
        let count = self.places.len();
        let most = (count / CONTACTS_PER_COEFFICIENT).clamp(DEGREES[0] + 1, DEGREES[1] + 1);
        let (mut gram, mut right) = (DMatrix::zeros(most, most), DVector::zeros(most));
        let mut square = 0.0;
        for place in &self.places {
            let row = DVector::from_fn(most, |power, _| place.x.powi(power as i32));
            gram.ger(1.0, &row, &row, 1.0);
            right.axpy(place.y, &row, 1.0);
            square += place.y * place.y;
        }
        let polynomial = |size: usize| {
            let factor = gram.view((0, 0), (size, size)).into_owned().cholesky()?;
            let path = factor.solve(&right.rows(0, size));
            let path = path.as_slice().to_vec();
            let left = self.places.iter().map(|place| {
                let distance = place.y - value_of(&path, place.x);
                distance * distance
            });
            let left = left.sum::<f64>().max(f64::EPSILON * square);
            let criterion = count as f64 * libm::log(left) + 2.0 * size as f64;
            let spread = (left / (count - size) as f64).sqrt();
            let turn_std = spread * factor.inverse()[(1, 1)].sqrt();
            Some((criterion, (path, [spread, turn_std])))
        };
        let paths = (DEGREES[0] + 1..=most).filter_map(polynomial);
        Some(paths.min_by(|one, other| one.0.total_cmp(&other.0))?.1)
    }
}

/// The orders of the fitted derivatives along u and along v.
fn terms() -> impl Iterator<Item = [usize; 2]> {
    (0..=ORDER).flat_map(|order| (0..=order).map(move |across| [order - across, across]))
}

/// Value of the polynomial with these coefficients, lowest power first.
fn value_of(coefficients: &[f64], u: f64) -> f64 {
    coefficients
        .iter()
        .rev()
        .fold(0.0, |sum, one| sum * u + one)
}

/// The values u^k / k! for k = 0 to [`ORDER`].
fn scaled_powers(u: f64) -> [f64; ORDER + 1] {
    let mut powers = [1.0; ORDER + 1];
    for order in 1..=ORDER {
        powers[order] = powers[order - 1] * u / order as f64;
    }
    powers
}

/// A derivative of the surface is a linear function of the fitted parameters. Returns the coefficients of this function.
/// `order` contains the orders of the derivative along u and along v.
fn derivative(powers: &[[f64; ORDER + 1]; 2], order: [usize; 2]) -> Row {
    let mut row = Row::zeros();
    for (place, term) in terms().enumerate() {
        let factors = [0, 1].map(|axis| {
            let left = term[axis].checked_sub(order[axis]);
            left.map_or(0.0, |left| powers[axis][left])
        });
        row[place] = factors[0] * factors[1];
    }
    row
}
