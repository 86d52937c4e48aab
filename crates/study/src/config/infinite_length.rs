//! Reads and writes lengths that may be infinite. In JSON, numbers are finite, so an infinite length is the text "inf".
//! In TOML, both `inf` and "inf" are accepted.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value as Json;

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Form {
    Finite(f64),
    Infinite(Infinite),
}

#[derive(Serialize, Deserialize)]
enum Infinite {
    #[serde(rename = "inf")]
    Length,
}

impl From<f64> for Form {
    fn from(length: f64) -> Self {
        match length == f64::INFINITY {
            true => Self::Infinite(Infinite::Length),
            false => Self::Finite(length),
        }
    }
}

/// The number as a JSON value. An infinite number is the text "inf".
pub fn json_number(number: f64) -> Json {
    serde_json::to_value(Form::from(number)).unwrap_or_default()
}

pub(super) fn is_infinite(text: Option<&str>) -> bool {
    text == Some("inf")
}

/// Writes a length, which may be infinite. An optional length may also be missing.
pub fn serialize<S: Serializer>(
    length: &(impl Copy + Into<Option<f64>>),
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let length: Option<f64> = (*length).into();
    length.map(Form::from).serialize(serializer)
}

/// Reads a length, which may be infinite. An optional length may also be missing.
///
/// # Errors
/// The error of the deserializer if the value is neither a number nor "inf".
pub fn deserialize<'de, D: Deserializer<'de>, T: From<f64> + Default>(
    deserializer: D,
) -> Result<T, D::Error> {
    let form = Option::<Form>::deserialize(deserializer)?;
    Ok(form.map_or_else(T::default, |form| match form {
        Form::Finite(length) => length.into(),
        Form::Infinite(_) => f64::INFINITY.into(),
    }))
}
