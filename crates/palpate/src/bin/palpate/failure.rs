//! Failures of commands.

use std::fmt;
use std::process::ExitCode;

use anyhow::{Error, anyhow};
use palpate::{ConfigError, Study, SweepError};

/// Reason why a command failed, and so its status.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad arguments or config: status 2.
    Usage(Error),
    /// The work failed or the readings are bad: status 1.
    Work(Error),
}

impl Failure {
    pub(crate) fn usage(error: impl Into<Error>) -> Self {
        Self::Usage(error.into())
    }

    pub(crate) fn work(error: impl Into<Error>) -> Self {
        Self::Work(error.into())
    }

    /// Failure of `--cell` with a number that no cell of the study has.
    pub(crate) fn no_cell(cell: usize, study: &Study) -> Self {
        let last = study.cell_count() - 1;
        Self::Usage(anyhow!("--cell is {cell}; the study has cells 0 to {last}"))
    }

    /// Failure of trials: bad usage where a config makes no scene.
    pub(crate) fn of_sweep(error: SweepError<ConfigError>) -> Self {
        match error {
            SweepError::SetUp(error) => Self::usage(error),
            error => Self::work(error),
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Usage(_) => 2,
            Self::Work(_) => 1,
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(error) | Self::Work(error)) = self;
        let mut text = error.to_string();
        for cause in error.chain().skip(1).map(ToString::to_string) {
            // Some errors tell their cause themselves.
            if !text.contains(&cause) {
                text = format!("{text}: {cause}");
            }
        }
        f.write_str(&visible(&text))
    }
}

/// A text that a terminal shows and does not obey: control characters of a file that a message quotes are spelt out.
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
