//! Choice of the tolerance of `auto` from the shift of the estimates that a model's error causes.

use palpate_scene::{Scene, Scenes};
use palpate_study::Quantity;
use palpate_study::config::{
    self, ConfigError, GlideSensorConfig, PressSensorConfig, RollSensorConfig, SceneConfig, Study,
    StudyConfig,
};

/// Tolerances of `auto` that are tried, largest first. The smallest that a scene of its kind accepts gives the
/// reference.
const TOLERANCES: [f64; 14] = [
    1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14,
];
/// Share of a value below which rounding decides a difference.
const ROUNDING: f64 = 1e-12;

/// Largest shift of a cell's estimates that the model may cause.
pub(crate) struct Allowance {
    /// Number of the cell in the study.
    pub(crate) cell: usize,
    /// Allowed shift as a share of a quantity's rms error, or of its truth where there is no rms error.
    pub(crate) share: f64,
    /// Quantities that the cell estimates.
    pub(crate) quantities: &'static [Quantity],
    /// Rms error of each quantity, where it is known; may be shorter than `quantities`.
    pub(crate) rms_errors: Vec<Option<f64>>,
}

/// Whether every cell has the model `auto` with a tolerance that no sweep sets.
pub(crate) fn is_auto(study: &Study) -> bool {
    let swept = |path: &String| path == "scene" || path.starts_with("scene.model");
    let is_auto = |scene: &SceneConfig| with_tolerance(scene, TOLERANCES[0]).is_some();
    !study.paths.iter().any(swept) && study.cells.iter().all(|cell| is_auto(&cell.config.scene))
}

/// Largest tolerance of `auto` with which the model shifts no estimate by more than is allowed, compared by a noiseless
/// pass with the pass at the smallest tolerance. Cells without a noiseless estimate are left out; `None` where that
/// leaves no cell.
pub(crate) fn tolerance_for(study: &Study, allowances: &[Allowance]) -> Option<f64> {
    let config = |allowance: &Allowance| &study.cells[allowance.cell].config;
    let reference = |allowance: &Allowance| {
        let mut finest = TOLERANCES.iter().rev();
        finest.find_map(|&tolerance| Some((tolerance, pass(config(allowance), tolerance)?)))
    };
    let references: Vec<(&Allowance, f64, Pass)> = allowances
        .iter()
        .filter_map(|allowance| {
            reference(allowance).map(|(tolerance, pass)| (allowance, tolerance, pass))
        })
        .collect();
    let smallest = references.iter().map(|(_, tolerance, _)| *tolerance);
    let smallest = smallest.reduce(f64::max)?;
    let is_kept = |tolerance: f64| {
        references.iter().all(|(allowance, _, reference)| {
            pass(config(allowance), tolerance)
                .is_some_and(|pass| allowance.is_kept(&pass, reference))
        })
    };
    let larger = TOLERANCES.iter().copied().filter(|&one| one > smallest);
    Some(
        larger
            .into_iter()
            .find(|&one| is_kept(one))
            .unwrap_or(smallest),
    )
}

/// Config of the study with `tolerance` for `auto`. Where `cells` are all cells of the study and `auto` takes the same
/// rung in each, that rung stands in place of `auto`.
pub(crate) fn resolved(
    study: &Study,
    cells: &[usize],
    tolerance: Option<f64>,
) -> Result<StudyConfig, ConfigError> {
    let mut config = study.config.clone();
    if !is_auto(study) {
        return Ok(config);
    }
    if let Some(scene) = tolerance.and_then(|one| with_tolerance(&config.scene, one)) {
        config.scene = scene;
    }
    if cells.len() < study.cells.len() {
        return Ok(config);
    }
    let auto = config::parse("run.toml", &config::to_toml(&config))?;
    let mut common = None;
    for &cell in cells {
        let taken = auto
            .ladder(cell)?
            .map(|ladder| ladder.taken().model.clone());
        match (&common, taken) {
            (None, Some(taken)) => common = Some(taken),
            (Some(known), Some(taken)) if *known == taken => {}
            (_, _) => return Ok(config),
        }
    }
    let explicit = common.and_then(|model| config.scene.with_model(&model));
    if let Some(scene) = explicit {
        config.scene = scene;
    }
    Ok(config)
}

