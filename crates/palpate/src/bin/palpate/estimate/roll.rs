//! `palpate estimate roll`.

use anyhow::anyhow;
use palpate_scene::recorded::{ReadingNoise, RollOptions, estimate_roll, parse_roll};

use super::like::Like;
use super::table::{form, table};
use super::warned::warn;
use crate::cli::EstimateRollArgs;
use crate::failure::Failure;
use crate::output;

pub(crate) fn roll(args: &EstimateRollArgs) -> Result<(), Failure> {
    let like = Like::of(&args.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_roll(file).map_err(Failure::work)?;
    let unit = readings.unit().or(args.form.length_unit);
    let base = like.map(|like| like.options(unit, RollOptions::like));
    let base = base.transpose()?;
    let base = base.unwrap_or_else(|| RollOptions::new(args.probe_radius.unwrap_or_default()));
    let probe_radius = args.probe_radius.unwrap_or(base.probe_radius);
    let refused = |error| Failure::Usage(anyhow!("--{error}"));
    let shifts = match (args.pitch, args.shift_std) {
        (Some(pitch), _) => RollOptions::noise_of_pads(probe_radius, pitch).map_err(refused)?,
        (None, Some(shift_std)) => {
            RollOptions::noise_of_shifts(probe_radius, shift_std).map_err(refused)?
        }
        (None, None) => base.noise,
    };
    let rotations = base.noise;
    let options = RollOptions {
        probe_radius,
        estimator: args.estimator.over(&base.estimator)?,
        noise: ReadingNoise {
            rotation_std_rad: args.rotation_std_rad.unwrap_or(rotations.rotation_std_rad),
            relative_rotation_std: args
                .relative_rotation_std
                .unwrap_or(rotations.relative_rotation_std),
            ..shifts
        },
        length_unit: args.form.length_unit.or(base.length_unit),
    };
    let estimate = estimate_roll(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&output::json(&estimate)?)
}
