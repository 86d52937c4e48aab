//! Compares numbers that a test program measures with the baseline, a committed table of earlier values of the same
//! numbers.

use std::fmt;

use anyhow::{Result, ensure};

/// Folder of the files with the baselines.
pub(crate) const DIRECTORY: &str = "crates/assay/baseline";

/// Names and numbers of a table, in the order of its rows.
pub(crate) type Figures = Vec<(String, f64)>;

/// Reads a table with a header and two columns, which are name and number.
pub(crate) fn read(text: &str) -> Result<Figures> {
    let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
    let figures = rows.collect::<Result<Figures, _>>()?;
    for (at, (name, figure)) in figures.iter().enumerate() {
        ensure!(
            figure.is_finite() && *figure >= 0.0,
            "`{name}`: {figure} is not a finite number of at least 0"
        );
        ensure!(
            find(&figures[..at], name).is_none(),
            "`{name}` occurs twice"
        );
    }
    Ok(figures)
}

fn find(figures: &[(String, f64)], name: &str) -> Option<f64> {
    let found = figures.iter().find(|(known, _)| known == name);
    found.map(|(_, figure)| *figure)
}

fn text(figure: f64) -> String {
    if figure.fract() == 0.0 {
        figure.to_string()
    } else {
        format!("{figure:.5e}")
    }
}

/// How much the measured numbers may differ from the baseline.
#[derive(Debug)]
pub(crate) struct Limits {
    pub(crate) what: &'static str,
    /// Name of the test program that prints the numbers. The baseline file has the same name.
    pub(crate) harness: &'static str,
    /// Largest allowed increase of a number, as a share of the number in the baseline.
    pub(crate) allowed: f64,
    /// Two numbers below this value count as equal: before the comparison, a smaller number (measured or in the
    /// baseline) is replaced by this value.
    pub(crate) floor: f64,
}

impl Limits {
    pub(crate) fn path(&self) -> String {
        format!("{DIRECTORY}/{}.csv", self.harness)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Same,
    Worse,
    /// The measured number is smaller: the number in the baseline is more than (1 + [`Limits::allowed`]) times the
    /// measured number.
    Better,
    New,
    Missing,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Same => "same",
            Self::Worse => "WORSE",
            Self::Better => "better",
            Self::New => "NEW",
            Self::Missing => "MISSING",
        })
    }
}

pub(crate) struct Comparison {
    pub(crate) limits: &'static Limits,
    pub(crate) before: Figures,
    pub(crate) now: Figures,
}

impl Comparison {
    /// Whether a number is larger than allowed, is new, or is missing.
    pub(crate) fn fails(&self) -> bool {
        let is_failure = |change| matches!(change, Change::Worse | Change::New | Change::Missing);
        self.rows()
            .any(|(_, figures)| is_failure(self.change(figures)))
    }

    /// Whether the baseline must be replaced, because a number is new or missing, or has changed. A change counts if it
    /// is larger than [`Limits::floor`] and larger than the rounding of the numbers in the table.
    pub(crate) fn alters(&self) -> bool {
        self.rows().any(|(_, figures)| match figures {
            [Some(before), Some(now)] => {
                (now - before).abs() > (1e-5 * before).max(self.limits.floor)
            }
            _ => true,
        })
    }

    pub(crate) fn to_csv(&self) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["name", self.limits.what])?;
        for (name, figure) in &self.now {
            writer.write_record([name, &text(*figure)])?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }

    /// The rows of the comparison: name, number in the baseline, and measured number; `None` for a missing number. Rows
    /// without a measured number come last.
    fn rows(&self) -> impl Iterator<Item = (&str, [Option<f64>; 2])> {
        let now = self.now.iter();
        let now = now.map(|(name, now)| (name.as_str(), [find(&self.before, name), Some(*now)]));
        let missing = |(name, _): &&(String, f64)| find(&self.now, name).is_none();
        let before = self.before.iter().filter(missing);
        now.chain(before.map(|(name, before)| (name.as_str(), [Some(*before), None])))
    }

    fn change(&self, figures: [Option<f64>; 2]) -> Change {
        let Limits { allowed, floor, .. } = self.limits;
        let [Some(before), Some(now)] = figures.map(|figure| figure.map(|one| one.max(*floor)))
        else {
            return match figures {
                [None, _] => Change::New,
                _ => Change::Missing,
            };
        };
        if now > before * (1.0 + allowed) {
            Change::Worse
        } else if before > now * (1.0 + allowed) {
            Change::Better
        } else {
            Change::Same
        }
    }

    pub(crate) fn render(&self) -> String {
        let what = self.limits.what;
        let (mut rows, mut is_better) = (String::new(), false);
        for (name, figures) in self.rows() {
            let change = self.change(figures);
            if change == Change::Same {
                continue;
            }
            is_better |= change == Change::Better;
            let share = match figures {
                [Some(before), Some(now)] => format!("{:+.2} %", (now / before - 1.0) * 100.0),
                _ => String::new(),
            };
            let [before, now] = figures.map(|figure| figure.map_or("–".to_owned(), text));
            rows += &format!("{change:<8} {name:<60} {before:>14} {now:>14} {share:>10}\n");
        }
        if rows.is_empty() {
            return format!("{what}: {} figures as in the baseline\n", self.now.len());
        }
        let header = format!("{:<8} {what:<60} {:>14} {:>14}\n", "", "before", "after");
        let advice = match is_better && !self.fails() {
            true => {
                "better than the baseline: run `cargo xtask bench-check --accept` to update it\n"
            }
            false => "",
        };
        format!("{header}{rows}{advice}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench_check::{COST, ERROR};

    type Pairs<'a> = &'a [(&'a str, f64)];

    fn compared(limits: &'static Limits, before: Pairs<'_>, now: Pairs<'_>) -> Comparison {
        let [before, now] = [before, now].map(|pairs| {
            let pairs = pairs.iter();
            pairs
                .map(|(name, figure)| ((*name).to_owned(), *figure))
                .collect()
        });
        Comparison {
            limits,
            before,
            now,
        }
    }

    fn change(limits: &'static Limits, before: f64, now: f64) -> Change {
        compared(limits, &[], &[]).change([Some(before), Some(now)])
    }

    #[test]
    fn up_to_three_percent_more_instructions_are_allowed() {
        assert_eq!(change(&COST, 1000.0, 1030.0), Change::Same);
        assert_eq!(change(&COST, 1000.0, 1031.0), Change::Worse);
        assert_eq!(change(&COST, 1000.0, 972.0), Change::Same);
        assert_eq!(change(&COST, 1000.0, 970.0), Change::Better);
    }

    #[test]
    fn errors_below_rounding_are_equal() {
        assert_eq!(change(&ERROR, 2e-16, 4.9e-15), Change::Same);
        assert_eq!(change(&ERROR, 0.0, 5.1e-15), Change::Worse);
        assert_eq!(change(&ERROR, 1e-9, 1.009e-9), Change::Same);
        assert_eq!(change(&ERROR, 1e-9, 1.011e-9), Change::Worse);
        assert_eq!(change(&ERROR, 1e-9, 1e-15), Change::Better);
    }
}
