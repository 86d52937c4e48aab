//! Recorded readings: CSV in and out, and the estimators on them.

mod roll;
mod sheet;

pub use roll::{
    RollEstimate, RollMethod, RollOptions, RollReadings, UnresolvedProbe, Value, estimate_roll,
    read_roll, roll_readings_table,
};
pub use sheet::RecordedError;
