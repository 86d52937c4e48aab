//! Estimates from two frames of a camera sensor, by either method.

use palpate_study::Table;
use palpate_study::config::LengthUnit;
use palpate_tracking::Calibration;

use super::camera_reading::{CameraReading, TrackedPress};
use super::error::RecordedError;
use super::frame_pair::{Frame, FramePair};
use super::image_estimate::{PictureOptions, estimate_images};
use super::press_estimate::PressOptions;

/// Method that estimates a press from two frames, with its settings.
#[derive(Clone, Debug)]
pub enum FrameReader {
    /// Converts the markers' changes to displacements by a calibration and fits the press to these.
    Displacements {
        /// The calibration.
        calibration: Box<Calibration>,
        /// Unit of its lengths and of all others.
        unit: LengthUnit,
        /// The camera's scale; `None` for the calibration's px per length times the markers' distance from the centre.
        px_per_rad: Option<f64>,
        /// Options of the estimate.
        options: Box<PressOptions>,
    },
    /// Fits the press to the frames themselves.
    Pictures(Box<PictureOptions>),
}

/// Displacements of the markers, and the press that they show.
#[derive(Debug)]
pub struct FrameReading {
    /// Table with one row per tracked marker.
    pub readings: Table,
    /// Displacements on a regular grid.
    pub field: Table,
    /// The estimate.
    pub estimate: Result<TrackedPress, RecordedError>,
    /// Unit of all lengths.
    pub unit: LengthUnit,
}

impl FrameReader {
    /// Reads tracked markers of a frame at rest and a pressed one. The field has `grid` points along each side and is
    /// filtered by a Gaussian of standard deviation `filter_std`. `file` names the readings in messages; `None` if they
    /// are not in a file.
    ///
    /// # Errors
    /// Errors of [`CameraReading::read`], [`CameraReading::field`] and [`estimate_images`].
    pub fn read(
        &self,
        frames: [&Frame; 2],
        tracked: &FramePair,
        (grid, filter_std): (usize, f64),
        file: Option<String>,
    ) -> Result<FrameReading, RecordedError> {
        match self {
            Self::Displacements {
                calibration,
                unit,
                px_per_rad,
                options,
            } => {
                let sensed = CameraReading::read(
                    tracked,
                    (calibration, *unit),
                    (options, *px_per_rad),
                    file,
                )?;
                Ok(FrameReading {
                    readings: sensed.readings(),
                    field: sensed.field(grid, filter_std)?,
                    estimate: sensed.estimate(options),
                    unit: *unit,
                })
            }
            Self::Pictures(options) => {
                let pictured = estimate_images(frames, tracked, options, file)?;
                Ok(FrameReading {
                    readings: pictured.readings(),
                    field: pictured.field(grid, filter_std)?,
                    estimate: Ok(pictured.press().clone()),
                    unit: options.unit(),
                })
            }
        }
    }
}
