//! Statistics over the trials of a cell of the study, with their column names in `cells.csv` and their names in words.

use strum::IntoStaticStr;

use crate::label::{self, Label, spoken_unit};
use crate::quantity::{Quantity, QuantityKind};

/// A statistic of a quantity over the trials of a cell. A cell is one combination of the swept values; its trials
/// differ in their random noise. The variants are in the order of the columns of `cells.csv`.
///
/// ```
/// use palpate_study::Statistic;
///
/// assert_eq!(Statistic::named("rms_error"), Some(Statistic::RmsError));
/// assert_eq!(Statistic::ALL[0].name(), "truth");
/// assert_eq!(Statistic::Q50.short(), "median estimate");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Statistic {
    /// True value of the quantity in the simulated scene.
    Truth,
    /// Number of trials of the cell of the study, including failed trials.
    Trials,
    /// Number of trials that failed.
    Failures,
    /// Mean of the estimates. If the trials do not determine the sign of a curvature, the radius that is its inverse
    /// has no mean and no standard deviation ([`Quantity::inverse_of`]).
    Mean,
    /// Standard deviation of the estimates.
    Std,
    /// Mean of the errors, that is, of estimate minus true value.
    Bias,
    /// Root mean square of the errors.
    RmsError,
    /// Standard error of the rms error: the standard deviation of the rms error between repetitions of the study with
    /// other random numbers.
    RmsErrorStd,
    /// Mean of the absolute errors.
    MeanAbsError,
    /// Root mean square of the errors, divided by the true value.
    RelativeRmsError,
    /// Mean of the absolute errors, divided by the true value.
    RelativeMeanAbsError,
    /// 5 % quantile of the estimates. It is computed from a histogram of the errors. The bins are logarithmic, with 128
    /// bins per factor of two of the error's magnitude. Therefore, the distance of the quantile from the true value is
    /// accurate to 0.4 %. Tables show only the digits that are accurate.
    Q05,
    /// Median of the estimates, with the same accuracy as `Q05`.
    Q50,
    /// 95 % quantile of the estimates, with the same accuracy as `Q05`.
    Q95,
    /// Mean of the standard deviations that the estimator states.
    MeanReportedStd,
    /// Share of the estimator's 50 % intervals that contain the true value.
    Coverage50,
    /// Share of the estimator's 80 % intervals that contain the true value.
    Coverage80,
    /// Share of the estimator's 95 % intervals that contain the true value.
    Coverage95,
    /// Cramér–Rao bound: the smallest standard deviation that an unbiased estimator can have. Only presses have this
    /// bound.
    StdBound,
}

impl Statistic {
    /// All statistics, in the order of the columns of `cells.csv`.
    pub const ALL: [Self; 18] = [
        Self::Truth,
        Self::Trials,
        Self::Failures,
        Self::Mean,
        Self::Std,
        Self::Bias,
        Self::RmsError,
        Self::RmsErrorStd,
        Self::MeanAbsError,
        Self::RelativeRmsError,
        Self::RelativeMeanAbsError,
        Self::Q05,
        Self::Q50,
        Self::Q95,
        Self::MeanReportedStd,
        Self::Coverage50,
        Self::Coverage80,
        Self::Coverage95,
    ];

