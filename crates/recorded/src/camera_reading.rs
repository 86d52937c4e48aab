//! Computes the displacements of markers from two frames of a camera sensor. The press is estimated from these
//! displacements or from the images themselves.

use std::collections::BTreeMap;

use palpate_press::Misfit;
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;
use palpate_study::{Column, Table, Unit, Warning};
use palpate_tracking::{Calibration, CalibrationError, Displaced, Equidistant, Field, FieldError};
use serde::Serialize;

use super::error::RecordedError;
use super::frame_pair::{Frame, FramePair, TrackCounts, track_frames};
use super::image_estimate::estimate_images;
use super::press_estimate::estimate_press;
use super::press_options::{PictureOptions, PressOptions};
use super::press_recording::PressRecording;
use super::press_report::{PressReport, Row};
use super::press_warnings::misfit_warning;
use super::reading_table::ExtraColumns;
use super::source::ReadingSource;
use super::value::Value;

/// Method that estimates a press from two frames, with its settings.
#[derive(Clone, Debug)]
pub enum FrameReader {
    /// Converts the changes of the markers' images to displacements by a calibration, and fits the press to these
    /// displacements.
    Displacements {
        /// The calibration of the sensor.
        calibration: Box<Calibration>,
        /// Unit of all lengths, including the lengths in the calibration.
        unit: LengthUnit,
        /// Scale of the camera, pixels per radian. If it is `None`, the scale is computed from the calibration: its
        /// pixels per length, multiplied by the distance of the markers from the centre of the sensor.
        px_per_rad: Option<f64>,
        /// Options of the estimate of the press from the displacements.
        options: Box<PressOptions>,
    },
    /// Fits the press directly to the images of the markers.
    Pictures(Box<PictureOptions>),
}

/// Displacements of the markers, and the press estimated from them.
#[derive(Debug)]
pub struct FrameReading {
    /// Table of the markers' displacements, one row per tracked marker.
    pub readings: Table,
    /// Table of the displacements, interpolated at the points of a regular grid.
    pub field: Table,
    /// Estimate of the press, or the reason why there is none.
    pub estimate: Result<TrackedPress, RecordedError>,
    /// Unit of all lengths in this reading.
    pub unit: LengthUnit,
}

impl FrameReader {
    /// Computes displacements and a press from the markers tracked between a frame at rest and a pressed frame. The
    /// displacements are also interpolated on a grid of `grid` points along each side, and filtered by a Gaussian. Its
    /// standard deviation is `filter_std` (length along the skin). `file` is the name of the readings in messages;
    /// `None` if the readings are not in a file.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if the calibration is for another sensor or lacks normal displacements, if the
    /// camera's scale is not given, if no marker was tracked, or if `filter_std` is negative or infinite. If the press
    /// is fitted to the images, this error also occurs in these cases: the frames have another size, layout, colour or
    /// camera than the study, are under-exposed or saturated, or do not determine the press.
    pub fn read(
        &self,
        frames: [&Frame; 2],
        tracked: &FramePair,
        (grid, filter_std): (usize, f64),
        file: Option<String>,
    ) -> Result<FrameReading, RecordedError> {
        let (reading, estimate) = match self {
            Self::Displacements {
                calibration,
                unit,
                px_per_rad,
                options,
            } => {
                let linear = of_calibration(calibration, frames, tracked)?;
                let (tracked, warning) = match &linear {
                    Some((tracked, warning)) => (tracked, Some(warning.clone())),
                    None => (tracked, None),
                };
                let calibration = (calibration.as_ref(), *unit);
                let mut reading =
                    CameraReading::read(tracked, calibration, (options, *px_per_rad), file)?;
                reading.warnings.extend(warning);
                let estimate = reading.estimate(options);
                (reading, estimate)
            }
            Self::Pictures(options) => {
                let read = estimate_images(frames, tracked, options, file.clone());
                let scatter = scatter_at_rest(&read);
                let linear = linearised(frames, options, file, scatter);
                let (reading, press) = linear.map_or(read, Ok)?;
                (reading, Ok(press))
            }
        };
        Ok(FrameReading {
            readings: reading.table(reading.field.markers()),
            field: reading.grid(grid, filter_std)?,
            estimate,
            unit: reading.unit,
        })
    }
}

type ImageReading = (CameraReading, TrackedPress);

