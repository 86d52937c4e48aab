//! Checks the automatic choice of a model (`auto`). The error of the chosen model must be within the tolerance. Its
//! number of processor instructions must be at most twice that of the cheapest model within the tolerance.
//!
//! | kind | computation whose instructions are counted | error | reference | competing models |
//! |---|---|---|---|---|
//! | roll | the rolls of one trial without noise | contacts at the end, relative to the contact's length scale | Montana's equations in the charts of both bodies | all models that use no charts, with many settings |
//! | glide | the contact points of all fingers | contacts, relative to the tip's radius | closed-form solution of the offset surface; if a model has a closed form, this model and Newton's method are compared with each other | closed form, Newton's method with the tolerances 10⁻¹, 10⁻², … 10⁻¹³ |
//! | press | the press, and the displacements of the markers | displacements, relative to the largest | quadrature over wavenumbers, which no competing model uses | Hertz, half-space, layer |
//!
//! The set-up of a scene is not counted. For a roll, the instructions of expensive models are not counted. A model
//! counts as expensive if it evaluates the contact equations more than three times as often as the chosen model. It
//! cannot be cheaper, because the costs per evaluation of any two methods differ at most by a factor of 2.1.

mod auto_choice;
mod auto_scenes;
mod competing_models;

use std::path::Path;

use anyhow::{Result, anyhow, bail};

use crate::csv_table::{self, or_empty};
use crate::timing::{self, Evaluation};
use auto_choice::MAX_COST_RATIO;
pub use auto_choice::{AutoChoice, SCENES};
pub use auto_scenes::{Kind, config_text};
pub use competing_models::CompetingModel;

/// The models that `auto` chooses on all random scenes: first all rolls, then all glides, then all presses.
///
/// # Errors
/// Errors of [`AutoChoice::new`].
pub fn choices() -> Result<Vec<AutoChoice>> {
    let of_kind = |kind| (0..SCENES).map(move |number| AutoChoice::new(kind, number));
    Kind::ALL.into_iter().flat_map(of_kind).collect()
}

/// Checks all scenes, writes `promise.csv`, and returns a summary. If `counted` is true, the function only runs the
/// computations whose instructions valgrind counts (see [`timing::instructions`]).
///
/// # Errors An error if a choice fails the check, if the instructions cannot be counted, or if the table cannot be
/// written. If a choice fails the check, the table is written before the error is returned.
pub fn run(out: &Path, counted: bool) -> Result<String> {
    let choices = choices()?;
    let evaluations: Vec<Evaluation> = choices
        .iter()
        .map(AutoChoice::evaluations)
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect();
    if counted {
        timing::count(evaluations);
        return Ok(String::new());
    }
    let scales: Vec<u32> = evaluations.iter().map(Evaluation::scale).collect();
    let Some(counts) = timing::instructions(&scales)? else {
        bail!("{}", timing::NO_VALGRIND);
    };
    let mut counts = counts.into_iter();
    let verdicts: Vec<Verdict<'_>> = choices
        .iter()
        .map(|choice| Verdict::new(choice, counts.by_ref()))
        .collect();
    write(&verdicts, out)?;
    summary(&verdicts).map_err(|summary| anyhow!("{summary}: see {}", out.display()))
}

/// A model that `auto` chose, and the comparison of its cost with the costs of the other models.
struct Verdict<'a> {
    choice: &'a AutoChoice,
    /// Number of processor instructions that the chosen model executes for one run of the scene.
    taken: u64,
    /// The cheapest model whose error is within the tolerance: its index among the models of the scene, and its number
    /// of processor instructions. `None` if no model is within the tolerance.
    cheapest: Option<(usize, u64)>,
}

impl<'a> Verdict<'a> {
    /// Finds the cheapest model within the tolerance for the scene of `choice`. `counts` yields the instruction counts
    /// of the models in [`AutoChoice::counted`], in the same order.
    fn new(choice: &'a AutoChoice, counts: &mut impl Iterator<Item = u64>) -> Self {
        let counted: Vec<(usize, u64)> = choice.counted().zip(counts).collect();
        let taken = counted.iter().find(|(place, _)| *place == choice.taken);
        let adequate = counted
            .iter()
            .filter(|(place, _)| choice.is_adequate(*place));
        Self {
            choice,
            taken: taken.map_or(0, |(_, count)| *count),
            cheapest: adequate.min_by_key(|(_, count)| *count).copied(),
        }
    }

    fn ratio(&self) -> Option<f64> {
        let (_, least) = self.cheapest?;
        Some(self.taken as f64 / least.max(1) as f64)
    }

    fn passes(&self) -> bool {
        self.choice.errs_within() && self.ratio().is_some_and(|ratio| ratio <= MAX_COST_RATIO)
    }
}

fn write(verdicts: &[Verdict<'_>], out: &Path) -> Result<()> {
    let row = |verdict: &Verdict<'_>| {
        let Verdict {
            choice, cheapest, ..
        } = verdict;
        let cheapest_name = cheapest.map(|(place, _)| choice.models[place].rung.name.clone());
        let error = match &choice.taken().accuracy {
            palpate::Accuracy::Error(error) => format!("{error:e}"),
            palpate::Accuracy::Impossible(why) => why.clone(),
        };
        let passes = if verdict.passes() { "yes" } else { "no" };
        [
            ("kind", choice.kind.name().to_owned()),
            ("scene", choice.number.to_string()),
            ("tolerance", format!("{:e}", choice.tolerance)),
            ("taken", choice.taken().name.clone()),
            ("error", error),
            ("judged_by", choice.truth.to_owned()),
            ("competitors", choice.competitors().to_string()),
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
            ("kept", passes.to_owned()),
        ]
    };
    csv_table::write(out, verdicts.iter().map(row))
}

/// Summary for each kind of scene. It states how many scenes pass the check, how many have competing models, and how
/// many have an independent reference. It also states the largest ratio of the chosen model's cost to the cheapest
/// model's cost. Returns an error if a scene fails the check.
fn summary(verdicts: &[Verdict<'_>]) -> Result<String, String> {
    let of_kind = Kind::ALL.map(|kind| {
        let of = || verdicts.iter().filter(move |one| one.choice.kind == kind);
        let count = |holds: &dyn Fn(&Verdict<'_>) -> bool| of().filter(|one| holds(one)).count();
        let passed = count(&|one| one.passes());
        let with_competitors = count(&|one| one.choice.competitors() > 0);
        let independent = count(&|one| one.choice.has_independent_truth());
        let dearest = of().filter_map(Verdict::ratio).fold(0.0, f64::max);
        format!(
            "{passed} of {SCENES} {} scenes pass, {with_competitors} have another adequate model, {independent} have an \
             independent reference, at most {dearest:.2} times the cheapest",
            kind.name()
        )
    });
    let summary = format!("auto: {}", of_kind.join("; "));
    match verdicts.iter().all(Verdict::passes) {
        true => Ok(summary),
        false => Err(summary),
    }
}
