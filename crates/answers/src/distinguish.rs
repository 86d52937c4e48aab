//! Computes how reliably trials distinguish the swept objects of a study.

use palpate_scene::{Arch, SceneTrial, Scenes, quantities_of};
use palpate_study::Quantity;
use palpate_study::config::{SceneConfig, Study};
use palpate_sweep::{Runner, TrialMeans, in_order, repeats};

use crate::discrimination::{Discrimination, Group, Object, Pair};
use crate::error::{AnswerError, MAX_CELLS};

/// The classification of a surface patch counts as correct if more than this share of the points on the patch is
/// classified correctly.
const MAJORITY: f64 = 0.5;
/// The trials of cell i of the study (combination of swept values) are numbered from i times this constant. It is so
/// large that no two cells use the same trial numbers, because trials with equal numbers would draw equal random
/// numbers.
const TRIALS_PER_CELL: u64 = 1 << 40;

/// Computes two results for each pair of objects that a study sweeps. The first is the probability that one trial of
/// each object puts the two estimates in the order of the true values. The second is the number of trials of each
/// object that must be averaged, so that the two mean estimates are in this order with the probability `confidence`.
///
/// If `quantity` is `None`, the object's curvature is compared: `object_curvature` for a press, otherwise
/// `mean_curvature`. A failed trial distinguishes no objects. With the quantity `class` of a glide, two objects are
/// distinguished if most points of both patches are classified correctly. Objects of the same class are never
/// distinguished.
///
/// ```
/// use palpate_answers::distinguish;
/// use palpate_study::config::parse;
/// use palpate_sweep::{RunOptions, Runner};
///
/// let text = r#"
/// name = "balls"
/// length_unit = "mm"
/// trials = 2000
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
/// [[sweep]]
/// path = "scene.object.radius"
/// values = [20.0, 21.0, 60.0]
/// "#;
/// let study = parse("balls.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let found = distinguish(&study, None, 0.95, &runner, &|_, _| ())?;
/// let pairs = &found.groups[0].pairs;
/// // The flatter object first: 60 and 21, 60 and 20, 21 and 20.
/// let far = pairs[0].order.ok_or("of different truths")?;
/// let near = pairs[2].order.ok_or("of different truths")?;
/// assert!(near.probability < far.probability && far.probability > 0.99);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnswerError`] if the question has no answer.
pub fn distinguish(
    study: &Study,
    quantity: Option<&str>,
    confidence: f64,
    runner: &Runner,
    progress: &dyn Fn(usize, usize),
) -> Result<Discrimination, AnswerError> {
    AnswerError::unless_confidence(confidence)?;
    let cells = study.cell_count();
    if cells > MAX_CELLS {
        return Err(AnswerError::TooManyCells(cells));
    }
    // Check the quantity before the objects: if both are wrong, the error about the quantity is reported.
    let first = study.cell(0)?.config.scene;
    let (_, compared) = place_of(quantities_of(&first), first.kind(), quantity)?;
    let layout = grouped(study)?;
    let mut means: Vec<Vec<TrialMeans>> = Vec::with_capacity(cells);
    let mut classes: Vec<Option<&'static str>> = Vec::with_capacity(cells);
    for cell in 0..cells {
        progress(cell, cells);
        let trial = SceneTrial {
            scene: study.estimable_scene(cell)?,
            arch: Arch::new(),
        };
        let kind = study.cell(cell)?.config.scene.kind();
        let (place, _) = place_of(trial.scene.quantities(), kind, quantity)?;
        let first = cell as u64 * TRIALS_PER_CELL;
        let trials = study.trials_of(cell).min(TRIALS_PER_CELL);
        means.push(runner.trial_means(&trial, place, first..first + trials));
        classes.push(trial.scene.true_class());
    }
    let is_class = compared == Quantity::CLASS;
    let limit = is_class.then_some(MAJORITY);
    let group = |(settings, members): (Vec<String>, Members)| {
        let object = |(cell, label): (usize, Vec<String>)| {
            let class = classes[cell].filter(|_| is_class);
            Object::new(cell, label, &means[cell], class)
        };
        let mut objects: Vec<Object> = members.into_iter().map(object).collect();
        objects.sort_by(|one, other| match (one.truth, other.truth) {
            (Some(one), Some(other)) if !is_class => one.total_cmp(&other),
            _ => one.cell.cmp(&other.cell),
        });
        let places = (0..objects.len())
            .flat_map(|first| (first + 1..objects.len()).map(move |second| (first, second)));
        let places: Vec<(usize, usize)> = places.collect();
        let pairs = runner.map(places.len(), |place| {
            let (first, second) = places[place];
            let (low, high) = (&objects[first], &objects[second]);
            let (of_low, of_high) = (&means[low.cell], &means[high.cell]);
            let differ = match is_class {
                true => low.class.is_some() && high.class.is_some() && low.class != high.class,
                false => low.truth.is_some() && high.truth.is_some() && low.truth != high.truth,
            };
            let order = in_order(of_low, of_high, limit);
            Pair {
                first,
                second,
                order: differ.then_some(order),
                repeats: differ.then(|| repeats(of_low, of_high, limit, confidence)),
            }
        });
        Group {
            settings,
            objects,
            pairs,
        }
    };
    Ok(Discrimination {
        unit: compared.unit.of(study.config.length_unit),
        quantity: compared,
        confidence,
        trials: trials(&study.config.scene),
        object_columns: layout.objects,
        columns: layout.others,
        groups: layout.groups.into_iter().map(group).collect(),
    })
}

