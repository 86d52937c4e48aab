//! Warnings if settings of a patch contradict its contacts.

use palpate_ep2::{Contact, Method, Patch};
use palpate_statistics::{Misfit, Number, SIGNIFICANCE_LEVEL, StatedQuantity, chi_squared_tail};
use palpate_study::config::{GlideEstimatorConfig, LengthUnit};

use super::consistency::row;
use super::misfit_warning::ReadingWords;
use super::source::ReadingSource;
use palpate_estimators::GlideFit;
use palpate_study::Warning;

/// Factor between the stated and the measured finger distance above which one of them is wrong.
const FAR_OFF: f64 = 3.0;

/// A contact may be an outlier if its distance to its nearest neighbour exceeds that of every other contact by this
/// factor.
const ALONE: f64 = 3.0;
/// Largest number of contacts for which distances are compared.
const MOST_COMPARED: usize = 3000;

/// The warning if the distance between fingers in the readings is not the stated one.
pub(super) fn spacing(
    patch: &Patch,
    stated: Option<f64>,
    estimator: &GlideEstimatorConfig,
    unit: LengthUnit,
) -> Option<String> {
    let stated = stated?;
    let found = patch.finger_distance? * patch.frame.scale();
    let is_used = matches!(estimator, GlideEstimatorConfig::TwoPass { .. })
        || estimator.position_fraction_of_ifd().is_some();
    let near = found / FAR_OFF..=found * FAR_OFF;
    (is_used && !near.contains(&stated)).then(|| {
        let [stated, found] = [stated, found].map(Number::rounded);
        let unit = unit.as_str();
        format!(
            "the distance between fingers is stated as {stated} {unit}, but the fingers of the readings are {found} {unit} apart: is the unit right?"
        )
    })
}

/// The warning about a contact far from all others: the fitted surface passes through it even if it is wrong.
pub(super) fn alone(
    contacts: &[Contact],
    unit: LengthUnit,
    origin: &ReadingSource,
) -> Option<String> {
    if contacts.len() > MOST_COMPARED {
        return None;
    }
    let nearest = |place: usize| {
        let others = contacts
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != place);
        others
            .map(|(_, other)| (other.position - contacts[place].position).norm())
            .fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<(f64, usize)> = (0..contacts.len())
        .map(|place| (nearest(place), place))
        .collect();
    distances.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let [(far, contact), (next, _), ..] = distances[..] else {
        return None;
    };
    (far > ALONE * next && next > 0.0).then(|| {
        let ([far, next], unit) = ([far, next].map(Number::rounded), unit.as_str());
        format!(
            "the contact of {} lies {far} {unit} from the nearest other contact, but all others lie within {next} {unit} of theirs: is it a contact?",
            row(contact, origin)
        )
    })
}

/// Ratio of the estimated noise to the stated one, or its inverse, above which the intervals are wrong.
const MAX_NOISE_RATIO: f64 = 1.5;

/// Warnings if the stated noise of contacts differs from the noise that the same method estimates.
pub(super) fn noise(
    patch: &Patch,
    estimator: &GlideEstimatorConfig,
    unit: LengthUnit,
) -> Vec<Warning> {
    let (estimator, stated) = estimator.clone().without_noise();
    if stated == [None; 2] {
        return Vec::new();
    }
    let fit = GlideFit::of(&estimator, None).fit(patch).ok();
    let Some((found, unknowns)) = fit.and_then(|fit| Some((fit.noise?, fit.effective_unknowns)))
    else {
        return Vec::new();
    };
    let found = [
        Some(found.position_std),
        found.normal_std_rad.map(f64::to_degrees),
    ];
    // Share of the readings that the fit leaves.
    let left = 1.0 - unknowns / patch.equations() as f64;
    let kinds = [("positions", unit.as_str(), 1), ("normals", "degrees", 2)];
    let all = stated.into_iter().zip(found).zip(kinds);
    all.filter_map(|((stated, found), (noise_of, unit, components))| {
        let (stated, estimated) = stated.zip(found)?;
        let ratio = estimated / stated;
        let freedom = (left * (components * patch.samples.len()) as f64).max(1.0);
        let larger = chi_squared_tail(freedom * ratio * ratio, freedom.round() as usize);
        let p_value = 2.0 * larger.min(1.0 - larger);
        let is_far = ratio.max(ratio.recip()) > MAX_NOISE_RATIO && p_value < SIGNIFICANCE_LEVEL;
        let words = ReadingWords {
            reading: &|_| String::new(),
            noise_of,
            unit,
        };
        is_far.then(|| {
            words.warning(&Misfit::Stated {
                quantity: StatedQuantity::Noise,
                stated,
                estimated,
                p_value,
            })
        })
    })
    .collect()
}

/// Warnings of misfits. Wrong normals make a contact seem an outlier.
pub(super) fn misfit_warnings(
    misfits: &[Misfit],
    are_normals_wrong: bool,
    origin: &ReadingSource,
) -> impl Iterator<Item = Warning> {
    misfits.iter().filter_map(move |misfit| {
        let words = ReadingWords {
            reading: &|contact| format!("the contact of {}", row(contact, origin)),
            noise_of: "contacts",
            unit: "",
        };
        let is_caused = are_normals_wrong && matches!(misfit, Misfit::Outlier { .. });
        (!is_caused).then(|| words.warning(misfit))
    })
}
