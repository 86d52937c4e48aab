//! Implements the command `palpate estimate roll`.

use palpate_recorded::{Form, RollOptions, estimate_roll, parse_roll};

use super::like::Like;
use super::table::{form, shown, table, warn};
use crate::cli::EstimateRollArgs;
use crate::failure::Failure;
use crate::output;

pub(crate) fn roll(args: &EstimateRollArgs) -> Result<(), Failure> {
    let like = Like::of(&args.like)?;
    let form = Form {
        rotation_frame: args.rotation_frame,
        ..form(&args.form, like.as_ref())
    };
    let file = table(&args.readings, form)?;
    let readings = parse_roll(file).map_err(Failure::work)?;
    let unit = readings.unit.or(args.form.length_unit);
    let base = like.map(|like| like.options(unit, palpate::study_options::roll));
    let given = args.rolls.and(&args.estimator);
    let options = RollOptions::with_settings(base.transpose()?, &given, args.form.length_unit);
    let options = options.map_err(Failure::usage)?;
    let estimate = estimate_roll(readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&shown(&estimate, args.json)?)
}
