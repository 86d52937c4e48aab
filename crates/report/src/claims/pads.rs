//! Claims 5 to 8: the resolution of the contact sensor (1996 paper, section 4.1.3). Lengths are in
//! probe radii, as the paper's probe has R₁ = 1 cm.

use super::evidence::{
    convex_rows, groups, near, numbers, percent, range, roll_angle, short, span,
};
use super::finding::Finding;
use crate::Study;

const QUANTITY: &str = "normal_curvature_u";

/// A trend "grows" if it does so in at least this share of the comparisons.
const MOST: f64 = 0.9;
/// "Many cases": at least this share.
const MANY: f64 = 0.5;
/// Claim 6 is about R₂ from here up and pads coarser than this.
const LARGE: f64 = 5.0;
const COARSER: f64 = 0.01;
/// An estimate is exactly zero if it is below this times the probe's curvature.
const ZERO: f64 = 1e-12;
/// Claim 8 is about pads of this pitch, a roll of this angle, spheres of these radii, …
const HALF_MILLIMETRE: f64 = 0.05;
const HALF_RADIAN: f64 = 0.5;
const SPHERES: (f64, f64) = (0.2, 5.0);
/// … and "reasonable" is an error of at most this, itself included (to rounding).
const REASONABLE: f64 = 0.25;
/// An error this close to that limit, as a share of it, sits on it.
const ON_THE_LIMIT: f64 = 0.01;

/// Row of a pad study.
#[derive(Clone, Copy)]
struct Sample {
    row: usize,
    /// R₂/R₁.
    size: f64,
    /// Pitch over R₁.
    pitch: f64,
    /// Angle of the roll in rad.
    roll: f64,
    random: bool,
    /// Failed trials are part of what a coarse sensor delivers: an average without them flatters it.
    complete: bool,
    error: Option<f64>,
    /// |mean estimate| × R₁.
    estimate: Option<f64>,
}

fn samples(study: &Study) -> Result<Vec<Sample>, String> {
    let rows = convex_rows(study, QUANTITY)?;
    let radius = numbers(study, &rows, "scene.probe.radius")?;
    let pitch = numbers(study, &rows, "scene.sensor.pitch")?;
    let sample = |(at, &row): (usize, &usize)| {
        let statistic = |name: &str| study.cells().statistic(row, name);
        Ok(Sample {
            row,
            size: 1.0 / (statistic("truth").ok_or("a true curvature is undefined")? * radius[at]),
            pitch: pitch[at] / radius[at],
            roll: roll_angle(study, row)
                .ok_or("the table and the config do not tell the length of the rolls")?,
            random: study.text(row, "scene.sensor.offset") == Some("random"),
            complete: statistic("failures") == Some(0.0),
            error: statistic("relative_rms_error"),
            estimate: statistic("mean").map(|mean| mean.abs() * radius[at]),
        })
    };
    rows.iter().enumerate().map(sample).collect()
}

/// Random offsets, whose error is a statistic; all samples if none is random.
fn statistical(samples: Vec<Sample>) -> (Vec<Sample>, &'static str) {
    if samples.iter().any(|s| s.random) {
        (
            samples.into_iter().filter(|s| s.random).collect(),
            "random offsets",
        )
    } else {
        (samples, "centred pads")
    }
}

/// Compares neighbours within groups that agree but for the axes under `free`, in order of `key`, where both
/// errors are of all trials: (comparisons, of which the error grows). Two equal errors say nothing.
fn trend(
    study: &Study,
    samples: &[Sample],
    free: &[&str],
    key: fn(&Sample) -> f64,
) -> (usize, usize) {
    let (mut pairs, mut growing) = (0, 0);
    for rows in groups(
        study,
        &samples.iter().map(|s| s.row).collect::<Vec<_>>(),
        free,
    ) {
        let mut group: Vec<(f64, f64)> = samples
            .iter()
            .filter(|s| rows.contains(&s.row) && s.complete)
            .filter_map(|s| Some((key(s), s.error?)))
            .collect();
        group.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in group.windows(2) {
            if !near(pair[0].0, pair[1].0) && !near(pair[0].1, pair[1].1) {
                pairs += 1;
                growing += usize::from(pair[1].1 > pair[0].1);
            }
        }
    }
    (pairs, growing)
}

