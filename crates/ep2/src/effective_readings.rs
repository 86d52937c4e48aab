//! Number of independent readings in a log. It is smaller than the number of rows, because of copies, resting fingers,
//! and noise that is correlated along a stroke.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use nalgebra::{Point3, Vector3};

use crate::Contact;
use crate::gross_outliers::{MAX_BLOCK, MAX_OUTLIER_SHARE, farthest};
use crate::patch::{FingerMap, by_finger};
use crate::surface_outliers::median;

/// A step is the distance between consecutive contacts of a finger. Consecutive contacts count as one reading if their
/// distance is at most this share of the length of a long step (the 90 % quantile of all steps).
const REST_SHARE: f64 = 0.1;
/// A step is the distance between consecutive contacts of a finger. The length of a long step is this quantile of all
/// steps.
const LONG_STEP_QUANTILE: f64 = 0.9;
/// A step is the distance between consecutive contacts of a finger. A gap in the sorted steps separates the steps of
/// resting fingers from the longer steps of moving fingers. This constant is the smallest ratio of the step above a gap
/// to the step below it.
const MIN_STEP_GAP: f64 = 8.0;
/// This share of the steps (distances between consecutive contacts), namely the shortest ones, always counts as steps
/// of a resting finger. A gap is searched only among the longer steps.
const MIN_REST_SHARE: f64 = 0.02;
/// During a rest of a finger, all contacts must be near their mean. This constant is the largest accepted distance from
/// the mean, divided by the typical step of a resting finger. A step is the distance between consecutive contacts.
const MAX_REST_EXTENT: f64 = 3.0;
/// Consecutive contacts of a finger at nearly the same place form a run. The finger moves from one run to the next by a
/// step. This constant is the largest accepted share of short steps among these steps. At a larger share, the fingers
/// were moving by short steps, and the contacts of a run are not merged.
const MAX_SHORT_BREAKS: f64 = 0.2;
/// If contacts are in a random order, consecutive contacts are near each other only by chance. The probability of this
/// is estimated from pairs of contacts of a finger that are 2 or more rows apart. This constant is the largest distance
/// between the two contacts of a pair, in rows.
const MAX_CHANCE_LAG: usize = 17;
/// A run consists of consecutive contacts that are near each other. Contacts in a random order also form runs, by
/// chance. If the number of runs exceeds the number expected by chance by this number of standard deviations, all runs
/// count as rests of a finger.
const MIN_CHANCE_DEVIATIONS: f64 = 5.0;
/// A run consists of consecutive contacts that are near each other. If the total number of runs may be due to chance,
/// each run is tested on its own. Let n be the expected number of runs of its length in contacts in a random order. The
/// run counts as a rest of a finger only if n is below this value.
const MAX_CHANCE_RUNS: f64 = 0.01;
/// All contacts of a run are within the distance `limit` of its first contact. If they are spread over this whole
/// distance, the run does not count as a rest of the finger. This constant is the largest root mean square distance of
/// the contacts of a rest from their mean, divided by `limit`.
const MAX_CHANCE_EXTENT: f64 = 0.4;
/// Several gaps in the sorted step lengths are tried as the limit between short and long steps, beginning with the gap
/// between the shortest steps. This constant is the largest number of gaps that are tried.
const MAX_GAPS: usize = 4;
/// A rest whose noise is as large as the steps of the moving finger is detected only if it has at least this number of
/// contacts.
const MIN_NOISY_REST: usize = 20;
/// The noise of a resting finger may be as large as the steps of the moving finger. A contact belongs to such a rest
/// only if it is near the finger's median position. This constant is the largest distance from this position, divided
/// by the finger's median step.
const MAX_NOISY_EXTENT: f64 = 2.5;
/// Contacts near one position count as a rest of a finger only if the finger's other contacts are far away. Otherwise
/// the contacts may only be in no order. This constant is the smallest accepted median distance of the other contacts
/// from the position, divided by the largest distance that is allowed within the rest.
const MIN_REST_DISTANCE: f64 = 4.0;
/// Four fifths of the contacts are within some distance of the median position. A contact beyond this multiple of the
/// distance may be a lost reading, such as 9999.
const MIN_FAR_RATIO: f64 = 10.0;
/// Largest share of lost readings among the contacts, if one coordinate of all lost readings has the same number.
const MAX_LOST_SHARE: f64 = 0.5;
/// The correlation between residuals is estimated from strokes until these contain this number of residuals. Further
/// strokes are not used.
const MAX_RESIDUALS: usize = 60_000;
/// Largest lag, as a number of residuals, at which the correlation of residuals is computed.
const MAX_LAG: usize = 1000;
/// Correlations at long lags are mostly noise, so the sum of correlations ends at a largest lag. The correlation time
/// is the number of consecutive residuals that count as one independent residual, computed from the sum so far. This
/// constant is the largest lag, divided by the correlation time.
const MAX_LAG_RATIO: f64 = 2.0;
/// A fit makes the variance of the residuals smaller than the variance of the errors, and the correlations of the
/// residuals are corrected for this. The correction is not used if the number of fitted parameters, divided by the
/// number of independent readings, exceeds this value.
const MAX_ABSORBED_SHARE: f64 = 0.3;

