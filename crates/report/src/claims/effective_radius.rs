//! Claim 16: the effective radius as the sensor is pressed in (2020 paper, section IV.B, Fig. 8c).

use super::evidence::{near, percent, range, short, span};
use super::finding::Finding;
use super::presses::{at_indentation, kind, label, millimetres, number, rows_of};
use crate::Study;

/// The paper's effective radii in mm: a dish of 80 mm, a plane and a ball of 80 mm on a sensor of 20 mm.
const RADII: [f64; 3] = [26.7, 20.0, 16.0];
/// A true radius is one of these if it agrees to this share: the paper rounds.
const ROUNDED: f64 = 0.01;
/// Indentations in mm: where the paper stops, and below which it says that noise dominates.
const DEEPEST: f64 = 1.4;
const SHALLOW: f64 = 1.0;
/// Converged is a median within this share of the truth: the paper's own, 31.4, 22.0 and 15.4 mm, are up to 18 % off.
const CONVERGED: f64 = 0.2;
/// Noise that dominates scatters the estimates by at least this factor more than at the deepest.
const SCATTERED: f64 = 1.5;

/// Claim 16.
pub(super) fn converges(study: &Study) -> Result<Finding, String> {
    // Not the chain through a camera, whose body is another.
    let direct = |row: usize| matches!(kind(study, row, "scene.sensor"), None | Some("direct"));
    let of_paper = |row: usize| {
        let estimator = "scene.estimator";
        let c = number(study, row, estimator, "c");
        let is_gaussian = kind(study, row, estimator) == Some("gaussian");
        direct(row) && is_gaussian && c.is_some_and(|c| near(c, 1.0))
    };
    let found = courses(study, &of_paper)
        .map_err(|missing| format!("of the gaussian with c = 1, {missing}"))?;
    let fit = courses(study, &|row| {
        direct(row) && kind(study, row, "scene.estimator") == Some("half-space")
    });
    let fit = fit.map_or(String::new(), |fit| {
        format!(" The half-space fit: {}.", told(&fit))
    });
    let chains = chains(study, &|row| !direct(row));
    Ok(Finding {
        holds: found
            .iter()
            .all(|course| course.converges() && course.starts_in_noise()),
        measured: format!("The gaussian with c = 1: {}.{fit}{chains}", told(&found)),
        why: format!(
            "Holds if at {DEEPEST} mm every median is within {} of the true radius (the paper's own estimates are 18, 10 and 4 % off), and at every indentation below {SHALLOW} mm the scatter, half the width from the 5 % to the 95 % quantile, exceeds the median's error and is at least {SCATTERED} × that at {DEEPEST} mm. A cell without any estimate counts as scattered.",
            percent(CONVERGED)
        ),
    })
}

/// The estimates of one effective radius by one estimator.
struct Course {
    truth: f64,
    /// Estimates at indentations below [`SHALLOW`]; none where no trial gave one.
    shallow: Vec<Option<Estimates>>,
    deepest: Estimates,
}

/// Many estimates: their median in mm, its error and their scatter as shares of the truth, and the share of trials
/// that gave none.
#[derive(Clone, Copy)]
struct Estimates {
    median: f64,
    error: f64,
    scatter: f64,
    failed: f64,
}

impl Course {
    fn converges(&self) -> bool {
        self.deepest.error <= CONVERGED
    }

    fn starts_in_noise(&self) -> bool {
        self.shallow.iter().all(|estimates| {
            estimates.is_none_or(|one| {
                one.scatter > one.error && one.scatter >= SCATTERED * self.deepest.scatter
            })
        })
    }
}

/// Estimates of each of the paper's radii over the indentation, from the rows that `chosen` accepts; an error says what
/// the table lacks.
fn courses(study: &Study, chosen: &dyn Fn(usize) -> bool) -> Result<Vec<Course>, String> {
    let unit = millimetres(study).ok_or("the length unit is not known in millimetres")?;
    let rows: Vec<usize> = rows_of(study, "effective_radius")
        .into_iter()
        .filter(|row| chosen(*row))
        .collect();
    RADII
        .iter()
        .map(|radius| course(study, &rows, *radius, unit))
        .collect()
}

