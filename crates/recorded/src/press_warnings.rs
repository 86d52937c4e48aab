//! Warnings about recorded presses: values that contradict the settings, and likely mistakes.

use palpate_estimators::large_contact_warning;
use palpate_press::{ForwardFit, Measured, Misfit, PressError, PressEstimate, Prior, Reading};
use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::{Baseline, LengthUnit, PressEstimatorConfig};

use super::misfit_warning::ReadingWords;
use super::press_options::PressOptions;
use super::press_recording::PressRecording;
use super::press_report::Row;
use super::source::ReadingSource;

/// Assumed standard deviation of an indentation that is stated without a standard deviation, relative to the
/// indentation.
const INDENTATION_SHARE: f64 = 0.02;

/// The stated indentation with its standard deviation. If the standard deviation is not stated, it is assumed, and the
/// second result is a warning.
pub(super) fn stated_indentation(value: f64, std: f64, unit: &str) -> (Measured, Option<Warning>) {
    if std > 0.0 {
        return (Measured { value, std }, None);
    }
    let std = INDENTATION_SHARE * value;
    let percent = 100.0 * INDENTATION_SHARE;
    let text = format!(
        "the indentation is stated without a standard deviation above 0, so a standard deviation of {} {unit} ({percent} % of the indentation) is assumed; setting `indentation_std` states it",
        Number::rounded(std)
    );
    let warning = Warning::new("assumed-indentation-std", text, [("std", std)]);
    (Measured { value, std }, Some(warning))
}

/// Converts `checked`, the result of the comparison of a stated indentation with the readings. Returns a misfit if they
/// contradict each other, a warning if the comparison was impossible, or neither.
pub(super) fn indentation_check(
    checked: Result<Option<Misfit>, PressError>,
) -> (Option<Misfit>, Option<Warning>) {
    checked.map_or_else(
        |reason| {
            let text = format!(
                "the stated indentation cannot be checked, because the readings alone do not determine an indentation: {reason}"
            );
            (None, Some(Warning::new("unchecked-indentation", text, [])))
        },
        |misfit| (misfit, None),
    )
}

pub(super) fn misfit_warning(misfit: &Misfit, source: &ReadingSource, unit: LengthUnit) -> Warning {
    let words = ReadingWords {
        reading: &|marker| format!("the marker of {}", source.row(marker)),
        noise_of: "displacements",
        unit: unit.as_str(),
    };
    let mut warning = words.warning(misfit);
    if let Misfit::Outlier { reading, .. } = *misfit {
        let index = source.row_number(reading) - 1;
        warning.numbers.insert("reading".into(), index as f64);
    }
    warning
}

/// Warning about markers that were left out as outliers. `wrong` contains the index and the row of each of these
/// markers, and `distances` the distance of every marker from the contact. `has_indentation` states whether the user
/// gave an indentation.
pub(super) fn left_out(
    wrong: &[(usize, &Row)],
    distances: &[f64],
    contact_radius: f64,
    has_indentation: bool,
) -> Option<Warning> {
    let (count, all) = (wrong.len(), distances.len());
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let is_of_contact = |(marker, _): &&(usize, _)| {
        distances[*marker] <= nearest || distances[*marker] < contact_radius
    };
    let mut text = format!("{count} of {all} markers contradict the others and are not used");
    if let Some((_, row)) = wrong.iter().find(is_of_contact) {
        let stated = match has_indentation {
            true => "the indentation or a value of the sensor",
            false => "a value of the sensor",
        };
        let line = row
            .line
            .map_or(String::new(), |line| format!(", line {line}"));
        text += &format!(
            ", among them a marker at the contact itself (row {}{line}): perhaps {stated} is wrong instead",
            row.row
        );
    }
    let numbers = [("left_out", count as f64), ("markers", all as f64)];
    (count > 0).then(|| Warning::new("wrong-markers", text, numbers))
}

