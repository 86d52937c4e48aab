//! A table of rows, judged one after the other.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::exit;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::row::{Outcome, Refusal, Row};

/// Time after which an entry point is said to hang.
const PATIENCE: Duration = Duration::from_secs(20);

/// Rows of one test.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Row>,
}

impl Table {
    /// Environment variable that names the folder of the tables.
    pub const FOLDER: &str = "PALPATE_EXTREMES";

    /// Adds a row whose input can be computed: an error breaks the promise.
    pub fn value<O: Into<Outcome>>(
        &mut self,
        entry: &'static str,
        input: String,
        call: impl FnOnce() -> O,
    ) {
        self.judge(entry, input, None, || call().into());
    }

    /// Adds a row whose input has no meaning: a value breaks the promise, and an error by another name.
    pub fn refused<R: Refusal>(
        &mut self,
        entry: &'static str,
        input: String,
        error: &str,
        call: impl FnOnce() -> R,
    ) {
        self.judge(entry, input, Some(error), || call().outcome());
    }

    /// Writes the table as `PACKAGE/MODULE.csv` into the folder that [`Self::FOLDER`] names, if it does.
    ///
    /// # Errors
    /// The rows that break a promise; a folder that cannot be written to.
    pub fn finish(&self, package: &str, module: &str) -> Result<(), Box<dyn Error>> {
        if let Some(folder) = std::env::var_os(Self::FOLDER) {
            let folder = Path::new(&folder).join(package);
            std::fs::create_dir_all(&folder)?;
            let name = module.rsplit("::").next().unwrap_or(module);
            let mut writer = csv::Writer::from_path(folder.join(name).with_extension("csv"))?;
            writer.write_record(Row::COLUMNS)?;
            for row in &self.rows {
                writer.write_record(row.record())?;
            }
            writer.flush()?;
        }
        let broken = self.rows.iter().filter(|row| row.verdict.is_broken());
        let broken: Vec<String> = broken.map(|row| row.record().join(", ")).collect();
        if broken.is_empty() {
            return Ok(());
        }
        Err(broken.join("\n").into())
    }

    fn judge(
        &mut self,
        entry: &'static str,
        input: String,
        error: Option<&str>,
        call: impl FnOnce() -> Outcome,
    ) {
        let hung = format!("{entry} at {input}: no answer for {PATIENCE:?}\n");
        let give_up = move || {
            // What is printed is kept for a test that ends, which this one does not.
            let _ = std::io::stderr().write_all(hung.as_bytes());
            exit(1)
        };
        let row = watched(PATIENCE, give_up, || Row::of(entry, input, error, call));
        self.rows.push(row);
    }
}

/// Result of a call, during which somebody gives up if it takes longer than that.
fn watched<T>(
    patience: Duration,
    give_up: impl FnOnce() + Send + 'static,
    call: impl FnOnce() -> T,
) -> T {
    let (done, waiting) = channel::<()>();
    thread::spawn(move || {
        if waiting.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
            give_up();
        }
    });
    let result = call();
    drop(done);
    result
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use super::{Table, watched};
    use crate::Answer;

    #[test]
    fn a_table_with_a_broken_row_fails() {
        let mut table = Table::default();
        table.value("here", "one".to_owned(), || Answer::near(1.0, 1.0));
        table.refused("here", "none".to_owned(), "none", || None::<f64>);
        assert!(table.finish("palpate-verdict", "kept").is_ok());
        table.value("here", "two".to_owned(), || Answer::near(2.0, 1.0));
        let told = table.finish("palpate-verdict", "broken").unwrap_err();
        assert!(told.to_string().starts_with("here, two, value, 2e0, 1e0"));
        assert!(told.to_string().ends_with("unexplained"));
    }

    #[test]
    fn a_call_that_hangs_is_given_up() {
        let (tell, told) = channel();
        let give_up = move || tell.send("hung").unwrap();
        watched(Duration::from_millis(1), give_up, || {
            assert_eq!(told.recv_timeout(Duration::from_secs(20)), Ok("hung"));
        });
        let give_up = || unreachable!("it is done");
        assert_eq!(watched(Duration::from_secs(20), give_up, || 7), 7);
    }
}
