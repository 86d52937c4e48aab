//! Frames and displacements of all sizes: a value within its stated bound, or the named error.

mod calibration;
mod displacements;
mod frames;
