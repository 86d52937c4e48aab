//! Figures by name, before and now.

use std::fmt;

use anyhow::{Context, Result, bail};

/// Named figures in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Figures(Vec<(String, f64)>);

impl Figures {
    /// Reads a table with a header and two columns: name and figure.
    pub(crate) fn read(text: &str) -> Result<Self> {
        let mut figures = Self::default();
        for record in csv::Reader::from_reader(text.as_bytes()).records() {
            let record = record?;
            let name = record.get(0).context("a row without a name")?;
            let figure = record.get(1).context("a row without a figure")?;
            let figure: f64 = figure
                .parse()
                .with_context(|| format!("`{name}`: `{figure}` is no number"))?;
            figures.add(name, figure)?;
        }
        Ok(figures)
    }

    /// Adds a figure.
    pub(crate) fn add(&mut self, name: &str, figure: f64) -> Result<()> {
        if !(figure.is_finite() && figure >= 0.0) {
            bail!("`{name}`: {figure} is no figure");
        }
        if self.get(name).is_some() {
            bail!("`{name}` is there twice");
        }
        self.0.push((name.to_owned(), figure));
        Ok(())
    }

    fn get(&self, name: &str) -> Option<f64> {
        self.0
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, figure)| *figure)
    }

    /// The table that [`Figures::read`] reads.
    pub(crate) fn to_csv(&self, figure: &str) -> Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["name", figure])?;
        for (name, figure) in &self.0 {
            writer.write_record([name, &text(*figure)])?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }
}

/// Counts in full, errors to six figures.
fn text(figure: f64) -> String {
    if figure.fract() == 0.0 {
        figure.to_string()
    } else {
        format!("{figure:.5e}")
    }
}

/// Limits within which figures may change.
#[derive(Debug)]
pub(crate) struct Limits {
    pub(crate) what: &'static str,
    /// Allowed growth, as a share of the earlier figure.
    pub(crate) allowed: f64,
    /// Smallest figure that counts; smaller ones are compared as if they were this.
    pub(crate) floor: f64,
}

/// Change of a figure against the baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    /// Within the limits.
    Same,
    /// Larger than allowed.
    Worse,
    /// Smaller by more than the allowed growth.
    Better,
    /// Absent from the baseline.
    New,
    /// Present in the baseline only.
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

/// A baseline beside what is measured.
pub(crate) struct Comparison {
    pub(crate) limits: &'static Limits,
    before: Figures,
    pub(crate) now: Figures,
}

impl Comparison {
    pub(crate) fn new(limits: &'static Limits, before: Figures, now: Figures) -> Self {
        Self {
            limits,
            before,
            now,
        }
    }

    /// Whether a figure is worse, or has nothing to be compared with.
    pub(crate) fn fails(&self) -> bool {
        self.changes()
            .any(|(_, change)| matches!(change, Change::Worse | Change::New | Change::Missing))
    }

    /// Whether a figure is another now, by more than the digits that the baseline has and than the floor; or came, or
    /// went, as where a name changes with its figure.
    pub(crate) fn alters(&self) -> bool {
        self.changes().any(|(name, _)| {
            let Some((before, now)) = self.before.get(name).zip(self.now.get(name)) else {
                return true;
            };
            (now - before).abs() > (1e-5 * before).max(self.limits.floor)
        })
    }

    /// Every name with its change, in the order of now, then what is missing.
    fn changes(&self) -> impl Iterator<Item = (&str, Change)> {
        let now = self.now.0.iter().map(|(name, now)| {
            let change = self
                .before
                .get(name)
                .map(|before| self.change(before, *now));
            (name.as_str(), change.unwrap_or(Change::New))
        });
        let missing = |name: &&str| self.now.get(name).is_none();
        let before = self.before.0.iter().map(|(name, _)| name.as_str());
        now.chain(before.filter(missing).map(|name| (name, Change::Missing)))
    }

    fn change(&self, before: f64, now: f64) -> Change {
        let Limits { allowed, floor, .. } = self.limits;
        let (before, now) = (before.max(*floor), now.max(*floor));
        if now > before * (1.0 + allowed) {
            Change::Worse
        } else if before > now * (1.0 + allowed) {
            Change::Better
        } else {
            Change::Same
        }
    }

