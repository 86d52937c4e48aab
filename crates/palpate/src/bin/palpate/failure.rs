//! Defines the failures of commands, with their exit status and their message.

use std::fmt;
use std::process::ExitCode;

use anyhow::{Error, anyhow};
use palpate::config::rename_settings;
use palpate::{ConfigError, Study, SweepError};

/// Reason why a command failed; it determines the exit status.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad arguments or config: status 2.
    Usage(Error),
    /// The work failed or the readings are bad: status 1.
    Work(Error),
    /// A signal stopped the work; the second value is the exit status.
    Stopped(Error, u8),
}

impl Failure {
    pub(crate) fn usage(error: impl Into<Error>) -> Self {
        Self::Usage(error.into())
    }

    pub(crate) fn work(error: impl Into<Error>) -> Self {
        Self::Work(error.into())
    }

    pub(crate) fn no_cell(cell: usize, study: &Study) -> Self {
        let last = study.cell_count() - 1;
        Self::Usage(anyhow!("--cell is {cell}; the study has cells 0 to {last}"))
    }

    /// Converts an error that stopped the trials to a failure of the command. If the config describes an impossible
    /// scene, the failure is bad usage.
    pub(crate) fn of_sweep(error: SweepError<ConfigError>) -> Self {
        match error {
            SweepError::SetUp(error) => Self::usage(error),
            error => Self::work(error),
        }
    }

    /// The failure as one line of JSON, for programs that call palpate.
    pub(crate) fn json(&self) -> String {
        let (kind, status, error) = match self {
            Self::Usage(error) => ("usage", 2, error),
            Self::Work(error) => ("work", 1, error),
            Self::Stopped(error, status) => ("stopped", *status, error),
        };
        let field = error
            .downcast_ref::<ConfigError>()
            .map(|error| error.path.as_str())
            .filter(|path| !path.is_empty());
        error_json(kind, status, &self.to_string(), field)
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Usage(_) => 2,
            Self::Work(_) => 1,
            Self::Stopped(_, status) => *status,
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(error) | Self::Work(error) | Self::Stopped(error, _)) = self;
        let mut text = error.to_string();
        for cause in error.chain().skip(1).map(ToString::to_string) {
            // Some errors already repeat the text of their cause, so do not add it again.
            if !text.contains(&cause) {
                text = format!("{text}: {cause}");
            }
        }
        f.write_str(&visible(&with_flags(&text)))
    }
}

/// Replaces the keys of settings in an error message by the names of the command-line flags.
pub(crate) fn with_flags(message: &str) -> String {
    rename_settings(message, |key| format!("--{}", flag(key)))
}

pub(crate) fn flag(key: &str) -> String {
    match key {
        "kind" => "method".to_owned(),
        key => key.replace('_', "-"),
    }
}

/// An error as one line of JSON. If the message begins with a file name and a line number, both become fields of their
/// own.
pub(crate) fn error_json(kind: &str, status: u8, message: &str, field: Option<&str>) -> String {
    let place = message.split_once(": ").map(|(place, _)| place);
    let line = place.and_then(|place| {
        let mut parts = place.split(':');
        let file = parts.next().filter(|file| !file.is_empty())?;
        let line: u64 = parts.next()?.parse().ok()?;
        Some((file, line))
    });
    let mut error = serde_json::json!({
        "version": 1,
        "kind": kind,
        "status": status,
        "message": message,
    });
    if let Some((file, line)) = line {
        error["file"] = file.into();
        error["line"] = line.into();
    }
    if let Some(field) = field {
        error["field"] = field.into();
    }
    serde_json::json!({ "error": error }).to_string()
}

/// Escapes the control characters of a text, because a terminal would execute control characters from quoted input.
fn visible(text: &str) -> String {
    let mut visible = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() && !matches!(character, '\n' | '\t') {
            visible.extend(character.escape_unicode());
        } else {
            visible.push(character);
        }
    }
    visible
}

#[cfg(test)]
mod tests {
    use super::visible;

    #[test]
    fn control_characters_are_spelt_out() {
        assert_eq!(visible("`\u{1b}[2J`\n\tµ"), "`\\u{1b}[2J`\n\tµ");
    }
}
