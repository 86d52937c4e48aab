//! Times and errors of peers and of palpate on tasks.

use anyhow::{Context, Result};
use serde::Deserialize;

/// Time and error of one task.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct Figure {
    pub(crate) task: String,
    pub(crate) peer: String,
    pub(crate) version: String,
    pub(crate) time_us: f64,
    pub(crate) error: f64,
}

impl Figure {
    /// Reads lines of JSON.
    pub(crate) fn read(lines: &str) -> Result<Vec<Figure>> {
        let lines = lines.lines().filter(|line| !line.trim().is_empty());
        let figure =
            |line| serde_json::from_str(line).with_context(|| format!("no figure: {line}"));
        lines.map(figure).collect()
    }
}

/// The median time and the median error of each peer on each task, in the order in which they first came.
pub(crate) fn medians(figures: Vec<Figure>) -> Vec<Figure> {
    let mut medians: Vec<Figure> = Vec::new();
    for figure in &figures {
        let same = |other: &&Figure| (&other.task, &other.peer) == (&figure.task, &figure.peer);
        if medians.iter().any(|known| same(&known)) {
            continue;
        }
        let median = |of: fn(&Figure) -> f64| {
            let mut all: Vec<f64> = figures.iter().filter(same).map(of).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        medians.push(Figure {
            time_us: median(|figure| figure.time_us),
            error: median(|figure| figure.error),
            ..figure.clone()
        });
    }
    medians
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(task: &str, time: f64) -> String {
        format!(
            "{{\"task\": \"{task}\", \"peer\": \"p\", \"version\": \"1\", \"time_us\": {time}, \"error\": 0.5}}\n"
        )
    }

    #[test]
    fn rounds_become_medians_per_task() {
        let lines: String = [
            ("b", 9.0),
            ("a", 1.0),
            ("b", 2.0),
            ("a", 7.0),
            ("b", 3.0),
            ("a", 4.0),
        ]
        .map(|(task, time)| line(task, time))
        .concat();
        let medians = medians(Figure::read(&lines).unwrap());
        let short: Vec<_> = medians
            .iter()
            .map(|one| (one.task.as_str(), one.time_us))
            .collect();
        assert_eq!(short, [("b", 3.0), ("a", 4.0)]);
    }

    #[test]
    fn an_incomplete_figure_is_named() {
        let error = Figure::read("{\"task\": \"a\"}").unwrap_err();
        let text = format!("{error:#}");
        assert!(
            text.starts_with("no figure: {\"task\": \"a\"}: missing field `peer`"),
            "{text}"
        );
        // Infinity is no JSON: a peer that misses markers is told so.
        assert!(Figure::read(&line("a", f64::INFINITY)).is_err());
    }
}
