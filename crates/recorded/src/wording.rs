//! Names of settings in messages.

use palpate_statistics::Number;
use palpate_study::config::{Range, SettingError};
use thiserror::Error;

/// How a user gives settings, and therefore how messages name them.
///
/// ```
/// use palpate_recorded::Wording;
///
/// assert_eq!(Wording::Flags.name("sensor_radius"), "--sensor-radius");
/// assert_eq!(Wording::Arguments.name("sensor_radius"), "sensor_radius");
/// assert_eq!(Wording::Flags.with("kind", "gaussian"), "--method gaussian");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wording {
    /// Flags of a command line.
    #[default]
    Flags,
    /// Arguments of a call.
    Arguments,
}

/// Error of settings that are invalid or that exclude each other.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{message}")]
pub struct GivenError {
    /// Key of the setting that is at fault, with underscores.
    pub setting: String,
    /// Its value, where it is a number.
    pub value: Option<f64>,
    /// Description of the problem, with settings named as the user gives them.
    pub message: String,
}

impl Wording {
    /// Name of the setting with this key; the key `kind` has the name `method`.
    pub fn name(self, key: &str) -> String {
        let key = match key {
            "kind" => "method",
            key => key,
        };
        match self {
            Self::Flags => format!("--{}", key.replace('_', "-")),
            Self::Arguments => key.replace('-', "_"),
        }
    }

    /// A setting with its value: a placeholder such as `R`, or a word.
    pub fn with(self, key: &str, value: &str) -> String {
        let name = self.name(key);
        let is_word = value
            .chars()
            .all(|letter| letter.is_lowercase() || " -".contains(letter));
        match (self, is_word) {
            (Self::Flags, _) => format!("{name} {value}"),
            (Self::Arguments, true) => format!("{name}={value:?}"),
            (Self::Arguments, false) => name,
        }
    }

    /// Error of a setting.
    pub(super) fn refused(self, key: &str, message: impl Into<String>) -> GivenError {
        GivenError {
            setting: key.replace('-', "_"),
            value: None,
            message: message.into(),
        }
    }

    /// Error of a setting that is a number: `--depth is 25; it must be …`.
    pub(super) fn bad(self, key: &str, value: f64, expected: &str) -> GivenError {
        let message = format!(
            "{} is {}; it must be {expected}",
            self.name(key),
            Number(value)
        );
        GivenError {
            value: Some(value),
            ..self.refused(key, message)
        }
    }

    /// Checks that numeric settings are within their ranges.
    pub(super) fn check<const N: usize>(
        self,
        numbers: [(&str, Option<f64>, Range); N],
    ) -> Result<(), GivenError> {
        for (key, value, range) in numbers {
            if let Some(value) = value.filter(|&value| !range.holds(value)) {
                return Err(self.bad(key, value, &range.to_string()));
            }
        }
        Ok(())
    }

    /// Error of an estimator's settings.
    pub fn of_estimator(self, error: SettingError) -> GivenError {
        match error {
            SettingError::Useless { key, kinds } => {
                let method = self.with("kind", &kinds.join(" or "));
                self.refused(
                    &key,
                    format!("{} is of use only to {method}", self.name(&key)),
                )
            }
            SettingError::Both { key, other } => {
                let [one, other] = [&key, &other].map(|key| self.name(key));
                self.refused(
                    &key,
                    format!("{one} cannot stand beside {other}; give one of them"),
                )
            }
            SettingError::Bad { key, message } => {
                self.refused(&key, format!("{}: {message}", self.name(&key)))
            }
        }
    }
}