/// Contacts after merging: each group of equal contacts, and all contacts during one rest of a finger, were merged into
/// one reading.
#[derive(Clone, Debug, PartialEq)]
pub struct DistinctContacts {
    /// The merged contacts. Each is the mean of the rows of the contact log that were merged into it. Their order is
    /// that of the first row of each contact.
    pub contacts: Vec<Contact>,
    /// For each row of the contact log, the index in `contacts` of the contact into which the row was merged.
    pub run_of_row: Vec<usize>,
}

/// Number of independent readings in a log, with the numbers from which it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectiveReadings {
    /// Number of contacts in the log, not counting outliers.
    pub contacts: usize,
    /// Number of readings after exact copies and the contacts of resting fingers were merged.
    pub distinct: usize,
    /// Number of consecutive positions that count as one independent position, ≥ 1.
    pub position_correlation: f64,
    /// Number of consecutive normals that count as one independent normal, ≥ 1.
    pub normal_correlation: f64,
}

impl EffectiveReadings {
    /// Effective number of independent contacts: `distinct` divided by `position_correlation`.
    pub fn effective(&self) -> f64 {
        self.distinct as f64 / self.position_correlation
    }
}

impl DistinctContacts {
    /// Merges equal contacts, and consecutive contacts of a finger that are within the distance `limit` of the first.
    pub fn within(contacts: &[Contact], limit: f64) -> Self {
        Runs::new(contacts, limit, true).merged(contacts)
    }

    /// Merges exact copies of a contact, and contacts that were recorded while a finger rested. A finger rests while
    /// its steps are clearly shorter than the steps of a moving finger. Lost readings (such as 9999) among the contacts
    /// do not affect the result.
    pub(crate) fn without_rests(contacts: &[Contact]) -> Self {
        let mut distinct = Self::within(contacts, 0.0);
        for merged in [rests, noisy_rests] {
            // The steps to and from a lost reading are long, so all other steps seem to be those of a resting finger.
            let near = without_far(&distinct.contacts);
            if near.is_none_or(|near| merged(&near).is_some())
                && let Some(rests) = merged(&distinct.contacts)
            {
                distinct = distinct.again(rests);
            }
        }
        distinct
    }

