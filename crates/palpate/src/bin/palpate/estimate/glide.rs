//! `palpate estimate glide`.

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    GlideOptions, GlideReadings, ShapeThresholds, estimate_glide, read_glide,
};
use palpate_study::config::GlideEstimatorConfig;

use super::like::like;
use super::warned::warn;
use crate::cli::EstimateGlideArgs;
use crate::failure::Failure;
use crate::output;

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let map_file = args.map.as_deref().map(place_of_map).transpose()?;
    let readings = read_glide(&args.readings).map_err(Failure::work)?;
    let options = options(args, &readings)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    let json = output::json(&estimate)?;
    if let Some((dir, name)) = map_file {
        output::write_files(dir, &[(name, map.to_csv())])?;
    }
    output::print(&json)
}

fn options(args: &EstimateGlideArgs, readings: &GlideReadings) -> Result<GlideOptions, Failure> {
    let unit = readings.unit().or(args.length_unit);
    let base = like(&args.like, unit, GlideOptions::like)?.unwrap_or_default();
    let estimator = args.estimator.over(&base.estimator)?;
    estimator
        .check()
        .map_err(|message| Failure::Usage(anyhow!("--gamma: {message}")))?;
    let is_two_pass = matches!(estimator, GlideEstimatorConfig::TwoPass { .. });
    if args.inter_finger_distance.is_some() && !is_two_pass {
        let message = "--inter-finger-distance is of use only to --method two-pass";
        return Err(Failure::Usage(anyhow!(message)));
    }
    if args.outward.is_some() && readings.has_normals() {
        let message = "--outward is of use only to readings without normals";
        return Err(Failure::Usage(anyhow!(message)));
    }
    if args.estimator.given.contains_key("normal_std_deg") && !readings.has_normals() {
        let message = "--normal-std-deg is of use only to readings with normals";
        return Err(Failure::Usage(anyhow!(message)));
    }
    let thresholds = args.gaussian_threshold.zip(args.mean_threshold);
    let thresholds = thresholds
        .map(|(gaussian, mean)| ShapeThresholds::new(gaussian, mean))
        .transpose()
        .map_err(Failure::usage)?;
    Ok(GlideOptions {
        estimator,
        length_unit: args.length_unit.or(base.length_unit),
        outward: args.outward.map_or(base.outward, |outward| outward.0),
        grid: args.grid as usize,
        map_at_contacts: args.at_contacts,
        thresholds: thresholds.or(base.thresholds),
        inter_finger_distance: args.inter_finger_distance.or(base.inter_finger_distance),
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
