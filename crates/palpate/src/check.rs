//! Forecast of what a study will do, without running it.

use std::num::NonZeroUsize;
use std::time::Duration;

use palpate_scene::{Ladder, Scene, Scenes};
use palpate_study::config::{
    ConfigError, ModelConfig, PressSensorConfig, RollModelConfig, SceneConfig, Study, StudyConfig,
};
use palpate_sweep::{Clock, Pace, Runner, SweepError, Trial, spread};

use crate::costs::{self, Cost};
use crate::plan::bare;
use crate::trial::SceneTrial;

/// Times after which no more scenes are set up as they are run, no more trials are timed, and no more rungs of ladders
/// are measured.
const SETTING_UP: Duration = Duration::from_millis(800);
const TIMING: Duration = Duration::from_millis(300);
const LADDERS: Duration = Duration::from_millis(600);

/// Valid study: what a run of it will do, and what that will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Number of cells.
    pub cells: usize,
    /// Number of cells that were set up as they are run; the others were checked without a camera, to be quick.
    pub set_up: usize,
    /// Number of the cells set up that run a single trial, because nothing in them is random.
    pub single: usize,
    /// Number of trials; where not all cells were set up, the most that there can be.
    pub trials: u64,
    /// Cells that were set up, by the models that they need.
    pub groups: Vec<CellGroup>,
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
    /// Models that each of them needs and why, one line each.
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

/// Checks a study: sets up its cells, as many as there is time for, measures their models, and times a few trials.
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
/// let check = palpate::check(&study, &runner, &|| start.elapsed())?;
/// assert_eq!((check.cells, check.trials), (2, 200));
/// assert!(check.groups[0].needs[0].starts_with("closed form"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SweepError::SetUp`] at the field of the first cell found that makes no scene; [`SweepError`] where trials cannot be
/// timed.
pub fn check(
    study: &Study,
    runner: &Runner,
    clock: &Clock<'_>,
) -> Result<Check, SweepError<ConfigError>> {
    let start = clock();
    let scenes = scenes(study, clock).map_err(SweepError::SetUp)?;
    let share = study.cell_count() as f64 / scenes.len() as f64;
    let planning = clock().saturating_sub(start).as_secs_f64() * share;
    let trials: Vec<u64> = scenes.iter().map(CellScene::trials).collect();
    let known: u64 = trials.iter().sum();
    let is_unknown = |number: &usize| {
        let place = scenes.binary_search_by_key(number, |one| one.number);
        place.is_err()
    };
    let unknown = (0..study.cell_count()).filter(is_unknown);
    let unknown = unknown.filter_map(|number| study.cell(number).ok());
    let unknown: u64 = unknown.map(|cell| cell.config.trials).sum();
    let groups = groups(study, &scenes, clock).map_err(SweepError::SetUp)?;
    let timed: Vec<&SceneTrial> = scenes.iter().map(|one| &one.trial).collect();
    let pace = Pace::of(runner, &timed, TIMING, clock)
        .map_err(|error| error.map_set_up(|never| match never {}))?;
    let of_all = (known + unknown) as f64 / known as f64;
    let threads = runner.threads();
    Ok(Check {
        cells: study.cell_count(),
        set_up: scenes.len(),
        single: trials.iter().filter(|&&trials| trials == 1).count(),
        trials: known + unknown,
        groups,
        seconds: planning + of_all * pace.run_seconds(&trials, threads),
        threads,
    })
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

/// Scenes of the cells, in order, as many as there is time for; once the time is up, presses are set up without a camera,
/// and dropped.
fn scenes(study: &Study, clock: &Clock<'_>) -> Result<Vec<CellScene>, ConfigError> {
    let start = clock();
    let mut scenes = Vec::new();
    for number in spread(study.cell_count()) {
        let config = study.cell(number)?.config;
        let is_press = matches!(config.scene, SceneConfig::Press(_));
        let is_late = clock().saturating_sub(start) >= SETTING_UP;
        if is_press && !scenes.is_empty() && is_late {
            Scene::new(&bare(&config.scene), config.seed)
                .map_err(|error| study.error_at(number, &error.path, error.message))?;
        } else {
            scenes.push(CellScene {
                number,
                config,
                trial: SceneTrial::new(study.estimable_scene(number)?),
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
    clock: &Clock<'_>,
) -> Result<Vec<CellGroup>, ConfigError> {
    let mut groups: Vec<CellGroup> = Vec::new();
    let mut firsts = Vec::new();
    for one in scenes {
        let needs = one.trial.scene.needs();
        match groups.iter_mut().find(|known| known.needs == needs) {
            Some(known) => known.cells += 1,
            None => {
                groups.push(CellGroup {
                    cells: 1,
                    needs,
                    needless: Vec::new(),
                    rungs: Rungs::NotMeasured,
                });
                firsts.push(one);
            }
        }
    }
    let deadline = clock() + LADDERS;
    let mut told: Vec<(SceneConfig, bool, usize)> = Vec::new();
    for (group, one) in groups.iter_mut().zip(firsts) {
        let cell = one.number;
        let (scene, has_camera) = (one.measured(), one.has_camera());
        let like = |known: &&(SceneConfig, bool, usize)| known.0 == scene && known.1 == has_camera;
        if let Some((.., other)) = told.iter().find(like) {
            group.rungs = Rungs::AsIn(*other);
            continue;
        }
        let in_time = clock() < deadline;
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
