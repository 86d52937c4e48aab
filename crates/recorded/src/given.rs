//! Builds the options of estimates from named settings, given on a command line or in a call.

mod glide;
mod pictures;
mod press;
mod roll;

pub use glide::GlideGiven;
pub use press::PressGiven;
pub use roll::RollGiven;