fn course(study: &Study, rows: &[usize], radius: f64, unit: f64) -> Result<Course, String> {
    let table = study.cells();
    let truth_of = |row: usize| Some(unit * table.statistic(row, "truth")?);
    let is_it = |truth: f64| (truth - radius).abs() <= ROUNDED * radius;
    let rows: Vec<usize> = rows
        .iter()
        .copied()
        .filter(|row| truth_of(*row).is_some_and(is_it))
        .collect();
    let truth = rows.first().and_then(|row| truth_of(*row));
    let truth = truth.ok_or_else(|| format!("the table has no effective radius of {radius} mm"))?;
    let estimates = |row: usize| {
        let quantile = |name: &str| Some(unit * table.statistic(row, name)?);
        let (low, median, high) = (quantile("q05")?, quantile("q50")?, quantile("q95")?);
        let (failures, trials) = (
            table.statistic(row, "failures")?,
            table.statistic(row, "trials")?,
        );
        Some(Estimates {
            median,
            error: (median - truth).abs() / truth,
            scatter: (high - low) / (2.0 * truth),
            failed: failures / trials.max(1.0),
        })
    };
    let mut depths: Vec<f64> = rows
        .iter()
        .filter_map(|row| study.number(*row, "scene.motion.indentation"))
        .filter(|depth| depth * unit < SHALLOW * (1.0 - 1e-9))
        .collect();
    depths.sort_by(f64::total_cmp);
    depths.dedup_by(|a, b| near(*a, *b));
    if depths.is_empty() {
        return Err(format!(
            "the table has no indentation below {SHALLOW} mm for {radius} mm"
        ));
    }
    let shallow = depths
        .iter()
        .map(|depth| Ok(estimates(at_indentation(study, &rows, *depth)?)))
        .collect::<Result<_, String>>()?;
    let deepest = estimates(at_indentation(study, &rows, DEEPEST / unit)?)
        .ok_or_else(|| format!("{radius} mm has no quantiles at {DEEPEST} mm"))?;
    Ok(Course {
        truth,
        shallow,
        deepest,
    })
}

/// The estimates of the chains through a camera, by the label of their estimator; those that end in numbers.
fn chains(study: &Study, seen: &dyn Fn(usize) -> bool) -> String {
    let mut labels: Vec<&str> = Vec::new();
    for row in rows_of(study, "effective_radius") {
        let label = label(study, row, "scene.estimator");
        labels.extend(label.filter(|label| seen(row) && !labels.contains(label)));
    }
    let told = labels.into_iter().filter_map(|chain| {
        let its = |row: usize| seen(row) && label(study, row, "scene.estimator") == Some(chain);
        let ends = courses(study, &its).ok()?;
        let ends = ends.iter().map(|course| {
            let Estimates { median, error, .. } = course.deepest;
            format!("{} ({} off)", short(median), percent(error))
        });
        let ends = ends.collect::<Vec<_>>().join(", ");
        Some(format!(" By {chain}: {ends} mm at {DEEPEST} mm."))
    });
    told.collect()
}

/// Words for the estimates at the deepest press and for their scatter before it.
fn told(courses: &[Course]) -> String {
    let ends = courses.iter().map(|course| {
        let Estimates { median, error, .. } = course.deepest;
        format!(
            "{} mm for {} ({} off)",
            short(median),
            short(course.truth),
            percent(error)
        )
    });
    let ends = ends.collect::<Vec<_>>().join(", ");
    let shallow = || courses.iter().flat_map(|course| &course.shallow);
    let known = || shallow().flatten();
    let scatter = range(known().map(|one| one.scatter));
    let scatter = scatter.map_or("nothing".to_owned(), |range| span(range, percent));
    let deepest = range(courses.iter().map(|course| course.deepest.scatter));
    let deepest = deepest.map_or(String::new(), |range| span(range, percent));
    let beyond = known().filter(|one| one.scatter > one.error).count();
    let failed = match range(known().map(|one| one.failed)) {
        Some((_, most)) if most > 0.0 => format!(" (up to {} of the trials fail)", percent(most)),
        _ => String::new(),
    };
    let without = match shallow().count() - known().count() {
        0 => String::new(),
        cells => format!("; {cells} cells there give no estimate"),
    };
    format!(
        "medians at {DEEPEST} mm {ends}; scatter {scatter} below {SHALLOW} mm{failed}, where it exceeds the median's error in {beyond} of {} cells, and {deepest} at {DEEPEST} mm{without}",
        known().count()
    )
}