    /// Merges further contacts: consecutive contacts of a finger whose distance is at most a tenth of a long step (the
    /// 90 % quantile of the distances between consecutive contacts). Contacts in a random order are not merged, because
    /// they may be neighbours by chance. Remove lost readings before the call, because they make the steps seem too
    /// long.
    pub(crate) fn without_short_steps(self) -> Self {
        let mut steps = steps(&self.contacts);
        if steps.len() < 3 {
            return self;
        }
        let place = ((steps.len() - 1) as f64 * LONG_STEP_QUANTILE) as usize;
        let limit = REST_SHARE * *steps.select_nth_unstable_by(place, f64::total_cmp).1;
        if steps.iter().all(|&step| step > limit) {
            return self;
        }
        let runs = Runs::new(&self.contacts, limit, false);
        let [short, all] = breaks(&self.contacts, &runs, 3.0 * limit);
        if short as f64 > MAX_SHORT_BREAKS * all as f64 {
            return self;
        }
        let share = chance_share(&self.contacts, &runs, limit);
        let expected = share * steps.len() as f64;
        let mut lengths = vec![0; runs.firsts.len()];
        runs.of_row.iter().for_each(|&run| lengths[run] += 1);
        let found = lengths.iter().filter(|&&length| length > 1).count();
        if found as f64 > expected + MIN_CHANCE_DEVIATIONS * expected.sqrt() {
            let merged = runs.merged(&self.contacts);
            return self.again(merged);
        }
        let mut squares = vec![0.0; lengths.len()];
        for (contact, &run) in self.contacts.iter().zip(&runs.of_row) {
            let mean = runs.mean(run, &self.contacts).position;
            squares[run] += (contact.position - mean).norm_squared();
        }
        let is_rest = |run: usize| {
            let extent = (squares[run] / lengths[run] as f64).sqrt();
            lengths[run] > 1
                && extent <= MAX_CHANCE_EXTENT * limit
                && expected * share.powi(lengths[run] - 2) < MAX_CHANCE_RUNS
        };
        if !(0..lengths.len()).any(is_rest) {
            return self;
        }
        let of_row = self.contacts.iter().zip(&runs.of_row);
        let moved = of_row.map(|(contact, &run)| match is_rest(run) {
            true => runs.mean(run, &self.contacts),
            false => *contact,
        });
        let moved: Vec<Contact> = moved.collect();
        self.again(Self::within(&moved, 0.0))
    }

    fn again(mut self, again: Self) -> Self {
        for run in &mut self.run_of_row {
            *run = again.run_of_row[*run];
        }
        self.contacts = again.contacts;
        self
    }
}

/// Merges exact copies and consecutive contacts of a finger at rest. The contacts must not contain lost readings. The
/// contacts of each finger must be in chronological order.
pub(crate) fn distinct_contacts(contacts: &[Contact]) -> DistinctContacts {
    DistinctContacts::without_rests(contacts).without_short_steps()
}

/// The runs of a contact log. A run consists of consecutive contacts of a finger at nearly the same place, and of exact
/// copies of contacts.
struct Runs {
    /// Index of the first contact of each run.
    firsts: Vec<usize>,
    /// For each contact, the index of its run.
    of_row: Vec<usize>,
    /// For each run with more than one contact, the sums over its contacts. Only few runs have more than one contact.
    rests: HashMap<usize, Rest>,
}

/// Sums over the contacts of a run. Positions are relative to the first contact of the run.
struct Rest {
    sum: Vector3<f64>,
    normal: Vector3<f64>,
    count: f64,
}

impl Runs {
    /// Divides the contacts of each finger into runs. Each contact of a run is at most the distance `limit` away from
    /// the run's first contact. If `with_copies`, exact copies belong to the run of the first copy.
    fn new(contacts: &[Contact], limit: f64, with_copies: bool) -> Self {
        let copies = if with_copies {
            copies(contacts)
        } else {
            HashMap::new()
        };
        let mut firsts: Vec<usize> = Vec::with_capacity(contacts.len());
        let mut rests: HashMap<usize, Rest> = HashMap::new();
        let mut open: FingerMap<Option<usize>> = FingerMap::default();
        let mut of_row: Vec<usize> = Vec::with_capacity(contacts.len());
        for (row, contact) in contacts.iter().enumerate() {
            let position = contact.position;
            let first = |run: usize| &contacts[firsts[run]];
            let copied = copies.get(&row).map(|&first| of_row[first]);
            let rested = open
                .entry(contact.finger)
                .filter(|&run| (position - first(run).position).norm() <= limit);
            let run = match (copied, rested) {
                // This contact is an exact copy of an earlier contact. It is merged with that contact, but does not
                // change the mean of the merged contacts.
                (Some(run), _) => run,
                (None, Some(run)) => {
                    let rest = rests.entry(run).or_insert_with(|| Rest {
                        sum: Vector3::zeros(),
                        normal: unit(first(run)),
                        count: 1.0,
                    });
                    rest.sum += position - first(run).position;
                    rest.normal += unit(contact);
                    rest.count += 1.0;
                    run
                }
                (None, None) => {
                    firsts.push(row);
                    *open.entry(contact.finger) = Some(firsts.len() - 1);
                    firsts.len() - 1
                }
            };
            of_row.push(run);
        }
        Self {
            firsts,
            of_row,
            rests,
        }
    }

