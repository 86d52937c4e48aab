//! The hot paths and what they are fed with: the same inputs where instructions are counted, where errors are found
//! ([`crate::accuracy`]) and where palpate is timed beside its peers ([`crate::ours`]).

pub mod camera;
pub mod patches;
pub mod pictures;
pub mod presses;
pub mod rolls;
pub mod texts;

use std::hint::black_box;

/// A hot path, ready to be run; each run does the same work.
pub type Hot = Box<dyn FnMut()>;

/// A path that has run once, so that tables are made and buffers are there.
fn warm<T>(mut run: impl FnMut() -> T + 'static) -> Hot {
    drop(black_box(run()));
    Box::new(move || drop(black_box(run())))
}
