//! Whether `auto` keeps its word: the rung that it takes errs by at most the tolerance, and costs at most twice the
//! instructions of the cheapest rung that does.
//!
//! | kind | what is counted | error | against |
//! |---|---|---|---|
//! | roll | the rolls of one trial without noise | contacts at the end, relative to the contact's length scale | DOP853 at 1e-14 |
//! | glide | the touches of all fingers | contacts, relative to the tip's radius | closed form, or Newton's method at 1e-14; a closed form against Newton's method |
//! | press | the press, and how the markers move | displacements, relative to the largest | the layer solved, or the half-space at the markers' depth |
//!
//! Setting up a scene is not counted. A press for which that last rung is taken errs by 0, for it is what the others
//! are held against.

mod cost;
mod scenes;

use std::path::Path;

use anyhow::{Context, Result, bail};
use palpate_scene::config::{self, Study};
use palpate_scene::{Ladder, Rung};

use crate::measured::{self, Evaluation};
pub use scenes::{Kind, text};

/// Scenes of each kind.
pub const SCENES: u64 = 50;
/// The rung that is taken may cost so many times the cheapest that would do.
const MOST: f64 = 2.0;

/// A random scene and its ladder.
#[derive(Debug)]
pub struct Promise {
    /// What kind of scene it is.
    pub kind: Kind,
    /// Its number among its kind.
    pub number: u64,
    study: Study,
    /// The models of the scene, of which `auto` has taken one.
    pub ladder: Ladder,
    /// What `auto` was asked for.
    pub tolerance: f64,
}

impl Promise {
    /// A scene of a kind by its number.
    ///
    /// # Errors
    /// If the scene cannot be set up, or its model does not choose.
    pub fn of(kind: Kind, number: u64) -> Result<Self> {
        let name = format!("{}-{number}.toml", kind.name());
        let study = config::parse(&name, &text(kind, number))?;
        let ladder = study
            .ladder(0)?
            .with_context(|| format!("{name} has no ladder"))?;
        let tolerance = ladder
            .tolerance
            .with_context(|| format!("{name} chooses no model"))?;
        Ok(Self {
            kind,
            number,
            study,
            ladder,
            tolerance,
        })
    }

    /// Whether the rung that was taken errs by at most the tolerance.
    pub fn errs_within(&self) -> bool {
        self.is_adequate(self.ladder.taken())
    }

