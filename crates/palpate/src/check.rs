//! Forecast of what a study will do, without running it.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::time::Duration;

use palpate_scene::{Ladder, Need, Scene, Scenes, SharedModels};
use palpate_study::config::{
    ConfigError, ModelConfig, PressSensorConfig, RollModelConfig, SceneConfig, Study, StudyConfig,
};
use palpate_sweep::{Clock, Pace, Runner, SweepError, Trial, spread};

use crate::asked::refuse;
use crate::costs::{self, Cost};
use crate::plan::bare;
use crate::tested::{Tested, tested};
use crate::trial::SceneTrial;

/// Times after which no more scenes are set up as they are run, no more trials are timed, and no more rungs of ladders
/// are measured.
const SETTING_UP: Duration = Duration::from_millis(800);
/// Time after which no more cells are set up at all, of a study of which every cell should be.
const WHOLE: Duration = Duration::from_secs(10);
const TIMING: Duration = Duration::from_millis(300);
const LADDERS: Duration = Duration::from_millis(600);
/// Longest trial of a roll whose ladder is measured.
const LONG_TRIAL: Duration = Duration::from_millis(50);

/// Valid study: what a run of it will do, and what that will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Number of cells.
    pub cells: usize,
    /// Number of cells whose settings were checked together; of the others each swept value was checked by itself.
    pub checked: usize,
    /// Number of cells that were set up as they are run; of the others as many as there was time for were set up without a
    /// camera.
    pub set_up: usize,
    /// Number of the cells set up that run a single trial, because nothing in them is random.
    pub single: usize,
    /// Number of trials; where not all cells were set up, the most that there can be.
    pub trials: u64,
    /// Cells that were set up, by the models that they need.
    pub groups: Vec<CellGroup>,
    /// Number of the cells set up whose intervals were tested alike, or not for the same reason.
    pub intervals: Vec<(usize, Tested)>,
    /// Time that planning and the run will take, roughly, s.
    pub seconds: f64,
    /// Number of threads that this time is for.
    pub threads: NonZeroUsize,
}

/// Cells that need the same models.
#[derive(Clone, Debug, PartialEq)]
pub struct CellGroup {
    /// Number of the cells.
    pub cells: usize,
    /// One line per model that each cell needs, with the reason, and one line per warning.
    pub needs: Vec<String>,
    /// Means that scenes of this kind may need and these do not: "integrator".
    pub needless: Vec<&'static str>,
    /// Models by which their truth can be computed.
    pub rungs: Rungs,
}

/// Models by which the truth of a group's first cell can be computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Rungs {
    /// There is nothing to choose.
    None,
    /// Not measured, to be quick.
    NotMeasured,
    /// Measured in an earlier group, whose first cell has this number.
    AsIn(usize),
    /// Measured in this cell.
    Measured {
        /// Number of the cell.
        cell: usize,
        /// Rungs with their errors.
        ladder: Ladder,
        /// Index of the rungs about that which is taken, with the cost of each where it was measured.
        costs: Vec<(usize, Option<Cost>)>,
    },
}

