//! Builds estimators from their settings and a sensor, for simulated and for recorded readings.
//!
//! [`PressFitSetup`] builds the fit to marker displacements, [`ImageFitSetup`] the fit to marker images, and
//! [`GlideFit`] the methods of EP2. [`MarkerSphere`] is the sensor of a config.

mod curvature_map;
mod departure_prior;
mod glide_fit;
mod image_fit;
mod image_model;
mod large_contact;
mod marker_images;
mod marker_sphere;
mod press_fit;
mod tracks_table;

pub use curvature_map::{map_table, push_map, push_map_point, study_map_table};
pub use departure_prior::departure_stds;
pub use glide_fit::GlideFit;
pub use image_fit::{ImageFitSetup, Layers};
pub use image_model::{ImageModel, marker_image};
pub use large_contact::large_contact_warning;
pub use marker_images::{ImageEstimator, MarkerImages, pressed_images};
pub use marker_sphere::{LAYOUT, MarkerSphere, optics_error};
pub use press_fit::{
    PressFitError, PressFitSetup, assumed_body, baseline, body_error, sensor_body, within,
    within_sensor,
};
pub use tracks_table::tracks_table;
