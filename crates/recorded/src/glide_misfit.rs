//! Warnings if settings of a patch contradict its contacts.

use palpate_ep2::{Contact, Doubt, Method, Patch};
use palpate_statistics::{Number, Percent};
use palpate_study::config::{GlideEstimatorConfig, LengthUnit};

use super::consistency::{LARGE_RESIDUALS, row};
use super::misfit::Misfit;
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
    // Percent of the readings that the fit leaves.
    let left = 1.0 - unknowns / patch.equations() as f64;
    let found = [
        Some(found.position_std),
        found.normal_std_rad.map(f64::to_degrees),
    ];
    let names = [("positions", unit.as_str()), ("normals", "degrees")];
    let each = [1, 2].map(|each| each * patch.samples.len());
    let all = stated.into_iter().zip(found).zip(names).zip(each);
    all.filter_map(|(((stated, found), (what, unit)), readings)| {
        let (stated, found) = stated.zip(found)?;
        // The estimated noise has a relative standard error of about 1/√(2 freedom).
        let freedom = (left * readings as f64).max(1.0);
        let ratio = (1.0 + 3.0 / (2.0 * freedom).sqrt()).max(LARGE_RESIDUALS);
        let near = found / ratio..=found * ratio;
        let code = match found > stated {
            true => "large-residuals",
            false => "small-residuals",
        };
        let numbers = [("stated_std", stated), ("found_std", found)];
        let [stated_shown, found] = [stated, found].map(Number::rounded);
        (!near.contains(&stated)).then(|| {
            let text = format!("the noise of {what} is stated as {stated_shown} {unit}, but the contacts show {found} {unit}");
            Warning::new(code, text, numbers)
        })
    })
    .collect()
}

/// Replaces doubts about fingers and contacts by doubts about normals, for normals that are known to be wrong: a fit
/// to them displaces the fingers too.
pub(super) fn of_wrong_normals(mut doubts: Vec<Doubt>) -> Vec<Doubt> {
    for doubt in &mut doubts {
        if let Doubt::DisplacedFinger { p_value, .. } | Doubt::StrayContact { p_value, .. } = *doubt
        {
            *doubt = Doubt::ContradictingNormals { p_value };
        }
    }
    // If there are two, keep the first, which is from the test of normals.
    doubts.dedup_by_key(|doubt| doubt.name());
    doubts
}

/// Warnings for doubts. Doubts about noise or directions are skipped if a more specific warning exists.
pub(super) fn words(
    doubts: &[Doubt],
    of_noise: &[Warning],
    has_directions: bool,
    origin: &ReadingSource,
) -> impl Iterator<Item = Warning> {
    doubts.iter().filter_map(move |doubt| match doubt {
        Doubt::LargeResiduals { .. } if !of_noise.is_empty() => None,
        Doubt::ContradictingNormals { .. } if has_directions => None,
        Doubt::StrayContact { contact, p_value } => Some(Warning {
            text: format!(
                "the contact of {} contradicts the others (chance does as much in {} of glides)",
                row(*contact, origin),
                Percent(*p_value)
            ),
            ..doubt.warning()
        }),
        _ => Some(doubt.warning()),
    })
}