/// Largest accepted ratio of the residuals of the markers at rest to their noise. With a larger ratio, the pixels may
/// be encoded by sRGB, so the frames are converted to linear light and read again. For sRGB pixels, the ratio exceeds
/// 100.
const MAX_LINEAR_SCATTER: f64 = 10.0;

/// Scatter of the markers at rest, which is the ratio of their residuals to their noise; infinite if `read` is an
/// error.
fn scatter_at_rest(read: &Result<ImageReading, RecordedError>) -> f64 {
    let Ok((_, press)) = read else {
        return f64::INFINITY;
    };
    let mut warnings = press.object.warnings.iter();
    let scatter = warnings.find(|warning| warning.code == "scatter-at-rest");
    scatter.map_or(1.0, |warning| warning.numbers["ratio"])
}

/// Estimates the press again from frames whose pixels are converted from sRGB to linear light. Returns this estimate
/// only if the markers at rest agree with the sensor in the converted frames, but not in the original frames. `scatter`
/// is [`scatter_at_rest`] of the original frames.
fn linearised(
    frames: [&Frame; 2],
    options: &PictureOptions,
    file: Option<String>,
    scatter: f64,
) -> Option<ImageReading> {
    if scatter <= MAX_LINEAR_SCATTER {
        return None;
    }
    let [rest, pressed] = frames.map(|frame| frame.clone().linearised());
    let tracked = track_frames(&rest, &pressed).ok()?;
    let read = estimate_images([&rest, &pressed], &tracked, options, file);
    if scatter_at_rest(&read) > MAX_LINEAR_SCATTER {
        return None;
    }
    let (reading, mut press) = read.ok()?;
    press.object.warnings.push(srgb_warning(&rest, "sensor"));
    Some((reading, press))
}

/// Largest accepted difference between the mean hues of the markers at rest and in the calibration, turns. If the
/// pixels are encoded by sRGB, the hue of a marker with two discs differs from its hue in linear light by about 0.03
/// turns.
const MAX_HUE_DIFFERENCE: f64 = 0.01;

/// Compares the hue of the markers at rest with the hue in the calibration. If the hues agree only after the pixels are
/// converted from sRGB to linear light, returns the tracks of the converted frames, and a warning. Returns `None` if
/// the hues of the original frames agree, or if the calibration states no hue.
///
/// # Errors
/// [`RecordedError::Readings`] if the hue differs and the calibration uses hues.
fn of_calibration(
    calibration: &Calibration,
    [rest, pressed]: [&Frame; 2],
    tracked: &FramePair,
) -> Result<Option<(FramePair, Warning)>, RecordedError> {
    let Some(hue) = calibration.hue_turns else {
        return Ok(None);
    };
    let is_near = |tracked: &FramePair| {
        let off = tracked.hue_at_rest() - hue;
        (off - off.round()).abs() <= MAX_HUE_DIFFERENCE
    };
    if is_near(tracked) {
        return Ok(None);
    }
    let [rest, pressed] = [rest, pressed].map(|frame| frame.clone().linearised());
    if let Some(linear) = track_frames(&rest, &pressed).ok().filter(is_near) {
        return Ok(Some((linear, srgb_warning(&rest, "calibration"))));
    }
    if calibration
        .normal_part
        .as_ref()
        .is_none_or(|part| part.weights[0] == 0.0)
    {
        return Ok(None);
    }
    let [own, hue] = [tracked.hue_at_rest(), hue].map(Number::rounded);
    let message = format!(
        "the markers at rest have a hue of {own} turns, but those of the calibration have {hue}: was the light different, or are only the frames of one of the two encoded by sRGB (setting `srgb`)?"
    );
    Err(RecordedError::readings(&rest.file, message))
}

fn srgb_warning(rest: &Frame, reference: &str) -> Warning {
    let text = format!(
        "the markers of {} fit the {reference} only if the pixels are encoded by sRGB, so both frames were linearised (setting `srgb`)",
        rest.file
    );
    Warning::new("srgb-frames", text, [])
}

/// Largest relative standard error of the calibration's slope (signal per displacement) for which there is no warning.
const MAX_SLOPE_SHARE: f64 = 0.05;

/// Relative standard error of the slope with which a calibration computes normal displacements; 0 if the calibration
/// does not state it.
fn slope_share(calibration: &Calibration) -> f64 {
    let line = calibration.normal_part.as_ref().map(|part| part.line);
    line.and_then(|line| Some((line.slope_std? / line.slope).abs()))
        .unwrap_or(0.0)
}