    /// Mean of the contacts of a run.
    fn mean(&self, run: usize, contacts: &[Contact]) -> Contact {
        let mut mean = contacts[self.firsts[run]];
        if let Some(rest) = self.rests.get(&run) {
            mean.position += rest.sum / rest.count;
            let normal = rest.normal.try_normalize(1e-6);
            mean.normal = mean.normal.map(|first| normal.unwrap_or(first));
        }
        mean
    }

    fn merged(self, contacts: &[Contact]) -> DistinctContacts {
        let runs = 0..self.firsts.len();
        DistinctContacts {
            contacts: runs.map(|run| self.mean(run, contacts)).collect(),
            run_of_row: self.of_row,
        }
    }
}

/// For each exact copy of an earlier contact, the index of the first such contact.
fn copies(contacts: &[Contact]) -> HashMap<usize, usize> {
    let hash = |contact: &Contact| {
        let mut hasher = DefaultHasher::new();
        bits_of(contact).hash(&mut hasher);
        hasher.finish()
    };
    // Sorting is faster than a map of all contacts, because most contacts have no copy.
    let hashes = contacts.iter().map(hash).zip(0..);
    let mut hashes: Vec<(u64, usize)> = hashes.collect();
    hashes.sort_unstable();
    let equal = hashes.chunk_by(|one, other| one.0 == other.0);
    let pairs = equal.flat_map(|rows| rows[1..].iter().map(|row| (row.1, rows[0].1)));
    let is_copy =
        |&(row, first): &(usize, usize)| bits_of(&contacts[row]) == bits_of(&contacts[first]);
    pairs.filter(is_copy).collect()
}

/// The contact's normal with length 1; zeros for a contact without a normal.
fn unit(contact: &Contact) -> Vector3<f64> {
    let normal = contact.normal.map(|normal| normal / normal.amax());
    normal.map_or(Vector3::zeros(), |normal| normal.normalize())
}

/// Bits of a contact's coordinates and normal. Equal contacts have equal bits, also if their zeros have different
/// signs.
fn bits_of(contact: &Contact) -> [u64; 6] {
    let normal = contact.normal.unwrap_or_default();
    let [x, y, z] = contact.position.into();
    [x, y, z, normal.x, normal.y, normal.z].map(|number| (number + 0.0).to_bits())
}

fn steps(contacts: &[Contact]) -> Vec<f64> {
    let mut last: FingerMap<Option<usize>> = FingerMap::default();
    let mut steps = Vec::with_capacity(contacts.len());
    for (index, contact) in contacts.iter().enumerate() {
        if let Some(before) = last.entry(contact.finger).replace(index) {
            steps.push((contact.position - contacts[before].position).norm());
        }
    }
    steps
}

/// Counts the steps of the fingers from one run of merged contacts to the next. Returns the number of steps of at most
/// the length `longest`, and the number of all steps.
fn breaks(contacts: &[Contact], runs: &Runs, longest: f64) -> [usize; 2] {
    let mut last: FingerMap<Option<usize>> = FingerMap::default();
    let [mut short, mut all] = [0, 0];
    for (index, contact) in contacts.iter().enumerate() {
        let before = last.entry(contact.finger).replace(index);
        let of_row = &runs.of_row;
        if let Some(before) = before.filter(|&before| of_row[before] != of_row[index]) {
            let step = (contact.position - contacts[before].position).norm();
            short += usize::from(step <= longest);
            all += 1;
        }
    }
    [short, all]
}

/// Probability that two consecutive contacts would be near each other by chance, if the contacts were in a random
/// order. It is estimated from pairs of contacts of a finger that are several rows apart in the log. The estimate is
/// the share of these pairs whose distance is at most `limit`. Pairs in the same run of merged contacts do not count as
/// near.
fn chance_share(contacts: &[Contact], runs: &Runs, limit: f64) -> f64 {
    let fingers = by_finger(contacts);
    let is_near = |&(one, other): &(&usize, &usize)| {
        let distance = (contacts[*one].position - contacts[*other].position).norm();
        runs.of_row[*one] != runs.of_row[*other] && distance <= limit
    };
    let (mut near, mut all) = (0, 0);
    for lag in 2..=MAX_CHANCE_LAG {
        for rows in fingers.iter().filter(|rows| rows.len() > lag) {
            near += rows.iter().zip(&rows[lag..]).filter(is_near).count();
            all += rows.len() - lag;
        }
    }
    near as f64 / all.max(1) as f64
}

