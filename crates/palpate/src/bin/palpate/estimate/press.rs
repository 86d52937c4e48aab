//! `palpate estimate press`.

use palpate_recorded::{
    PictureOptions, PressGiven, PressOptions, Wording, estimate_press, parse_press,
};
use palpate_study::config::LengthUnit;

use super::like::Like;
use super::table::{form, table};
use super::warned::warn;
use crate::cli::{EstimatePressArgs, SensorArgs};
use crate::failure::Failure;
use crate::output;

pub(crate) fn press(args: &EstimatePressArgs) -> Result<(), Failure> {
    let like = Like::of(&args.sensor.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_press(file).map_err(Failure::work)?;
    let unit = readings.unit().or(args.form.length_unit);
    let options = press_options(&args.sensor, like.as_ref(), unit)?;
    let options = PressOptions {
        radial_scale: args.radial_scale,
        length_unit: args.form.length_unit.or(options.length_unit),
        ..options
    };
    let fits = given(&args.sensor).fits(&readings, Wording::Flags);
    fits.map_err(Failure::usage)?;
    let estimate = estimate_press(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&output::json(&estimate)?)
}

/// Options of the estimator in the readings' unit, after a check that the arguments fit together.
pub(crate) fn press_options(
    args: &SensorArgs,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
) -> Result<PressOptions, Failure> {
    let base = like.map(|like| like.options(unit, palpate::study_options::press));
    PressOptions::given(&given(args), base.transpose()?, Wording::Flags).map_err(Failure::usage)
}

/// Options of a fit of pictures in this unit, likewise.
pub(crate) fn picture_options(
    args: &SensorArgs,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
) -> Result<PictureOptions, Failure> {
    let base = like.map(|like| like.options(unit, palpate::study_options::pictures));
    let options = PictureOptions::given(&given(args), base.transpose()?, Wording::Flags);
    options.map_err(Failure::usage)
}

fn given(args: &SensorArgs) -> PressGiven {
    PressGiven {
        sensor_radius: args.sensor_radius,
        depth: args.depth,
        estimator: args.estimator.given.clone(),
        indentation: args.indentation,
        normal_std: args.normal_std,
        tangential_std: args.tangential_std,
        young: args.young,
        ..PressGiven::default()
    }
}