/// Checks a study: sets up its cells, as many as there is time for, measures their models, and times a few trials. Of a study
/// of many cells it sets up those of the [sample](Study::sample). `progress` is told the number of cells looked at so far,
/// and of how many.
///
/// ```
/// use std::time::Instant;
/// use palpate::{RunOptions, Runner};
///
/// let text = r#"
/// name = "balls"
/// trials = 100
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
/// [[sweep]]
/// path = "scene.object.radius"
/// values = [30.0, 60.0]
/// "#;
/// let study = palpate::parse("balls.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let start = Instant::now();
/// let check = palpate::check(&study, &runner, &|| start.elapsed(), &|_, _| ())?;
/// assert_eq!((check.cells, check.trials), (2, 200));
/// assert!(check.groups[0].needs[0].starts_with("closed form"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SweepError::SetUp`] as [`refuse`], and at the field of the first cell found that makes no scene; [`SweepError`] where
/// trials cannot be timed.
pub fn check(
    study: &Study,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, usize),
) -> Result<Check, SweepError<ConfigError>> {
    refuse(study).map_err(SweepError::SetUp)?;
    let start = clock();
    let scenes = scenes(study, clock, progress).map_err(SweepError::SetUp)?;
    let share = study.cell_count() as f64 / scenes.len() as f64;
    let planning = clock().saturating_sub(start).as_secs_f64() * share;
    let trials: Vec<u64> = scenes.iter().map(CellScene::trials).collect();
    let known = sum(trials.iter().copied());
    let asked = sum(scenes.iter().map(|one| one.config.trials));
    let trials_of_all = study.trials().saturating_sub(asked).saturating_add(known);
    let timed: Vec<&SceneTrial> = scenes.iter().map(|one| &one.trial).collect();
    let pace = Pace::of(runner, &timed, TIMING, clock);
    let groups = groups(study, &scenes, &pace, clock).map_err(SweepError::SetUp)?;
    let intervals = intervals(&scenes);
    let of_all = study.trials() as f64 / asked as f64;
    let threads = runner.threads();
    Ok(Check {
        cells: study.cell_count(),
        checked: study.sample().len(),
        set_up: scenes.len(),
        single: trials.iter().filter(|&&trials| trials == 1).count(),
        trials: trials_of_all,
        groups,
        intervals,
        seconds: planning + of_all * pace.run_seconds(&trials, threads),
        threads,
    })
}

/// Sum of counts, at most the largest number of 64 bits.
fn sum(counts: impl Iterator<Item = u64>) -> u64 {
    counts.fold(0, u64::saturating_add)
}

/// Cell that has been set up.
struct CellScene {
    number: usize,
    config: StudyConfig,
    trial: SceneTrial,
}

impl CellScene {
    fn trials(&self) -> u64 {
        self.trial.scene.trials(self.config.trials)
    }

    /// Scene whose costs are measured: of a press, one that is read without a camera, so that it is quick to set up.
    fn measured(&self) -> SceneConfig {
        match &self.config.scene {
            scene @ SceneConfig::Press(_) => bare(scene),
            scene => scene.clone(),
        }
    }

    /// Whether a camera reads a press: it sees markers at other depths than those at which displacements are read
    /// without one.
    fn has_camera(&self) -> bool {
        match &self.config.scene {
            SceneConfig::Press(press) => !matches!(press.sensor, PressSensorConfig::Direct { .. }),
            _ => false,
        }
    }
}

