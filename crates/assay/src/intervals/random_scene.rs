//! Draws a random scene of a family, and simulates and estimates its trials.

use std::f64::consts::TAU;

use anyhow::{Context, Result};
use palpate::family_scene;
use palpate_scene::{PressFlaw, Scene, Scenes};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::{ReadingNoise, SceneConfig, parse, with_fields};
use palpate_sweep::Observation;
use serde_json::json;

/// Name of a column: the range of the objects' curvature in a family, that is, a group of similar random scenes. If the
/// range starts at a negative number, the objects are dishes (negative curvature) and balls. If it starts at 0, the
/// objects are quadrics with two waves, and the upper end of the range limits their curvature.
const CURVATURE: &str = "scene.object.curvature";
const INTEGERS: [&str; 2] = ["scene.motion.contacts_per_finger", "scene.sensor.size_px"];
/// Formula of a surface that is a quadric with two waves.
const WAVES: &str = "a*x*x + b*x*y + c*y*y + p*sin(k*x + l*y + f) + q*sin(m*x + n*y + g)";
/// Smallest and largest wave number of a wave, in units of 1 / (distance between the outermost fingers).
const WAVE_NUMBERS: [f64; 2] = [1.2, 4.8];

pub(super) struct RandomScene {
    scene: Scene,
    flaw: PressFlaw,
    /// Indices of the scene's quantities for which the coverage of intervals is measured.
    pub(super) quantities: Vec<usize>,
}

impl RandomScene {
    /// Draws the random scene with the number `number` of a family of scenes. `cells` is the row of this family in the
    /// table of families, as pairs of a column name and a text.
    pub(super) fn new(cells: &[(&str, &str)], seed: u64, number: u64) -> Result<Self> {
        let mut draws = Draws(Stream::new(seed, number, Channel::PadOffset));
        let mut max_curvature = None;
        let text = family_scene(cells.iter().copied(), |field, range| {
            if field == CURVATURE && range[0] == 0.0 {
                max_curvature = Some(range[1]);
            }
            value(&mut draws, field, range)
        })?;
        let seed = seed.wrapping_mul(1000).wrapping_add(number);
        let mut fields = vec![("seed".to_owned(), json!(seed))];
        if let Some(curvature) = max_curvature {
            fields.push(("scene.object".to_owned(), waves(&mut draws, curvature)));
        }
        let study = parse("family", &with_fields("family", &text, &fields)?)?;
        let scene = study.estimable_scene(0)?;
        let flaw = cells.iter().find(|(column, _)| *column == "flaw");
        let flaw = flaw.map_or("", |(_, flaw)| flaw);
        let counted: &[&str] = match &scene {
            Scene::Roll(_) => &["normal_curvature_u", "normal_curvature_v"],
            Scene::Glide(_) => &["gaussian_curvature", "mean_curvature"],
            _ => &["object_curvature"],
        };
        let place = |name: &&str| {
            let mut names = scene.quantities().iter().map(|one| one.name);
            let place = names.position(|one| one == *name);
            place.with_context(|| format!("no quantity {name}"))
        };
        Ok(Self {
            flaw: press_flaw(flaw, &study.cell(0)?.config.scene),
            quantities: counted.iter().map(place).collect::<Result<_>>()?,
            scene,
        })
    }

    /// Simulates and estimates a trial, and returns the names of the estimate's warnings.
    ///
    /// # Errors
    /// The name of the failure if the trial has no estimate.
    pub(super) fn trial(
        &self,
        trial: u64,
        observe: &mut dyn FnMut(usize, Observation),
    ) -> Result<Vec<&'static str>, &'static str> {
        match &self.scene {
            Scene::Press(press) => press.flawed_trial(trial, self.flaw, observe),
            scene => scene.trial_with_warnings(trial, observe),
        }
    }
}

/// Converts the text `flaw`, for example `outlier of 8 standard deviations`, to a flaw of a press. Only outliers and
/// wrong indentations are converted; other flaws are already part of the scene's config.
fn press_flaw(flaw: &str, scene: &SceneConfig) -> PressFlaw {
    let SceneConfig::Press(press) = scene else {
        return PressFlaw::default();
    };
    let size = flaw
        .split_whitespace()
        .find_map(|word| word.parse::<f64>().ok());
    let size = size.unwrap_or_default();
    match (flaw.split(' ').next(), &press.noise.normal_displacement) {
        (Some("outlier"), Some(ReadingNoise::Gaussian { std })) => PressFlaw {
            outlier: size * std.0,
            ..PressFlaw::default()
        },
        (Some("indentation"), _) => PressFlaw {
            indentation: size,
            ..PressFlaw::default()
        },
        _ => PressFlaw::default(),
    }
}

/// Random value of a field between two limits. If both limits are positive, the logarithm of the value is uniformly
/// distributed. The curvature of a ball or a dish is in units of the probe's curvature. So 1 + value is the relative
/// curvature of object and probe, and the logarithm of this sum is uniformly distributed.
fn value(draws: &mut Draws, field: &str, [low, high]: [f64; 2]) -> f64 {
    match field {
        _ if INTEGERS.contains(&field) => draws.between(low, high + 1.0).floor(),
        CURVATURE if low < 0.0 => draws.log_between(1.0 + low, 1.0 + high) - 1.0,
        _ if low > 0.0 => draws.log_between(low, high),
        _ => draws.between(low, high),
    }
}

/// A random quadric with two waves, as an object of a config. The second derivatives of the quadric and of each wave
/// are at most half of `max`.
fn waves(draws: &mut Draws, max: f64) -> serde_json::Value {
    let second = 0.5 * max;
    let [a, b, c] = [(); 3].map(|()| 0.5 * draws.between(-second, second));
    let [[p, k, l, f], [q, m, n, g]] = [(); 2].map(|()| {
        let number = draws.between(WAVE_NUMBERS[0], WAVE_NUMBERS[1]);
        let (sine, cosine) = libm::sincos(draws.between(0.0, TAU));
        let amplitude = draws.between(0.1, 1.0) * second / (number * number);
        let phase = draws.between(0.0, TAU);
        [amplitude, number * cosine, number * sine, phase]
    });
    json!({
        "kind": "height-field",
        "formula": WAVES,
        "parameters": {
            "a": a, "b": b, "c": c, "p": p, "k": k, "l": l, "f": f, "q": q, "m": m, "n": n, "g": g,
        },
    })
}

/// The random numbers of one scene.
pub(crate) struct Draws(pub(crate) Stream);

impl Draws {
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (0.5 + 0.5 * self.0.symmetric_uniform())
    }

    /// A random number between `from` and `to`, uniform on a logarithmic scale.
    pub(crate) fn log_between(&mut self, from: f64, to: f64) -> f64 {
        libm::pow(10_f64, self.between(libm::log10(from), libm::log10(to)))
    }

    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}
