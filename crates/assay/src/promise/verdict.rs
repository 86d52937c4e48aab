//! Verdicts on promises, from counts of instructions.

use std::path::Path;

use anyhow::Result;

use super::promised::{MOST, Promise, SCENES};
use super::scenes::Kind;
use crate::columns::{self, or_empty};

/// A promise, and what it costs.
pub(super) struct Verdict<'a> {
    promise: &'a Promise,
    /// Instructions of the model that was taken.
    taken: u64,
    /// The cheapest model that would do, and its instructions.
    cheapest: Option<(usize, u64)>,
}

impl<'a> Verdict<'a> {
    /// Takes as many counts as the promise has models to be judged.
    pub(super) fn of(promise: &'a Promise, counts: &mut impl Iterator<Item = u64>) -> Self {
        let judged: Vec<(usize, u64)> = promise.judged().zip(counts).collect();
        let taken = judged.iter().find(|(place, _)| *place == promise.taken);
        let adequate = judged
            .iter()
            .filter(|(place, _)| promise.is_adequate(*place));
        Self {
            promise,
            taken: taken.map_or(0, |(_, count)| *count),
            cheapest: adequate.min_by_key(|(_, count)| *count).copied(),
        }
    }

    fn ratio(&self) -> Option<f64> {
        let (_, least) = self.cheapest?;
        Some(self.taken as f64 / least.max(1) as f64)
    }

    fn is_kept(&self) -> bool {
        self.promise.errs_within() && self.ratio().is_some_and(|ratio| ratio <= MOST)
    }
}

/// Writes the table.
pub(super) fn write(verdicts: &[Verdict<'_>], out: &Path) -> Result<()> {
    let row = |verdict: &Verdict<'_>| {
        let Verdict {
            promise, cheapest, ..
        } = verdict;
        let cheapest_name = cheapest.map(|(place, _)| promise.rivals[place].rung.name.clone());
        let error = match &promise.taken().outcome {
            Ok(error) => format!("{error:e}"),
            Err(why) => why.clone(),
        };
        let is_kept = if verdict.is_kept() { "yes" } else { "no" };
        [
            ("kind", promise.kind.name().to_owned()),
            ("scene", promise.number.to_string()),
            ("tolerance", format!("{:e}", promise.tolerance)),
            ("taken", promise.taken().name.clone()),
            ("error", error),
            ("judged_by", promise.truth.to_owned()),
            ("competitors", promise.competitors().to_string()),
            ("instructions", verdict.taken.to_string()),
            ("cheapest_adequate", cheapest_name.unwrap_or_default()),
            (
                "cheapest_instructions",
                or_empty(*cheapest, |(_, count)| count.to_string()),
            ),
            (
                "ratio",
                or_empty(verdict.ratio(), |ratio| format!("{ratio:.3}")),
            ),
            ("kept", is_kept.to_owned()),
        ]
    };
    columns::write(out, verdicts.iter().map(row))
}

/// How many of each kind keep their word, how many had a choice, and what the dearest costs; as an error where one does
/// not.
pub(super) fn words(verdicts: &[Verdict<'_>]) -> Result<String, String> {
    let of_kind = Kind::ALL.map(|kind| {
        let of = || verdicts.iter().filter(move |one| one.promise.kind == kind);
        let count = |holds: &dyn Fn(&Verdict<'_>) -> bool| of().filter(|one| holds(one)).count();
        let kept = count(&|one| one.is_kept());
        let had_a_choice = count(&|one| one.promise.competitors() > 0);
        let by_another = count(&|one| one.promise.is_judged_by_another());
        let dearest = of().filter_map(Verdict::ratio).fold(0.0, f64::max);
        format!(
            "{kept} of {SCENES} {}, others would do for {had_a_choice}, {by_another} judged by another computation, at \
             most {dearest:.2} times the cheapest",
            kind.plural()
        )
    });
    let words = format!("auto: {}", of_kind.join("; "));
    if verdicts.iter().all(Verdict::is_kept) {
        Ok(words)
    } else {
        Err(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_cheapest_keeps_the_promise_and_no_more() {
        let promise = Promise::of(Kind::Glide, 0).unwrap();
        assert!(promise.competitors() > 0);
        let is_kept = |taken: u64| {
            let count = |place| if place == promise.taken { taken } else { 100 };
            let verdict = Verdict::of(&promise, &mut promise.judged().map(count));
            words(&[verdict]).is_ok()
        };
        assert!([50, 200].into_iter().all(is_kept));
        assert!(!is_kept(201));
    }
}
