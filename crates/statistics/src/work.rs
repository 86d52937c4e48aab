//! Counters of the work that a scene causes. They show that a scene which needs no random numbers, integrator or frames
//! causes none of that work.
//!
//! Counting is per thread, and only with the feature `count`; without it every function here is empty.

/// Work done on one thread, counted by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Random words drawn.
    pub draws: u64,
    /// Motions of a probe whose contact was computed, by any rung.
    pub rolls: u64,
    /// Evaluations of the right-hand side of contact equations by an integrator.
    pub derivatives: u64,
    /// Searches for the place where a fingertip with a radius touches.
    pub searches: u64,
    /// Contacts with an elastic layer for which an integral equation was solved.
    pub layers: u64,
    /// Markers whose image was computed in closed form.
    pub projections: u64,
    /// Frames painted.
    pub frames: u64,
}

#[cfg(feature = "count")]
mod counting {
    use std::cell::Cell;

    use super::Tally;

    thread_local! {
        static TALLY: Cell<Tally> = const {
            Cell::new(Tally { draws: 0, rolls: 0, derivatives: 0, searches: 0, layers: 0, projections: 0, frames: 0 })
        };
    }

    pub(super) fn add(change: impl FnOnce(&mut Tally)) {
        TALLY.with(|cell| {
            let mut tally = cell.get();
            change(&mut tally);
            cell.set(tally);
        });
    }

    /// Work that `work` does on this thread, beside the value that `work` returns.
    pub fn counted<T>(work: impl FnOnce() -> T) -> (Tally, T) {
        let before = TALLY.replace(Tally::default());
        let given = work();
        (TALLY.replace(before), given)
    }
}

#[cfg(feature = "count")]
pub use counting::counted;

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident => $field:ident;)*) => {
        $(
            $(#[$doc])*
            #[inline(always)]
            pub fn $name(count: u64) {
                #[cfg(feature = "count")]
                counting::add(|tally| tally.$field += count);
                #[cfg(not(feature = "count"))]
                let _ = count;
            }
        )*
    };
}

counters! {
    /// Random words were drawn.
    drew => draws;
    /// The contact after a motion was computed.
    rolled => rolls;
    /// An integrator asked for derivatives.
    derived => derivatives;
    /// The contact of a round tip was searched for.
    searched => searches;
    /// A contact with a layer was solved.
    solved_layer => layers;
    /// Images of markers were computed without pixels.
    projected => projections;
    /// Frames were painted.
    painted => frames;
}

#[cfg(all(test, feature = "count"))]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_done_inside_counts() {
        drew(5);
        let (tally, given) = counted(|| {
            drew(2);
            painted(1);
            drew(3);
            "given"
        });
        let expected = Tally {
            draws: 5,
            frames: 1,
            ..Tally::default()
        };
        assert_eq!((tally, given), (expected, "given"));
        assert_eq!(counted(|| ()).0, Tally::default());
    }
}