    /// Name of the column of `cells.csv` that contains the statistic.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Meaning of the statistic, in sentences.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Truth => "True value of the quantity.",
            Self::Trials => "Number of trials that were run.",
            Self::Failures => {
                "Number of trials without an estimate; failures.csv lists their kinds. All other \
                 statistics use only the trials with an estimate."
            }
            Self::Mean => {
                "Mean of the estimates. It is empty for a radius if the trials do not determine \
                 its sign."
            }
            Self::Std => "Standard deviation of the estimates.",
            Self::Bias => "Mean of the errors (estimate minus true value).",
            Self::RmsError => "Root mean square of the errors.",
            Self::RmsErrorStd => {
                "Standard error of rms_error: the standard deviation of rms_error between \
                 repeated runs with the same number of trials, computed from the scatter of the \
                 squared errors. A single trial has none."
            }
            Self::MeanAbsError => "Mean of the absolute errors.",
            Self::RelativeRmsError => "Root mean square of the errors, divided by the true value.",
            Self::RelativeMeanAbsError => "Mean of the absolute errors, divided by the true value.",
            Self::Q05 => {
                "5 % quantile of the estimates, accurate to 0.4 % of its distance from the true \
                 value."
            }
            Self::Q50 => {
                "Median of the estimates, accurate to 0.4 % of its distance from the true value."
            }
            Self::Q95 => {
                "95 % quantile of the estimates, accurate to 0.4 % of its distance from the true \
                 value."
            }
            Self::MeanReportedStd => {
                "Mean of the standard deviations that the estimator states for its estimates."
            }
            Self::Coverage50 => {
                "Share of the estimator's 50 % intervals that contain the true value; 0.50 is \
                 ideal. An interval is the estimate ± 0.67 standard deviations. If the estimator \
                 states its own 95 % interval, the distances of its ends from the estimate are \
                 multiplied by 0.67/1.96."
            }
            Self::Coverage80 => {
                "Share of the estimator's 80 % intervals that contain the true value; 0.80 is \
                 ideal. The intervals are computed as for coverage50, with 1.28 standard \
                 deviations."
            }
            Self::Coverage95 => {
                "Share of the estimator's 95 % intervals that contain the true value; 0.95 is \
                 ideal."
            }
            Self::StdBound => {
                "Cramér–Rao bound: no unbiased estimator has a smaller standard deviation. It \
                 exists only for presses."
            }
        }
    }

    /// Whether the statistic is a share or a count, and therefore has no unit.
    pub const fn is_number(self) -> bool {
        self.is_relative() || self.is_coverage() || matches!(self, Self::Trials | Self::Failures)
    }

    /// Whether the statistic is a share of intervals that contain the true value.
    pub const fn is_coverage(self) -> bool {
        matches!(self, Self::Coverage50 | Self::Coverage80 | Self::Coverage95)
    }

    /// Whether the statistic is divided by the true value.
    pub(crate) const fn is_relative(self) -> bool {
        matches!(self, Self::RelativeRmsError | Self::RelativeMeanAbsError)
    }

    /// Short name of the statistic without its quantity, for the legend of a figure that already states the quantity.
    pub fn short(self) -> &'static str {
        match self {
            Self::Truth => "true value",
            Self::Failures => "failures",
            Self::RmsErrorStd => "std of the rms error",
            Self::Q05 | Self::Q95 => self.name(),
            Self::Coverage50 => "coverage of 50 % intervals",
            Self::Coverage80 => "coverage of 80 % intervals",
            Self::Coverage95 => "coverage of 95 % intervals",
            Self::StdBound => "Cramér–Rao bound",
            _ => self.words().trim_end_matches(" of {}"),
        }
    }

    /// Name of the statistic in words, with `{}` as the placeholder for the name of the quantity.
    const fn words(self) -> &'static str {
        match self {
            Self::Truth => "true {}",
            Self::Trials => "trials",
            Self::Failures => "failed trials",
            Self::Mean => "mean estimate of {}",
            Self::Std => "standard deviation of {}",
            Self::Bias => "bias of {}",
            Self::RmsError => "rms error of {}",
            Self::RmsErrorStd => "Monte Carlo std of the rms error of {}",
            Self::MeanAbsError => "mean |error| of {}",
            Self::RelativeRmsError => "rms relative error of {}",
            Self::RelativeMeanAbsError => "mean |relative error| of {}",
            Self::Q05 => "5 % quantile of the estimates of {}",
            Self::Q50 => "median estimate of {}",
            Self::Q95 => "95 % quantile of the estimates of {}",
            Self::MeanReportedStd => "mean reported std of {}",
            Self::Coverage50 => "share of 50 % intervals that hold the true {}",
            Self::Coverage80 => "share of 80 % intervals that hold the true {}",
            Self::Coverage95 => "share of 95 % intervals that hold the true {}",
            Self::StdBound => "Cramér–Rao bound on the std of {}",
        }
    }

    /// Whether the statistic can never be negative.
    pub const fn is_size(self) -> bool {
        matches!(
            self,
            Self::Std
                | Self::RmsError
                | Self::RmsErrorStd
                | Self::MeanAbsError
                | Self::RelativeRmsError
                | Self::RelativeMeanAbsError
                | Self::MeanReportedStd
                | Self::StdBound
        )
    }

    /// The statistic whose column has this name; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        let all = Self::ALL.into_iter().chain([Self::StdBound]);
        all.into_iter().find(|statistic| statistic.name() == name)
    }

    /// Label of a statistic for one or more quantities. All quantities must have the same kind and the same `unit`.
    /// `unit` is written as in the column `unit` of a table.
    pub fn label(self, quantities: &[&str], unit: &str) -> Label {
        let first = quantities.first().and_then(|name| Quantity::named(name));
        let is_measured = first.is_some_and(|first| first.kind != QuantityKind::Estimated);
        // Strains are shares of a length, so they are also displayed in percent.
        let is_strain = |first: Quantity| first.name.ends_with("_strain");
        let is_share =
            first.is_some_and(|first| first.kind == QuantityKind::Share || is_strain(first));
        let quantity = in_common(quantities);
        let words = match self {
            // Measured values are not estimates, so the label of their mean is the name of the quantity alone.
            Self::Mean if is_measured => quantity,
            _ => self.words().replace("{}", &quantity),
        };
        match self {
            Self::Trials | Self::Failures => Label::in_unit(words, ""),
            _ if self.is_number() => Label::in_percent(words, "%"),
            _ if is_share => Label::in_percent(words, "%"),
            _ => Label::in_unit(words, &spoken_unit(unit)),
        }
    }
}

/// The last words that the names of all these quantities have in common, such as `strain of folding`.
fn in_common(quantities: &[&str]) -> String {
    let words: Vec<String> = quantities
        .iter()
        .map(|name| label::quantity(name))
        .collect();
    let Some((first, others)) = words.split_first() else {
        return String::new();
    };
    let mut shared = first.as_str();
    while !shared.is_empty() {
        let end = |other: &String| other == shared || other.ends_with(&format!(" {shared}"));
        if others.iter().all(end) {
            return shared.to_owned();
        }
        shared = shared.split_once(' ').map_or("", |(_, rest)| rest);
    }
    "each quantity".to_owned()
}
