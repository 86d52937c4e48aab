//! Targets of `palpate design`. A target is a limit for a statistic of a quantity.

use std::fmt;
use std::str::FromStr;

use palpate_statistics::Number;
use thiserror::Error;

use crate::config::suggest;
use crate::quantity::{Quantity, QuantityKind};
use crate::statistic::Statistic;

/// Target: a limit for a statistic of a quantity over the trials, for example `relative_rms_error(mean_curvature) <=
/// 0.05`.
///
/// Statistics and quantities have the same names as in `cells.csv`. If the quantity is omitted, the first quantity of
/// the scene is used. The limit of a share may be written in percent. If it is above 1, it must be written in percent,
/// because 5 without a percent sign could mean 5 % or 500 %.
///
/// ```
/// use palpate_study::{Bound, Quantity, Statistic, Target};
///
/// let target: Target = "relative_rms_error(mean_curvature) <= 5 %".parse()?;
/// assert_eq!((target.statistic, target.bound), (Statistic::RelativeRmsError, Bound::AtMost));
/// assert_eq!((target.quantity, target.limit), (Some(Quantity::MEAN_CURVATURE), 0.05));
/// assert_eq!(target.to_string(), "relative_rms_error(mean_curvature) <= 0.05");
/// let error = "rms(mean_curvature) <= 0.05".parse::<Target>().expect_err("no such statistic");
/// assert!(error.to_string().starts_with("there is no statistic \"rms\"; did you mean `rms_error`?"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The statistic to which the limit applies.
    pub statistic: Statistic,
    /// Quantity whose statistic is limited; `None` means the first quantity of the scene.
    pub quantity: Option<Quantity>,
    /// Whether the limit is an upper or a lower limit.
    pub bound: Bound,
    /// The limit, in the unit of the statistic.
    pub limit: f64,
}

/// Whether a target states an upper or a lower limit for its statistic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// The statistic must be at most the limit.
    AtMost,
    /// The statistic must be at least the limit.
    AtLeast,
}

/// Reason why a text is not a valid target.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TargetError {
    /// The limit, or the statistic in front of the limit, is missing.
    #[error(
        "{0:?} is not of the form STATISTIC(QUANTITY) <= LIMIT, such as relative_rms_error(mean_curvature) <= 0.05"
    )]
    Malformed(String),
    /// No statistic has this name.
    #[error("there is no statistic {name:?}; {}", suggest(name, known.iter().copied()))]
    NoStatistic {
        /// The name that is not a statistic.
        name: String,
        /// Statistics that can be targets.
        known: Vec<&'static str>,
    },
    /// This statistic cannot be a target. The first text is its name, the second is the reason.
    #[error("{0} cannot be a target: {1}")]
    NoTarget(&'static str, &'static str),
    /// No quantity has this name.
    #[error("there is no quantity {name:?}; {}", suggest(name, known.iter().copied()))]
    NoQuantity {
        /// The name that is not a quantity.
        name: String,
        /// Names of all quantities.
        known: Vec<&'static str>,
    },
    /// The limit is not a finite number.
    #[error("the limit {0:?} is not a finite number")]
    NoLimit(String),
    /// The limit of a share is above 1, but has no percent sign.
    #[error(
        "{statistic} is a share, and {} may mean {} % or {} %; write {} % or {}",
        Number(*limit), Number(*limit), Number(100.0 * limit), Number(*limit),
        Number(limit / 100.0)
    )]
    PlainShare {
        /// Name of the statistic, with its quantity.
        statistic: String,
        /// The limit that the target states, without a percent sign.
        limit: f64,
    },
    /// The limit is in percent, but the statistic is not a share.
    #[error(
        "{statistic} is not a share; write its limit without %, or name a quantity that is one, or relative_rms_error"
    )]
    NoShare {
        /// Name of the statistic, with its quantity.
        statistic: String,
    },
    /// The limit of the target is outside the possible values of the statistic.
    #[error("{statistic} is {range}, and the limit is {}", Number(*limit))]
    OutOfRange {
        /// Name of the target's statistic.
        statistic: &'static str,
        /// Range of the statistic's possible values.
        range: &'static str,
        /// The limit of the target.
        limit: f64,
    },
}

