//! Finds outliers near the surface: contacts that contradict a smooth surface through the other contacts.
//!
//! Robust polynomial fits find suspects, which are contacts far from the polynomial. Because polynomials do not follow
//! every surface, a second fit to the contacts without suspects tests each suspect. A suspect is an outlier only if it
//! contradicts this fit too. Outliers that lie close together are kept as a part of the surface, unless the path of a
//! finger jumps to them.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector, Vector3};
use palpate_statistics::evenly_spaced;

use crate::chebyshev::{count, products};
use crate::gross_outliers::{Outlier, OutlierReason, SoundContacts, within_share};
use crate::noise::{MIN_OUTLIER_STEPS, Resolution};
use crate::patch::{Sample, by_finger, sample};
use crate::square_quadric::Square;
use crate::{Contact, Patch, Penalised, ShapeError};

const MIN_CONTACTS: usize = 24;
/// A robust fit tries polynomials of several degrees. A degree above the smallest one is tried only if the number of
/// contacts per coefficient is at least this value.
const MIN_CONTACTS_PER_COEFFICIENT: usize = 3;
const DEGREES: RangeInclusive<usize> = 2..=MAX_DEGREE;
const MAX_DEGREE: usize = 4;
/// Number of coefficients of a polynomial with the largest degree.
const COUNT: usize = count(MAX_DEGREE);
const MAX_CONTACTS: usize = 2000;
/// A contact that represents a rest of a finger has the number of its rows as weight, but at most this weight.
const MAX_REPEATS: usize = 5;
/// Largest number of iterations of a robust fit. The fit minimises the absolute deviations until their median changes
/// by less than the share [`MAX_CHANGE`], and then uses Tukey's biweight.
const ITERATIONS: usize = 16;
const MAX_CHANGE: f64 = 0.03;
/// At the start of a fit, distant contacts have no weight, because an outlier among them would determine the
/// polynomial. A contact is distant if, along u or along v, its distance from the median place exceeds this multiple of
/// the median of these distances.
const MAX_START_RATIO: f64 = 3.0;
/// Tukey's biweight is 0 if the residual exceeds this number of standard deviations.
const BIWEIGHT: f64 = 4.685;
/// A contact is a suspect if its residual exceeds this number of standard deviations.
const SUSPECT: f64 = 4.5;
/// Standard deviation of a normal distribution, divided by its median absolute deviation.
const STD_PER_MEDIAN: f64 = 1.4826;
/// Smallest standard deviation that is assumed for heights, relative to half the patch's side, and for slopes.
const MIN_STD: f64 = 1e-6;
/// Smallest residual of a suspect, relative to the heights' median deviation from their median, or to the median slope.
/// Without this limit, exact readings would be suspects because of the small errors of the fitted polynomial.
const MIN_RELATIVE_RESIDUAL: f64 = 0.02;
/// Largest number of fits that test whether suspects agree with the other contacts.
const ROUNDS: usize = 6;
/// A chain of at least this number of contacts is a part of a finger's path.
const MIN_CHAIN: usize = 20;
/// To test whether outliers lie together, this number of nearest contacts of each outlier is examined. If there are
/// more than `MAX_EXAMINED` outliers, only a part of the outliers is examined.
const NEIGHBOURS: usize = 4;
const MAX_EXAMINED: usize = 100;
/// A neighbour of an outlier is examined only if it is far enough from the outlier. This constant is its smallest
/// distance, relative to the distance of the nearest contact that is not an outlier. The limit excludes other outliers
/// at the same point beside the surface.
const MIN_DISTANCE_RATIO: f64 = 0.3;
/// Outliers lie together if many of their nearest contacts are outliers too. They are then kept as a part of the
/// surface. This constant is the limit for the mean share of outliers among the nearest contacts. The limit is at least
/// `MAX_RELATIVE_NEIGHBOUR_SHARE` times the share of outliers among all contacts.
const MAX_NEIGHBOUR_SHARE: f64 = 0.3;
const MAX_RELATIVE_NEIGHBOUR_SHARE: f64 = 1.2;
/// Longest step along the path of a finger, relative to the median step. If the step skips contacts as outliers, the
/// limit increases by `MAX_SKIPPED_STEP_RATIO` for each skipped contact.
const MAX_STEP_RATIO: f64 = 3.0;
const MAX_SKIPPED_STEP_RATIO: f64 = 1.5;
/// A step out of the surface has at least this share of its length along the normal of the patch.
const MIN_RISE: f64 = 0.5;
/// Largest number of successive outliers that the path of a finger skips.
const MAX_SKIPPED: usize = 30;

