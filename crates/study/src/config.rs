//! Study configs: TOML text in, validated cells out.
//!
//! A config passes through four steps, each with its own file:
//!
//! 1. `tree`: the text becomes a tree in which every key and value knows its bytes;
//! 2. `sweep`, `grid`: the `[[sweep]]` axes multiply; a cell is the tree with one combination of values put in;
//! 3. `validate`: each cell's tree (of a study of many cells: those of a `sample`, and every swept value) is walked against the JSON Schema of the config ([`schema()`]), the one place where
//!    keys, types, kinds and limits are known;
//! 4. the tree becomes a [`StudyConfig`], and the few rules that join several fields are checked.
//!
//! Whatever fails becomes a [`ConfigError`] with file, line, column, field and an excerpt.

mod edit;
mod error;
mod field;
mod fingertip;
mod flat;
mod glide;
mod grid;
mod length_unit;
mod load;
mod located;
mod model;
mod object;
mod output;
mod overrides;
mod pads;
mod plot;
mod press;
mod resolved;
mod roll;
mod sample;
mod schema;
mod settings;
mod study;
mod sweep;
mod tree;
mod validate;
mod vary;

pub use edit::{of_json, with_axes, with_fields};
pub use error::ConfigError;
pub use field::field;
pub use fingertip::{BareFingertipConfig, LensConfig, LensName, ViewConfig};
pub use glide::{
    CriterionName, EvaluateConfig, FingertipConfig, GlideConfig, GlideEstimatorConfig,
    GlideModelConfig, GlideMotionConfig, GlideNoiseConfig, GlideSensorConfig, NoiseAxis,
    NormalNoise, NormalsOf, PositionNoise, Reports,
};
pub use length_unit::LengthUnit;
pub use load::{Cell, Study, SweptKind, load, parse, plots};
pub use model::ModelConfig;
pub use object::ObjectConfig;
pub use output::Output;
pub use pads::{PadLayout, PadOffset};
pub use plot::{
    Component, Mark, MarkAxis, PlotConfig, PlotKind, Points, STATISTICS, STD_BOUND, Scale,
};
pub use press::{
    Baseline, CalibrationConfig, CameraConfig, CentroidNoise, DiscsConfig, GainNoise, HueNoise,
    Indentation, LayoutConfig, LayoutTable, LengthNoise, LostMarkers, NamedLayout, NoiseKnown,
    NormalFrom, PixelNoise, PressConfig, PressEstimatorConfig, PressModelConfig, PressMotionConfig,
    PressNoiseConfig, PressObjectConfig, PressPriors, PressProbeConfig, PressSensorConfig,
    SensorNoise, ShownMarkers, SizeNoise, WrongMarkers,
};
pub use resolved::to_toml;
pub use roll::{
    AngularVelocityNoise, Chart, EncoderConfig, ProbeConfig, RollAxis, RollConfig,
    RollEstimatorConfig, RollModelConfig, RollMotionConfig, RollNoiseConfig, RollSensorConfig,
    Side, When,
};
pub use schema::schema;
pub use settings::{Accepts, Range, Setting, SettingError, in_unit, settings, with_settings};
pub use study::{SceneConfig, StopConfig, StopStatistic, StudyConfig};
pub use sweep::{RangeConfig, Sample, Spacing, SweepConfig};
pub use vary::{Takes, Varied, Vary, VaryError};