pub(super) fn of_estimate(
    recorded: &PressRecording,
    options: &PressOptions,
    estimate: &PressEstimate,
    has_misfit: bool,
) -> impl Iterator<Item = Warning> {
    let depth = options.marker_depth.is_none().then_some(
        "the depth of the markers is not stated, so 0 is assumed, at the skin's surface: if the markers lie deeper, the curvature is wrong, and the readings may not show it (setting `depth`)",
    );
    let contact = (!estimate.is_detected).then_some(
        "the displacements alone show no contact: the interval contains all objects that are possible for the stated indentation at an unknown position on the markers",
    );
    let alone = estimate.only_marker.map(|marker| {
        format!(
            "only the marker of {} moved: it is wrong, or the object presses between the other markers",
            recorded.source.row(marker)
        )
    });
    let is_noise = options.normal_std.is_some() && !has_misfit;
    let unexplained = (estimate.r_squared < MIN_R_SQUARED && !is_noise).then(|| {
        let percent = 100.0 * estimate.r_squared.max(0.0);
        let text = format!(
            "the fit explains only {percent:.0} % of the variance of the normal displacements: they are noise, or not a press of this body"
        );
        Warning::new(
            "unexplained-readings",
            text,
            [("r_squared", estimate.r_squared)],
        )
    });
    let gaussian = matches!(options.estimator, PressEstimatorConfig::Gaussian { .. }).then_some(
        "a Gaussian is no elastic body: its intervals contain the noise alone, not the difference between a Gaussian and a skin",
    );
    let is_layer = matches!(options.estimator, PressEstimatorConfig::BondedLayer { .. });
    Warning::of("units", units(recorded, options))
        .into_iter()
        .chain(Warning::of("clipped", clipped(recorded)))
        .chain(Warning::of("unstated-depth", depth))
        .chain(Warning::of("unseen-contact", contact))
        .chain(recorded.source.notes.iter().cloned())
        .chain(Warning::of("lone-marker", alone))
        .chain(large_contact(estimate, options.radius(), is_layer))
        .chain(unexplained)
        .chain(Warning::of("gaussian-body", gaussian))
}

pub(super) fn large_contact(
    estimate: &PressEstimate,
    sensor_radius: f64,
    is_layer: bool,
) -> Option<Warning> {
    large_contact_warning(
        estimate.most_likely_curvature,
        estimate.contact_radius.value,
        sensor_radius,
        is_layer,
    )
}

/// If the fit explains less than this share of the variance of the normal displacements, there is a warning.
const MIN_R_SQUARED: f64 = 0.5;

/// Smallest normal displacement whose sign is checked, as a share of the largest displacement.
const MIN_SIGNED: f64 = 0.2;
/// A warning about the sign is shown if at least this share of the displacements whose sign is checked points outward.
const MIN_OUTWARD: f64 = 0.9;

/// Smallest accepted distance of the outermost marker from the apex, relative to the sensor's radius. If all markers
/// are nearer to the apex, there is a warning about units.
const MIN_EXTENT: f64 = 5e-3;
/// Smallest accepted normal displacement of the marker that is displaced most, relative to the sensor's radius or, on a
/// flat pad, to the width of the markers. If its displacement is smaller, there is a warning about units.
const MIN_DISPLACEMENT: f64 = 1e-4;

/// Smallest accepted ratio of the largest displacement along the skin to the largest normal displacement. A smaller
/// ratio causes a warning about units.
const MIN_TANGENTIAL: f64 = 2e-3;

/// Text about a likely mistake of sign or unit in the readings; `None` if there is none.
pub(super) fn units(recorded: &PressRecording, options: &PressOptions) -> Option<String> {
    let unit = recorded.unit.or(options.length_unit).unwrap_or_default();
    let (radius, unit) = (options.radius(), unit.as_str());
    let distances = recorded.places.iter().map(|[x, y]| libm::hypot(*x, *y));
    let extent = distances.fold(0.0, f64::max) * options.radial_scale;
    let sizes = recorded.normal.iter().map(|one| one.abs());
    let largest = sizes.fold(0.0, f64::max);
    let along = recorded.tangential.iter().flatten().flatten();
    let along = along.fold(0.0, |most: f64, one| most.max(one.abs()));
    let is_flat = radius == f64::INFINITY;
    let size = if is_flat { 2.0 * extent } else { radius };
    let [far, moved, sensor] = [extent, largest, size].map(Number::rounded);
    let what = ["the sensor's radius", "the width of the pad"][usize::from(is_flat)];
    let sensor = format!("{what}, {sensor} {unit}");
    let signed = recorded.normal.iter();
    let signed = signed.filter(|one| one.abs() > MIN_SIGNED * largest);
    let outward = signed.clone().filter(|one| **one < 0.0).count() as f64;
    let signed = signed.count() as f64;
    let has_baseline = options.estimator.priors().baseline == Baseline::Known;
    let text = match () {
        () if extent > std::f64::consts::PI * radius => format!(
            "a marker is {far} {unit} from the apex, which is more than half the circumference for {sensor}: do both have the same unit?"
        ),
        () if largest > radius => format!(
            "a marker is displaced by {moved} {unit}, more than {sensor}: do both have the same unit?"
        ),
        () if 0.0 < along && along < MIN_TANGENTIAL * largest => format!(
            "no marker is displaced along the skin by more than {}, much less than the normal displacements of up to {moved} {unit}: are they in m and the rest in mm?",
            Number::rounded(along)
        ),
        () if has_baseline && signed > 1.0 && outward >= MIN_OUTWARD * signed => {
            "the displacements point outward, but inward displacements must be positive: is the sign wrong?"
                .to_owned()
        }
        () if 0.0 < extent && extent < MIN_EXTENT * size => format!(
            "all markers lie within {far} {unit} of the apex, much less than {sensor}: are the readings in m and the radius in mm?"
        ),
        () if 0.0 < largest && largest < MIN_DISPLACEMENT * size => format!(
            "no marker is displaced by more than {moved} {unit}, much less than {sensor}: are the displacements in m and the rest in mm?"
        ),
        () => return None,
    };
    Some(text)
}