impl SoundContacts {
    /// Leaves out not only the gross outliers, but also contacts that contradict a smooth surface through the other
    /// contacts. `contacts` are the same contacts as in [`SoundContacts::new`]. Without normals, `outward` determines
    /// the outer side of the surface.
    ///
    /// # Errors
    /// [`ShapeError::TooManyOutliers`] if more than a fifth of the contacts are outliers.
    pub fn without_misfits(
        mut self,
        contacts: &[Contact],
        outward: &Vector3<f64>,
    ) -> Result<Self, ShapeError> {
        let mut counts = vec![0; self.distinct.contacts.len()];
        for &run in &self.distinct.run_of_row {
            counts[run] += 1;
        }
        let resolution = Resolution::new(self.rows.iter().map(|&row| &contacts[row]));
        let all = &self.distinct.contacts;
        let mut is_beside_path = beside_paths(all);
        let mut is_outlier = outliers(all, &counts, &is_beside_path, &resolution, outward);
        for (contact, is_shifted) in shifted_runs(all, &is_outlier, outward) {
            (is_beside_path[contact], is_outlier[contact]) = (is_shifted, is_shifted);
        }
        let pairs = is_outlier.iter().zip(&is_beside_path);
        let on_path: Vec<bool> = pairs.map(|(one, is_beside)| *one && !is_beside).collect();
        if on_path.contains(&true) && !are_scattered(all, &on_path, outward) {
            let pairs = is_outlier.iter_mut().zip(on_path);
            pairs.for_each(|(one, is_on_path)| *one &= !is_on_path);
        }
        if !is_outlier.contains(&true) {
            return Ok(self);
        }
        let runs = self.distinct.run_of_row.iter().zip(&self.rows);
        let misfits = runs.filter(|(run, _)| is_outlier[**run]);
        self.outliers.extend(misfits.map(|(_, row)| Outlier {
            contact: *row,
            reason: OutlierReason::Misfit,
        }));
        self.outliers.sort_by_key(|outlier| outlier.contact);
        let outliers = within_share(self.outliers, contacts.len())?;
        Ok(Self::without(contacts, outliers))
    }
}

