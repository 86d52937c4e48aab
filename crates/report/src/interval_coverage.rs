//! Coverage of the intervals that each estimator reports. Coverage is the share of the intervals that contain the true
//! value.

use crate::records::by_key;
use crate::{Study, Table};
use palpate_study::Statistic;

/// The statistics `coverage50`, `coverage80` and `coverage95` of `cells.csv`, each with the nominal probability of its
/// intervals.
pub(crate) const STATED: [(Statistic, f64); 3] = [
    (Statistic::Coverage50, 0.50),
    (Statistic::Coverage80, 0.80),
    (Statistic::Coverage95, 0.95),
];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Estimator {
    /// Text that names the kind of the scene, the kind of the estimator and the kind of the sensor.
    pub(crate) name: String,
    /// For each study with intervals of this estimator: the index of the study, and the coverage in each row of its
    /// table.
    pub(crate) studies: Vec<(usize, Vec<Coverage>)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Coverage {
    pub(crate) row: usize,
    /// Shares of the 50 %, 80 % and 95 % intervals that contain the true value.
    pub(crate) shares: [f64; 3],
}

impl Estimator {
    /// All estimators for which the studies contain intervals, in the order of the studies. Cells with fewer than two
    /// successful trials are left out.
    pub(crate) fn all(studies: &[Study]) -> Vec<Self> {
        let of_study = |(place, study): (usize, &Study)| {
            let rows = 0..study.cells().rows();
            let measured =
                rows.filter_map(|row| Some((name(study, row)?, measured(study.cells(), row)?)));
            let estimators = by_key(measured).into_iter();
            estimators
                .map(|(name, rows)| (name, (place, rows)))
                .collect::<Vec<_>>()
        };
        let each = studies.iter().enumerate().flat_map(of_study);
        by_key(each)
            .into_iter()
            .map(|(name, studies)| Self { name, studies })
            .collect()
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = &Coverage> {
        self.studies.iter().flat_map(|(_, rows)| rows)
    }
}

fn measured(table: &Table, row: usize) -> Option<Coverage> {
    let of = |statistic: Statistic| table.statistic(row, statistic.name());
    let successes = of(Statistic::Trials)? - of(Statistic::Failures)?;
    let [narrowest, narrow, wide] = STATED.map(|(statistic, _)| of(statistic));
    let shares = [narrowest?, narrow?, wide?];
    (successes >= 2.0).then_some(Coverage { row, shares })
}

/// Kinds of the scene, the estimator and the sensor of the table row `row`, as text. An estimator or sensor whose kind
/// the study does not state is left out. `None` if the kind of the scene is not stated.
fn name(study: &Study, row: usize) -> Option<String> {
    let scene = study.text(row, "scene.kind")?;
    let others = ["scene.estimator", "scene.sensor"].into_iter();
    let others: Vec<&str> = others.filter_map(|path| kind(study, row, path)).collect();
    Some(format!("{scene}: {}", others.join(", ")))
}

/// The `kind` of the part of the scene at `path`, such as `scene.sensor`, for the table row `row`. If the study states
/// no kind, but sweeps this part as a whole, the label of the part in this row is returned. `None` if the study states
/// neither a kind nor a label.
fn kind<'a>(study: &'a Study, row: usize, path: &str) -> Option<&'a str> {
    let kind = study.text(row, &format!("{path}.kind"));
    kind.or_else(|| study.text(row, path))
}

/// Means of the coverages of the 50 %, 80 % and 95 % intervals over the table rows `rows`.
pub(crate) fn mean_shares<'a>(rows: impl Iterator<Item = &'a Coverage> + Clone) -> [f64; 3] {
    let count = rows.clone().count().max(1) as f64;
    [0, 1, 2].map(|at| rows.clone().map(|row| row.shares[at]).sum::<f64>() / count)
}
