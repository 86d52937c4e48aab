//! Cache of values that are computed once.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Cache of values by key. The first thread that needs a value computes it; other threads that need it wait. If the
/// total size exceeds `room`, the least recently used values are dropped. They are computed again if needed.
#[derive(Debug)]
pub(crate) struct Kept<K, V> {
    room: usize,
    /// Least recently used first.
    values: Mutex<Vec<Entry<K, V>>>,
}

#[derive(Debug)]
struct Entry<K, V> {
    key: K,
    size: usize,
    value: Arc<OnceLock<V>>,
}

impl<K: PartialEq, V: Clone> Kept<K, V> {
    pub(crate) const fn new(room: usize) -> Self {
        Self {
            room,
            values: Mutex::new(Vec::new()),
        }
    }

    /// Returns the value of `key`, which has this size. If it is not cached, `make` computes it from the key alone.
    pub(crate) fn get(&self, key: K, size: usize, make: impl FnOnce() -> V) -> V {
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
            let mut taken: usize = values.iter().map(|entry| entry.size).sum();
            while taken > self.room {
                taken -= values.remove(0).size;
            }
            value
        };
        value.get_or_init(make).clone()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn a_value_is_made_once_for_all_threads() {
        let (kept, made, ready) = (Kept::new(4), AtomicU32::new(0), Barrier::new(8));
        std::thread::scope(|scope| {
            for thread in 0..8 {
                let (kept, made, ready) = (&kept, &made, &ready);
                scope.spawn(move || {
                    ready.wait();
                    let value = kept.get(thread % 2, 1, || {
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
    fn no_more_than_there_is_room_for_is_kept_and_the_last_asked_for_is() {
        let kept = Kept::new(6);
        let of_size = |key: u32, size: usize| {
            let mut is_made = false;
            let value = kept.get(key, size, || {
                is_made = true;
                2 * key
            });
            assert_eq!(value, 2 * key);
            let taken: usize = kept.values.lock().unwrap().iter().map(|one| one.size).sum();
            assert!(taken <= 6);
            is_made
        };
        let made = |key| of_size(key, 2);
        assert!([1, 2, 3].into_iter().all(&made));
        assert!(!made(1));
        // 2 is the least recently used.
        assert!(made(4));
        assert!(!made(1) && !made(3) && !made(4));
        assert!(made(2));
        assert!(made(1));
        // Larger than the room: never cached.
        assert!(of_size(5, 7) && of_size(5, 7));
    }
}
