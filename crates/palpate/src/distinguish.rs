//! How surely trials tell the swept objects of a study apart.

mod error;
mod figure;
mod found;
mod json;
mod objects;
mod words;

use palpate_scene::{Scenes, quantities_of};
use palpate_study::Quantity;
use palpate_study::config::{SceneConfig, Study};
use palpate_sweep::{Runner, TrialMeans, both_above, in_order, repeats};

use crate::trial::SceneTrial;
use error::MOST_CELLS;
use objects::grouped;

pub use error::DistinguishError;
pub use found::{Group, Object, Pair, ToldApart};

/// Share of places of a patch above which a class is that of most.
const MOST_PLACES: f64 = 0.5;
/// Trial numbers of a cell, so that no two cells draw the same random numbers.
const APART: u64 = 1 << 40;

/// Tells how surely one trial of each of two objects puts them in the right order, for every two objects that a study
/// sweeps, and how many trials do it with the probability `confidence`.
///
/// The quantity is `quantity`, or else the object's curvature: of a press `object_curvature`, of others `mean_curvature`. A
/// trial that fails, and estimates that are alike, do not tell. By the quantity `class` of a glide two objects are told
/// apart where most places of each are classified right; objects of one class never are.
///
/// ```
/// use palpate::{RunOptions, Runner};
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
/// let study = palpate::parse("balls.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let told = palpate::distinguish(&study, None, 0.95, &runner, &|_, _| ())?;
/// let pairs = &told.groups[0].pairs;
/// // The flatter object first: 60 and 21, 60 and 20, 21 and 20.
/// let far = pairs[0].order.ok_or("of different truths")?;
/// let near = pairs[2].order.ok_or("of different truths")?;
/// assert!(near.probability < far.probability && far.probability > 0.99);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DistinguishError`].
pub fn distinguish(
    study: &Study,
    quantity: Option<&str>,
    confidence: f64,
    runner: &Runner,
    progress: &dyn Fn(usize, usize),
) -> Result<ToldApart, DistinguishError> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return Err(DistinguishError::Confidence(confidence));
    }
    let cells = study.cell_count();
    if cells > MOST_CELLS {
        return Err(DistinguishError::TooManyCells(cells));
    }
    // A wrong name is told before the lack of objects.
    let first = study.cell(0)?.config.scene;
    place_of(quantities_of(&first), first.kind(), quantity)?;
    let layout = grouped(study)?;
    let mut told: Vec<Vec<TrialMeans>> = Vec::with_capacity(cells);
    let mut facts: Vec<(Option<&'static str>, Quantity)> = Vec::with_capacity(cells);
    for cell in 0..cells {
        progress(cell, cells);
        let trial = SceneTrial::new(study.estimable_scene(cell)?);
        let kind = study.cell(cell)?.config.scene.kind();
        let (place, found) = place_of(trial.scene.quantities(), kind, quantity)?;
        let first = cell as u64 * APART;
        let trials = study.trials_of(cell).min(APART);
        told.push(runner.trial_means(&trial, place, first..first + trials));
        facts.push((trial.scene.true_class(), found));
    }
    let quantity = facts
        .first()
        .map_or(Quantity::MEAN_CURVATURE, |(_, found)| *found);
    let is_class = quantity == Quantity::CLASS;
    let limit = is_class.then_some(MOST_PLACES);
    let mut groups = Vec::new();
    for (settings, members) in layout.groups {
        let mut objects: Vec<Object> = members
            .iter()
            .map(|(cell, label)| {
                let truth = match is_class {
                    true => facts[*cell].0.map(str::to_owned),
                    false => None,
                };
                Object::of(*cell, label.clone(), &told[*cell], truth)
            })
            .collect();
        objects.sort_by(|one, other| match (one.truth, other.truth) {
            (Some(one), Some(other)) if !is_class => one.total_cmp(&other),
            _ => one.cell.cmp(&other.cell),
        });
        let mut places = Vec::new();
        for first in 0..objects.len() {
            places.extend((first + 1..objects.len()).map(|second| (first, second)));
        }
        let pair = |(first, second): (usize, usize)| {
            let (low, high) = (&objects[first], &objects[second]);
            let (of_low, of_high) = (&told[low.cell], &told[high.cell]);
            let differ = match is_class {
                true => low.class.is_some() && high.class.is_some() && low.class != high.class,
                false => low.truth.is_some() && high.truth.is_some() && low.truth != high.truth,
            };
            let order = match limit {
                Some(limit) => both_above(of_low, of_high, limit),
                None => in_order(of_low, of_high),
            };
            Pair {
                first,
                second,
                order: differ.then_some(order),
                repeats: differ.then(|| repeats(of_low, of_high, limit, confidence)),
            }
        };
        let pairs = runner.map(places.len(), |place| pair(places[place]));
        groups.push(Group {
            settings,
            objects,
            pairs,
        });
    }
    Ok(ToldApart {
        unit: quantity.unit.of(study.config.length_unit),
        quantity,
        confidence,
        trials: trials(&study.config.scene),
        object_columns: layout.objects,
        columns: layout.others,
        groups,
    })
}

/// Name of the repeated experiment. A trial of a roll scene consists of several rolls.
fn trials(scene: &SceneConfig) -> String {
    match scene {
        SceneConfig::Press(_) => "presses".to_owned(),
        SceneConfig::Glide(_) => "glides".to_owned(),
        SceneConfig::Roll(roll) => format!("trials of {} rolls", roll.motion.directions_deg.len()),
        _ => "trials".to_owned(),
    }
}

/// Place and name of the quantity by which objects are told apart.
fn place_of(
    quantities: &'static [Quantity],
    kind: &'static str,
    asked: Option<&str>,
) -> Result<(usize, Quantity), DistinguishError> {
    let usual = [Quantity::OBJECT_CURVATURE, Quantity::MEAN_CURVATURE];
    let find = |name: &str| quantities.iter().position(|one| one.name == name);
    let found = match asked {
        Some(name) => find(name),
        None => usual.iter().find_map(|usual| find(usual.name)),
    };
    let known: Vec<&str> = quantities.iter().map(|one| one.name).collect();
    let unknown = || DistinguishError::NoQuantity {
        scene: kind,
        name: asked.unwrap_or(Quantity::MEAN_CURVATURE.name).to_owned(),
        known: known.join(", "),
    };
    let place = found.ok_or_else(unknown)?;
    Ok((place, quantities[place]))
}
