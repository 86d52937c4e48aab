//! Study configs: from a TOML text to validated cells.
//!
//! A config passes through four steps, each with its own file:
//!
//! 1. `tree`: the text is parsed to a tree of values. Errors name paths in it; `error` finds their place in the text.
//! 2. `sweep`, `grid`: the `[[sweep]]` axes are multiplied. A cell is the tree with one combination of values.
//! 3. `validate`: each cell's tree is validated by the JSON Schema of the config ([`schema()`]), which alone defines keys,
//!    types, kinds and limits. In a study of many cells, only the cells of a `sample` and every swept value are validated.
//! 4. serde converts the tree to a [`StudyConfig`], and the few rules that concern several fields are checked.
//!
//! Every failure is a [`ConfigError`] with file, line, column, field and an excerpt.

mod config_builder;
mod config_output;
mod error;
mod error_location;
mod field;
mod field_path;
mod field_value;
mod glide;
mod glide_estimator;
mod grid;
mod load;
mod marker_sensor;
mod object;
mod plot;
mod press;
mod press_estimator;
mod roll;
mod sample;
mod schema;
mod setting_list;
mod study;
mod sweep;
mod tree;
mod validate;
mod vary;

pub use config_builder::{of_json, with_axes, with_fields};
pub use config_output::to_toml;
pub use error::{ConfigError, FieldError};
pub use field::field;
pub use glide::{
    EvaluateConfig, FingertipConfig, GlideConfig, GlideModelConfig, GlideMotionConfig,
    GlideNoiseConfig, GlideSensorConfig, NoiseAxis, NormalNoise, PositionNoise, Reports,
};
pub use glide_estimator::{CriterionName, GlideEstimatorConfig, NormalsOf};
pub use load::{Cell, Study, load, parse, plots};
pub use marker_sensor::{
    BareFingertipConfig, CalibrationConfig, CameraConfig, DiscsConfig, LayoutConfig, LayoutTable,
    LensConfig, LensName, NamedLayout, NormalFrom, PressProbeConfig, PressSensorConfig,
    ShownMarkers, ViewConfig,
};
pub use object::ObjectConfig;
pub use plot::{
    Component, Mark, MarkAxis, PlotConfig, PlotKind, Points, STATISTICS, STD_BOUND, Scale,
};
pub use press::{
    CentroidNoise, GainNoise, HueNoise, LengthNoise, LostMarkers, PixelNoise, PressConfig,
    PressModelConfig, PressMotionConfig, PressNoiseConfig, PressObjectConfig, SensorNoise,
    SizeNoise, WrongMarkers,
};
pub use press_estimator::{Baseline, Indentation, NoiseKnown, PressEstimatorConfig, PressPriors};
pub use roll::{
    AngularVelocityNoise, Chart, EncoderConfig, PadLayout, PadOffset, ProbeConfig, RollAxis,
    RollConfig, RollEstimatorConfig, RollModelConfig, RollMotionConfig, RollNoiseConfig,
    RollSensorConfig, Side, When,
};
pub use schema::schema;
pub use setting_list::{
    Accepts, Range, Setting, SettingError, in_unit, rename_settings, setting, settings,
    split_settings, with_settings,
};
pub use study::{
    LengthUnit, ModelConfig, Output, SceneConfig, StopConfig, StopStatistic, StudyConfig,
};
pub use sweep::{RangeConfig, Sample, Spacing, SweepConfig};
pub use vary::{Takes, Varied, Vary, VaryError};