/// The contacts without the lost readings. A lost reading is very far from most contacts. `None` if no contact is so
/// far, or if far contacts do not look like lost readings.
fn without_far(contacts: &[Contact]) -> Option<Vec<Contact>> {
    contacts.first()?;
    let coordinates = |axis| contacts.iter().map(|one| one.position[axis]).collect();
    let centre = Point3::from([0, 1, 2].map(|axis| median(coordinates(axis))));
    let distance = |one: &Contact| (one.position - centre).norm();
    let mut distances: Vec<f64> = contacts.iter().map(distance).collect();
    // Many successive far contacts count as lost readings only if their farthest coordinate is the same number in all
    // of them. The other coordinates may be correct.
    let wrong = |one: &Contact| farthest(&one.position, &centre);
    let is_lost = |block: &[Contact]| {
        block.len() <= MAX_BLOCK || block.iter().all(|one| wrong(one) == wrong(&block[0]))
    };
    let mut without = |share: f64| {
        let place = (distances.len() as f64 * (1.0 - share)) as usize;
        let (_, &mut usual, _) = distances.select_nth_unstable_by(place, f64::total_cmp);
        let is_near = move |one: &&Contact| distance(one) <= MIN_FAR_RATIO * usual;
        let far = contacts.iter().find(|one| !is_near(one))?;
        Some((is_near, wrong(far)))
    };
    if let Some((is_near, _)) = without(MAX_OUTLIER_SHARE) {
        let mut blocks = contacts.chunk_by(|one, other| is_near(&one) == is_near(&other));
        let are_lost = blocks.all(|block| is_near(&&block[0]) || is_lost(block));
        return are_lost.then(|| contacts.iter().filter(is_near).copied().collect());
    }
    // If more contacts are far away, they are lost readings only if the coordinate that is farthest from the others is
    // the same number in all of them.
    let (is_near, number) = without(MAX_LOST_SHARE)?;
    let mut far = contacts.iter().filter(|one| !is_near(one));
    far.all(|one| wrong(one) == number)
        .then(|| contacts.iter().filter(is_near).copied().collect())
}

/// Merges the contacts of resting fingers. The short steps must be separated from the long steps by a gap. During short
/// steps, a finger must stay at one position, and it must leave this position by a long step. `None` if the contacts do
/// not fulfil these conditions.
fn rests(contacts: &[Contact]) -> Option<DistinctContacts> {
    let mut sorted = steps(contacts);
    sorted.retain(|&step| step > 0.0);
    sorted.sort_unstable_by(f64::total_cmp);
    let from = 1.max((MIN_REST_SHARE * sorted.len() as f64).ceil() as usize);
    let mut candidates = 0;
    for place in from..sorted.len() {
        let (short, long) = (sorted[place - 1], sorted[place]);
        if long < MIN_STEP_GAP * short {
            continue;
        }
        candidates += 1;
        if candidates > MAX_GAPS {
            break;
        }
        let limit = (short * long).sqrt();
        let typical = sorted[place / 2];
        let runs = Runs::new(contacts, limit, false);
        let extents = contacts
            .iter()
            .zip(&runs.of_row)
            .map(|(contact, &run)| (contact.position - runs.mean(run, contacts).position).norm());
        let is_still = extents.fold(0.0, f64::max) <= MAX_REST_EXTENT * typical;
        if is_still && breaks(contacts, &runs, limit)[0] == 0 {
            return Some(runs.merged(contacts));
        }
    }
    None
}

