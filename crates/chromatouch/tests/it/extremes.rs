//! Sensors of all sizes, frames of all resolutions: a value within its stated bound, or the named error.

mod layouts;
mod optics;
mod slopes;