/// Scenes of the cells of the study's sample, in order, as many as there is time for; once the time is up, presses are set
/// up without a camera, and dropped, and where the sample is not the whole study, no more cells are.
fn scenes(
    study: &Study,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<CellScene>, ConfigError> {
    let (start, sample) = (clock(), study.sample());
    let is_whole = sample.len() == study.cell_count();
    let (mut scenes, parts) = (Vec::new(), SharedModels::default());
    for (done, place) in spread(sample.len()).enumerate() {
        progress(done, sample.len());
        let number = sample[place];
        let spent = clock().saturating_sub(start);
        let is_late = !scenes.is_empty() && spent >= SETTING_UP;
        if is_late && (!is_whole || spent >= WHOLE) {
            break;
        }
        let cell = study.cell(number)?;
        if is_late && matches!(cell.config.scene, SceneConfig::Press(_)) {
            Scene::of(&bare(&cell.config.scene), cell.config.seed, &parts)
                .map_err(|error| study.error_at(number, &error.path, error.message))?;
        } else {
            let scene = study.estimable_scene_of(number, &cell, &parts)?;
            scenes.push(CellScene {
                number,
                config: cell.config,
                trial: SceneTrial::new(scene),
            });
        }
    }
    scenes.sort_by_key(|one| one.number);
    Ok(scenes)
}

/// Groups of cells that need the same models, with the rungs of their ladders.
fn groups(
    study: &Study,
    scenes: &[CellScene],
    pace: &Pace,
    clock: &Clock<'_>,
) -> Result<Vec<CellGroup>, ConfigError> {
    let mut groups: Vec<CellGroup> = Vec::new();
    let mut places: HashMap<Vec<String>, usize> = HashMap::new();
    let mut firsts = Vec::new();
    for (place, one) in scenes.iter().enumerate() {
        let needs: Vec<String> = one
            .trial
            .scene
            .needs()
            .iter()
            .map(Need::to_string)
            .collect();
        match places.get(&needs) {
            Some(&known) => groups[known].cells += 1,
            None => {
                places.insert(needs.clone(), groups.len());
                groups.push(CellGroup {
                    cells: 1,
                    needs,
                    needless: Vec::new(),
                    rungs: Rungs::NotMeasured,
                });
                firsts.push((place, one));
            }
        }
    }
    let deadline = clock() + LADDERS;
    let mut told: Vec<(SceneConfig, bool, usize)> = Vec::new();
    for (group, (place, one)) in groups.iter_mut().zip(firsts) {
        let cell = one.number;
        let (scene, has_camera) = (one.measured(), one.has_camera());
        let like = |known: &&(SceneConfig, bool, usize)| known.0 == scene && known.1 == has_camera;
        if let Some((.., other)) = told.iter().find(like) {
            group.rungs = Rungs::AsIn(*other);
            continue;
        }
        // The ladder of a roll follows its contacts on every rung, as a trial does on one.
        let is_roll = matches!(one.config.scene, SceneConfig::Roll(_));
        let is_long = is_roll && pace.seconds_per_trial(place) > LONG_TRIAL.as_secs_f64();
        let in_time = clock() < deadline && !is_long;
        let ladder = match in_time {
            true => study.ladder_of(cell, &one.trial.scene)?,
            false => None,
        };
        let taken = ladder.as_ref().map(|ladder| &ladder.taken().model);
        group.needless = needless(&one.trial, &one.config.scene, taken);
        group.rungs = match ladder {
            Some(ladder) => {
                let measured = (&scene, one.config.seed);
                let costs = costs::of_neighbours(measured, &ladder, deadline, clock);
                told.push((scene, has_camera, cell));
                Rungs::Measured {
                    cell,
                    ladder,
                    costs,
                }
            }
            None if in_time => Rungs::None,
            None => Rungs::NotMeasured,
        };
    }
    Ok(groups)
}

/// Verdicts of random scenes on the intervals of scenes, with the number of those of which it is told.
fn intervals(scenes: &[CellScene]) -> Vec<(usize, Tested)> {
    let mut told: Vec<(usize, Tested)> = Vec::new();
    for one in scenes {
        let tested = tested(&one.config.scene, one.config.length_unit);
        match told.iter_mut().find(|(_, known)| *known == tested) {
            Some((cells, _)) => *cells += 1,
            None => told.push((1, tested)),
        }
    }
    told
}

/// Means which scenes of this kind may need and this one does not.
fn needless(
    trial: &SceneTrial,
    scene: &SceneConfig,
    taken: Option<&ModelConfig>,
) -> Vec<&'static str> {
    let integrates = !matches!(
        taken,
        Some(ModelConfig::Roll(
            RollModelConfig::ClosedForm {} | RollModelConfig::Meridian {}
        ))
    );
    let renders = match scene {
        SceneConfig::Press(press) => matches!(press.sensor, PressSensorConfig::Rendered(_)),
        _ => true,
    };
    [
        (trial.is_random(), "random numbers"),
        (integrates, "integrator"),
        (renders, "frames"),
    ]
    .into_iter()
    .filter_map(|(needs, what)| (!needs).then_some(what))
    .collect()
}
