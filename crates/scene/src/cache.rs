//! A cache for values that are expensive to compute, and the models of presses that several scenes share.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use palpate_press::{Body, PressError};
use palpate_tracking::Marker;

use crate::press::{CalibrationFrames, ImageChanges, PressFailure, RestFrames, RestMarkers};

/// Maximum number of cached layers of the soft body. Each layer has tables of at most 2 MB.
const LAYERS: usize = 16;
/// Maximum number of cached marker images, each of at most 300 bytes.
const IMAGES: usize = 1 << 17;

/// Cache of values, each with a key. The first thread that needs a value computes it, and other threads that need the
/// same value wait. `room` limits the total size of the values: if it is exceeded, the least recently used values are
/// removed. Removed values are computed again when they are needed.
#[derive(Debug)]
struct Cache<K, V> {
    room: usize,
    values: Mutex<Vec<Entry<K, V>>>,
}

#[derive(Debug)]
struct Entry<K, V> {
    key: K,
    size: usize,
    value: Arc<OnceLock<V>>,
}

impl<K: PartialEq, V: Clone> Cache<K, V> {
    const fn new(room: usize) -> Self {
        Self {
            room,
            values: Mutex::new(Vec::new()),
        }
    }

    /// Returns the value for `key`, which `make` computes if the cache does not contain it. The value must depend on
    /// the key only. `size` is the size of the value, in the same unit as the limit `room`.
    fn get(&self, key: K, size: usize, make: impl FnOnce() -> V) -> V {
        let value = {
            let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
            let found = values.iter().position(|entry| entry.key == key);
            let entry = match found {
                Some(place) => values.remove(place),
                None => Entry {
                    key,
                    size,
                    value: Arc::default(),
                },
            };
            let value = Arc::clone(&entry.value);
            values.push(entry);
            let mut total: usize = values.iter().map(|entry| entry.size).sum();
            while total > self.room {
                total -= values.remove(0).size;
            }
            value
        };
        value.get_or_init(make).clone()
    }
}

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

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn a_value_is_made_once_for_all_threads() {
        let (cache, made, ready) = (Cache::new(4), AtomicU32::new(0), Barrier::new(8));
        std::thread::scope(|scope| {
            for thread in 0..8 {
                let (cache, made, ready) = (&cache, &made, &ready);
                scope.spawn(move || {
                    ready.wait();
                    let value = cache.get(thread % 2, 1, || {
                        made.fetch_add(1, Ordering::Relaxed);
                        std::thread::sleep(std::time::Duration::from_millis(20));
                        10 * (thread % 2)
                    });
                    assert_eq!(value, 10 * (thread % 2));
                });
            }
        });
        assert_eq!(made.into_inner(), 2);
    }

    #[test]
    fn the_least_recently_used_value_is_dropped_first() {
        let cache = Cache::new(6);
        let of_size = |key: u32, size: usize| {
            let mut is_made = false;
            let value = cache.get(key, size, || {
                is_made = true;
                2 * key
            });
            assert_eq!(value, 2 * key);
            let total: usize = cache
                .values
                .lock()
                .unwrap()
                .iter()
                .map(|one| one.size)
                .sum();
            assert!(total <= 6);
            is_made
        };
        let made = |key| of_size(key, 2);
        assert!([1, 2, 3].into_iter().all(&made));
        assert!(!made(1));
        // The cache has room for three values. Value 2 was used least recently, so it is removed.
        assert!(made(4));
        assert!(!made(1) && !made(3) && !made(4));
        assert!(made(2));
        assert!(made(1));
        // The cache does not keep a value that is larger than the cache, so each request computes it again.
        assert!(of_size(5, 7) && of_size(5, 7));
    }
}