/// Whether each contact is beside the path of its finger. A chain is a sequence of contacts without jumps, which are
/// steps much longer than the median step. A chain may skip contacts. The path consists of the longest chain and of all
/// other long chains, such as further strokes. All other contacts are beside the path. A finger moves without jumps, so
/// such a contact is suspect even if other contacts lie close to it. In contacts without an order, the median step is
/// long too, so there are no jumps, and no contact is beside the path.
fn beside_paths(contacts: &[Contact]) -> Vec<bool> {
    let fingers = by_finger(contacts);
    let distance =
        |one: usize, other: usize| (contacts[one].position - contacts[other].position).norm();
    let steps_of = |finger: &Vec<usize>| -> Vec<f64> {
        let pairs = finger.windows(2);
        pairs.map(|pair| distance(pair[0], pair[1])).collect()
    };
    let mut steps = fingers.iter().flat_map(steps_of).peekable();
    let median_of_all = steps.peek().is_some().then(|| median(steps.collect()));
    let mut is_beside = vec![false; contacts.len()];
    for finger in fingers.iter().filter(|finger| finger.len() > 1) {
        // This finger may have longer steps than the others, so use the larger of two medians: that of its own steps,
        // and that of the steps of all fingers.
        let step = median(steps_of(finger)).max(median_of_all.unwrap_or(0.0));
        let limits = [MAX_STEP_RATIO, MAX_SKIPPED_STEP_RATIO].map(|ratio| ratio * step);
        // The chains of contacts without a jump. For each contact: the number of contacts in the longest chain that
        // ends at it, and the previous contact in this chain.
        let mut paths: Vec<(usize, Option<usize>)> = Vec::with_capacity(finger.len());
        for place in 0..finger.len() {
            let is_near = |before: &usize| {
                let skipped = (place - before - 1) as f64;
                distance(finger[*before], finger[place]) <= limits[0] + skipped * limits[1]
            };
            let near = (place.saturating_sub(MAX_SKIPPED + 1)..place)
                .rev()
                .filter(is_near);
            let longest = near
                .map(|before| (paths[before].0, before))
                .max_by_key(|one| one.0);
            paths.push(longest.map_or((1, None), |(count, before)| (count + 1, Some(before))));
        }
        finger.iter().for_each(|&contact| is_beside[contact] = true);
        let mut ends: Vec<usize> = (0..finger.len()).collect();
        ends.sort_by_key(|&place| std::cmp::Reverse(paths[place].0));
        let least = paths[ends[0]].0.min(MIN_CHAIN);
        for end in ends.into_iter().filter(|&end| paths[end].0 >= least) {
            // A chain that branches off from another one belongs to the path only if its own part is long.
            let chain = std::iter::successors(Some(end), |&place| paths[place].1);
            let own = chain.take_while(|&place| is_beside[finger[place]]);
            if own.clone().take(least).count() == least {
                let own: Vec<usize> = own.collect();
                own.into_iter()
                    .for_each(|place| is_beside[finger[place]] = false);
            }
        }
    }
    is_beside
}

/// Contacts of fingers that slip, or whose frame slips, each with whether it is shifted. A jump out of the surface
/// separates a run of contacts from the rest of its finger, and most contacts of the run are outliers. Either the run is
/// shifted, or the rest is: the shifted part contradicts a smooth surface through the contacts of the other fingers, and
/// the sound part agrees with it. Contacts of a sound rest are not in the result, because single outliers may be among
/// them.
fn shifted_runs(
    contacts: &[Contact],
    is_outlier: &[bool],
    outward: &Vector3<f64>,
) -> Vec<(usize, bool)> {
    let patch = Patch::new(&selected(contacts.iter()), outward);
    let normal = patch.map(|patch| patch.frame.direction_in_world(&Vector3::z()));
    let normal = normal.unwrap_or_default();
    let step = |one: usize, next: usize| contacts[next].position - contacts[one].position;
    let outliers = |run: &[usize]| run.iter().filter(|one| is_outlier[**one]).count();
    let mut shifted = Vec::new();
    for finger in by_finger(contacts).iter().filter(|finger| finger.len() > 1) {
        let lengths = finger.windows(2).map(|pair| step(pair[0], pair[1]).norm());
        let longest = MAX_STEP_RATIO * median(lengths.collect());
        let is_path = |one: &usize, next: &usize| {
            let step = step(*one, *next);
            step.norm() <= longest || step.dot(&normal).abs() < MIN_RISE * step.norm()
        };
        let is_run = |run: &&[usize]| run.len() < finger.len() && 2 * outliers(run) > run.len();
        let (runs, rest): (Vec<_>, Vec<_>) = finger.chunk_by(is_path).partition(is_run);
        let (runs, rest) = (runs.concat(), rest.concat());
        if runs.is_empty() || rest.is_empty() {
            continue;
        }
        let is_other = |one: &Contact| one.finger != contacts[finger[0]].finger;
        let others = contacts.iter().zip(is_outlier);
        let others = others.filter(|(one, is_outlier)| is_other(one) && !**is_outlier);
        let Ok(patch) = Patch::new(&selected(others.map(|(one, _)| one)), outward) else {
            continue;
        };
        let contradict = |part: &[usize]| {
            let samples = part
                .iter()
                .map(|&one| sample(&patch.frame, 0, &contacts[one]).ok());
            let samples: Vec<_> = samples.collect();
            let found = Penalised::default().contradicting(&patch, &samples).ok()?;
            Some(2 * found.iter().filter(|one| **one).count() > part.len())
        };
        match (contradict(&runs), contradict(&rest)) {
            (Some(true), Some(false)) => shifted.extend(runs.iter().map(|one| (*one, true))),
            (Some(false), Some(true)) => {
                shifted.extend(rest.iter().map(|one| (*one, true)));
                shifted.extend(runs.iter().map(|one| (*one, false)));
            }
            _ => {}
        }
    }
    shifted
}