fn mostly((pairs, growing): (usize, usize)) -> bool {
    growing as f64 >= MOST * pairs as f64
}

/// Claim 5.
pub(super) fn error_grows_with_pitch(study: &Study) -> Result<Finding, String> {
    let (samples, which) = statistical(samples(study)?);
    let with_pitch = trend(study, &samples, &["scene.sensor.pitch"], |s| s.pitch);
    let part = |keep: fn(f64) -> bool| {
        samples
            .iter()
            .copied()
            .filter(|s| keep(s.size))
            .collect::<Vec<_>>()
    };
    let flatter = trend(
        study,
        &part(|size| size >= 1.0 - 1e-9),
        &["scene.object"],
        |s| s.size,
    );
    let sharper = trend(
        study,
        &part(|size| size <= 1.0 + 1e-9),
        &["scene.object"],
        |s| -s.size,
    );
    if with_pitch.0 == 0 || flatter.0 == 0 {
        return Err("no two pitches, or no two radii from R₁ up, to compare".to_owned());
    }
    let of = |(pairs, growing): (usize, usize)| format!("{growing} of {pairs}");
    let below = if sharper.0 == 0 {
        String::new()
    } else {
        format!(
            " Below R₁ it grows again as the object gets sharper, in {} steps: the contact then moves less.",
            of(sharper)
        )
    };
    Ok(Finding {
        holds: mostly(with_pitch) && mostly(flatter),
        measured: format!(
            "With {which} the rms relative error grows in {} steps to coarser pads, and in {} steps to a larger R₂ from R₁ up.{below}",
            of(with_pitch),
            of(flatter),
        ),
        why: format!(
            "Holds if each of the first two is at least {}; steps compare cells without failed trials, equal errors left out.",
            percent(MOST)
        ),
    })
}

/// Claim 6.
pub(super) fn zeros(study: &Study) -> Result<Finding, String> {
    let cells: Vec<Sample> = samples(study)?
        .into_iter()
        .filter(|s| !s.random && s.size >= LARGE * (1.0 - 1e-9) && s.pitch > COARSER * (1.0 + 1e-9))
        .filter(|s| s.estimate.is_some())
        .collect();
    if cells.is_empty() {
        return Err(format!(
            "no centred pads coarser than {COARSER} R₁ on a sphere of {LARGE} R₁ or more"
        ));
    }
    let zero = |s: &&Sample| s.estimate.is_some_and(|estimate| estimate <= ZERO);
    let zeros = cells.iter().filter(zero).count();
    let smallest = range(cells.iter().map(|s| s.size)).map_or(LARGE, |r| r.0);
    let at_smallest: Vec<&Sample> = cells.iter().filter(|s| near(s.size, smallest)).collect();
    let there = at_smallest.iter().filter(|s| zero(s)).count();
    Ok(Finding {
        holds: zeros as f64 >= MANY * cells.len() as f64,
        measured: format!(
            "From a pad's centre {zeros} of {} cells with R₂ ≥ {LARGE} R₁ and pads coarser than {COARSER} R₁ give exactly zero; {there} of {} at R₂ = {} R₁.",
            cells.len(),
            at_smallest.len(),
            short(smallest),
        ),
        why: format!(
            "Holds if at least {} of those cells are zero (|curvature| ≤ 10⁻¹² / R₁).",
            percent(MANY)
        ),
    })
}

