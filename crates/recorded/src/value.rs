//! Values with their uncertainty, as in the JSON of an estimate.

use std::borrow::Cow;

use palpate_press::Estimated;
use palpate_statistics::NORMAL_95;
use palpate_study::Unit;
use palpate_study::config::LengthUnit;
use serde::Serialize;

/// Version of the JSON format of estimates from recorded readings. It increases when a key is removed or changes its
/// meaning, not when a key is added.
pub(super) const FORMAT_VERSION: u32 = 2;

/// A value with its standard error, its interval and its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// The estimated value; `None` if the readings do not determine it.
    pub value: Option<f64>,
    /// Standard error of the value; `None` if the noise is unknown.
    pub std: Option<f64>,
    /// 95 % interval of the value; `None` if there is no standard error. An end is `None` if the readings do not bound
    /// the value on that side.
    pub interval95: Option<[Option<f64>; 2]>,
    /// Unit of the value, the standard error and the interval.
    pub unit: Cow<'static, str>,
}

impl Value {
    pub(super) fn new(value: f64, std: Option<f64>, power: Unit, length: LengthUnit) -> Self {
        Self::within(value, std, NORMAL_95, power, length)
    }

    pub(super) fn bare(value: f64, unit: impl Into<Cow<'static, str>>) -> Self {
        Self {
            value: Some(value + 0.0),
            std: None,
            interval95: None,
            unit: unit.into(),
        }
    }

    /// A value that the readings do not determine: the field `value` is `None`.
    pub(super) fn open(power: Unit, length: LengthUnit) -> Self {
        Self {
            value: None,
            std: None,
            interval95: Some([None; 2]),
            unit: power.of(length).into(),
        }
    }

    pub(super) fn number(&self) -> f64 {
        self.value.unwrap_or(f64::NAN)
    }

    /// A value whose 95 % interval extends `half_width` standard errors to both sides.
    pub(super) fn within(
        value: f64,
        std: Option<f64>,
        half_width: f64,
        power: Unit,
        length: LengthUnit,
    ) -> Self {
        let bare = Self::bare(value, power.of(length));
        let end = |std: f64, sign: f64| Some(value + sign * half_width * std);
        Self {
            std,
            interval95: std.map(|std| [end(std, -1.0), end(std, 1.0)]),
            ..bare
        }
    }

    pub(super) fn of(estimated: &Estimated, power: Unit, length: LengthUnit) -> Self {
        let ends = [estimated.interval.low, estimated.interval.high];
        Self {
            std: finite(estimated.std),
            interval95: Some(ends.map(|end| end.and_then(finite))),
            ..Self::bare(estimated.value, power.of(length))
        }
    }
}

/// The number, with 0 instead of −0; `None` if it is not finite.
pub(super) fn finite(number: f64) -> Option<f64> {
    Some(number + 0.0).filter(|number| number.is_finite())
}
