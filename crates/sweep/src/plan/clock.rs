//! Time, which a planner is handed by its caller.

use std::time::Duration;

/// Time since planning began. It must go on: what a planner measures by a clock that stands still never ends.
pub type Clock<'a> = dyn Fn() -> Duration + 'a;
