//! Facts about a scene that its tables state.

use palpate_scene::Scene;
use palpate_study::Quantity;
use palpate_study::config::Cell;

/// Facts about a scene that its trials do not change.
#[derive(Clone, Debug)]
pub(crate) struct Facts {
    /// Swept values of the cell, one per column.
    pub(crate) coordinates: Vec<String>,
    pub(crate) quantities: &'static [Quantity],
    /// Truth of each quantity, where it is the same everywhere.
    pub(crate) truths: Vec<Option<f64>>,
    /// Bound on the standard deviation of an estimate of each quantity, where it is known.
    pub(crate) std_bounds: Vec<Option<f64>>,
}

impl Facts {
    /// Facts about a cell without its scene: no truths, and no bounds on the standard deviations.
    pub(crate) fn bare(cell: &Cell, quantities: &'static [Quantity]) -> Self {
        let nothing = vec![None; quantities.len()];
        Self {
            coordinates: cell.coordinates.clone(),
            quantities,
            truths: nothing.clone(),
            std_bounds: nothing,
        }
    }

    /// Facts about a cell and its scene.
    pub(crate) fn of(scene: &Scene, cell: Cell) -> Self {
        let quantities = scene.quantities();
        let places = 0..quantities.len();
        Self {
            coordinates: cell.coordinates,
            quantities,
            truths: places.clone().map(|place| scene.truth(place)).collect(),
            std_bounds: places.map(|place| scene.std_bound(place)).collect(),
        }
    }
}
