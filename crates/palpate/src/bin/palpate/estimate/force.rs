//! Implements the command `palpate estimate force`.

use palpate_recorded::{LoadOptions, estimate_force, parse_load_curve};

use super::table::{form, table, warn};
use crate::cli::EstimateForceArgs;
use crate::failure::Failure;
use crate::output;

pub(crate) fn force(args: &EstimateForceArgs) -> Result<(), Failure> {
    let options = LoadOptions {
        modulus_kpa: args.modulus_kpa,
        modulus_std_kpa: args.modulus_std_kpa,
        poisson: args.poisson,
        sensor_radius: args.sensor_radius,
        force_std_n: args.force_std_n,
        length_unit: args.form.length_unit,
    };
    options.check().map_err(Failure::usage)?;
    let file = table(&args.readings, form(&args.form, None))?;
    let curve = parse_load_curve(file).map_err(Failure::work)?;
    let estimate = estimate_force(&curve, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&output::json(&estimate)?)
}
