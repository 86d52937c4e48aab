//! Checks the answers of two commands. Boundaries that `palpate design` finds are compared with a reference that has
//! 100 times the trials. Probabilities that `palpate distinguish` estimates are compared with pairs of fresh trials.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use palpate::{
    Order, Question, Region, RunOptions, Runner, SceneTrial, Scenes, design, distinguish, parse,
};

use crate::answer_scenes::{DESIGNS, Design, OBJECTS, Objects};
use crate::csv_table::Column;

const DESIGN: &str = "design";
const DISTINGUISH: &str = "distinguish";
/// Gap of the reference answer, divided by the gap of the checked answer. The gap of a `design` answer lies between the
/// values that meet the target and the values that miss it; in the gap, the answer is undecided. A gap that is ten
/// times smaller needs 100 times the trials.
const REFERENCE_GAP: f64 = 0.1;
const REFERENCE_SEED: u64 = 1_000_003;
/// Number of the first fresh trial. `distinguish` estimates its probabilities from trials with smaller numbers, so
/// fresh trials test these probabilities independently.
const FRESH: u64 = 1 << 50;
/// Number of trial numbers that are reserved for the fresh trials of each grid point. It is so large that no two grid
/// points use the same random numbers.
const APART: u64 = 1 << 40;
const HALF_WIDTH_95: f64 = 1.96;

/// Options for checking the answers of `design` and `distinguish`.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Number of seeds with which each scene is run.
    pub seeds: u64,
    /// Number of pairs of fresh trials for the test of each probability from `distinguish`.
    pub pairs: u64,
    /// Run only scenes whose names contain these words.
    pub only: &'a str,
}

/// How many of the answers for a scene are correct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Score {
    /// The checked command: `design` or `distinguish`.
    pub command: &'static str,
    /// Name of the scene.
    pub scene: &'static str,
    /// Number of checked answers for the scene.
    pub cases: u64,
    /// Number of correct answers for the scene.
    pub right: u64,
}

impl Score {
    /// The score as columns of the table of scores.
    pub fn columns(&self) -> [Column; 4] {
        [
            ("command", self.command.to_owned()),
            ("scene", self.scene.to_owned()),
            ("cases", self.cases.to_string()),
            ("right", self.right.to_string()),
        ]
    }
}

/// Computes the scores of all scenes. Calls `report` with each score as soon as it is computed.
///
/// # Errors
/// An error if a scene cannot be set up.
pub fn scores(options: Options<'_>, report: impl Fn(&Score)) -> Result<Vec<Score>> {
    let runner = Runner::new(&RunOptions::default())?;
    let mut scores = Vec::new();
    let mut push = |score: Score| {
        report(&score);
        scores.push(score);
    };
    for scene in DESIGNS
        .iter()
        .filter(|scene| scene.name.contains(options.only))
    {
        push(design_score(scene, &runner, options.seeds)?);
    }
    for scene in OBJECTS
        .iter()
        .filter(|scene| scene.name.contains(options.only))
    {
        push(distinguish_score(scene, &runner, options)?);
    }
    Ok(scores)
}

/// Fails if too few answers are correct. Of all answers of `design`, at least 183 of 200 must be correct, and for each
/// scene at least 16 of 20. Of the probabilities of `distinguish`, at least 19 of 20 must be correct.
///
/// An answer should be correct with a probability of 95 %. Then at least 183 of 200 answers are correct with a
/// probability of 98.8 %, and at least 16 of 20 answers with a probability of 99.7 %.
///
/// # Errors
/// An error if too few answers are correct.
pub fn check(scores: &[Score]) -> Result<()> {
    let of = |command: &str| {
        let scores = scores.iter().filter(|score| score.command == command);
        scores.fold((0, 0), |(cases, right), score| {
            (cases + score.cases, right + score.right)
        })
    };
    let ((cases, right), (pairs, pairs_right)) = (of(DESIGN), of(DISTINGUISH));
    ensure!(
        200 * right >= 183 * cases,
        "design: {right} of {cases} answers are right"
    );
    ensure!(
        20 * pairs_right >= 19 * pairs,
        "distinguish: {pairs_right} of {pairs} probabilities are within their intervals"
    );
    for score in scores.iter().filter(|score| score.command == DESIGN) {
        let (scene, cases, right) = (&score.scene, score.cases, score.right);
        ensure!(20 * right >= 16 * cases, "{scene}: {right} of {cases}");
    }
    Ok(())
}

