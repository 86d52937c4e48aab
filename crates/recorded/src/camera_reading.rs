//! Readings of a calibrated camera sensor from two frames.

use std::collections::BTreeMap;

use palpate_press::Misfit;
use palpate_statistics::Number;
use palpate_tracking::{Calibration, CalibrationError, Displaced, Equidistant, Field, FieldError};
use serde::Serialize;

use super::Value;
use super::consistency;
use super::error::RecordedError;
use super::extra_columns::ExtraColumns;
use super::frame_pair::{FramePair, TrackCounts};
use super::press_estimate::{PressOptions, estimate_press};
use super::press_recording::PressRecording;
use super::press_report::{PressReport, Row};
use super::source::ReadingSource;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;
use palpate_study::{Column, Table, Unit};

/// Relative standard error of the calibrated slope above which a warning is given.
const VAGUE: f64 = 0.05;

/// Relative standard error of a calibration's slope of normal displacements; 0 if it is not known.
fn slope_share(calibration: &Calibration) -> f64 {
    let line = calibration.normal_part().map(|part| part.line);
    line.and_then(|line| Some((line.slope_std? / line.slope).abs()))
        .unwrap_or(0.0)
}

/// Factor between the stated and the calibrated scale of a camera above which a warning is given.
const FAR_OFF: f64 = 1.25;

/// The displacements of the markers that were tracked.
#[derive(Clone, Debug)]
pub struct CameraReading {
    origin: ReadingSource,
    unit: LengthUnit,
    radius: f64,
    has_tangential: bool,
    fates: TrackCounts,
    field: Field,
    /// Warnings about the frames and the camera's scale.
    warnings: Vec<Warning>,
    /// Relative standard error of the slope of normal displacements.
    slope_share: f64,
}

/// Output of `sensor track`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackedPress {
    frames: TrackCounts,
    /// Mean tangential displacement away from the marker of the largest normal displacement, over the contact; `null`
    /// where tangential displacements are not calibrated or no other marker was displaced inward.
    outward_displacement: Option<Value>,
    #[serde(flatten)]
    object: PressReport,
}

