//! Share of a study that one run does: cells, and superblocks of the trials of heavy cells.

use palpate_study::config::Study;
use palpate_sweep::Task;

/// One of several runs that share a study: each runs every `of`-th task, so that all have about as much to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1 on.
    pub number: u64,
    /// Number of shards.
    pub of: u64,
}

/// The only shard of a study that is not shared.
impl Default for Shard {
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

/// Tasks of a run: those of each of its cells, superblock by superblock.
#[derive(Debug)]
pub(crate) struct Share {
    /// Numbers of the cells of all shards together.
    pub(crate) cells: Vec<usize>,
    /// First task of each cell; `None` where each has one.
    starts: Option<Vec<u64>>,
    /// Number of tasks of all shards together.
    pub(crate) all: u64,
    shard: Shard,
    may_stop: bool,
}

/// Task of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Number of the cell.
    pub(crate) cell: usize,
    /// Trials of the cell.
    pub(crate) trials: u64,
    /// Number of the superblock of its trials.
    pub(crate) superblock: u64,
    /// Number of superblocks of the cell.
    pub(crate) of: u64,
}

impl Share {
    pub(crate) fn new(study: &Study, cells: Vec<usize>, shard: Shard) -> Self {
        let may_stop = study.config.stop.is_some();
        let superblocks = |&cell: &usize| match may_stop {
            true => 1,
            false => Task::superblocks(study.trials_of(cell)),
        };
        let mut all = 0_u64;
        let mut starts = Vec::new();
        if cells.iter().any(|cell| superblocks(cell) > 1) {
            for cell in &cells {
                starts.push(all);
                all = all.saturating_add(superblocks(cell));
            }
        } else {
            all = cells.len() as u64;
        }
        Self {
            cells,
            starts: (!starts.is_empty()).then_some(starts),
            all,
            shard,
            may_stop,
        }
    }

    /// Number of tasks of this shard.
    pub(crate) fn tasks(&self) -> u64 {
        let before = self.shard.number - 1;
        self.all.saturating_sub(before).div_ceil(self.shard.of)
    }

    /// Task of this shard with this number.
    pub(crate) fn part(&self, study: &Study, number: u64) -> Part {
        let task = number * self.shard.of + self.shard.number - 1;
        let place = match &self.starts {
            Some(starts) => starts.partition_point(|&first| first <= task) - 1,
            None => task as usize,
        };
        let start = self.starts.as_ref().map_or(task, |starts| starts[place]);
        let cell = self.cells[place];
        let trials = self.trials(study, cell);
        let of = match self.may_stop {
            true => 1,
            false => Task::superblocks(trials),
        };
        Part {
            cell,
            trials,
            superblock: task - start,
            of,
        }
    }

    /// Trials of a cell, or the most that it may have.
    fn trials(&self, study: &Study, cell: usize) -> u64 {
        let stop = study.config.stop.as_ref();
        stop.map_or_else(|| study.trials_of(cell), |stop| stop.max_trials)
    }

    pub(crate) fn task(&self, study: &Study, number: u64) -> Task {
        let part = self.part(study, number);
        match self.may_stop {
            true => Task {
                cell: part.cell,
                trials: 0..part.trials,
                may_stop: true,
            },
            false => Task::of(part.cell, part.trials, part.superblock),
        }
    }

    /// Number of trials of the first of this shard's tasks together, at most the largest number of 64 bits.
    pub(crate) fn trials_before(&self, study: &Study, tasks: u64) -> u64 {
        let is_swept = study.paths.iter().any(|path| path == "trials");
        if self.starts.is_none() && !is_swept {
            let trials = self
                .cells
                .first()
                .map_or(0, |&cell| self.trials(study, cell));
            return tasks.saturating_mul(trials);
        }
        let trials = (0..tasks).map(|number| {
            let task = self.task(study, number);
            task.trials.end - task.trials.start
        });
        trials.fold(0, u64::saturating_add)
    }
}
