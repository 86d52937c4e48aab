//! Notes on single trials.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::column::{Column, UNREPORTED};
use crate::observation::Observation;
use crate::record::Record;
use crate::trial::Trial;

/// Observations of one trial that succeeded.
#[derive(Debug)]
pub struct Seen<'a> {
    columns: &'a [Column],
    /// Places of its observations in each column.
    places: Vec<Range<usize>>,
}

impl Seen<'_> {
    /// Observations of a quantity, in the order in which they were recorded; none of a quantity that was not observed.
    pub fn observations(&self, quantity: usize) -> impl Iterator<Item = Observation> {
        let column = self.columns.get(quantity).zip(self.places.get(quantity));
        column.into_iter().flat_map(|(column, places)| {
            let pairs = column.pairs().take(places.end).enumerate();
            pairs
                .skip(places.start)
                .map(|(place, (estimate, truth))| Observation {
                    estimate,
                    truth,
                    std: column
                        .stds()
                        .get(place)
                        .copied()
                        .filter(|&std| std != UNREPORTED),
                    interval_holds: column.judgements().get(place).copied().flatten(),
                })
        })
    }
}

/// Trial that writes a note whenever it is run.
pub(crate) struct Noting<'a, T, N> {
    pub(crate) trial: &'a T,
    /// Adds to a text what is to be told of a trial: of its observations, or of the kind of its failure.
    pub(crate) note: N,
    /// Notes so far. One thread writes at a time.
    pub(crate) text: Mutex<String>,
}

impl<T, N> Noting<'_, T, N>
where
    T: Trial,
    N: Fn(u64, Result<&Seen<'_>, &'static str>, &mut String) + Sync,
{
    /// Notes trials that have recorded equally often since the columns were this long.
    fn add(&self, trials: Range<u64>, record: &mut Record, before: &[usize]) {
        let mut text = self.text.lock().unwrap_or_else(PoisonError::into_inner);
        let columns = &*record.columns();
        let count = (trials.end - trials.start) as usize;
        for (number, trial) in trials.enumerate() {
            let places = columns.iter().zip(before).map(|(column, before)| {
                let each = (column.len() - before) / count;
                before + number * each..before + (number + 1) * each
            });
            let places = places.collect();
            (self.note)(trial, Ok(&Seen { columns, places }), &mut text);
        }
    }
}

impl<T, N> Trial for Noting<'_, T, N>
where
    T: Trial,
    N: Fn(u64, Result<&Seen<'_>, &'static str>, &mut String) + Sync,
{
    fn quantities(&self) -> usize {
        self.trial.quantities()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        let before = record.lengths();
        let ran = self.trial.run(trial, record);
        match ran.err().or(record.rejected()) {
            Some(kind) => {
                let text = self.text.lock();
                (self.note)(
                    trial,
                    Err(kind),
                    &mut text.unwrap_or_else(PoisonError::into_inner),
                );
            }
            None => self.add(trial..trial + 1, record, &before),
        }
        ran
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        let before = record.lengths();
        let start = trials.start;
        let ran = self.trial.run_together(trials, record);
        if ran > 0 {
            self.add(start..start + ran, record, &before);
        }
        ran
    }

    fn is_random(&self) -> bool {
        self.trial.is_random()
    }
}
