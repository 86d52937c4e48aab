//! Trials that run alone.

use crate::column::Column;
use crate::record::Record;
use crate::trial::Trial;

/// Runs one trial, shows what it observed of each quantity, and forgets it. `record` is empty before and after.
pub(crate) fn alone<T>(
    record: &mut Record,
    trial: &dyn Trial,
    number: u64,
    show: impl FnOnce(&[Column]) -> T,
) -> Result<T, &'static str> {
    record.set_quantities(trial.quantities());
    let done = record.take(|record| trial.run(number, record));
    let columns = record.columns();
    let shown = done.map(|()| show(columns));
    columns.iter_mut().for_each(Column::clear);
    shown
}
