//! Warnings where what is stated of a patch is not what its contacts show.

use palpate_chance::Share;
use palpate_ep2::{Contact, Doubt, Method, Patch};
use palpate_number::Number;
use palpate_study::config::{GlideEstimatorConfig, LengthUnit};

use super::origin::Origin;
use super::stated::{LARGE_RESIDUALS, row};
use crate::glide::AnyMethod;
use crate::need::Warning;

/// Factor between the stated distance of the fingers and that of the readings past which one of them is wrong.
const FAR_OFF: f64 = 3.0;

/// Ratio of a contact's distance from the nearest other to the largest such distance of all others past which it may be no contact
/// of the patch.
const ALONE: f64 = 3.0;
/// Most contacts whose distances are compared.
const MOST_COMPARED: usize = 3000;

/// The warning where the fingers of the readings are not as far apart as is stated.
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
            "the distance between fingers is stated as {stated} {unit}, but those of the readings are {found} {unit} apart: is the unit right?"
        )
    })
}

/// The warning of a contact far from all others: a surface passes through it whatever it is.
pub(super) fn alone(contacts: &[Contact], unit: LengthUnit, origin: &Origin) -> Option<String> {
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
            "the contact of {} lies {far} {unit} from the nearest other, where no other is farther than {next} {unit} from its own: is it a contact?",
            row(contact, origin)
        )
    })
}

/// Warnings where the stated noise of contacts is not what the same method finds.
pub(super) fn noise(
    patch: &Patch,
    estimator: &GlideEstimatorConfig,
    unit: LengthUnit,
) -> Vec<Warning> {
    let mut estimator = estimator.clone();
    let (GlideEstimatorConfig::Penalised {
        position_std,
        normal_std_deg,
        ..
    }
    | GlideEstimatorConfig::Quadric {
        position_std,
        normal_std_deg,
        ..
    }) = &mut estimator
    else {
        return Vec::new();
    };
    let stated = [position_std.take(), normal_std_deg.take()];
    if stated == [None; 2] {
        return Vec::new();
    }
    let fit = AnyMethod::of(&estimator, None).fit(patch).ok();
    let Some((found, unknowns)) = fit.and_then(|fit| Some((fit.noise?, fit.effective_unknowns)))
    else {
        return Vec::new();
    };
    // Share of the readings that the fit leaves.
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
        // The standard deviation of what is found is about 1/√(2 freedom) of it.
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

/// Doubts where the normals are known to be of another surface: fitted to them, places of fingers are off too.
pub(super) fn of_wrong_normals(mut doubts: Vec<Doubt>) -> Vec<Doubt> {
    for doubt in &mut doubts {
        if let Doubt::DisplacedFinger { p_value, .. } | Doubt::StrayContact { p_value, .. } = *doubt
        {
            *doubt = Doubt::ContradictingNormals { p_value };
        }
    }
    // Of two, the one of the test of normals comes first.
    doubts.dedup_by_key(|doubt| doubt.name());
    doubts
}

/// Warnings of doubts; those about the noise and about directions are left to warnings that say more, where there are such.
pub(super) fn words(
    doubts: &[Doubt],
    of_noise: &[Warning],
    has_directions: bool,
    origin: &Origin,
) -> impl Iterator<Item = Warning> {
    doubts.iter().filter_map(move |doubt| match doubt {
        Doubt::LargeResiduals { .. } if !of_noise.is_empty() => None,
        Doubt::ContradictingNormals { .. } if has_directions => None,
        Doubt::StrayContact { contact, p_value } => Some(Warning {
            text: format!(
                "the contact of {} contradicts the others (chance does as much in {} of glides)",
                row(*contact, origin),
                Share(*p_value)
            ),
            ..Warning::from(*doubt)
        }),
        _ => Some(Warning::from(*doubt)),
    })
}
