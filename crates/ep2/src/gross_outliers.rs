//! Finds gross outliers, which are contacts far from all other contacts: lost readings that are written as a special
//! number or as zeros, and other gross errors.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};
use palpate_statistics::evenly_spaced;
use strum::IntoStaticStr;

use crate::effective_readings::{DistinctContacts, distinct_contacts};
use crate::patch::check;
use crate::surface_outliers::median;
use crate::{Contact, ShapeError};

/// A contact is a gross outlier if its distance from the spatial median of all contacts exceeds this multiple of the
/// median distance. The median distance is the median of all contacts' distances from the spatial median. In clean logs
/// of strokes and caps, less than 0.01 % of the contacts exceed the limit.
const MAX_DISTANCE_RATIO: f64 = 6.0;
/// The sorted distances of the contacts from their spatial median may have a gap. The contacts beyond a gap are gross
/// outliers only if the first distance beyond it exceeds this multiple of the median of all distances.
const MAX_DISTANCE_RATIO_BEFORE_GAP: f64 = 2.5;
/// The distances of the contacts from their spatial median are sorted. Two consecutive distances are separated by a gap
/// if the ratio of the larger to the smaller one is at least this value.
const MIN_GAP_RATIO: f64 = 1.5;
/// The distances of the contacts' positions from their spatial median are searched for a gap only if there are at least
/// this number of positions.
const MIN_PLACES_WITH_GAP: usize = 20;
/// Contacts beyond a gap (in the distances from the spatial median) are outliers only if they form short blocks of
/// consecutive rows. This constant is the largest mean number of rows in a block. Longer blocks are strokes of a
/// finger.
pub(crate) const MAX_BLOCK: usize = 3;
/// Largest share of outliers among the contacts of a log. A larger share is an error.
pub(crate) const MAX_OUTLIER_SHARE: f64 = 0.2;
/// A contact that is not a gross outlier counts as an outlier of the fitted surface if the p-value of its residuals is
/// below this limit. For many contacts, the limit corresponds to a residual of 4.5 standard deviations.
pub(crate) const OUTLIER_PROBABILITY: f64 = 6.8e-6;
const MAX_PLACES: usize = 5000;
const MEDIAN_ITERATIONS: usize = 40;

/// Reason for which a contact is left out of a fit.
#[derive(Clone, Copy, Debug, IntoStaticStr, PartialEq, Eq)]
#[strum(serialize_all = "kebab-case")]
pub enum OutlierReason {
    /// All three coordinates are the same large number, or several contacts share the same wrong number as their
    /// farthest coordinate.
    Sentinel,
    /// All three coordinates are 0, far from the other contacts.
    Zeros,
    /// The position is far from all other contacts.
    Far,
    /// The contact contradicts the surface fitted to the other contacts.
    Misfit,
}

/// A contact that is left out of a fit, and the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Index of the contact in the log, counted from 0.
    pub contact: usize,
    /// Reason for which the contact is left out.
    pub reason: OutlierReason,
}

/// Returns the axis along which a position is farthest from `centre`, and the bits of the coordinate along this axis.
/// To compare equal coordinates by their bits, −0 is replaced by +0.
pub(crate) fn farthest(position: &Point3<f64>, centre: &Point3<f64>) -> (usize, u64) {
    let axis = (position - centre).iamax();
    (axis, (position[axis] + 0.0).to_bits())
}

/// Whether a contact is a lost reading: its normal is 0, and its three coordinates are equal.
fn is_lost(contact: &Contact) -> bool {
    let Point3 { coords } = contact.position;
    contact.normal == Some(Vector3::zeros()) && coords == Vector3::repeat(coords.x)
}

/// The contacts of a log without gross outliers.
#[derive(Clone, Debug)]
pub struct SoundContacts {
    /// The gross outliers that were found.
    pub outliers: Vec<Outlier>,
    /// Indices (from 0) of the contacts that are not gross outliers.
    pub rows: Vec<usize>,
    /// The contacts that are not gross outliers. Copies of a contact, and the contacts of a finger that rests, are
    /// merged into one contact.
    pub distinct: DistinctContacts,
}

impl SoundContacts {
    /// Finds the gross outliers among contacts.
    ///
    /// # Errors
    /// [`ShapeError`] if a number is invalid, or if more than a fifth of the contacts are gross outliers.
    pub fn new(contacts: &[Contact]) -> Result<Self, ShapeError> {
        // Lost readings often have normals of zeros. Such normals are an error only if their contacts are used.
        let has_normal = |one: &Contact| one.normal != Some(Vector3::zeros());
        let rows = || contacts.iter().enumerate();
        let without = rows().filter(|(_, one)| !has_normal(one));
        let mut places: Vec<_> = without.map(|(row, one)| (row, *one)).collect();
        places.iter_mut().for_each(|(_, one)| one.normal = None);
        check(places.iter().map(|(row, one)| (*row, one)))?;
        check(rows().filter(|(_, one)| has_normal(one)))?;
        let distinct = DistinctContacts::without_rests(contacts);
        let far = far_contacts(contacts, &distinct.contacts);
        let outliers = within_share(far, contacts.len())?;
        let place = |row: usize| outliers.binary_search_by_key(&row, |one| one.contact);
        let without_normal = rows().find(|(row, one)| !has_normal(one) && place(*row).is_err());
        check(without_normal.into_iter())?;
        if outliers.is_empty() {
            return Ok(Self {
                outliers,
                rows: (0..contacts.len()).collect(),
                distinct: distinct.without_short_steps(),
            });
        }
        Ok(Self::without(contacts, outliers))
    }

