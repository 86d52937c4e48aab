//! `palpate sensor track`.

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    Fates, PressOptions, RecordedError, Sensed, SensorOptions, TrackedFrames, difference_image,
    overlay, read_calibration, read_frame, track_frames,
};

use crate::cli::TrackArgs;
use crate::estimate::{Like, press_options, warn};
use crate::failure::Failure;
use crate::output::{self, Folder, Guard};

pub(crate) fn track(args: &TrackArgs) -> Result<(), Failure> {
    if let (None, Some(flag)) = (&args.calibration, args.sensor.given()) {
        return Err(Failure::Usage(anyhow!("{flag} needs --calibration FILE")));
    }
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
    let like = &args.sensor.like.like;
    let inputs = [&args.rest, &args.pressed]
        .into_iter()
        .chain(&args.calibration)
        .chain(like);
    let mut folder = Folder::open(&args.out, Guard::new(inputs, args.force))?;
    folder.write(&files, None)?;
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
    estimate: PressOptions,
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
        let given = &args.sensor;
        let missing = |option| Failure::Usage(anyhow!("--calibration needs {option}"));
        if given.like.like.is_none() {
            given
                .sensor_radius
                .ok_or_else(|| missing("--sensor-radius"))?;
            given.depth.ok_or_else(|| missing("--depth"))?;
            // Bad arguments are refused before any file is read.
            press_options(given, None, None)?;
        }
        let (calibration, unit) = read_calibration(file).map_err(Failure::work)?;
        let like = Like::of(&given.like)?;
        let estimate = press_options(given, like.as_ref(), Some(unit))?;
        Ok(Self {
            args,
            sensor: SensorOptions {
                radius: estimate.sensor_radius,
                depth: estimate.marker_depth,
                px_per_rad: args.px_per_rad,
            },
            estimate,
            calibration,
            unit,
        })
    }

    fn read(&self, frames: &TrackedFrames) -> Result<Read, RecordedError> {
        let file = self.args.out.join("readings.csv").display().to_string();
        let calibration = (&self.calibration, self.unit);
        let sensed = Sensed::read(frames, calibration, &self.sensor, Some(file))?;
        let field = sensed.field(self.args.grid as usize, self.args.filter)?;
        let field = field.to_csv();
        Ok(Read { sensed, field })
    }

    fn estimate(&self, read: &Read) -> Result<(), Failure> {
        let estimate = read
            .sensed
            .estimate(&self.estimate)
            .map_err(Failure::work)?;
        warn(&estimate)?;
        output::print(&output::json(&estimate)?)
    }
}
