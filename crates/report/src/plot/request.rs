//! A `[[plot]]` that a study asks for, and what is said when it cannot be drawn.

use super::sheet::Words;
use crate::table::Axis;
use crate::{ReportError, Study};
use palpate_study::config::PlotConfig;

/// Plot of a study, as its config asks for it.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) study: &'a Study,
    pub(crate) plot: &'a PlotConfig,
    /// Name of its files.
    pub(crate) name: &'a str,
}

impl<'a> Request<'a> {
    /// Words around its figure.
    pub(crate) fn words(&self, subtitle: String, notes: Vec<String>) -> Words {
        let title = self.plot.title.as_deref().unwrap_or(self.study.title());
        Words {
            name: self.name.to_owned(),
            title: title.to_owned(),
            subtitle,
            notes,
        }
    }

    /// The error that it cannot be drawn from the table.
    pub(crate) fn bad(&self, problem: String) -> ReportError {
        ReportError::BadPlot {
            path: self.study.run_toml(),
            plot: self.name.to_owned(),
            problem,
        }
    }

    /// The error that `value` under `key` is none of the `known` columns.
    pub(crate) fn unknown<'b>(
        &self,
        key: &str,
        value: &str,
        known: impl Iterator<Item = &'b str>,
    ) -> ReportError {
        ReportError::UnknownColumn {
            path: self.study.run_toml(),
            plot: self.name.to_owned(),
            key: key.to_owned(),
            value: value.to_owned(),
            known: nearest(value, known),
        }
    }

    /// The swept path called `name` under `key`.
    pub(crate) fn axis(&self, key: &str, name: &str) -> Result<&'a Axis, ReportError> {
        let table = self.study.cells();
        let known = table.axes().iter().map(|axis| axis.header.as_str());
        let unknown = || self.unknown(key, name, known);
        table.axis(name).ok_or_else(unknown)
    }
}

/// `names`, the most similar to `wanted` first.
pub(crate) fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<&str> = names.collect();
    let likeness = |name: &str| strsim::jaro_winkler(wanted, name);
    names.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    names.into_iter().map(str::to_owned).collect()
}
