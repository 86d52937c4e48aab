//! `palpate sensor track`.

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    Fates, RecordedError, Sensed, SensorOptions, TrackedFrames, difference_image, read_calibration,
    read_frame, track_frames,
};

use super::overlay::overlay;
use crate::cli::{BaselineIs, EstimatePressArgs, TrackArgs};
use crate::estimate::press_options;
use crate::failure::Failure;
use crate::output;

pub(crate) fn track(args: &TrackArgs) -> Result<(), Failure> {
    let calibrated = args
        .calibration
        .as_deref()
        .map(|file| Calibrated::new(args, file))
        .transpose()?;
    output::make_directory(&args.out)?;
    let read = |path: &Path| read_frame(path).map_err(Failure::work);
    let [rest, pressed] = [read(&args.rest)?, read(&args.pressed)?];
    let frames = track_frames(&rest, &pressed).map_err(Failure::work)?;
    let difference = difference_image(&rest, &pressed).map_err(Failure::work)?;
    let mut files = vec![
        ("markers.csv", frames.table().to_csv().into_bytes()),
        (
            "overlay.png",
            output::png(&overlay(&pressed.image, &frames))?,
        ),
        ("difference.png", output::png(&difference)?),
    ];
    // The tables are written even where the frames turn out not to fit together below.
    let read = calibrated
        .as_ref()
        .map(|calibrated| calibrated.read(&frames));
    if let Some(Ok(read)) = &read {
        files.push(("readings.csv", read.sensed.readings().to_csv().into_bytes()));
        files.push(("field.csv", read.field.clone().into_bytes()));
    }
    output::write_files(&args.out, &files)?;
    for warning in frames.warnings() {
        eprintln!("warning: {warning}");
    }
    frames.of_one_sensor().map_err(Failure::work)?;
    match (calibrated, read) {
        (Some(calibrated), Some(read)) => calibrated.estimate(&read.map_err(Failure::work)?),
        _ => output::print(&summary(&frames.fates(), &args.out)),
    }
}

fn summary(fates: &Fates, out: &Path) -> String {
    let Fates {
        at_rest,
        tracked,
        lost,
        merged,
        split,
        new,
        cut_at_rest,
    } = fates;
    format!(
        "{at_rest} markers at rest ({cut_at_rest} more cut by the rim): {tracked} tracked, {lost} lost, {merged} merged, {split} split; {new} new -> {}",
        out.display()
    )
}

/// Calibration of a sensor, with the options of what is to be read with it.
struct Calibrated<'a> {
    args: &'a TrackArgs,
    sensor: SensorOptions,
    estimate: EstimatePressArgs,
    calibration: palpate_scene::recorded::Calibration,
    unit: palpate_study::config::LengthUnit,
}

/// Readings of a calibrated sensor.
struct Read {
    sensed: Sensed,
    /// Displacements on a regular grid, as CSV.
    field: String,
}

impl<'a> Calibrated<'a> {
    fn new(args: &'a TrackArgs, file: &Path) -> Result<Self, Failure> {
        let missing = |option| Failure::Usage(anyhow!("--calibration needs {option}"));
        let sensor = SensorOptions {
            radius: args
                .sensor_radius
                .ok_or_else(|| missing("--sensor-radius"))?,
            depth: args.depth.ok_or_else(|| missing("--depth"))?,
            px_per_rad: args.px_per_rad,
        };
        let estimate = EstimatePressArgs {
            readings: args.out.join("readings.csv"),
            sensor_radius: sensor.radius,
            method: args.method,
            depth: sensor.depth,
            thickness: args.thickness,
            poisson: args.poisson,
            indentation: args.indentation,
            indentation_std: args.indentation_std,
            baseline: BaselineIs::Known,
            gain_std: 0.0,
            normal_std: None,
            tangential_std: None,
            c: args.c,
            window: None,
            radial_scale: 1.0,
            young: None,
            length_unit: None,
        };
        // Bad arguments are refused before the work begins.
        press_options(&estimate)?;
        let (calibration, unit) = read_calibration(file).map_err(Failure::work)?;
        Ok(Self {
            args,
            sensor,
            estimate,
            calibration,
            unit,
        })
    }

    fn read(&self, frames: &TrackedFrames) -> Result<Read, RecordedError> {
        let file = self.estimate.readings.display().to_string();
        let calibration = (&self.calibration, self.unit);
        let sensed = Sensed::read(frames, calibration, &self.sensor, file)?;
        let field = sensed.field(self.args.grid as usize, self.args.filter)?;
        let field = field.to_csv();
        Ok(Read { sensed, field })
    }

    fn estimate(&self, read: &Read) -> Result<(), Failure> {
        let options = press_options(&self.estimate)?;
        let estimate = read.sensed.estimate(&options).map_err(Failure::work)?;
        output::print(&output::json(&estimate)?)
    }
}
