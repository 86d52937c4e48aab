//! The fidelity ladder of a roll.

use palpate_rolling::{Chart, Model, Motion, Rolls};

use super::plan::cut;
use super::scene::RollScene;
use crate::ladder::{Ladder, Rung};
use palpate_study::config::{self, ModelConfig, RollModelConfig};

impl RollScene {
    /// Commanded motion of each probe without noise, cut into the pieces in which noise acts.
    pub fn noiseless(&self) -> Vec<Vec<Motion>> {
        let pieces = self.noise.pieces();
        self.commands()
            .map(|command| cut(command, pieces))
            .collect()
    }

    /// Measures the error of each rung of this scene.
    pub(super) fn measured_ladder(&self) -> Ladder {
        let rolls = self.noiseless();
        let measured = self.roller.ladder(self.chart, Rolls { rolls: &rolls });
        let choice = self.roller.choice();
        let rungs = measured.into_iter().map(|rung| Rung {
            name: rung.name,
            model: ModelConfig::Roll(named(rung.model)),
            outcome: rung.outcome,
        });
        let taken = ModelConfig::Roll(named(choice.model));
        Ladder::new(
            rungs.collect(),
            &taken,
            choice.reason.clone(),
            self.tolerance,
        )
    }
}

/// The model in the form of a config.
fn named(model: Model) -> RollModelConfig {
    let of = |chart: Chart| match chart {
        Chart::Free => config::Chart::Free,
        Chart::Montana(_) => config::Chart::Montana,
    };
    match model {
        Model::Auto { tolerance, chart } => RollModelConfig::Auto {
            tolerance,
            chart: of(chart),
        },
        Model::ClosedForm => RollModelConfig::ClosedForm {},
        Model::Meridian => RollModelConfig::Meridian {},
        Model::Rk4 { steps, chart } => RollModelConfig::Rk4 {
            steps: u32::try_from(steps).unwrap_or(u32::MAX),
            chart: of(chart),
        },
        Model::Dop853 { tolerance, chart } => RollModelConfig::Dop853 {
            tolerance,
            chart: of(chart),
        },
    }
}