/// Name of the scene's trials in the plural, such as `presses`. For rolls, the name states the number of rolls per
/// trial.
fn trials(scene: &SceneConfig) -> String {
    match scene {
        SceneConfig::Press(_) => "presses".to_owned(),
        SceneConfig::Glide(_) => "glides".to_owned(),
        SceneConfig::Roll(roll) => format!("trials of {} rolls", roll.motion.directions().len()),
        _ => "trials".to_owned(),
    }
}

/// Returns the compared quantity, and its index among the quantities of the scene. If the user names no quantity, the
/// object's curvature is compared.
pub(crate) fn place_of(
    quantities: &'static [Quantity],
    kind: &'static str,
    wanted: Option<&str>,
) -> Result<(usize, Quantity), AnswerError> {
    let usual = [
        Quantity::OBJECT_CURVATURE.name,
        Quantity::MEAN_CURVATURE.name,
    ];
    let mut names = wanted.map_or(usual.to_vec(), |name| vec![name]).into_iter();
    let find = |name: &str| quantities.iter().position(|one| one.name == name);
    let place = names.clone().find_map(find);
    let name = names.next_back().unwrap_or_default();
    let place = place.ok_or_else(|| AnswerError::no_quantity(kind, name, quantities))?;
    Ok((place, quantities[place]))
}

/// The cells of a study (combinations of its swept values) in groups. Cells of a group differ only in the swept fields
/// that define the object.
struct Layout {
    objects: Vec<String>,
    others: Vec<String>,
    groups: Vec<(Vec<String>, Members)>,
}

/// The cells of a group. Each entry has the index of a cell of the study, and the values that define the cell's object.
type Members = Vec<(usize, Vec<String>)>;

fn grouped(study: &Study) -> Result<Layout, AnswerError> {
    let is_object = |path: &String| path == "scene.object" || path.starts_with("scene.object.");
    let texts_of = |of_object: bool, texts: &[String]| -> Vec<String> {
        let pairs = study.paths.iter().zip(texts);
        let chosen = pairs.filter(|(path, _)| is_object(path) == of_object);
        chosen.map(|(_, text)| text.clone()).collect()
    };
    let mut groups: Vec<(Vec<String>, Members)> = Vec::new();
    for cell in 0..study.cell_count() {
        let coordinates = study.cell(cell)?.coordinates;
        let (settings, label) = (texts_of(false, &coordinates), texts_of(true, &coordinates));
        match groups.iter_mut().find(|(known, _)| *known == settings) {
            Some((_, members)) => members.push((cell, label)),
            None => groups.push((settings, vec![(cell, label)])),
        }
    }
    groups.retain(|(_, members)| members.len() > 1);
    match study.paths.iter().any(is_object) && !groups.is_empty() {
        true => Ok(Layout {
            objects: texts_of(true, &study.columns),
            others: texts_of(false, &study.columns),
            groups,
        }),
        false => Err(AnswerError::NoObjects),
    }
}