/// Whether outliers are scattered among the other contacts. Contacts that lie together, such as those of a bump, are
/// part of the surface. The nearest contacts along the mean plane are compared: in a dense log, outliers are nearer to
/// each other than to the surface.
fn are_scattered(contacts: &[Contact], is_outlier: &[bool], outward: &Vector3<f64>) -> bool {
    let sound = contacts.iter().zip(is_outlier).filter(|(_, one)| !**one);
    let Ok(patch) = Patch::new(&selected(sound.map(|(contact, _)| contact)), outward) else {
        return false;
    };
    let share = |are: &[bool]| are.iter().filter(|one| **one).count() as f64 / are.len() as f64;
    let places = contacts.iter().map(|contact| contact.position);
    let outliers: Vec<usize> = (0..contacts.len()).filter(|&one| is_outlier[one]).collect();
    let step = outliers.len().div_ceil(MAX_EXAMINED);
    let shares = outliers.iter().step_by(step).map(|&outlier| {
        let place = contacts[outlier].position;
        let others = places.clone().zip(is_outlier).enumerate();
        let others = others.filter(|(index, _)| *index != outlier);
        let mut near: Vec<(f64, f64, bool)> = others
            .map(|(_, (other, is_outlier))| {
                let step = other - place;
                let along = patch.frame.direction(&step).xy().norm();
                (along, step.norm(), *is_outlier)
            })
            .collect();
        let sound = near.iter().filter(|one| !one.2).map(|one| one.1);
        let least = MIN_DISTANCE_RATIO * sound.fold(f64::INFINITY, f64::min);
        near.retain(|(_, distance, _)| *distance >= least);
        near.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        let near = near.iter().take(NEIGHBOURS);
        share(&near.map(|one| one.2).collect::<Vec<_>>())
    });
    let shares: Vec<f64> = shares.collect();
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    mean <= MAX_NEIGHBOUR_SHARE.max(MAX_RELATIVE_NEIGHBOUR_SHARE * share(is_outlier))
}

/// Whether each contact is an outlier. `counts` contains the number of rows of the log that each contact represents; it
/// is the weight of the contact. The weight is needed if a slow finger has outliers between its contacts. The outliers
/// make the typical step seem long. Then many contacts of the slow finger are merged as a rest, and the merged contact
/// must have their weight. Contacts beside the path of their finger (`is_beside_path`) are suspects, and have no
/// weight.
fn outliers(
    contacts: &[Contact],
    counts: &[usize],
    is_beside_path: &[bool],
    resolution: &Resolution,
    outward: &Vector3<f64>,
) -> Vec<bool> {
    let none = vec![false; contacts.len()];
    let pairs = counts.iter().zip(is_beside_path);
    let repeats = pairs.map(|(count, is_beside)| match is_beside {
        true => 0,
        false => (*count).min(MAX_REPEATS),
    });
    let weighted = contacts.iter().zip(repeats);
    let weighted = weighted.flat_map(|(contact, repeats)| std::iter::repeat_n(contact, repeats));
    let patch = Patch::new(&selected(weighted), outward).ok();
    let Some(mut is_outlier) = patch.and_then(|patch| suspects(&patch, contacts, resolution))
    else {
        return none;
    };
    let suspects = is_outlier.iter_mut().zip(is_beside_path);
    suspects.for_each(|(one, is_beside)| *one |= is_beside);
    for _ in 0..ROUNDS {
        if !is_outlier.contains(&true) {
            break;
        }
        let part = |is_part: bool| {
            let all = contacts.iter().zip(&is_outlier);
            all.filter(move |(_, one)| **one == is_part)
                .map(|(contact, _)| contact)
        };
        let sound = selected(part(false));
        let Ok(patch) = Patch::new(&sound, outward) else {
            return none;
        };
        let suspects = part(true).map(|suspect| sample(&patch.frame, 0, suspect).ok());
        let suspects: Vec<_> = suspects.collect();
        let Ok(contradicts) = Penalised::default().contradicting(&patch, &suspects) else {
            return none;
        };
        let is_steady = !contradicts.contains(&false);
        let mut contradicts = contradicts.into_iter();
        for one in is_outlier.iter_mut().filter(|one| **one) {
            *one = contradicts.next().unwrap_or(false);
        }
        if is_steady {
            break;
        }
    }
    is_outlier
}

