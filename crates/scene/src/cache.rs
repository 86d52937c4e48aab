//! Models of presses that several scenes share.

use palpate_press::{Body, PressError};
use palpate_sweep::Cache;
use palpate_tracking::Marker;

use crate::press::{CalibrationFrames, ImageChanges, PressFailure, RestFrames, RestMarkers};

/// Maximum number of cached layers of the soft body. Each layer has tables of at most 2 MB.
const LAYERS: usize = 16;
/// Maximum number of cached marker images, each of at most 300 bytes.
const IMAGES: usize = 1 << 17;

/// Models that several scenes share, such as the scenes of a study's grid points. The models are soft layers with their
/// tables of displacements, and camera readings at rest and in calibration presses. The first scene that needs a model
/// computes it, and scenes with the same inputs reuse it. The cache has a limited size and never changes results.
///
/// ```
/// use palpate_scene::{Scenes, SharedModels};
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "presses"
///     scene.kind = "press"
///     scene.probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
///     scene.object = { kind = "plane" }
///     scene.motion = { indentation = 1.0 }
///     scene.model = { kind = "bonded-layer", thickness = 5.0 }
///     scene.estimator = { kind = "bonded-layer" }
///     [[sweep]]
///     path = "scene.motion.indentation"
///     values = [0.5, 1.0]
/// "#;
/// let study = parse("study.toml", text)?;
/// let models = SharedModels::default();
/// for (number, indentation) in [0.5, 1.0].into_iter().enumerate() {
///     // The second scene reuses the layer of the first.
///     let scene = study.estimable_scene_of(number, &study.cell(number)?, &models)?;
///     assert_eq!(scene.truth(3), Some(indentation));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SharedModels {
    /// Cached layers of the soft body. The key consists of the bits of the layer's thickness and of the marker depths.
    layers: Cache<Vec<u64>, Result<Vec<Body>, PressError>>,
    at_rest: Cache<RestFrames, Result<RestMarkers, PressFailure>>,
    changes: Cache<CalibrationFrames, Result<ImageChanges, PressFailure>>,
}

impl Default for SharedModels {
    fn default() -> Self {
        Self {
            layers: Cache::new(LAYERS),
            at_rest: Cache::new(IMAGES),
            changes: Cache::new(IMAGES),
        }
    }
}

impl SharedModels {
    /// Returns the soft body that [`Body::bonded_layer`] builds for this thickness and marker depth. The body is built
    /// only if the cache does not contain it.
    pub(crate) fn layer(&self, thickness: f64, depth: f64) -> Result<Body, PressError> {
        let mut layers = self.layers(thickness, &[depth])?;
        layers.pop().ok_or(PressError::OutOfRange)
    }

    pub(crate) fn layers(&self, thickness: f64, depths: &[f64]) -> Result<Vec<Body>, PressError> {
        let numbers = [thickness].into_iter().chain(depths.iter().copied());
        let key = numbers.map(f64::to_bits).collect();
        self.layers
            .get(key, depths.len(), || Body::bonded_layers(thickness, depths))
    }

    pub(crate) fn at_rest(&self, frames: &RestFrames) -> Result<RestMarkers, PressFailure> {
        let markers = || frames.markers().map(RestMarkers::from);
        self.at_rest.get(frames.clone(), frames.size(), markers)
    }

    /// For each calibration press, the changes of the markers' images from their images at rest (`rest`).
    pub(crate) fn changes(
        &self,
        frames: &CalibrationFrames,
        rest: &[Option<Marker>],
    ) -> Result<ImageChanges, PressFailure> {
        self.changes
            .get(frames.clone(), frames.size(), || frames.changes(rest))
    }
}
