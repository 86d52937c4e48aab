//! Builds estimators from their settings and a sensor, for simulated and for recorded readings.
//!
//! [`PressFitSetup`] builds the fit to marker displacements, [`ImageFitSetup`] the fit to marker images, and
//! [`GlideMethod`] the methods of EP2. [`MarkerSphere`] is the sensor that a config describes, and
//! [`CutPattern`] the flat pattern of its skin.

mod curvature_map;
mod cut_pattern;
mod glide_fit;
mod image_fit;
mod image_model;
mod marker_images;
mod marker_sphere;
mod press_fit;

pub use curvature_map::{map_table, push_map_point};
pub use cut_pattern::{CutPattern, marker_places};
pub use glide_fit::{GlideFit, GlideMethod, fit_shape};
pub use image_fit::{ImageFitSetup, departure_stds};
pub use image_model::{ImageModel, marker_image};
pub use marker_images::{ImageEstimator, MarkerImages, pressed_images, tracks_table};
pub use marker_sphere::{MarkerSphere, optics_error};
pub use press_fit::{
    PressFitError, PressFitSetup, body_error, fit_description, ideal_fit, large_contact_warning,
    sensor_body, within_sensor,
};
