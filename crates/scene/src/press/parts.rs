//! Cache of parts that presses share.

use palpate_press::{Body, PressError};
use palpate_tracking::Marker;

use super::failure::PressFailure;
use super::looks::{Changes, PressLooks, RestLook, Seen};
use crate::kept::Kept;

/// Number of cached layers, each with tables of at most 2 MB.
const LAYERS: usize = 16;
/// Number of cached pictures of markers, each of at most 300 bytes.
const SEEN: usize = 1 << 17;

/// Cache of parts that scenes share, such as the cells of a study: layers with their tables, and camera readings at
/// rest and in calibration presses. The first scene that needs a part computes it; scenes with the same inputs reuse
/// it. The cache has a limited size and never changes results.
///
/// ```
/// use palpate_scene::{Parts, Scenes};
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
/// let parts = Parts::default();
/// for (number, indentation) in [0.5, 1.0].into_iter().enumerate() {
///     // The second finds the layer of the first.
///     let scene = study.estimable_scene_of(number, &study.cell(number)?, &parts)?;
///     assert_eq!(scene.truth(3), Some(indentation));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Parts {
    /// Layers; the key is the bits of their thickness and their depths.
    layers: Kept<Vec<u64>, Result<Vec<Body>, PressError>>,
    at_rest: Kept<RestLook, Result<Seen, PressFailure>>,
    changes: Kept<PressLooks, Result<Changes, PressFailure>>,
}

impl Default for Parts {
    fn default() -> Self {
        Self {
            layers: Kept::new(LAYERS),
            at_rest: Kept::new(SEEN),
            changes: Kept::new(SEEN),
        }
    }
}

impl Parts {
    /// A layer with tables, as [`Body::bonded_layer`] makes it.
    pub(super) fn layer(&self, thickness: f64, depth: f64) -> Result<Body, PressError> {
        let mut layers = self.layers(thickness, &[depth])?;
        layers.pop().ok_or(PressError::OutOfRange)
    }

    /// One layer at several depths, with tables, as [`Body::bonded_layers`] makes it.
    pub(super) fn layers(&self, thickness: f64, depths: &[f64]) -> Result<Vec<Body>, PressError> {
        let numbers = [thickness].into_iter().chain(depths.iter().copied());
        let key = numbers.map(f64::to_bits).collect();
        self.layers
            .get(key, depths.len(), || Body::bonded_layers(thickness, depths))
    }

    /// The markers that a camera sees at rest.
    pub(super) fn at_rest(&self, look: &RestLook) -> Result<Seen, PressFailure> {
        let markers = || look.markers().map(Seen::from);
        self.at_rest.get(look.clone(), look.size(), markers)
    }

    /// Changes of the markers' pictures from `rest` to each press.
    pub(super) fn changes(
        &self,
        looks: &PressLooks,
        rest: &[Option<Marker>],
    ) -> Result<Changes, PressFailure> {
        self.changes
            .get(looks.clone(), looks.size(), || looks.changes(rest))
    }
}
