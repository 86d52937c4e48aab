//! The cache of values that several cells share.

use std::sync::Barrier;
use std::sync::atomic::{AtomicU32, Ordering};

use palpate_sweep::Cache;

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
