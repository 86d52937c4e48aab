//! Implements the command `palpate sensor calibrate`.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use palpate_recorded::{
    CalibrateOptions, CalibrationPoints, Frame, KnownDisplacements, RecordedFile,
    calibrate as calibrate_to, calibrate_camera, calibration_toml, frame_calibration_points,
};

use palpate_study::config;

use crate::cli::CalibrateArgs;
use crate::estimate::table;
use crate::failure::Failure;
use crate::output::{self, Guard, OutputFile};

pub(crate) fn calibrate(args: &CalibrateArgs) -> Result<(), Failure> {
    if let (Some(rest), Some(layout)) = (&args.rest, &args.layout) {
        return camera(args, rest, layout);
    }
    let guard = Guard::new(&args.inputs, args.force);
    let out = OutputFile::new("--out", &args.out, guard)?;
    let shows_frames = shows_frames(args)?;
    let (points, markers) = if shows_frames {
        points_of_frames(args)?
    } else {
        let points: Result<_, _> = args
            .inputs
            .iter()
            .map(|path| {
                let file = table(path, args.form.form())?;
                CalibrationPoints::try_from(&file).map_err(Failure::work)
            })
            .collect();
        (points?, None)
    };
    let options = CalibrateOptions {
        from: args.from,
        per_marker: args.per_marker,
        markers,
        length_unit: args.form.length_unit,
    };
    let report = calibrate_to(&points, &options).map_err(Failure::work)?;
    out.write(calibration_toml(&report.calibration, report.length_unit).as_bytes())?;
    for warning in report.warnings() {
        output::print_note(warning);
    }
    let mut lines = report.summary();
    lines.push(format!("-> {}", args.out.display()));
    out.print(&lines.join("\n"))
}

/// Estimates position, rotation and scale of a camera from a frame at rest.
fn camera(args: &CalibrateArgs, rest: &PathBuf, layout: &PathBuf) -> Result<(), Failure> {
    let out = OutputFile::new("--out", &args.out, Guard::new([rest, layout], args.force))?;
    let study = config::load(layout).map_err(Failure::usage)?;
    let Ok(cell) = study.cell(args.cell) else {
        return Err(Failure::no_cell(args.cell, &study));
    };
    let frame = read_frame(rest, args.srgb)?.central_square();
    let camera = calibrate_camera(&frame, &cell.config).map_err(|error| {
        let linear = (!args.srgb).then(|| calibrate_camera(&frame.linearised(), &cell.config));
        match linear {
            Some(Ok(_)) => Failure::work(anyhow!("{error}; with setting `srgb` the frame fits")),
            _ => Failure::work(error),
        }
    })?;
    out.write(camera.to_toml().as_bytes())?;
    for warning in &camera.warnings {
        output::print_note(warning);
    }
    let lines = [camera.summary(), format!("-> {}", args.out.display())];
    out.print(&lines.join("\n"))
}

/// Reads a frame from an image file. If `srgb` is true, its sRGB pixels are converted to values that are proportional
/// to the light.
pub(super) fn read_frame(path: &Path, srgb: bool) -> Result<Frame, Failure> {
    let frame = RecordedFile::read(path).and_then(|file| Frame::try_from(&file));
    let frame = frame.map_err(Failure::work)?;
    Ok(if srgb { frame.linearised() } else { frame })
}

fn is_frame(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let extension = extension.unwrap_or_default().to_lowercase();
    matches!(
        extension.as_str(),
        "png" | "jpg" | "jpeg" | "bmp" | "tif" | "tiff" | "webp"
    )
}

/// Whether the inputs are camera frames (true) or tables (false). Rejects options that have no effect on this kind of
/// input.
fn shows_frames(args: &CalibrateArgs) -> Result<bool, Failure> {
    let refuse = |message: String| Err(Failure::Usage(anyhow!(message)));
    let frames = args.inputs.iter().filter(|path| is_frame(path)).count();
    let is_known = args.normal.is_some() || args.tangential.is_some();
    if frames == 0 && !is_known {
        if args.px_per_rad.is_some() {
            return refuse("--px-per-rad has an effect only with frames".to_owned());
        }
        return Ok(false);
    }
    if frames > 0 && frames < args.inputs.len() {
        return refuse(format!(
            "{frames} of the {} inputs are images; give tables or frames, not both",
            args.inputs.len()
        ));
    }
    if let Some(flag) = args.form.given() {
        return refuse(format!("{flag} has an effect only with tables"));
    }
    if !is_known {
        return refuse("frames need --normal D,D,... or --tangential D,D,...: a displacement of the marker under the contact for each but the first".to_owned());
    }
    let pressed = args.inputs.len() - 1;
    for (option, known) in [
        ("--normal", &args.normal),
        ("--tangential", &args.tangential),
    ] {
        if let Some(known) = known.as_ref().filter(|known| known.len() != pressed) {
            return refuse(format!(
                "{option} has {} displacements; there are {pressed} pressed frames after the one at rest",
                known.len()
            ));
        }
    }
    Ok(true)
}

fn points_of_frames(
    args: &CalibrateArgs,
) -> Result<(Vec<CalibrationPoints>, Option<usize>), Failure> {
    let known = KnownDisplacements {
        normal: args.normal.clone(),
        tangential: args.tangential.clone(),
        from: args.from,
        px_per_rad: args.px_per_rad,
    };
    let frames = args.inputs.iter().map(|path| read_frame(path, args.srgb));
    let frames: Vec<Frame> = frames.collect::<Result<_, _>>()?;
    let Some((rest, pressed)) = frames.split_first() else {
        return Err(Failure::Usage(anyhow!("there are no frames")));
    };
    let (points, markers) =
        frame_calibration_points(rest, pressed, &known).map_err(Failure::work)?;
    Ok((vec![points], Some(markers)))
}
