//! `palpate estimate`.

mod press;

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    GlideMethod, GlideOptions, RollMethod, RollOptions, ShapeThresholds, estimate_glide,
    estimate_roll, read_glide, read_roll,
};

use crate::cli::{EstimateGlideArgs, EstimateRollArgs, Method};
use crate::failure::Failure;
use crate::output;

pub(crate) use press::{press, press_options};

pub(crate) fn roll(args: &EstimateRollArgs) -> Result<(), Failure> {
    let readings = read_roll(&args.readings).map_err(Failure::work)?;
    let options = RollOptions {
        probe_radius: args.probe_radius,
        length_unit: args.length_unit,
        pitch: args.pitch,
        method: match args.method {
            Method::LeastSquares => RollMethod::LeastSquares,
        },
    };
    let estimate = estimate_roll(&readings, &options).map_err(Failure::work)?;
    output::print(&output::json(&estimate)?)
}

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let options = glide_options(args)?;
    let map_file = args.map.as_deref().map(place_of_map).transpose()?;
    let readings = read_glide(&args.readings).map_err(Failure::work)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    let json = output::json(&estimate)?;
    if let Some((dir, name)) = map_file {
        output::write_files(dir, &[(name, map.to_csv())])?;
    }
    output::print(&json)
}

fn glide_options(args: &EstimateGlideArgs) -> Result<GlideOptions, Failure> {
    for (option, value) in [
        ("--position-std", args.position_std),
        ("--normal-std-deg", args.normal_std_deg),
    ] {
        if args.method == GlideMethod::TwoPass && value.is_some() {
            let message =
                "is of no use to two-pass, which is told by its weight and smoothing sums";
            return Err(Failure::Usage(anyhow!("{option} {message}")));
        }
    }
    if args.method != GlideMethod::TwoPass && args.inter_finger_distance.is_some() {
        let message = "--inter-finger-distance is of use only to --method two-pass";
        return Err(Failure::Usage(anyhow!(message)));
    }
    let thresholds = args.gaussian_threshold.zip(args.mean_threshold);
    let defaults = GlideOptions::default();
    Ok(GlideOptions {
        method: args.method,
        length_unit: args.length_unit,
        outward: args.outward.map_or(defaults.outward, |outward| outward.0),
        grid: args.grid as usize,
        map_at_contacts: args.at_contacts,
        thresholds: thresholds
            .map(|(gaussian, mean)| ShapeThresholds::new(gaussian, mean))
            .transpose()
            .map_err(Failure::usage)?,
        position_std: args.position_std,
        normal_std_rad: args.normal_std_deg.map(f64::to_radians),
        inter_finger_distance: args.inter_finger_distance,
    })
}

/// The directory and the name of the map's file.
fn place_of_map(file: &Path) -> Result<(&Path, &str), Failure> {
    let shown = file.display();
    let Some(name) = file.file_name().and_then(|name| name.to_str()) else {
        return Err(Failure::Usage(anyhow!("--map {shown}: is not a file name")));
    };
    let dir = match file.parent() {
        Some(dir) if dir != Path::new("") => dir,
        _ => Path::new("."),
    };
    if dir.is_dir() {
        return Ok((dir, name));
    }
    let dir = dir.display();
    Err(Failure::Work(anyhow!("--map {shown}: no directory {dir}")))
}