/// An offset that is common to all markers is reported if it exceeds this number of its standard errors.
const MIN_OFFSET: f64 = 5.0;

/// Text about an offset of all normal displacements, for readings that a fit without an offset does not explain. `None`
/// if a fit with an offset does not explain them either.
pub(super) fn common_offset(
    fit: &ForwardFit,
    reading: &Reading<'_>,
    unit: LengthUnit,
) -> Option<String> {
    let free = ForwardFit {
        baseline: Prior::Free,
        ..fit.clone()
    };
    let estimate = free.estimate(reading).ok()?;
    let offset = estimate.baseline?;
    let is_explained = free.misfits(reading, &estimate).ok()?.is_empty();
    let is_explained = is_explained && estimate.wrong_markers.is_empty();
    (is_explained && offset.value.abs() > MIN_OFFSET * offset.std).then(|| {
        format!(
            "the normal displacements have a common offset of {} {}; setting `baseline` fitted estimates it together with the curvature",
            Number::rounded(offset.value),
            unit.as_str()
        )
    })
}

/// Smallest number of markers with the same largest displacement that causes a warning.
const MIN_CLIPPED: usize = 4;

/// Text about several markers with exactly the largest displacement; `None` if the displacements are distinct, or if they
/// are rounded, so that smaller displacements are equal too.
fn clipped(recorded: &PressRecording) -> Option<String> {
    let mut normal = recorded.normal.clone();
    normal.sort_by(f64::total_cmp);
    let mut groups = normal.chunk_by(PartialEq::eq).rev();
    let largest = groups.next()?;
    let others = groups.take(3).map(<[f64]>::len).max()?;
    let (count, all, value) = (largest.len(), normal.len(), Number(largest[0]));
    (value.0 > 0.0 && count >= MIN_CLIPPED && count > 2 * others).then(|| {
        format!(
            "{count} of {all} markers have exactly the largest normal displacement, {value}: does the sensor measure no larger ones? If so, leave these markers out of the file"
        )
    })
}

/// A warning is shown if swapped columns or reversed signs decrease the mean square residual of the fit by more than
/// this factor.
const MIN_IMPROVEMENT: f64 = 4.0;
/// Largest accepted standard deviation of the noise of displacements along the skin, relative to the largest of these
/// displacements. If the estimated noise is larger, or if there are misfits, the columns are checked for mistakes.
const MAX_NOISE: f64 = 0.2;

/// Function that swaps the components of a displacement along the skin, or changes their signs.
type Change = fn([f64; 2]) -> [f64; 2];

/// Text about a likely mistake in the displacements along the skin: swapped columns or a wrong sign. The displacements
/// are checked only if the fit has misfits or large residuals. `None` if no mistake is likely.
pub(super) fn swapped_columns(
    fit: &ForwardFit,
    reading: &Reading<'_>,
    estimate: &PressEstimate,
    misfits: &[Misfit],
) -> Option<String> {
    let along = reading.tangential?;
    let most = along.iter().flatten().map(|one| one.abs());
    if misfits.is_empty() && estimate.tangential_std? <= MAX_NOISE * most.fold(0.0, f64::max) {
        return None;
    }
    let is_found = fit.tangential_std.is_none_or(|std| std <= 0.0);
    let misfit = |estimate: &PressEstimate| match estimate.tangential_std {
        Some(std) if is_found => std * std,
        _ => estimate.reduced_chi_squared,
    };
    let changed = |(name, change): (&'static str, Change)| {
        let along: Vec<[f64; 2]> = along.iter().map(|along| change(*along)).collect();
        let tangential = Some(along.as_slice());
        let changed = Reading {
            tangential,
            ..*reading
        };
        let estimate = fit.estimate(&changed).ok()?;
        Some((misfit(&estimate), name))
    };
    let changes: [(&str, Change); 4] = [
        ("tangential_x and tangential_y swapped", |[x, y]| [y, x]),
        ("the sign of tangential_x reversed", |[x, y]| [-x, y]),
        ("the sign of tangential_y reversed", |[x, y]| [x, -y]),
        ("both signs reversed", |[x, y]| [-x, -y]),
    ];
    let all = changes.into_iter().filter_map(changed);
    let (least, name) = all.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    let ratio = misfit(estimate) / least;
    (ratio > MIN_IMPROVEMENT && ratio.is_finite()).then(|| {
        let times = Number::rounded(ratio.sqrt());
        format!(
            "the displacements along the skin contradict the normal displacements; they would fit {times} times better with {name}: are columns swapped, or is a sign wrong?"
        )
    })
}
