//! Facts about a scene that its tables state.

use palpate_scene::{MapTable, Scene};
use palpate_study::Quantity;
use palpate_study::config::StudyConfig;

/// What tables say of a scene, whatever its trials give.
#[derive(Debug)]
pub(crate) struct Facts {
    /// Number of trials that are run.
    pub(crate) trials: u64,
    pub(crate) quantities: &'static [Quantity],
    /// Truth of each quantity, where it is the same everywhere.
    pub(crate) truths: Vec<Option<f64>>,
    /// Bound on the standard deviation of an estimate of each quantity, where it is known.
    pub(crate) std_bounds: Vec<Option<f64>>,
    /// Whether such bounds are stated of scenes of its kind.
    pub(crate) states_bounds: bool,
    /// Empty table for its map, or why it has none.
    pub(crate) map_table: Result<MapTable, &'static str>,
}

impl Facts {
    /// Facts about the scene of a config.
    pub(crate) fn of(scene: &Scene, config: &StudyConfig) -> Self {
        let quantities = scene.quantities();
        let places = 0..quantities.len();
        Self {
            trials: scene.trials(config.trials),
            quantities,
            truths: places.clone().map(|place| scene.truth(place)).collect(),
            std_bounds: places.map(|place| scene.std_bound(place)).collect(),
            states_bounds: scene.states_bounds(),
            map_table: scene.map_table(config.length_unit),
        }
    }
}
