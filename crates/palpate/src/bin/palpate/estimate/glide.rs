//! `palpate estimate glide`.

use std::path::Path;

use anyhow::anyhow;
use palpate_scene::recorded::{
    GlideOptions, GlideReadings, ShapeThresholds, estimate_glide, parse_glide,
};
use palpate_study::config::GlideEstimatorConfig;

use super::like::Like;
use super::table::{form, table};
use super::warned::warn;
use crate::cli::EstimateGlideArgs;
use crate::failure::Failure;
use crate::output::{self, Guard, Single};

pub(crate) fn glide(args: &EstimateGlideArgs) -> Result<(), Failure> {
    let map_file = place_of_map(args)?;
    let like = Like::of(&args.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_glide(file).map_err(Failure::work)?;
    let options = options(args, like, &readings)?;
    let (estimate, map) = estimate_glide(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    let json = output::json(&estimate)?;
    let Some(map_file) = map_file else {
        return output::print(&json);
    };
    map_file.write(map.to_csv().as_bytes())?;
    map_file.print(&json)
}

fn options(
    args: &EstimateGlideArgs,
    like: Option<Like>,
    readings: &GlideReadings,
) -> Result<GlideOptions, Failure> {
    let unit = readings.unit().or(args.form.length_unit);
    let base = like.map(|like| like.options(unit, GlideOptions::like));
    let base = base.transpose()?.unwrap_or_default();
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
        length_unit: args.form.length_unit.or(base.length_unit),
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
