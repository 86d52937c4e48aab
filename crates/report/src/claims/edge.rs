//! Claim 20: what a sharp object leaves (1996 paper, section 4.1.4).

use super::evidence::{convex_rows, near, numbers, short};
use super::finding::Finding;
use crate::Study;
use palpate_study::number;

/// Claim 20.
pub(super) fn is_a_bound(study: &Study) -> Result<Finding, String> {
    let table = study.cells();
    let rows = convex_rows(study, "normal_curvature_u")?;
    let radius = numbers(study, &rows, "scene.probe.radius")?;
    /// Cells of one radius.
    #[derive(Default)]
    struct Group {
        size: f64,
        trials: u64,
        unresolved: u64,
        cells: usize,
        wholly: usize,
    }
    let mut groups: Vec<Group> = Vec::new();
    for (&row, radius) in rows.iter().zip(radius) {
        let (Some(truth), Some(trials)) = (
            table.statistic(row, "truth"),
            table.statistic(row, "trials"),
        ) else {
            continue;
        };
        let size = 1.0 / (truth * radius);
        let of_cell = study
            .failures()
            .iter()
            .filter(|f| f.cell == table.cell(row) && f.kind.starts_with("unresolved"));
        let unresolved: u64 = of_cell.map(|f| f.count).sum();
        let at = groups
            .iter()
            .position(|g| near(g.size, size))
            .unwrap_or_else(|| {
                groups.push(Group {
                    size,
                    ..Group::default()
                });
                groups.len() - 1
            });
        groups[at].trials += trials as u64;
        groups[at].unresolved += unresolved;
        groups[at].cells += 1;
        groups[at].wholly += usize::from(trials > 0.0 && unresolved >= trials as u64);
    }
    groups.sort_by(|a, b| a.size.total_cmp(&b.size));
    let [sharpest, .., flattest] = groups.as_slice() else {
        return Err("the table has one radius only".to_owned());
    };
    let share = |g: &Group| g.unresolved as f64 / g.trials.max(1) as f64;
    let most = groups.iter().all(|g| share(g) <= share(sharpest));
    let told = |g: &Group| {
        format!(
            "at R₂ = {} R₁ {} of {} trials are unresolved (every trial of {} of {} cells)",
            short(g.size),
            number::grouped(g.unresolved),
            number::grouped(g.trials),
            g.wholly,
            g.cells
        )
    };
    Ok(Finding {
        holds: sharpest.wholly > 0 && most,
        measured: format!("A contact that stays on its pad leaves a bound on the radius, no radius: {}; {}.", told(sharpest), told(flattest)),
        why: "Holds if at the sharpest object some cell has only unresolved trials, and no other radius has a larger share of them.".to_owned(),
    })
}