/// Largest accepted ratio of two scales of a camera: the scale that the user states, and the scale that was calibrated
/// (the larger divided by the smaller). A larger ratio causes a warning.
const MAX_SCALE_RATIO: f64 = 1.25;

#[derive(Clone, Debug)]
pub(super) struct CameraReading {
    source: ReadingSource,
    unit: LengthUnit,
    radius: f64,
    has_tangential: bool,
    counts: TrackCounts,
    field: Field,
    warnings: Vec<Warning>,
    slope_share: f64,
}

/// Output of the command `sensor track`: the press, and the counts of the tracked markers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackedPress {
    frames: TrackCounts,
    /// Mean tangential displacement of the markers that are displaced into the skin, weighted by their normal
    /// displacements. It is positive away from the marker with the largest normal displacement. `null` if tangential
    /// displacements are not calibrated, or if only this marker was displaced into the skin.
    outward_displacement: Option<Value>,
    #[serde(flatten)]
    object: PressReport,
}

impl CameraReading {
    /// Converts the changes of tracked markers to displacements by a calibration. `px_per_rad` is the camera's scale.
    /// If it is `None`, the scale is the calibration's px per length, multiplied by the markers' distance from the
    /// centre of the sensor. `file` is the name of the readings in messages; `None` if the readings are not in a file.
    fn read(
        frames: &FramePair,
        (calibration, unit): (&Calibration, LengthUnit),
        (options, px_per_rad): (&PressOptions, Option<f64>),
        file: Option<String>,
    ) -> Result<Self, RecordedError> {
        let source = source(frames, file);
        let fail = |message: String| source.fail(message);
        let refused = |error: CalibrationError| fail(error.to_string());
        calibration.fits(frames.at_rest()).map_err(refused)?;
        if calibration.normal_part.as_ref().is_none() {
            let message =
                "the calibration has no normal displacements, but the estimate needs them";
            return Err(source.fail(message));
        }
        let lateral = calibration.lateral_part.as_ref();
        let distance = options.radius() - options.depth();
        let calibrated = lateral.map(|lateral| lateral.px_per_length * distance);
        let px_per_rad = px_per_rad.or(calibrated).ok_or_else(|| {
            source.fail("the calibration has no px per length: state setting `px_per_rad`")
        })?;
        let lens = Equidistant::new(frames.centre_px, px_per_rad, [0.0; 2]).map_err(refused)?;
        let mut displaced = Vec::new();
        for (marker, track) in frames.tracks.iter().enumerate() {
            let Some((rest, change)) = track.rest.zip(lens.change(track)) else {
                continue;
            };
            let Some(normal) = calibration.normal(marker, &change) else {
                continue;
            };
            let tangential = calibration.tangential(change.shift_px, normal);
            displaced.push(Displaced {
                place: lens.place(rest.centroid_px),
                tangential: tangential.unwrap_or_default(),
                normal,
            });
        }
        let field = Field::new(&displaced).map_err(|error| match error {
            FieldError::OutOfRange { .. } => fail(format!(
                "{error}: is the stated scale of the camera, {px_per_rad} px per rad, correct?"
            )),
            _ => no_field(&source, error),
        })?;
        let far = calibrated.filter(|&calibrated| {
            !(calibrated / MAX_SCALE_RATIO..=calibrated * MAX_SCALE_RATIO).contains(&px_per_rad)
        });
        let scale = far.map(|calibrated| {
            let numbers = [("stated", px_per_rad), ("calibrated", calibrated)];
            let [stated, calibrated] = [px_per_rad, calibrated].map(Number::rounded);
            let text = format!(
                "the stated scale of the camera is {stated} px per rad, but the calibration, the sensor's radius and the depth of its markers give {calibrated}"
            );
            Warning::new("camera-scale", text, numbers)
        });
        Ok(Self {
            warnings: frames.warnings().into_iter().chain(scale).collect(),
            slope_share: slope_share(calibration),
            field,
            unit,
            radius: options.radius(),
            has_tangential: lateral.is_some(),
            counts: frames.counts(),
            source,
        })
    }

