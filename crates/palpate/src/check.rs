//! Forecast of a study without running it: the models that it needs, its number of trials and its run time.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::time::Duration;

use palpate_scene::{Arch, Ladder, Need, Scene, SceneTrial, Scenes, SharedModels};
use palpate_study::config::{
    ConfigError, ModelConfig, PressSensorConfig, RollModelConfig, SceneConfig, Study, StudyConfig,
};
use palpate_sweep::{Clock, Runner, SweepError, Trial};

use crate::coverage::{Coverage, coverage};
use crate::ladder_timing::neighbour_times;
use crate::output_check::check_outputs;
use crate::plan::with_ideal_sensor;
use crate::planner::{Pace, spread};

/// Time limit for setting up cells completely, that is, including the camera if a camera reads the press.
const SET_UP_LIMIT: Duration = Duration::from_millis(800);
/// Time limit for the set-up of cells after [`SET_UP_LIMIT`]; presses are then set up without their camera. It applies
/// only if all cells of the study are checked. In a large study, only a sample is checked, and set-up ends at
/// [`SET_UP_LIMIT`].
const SET_UP_WITHOUT_CAMERA_LIMIT: Duration = Duration::from_secs(10);
/// Time limit for running a few trials to measure the time per trial.
const TRIALS_LIMIT: Duration = Duration::from_millis(300);
/// Time limit for measuring the errors and the computing times of contact models, for all groups of cells together.
const LADDERS_LIMIT: Duration = Duration::from_millis(600);
/// If a trial of a roll takes longer than this time, the errors and computing times of the roll models are not
/// measured.
const MAX_TRIAL_TIME: Duration = Duration::from_millis(50);

/// Forecast of a study, made by [`check()`].
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Number of cells of the study.
    pub cells: usize,
    /// Number of cells that were checked. Each swept value of the unchecked cells also occurs in a checked cell, but in
    /// another combination.
    pub checked: usize,
    /// Number of cells that were set up completely. Presses that were set up without their camera, to save time, are
    /// not counted.
    pub set_up: usize,
    /// Number of cells that run only one trial, because they use no random numbers. Only cells that were set up are
    /// counted.
    pub single: usize,
    /// Number of trials of all cells. If not all cells were set up, this is an upper limit.
    pub trials: u64,
    /// Groups of cells that need the same models. Only cells that were set up completely are in a group.
    pub groups: Vec<CellGroup>,
    /// Measured coverages of the 95 % intervals. Each different coverage is listed once, with the number of cells that
    /// have it. Only cells that were set up completely are counted.
    pub intervals: Vec<(usize, Coverage)>,
    /// Estimated time of planning and run together, s.
    pub seconds: f64,
    /// Number of threads that the estimated time assumes.
    pub threads: NonZeroUsize,
}

/// Group of cells of the study that need the same models and have the same warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct CellGroup {
    /// Number of cells in the group.
    pub cells: usize,
    /// One line of text per model that the group needs, with the reason for this model, and one line per warning. The
    /// lines apply to every cell of the group.
    pub needs: Vec<String>,
    /// Parts of the simulation that the cells of this group do not need, although other scenes of the same kind (rolls,
    /// glides or presses) need them; for example "integrator".
    pub needless: Vec<&'static str>,
    /// Models that can compute the true contacts or displacements of the first cell in this group of cells.
    pub rungs: Rungs,
}