/// Answers the scene's `design` question with each seed, and counts the answers that agree with a reference answer.
fn design_score(scene: &Design, runner: &Runner, seeds: u64) -> Result<Score> {
    let ask = |seed: u64, gap: f64| -> Result<Region> {
        let mut study = parse(scene.name, scene.config)?;
        study.override_numbers(Some(seed), None)?;
        let mut question = Question::new(scene.target.parse()?, vec![scene.vary.parse()?], None)?;
        question.gap = gap;
        question.most_trials = 1 << 32;
        let start = Instant::now();
        let answer = design(&study, &question, runner, &|| start.elapsed(), &|_, _| ());
        answer.with_context(|| scene.name)
    };
    let reference = ask(REFERENCE_SEED, scene.gap * REFERENCE_GAP)?;
    let mut right = 0;
    for seed in 0..seeds {
        right += u64::from(is_right_design(&ask(seed, scene.gap)?, &reference));
    }
    Ok(Score {
        command: DESIGN,
        scene: scene.name,
        cases: seeds,
        right,
    })
}

/// Whether an answer of `design` is correct. It must contain a range of values that meet the target and a range of
/// values that miss it. At both ends of each range, the reference answer must not state the opposite.
fn is_right_design(answer: &Region, reference: &Region) -> bool {
    let [answer, reference] = [answer, reference].map(|region| &region.columns[0]);
    let is_wrong = |value: f64, meets: bool| {
        let mut runs = reference.runs.iter();
        runs.any(|run| run.meets != meets && (run.from..=run.to).contains(&value))
    };
    let mut ends = answer
        .runs
        .iter()
        .flat_map(|run| [(run.from, run.meets), (run.to, run.meets)]);
    [true, false].map(|meets| answer.runs.iter().any(|run| run.meets == meets)) == [true; 2]
        && !ends.any(|(value, meets)| is_wrong(value, meets))
}

/// Checks each probability that `distinguish` estimates; there is one for each pair of objects and seed. It is compared
/// with a measured share: the share of pairs of fresh trials whose estimates are in the right order.
fn distinguish_score(scene: &Objects, runner: &Runner, options: Options<'_>) -> Result<Score> {
    let (config, radii) = (scene.config, scene.radii);
    let sweep = format!("[[sweep]]\npath = \"scene.object.radius\"\nvalues = {radii:?}\n");
    let mut study = parse(scene.name, &format!("{config}{sweep}"))?;
    study.override_numbers(None, Some(scene.trials))?;
    let mut fresh = Vec::new();
    for cell in 0..study.cell_count() {
        let trial = SceneTrial {
            scene: study.estimable_scene(cell)?,
            arch: palpate_scene::Arch::new(),
        };
        let mut names = trial.scene.quantities().iter();
        let place = names.position(|one| one.name == scene.quantity);
        let place = place.with_context(|| format!("{} has no {}", scene.name, scene.quantity))?;
        let first = FRESH + cell as u64 * APART;
        fresh.push(runner.trial_means(&trial, place, first..first + options.pairs));
    }
    let mut score = Score {
        command: DISTINGUISH,
        scene: scene.name,
        cases: 0,
        right: 0,
    };
    for seed in 0..options.seeds {
        study.override_numbers(Some(seed), None)?;
        let answer = distinguish(&study, Some(scene.quantity), 0.95, runner, &|_, _| ())?;
        for group in &answer.groups {
            for pair in &group.pairs {
                let order = pair.order;
                let order = order.with_context(|| format!("{} has twins", scene.name))?;
                let [low, high] =
                    [pair.first, pair.second].map(|one| &fresh[group.objects[one].cell]);
                let pairs = low.iter().zip(high);
                let pairs = pairs.filter_map(|(low, high)| low.ok().zip(high.ok()));
                let in_order = pairs.filter(|((low, _), (high, _))| low < high).count();
                let share = in_order as f64 / low.len().max(1) as f64;
                score.cases += 1;
                score.right += u64::from(is_right_order(order, share, low.len()));
            }
        }
    }
    Ok(score)
}

/// Whether the estimated probability of the right order agrees with `share`, the share of pairs of fresh trials in the
/// right order. The allowed difference combines the half-width of the probability's 95 % interval and the standard
/// error of the share.
fn is_right_order(order: Order, share: f64, pairs: usize) -> bool {
    let side = match share < order.probability {
        true => order.probability - order.low,
        false => order.high - order.probability,
    };
    let square_error = HALF_WIDTH_95 * HALF_WIDTH_95 * share * (1.0 - share) / pairs.max(1) as f64;
    let difference = share - order.probability;
    difference * difference <= side * side + square_error
}