    /// Readings from `displaced`, the markers' displacements that a fit to the images computed. They are in the order
    /// of the tracks. `radius` is the radius of the skin.
    pub(super) fn of(
        frames: &FramePair,
        displaced: &[Displaced],
        (radius, unit): (f64, LengthUnit),
        file: Option<String>,
    ) -> Result<Self, RecordedError> {
        let source = source(frames, file);
        let field = Field::new(displaced).map_err(|error| no_field(&source, error))?;
        Ok(Self {
            warnings: frames.warnings(),
            slope_share: 0.0,
            field,
            unit,
            radius,
            has_tangential: true,
            counts: frames.counts(),
            source,
        })
    }

    pub(super) fn row(&self, marker: usize) -> Row {
        Row {
            row: marker + 1,
            line: self.source.line(marker),
            columns: BTreeMap::default(),
        }
    }

    /// Warning about a misfit of the press. If the misfit is an outlier, the warning states the marker's row in the
    /// table.
    pub(super) fn warning(&self, misfit: &Misfit) -> Warning {
        misfit_warning(misfit, &self.source, self.unit)
    }

    pub(super) fn tracked_press(&self, mut object: PressReport) -> TrackedPress {
        object.warnings.extend(self.warnings.iter().cloned());
        let outward = self.field.outward().filter(|_| self.has_tangential);
        TrackedPress {
            frames: self.counts,
            outward_displacement: outward
                .map(|mean| Value::new(mean, None, Unit::Length, self.unit)),
            object,
        }
    }

    /// Displacements on a grid over the bounding rectangle of the markers. The table has no rows for grid points
    /// outside of the markers' convex hull. The displacements are filtered by a Gaussian with the standard deviation
    /// `filter_std`, length along the skin.
    fn grid(&self, grid: usize, filter_std: f64) -> Result<Table, RecordedError> {
        let smooth = self.field.smoothed(filter_std / self.radius);
        let smooth = smooth.map_err(|error| self.source.fail(error.to_string()))?;
        Ok(self.table(&smooth.grid(grid)))
    }

    /// Table with one row per displacement, in the format that `estimate press` reads.
    fn table(&self, displaced: &[Displaced]) -> Table {
        let columns = [
            "x",
            "y",
            "normal_displacement",
            "tangential_x",
            "tangential_y",
        ];
        let columns = Column::in_length(columns, Unit::Length, self.unit).into_iter();
        let columns = columns.take(if self.has_tangential { 5 } else { 3 });
        let mut table = Table::new(columns);
        for one in displaced {
            let [x, y] = self.place(one);
            let along = self.has_tangential.then_some(one.tangential);
            let along = along.into_iter().flatten();
            table.push_numbers([x, y, one.normal].into_iter().chain(along));
        }
        table
    }

    fn place(&self, displaced: &Displaced) -> [f64; 2] {
        displaced.place.map(|angle| self.radius * angle)
    }

    fn gain(&self, options: &PressOptions) -> Option<Warning> {
        let stated = options.estimator.priors().gain_std?;
        (self.slope_share > MAX_SLOPE_SHARE.max(stated)).then(|| {
            let text = format!(
                "the slope of the calibration has a relative standard error of {:.0} %; the intervals do not include this error, which all normal displacements have in common: state it with setting `gain_std` {}",
                100.0 * self.slope_share,
                Number::rounded(self.slope_share)
            );
            Warning::new("uncertain-gain", text, [("gain_std", self.slope_share)])
        })
    }

    fn estimate(&self, options: &PressOptions) -> Result<TrackedPress, RecordedError> {
        let markers = self.field.markers();
        let tangential = markers.iter().map(|marker| marker.tangential).collect();
        let readings = PressRecording {
            source: self.source.clone(),
            places: markers.iter().map(|marker| self.place(marker)).collect(),
            normal: markers.iter().map(|marker| marker.normal).collect(),
            tangential: self.has_tangential.then_some(tangential),
            unit: Some(self.unit),
            extras: ExtraColumns::default(),
        };
        let mut object = estimate_press(&readings, options)?;
        object.warnings.extend(self.gain(options));
        Ok(self.tracked_press(object))
    }
}

fn source(frames: &FramePair, file: Option<String>) -> ReadingSource {
    file.map_or_else(ReadingSource::arrays, |name| {
        // Line 1 of the file is the header, so the first marker is in line 2.
        let lines = (2..frames.tracks.len() + 2).collect();
        ReadingSource::new(&name, lines)
    })
}

fn no_field(source: &ReadingSource, error: FieldError) -> RecordedError {
    source.fail(match error {
        FieldError::NoMarkers => {
            "no marker of the frame at rest was found in the pressed frame".to_owned()
        }
        _ => error.to_string(),
    })
}
