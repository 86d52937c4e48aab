//! A roll: probes roll on an object from a first contact. The curvature of the object at the first contact is estimated
//! from the rotations of the probes and the displacements of their contacts.

mod linear_rolls;
mod motion_noise;
mod roll_plan;
mod roll_sensor;
mod roll_trace;
mod roll_trial;
mod sampled_rolls;

pub use pulp::Arch;
pub use roll_trial::RollScene;
pub(crate) use roll_trial::quantities_of;
