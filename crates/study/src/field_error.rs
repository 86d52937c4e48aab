//! A config that makes no scene or no estimator.

use std::ops::Range;

/// The field of a config that is wrong, and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// Path of the field, such as `scene.object.radius`.
    pub path: String,
    /// Problem in words.
    pub message: String,
    /// Byte range of the wrong part of the field's text.
    pub part: Option<Range<usize>>,
}

impl FieldError {
    /// The error of a whole field.
    pub fn at(path: impl Into<String>, message: impl ToString) -> Self {
        Self {
            path: path.into(),
            message: message.to_string(),
            part: None,
        }
    }
}
