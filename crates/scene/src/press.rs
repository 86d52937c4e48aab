//! A press: a soft spherical sensor touches an object once, and the object's curvature is estimated from how the markers
//! under its skin move.

mod camera;
mod departed;
mod failure;
mod judged;
mod ladder;
mod looks;
mod method;
mod parts;
mod picture_fit;
mod picture_law;
mod pictures;
mod plan;
mod pressed;
mod profile;
mod readings;
mod scene;
mod seen;
mod soft_body;
mod trace;
mod words;

pub(crate) use departed::stds as sensor_stds;
pub use failure::PressFailure;
pub use judged::JudgedCurvature;
pub(crate) use method::{Assumed, body_of, thickness};
pub use parts::Parts;
pub(crate) use picture_fit::PicturePlan;
pub use picture_law::PictureLaw;
pub(crate) use picture_law::seen_of;
pub(crate) use pictures::{PictureMethod, Pictures, pressed};
pub use scene::PressScene;
pub(crate) use words::large_contact;
