//! `palpate estimate`.

use palpate_scene::recorded::{RollMethod, RollOptions, estimate_roll, read_roll};

use crate::cli::{EstimateRollArgs, Method};
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
