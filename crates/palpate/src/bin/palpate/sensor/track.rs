//! Implements the command `palpate sensor track`.

use std::path::Path;

use anyhow::anyhow;
use palpate_recorded::{
    CameraEstimate, Frame, FrameReader, PictureOptions, RecordedError, RecordedFile, TrackCounts,
    difference_image, overlay, parse_calibration, track_frames,
};

use super::calibrate::read_frame;
use crate::cli::TrackArgs;
use crate::estimate::{Like, picture_options, press_options, warn};
use crate::failure::Failure;
use crate::output::{self, Guard, LockedDir};

/// Default number of points along each side of the grid of the interpolated displacement field.
const GRID: u32 = 30;

pub(crate) fn track(args: &TrackArgs) -> Result<(), Failure> {
    let reader = reader(args)?;
    output::make_directory(&args.out)?;
    let mut both = [
        read_frame(&args.rest, args.srgb)?,
        read_frame(&args.pressed, args.srgb)?,
    ];
    // The camera model of a study has square frames, so use the central square of each frame.
    if args.sensor.like.like.is_some() {
        both = both.map(Frame::central_square);
    }
    let [rest, pressed] = both;
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
    // The two frames may be of different sensors. Then the press cannot be estimated, but the other files are written
    // nevertheless.
    let grid = args.grid.unwrap_or(GRID) as usize;
    let filter = args.filter.unwrap_or(0.0);
    let file = args.out.join("readings.csv").display().to_string();
    let read =
        reader.map(|reader| reader.read([&rest, &pressed], &frames, (grid, filter), Some(file)));
    if let Some(Ok(read)) = &read {
        files.push(("readings.csv", read.readings.to_csv().into_bytes()));
        files.push(("field.csv", read.field.to_csv().into_bytes()));
    }
    let like = &args.sensor.like.like;
    let inputs = [&args.rest, &args.pressed]
        .into_iter()
        .chain(&args.calibration)
        .chain(like);
    let mut folder = LockedDir::open(&args.out, Guard::new(inputs, args.force))?;
    folder.write(&files, None)?;
    let estimate = read.map(|read| read.and_then(|read| read.estimate));
    match &estimate {
        // The warnings of the estimate already include the warnings of the frames.
        Some(Ok(estimate)) => warn(estimate)?,
        _ => frames.warnings().iter().for_each(output::print_note),
    }
    frames.of_one_sensor().map_err(Failure::work)?;
    match estimate {
        Some(estimate) => output::print(&output::json(&estimate.map_err(Failure::work)?)?),
        None => output::print(&summary(&frames.counts(), &args.out)),
    }
}

fn summary(counts: &TrackCounts, out: &Path) -> String {
    let TrackCounts {
        at_rest,
        tracked,
        lost,
        merged,
        split,
        new,
        cut_at_rest,
    } = counts;
    format!(
        "{at_rest} markers at rest ({cut_at_rest} more cut by the rim): {tracked} tracked, {lost} lost, {merged} merged, {split} split; {new} new -> {}",
        out.display()
    )
}

/// Chooses how the pressed frame is evaluated: by a fit to the images of its markers, or by displacements that follow
/// from a calibration. `None` if the arguments choose neither.
fn reader(args: &TrackArgs) -> Result<Option<FrameReader>, Failure> {
    let like = Like::of(&args.sensor.like)?;
    let study = like.as_ref().map(|like| &like.config);
    if PictureOptions::are_asked_for(&args.sensor.estimator.given, study) {
        let pictures = pictures(args, like.as_ref())?;
        return Ok(Some(FrameReader::Pictures(Box::new(pictures))));
    }
    match (&args.calibration, of_calibration(args)) {
        (Some(file), _) => calibrated(args, file, like.as_ref()).map(Some),
        (None, Some(flag)) => Err(Failure::Usage(anyhow!("{flag} needs --calibration FILE"))),
        (None, None) => Ok(None),
    }
}

fn of_calibration(args: &TrackArgs) -> Option<String> {
    let given = [
        ("--like", args.sensor.like.like.is_some()),
        ("--px-per-rad", args.px_per_rad.is_some()),
        ("--grid", args.grid.is_some()),
        ("--filter", args.filter.is_some()),
    ];
    let mut given = given.into_iter().filter(|(_, is_given)| *is_given);
    let other = given.next().map(|(flag, _)| flag);
    let own = args.sensor.presses.flag();
    own.or(other.map(str::to_owned))
        .or_else(|| args.sensor.estimator.flag())
}

fn pictures(args: &TrackArgs, like: Option<&Like>) -> Result<PictureOptions, Failure> {
    if args.px_per_rad.is_some() {
        return Err(Failure::Usage(anyhow!(
            "--px-per-rad has no effect with --method image: --like or --calibration states the camera"
        )));
    }
    // Reject bad arguments before the calibration is read.
    let given = args.sensor.presses.and(&args.sensor.estimator);
    picture_options(&given, like, None)?;
    let camera = args.calibration.as_deref().map(|file| {
        let camera = RecordedFile::read(file).and_then(|file| CameraEstimate::try_from(&file))?;
        Ok((file.display().to_string(), camera))
    });
    let camera = camera
        .transpose()
        .map_err(|error: RecordedError| Failure::work(error))?;
    let unit = camera.as_ref().map(|(_, camera)| camera.length_unit);
    let mut options = picture_options(&given, like, unit)?;
    options.camera = camera;
    Ok(options)
}

fn calibrated(args: &TrackArgs, file: &Path, like: Option<&Like>) -> Result<FrameReader, Failure> {
    let given = args.sensor.presses.and(&args.sensor.estimator);
    if like.is_none() {
        for (key, flag) in [("sensor_radius", "--sensor-radius"), ("depth", "--depth")] {
            if !given.contains_key(key) {
                return Err(Failure::Usage(anyhow!("--calibration needs {flag}")));
            }
        }
        // Reject bad arguments before any file is read.
        press_options(&given, None, None, true)?;
    }
    let calibration = RecordedFile::read(file).and_then(|file| parse_calibration(&file));
    let (calibration, unit) = calibration.map_err(Failure::work)?;
    Ok(FrameReader::Displacements {
        calibration: Box::new(calibration),
        unit,
        px_per_rad: args.px_per_rad,
        options: Box::new(press_options(&given, like, Some(unit), true)?),
    })
}