impl CameraReading {
    /// Converts the changes of tracked markers to displacements by a calibration. `px_per_rad` is the camera's scale;
    /// `None` for the calibration's px per length times the markers' distance from the centre. `file` is the name of the
    /// readings, for messages; `None` if they are not in a file.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] if the calibration has other markers or no normal displacements, if the camera's
    /// scale is unknown, or if no marker was tracked.
    pub fn read(
        frames: &FramePair,
        (calibration, unit): (&Calibration, LengthUnit),
        (options, px_per_rad): (&PressOptions, Option<f64>),
        file: Option<String>,
    ) -> Result<Self, RecordedError> {
        let origin = origin(frames, file);
        let fail = |message: String| origin.fail(message);
        let refused = |error: CalibrationError| fail(error.to_string());
        calibration.fits(frames.at_rest()).map_err(refused)?;
        if calibration.normal_part().is_none() {
            return Err(fail(
                "the calibration is of tangential displacements alone; the normal ones are needed"
                    .to_owned(),
            ));
        }
        let lateral = calibration.lateral_part();
        let distance = options.radius() - options.depth();
        let calibrated = lateral.map(|lateral| lateral.px_per_length * distance);
        let px_per_rad = px_per_rad.or(calibrated).ok_or_else(|| {
            fail("the calibration has no px per length: give setting `px_per_rad`".to_owned())
        })?;
        let lens = Equidistant::new(frames.centre_px, px_per_rad).map_err(refused)?;
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
                "{error}: is the camera's scale, {px_per_rad} px per rad, right?"
            )),
            _ => no_field(&origin, error),
        })?;
        let far = calibrated.filter(|&calibrated| {
            !(calibrated / FAR_OFF..=calibrated * FAR_OFF).contains(&px_per_rad)
        });
        let scale = far.map(|calibrated| {
            let numbers = [("stated", px_per_rad), ("calibrated", calibrated)];
            let [stated, calibrated] = [px_per_rad, calibrated].map(Number::rounded);
            let text = format!(
                "the camera's scale is stated as {stated} px per rad, but the calibration, the sensor's radius and the depth of its markers make it {calibrated}"
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
            fates: frames.fates(),
            origin,
        })
    }

    /// Readings from displacements that another method computed, in the order of the tracks; with the radius of the
    /// skin and the unit of lengths.
    pub(super) fn of(
        frames: &FramePair,
        displaced: &[Displaced],
        (radius, unit): (f64, LengthUnit),
        file: Option<String>,
    ) -> Result<Self, RecordedError> {
        let origin = origin(frames, file);
        let field = Field::new(displaced).map_err(|error| no_field(&origin, error))?;
        Ok(Self {
            warnings: frames.warnings(),
            slope_share: 0.0,
            field,
            unit,
            radius,
            has_tangential: true,
            fates: frames.fates(),
            origin,
        })
    }

    /// Row of a marker that was tracked, counted from 0.
    pub(super) fn row(&self, marker: usize) -> Row {
        Row {
            row: marker + 1,
            line: self.origin.line(marker),
            columns: BTreeMap::default(),
        }
    }

    /// Warning of a misfit of a press; an outlier is the number of its row.
    pub(super) fn warning(&self, misfit: &Misfit) -> Warning {
        consistency::warning(misfit, &self.origin, self.unit.as_str())
    }

    /// Report of the object, with the tracking statuses, the outward displacement of the markers, and the warnings
    /// about the frames.
    pub(super) fn pressed_by(&self, mut object: PressReport) -> TrackedPress {
        object.warnings.extend(self.warnings.iter().cloned());
        let outward = self.field.outward().filter(|_| self.has_tangential);
        TrackedPress {
            frames: self.fates,
            outward_displacement: outward
                .map(|mean| Value::new(mean, None, Unit::Length, self.unit)),
            object,
        }
    }

    /// Table with one row per tracked marker, as `estimate press` accepts it.
    pub fn readings(&self) -> Table {
        self.table(self.field.markers())
    }

    /// Displacements on a grid over the rectangle of the markers, without the places outside their convex hull;
    /// filtered by a Gaussian of standard deviation `filter_std`, length along the skin.
    ///
    /// # Errors
    /// [`RecordedError::Readings`] for a negative or infinite `filter_std`.
    pub fn field(&self, grid: usize, filter_std: f64) -> Result<Table, RecordedError> {
        let smooth = self.field.smoothed(filter_std / self.radius);
        let smooth = smooth.map_err(|error| self.origin.fail(error.to_string()))?;
        Ok(self.table(&smooth.grid(grid)))
    }

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
            let [x, y] = one.place.map(|angle| self.radius * angle);
            let along = self.has_tangential.then_some(one.tangential);
            let along = along.into_iter().flatten();
            table.push_numbers([x, y, one.normal].into_iter().chain(along));
        }
        table
    }

    /// Warning if the calibrated slope is less certain than the estimator's `gain_std` allows.
    fn gain(&self, options: &PressOptions) -> Option<Warning> {
        let told = options.estimator.priors().gain_std?;
        (self.slope_share > VAGUE.max(told)).then(|| {
            let text = format!(
                "the calibration tells its slope to {:.0} % only, a gain of all normal displacements that the intervals do not count: state it with setting `gain_std` {}",
                100.0 * self.slope_share,
                Number::rounded(self.slope_share)
            );
            Warning::new("uncertain-gain", text, [("gain_std", self.slope_share)])
        })
    }

    /// The curvature of the object.
    ///
    /// # Errors
    /// Errors of [`estimate_press`].
    pub fn estimate(&self, options: &PressOptions) -> Result<TrackedPress, RecordedError> {
        let markers = self.field.markers();
        let tangential = markers.iter().map(|marker| marker.tangential).collect();
        let readings = PressRecording {
            origin: self.origin.clone(),
            places: markers
                .iter()
                .map(|marker| marker.place.map(|angle| self.radius * angle))
                .collect(),
            normal: markers.iter().map(|marker| marker.normal).collect(),
            tangential: self.has_tangential.then_some(tangential),
            unit: Some(self.unit),
            extras: ExtraColumns::default(),
        };
        let mut object = estimate_press(&readings, options)?;
        object.warnings.extend(self.gain(options));
        Ok(self.pressed_by(object))
    }
}

/// ReadingSource of the readings of two frames.
fn origin(frames: &FramePair, file: Option<String>) -> ReadingSource {
    file.map_or(ReadingSource::Arrays, |name| ReadingSource::File {
        name,
        // Line 1 is the header.
        lines: (2..frames.tracks.len() + 2).collect(),
    })
}

fn no_field(origin: &ReadingSource, error: FieldError) -> RecordedError {
    origin.fail(match error {
        FieldError::NoMarkers => "no marker was found again".to_owned(),
        _ => error.to_string(),
    })
}