impl FromStr for Target {
    type Err = TargetError;

    fn from_str(text: &str) -> Result<Self, TargetError> {
        const BOUNDS: [(&str, Bound); 6] = [
            ("<=", Bound::AtMost),
            (">=", Bound::AtLeast),
            ("≤", Bound::AtMost),
            ("≥", Bound::AtLeast),
            ("<", Bound::AtMost),
            (">", Bound::AtLeast),
        ];
        let malformed = || TargetError::Malformed(text.to_owned());
        let split = BOUNDS.iter().find_map(|(sign, bound)| {
            let (what, limit) = text.split_once(sign)?;
            Some((what.trim(), *bound, limit.trim()))
        });
        let (what, bound, limit) = split.ok_or_else(malformed)?;
        let (statistic, quantity) = match what.split_once('(') {
            None => (what, None),
            Some((statistic, rest)) => {
                let quantity = rest.strip_suffix(')').ok_or_else(malformed)?;
                (statistic.trim_end(), Some(quantity.trim()))
            }
        };
        if statistic.is_empty() || quantity == Some("") || limit.is_empty() {
            return Err(malformed());
        }
        let statistic = statistic_of(statistic)?;
        let quantity = quantity.map(quantity_of).transpose()?;
        let percent = limit.strip_suffix('%');
        let (digits, unit) = percent.map_or((limit, 1.0), |percent| (percent.trim_end(), 0.01));
        let number = digits.parse().ok().map(|number: f64| number * unit);
        let limit = number
            .filter(|number| number.is_finite())
            .ok_or_else(|| TargetError::NoLimit(limit.to_owned()))?;
        let is_share = statistic.is_relative()
            || quantity.is_some_and(|quantity| quantity.kind == QuantityKind::Share);
        let is_share = is_share || statistic.is_coverage();
        if unit == 1.0 && limit.abs() > 1.0 && is_share {
            let statistic = what.to_owned();
            return Err(TargetError::PlainShare { statistic, limit });
        }
        if unit != 1.0 && !is_share {
            let statistic = what.to_owned();
            return Err(TargetError::NoShare { statistic });
        }
        let out_of_range = |range| {
            Err(TargetError::OutOfRange {
                statistic: statistic.name(),
                range,
                limit,
            })
        };
        match statistic {
            statistic if statistic.is_coverage() && !(limit > 0.0 && limit <= 1.0) => {
                return out_of_range("a share, above 0 and at most 1");
            }
            statistic if statistic.is_size() && limit <= 0.0 => return out_of_range("above 0"),
            _ => {}
        }
        Ok(Self {
            statistic,
            quantity,
            bound,
            limit,
        })
    }
}

fn statistics() -> impl Iterator<Item = Statistic> {
    let all = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    all.filter(|statistic| refusal(*statistic).is_none())
}

fn refusal(statistic: Statistic) -> Option<&'static str> {
    match statistic {
        Statistic::Truth => Some("its value is fixed before any trial"),
        Statistic::Trials => Some("it is a setting, and does not describe the estimates"),
        Statistic::Failures => Some("--max-failures limits their share for every target"),
        _ => None,
    }
}

fn statistic_of(name: &str) -> Result<Statistic, TargetError> {
    let known = || statistics().map(Statistic::name).collect();
    let statistic = Statistic::named(name).ok_or_else(|| TargetError::NoStatistic {
        name: name.to_owned(),
        known: known(),
    })?;
    let no_target = |why| Err(TargetError::NoTarget(statistic.name(), why));
    refusal(statistic).map_or(Ok(statistic), no_target)
}

fn quantity_of(name: &str) -> Result<Quantity, TargetError> {
    Quantity::named(name).ok_or_else(|| TargetError::NoQuantity {
        name: name.to_owned(),
        known: Quantity::ALL.iter().map(|quantity| quantity.name).collect(),
    })
}

impl Bound {
    pub(crate) fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::AtLeast => ">=",
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.statistic.name())?;
        if let Some(quantity) = self.quantity {
            write!(f, "({})", quantity.name)?;
        }
        write!(f, " {} {}", self.bound.sign(), Number(self.limit))
    }
}