/// Merges the contacts of rests whose noise is as large as the steps of the moving finger. For such rests, the lengths
/// of the steps do not separate rest from motion. Therefore the function finds a rest only if it contains most contacts
/// of a finger: these are near its median position, and the other contacts are far from it. `None` if there is no such
/// rest.
fn noisy_rests(contacts: &[Contact]) -> Option<DistinctContacts> {
    let fingers = by_finger(contacts);
    let mut moved = Vec::new();
    for rows in fingers.iter().filter(|rows| rows.len() >= MIN_NOISY_REST) {
        let position = |&row: &usize| contacts[row].position;
        let centre = Point3::from([0, 1, 2].map(|axis| {
            let places = rows.iter().map(|row| position(row)[axis]);
            median(places.collect())
        }));
        let steps = rows.windows(2);
        let steps = steps.map(|pair| (position(&pair[1]) - position(&pair[0])).norm());
        let limit = MAX_NOISY_EXTENT * median(steps.collect());
        let is_near = |at: Point3<f64>| (at - centre).norm() <= limit;
        let near = rows.iter().copied().filter(|row| is_near(position(row)));
        let near: Vec<usize> = near.collect();
        let count = near.len();
        if count < MIN_NOISY_REST || 2 * count <= rows.len() {
            continue;
        }
        let others = rows.iter().map(position).filter(|&at| !is_near(at));
        let others: Vec<f64> = others.map(|at| (at - centre).norm()).collect();
        if others.is_empty() || median(others) < MIN_REST_DISTANCE * limit {
            continue;
        }
        let offsets = near.iter().map(|row| position(row) - centre);
        let mean = centre + offsets.sum::<Vector3<f64>>() / count as f64;
        let normals = near.iter().map(|&row| unit(&contacts[row]));
        let normal = normals.sum::<Vector3<f64>>().try_normalize(1e-6);
        if moved.is_empty() {
            moved = contacts.to_vec();
        }
        for row in near {
            moved[row].position = mean;
            moved[row].normal = contacts[row].normal.map(|own| normal.unwrap_or(own));
        }
    }
    (!moved.is_empty()).then(|| DistinctContacts::within(&moved, 0.0))
}

/// Number of consecutive residuals that count as one independent residual: 1 + 2 Σ ρ, which is at least 1. The sum of
/// the correlations ρ ends at the first lag at which ρ < 2/√N, where N is the number of pairs of residuals. `absorbed`
/// is the number of parameters that were fitted to the residuals.
pub(crate) fn correlation_time(strokes: &[Vec<f64>], absorbed: usize) -> f64 {
    let total: usize = strokes.iter().map(Vec::len).sum();
    let (mut used, mut count) = (0, 0_usize);
    for stroke in strokes {
        if count < MAX_RESIDUALS {
            used += 1;
            count += stroke.len();
        }
    }
    let strokes = &strokes[..used];
    let covariance = |lag: usize| {
        let (mut sum, mut pairs) = (0.0, 0_usize);
        for stroke in strokes.iter().filter(|stroke| stroke.len() > lag) {
            let end = stroke.len().min(MAX_RESIDUALS);
            sum += (lag..end).map(|i| stroke[i] * stroke[i - lag]).sum::<f64>();
            pairs += end.saturating_sub(lag);
        }
        (sum / pairs.max(1) as f64, pairs)
    };
    let (variance, _) = covariance(0);
    if !(variance > 0.0 && variance.is_finite()) {
        return 1.0;
    }
    let mut covariances = Vec::new();
    let mut time: f64 = 1.0;
    // The first pass tests whether the residuals are correlated. Each later pass corrects all covariances, because the
    // fit has reduced the variance of the residuals. The correction uses the correlation from the pass before.
    for pass in 0..4 {
        let share = match pass {
            0 => 0.0,
            _ => time * absorbed as f64 / total as f64,
        };
        if share > MAX_ABSORBED_SHARE {
            break;
        }
        let lost = variance * share / (1.0 - share);
        let mut sum = 0.0;
        for lag in 1..MAX_LAG {
            if lag as f64 > MAX_LAG_RATIO * (1.0 + 2.0 * sum) {
                break;
            }
            if lag > covariances.len() {
                covariances.push(covariance(lag));
            }
            let (one, pairs) = covariances[lag - 1];
            let correlation = (one + lost) / (variance + lost);
            if pairs < 3 || correlation < 2.0 / (pairs as f64).sqrt() {
                break;
            }
            sum += correlation;
        }
        let next = 1.0 + 2.0 * sum;
        let is_steady = next == 1.0 || (next - time).abs() < 0.01 * time;
        time = next;
        if is_steady {
            break;
        }
    }
    time.min(total as f64)
}
