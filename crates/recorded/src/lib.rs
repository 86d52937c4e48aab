//! Recorded readings: tables in and out, and the estimators on them.
//!
//! A table is CSV with any of the usual delimiters, or one JSON object per line. Its [`Form`] states what the table
//! itself does not show.

mod calibration;
mod calibration_file;
mod calibration_report;
mod camera_calibration;
mod camera_reading;
mod consistency;
mod decimal;
mod drawing;
mod duplicate_rows;
mod error;
mod extra_columns;
mod file;
mod finger_assignment;
mod frame;
mod frame_calibration;
mod frame_pair;
mod frame_reader;
mod glide_estimate;
mod glide_misfit;
mod glide_recording;
mod glide_report;
mod glide_settings;
mod header;
mod image_estimate;
mod input_checks;
mod misfit_warning;
mod overlay;
mod press_estimate;
mod press_recording;
mod press_report;
mod press_settings;
mod reading_table;
mod roll_estimate;
mod roll_misfit;
mod roll_recording;
mod roll_settings;
mod source;
mod study_options;
mod table_format;
mod text_table;

pub use calibration::{
    CalibrateOptions, CalibrationPoints, calibrate, parse_calibration_points,
    read_calibration_points,
};
pub use calibration_file::{calibration_toml, parse_calibration, read_calibration};
pub use calibration_report::{CalibrationReport, Fitted};
pub use camera_calibration::{
    CameraEstimate, Residual, calibrate_camera, parse_camera, read_camera,
};
pub use camera_reading::{CameraReading, TrackedPress};
pub use consistency::{FORMAT_VERSION, INDENTATION_SHARE};
pub use error::RecordedError;
pub use file::RecordedFile;
pub use frame::{parse_frame, read_frame};
pub use frame_calibration::{KnownDisplacements, frame_calibration_points};
pub use frame_pair::{Frame, FramePair, TrackCounts, difference_image, track_frames};
pub use frame_reader::{FrameReader, FrameReading};
pub use glide_estimate::{GlideFitResult, GlideOptions, estimate_glide};
pub use glide_recording::{GlideRecording, parse_glide, read_glide};
pub use glide_report::{GlideEstimate, GlideMap, PatchNoise, PatchRegion, Thresholds};
pub use glide_settings::TipReports;
pub use image_estimate::{ImageEstimate, PictureOptions, estimate_images};
pub use overlay::overlay;
pub use palpate_ep1::ReadingNoise;
pub use palpate_ep2::{Curvature, MapPoint};
pub use palpate_geometry::{ShapeClass, ShapeThresholds};
pub use palpate_tracking::{Calibration, Marker, NormalFrom, Status, Track};
pub use press_estimate::{PressOptions, estimate_press};
pub use press_recording::{PressRecording, parse_press, read_press};
pub use press_report::{PressNoise, PressReport, Radius, Row, Told};
pub use roll_estimate::{RollEstimate, RollValues, UnresolvedProbe, estimate_roll};
pub use roll_recording::{RollOptions, RollRecording, parse_roll, read_roll};
pub use roll_settings::RollSettings;
pub use study_options::StudyMismatch;
pub use table_format::{Decimal, Delimiter, Form, column_names};

use std::borrow::Cow;

use palpate_statistics::NORMAL_95;
use serde::Serialize;

use palpate_study::Unit;
use palpate_study::config::LengthUnit;

/// A value with its standard deviation, interval and unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// Its standard deviation, if it is known.
    pub std: Option<f64>,
    /// 95 % interval; `None` without a standard deviation.
    pub interval95: Option<[f64; 2]>,
    /// Unit of all of them.
    pub unit: Cow<'static, str>,
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