/// An evenly spaced selection of at most [`MAX_CONTACTS`] contacts.
fn selected<'a>(contacts: impl Iterator<Item = &'a Contact>) -> Vec<Contact> {
    let all: Vec<&Contact> = contacts.collect();
    evenly_spaced(all.len(), MAX_CONTACTS)
        .map(|contact| *all[contact])
        .collect()
}

/// Whether each contact may be an outlier. `patch` contains a selection of the contacts. `None` if the selection has
/// too few contacts.
fn suspects(patch: &Patch, contacts: &[Contact], resolution: &Resolution) -> Option<Vec<bool>> {
    let count_of_fitted = patch.samples.len();
    if count_of_fitted < MIN_CONTACTS {
        return None;
    }
    let square = Square::of(patch);
    let samples = patch.samples.iter();
    let heights = samples.clone().map(|sample| sample.w);
    let heights = DVector::from_iterator(count_of_fitted, heights);
    let start = start_weights(patch);
    let values = samples.map(|sample| products_at(square.place([sample.u, sample.v])).0);
    let values: Vec<_> = values.collect();
    let degrees = DEGREES.filter(|&degree| {
        degree == *DEGREES.start()
            || count_of_fitted >= MIN_CONTACTS_PER_COEFFICIENT * count(degree)
    });
    let fits = degrees.filter_map(|degree| robust(&values, count(degree), &heights, &start));
    let (_, coefficients) = fits.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    let [half_u, half_v] = square.half();
    let residuals = |sample: &Sample| {
        let (values, along_a, along_b) = products_at(square.place([sample.u, sample.v]));
        let fitted = [values, along_a, along_b].map(|values| {
            let products = coefficients.iter().zip(values);
            products.map(|(one, value)| one * value).sum::<f64>()
        });
        let height = (sample.w - fitted[0]).abs();
        let slopes = sample.slopes.map_or([0.0; 2], |[along_u, along_v]| {
            [along_u - fitted[1] / half_u, along_v - fitted[2] / half_v].map(f64::abs)
        });
        [height, slopes[0], slopes[1]]
    };
    let of_fitted: Vec<[f64; 3]> = patch.samples.iter().map(residuals).collect();
    let middle = median(heights.as_slice().to_vec());
    let deviations = heights.iter().map(|height| (height - middle).abs());
    let slopes = |axis: usize| {
        let slopes = patch.samples.iter().filter_map(|sample| sample.slopes);
        let slopes: Vec<f64> = slopes.map(|slopes| slopes[axis].abs()).collect();
        match slopes.is_empty() {
            true => 0.0,
            false => median(slopes),
        }
    };
    let typical = [median(deviations.collect()), slopes(0), slopes(1)];
    let normal = patch.frame.direction_in_world(&Vector3::z());
    let step = resolution.steps(&normal.abs()).amax() / patch.frame.scale();
    let rounding = MIN_OUTLIER_STEPS * step;
    let limits: [f64; 3] = std::array::from_fn(|kind| {
        let of_kind = of_fitted.iter().map(|residuals| residuals[kind]);
        let limit = SUSPECT * std(of_kind.collect(), coefficients.len());
        let of_rounding = if kind == 0 { rounding } else { 0.0 };
        limit
            .max(MIN_RELATIVE_RESIDUAL * typical[kind])
            .max(of_rounding)
    });
    let is_suspect = |contact: &Contact| {
        let residuals = sample(&patch.frame, 0, contact).map(|sample| residuals(&sample));
        !residuals.is_ok_and(|residuals| (0..3).all(|kind| residuals[kind] <= limits[kind]))
    };
    Some(contacts.iter().map(is_suspect).collect())
}