    /// The contacts without `outliers`. The outliers must be in ascending order of their indices.
    pub(crate) fn without(contacts: &[Contact], outliers: Vec<Outlier>) -> Self {
        let mut left_out = outliers.iter().map(|outlier| outlier.contact).peekable();
        let mut rows: Vec<usize> = (0..contacts.len()).collect();
        rows.retain(|row| left_out.next_if_eq(row).is_none());
        let kept: Vec<Contact> = rows.iter().map(|&row| contacts[row]).collect();
        Self {
            outliers,
            rows,
            distinct: distinct_contacts(&kept),
        }
    }
}

/// Finds the contacts that are far from most of the contacts in `runs`, and the lost readings. `runs` are the merged
/// contacts, in which the contacts of a resting finger count only once.
fn far_contacts(contacts: &[Contact], runs: &[Contact]) -> Vec<Outlier> {
    let places: Vec<Vector3<f64>> = evenly_spaced(runs.len(), MAX_PLACES)
        .map(|run| runs[run].position.coords)
        .collect();
    let Some((centre, median)) = centre_and_distance(&places) else {
        return Vec::new();
    };
    let ratio = |position: &Point3<f64>| (position - centre).norm() / median;
    let limit = gap(places.iter().map(|place| ratio(&(*place).into())).collect())
        .filter(|limit| {
            let far = contacts
                .iter()
                .map(|contact| ratio(&contact.position) > *limit);
            let count = far.clone().filter(|far| *far).count();
            let before = std::iter::once(false).chain(far.clone());
            let starts = far.zip(before).filter(|(one, before)| *one && !before);
            count <= MAX_BLOCK * starts.count()
        })
        .unwrap_or(MAX_DISTANCE_RATIO);
    let is_far = |one: &Contact| ratio(&one.position) > limit || is_lost(one);
    let far = contacts.iter().enumerate().filter(|(_, one)| is_far(one));
    let mut counts: HashMap<(usize, u64), usize> = HashMap::new();
    for (_, contact) in far.clone() {
        *counts
            .entry(farthest(&contact.position, &centre))
            .or_default() += 1;
    }
    let outliers = far.map(|(index, contact)| {
        let [x, y, z] = contact.position.into();
        let is_repeated = counts[&farthest(&contact.position, &centre)] > 1;
        let reason = if [x, y, z] == [0.0; 3] {
            OutlierReason::Zeros
        } else if is_repeated || (x == y && y == z) {
            OutlierReason::Sentinel
        } else {
            OutlierReason::Far
        };
        Outlier {
            contact: index,
            reason,
        }
    });
    outliers.collect()
}

/// Searches for the widest gap between successive distances, in the largest fifth of the sorted distances. Returns the
/// distance below this gap; `None` if there is no gap.
fn gap(mut distances: Vec<f64>) -> Option<f64> {
    if distances.len() < MIN_PLACES_WITH_GAP {
        return None;
    }
    distances.sort_unstable_by(f64::total_cmp);
    let first = ((1.0 - MAX_OUTLIER_SHARE) * distances.len() as f64) as usize;
    let pairs = distances[first.max(1) - 1..].windows(2);
    let is_gap = |pair: &&[f64]| {
        let is_wide = pair[1] > MIN_GAP_RATIO * pair[0];
        is_wide && pair[1] > MAX_DISTANCE_RATIO_BEFORE_GAP && pair[0] < MAX_DISTANCE_RATIO
    };
    let found = pairs
        .filter(is_gap)
        .max_by(|one, other| (one[1] / one[0]).total_cmp(&(other[1] / other[0])));
    found.map(|pair| pair[0] * (1.0 + 1e-9))
}

pub(crate) fn within_share(
    outliers: Vec<Outlier>,
    contacts: usize,
) -> Result<Vec<Outlier>, ShapeError> {
    if outliers.len() as f64 > MAX_OUTLIER_SHARE * contacts as f64 {
        let outliers = outliers.iter().map(|outlier| outlier.contact).collect();
        return Err(ShapeError::TooManyOutliers { contacts, outliers });
    }
    Ok(outliers)
}

/// Spatial median of positions, and the median distance of the positions from it. Weiszfeld's iteration computes the
/// spatial median, starting at the median of each coordinate. `None` if at least half of the positions coincide.
fn centre_and_distance(places: &[Vector3<f64>]) -> Option<(Point3<f64>, f64)> {
    if places.len() < 3 {
        return None;
    }
    let mut centre =
        Vector3::from_fn(|axis, _| median(places.iter().map(|place| place[axis]).collect()));
    let distance = |centre: &Vector3<f64>| {
        median(places.iter().map(|place| (place - centre).norm()).collect())
    };
    let near = 1e-6 * distance(&centre);
    for _ in 0..MEDIAN_ITERATIONS {
        let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
        for place in places {
            let weight = 1.0 / (place - centre).norm().max(near).max(f64::MIN_POSITIVE);
            sum += place * weight;
            weights += weight;
        }
        let next = sum / weights;
        let is_finite = next.iter().all(|x| x.is_finite());
        if !is_finite || (next - centre).norm() < near {
            break;
        }
        centre = next;
    }
    let median = distance(&centre);
    (median > 0.0 && median.is_finite()).then(|| (centre.into(), median))
}
