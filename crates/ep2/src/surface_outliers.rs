//! Finds outliers near the surface: contacts that contradict a smooth surface through the other contacts.
//!
//! Robust polynomials find suspects. A suspect is an outlier only if a fit to the contacts without suspects also
//! contradicts it, because polynomials do not follow every surface.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::chebyshev::count;
use crate::gross_outliers::{Outlier, OutlierReason, SoundContacts, within_share};
use crate::misfit::series;
use crate::patch::sample;
use crate::square_quadric::Square;
use crate::{Contact, Patch, Penalised, ShapeError};

/// Smallest number of contacts among which outliers are searched.
const MIN_CONTACTS: usize = 12;
/// Smallest ratio of the number of contacts to the number of coefficients of a polynomial.
const MIN_CONTACTS_PER_COEFFICIENT: usize = 3;
/// Degrees of the polynomials that are tried.
const DEGREES: std::ops::RangeInclusive<usize> = 2..=4;
/// Largest number of contacts to which polynomials are fitted.
const MAX_CONTACTS: usize = 2000;
/// Largest number of iterations of a robust fit. It minimises the absolute deviations until their median changes by less
/// than the share [`MAX_CHANGE`], and then uses Tukey's biweight.
const ITERATIONS: usize = 16;
const MAX_CHANGE: f64 = 0.03;
/// A contact has no weight at the start if its distance from the median place exceeds the median distance along u or v
/// by more than this factor. A distant outlier would otherwise determine the polynomial.
const MAX_START_RATIO: f64 = 3.0;
/// Residual, as a number of standard deviations, from which Tukey's biweight is 0.
const BIWEIGHT: f64 = 4.685;
/// Residual of a suspect, as a number of standard deviations.
const SUSPECT: f64 = 4.5;
/// Ratio of a standard deviation to the median absolute deviation.
const STD_PER_MEDIAN: f64 = 1.4826;
/// Smallest standard deviation that is assumed for heights, relative to half the patch's side, and for slopes.
const MIN_STD: f64 = 1e-6;
/// Largest number of fits in which suspects are found to agree with the other contacts.
const ROUNDS: usize = 6;

impl SoundContacts {
    /// Also leaves out contacts that contradict a smooth surface through the other contacts. `contacts` are the same
    /// contacts as in [`SoundContacts::new`]. Without normals, `outward` determines the outer side of the surface.
    ///
    /// # Errors
    /// [`ShapeError::TooManyOutliers`] if more than a fifth of the contacts are outliers.
    pub fn without_misfits(
        mut self,
        contacts: &[Contact],
        outward: &Vector3<f64>,
    ) -> Result<Self, ShapeError> {
        let is_outlier = outliers(&self.distinct.contacts, outward);
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

/// Whether each contact is an outlier.
fn outliers(contacts: &[Contact], outward: &Vector3<f64>) -> Vec<bool> {
    let none = vec![false; contacts.len()];
    let patch = Patch::new(contacts, outward).ok();
    let Some(mut is_outlier) = patch.and_then(|patch| suspects(&patch)) else {
        return none;
    };
    for _ in 0..ROUNDS {
        if !is_outlier.contains(&true) {
            break;
        }
        let select = |outliers: bool| {
            let all = contacts.iter().zip(&is_outlier);
            all.filter(move |(_, one)| **one == outliers)
                .map(|(contact, _)| *contact)
        };
        let sound: Vec<Contact> = select(false).collect();
        let Ok(patch) = Patch::new(&sound, outward) else {
            return none;
        };
        let suspects = select(true).map(|suspect| sample(&patch.frame, 0, &suspect).ok());
        let suspects: Vec<_> = suspects.collect();
        let Ok(contradicts) = Penalised::default().contradicting(&patch, &suspects) else {
            return none;
        };
        let mut contradicts = contradicts.into_iter();
        let before = is_outlier.clone();
        for one in is_outlier.iter_mut().filter(|one| **one) {
            *one = contradicts.next().unwrap_or(false);
        }
        if is_outlier == before {
            break;
        }
    }
    is_outlier
}

/// Whether each contact of a patch may be an outlier; `None` if there are too few contacts.
fn suspects(patch: &Patch) -> Option<Vec<bool>> {
    let (thinned, _) = patch.thinned(MAX_CONTACTS);
    let contacts = thinned.samples.len();
    if contacts < MIN_CONTACTS {
        return None;
    }
    let square = Square::of(patch);
    let most = *DEGREES.end();
    let rows = |patch: &Patch| -> Vec<DMatrix<f64>> {
        let samples = patch.samples.iter();
        samples.map(|sample| series(square, most, sample)).collect()
    };
    let fitted = rows(&thinned);
    let heights = thinned.samples.iter().map(|sample| sample.w);
    let heights = DVector::from_iterator(contacts, heights);
    let start = start_weights(&thinned);
    let degrees = DEGREES.filter(|&degree| {
        degree == *DEGREES.start() || contacts >= MIN_CONTACTS_PER_COEFFICIENT * count(degree)
    });
    let fits = degrees.filter_map(|degree| robust(&fitted, count(degree), &heights, &start));
    let (_, coefficients) = fits.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    let has_normals = patch.has_normals();
    let all = if contacts == patch.samples.len() {
        fitted
    } else {
        rows(patch)
    };
    let mut is_suspect = vec![false; all.len()];
    for kind in 0..if has_normals { 3 } else { 1 } {
        let residuals = patch.samples.iter().zip(&all).map(|(sample, row)| {
            let [along_u, along_v] = sample.slopes.unwrap_or_default();
            let row = row.row(kind);
            let fitted = row.columns(0, coefficients.len()) * &coefficients;
            ([sample.w, along_u, along_v][kind] - fitted[0]).abs()
        });
        let residuals: Vec<f64> = residuals.collect();
        let limit = SUSPECT * std(&residuals, coefficients.len());
        for (one, residual) in is_suspect.iter_mut().zip(residuals) {
            *one |= residual > limit;
        }
    }
    Some(is_suspect)
}

/// Weights of the contacts at the start of a robust fit.
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

/// Standard deviation and coefficients of a polynomial that few outliers affect only slightly. `None` if the contacts do
/// not determine the polynomial.
fn robust(
    rows: &[DMatrix<f64>],
    coefficients: usize,
    heights: &DVector<f64>,
    start: &[f64],
) -> Option<(f64, DVector<f64>)> {
    let entry = |row: usize, column: usize| rows[row][(0, column)];
    let rows = DMatrix::from_fn(rows.len(), coefficients, entry);
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
        let std = std(residuals.as_slice(), coefficients);
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

/// Standard deviation that corresponds to the median of absolute residuals, after a fit of `coefficients`.
fn std(residuals: &[f64], coefficients: usize) -> f64 {
    let freedom = residuals.len().saturating_sub(coefficients).max(1);
    let correction = 1.0 + 5.0 / freedom as f64;
    (STD_PER_MEDIAN * correction * median(residuals.to_vec())).max(MIN_STD)
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
