//! A row of a study's `cells.csv`, with functions that compute numbers for claims from it.

use crate::Study;
use crate::records::by_key;

#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub(super) study: &'a Study,
    at: usize,
}

impl<'a> Row<'a> {
    pub(super) fn all(study: &'a Study) -> impl Iterator<Item = Self> {
        (0..study.cells().rows()).map(move |at| Self { study, at })
    }

    pub(super) fn quantity(&self) -> &'a str {
        self.study.cells().quantity(self.at)
    }

    pub(super) fn statistic(&self, name: &str) -> Option<f64> {
        self.study.cells().statistic(self.at, name)
    }

    pub(super) fn number(&self, path: &str) -> Option<f64> {
        self.study.number(self.at, path)
    }

    pub(super) fn text(&self, path: &str) -> Option<&'a str> {
        self.study.text(self.at, path)
    }

    /// Label of the part of the scene at `path`, such as `scene.object`; the part's `kind` if it has no label.
    pub(super) fn label(&self, path: &str) -> &'a str {
        let kind = || self.text(&format!("{path}.kind"));
        self.text(path).or_else(kind).unwrap_or_default()
    }

    /// Texts of the swept values at these paths, separated by commas. Paths that are not swept are left out.
    pub(super) fn swept(&self, paths: &[&str]) -> String {
        let axes = paths
            .iter()
            .filter_map(|path| self.study.cells().axis(path));
        let texts: Vec<&str> = axes.map(|axis| axis.text(self.at)).collect();
        texts.join(", ")
    }

    /// The table row of another quantity in the same cell (grid point); `None` if there is none.
    pub(super) fn of(&self, quantity: &str) -> Option<Self> {
        let table = self.study.cells();
        let is_cell = |at: &usize| table.cell(*at) == table.cell(self.at);
        let before = (0..self.at).rev().take_while(is_cell);
        let after = (self.at..table.rows()).take_while(is_cell);
        let mut cell = before.chain(after).map(|at| Self { at, ..*self });
        cell.find(|row| row.quantity() == quantity)
    }

    /// Share of failed trials in the row's cell (grid point). Only the kinds of failure that `is_it` accepts are
    /// counted. `None` if the cell has no trials.
    pub(super) fn failed(&self, is_it: impl Fn(&str) -> bool) -> Option<f64> {
        let trials = self.statistic("trials").filter(|trials| *trials > 0.0)?;
        let cell = self.study.cells().cell(self.at);
        let failures = self.study.failures().iter();
        let counts = failures.filter(|failure| failure.cell == cell && is_it(&failure.kind));
        Some(counts.map(|failure| failure.count as f64).sum::<f64>() / trials)
    }

    /// Factor from the study's unit of length to millimetres; `None` if this unit is not metric.
    pub(super) fn millimetres(&self) -> Option<f64> {
        match self.study.setting("length_unit")?.as_str()? {
            "m" => Some(1000.0),
            "cm" => Some(10.0),
            "mm" => Some(1.0),
            "um" => Some(0.001),
            _ => None,
        }
    }
}

/// Groups of table rows. The rows of a group differ only in swept fields whose paths begin with one of the texts in
/// `free`.
pub(super) fn groups<'a>(rows: &[Row<'a>], free: &[&str]) -> Vec<Vec<Row<'a>>> {
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    let axes = first.study.cells().axes().iter();
    let is_free = |header: &str| free.iter().any(|prefix| header.starts_with(prefix));
    let fixed: Vec<_> = axes.filter(|axis| !is_free(&axis.header)).collect();
    let key = |row: &Row<'_>| {
        fixed
            .iter()
            .map(|axis| axis.text(row.at))
            .collect::<Vec<_>>()
    };
    let groups = by_key(rows.iter().map(|row| (key(row), *row)));
    groups.into_iter().map(|(_, rows)| rows).collect()
}

/// The pairs (`x(row)`, `y(row)`) of the table rows `rows`, sorted by x. Rows without x or y are left out.
pub(super) fn sorted(
    rows: &[Row<'_>],
    x: impl Fn(&Row<'_>) -> Option<f64>,
    y: impl Fn(&Row<'_>) -> Option<f64>,
) -> Vec<(f64, f64)> {
    let pairs = rows.iter().filter_map(|row| Some((x(row)?, y(row)?)));
    let mut pairs: Vec<(f64, f64)> = pairs.collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs
}

pub(super) fn probe_radius(row: &Row<'_>) -> Option<f64> {
    row.number("scene.probe.radius")
}

/// Radius of the object divided by the radius of the probe. The inverse of this ratio is the relative curvature, RCR in
/// the 1996 paper.
pub(super) fn size(row: &Row<'_>) -> Option<f64> {
    Some(1.0 / (row.statistic("truth")? * probe_radius(row)?))
}

/// Roll angle in rad. If the config states the rate of rotation and the duration, it is their product; if the config
/// states an angle, it is this angle. Otherwise, it is s (1/R₁ + 1/R₂) with the arc length s on the probe, the probe's
/// radius R₁ and the object's radius R₂. `None` if the row lacks these numbers.
pub(super) fn roll_angle(row: &Row<'_>) -> Option<f64> {
    let number = |path: &str| row.number(path);
    if let (Some(rate), Some(duration)) = (
        number("scene.motion.rate_rad_per_s"),
        number("scene.motion.duration_s"),
    ) {
        return Some(rate * duration);
    }
    if let Some(angle) = number("scene.motion.angle_deg") {
        return Some(angle.to_radians());
    }
    let curvature = probe_radius(row)?.recip() + row.statistic("truth")?;
    Some(number("scene.motion.arc_length")? * curvature)
}