    /// Table of the figures that differ, before and now.
    pub(crate) fn render(&self) -> String {
        let what = self.limits.what;
        let (mut rows, mut better) = (String::new(), false);
        for (name, change) in self.changes() {
            if change == Change::Same {
                continue;
            }
            better |= change == Change::Better;
            let (before, now) = (self.before.get(name), self.now.get(name));
            let share = before.zip(now).map_or_else(String::new, |(before, now)| {
                format!("{:+.2} %", (now / before - 1.0) * 100.0)
            });
            let shown = |figure: Option<f64>| figure.map_or_else(|| "–".to_owned(), text);
            rows += &format!(
                "{change:<8} {name:<60} {:>14} {:>14} {share:>10}\n",
                shown(before),
                shown(now)
            );
        }
        let count = self.now.0.len();
        if rows.is_empty() {
            return format!("{what}: {count} figures as in the baseline\n");
        }
        let header = format!("{:<8} {what:<60} {:>14} {:>14}\n", "", "before", "after");
        let advice = match better && !self.fails() {
            true => "better than the baseline: `cargo xtask bench-check --accept` keeps it so\n",
            false => "",
        };
        format!("{header}{rows}{advice}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::{COST, ERROR};
    use super::*;

    fn figures(of: &[(&str, f64)]) -> Figures {
        let mut figures = Figures::default();
        for (name, figure) in of {
            figures.add(name, *figure).unwrap();
        }
        figures
    }

    fn compared(limits: &'static Limits, before: f64, now: f64) -> Change {
        let comparison = Comparison::new(limits, figures(&[("a", before)]), figures(&[("a", now)]));
        comparison.changes().next().unwrap().1
    }

    #[test]
    fn three_hundredths_more_instructions_are_allowed_and_no_more() {
        assert_eq!(compared(&COST, 1000.0, 1030.0), Change::Same);
        assert_eq!(compared(&COST, 1000.0, 1031.0), Change::Worse);
        assert_eq!(compared(&COST, 1000.0, 972.0), Change::Same);
        assert_eq!(compared(&COST, 1000.0, 970.0), Change::Better);
    }

    #[test]
    fn errors_below_rounding_are_equal_and_no_error_hides_there() {
        assert_eq!(compared(&ERROR, 2e-16, 4.9e-15), Change::Same);
        assert_eq!(compared(&ERROR, 0.0, 5.1e-15), Change::Worse);
        assert_eq!(compared(&ERROR, 1e-9, 1.009e-9), Change::Same);
        assert_eq!(compared(&ERROR, 1e-9, 1.011e-9), Change::Worse);
        assert_eq!(compared(&ERROR, 1e-9, 1e-15), Change::Better);
    }

    #[test]
    fn what_is_new_or_missing_is_named_and_fails() {
        let before = figures(&[("a", 1.0), ("b", 2.0)]);
        let comparison = Comparison::new(&COST, before, figures(&[("a", 1.0), ("c", 3.0)]));
        assert!(comparison.fails());
        let text = comparison.render();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert!(lines[1].starts_with("NEW      c ") && lines[1].contains(" 3"));
        assert!(lines[2].starts_with("MISSING  b ") && lines[2].contains(" 2"));
    }

    #[test]
    fn tables_have_before_and_after() {
        let before = figures(&[("slower", 1000.0), ("same", 5.0), ("quicker", 100.0)]);
        let now = figures(&[("slower", 1100.0), ("same", 5.0), ("quicker", 50.0)]);
        let text = Comparison::new(&COST, before, now).render();
        assert!(!text.contains("same"), "{text}");
        let slower = text.lines().nth(1).unwrap();
        assert!(slower.starts_with("WORSE    slower"), "{text}");
        assert!(slower.contains("1000") && slower.contains("1100") && slower.contains("+10.00 %"));
        assert!(
            text.lines().nth(2).unwrap().starts_with("better   quicker"),
            "{text}"
        );
        // Something is worse: no advice to accept.
        assert!(!text.contains("--accept"), "{text}");
    }

    #[test]
    fn alterations_smaller_than_the_limit_are_seen_too() {
        let alters = |before, now| {
            Comparison::new(&ERROR, figures(&[("a", before)]), figures(&[("a", now)])).alters()
        };
        assert!(alters(0.1, 0.1001));
        assert!(alters(0.1, 0.05));
        assert!(!alters(0.1, 0.1 + 1e-7));
        assert!(!alters(1e-15, 4e-15));
    }

    #[test]
    fn figures_that_come_or_go_are_alterations() {
        let alters = |before: &[(&str, f64)], now: &[(&str, f64)]| {
            Comparison::new(&ERROR, figures(before), figures(now)).alters()
        };
        let (one, both) = ([("a", 0.1)], [("a", 0.1), ("b", 0.2)]);
        assert!(alters(&one, &both));
        assert!(alters(&both, &one));
        assert!(alters(&one, &[("b", 0.1)]));
        assert!(!alters(&both, &both));
    }

    #[test]
    fn tables_are_read_as_they_are_written() {
        let table = figures(&[
            ("roll, 6 rad", 1.23456e-7),
            ("exact", 0.0),
            ("many", 123_456_789.0),
        ]);
        let text = table.to_csv("error").unwrap();
        assert_eq!(
            text,
            "name,error\n\"roll, 6 rad\",1.23456e-7\nexact,0\nmany,123456789\n"
        );
        assert_eq!(Figures::read(&text).unwrap(), table);
    }

    #[test]
    fn unsound_tables_are_refused() {
        for text in [
            "name,error\na,x\n",
            "name,error\na,NaN\n",
            "name,error\na,-1\n",
            "name,error\na,1\na,2\n",
        ] {
            assert!(Figures::read(text).is_err(), "{text}");
        }
    }
}