/// The models that can compute the true contacts or displacements in a cell (a grid point of a study), from the cheapest
/// to the most exact. A model is also called a rung.
#[derive(Clone, Debug, PartialEq)]
pub enum Rungs {
    /// At most one model can compute the true contacts or displacements, so there is nothing to choose.
    None,
    /// The errors and computing times of the models were not measured, because the measurement would have taken too
    /// long.
    NotMeasured,
    /// The models are the same as in an earlier group of cells. The number is the number of the first cell of that
    /// group.
    AsIn(usize),
    /// The errors and computing times of the models were measured in the cell `cell`.
    Measured {
        /// Number of the cell in which the models were measured.
        cell: usize,
        /// The models with their errors, cheapest first.
        ladder: Ladder,
        /// Index in `ladder` and computing time (s) of the chosen model, and of its neighbours: the next cheaper and
        /// the next more exact model that can compute the scene, and all models between them. It is the time of a
        /// trial for a roll, and of the set-up for a glide or a press. A time is `None` if it was not measured.
        times: Vec<(usize, Option<f64>)>,
    },
}

/// Forecasts the models, the number of trials and the run time of a study. Sets up as many cells as a time limit
/// allows, measures the errors and times of their models, and measures the time of a few trials. For a study with many
/// cells, only the [sample](Study::sample) of cells is used. `progress` receives the number of checked cells and the
/// number of cells to check.
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
/// [`SweepError::SetUp`] for an error of [`check_outputs`], and for the first cell with an invalid field; other
/// [`SweepError`]s if running trials to measure their time fails.
pub fn check(
    study: &Study,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, usize),
) -> Result<Check, SweepError<ConfigError>> {
    check_outputs(study).map_err(SweepError::SetUp)?;
    let start = clock();
    let scenes = scenes(study, clock, progress).map_err(SweepError::SetUp)?;
    let share = study.cell_count() as f64 / scenes.len() as f64;
    let planning = clock().saturating_sub(start).as_secs_f64() * share;
    let trials: Vec<u64> = scenes.iter().map(CellScene::trials).collect();
    let known = sum(trials.iter().copied());
    let asked = sum(scenes.iter().map(|one| one.config.trials));
    let trials_of_all = study.trials().saturating_sub(asked).saturating_add(known);
    let timed: Vec<&SceneTrial> = scenes.iter().map(|one| &one.trial).collect();
    let pace = Pace::of(runner, &timed, TRIALS_LIMIT, clock);
    let groups = groups(study, &scenes, &pace, clock).map_err(SweepError::SetUp)?;
    let intervals = intervals(&scenes);
    let of_all = study.trials() as f64 / asked as f64;
    let threads = runner.threads();
    Ok(Check {
        cells: study.cell_count(),
        checked: study.sample.len(),
        set_up: scenes.len(),
        single: trials.iter().filter(|&&trials| trials == 1).count(),
        trials: trials_of_all,
        groups,
        intervals,
        seconds: planning + of_all * pace.run_seconds(&trials, threads),
        threads,
    })
}

fn sum(counts: impl Iterator<Item = u64>) -> u64 {
    counts.fold(0, u64::saturating_add)
}

struct CellScene {
    number: usize,
    config: StudyConfig,
    trial: SceneTrial,
}

impl CellScene {
    fn trials(&self) -> u64 {
        self.trial.scene.trials(self.config.trials)
    }

    /// Config of the scene whose computing time is measured. A press is measured without its camera, because setting
    /// up a camera is slow.
    fn measured(&self) -> SceneConfig {
        match &self.config.scene {
            scene @ SceneConfig::Press(_) => with_ideal_sensor(scene),
            scene => scene.clone(),
        }
    }

    /// Whether a camera reads a press. With a camera, the markers lie at other depths than for a direct reading, so
    /// the errors of the models differ.
    fn has_camera(&self) -> bool {
        let scene = &self.config.scene;
        matches!(scene, SceneConfig::Press(press) if press.sensor.camera().is_some())
    }
}

