//! Recorded readings: tables in and out, and the estimators on them.
//!
//! A table is CSV with any of the usual delimiters, or one JSON object per line. Its [`Form`] states what the table
//! itself does not show.

mod calibration;
mod calibration_file;
mod calibration_report;
mod camera_rest;
mod doubted;
mod drawing;
mod error;
mod extra;
mod file;
mod fingers;
mod form;
mod frame;
mod frame_reader;
mod glide;
mod glide_settings;
mod header;
mod number;
mod origin;
mod overlay;
mod patch;
mod patch_doubts;
mod patch_estimate;
mod pictured;
mod press;
mod press_settings;
mod pressed;
mod pressed_object;
mod repeated;
mod roll;
mod roll_agreement;
mod roll_estimate;
mod roll_settings;
mod rolls;
mod sensed;
mod sheet;
mod shown;
mod stated;
mod study_options;
mod suspicion;
mod tracked;
mod written;

pub use calibration::{
    CalibrateOptions, CalibrationPoints, calibrate, parse_calibration_points,
    read_calibration_points,
};
pub use calibration_file::{calibration_toml, parse_calibration, read_calibration};
pub use calibration_report::{CalibrationReport, Fitted};
pub use camera_rest::{Residual, RestCamera, calibrate_camera, parse_camera, read_camera};
pub use error::RecordedError;
pub use file::RecordedFile;
pub use form::{Decimal, Delimiter, Form, column_names};
pub use frame::{parse_frame, read_frame};
pub use frame_reader::{FrameReader, FrameReading};
pub use glide::{GlideReadings, parse_glide, read_glide};
pub use glide_settings::TipReports;
pub use overlay::overlay;
pub use palpate_ep1::{ReadingNoise, SetRow};
pub use palpate_ep2::{Curvature, MapPoint};
pub use palpate_geometry::{ShapeClass, ShapeThresholds};
pub use palpate_tracking::{Calibration, Marker, NormalFrom, Status, Track};
pub use patch::{FittedGlide, GlideOptions, estimate_glide};
pub use patch_estimate::{GlideEstimate, GlideMap, PatchNoise, PatchRegion, Thresholds};
pub use pictured::{PictureOptions, Pictured, estimate_pictures};
pub use press::{PressReadings, parse_press, read_press};
pub use pressed::{PressOptions, estimate_press};
pub use pressed_object::{PressNoise, PressedObject, Radius, Row, Told};
pub use roll::{RollOptions, RollReadings, parse_roll, read_roll};
pub use roll_estimate::{RollEstimate, UnresolvedProbe, estimate_roll};
pub use roll_settings::RollSettings;
pub use rolls::RollSets;
pub use sensed::{Sensed, TrackedPress};
pub use shown::{KnownOfFrames, calibration_points_of_frames};
pub use stated::{FORMAT_VERSION, INDENTATION_SHARE};
pub use study_options::StudyMismatch;
pub use tracked::{Fates, Frame, TrackedFrames, difference_image, track_frames};

use std::borrow::Cow;

use palpate_statistics::NORMAL_95;
use serde::Serialize;

use palpate_study::Unit;
use palpate_study::config::LengthUnit;

/// A value with its standard deviation, interval and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    value: f64,
    std: Option<f64>,
    /// 95 % interval; `None` without a standard deviation.
    interval95: Option<[f64; 2]>,
    unit: Cow<'static, str>,
}

impl Value {
    fn new(value: f64, std: Option<f64>, power: Unit, length: LengthUnit) -> Self {
        Self::within(value, std, NORMAL_95, power, length)
    }

    /// A value whose 95 % interval reaches `half_width` standard deviations to either side.
    fn within(
        value: f64,
        std: Option<f64>,
        half_width: f64,
        power: Unit,
        length: LengthUnit,
    ) -> Self {
        let value = value + 0.0;
        let interval = |std: f64| [value - half_width * std, value + half_width * std];
        Self {
            value,
            std,
            interval95: std.map(interval),
            unit: Cow::Borrowed(power.of(length)),
        }
    }
}
