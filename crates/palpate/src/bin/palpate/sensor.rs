//! Implements the command `palpate sensor`.

mod calibrate;
mod pattern;
mod track;

use crate::cli::SensorCommand;
use crate::failure::Failure;

pub(crate) fn sensor(command: &SensorCommand) -> Result<(), Failure> {
    match command {
        SensorCommand::Pattern(args) => pattern::pattern(args),
        SensorCommand::Calibrate(args) => calibrate::calibrate(args),
        SensorCommand::Track(args) => track::track(args),
    }
}
