//! Makes the command-line flags for the settings of estimators and readings: one flag for each key of the config.

use std::fmt::Debug;
use std::marker::PhantomData;

use clap::builder::{
    PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser, ValueParser,
};
use clap::error::Error;
use clap::{Arg, ArgGroup, ArgMatches, Args, Command, FromArgMatches, Id};
use palpate_recorded::{GlideOptions, PressOptions, RollSettings};
use palpate_study::config::infinite_length::json_number;
use palpate_study::config::{
    Accepts, GlideEstimatorConfig, LengthUnit, PressEstimatorConfig, Range, RollEstimatorConfig,
    Setting, settings,
};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};

use crate::failure::{flag, with_flags};

/// A table of a config whose keys are available as command-line flags. The flag `--method` sets the key `kind`.
pub(crate) trait Flagged:
    Default + Serialize + DeserializeOwned + JsonSchema + 'static
{
    const GROUP: &'static str;
    /// Keys that have no flag of their own, for example because the command already has another flag with this name.
    const NO_FLAGS: &'static [&'static str] = &[];
}

impl Flagged for RollEstimatorConfig {
    const GROUP: &'static str = "roll estimator";
    // No flag is generated for the key `start`, because `RollSettings` already has a flag `--start`, which states the
    // place where rolls start.
    const NO_FLAGS: &'static [&'static str] = &["start"];
}

impl Flagged for GlideEstimatorConfig {
    const GROUP: &'static str = "glide estimator";
}

impl Flagged for PressEstimatorConfig {
    const GROUP: &'static str = "press estimator";
    // No flag is generated for the key `indentation`, because `PressOptions` already has a flag of this name.
    const NO_FLAGS: &'static [&'static str] = &["indentation"];
}

impl Flagged for RollSettings {
    const GROUP: &'static str = "rolls";
}

impl Flagged for GlideOptions {
    const GROUP: &'static str = "glides";
}

impl Flagged for PressOptions {
    const GROUP: &'static str = "presses";
    // The setting `radial_scale` applies only to tables of readings, so it is not a flag of `sensor track`.
    const NO_FLAGS: &'static [&'static str] = &["radial_scale"];
}

/// Settings that the user gave as flags. `given` maps the key of each setting to its value.
#[derive(Clone, Debug)]
pub(crate) struct Settings<T> {
    pub(crate) given: Map<String, Json>,
    of: PhantomData<T>,
}

impl<T> Settings<T> {
    pub(crate) fn flag(&self) -> Option<String> {
        let key = self.given.keys().next()?;
        Some(format!("--{}", flag(key)))
    }

    pub(crate) fn and<U>(&self, others: &Settings<U>) -> Map<String, Json> {
        let mut all = self.given.clone();
        all.extend(others.given.clone());
        all
    }
}

fn flagged<T: Flagged>() -> impl Iterator<Item = Setting> {
    let all = settings::<T>().into_iter();
    all.filter(|setting| !T::NO_FLAGS.contains(&setting.key.as_str()))
}

/// Kind of estimator that is used if the user does not give `--method`; `None` if the table has no key `kind`.
fn default_kind<T: Flagged>() -> Option<String> {
    let default = serde_json::to_value(T::default()).ok()?;
    default["kind"].as_str().map(str::to_owned)
}

fn argument(setting: &Setting, all_kinds: usize, default: Option<String>) -> Arg {
    let flag = flag(&setting.key);
    let only = match setting.kinds.len() < all_kinds {
        true => format!(" (--method {})", setting.kinds.join(" or ")),
        false => String::new(),
    };
    let default = default.map_or(String::new(), |default| format!(" [default: {default}]"));
    let help = with_flags(setting.help.trim_end_matches('.'));
    let (name, parser) = match &setting.accepts {
        Accepts::Number(range) => {
            let (range, is_whole) = (*range, range.is_whole);
            let parser = StringValueParser::new().try_map(move |text| {
                range.parse(&text).map(|number| match is_whole {
                    true => Json::from(number as u64),
                    false => json_number(number),
                })
            });
            let name = match (is_whole, setting.is_length) {
                (true, _) => "N",
                (false, true) => "LENGTH",
                (false, false) => "X",
            };
            (name.to_owned(), ValueParser::new(parser))
        }
        Accepts::Word(words) => {
            let words = words.iter().map(|(word, help)| {
                PossibleValue::new(word.clone()).help(help.trim_end_matches('.').to_owned())
            });
            let parser = PossibleValuesParser::new(words).map(Json::String);
            (flag.to_uppercase(), ValueParser::new(parser))
        }
        &Accepts::Vector(size) => {
            let name = if size == 2 { "U,V" } else { "X,Y,Z" };
            let parser = StringValueParser::new()
                .try_map(move |text| vector(&text, size, name).map(Json::from));
            (name.to_owned(), ValueParser::new(parser))
        }
    };
    Arg::new(setting.key.clone())
        .long(flag)
        .help(format!("{help}{only}{default}"))
        .value_name(name)
        .value_parser(parser)
        .allow_negative_numbers(true)
        .allow_hyphen_values(matches!(setting.accepts, Accepts::Vector(_)))
}

impl<T: Flagged> Args for Settings<T> {
    fn group_id() -> Option<Id> {
        Some(Id::from(T::GROUP))
    }

    fn augment_args(command: Command) -> Command {
        let kinds = flagged::<T>().next().map_or(0, |kind| kind.kinds.len());
        let arguments: Vec<Arg> = flagged::<T>()
            .map(|setting| {
                let default = match setting.key.as_str() {
                    "kind" => default_kind::<T>(),
                    _ => setting.default.clone(),
                };
                argument(&setting, kinds, default)
            })
            .collect();
        let ids = arguments.iter().map(Arg::get_id).cloned();
        let group = ArgGroup::new(T::GROUP).multiple(true).args(ids);
        command.args(arguments).group(group)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<T: Flagged> FromArgMatches for Settings<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let given = flagged::<T>().filter_map(|setting| {
            let value = matches.get_one::<Json>(&setting.key)?;
            Some((setting.key, value.clone()))
        });
        Ok(Self {
            given: given.collect(),
            of: PhantomData,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

const POSITIVE: Range = Range {
    above: Some(0.0),
    least: None,
    most: None,
    is_whole: false,
    may_be_infinite: false,
};

pub(super) fn positive(text: &str) -> Result<f64, String> {
    POSITIVE.parse(text)
}

pub(super) fn radius(text: &str) -> Result<f64, String> {
    let range = Range {
        may_be_infinite: true,
        ..POSITIVE
    };
    range.parse(text)
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    let range = Range {
        above: None,
        least: Some(0.0),
        ..POSITIVE
    };
    range.parse(text)
}

/// Parses `size` numbers, separated by commas. Error messages show `name` as the expected form.
pub(super) fn vector(text: &str, size: usize, name: &str) -> Result<Vec<f64>, String> {
    let number = |part: &str| {
        let number = part
            .trim()
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| format!("`{part}` is not a number"))
    };
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match numbers.len() {
        count if count == size => Ok(numbers),
        count => Err(format!("needs {size} numbers, {name}; has {count}")),
    }
}

pub(super) fn length_unit(text: &str) -> Result<LengthUnit, String> {
    use LengthUnit::{Cm, M, Mm, Um, Unit};
    [M, Cm, Mm, Um, Unit]
        .into_iter()
        .find(|unit| unit.as_str() == text)
        .ok_or_else(|| "must be one of m, cm, mm, um, unit".to_owned())
}
