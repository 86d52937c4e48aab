//! `palpate estimate`.

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    GlideMethod, GlideOptions, RollMethod, RollOptions, ShapeThresholds, estimate_glide,
    estimate_roll, read_glide, read_roll,
};

use crate::cli::{EstimateGlideArgs, EstimateRollArgs, Method, PatchMethod};
use crate::failure::Failure;
use crate::output;

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
    output::print(&serde_json::to_string_pretty(&estimate).map_err(Failure::work)?)
}

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let options = glide_options(args)?;
    let readings = read_glide(&args.readings).map_err(Failure::work)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    let json = serde_json::to_string_pretty(&estimate).map_err(Failure::work)?;
    if let Some(file) = &args.map {
        write_map(file, map.to_csv())?;
    }
    output::print(&json)
}

fn glide_options(args: &EstimateGlideArgs) -> Result<GlideOptions, Failure> {
    for (option, value) in [
        ("--position-std", args.position_std),
        ("--normal-std-deg", args.normal_std_deg),
    ] {
        if args.method == PatchMethod::TwoPass && value.is_some() {
            let message =
                "is of no use to two-pass, which is told by its weight and smoothing sums";
            return Err(Failure::Usage(anyhow!("{option} {message}")));
        }
    }
    let thresholds = args.gaussian_threshold.zip(args.mean_threshold);
    let defaults = GlideOptions::default();
    Ok(GlideOptions {
        method: match args.method {
            PatchMethod::Penalised => GlideMethod::Penalised,
            PatchMethod::TwoPass => GlideMethod::TwoPass,
            PatchMethod::Quadric => GlideMethod::Quadric,
        },
        length_unit: args.length_unit,
        outward: args.outward.map_or(defaults.outward, |outward| outward.0),
        grid: args.grid as usize,
        thresholds: thresholds
            .map(|(gaussian, mean)| ShapeThresholds::new(gaussian, mean))
            .transpose()
            .map_err(Failure::usage)?,
        position_std: args.position_std,
        normal_std_rad: args.normal_std_deg.map(f64::to_radians),
    })
}

fn write_map(file: &Path, csv: String) -> Result<(), Failure> {
    let name = file.file_name().and_then(|name| name.to_str());
    let Some(name) = name else {
        return Err(Failure::Usage(anyhow!(
            "--map {}: is not a file name",
            file.display()
        )));
    };
    let dir = match file.parent() {
        Some(dir) if dir != Path::new("") => dir,
        _ => Path::new("."),
    };
    output::write_files(dir, &[(name, csv)])
}
