//! Counters of the computational work of a simulation. Tests use the counters to check, for example, that a scene
//! without noise draws no random numbers.
//!
//! Work is counted separately for each thread. A count takes one instruction.

use std::cell::Cell;

/// Amount of computational work that was done on one thread, for each kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Number of random 64-bit words that were drawn from the random number generators.
    pub draws: u64,
    /// Number of probe motions (rolls) for which a model computed the contact.
    pub rolls: u64,
    /// Number of times an integrator evaluated the right-hand side of the contact equations.
    pub derivatives: u64,
    /// Number of searches for the contact of a round fingertip (a fingertip with a radius above 0).
    pub searches: u64,
    /// Number of contacts with an elastic layer for which an integral equation was solved.
    pub layers: u64,
    /// Number of markers whose image was computed without rendering pixels.
    pub projections: u64,
    /// Number of rendered camera frames.
    pub frames: u64,
}

thread_local! {
    static TALLY: Cell<Tally> = const {
        Cell::new(Tally { draws: 0, rolls: 0, derivatives: 0, searches: 0, layers: 0, projections: 0, frames: 0 })
    };
}

fn add(change: impl FnOnce(&mut Tally)) {
    TALLY.with(|cell| {
        let mut tally = cell.get();
        change(&mut tally);
        cell.set(tally);
    });
}

/// Runs the function `work`. Returns the counts of the operations that `work` does on this thread, and the result of
/// `work`.
pub fn counted<T>(work: impl FnOnce() -> T) -> (Tally, T) {
    let before = TALLY.replace(Tally::default());
    let given = work();
    (TALLY.replace(before), given)
}

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident => $field:ident;)*) => {
        $(
            $(#[$doc])*
            #[inline(always)]
            pub fn $name(count: u64) {
                add(|tally| tally.$field += count);
            }
        )*
    };
}

counters! {
    /// Counts 64-bit words of random bits that were drawn.
    drew => draws;
    /// Counts probe motions (rolls) for which a model computed the contact.
    rolled => rolls;
    /// Counts evaluations of the contact equations by an integrator.
    derived => derivatives;
    /// Counts searches for the contact of a round fingertip.
    searched => searches;
    /// Counts contacts with an elastic layer for which an integral equation was solved.
    solved_layer => layers;
    /// Counts markers whose image was computed without rendering pixels.
    projected => projections;
    /// Counts rendered camera frames.
    painted => frames;
}

#[cfg(test)]
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
