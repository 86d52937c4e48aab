//! Recorded readings: CSV in and out, and the estimators on them.

mod glide;
mod patch;
mod patch_estimate;
mod press;
mod pressed;
mod pressed_object;
mod roll;
mod sheet;

pub use glide::{GlideReadings, read_glide};
pub use palpate_geometry::ShapeThresholds;
pub use patch::{GlideMethod, GlideOptions, estimate_glide};
pub use patch_estimate::{GlideEstimate, GlideMap, PatchNoise, PatchRegion, Thresholds};
pub use press::{PressReadings, read_press};
pub use pressed::{PressBody, PressMethod, PressOptions, estimate_press};
pub use pressed_object::{PressNoise, PressedObject, Radius, Row, Told};
pub use roll::{
    RollEstimate, RollMethod, RollOptions, RollReadings, UnresolvedProbe, estimate_roll, read_roll,
    roll_readings_table,
};
pub use sheet::RecordedError;

use serde::Serialize;

use crate::Unit;
use crate::config::LengthUnit;

/// A value with its standard deviation and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    value: f64,
    std: Option<f64>,
    unit: String,
}

impl Value {
    fn new(value: f64, std: Option<f64>, power: Unit, length: LengthUnit) -> Self {
        Self {
            value: value + 0.0,
            std,
            unit: power.of(length),
        }
    }
}
