//! Reads recorded readings from tables and camera frames, and computes estimates from them.
//!
//! | step | files |
//! |---|---|
//! | a file to rows of text | `file`, `text_table` with a file per format: `delimited_text`, `json_table`, `numpy` |
//! | rows to columns of numbers in one unit | `header`, `table_layout`, `decimal`, `reading_table` |
//! | columns to readings | `roll_recording`, `glide_recording`, `press_recording`, `calibration` |
//! | settings, also of a study | `roll_options`, `glide_options`, `press_options`, `study_options` |
//! | readings to an estimate | `roll_estimate`, `roll_series`, `glide_estimate`, `press_estimate`, `load_curve` |
//! | warnings | `roll_warnings`, `glide_warnings`, `log_warnings`, `two_groups`, `press_warnings`, with the words of `misfit_warning` |
//! | frames to tracked markers | `frame_pair`, `overlay` |
//! | tracked markers to an estimate | `camera_reading` by a calibration, `image_estimate` by the markers' images |
//! | a frame at rest to a camera | `camera_calibration`, `layout_matching`, `nominal_sensor`, `camera_file`, `camera_prior` |

mod calibration;
mod calibration_file;
mod calibration_report;
mod camera_calibration;
mod camera_file;
mod camera_prior;
mod camera_reading;
mod decimal;
mod delimited_text;
mod error;
mod file;
mod finger_assignment;
mod frame_pair;
mod glide_estimate;
mod glide_options;
mod glide_recording;
mod glide_report;
mod glide_warnings;
mod header;
mod heading;
mod image_estimate;
mod json_table;
mod layout_matching;
mod load_curve;
mod log_warnings;
mod lost_rolls;
mod misfit_warning;
mod nominal_sensor;
mod numpy;
mod overlay;
mod press_estimate;
mod press_options;
mod press_recording;
mod press_report;
mod press_warnings;
mod reading_table;
mod roll_estimate;
mod roll_options;
mod roll_recording;
mod roll_rotation;
mod roll_series;
mod roll_table;
mod roll_warnings;
mod shape_report;
mod single_direction;
mod source;
mod study_options;
mod table_format;
mod table_layout;
mod text_table;
mod two_groups;
mod value;

pub use calibration::{
    CalibrateOptions, CalibrationPoints, KnownDisplacements, calibrate, frame_calibration_points,
};
pub use calibration_file::{calibration_toml, parse_calibration};
pub use calibration_report::CalibrationReport;
pub use camera_calibration::calibrate_camera;
pub use camera_file::{CameraEstimate, Residual};
pub use camera_reading::{FrameReader, FrameReading, TrackedPress};
pub use error::RecordedError;
pub use file::RecordedFile;
pub use frame_pair::{Frame, FramePair, TrackCounts, difference_image, track_frames};
pub use glide_estimate::{GlideFitResult, estimate_glide};
pub use glide_options::{GlideOptions, TipReports};
pub use glide_recording::GlideRecording;
pub use glide_report::{GlideEstimate, GlideMap};
pub use load_curve::{LoadCurve, LoadEstimate, LoadOptions, estimate_force};
pub use overlay::overlay;
pub use palpate_ep1::ReadingNoise;
pub use palpate_ep2::{Curvature, MapPoint};
pub use palpate_frames::Compression;
pub use palpate_geometry::{ShapeClass, ShapeThresholds};
pub use palpate_tracking::{Calibration, Marker, NormalFrom, Status, Track};
pub use press_estimate::estimate_press;
pub use press_options::{PictureOptions, PressOptions};
pub use press_recording::PressRecording;
pub use press_report::PressReport;
pub use roll_estimate::{RollEstimate, RollValues, estimate_roll};
pub use roll_options::{RollOptions, RollSettings};
pub use roll_recording::RollRecording;
pub use roll_rotation::RotationFrame;
pub use roll_series::SeriesOptions;

pub use table_format::{Decimal, Delimiter, Form, column_names};
pub use value::Value;
