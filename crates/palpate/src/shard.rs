//! A study can be divided into shards. Each shard has its own cells and runs separately.

use palpate_study::config::Study;
use palpate_sweep::Task;

/// One part of a study, which runs separately. Each shard runs every `of`-th cell, so that all shards take about the
/// same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, counted from 1.
    pub number: u64,
    /// Number of shards into which the study is divided.
    pub of: u64,
}

/// The default is a single shard that contains the whole study.
impl Default for Shard {
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

#[derive(Debug)]
pub(crate) struct ShardTasks {
    /// Numbers of the study's cells that all shards together run.
    pub(crate) cells: Vec<usize>,
    shard: Shard,
}

impl ShardTasks {
    pub(crate) fn new(cells: Vec<usize>, shard: Shard) -> Self {
        Self { cells, shard }
    }

    pub(crate) fn tasks(&self) -> u64 {
        let before = self.shard.number - 1;
        let all = self.cells.len() as u64;
        all.saturating_sub(before).div_ceil(self.shard.of)
    }

    pub(crate) fn cell(&self, number: u64) -> usize {
        let place = number * self.shard.of + self.shard.number - 1;
        self.cells[place as usize]
    }

    pub(crate) fn task(&self, study: &Study, number: u64) -> Task {
        let cell = self.cell(number);
        Task {
            cell,
            trials: trials(study, cell),
            may_stop: study.config.stop.is_some(),
        }
    }

    /// Number of trials of the first `tasks` tasks of this shard (each cell is one task), limited to the largest `u64`.
    pub(crate) fn trials_before(&self, study: &Study, tasks: u64) -> u64 {
        if !study.paths.iter().any(|path| path == "trials") {
            let of_each = self.cells.first().map_or(0, |&cell| trials(study, cell));
            return tasks.saturating_mul(of_each);
        }
        let trials = (0..tasks).map(|number| trials(study, self.cell(number)));
        trials.fold(0, u64::saturating_add)
    }
}

/// Number of trials of a cell. If the study has a stopping rule, this is the largest possible number.
fn trials(study: &Study, cell: usize) -> u64 {
    let stop = study.config.stop.as_ref();
    stop.map_or_else(|| study.trials_of(cell), |stop| stop.max_trials)
}