    /// Whether the rung that was taken costs no more than it may, as far as that shows without counting instructions: a
    /// roll asks for at most twice the derivatives of any other rung that would do; of glides and presses no rung earlier
    /// on the ladder that would do is of another method.
    ///
    /// # Errors
    /// If a rung that would do does not do.
    #[cfg(feature = "count")]
    pub fn seems_cheap(&self) -> Result<bool> {
        let asked = |place: usize| -> Result<u64> {
            let mut truth = cost::truth(&self.study, &self.ladder.rungs[place])?;
            let (tally, done) = palpate_tally::counted(&mut truth);
            done.map(|_| tally.derivatives)
        };
        let taken = self.ladder.taken;
        match self.kind {
            Kind::Roll => {
                let most = asked(taken)? as f64;
                for place in self.judged() {
                    if most > MOST * asked(place)? as f64 {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            Kind::Glide => Ok(taken == 0 || !self.is_adequate(&self.ladder.rungs[0])),
            Kind::Press => Ok(self.judged().all(|place| place >= taken)),
        }
    }

    fn is_adequate(&self, rung: &Rung) -> bool {
        matches!(rung.outcome, Ok(error) if error <= self.tolerance)
    }

    /// The rungs that would do, and the one that is taken.
    fn judged(&self) -> impl Iterator<Item = usize> {
        (0..self.ladder.rungs.len()).filter(|&place| {
            place == self.ladder.taken || self.is_adequate(&self.ladder.rungs[place])
        })
    }

    fn evaluations(&self) -> Result<Vec<Evaluation>> {
        self.judged().map(|place| self.evaluation(place)).collect()
    }

    /// What the truth of the scene costs on a rung.
    fn evaluation(&self, place: usize) -> Result<Evaluation> {
        let rung = &self.ladder.rungs[place];
        let mut run = cost::truth(&self.study, rung)?;
        run().with_context(|| format!("{} {}: {}", self.kind.name(), self.number, rung.name))?;
        let name = format!("{} {}: {}", self.kind.name(), self.number, rung.name);
        Ok(Evaluation::new(name, run))
    }
}

/// All scenes, kind by kind.
///
/// # Errors
/// As [`Promise::of`].
pub fn promises() -> Result<Vec<Promise>> {
    let numbered = |kind| (0..SCENES).map(move |number| Promise::of(kind, number));
    Kind::ALL.into_iter().flat_map(numbered).collect()
}

/// Judges all scenes and writes `promise.csv`; `counted` as in [`measured::instructions`]. Says how many kept their word.
///
/// # Errors
/// If a scene breaks the promise, after the table is written; if counting fails, or the table cannot be written.
pub fn run(out: &Path, counted: bool) -> Result<String> {
    let promises = promises()?;
    let evaluations: Vec<Vec<Evaluation>> = promises
        .iter()
        .map(Promise::evaluations)
        .collect::<Result<_>>()?;
    if counted {
        measured::count(evaluations.into_iter().flatten());
        return Ok(String::new());
    }
    let scales: Vec<u32> = evaluations
        .iter()
        .flatten()
        .map(Evaluation::scale)
        .collect();
    let Some(counts) = measured::instructions(&scales)? else {
        bail!("{}", measured::NO_VALGRIND);
    };
    let mut counts = counts.into_iter();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "kind",
        "scene",
        "tolerance",
        "taken",
        "error",
        "instructions",
        "cheapest_adequate",
        "cheapest_instructions",
        "ratio",
        "kept",
    ])?;
    let mut held = Kind::ALL.map(|kind| (kind, 0));
    for promise in &promises {
        let judged: Vec<(usize, u64)> = promise.judged().zip(counts.by_ref()).collect();
        let of_taken = judged
            .iter()
            .find(|(place, _)| *place == promise.ladder.taken);
        let taken = of_taken.map_or(0, |(_, count)| *count);
        let rungs = &promise.ladder.rungs;
        let adequate = judged
            .iter()
            .filter(|(place, _)| promise.is_adequate(&rungs[*place]));
        let cheapest = adequate.min_by_key(|(_, count)| *count);
        let ratio = cheapest.map(|(_, count)| taken as f64 / (*count).max(1) as f64);
        let kept = promise.errs_within() && ratio.is_some_and(|ratio| ratio <= MOST);
        for (kind, count) in &mut held {
            *count += u64::from(*kind == promise.kind && kept);
        }
        let error = match &promise.ladder.taken().outcome {
            Ok(error) => format!("{error:e}"),
            Err(why) => why.clone(),
        };
        writer.write_record([
            promise.kind.name(),
            &promise.number.to_string(),
            &format!("{:e}", promise.tolerance),
            &promise.ladder.taken().name,
            &error,
            &taken.to_string(),
            cheapest.map_or("", |(place, _)| &rungs[*place].name),
            &cheapest.map_or(String::new(), |(_, count)| count.to_string()),
            &ratio.map_or(String::new(), |ratio| format!("{ratio:.3}")),
            if kept { "yes" } else { "no" },
        ])?;
    }
    std::fs::write(out, writer.into_inner()?)
        .with_context(|| format!("cannot write {}", out.display()))?;
    let words = held.map(|(kind, count)| format!("{count} of {SCENES} {}", kind.plural()));
    let words = format!("auto: {}", words.join(", "));
    if held.iter().any(|(_, count)| *count < SCENES) {
        bail!("{words}: see {}", out.display());
    }
    Ok(words)
}
