//! A cache for values that are expensive to compute and that the trials of several cells need.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Cache of values, each with a key. The first thread that needs a value computes it, and other threads that need the
/// same value wait. `room` limits the total size of the values: if it is exceeded, the least recently used values are
/// removed. Removed values are computed again when they are needed.
#[derive(Debug)]
pub struct Cache<K, V> {
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
    /// An empty cache with the limit `room` on the total size of its values.
    pub const fn new(room: usize) -> Self {
        Self {
            room,
            values: Mutex::new(Vec::new()),
        }
    }

    /// Returns the value for `key`, which `make` computes if the cache does not contain it. The value must depend on
    /// the key only. `size` is the size of the value, in the same unit as the limit `room`.
    pub fn get(&self, key: K, size: usize, make: impl FnOnce() -> V) -> V {
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