/// Claim 7.
pub(super) fn longer_rolls_help(study: &Study) -> Result<Finding, String> {
    let (samples, which) = statistical(samples(study)?);
    let steps = trend(study, &samples, &["scene.motion"], |s| -s.roll);
    // Shortest against longest, by object and pads. A roll by a whole number of pads is read exactly from any start, which
    // leaves nothing to reduce.
    let (mut exact, mut ratios) = (0, Vec::new());
    for rows in groups(
        study,
        &samples.iter().map(|s| s.row).collect::<Vec<_>>(),
        &["scene.motion"],
    ) {
        let known = samples
            .iter()
            .filter(|s| rows.contains(&s.row) && s.complete);
        let mut group: Vec<(f64, f64)> = known.filter_map(|s| Some((s.roll, s.error?))).collect();
        group.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let [first, .., last] = group.as_slice()
            && !near(first.0, last.0)
            && !near(first.1, last.1)
        {
            match first.1 > 0.0 {
                true => ratios.push(last.1 / first.1),
                false => exact += 1,
            }
        }
    }
    let helped = ratios.iter().filter(|ratio| **ratio < 1.0).count();
    let (Some(range), true) = (range(ratios.iter().copied()), steps.0 > 0) else {
        return Err("no two lengths of roll to compare".to_owned());
    };
    let rolls = super::evidence::range(samples.iter().map(|s| s.roll))
        .map_or(String::new(), |r| span(r, short));
    let exact = match exact {
        0 => String::new(),
        n => format!(
            " ({n} more begin with a roll by a whole number of pads, which is read exactly)"
        ),
    };
    Ok(Finding {
        holds: helped as f64 >= MOST * ratios.len() as f64,
        measured: format!(
            "With {which}, from the shortest to the longest roll ({rolls} rad) the rms error falls in {helped} of {} combinations of radius and pitch, to {} × its value{exact}; it rises in {} of {} single steps.",
            ratios.len(),
            span(range, short),
            steps.0 - steps.1,
            steps.0,
        ),
        why: format!(
            "Holds if it falls in at least {} of the combinations; cells with failed trials are left out.",
            percent(MOST)
        ),
    })
}

/// Claim 8.
pub(super) fn half_millimetre_pads(study: &Study) -> Result<Finding, String> {
    let cells: Vec<Sample> = samples(study)?
        .into_iter()
        .filter(|s| near(s.pitch, HALF_MILLIMETRE) && near(s.roll, HALF_RADIAN))
        .filter(|s| s.size >= SPHERES.0 * (1.0 - 1e-9) && s.size <= SPHERES.1 * (1.0 + 1e-9))
        .collect();
    let mut sizes: Vec<f64> = cells.iter().map(|s| s.size).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes.dedup_by(|a, b| near(*a, *b));
    let ends = [SPHERES.0, SPHERES.1]
        .iter()
        .all(|end| sizes.iter().any(|size| near(*size, *end)));
    if !ends {
        return Err(format!(
            "no pads of {HALF_MILLIMETRE} R₁ rolled by {HALF_RADIAN} rad on spheres of both {} and {} R₁",
            SPHERES.0, SPHERES.1
        ));
    }
    let (mut parts, mut reasonable, mut on_limit) = (Vec::new(), true, Vec::new());
    for (random, which) in [(false, "centred"), (true, "random offsets")] {
        let mut list = Vec::new();
        for size in &sizes {
            let here = cells
                .iter()
                .filter(|s| s.random == random && near(s.size, *size));
            for cell in here {
                let good = cell
                    .error
                    .is_some_and(|error| error <= REASONABLE * (1.0 + 1e-9));
                reasonable &= good && cell.complete;
                let unresolved = if cell.complete {
                    ""
                } else {
                    ", with failed trials"
                };
                if let Some(error) = cell.error
                    && (error / REASONABLE - 1.0).abs() <= ON_THE_LIMIT
                {
                    on_limit.push(format!("{which}, R₂ = {} R₁", short(*size)));
                }
                let error = cell.error.map_or("no estimate".to_owned(), percent);
                list.push(format!("{error}{unresolved} (R₂ = {} R₁)", short(*size)));
            }
        }
        if !list.is_empty() {
            list.dedup();
            parts.push(format!("{which}: {}", list.join(", ")));
        }
    }
    Ok(Finding {
        holds: reasonable,
        measured: format!("Rms relative error, {}.", parts.join("; ")),
        why: format!(
            "Holds if every error is at most {} (exactly that still counts), without failed trials.{}",
            percent(REASONABLE),
            if on_limit.is_empty() {
                String::new()
            } else {
                on_limit.dedup();
                format!(
                    " The verdict is a close one: within {} of that limit lies {}.",
                    percent(ON_THE_LIMIT),
                    on_limit.join("; ")
                )
            }
        ),
    })
}