/// Products of Chebyshev polynomials at a place of the square, and the derivatives of these products along both axes.
/// Their order is that of [`products`].
fn products_at(place: [f64; 2]) -> ([f64; COUNT], [f64; COUNT], [f64; COUNT]) {
    let [of_a, of_b] = place.map(|x| {
        let mut all = [[1.0, 0.0]; MAX_DEGREE + 1];
        all[1] = [x, 1.0];
        for order in 2..=MAX_DEGREE {
            let ([last, slope], [before, slope_before]) = (all[order - 1], all[order - 2]);
            all[order] = [
                2.0 * x * last - before,
                2.0 * last + 2.0 * x * slope - slope_before,
            ];
        }
        all
    });
    let mut all = ([0.0; COUNT], [0.0; COUNT], [0.0; COUNT]);
    for (index, [i, j]) in products(MAX_DEGREE).enumerate() {
        all.0[index] = of_a[i][0] * of_b[j][0];
        all.1[index] = of_a[i][1] * of_b[j][0];
        all.2[index] = of_a[i][0] * of_b[j][1];
    }
    all
}

fn start_weights(patch: &Patch) -> Vec<f64> {
    let mut weights = vec![1.0; patch.samples.len()];
    for axis in 0..2 {
        let places = patch
            .samples
            .iter()
            .map(|sample| [sample.u, sample.v][axis]);
        let middle = median(places.clone().collect());
        let distances: Vec<f64> = places.map(|place| (place - middle).abs()).collect();
        let most = MAX_START_RATIO * median(distances.clone());
        for (weight, distance) in weights.iter_mut().zip(distances) {
            if most > 0.0 && distance > most {
                *weight = 0.0;
            }
        }
    }
    weights
}

/// Standard deviation of the residuals, and coefficients, of a robust polynomial fit. `None` if the contacts do not
/// determine the polynomial.
fn robust(
    values: &[[f64; COUNT]],
    coefficients: usize,
    heights: &DVector<f64>,
    start: &[f64],
) -> Option<(f64, DVector<f64>)> {
    let rows = DMatrix::from_fn(values.len(), coefficients, |row, column| {
        values[row][column]
    });
    let start = DVector::from_column_slice(start);
    let mut weights = start.clone();
    let (mut is_first, mut last) = (true, f64::INFINITY);
    let mut found = None;
    for _ in 0..ITERATIONS {
        let weighted = DMatrix::from_fn(coefficients, rows.nrows(), |column, row| {
            rows[(row, column)] * weights[row]
        });
        let mut gram = &weighted * &rows;
        let least = 1e-9 * gram.trace();
        for place in 0..coefficients {
            gram[(place, place)] += least;
        }
        let solved = gram.cholesky()?.solve(&(weighted * heights));
        let residuals = (heights - &rows * &solved).abs();
        let std = std(residuals.as_slice().to_vec(), coefficients);
        let is_steady = (std - last).abs() < MAX_CHANGE * std;
        found = Some((std, solved));
        if is_steady && !is_first {
            break;
        }
        is_first &= !is_steady;
        last = std;
        weights = match is_first {
            true => residuals.zip_map(&start, |residual, start| start / residual.max(0.1 * std)),
            false => residuals.map(|residual| {
                let share = residual / (BIWEIGHT * std);
                (1.0 - share * share).max(0.0).powi(2)
            }),
        };
    }
    found.filter(|(std, solved)| std.is_finite() && solved.iter().all(|one| one.is_finite()))
}

/// Standard deviation of the noise, estimated from the median of the absolute residuals of a fit with `coefficients`
/// parameters.
fn std(residuals: Vec<f64>, coefficients: usize) -> f64 {
    let freedom = residuals.len().saturating_sub(coefficients).max(1);
    let correction = 1.0 + 5.0 / freedom as f64;
    (STD_PER_MEDIAN * correction * median(residuals)).max(MIN_STD)
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
