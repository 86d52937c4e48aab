//! Implements the command `palpate estimate press`.

use palpate_recorded::{PictureOptions, PressOptions, estimate_press, parse_press};
use palpate_study::config::LengthUnit;
use serde_json::{Map, Value as Json};

use super::like::Like;
use super::table::{form, shown, table, warn};
use crate::cli::EstimatePressArgs;
use crate::failure::Failure;
use crate::output;

pub(crate) fn press(args: &EstimatePressArgs) -> Result<(), Failure> {
    let like = Like::of(&args.sensor.like)?;
    let file = table(&args.readings, form(&args.form, like.as_ref()))?;
    let readings = parse_press(file).map_err(Failure::work)?;
    let unit = readings.unit.or(args.form.length_unit);
    let mut given = args.sensor.presses.and(&args.sensor.estimator);
    given.insert("radial_scale".to_owned(), args.radial_scale.into());
    let mut options = press_options(&given, like.as_ref(), unit, readings.has_tangential())?;
    options.length_unit = args.form.length_unit.or(options.length_unit);
    let estimate = estimate_press(&readings, &options).map_err(Failure::work)?;
    warn(&estimate)?;
    output::print(&shown(&estimate, args.json)?)
}

/// Options of the estimate of a press, from flags and from the study of `--like`. Lengths are in the readings' unit.
pub(crate) fn press_options(
    given: &Map<String, Json>,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
    has_tangential: bool,
) -> Result<PressOptions, Failure> {
    let base = like.map(|like| like.options(unit, palpate::study_options::press));
    let options = PressOptions::with_settings(base.transpose()?, given, None, has_tangential);
    options.map_err(Failure::usage)
}

/// Options of the fit of a press to camera frames, from flags and from the study of `--like`. Lengths are in `unit`.
pub(crate) fn picture_options(
    given: &Map<String, Json>,
    like: Option<&Like>,
    unit: Option<LengthUnit>,
) -> Result<PictureOptions, Failure> {
    let base = like.map(|like| like.options(unit, PictureOptions::from_study));
    PictureOptions::with_settings(base.transpose()?, given).map_err(Failure::usage)
}
