//! Contact with an incompressible elastic layer bonded to a rigid core.

use crate::{Field, PressError};

/// An incompressible layer on a rigid base, read at a depth.
#[derive(Clone, Debug)]
pub struct BondedLayer {
    thickness: f64,
    depth: f64,
}

impl BondedLayer {
    /// A layer of this thickness whose displacements are read at this depth.
    ///
    /// # Errors
    /// [`PressError::BadSetting`].
    pub fn new(thickness: f64, depth: f64) -> Result<Self, PressError> {
        Ok(Self { thickness, depth })
    }
    /// Its thickness.
    pub const fn thickness(&self) -> f64 {
        self.thickness
    }
    /// D(a) and its derivative.
    ///
    /// # Errors
    /// [`PressError::LayerTooThin`].
    pub fn indentation_of(&self, _a: f64) -> Result<[f64; 2], PressError> {
        Err(PressError::OutOfRange)
    }
    /// a from D.
    ///
    /// # Errors
    /// [`PressError::LayerTooThin`].
    pub fn contact_radius(&self, _d: f64) -> Result<f64, PressError> {
        Err(PressError::OutOfRange)
    }
    /// The field.
    pub fn field(&self, _a: f64, _r: f64) -> Field {
        let _ = self.depth;
        Field::default()
    }
}