/// Model of a scene as one line of TOML, `kind` first.
pub(crate) fn shown(scene: &SceneConfig) -> Option<String> {
    let model = serde_json::to_value(scene.model()?).ok()?;
    let (kind, settings): (Vec<_>, Vec<_>) = model
        .as_object()?
        .iter()
        .partition(|(key, _)| *key == "kind");
    let keys: Vec<String> = kind
        .into_iter()
        .chain(settings)
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    Some(format!("{{ {} }}", keys.join(", ")))
}

impl Allowance {
    /// Whether no estimate and no truth of a pass differs from the reference by more than is allowed.
    fn is_kept(&self, pass: &Pass, reference: &Pass) -> bool {
        if pass.values.len() != reference.values.len() {
            return false;
        }
        let scale = |quantity: usize| {
            let name = reference.quantities[quantity].name;
            let place = self.quantities.iter().position(|one| one.name == name);
            let rms = place.and_then(|place| self.rms_errors.get(place).copied().flatten());
            let truth = reference.scales[quantity];
            match rms {
                Some(rms) if rms > ROUNDING * truth => rms,
                _ => truth,
            }
        };
        let pairs = pass.values.iter().zip(&reference.values);
        pairs.into_iter().all(|(one, other)| {
            let shift = (one.estimate - other.estimate)
                .abs()
                .max((one.truth - other.truth).abs());
            shift <= self.share * scale(one.quantity)
        })
    }
}

/// Results of a noiseless pass with an ideal sensor.
struct Pass {
    quantities: &'static [Quantity],
    values: Vec<PassValue>,
    /// Largest magnitude of the truths of each quantity; where they are 0, the largest of any quantity in the same
    /// unit.
    scales: Vec<f64>,
}

struct PassValue {
    quantity: usize,
    estimate: f64,
    truth: f64,
}

/// Noiseless pass of a cell with this tolerance; `None` where the scene cannot be set up or its trial fails.
fn pass(config: &StudyConfig, tolerance: f64) -> Option<Pass> {
    let scene = with_tolerance(&config.scene, tolerance)?;
    let scene = Scene::new(&bare(&scene), config.seed).ok()?;
    let mut values = Vec::new();
    let quantities = scene.quantities();
    let mut scales = vec![0.0_f64; quantities.len()];
    scene
        .trial(0, |quantity, outcome| {
            // A class is not a number that could be shifted.
            if quantities[quantity].name != "class" {
                scales[quantity] = scales[quantity].max(outcome.truth.abs());
                values.push(PassValue {
                    quantity,
                    estimate: outcome.estimate,
                    truth: outcome.truth,
                });
            }
        })
        .ok()?;
    let of_unit = |place: usize| {
        let alike = (0..scales.len()).filter(|&one| quantities[one].unit == quantities[place].unit);
        alike.map(|one| scales[one]).fold(0.0, f64::max)
    };
    let scales = (0..scales.len())
        .map(|place| match scales[place] {
            0.0 => of_unit(place),
            scale => scale,
        })
        .collect();
    Some(Pass {
        quantities,
        values,
        scales,
    })
}

/// Copy of a scene without noise and with an ideal sensor, which makes it cheap to set up.
pub(crate) fn bare(scene: &SceneConfig) -> SceneConfig {
    let mut scene = scene.clone();
    match &mut scene {
        SceneConfig::Roll(roll) => {
            roll.noise = Default::default();
            roll.sensor = RollSensorConfig::default();
        }
        SceneConfig::Glide(glide) => {
            glide.noise = Default::default();
            if matches!(glide.sensor, GlideSensorConfig::Pads { .. }) {
                glide.sensor = GlideSensorConfig::default();
            }
        }
        SceneConfig::Press(press) => {
            press.noise = Default::default();
            if !matches!(press.sensor, PressSensorConfig::Direct { .. }) {
                press.sensor = PressSensorConfig::default();
            }
        }
        SceneConfig::Fingertip(_) => {}
    }
    scene
}

/// Copy of a scene with this tolerance of `auto`; `None` where the scene's model is another than `auto`, or there is
/// none.
fn with_tolerance(scene: &SceneConfig, tolerance: f64) -> Option<SceneConfig> {
    let mut scene = serde_json::to_value(scene).ok()?;
    let model = scene.get_mut("model")?;
    if model["kind"] != "auto" {
        return None;
    }
    model["tolerance"] = tolerance.into();
    serde_json::from_value(scene).ok()
}
