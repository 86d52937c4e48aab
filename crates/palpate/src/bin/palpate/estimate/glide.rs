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
use crate::output::{self, Guard, Single};

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let map_file = place_of_map(args)?;
    let readings = read_glide(&args.readings).map_err(Failure::work)?;
    let options = options(args, &readings)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    let json = output::json(&estimate)?;
    let Some(map_file) = map_file else {
        return output::print(&json);
    };
    map_file.write(map.to_csv().as_bytes())?;
    map_file.print(&json)
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

/// Place of the map, whose directory must be there.
fn place_of_map(args: &EstimateGlideArgs) -> Result<Option<Single>, Failure> {
    let Some(file) = &args.map else {
        return Ok(None);
    };
    let inputs = [&args.readings].into_iter().chain(&args.like.like);
    let place = Single::new("--map", file, Guard::new(inputs, args.force))?;
    match file.parent() {
        Some(dir) if dir != Path::new("") && !dir.is_dir() => {
            let (file, dir) = (file.display(), dir.display());
            Err(Failure::Work(anyhow!("--map {file}: no directory {dir}")))
        }
        _ => Ok(Some(place)),
    }
}
