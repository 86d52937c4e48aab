//! Finding the rows and numbers that a claim is about.

use crate::Study;
use crate::group::by_key;
use palpate_study::number;

/// Rows of `quantity` whose true value is defined and positive: convex along the direction in question.
pub(super) fn convex_rows(study: &Study, quantity: &str) -> Result<Vec<usize>, String> {
    let table = study.cells();
    let rows: Vec<usize> = (0..table.rows())
        .filter(|row| table.quantity(*row) == quantity)
        .filter(|row| {
            table
                .statistic(*row, "truth")
                .is_some_and(|truth| truth > 0.0)
        })
        .collect();
    if rows.is_empty() {
        Err(format!("the table has no {quantity} of a convex object"))
    } else {
        Ok(rows)
    }
}

/// The number at `path` in every one of `rows`, or what is missing.
pub(super) fn numbers(study: &Study, rows: &[usize], path: &str) -> Result<Vec<f64>, String> {
    rows.iter()
        .map(|row| {
            study
                .number(*row, path)
                .ok_or_else(|| format!("no number for {path} in the table or the config"))
        })
        .collect()
}

/// Rows that agree in every swept path except those that begin with one of `free`.
pub(super) fn groups(study: &Study, rows: &[usize], free: &[&str]) -> Vec<Vec<usize>> {
    let fixed: Vec<_> = study
        .cells()
        .axes()
        .iter()
        .filter(|axis| !free.iter().any(|prefix| axis.header.starts_with(prefix)))
        .collect();
    let key = |row: &usize| fixed.iter().map(|axis| axis.text(*row)).collect::<Vec<_>>();
    let groups = by_key(rows.iter().map(|row| (key(row), *row)));
    groups.into_iter().map(|(_, rows)| rows).collect()
}

/// The angle of a roll in rad, as it is given: by rate and duration, by itself, or by the length of its arc on the probe,
/// which turns the contact by the arc over both radii.
pub(super) fn roll_angle(study: &Study, row: usize) -> Option<f64> {
    let number = |path: &str| study.number(row, path);
    if let (Some(rate), Some(duration)) = (
        number("scene.motion.rate_rad_per_s"),
        number("scene.motion.duration_s"),
    ) {
        return Some(rate * duration);
    }
    if let Some(angle) = number("scene.motion.angle_deg") {
        return Some(angle.to_radians());
    }
    let curvature =
        number("scene.probe.radius")?.recip() + study.cells().statistic(row, "truth")?;
    Some(number("scene.motion.arc_length")? * curvature)
}

/// Whether numbers are equal up to what a decimal text loses.
pub(super) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

/// A share as percent in three digits.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A number in three digits.
pub(super) fn short(value: f64) -> String {
    number::significant(value, 3)
}

/// The smallest and largest of some numbers.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((value.min(low), value.max(high))),
    })
}

/// `low to high`, or the one value if they show the same, each as `show` writes it.
pub(super) fn span((low, high): (f64, f64), show: fn(f64) -> String) -> String {
    let (low, high) = (show(low), show(high));
    if low == high {
        low
    } else {
        format!("{low} to {high}")
    }
}

/// Geometric mean of positive numbers; `None` without numbers.
pub(super) fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| libm::log(*value)).sum();
    (!values.is_empty()).then(|| libm::exp(sum / values.len() as f64))
}