/// Sets up the scenes of the study's sample, until the time limit. If the sample is the whole study, the remaining
/// presses are then set up without their camera. This finds their invalid fields, but their scenes are not returned.
fn scenes(
    study: &Study,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<CellScene>, ConfigError> {
    let (start, sample) = (clock(), &study.sample);
    let is_whole = sample.len() == study.cell_count();
    let (mut scenes, parts) = (Vec::new(), SharedModels::default());
    for (done, place) in spread(sample.len()).enumerate() {
        progress(done, sample.len());
        let number = sample[place];
        let spent = clock().saturating_sub(start);
        let is_late = !scenes.is_empty() && spent >= SET_UP_LIMIT;
        if is_late && (!is_whole || spent >= SET_UP_WITHOUT_CAMERA_LIMIT) {
            break;
        }
        let cell = study.cell(number)?;
        if is_late && matches!(cell.config.scene, SceneConfig::Press(_)) {
            Scene::new(
                &with_ideal_sensor(&cell.config.scene),
                cell.config.length_unit,
                cell.config.seed,
                &parts,
            )
            .map_err(|error| study.error_at(number, error))?;
        } else {
            let scene = study.estimable_scene_of(number, &cell, &parts)?;
            scenes.push(CellScene {
                number,
                config: cell.config,
                trial: SceneTrial {
                    scene,
                    arch: Arch::new(),
                },
            });
        }
    }
    scenes.sort_by_key(|one| one.number);
    Ok(scenes)
}

/// Groups the cells by the models that they need, and measures the models of each group.
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
    let deadline = clock() + LADDERS_LIMIT;
    let mut measured: Vec<(SceneConfig, bool, usize)> = Vec::new();
    for (group, (place, one)) in groups.iter_mut().zip(firsts) {
        let cell = one.number;
        let (scene, has_camera) = (one.measured(), one.has_camera());
        let like = |known: &&(SceneConfig, bool, usize)| known.0 == scene && known.1 == has_camera;
        if let Some((.., other)) = measured.iter().find(like) {
            group.rungs = Rungs::AsIn(*other);
            continue;
        }
        // Measuring the error and the time of one roll model takes as long as a trial. Therefore, if a trial is slow,
        // the models are not measured.
        let is_roll = matches!(one.config.scene, SceneConfig::Roll(_));
        let is_long = is_roll && pace.seconds_per_trial(place) > MAX_TRIAL_TIME.as_secs_f64();
        let in_time = clock() < deadline && !is_long;
        let ladder = match in_time {
            true => {
                let ladder = one.trial.scene.ladder();
                ladder.map_err(|error| study.error_at(cell, error))?
            }
            false => None,
        };
        let taken = ladder.as_ref().map(|ladder| &ladder.taken().model);
        group.needless = needless(&one.trial, &one.config.scene, taken);
        group.rungs = match ladder {
            Some(ladder) => {
                let times = {
                    let scene = (&scene, one.config.length_unit, one.config.seed);
                    neighbour_times(scene, &ladder, deadline, clock)
                };
                measured.push((scene, has_camera, cell));
                Rungs::Measured {
                    cell,
                    ladder,
                    times,
                }
            }
            None if in_time => Rungs::None,
            None => Rungs::NotMeasured,
        };
    }
    Ok(groups)
}

/// Measured coverages of the 95 % intervals of the scenes. Each different coverage is listed once, with the number of
/// scenes that have it.
fn intervals(scenes: &[CellScene]) -> Vec<(usize, Coverage)> {
    let mut all: Vec<(usize, Coverage)> = Vec::new();
    for one in scenes {
        let coverage = coverage(&one.config.scene, one.config.length_unit);
        match all.iter_mut().find(|(_, known)| *known == coverage) {
            Some((cells, _)) => *cells += 1,
            None => all.push((1, coverage)),
        }
    }
    all
}

/// Parts of the simulation that this scene does not need, although other scenes of the same kind (rolls, glides or
/// presses) need them.
fn needless(
    trial: &SceneTrial,
    scene: &SceneConfig,
    taken: Option<&ModelConfig>,
) -> Vec<&'static str> {
    use RollModelConfig::{ClosedForm, Meridian};
    let integrates = !matches!(taken, Some(ModelConfig::Roll(ClosedForm {} | Meridian {})));
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
