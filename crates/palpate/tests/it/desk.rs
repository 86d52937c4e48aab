//! Makes a directory for each test, runs the program in this directory, and parses the tables that the program writes.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use palpate::config::rename_settings;
use tempfile::TempDir;

/// A study with two noisy cells: short rolls of a sphere on spheres.
pub(crate) const STUDY: &str = r#"name = "a-study"
length_unit = "mm"
seed = 7
trials = 20

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 50.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }

[[sweep]]
path = "scene.object.radius"
values = [50, 5]
"#;

/// A study with one cell and without noise, nine lines long. If a test appends lines to this text, they belong to its
/// last table, `[scene]`.
pub(crate) const SCENE: &str = r#"name = "a-study"
length_unit = "mm"
trials = 20

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 50.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
"#;

pub(crate) fn noiseless() -> String {
    let noise = "noise = { angular_velocity = { kind = \"uniform\", fraction = 0.01 } }\n";
    edited(STUDY, noise, "")
}

pub(crate) fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the text");
    text.replacen(from, to, 1)
}

pub(crate) struct Desk(TempDir);

impl Desk {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn with(config: &str) -> Self {
        let desk = Self::new();
        desk.write("c.toml", config);
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn table(&self, name: &str) -> Table {
        Table::parse(&self.read(name))
    }

    /// Sorted file names in a directory, without the manifest. The list is empty if the directory does not exist.
    pub(crate) fn names(&self, dir: &str) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(self.path(dir)) else {
            return Vec::new();
        };
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name != ".palpate.toml")
            .collect();
        names.sort();
        names
    }

    pub(crate) fn palpate(&self, arguments: &str) -> Ended {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
        command.args(arguments.split_whitespace());
        self.end(command)
    }

    /// Runs a shell command line in which `$palpate` is the program.
    pub(crate) fn shell(&self, line: &str) -> Ended {
        let mut command = Command::new("sh");
        command
            .args(["-c", line])
            .env("palpate", env!("CARGO_BIN_EXE_palpate"));
        self.end(command)
    }

    /// Each row of `table` is `arguments | words of the expected error`. Checks that the command fails with status 2
    /// for every row, and writes nothing.
    pub(crate) fn refuses(&self, command: &str, table: &str) {
        let before = self.names("");
        let is_wrong = |row: &&str| {
            let (arguments, words) = row.rsplit_once("| ").unwrap();
            let ended = self.palpate(&format!("{command} {arguments}"));
            let is_error =
                ended.stderr.starts_with("error: ") && !ended.stderr.contains("panicked");
            !is_error
                || ended.status != Some(2)
                || !ended.stdout.is_empty()
                || !ended.stderr.contains(words)
        };
        let wrong: Vec<&str> = table.trim().lines().filter(is_wrong).collect();
        assert!(wrong.is_empty(), "{command}: {wrong:#?}");
        assert_eq!(self.names(""), before);
    }

    #[track_caller]
    pub(crate) fn json(&self, arguments: &str) -> serde_json::Value {
        let printed = self.palpate(&format!("{arguments} --json")).printed();
        serde_json::from_str(&printed).unwrap_or_else(|error| panic!("{error}: {printed}"))
    }

    /// Checks that a command writes the same bytes with one thread and with two threads. The run with one thread
    /// writes into `out-1`.
    #[track_caller]
    pub(crate) fn assert_alike_on_any_threads(&self, arguments: &str, names: &[&str]) {
        for threads in [1, 2] {
            let on = format!("--threads {threads} --out out-{threads}");
            self.palpate(&format!("{arguments} {on}")).printed();
        }
        for name in names {
            let [one, two] = [1, 2].map(|threads| self.read(&format!("out-{threads}/{name}")));
            assert_eq!(one, two, "{name}");
        }
    }

    fn end(&self, mut command: Command) -> Ended {
        let output = command
            .current_dir(self.0.path())
            .env_remove("RUST_BACKTRACE")
            .env_remove("RUST_LIB_BACKTRACE")
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        // Many test configs also set the field that they sweep. Another test checks the notes about such fields, so
        // separate these notes from the other messages.
        let is_swept =
            |line: &&str| line.starts_with("note: ") && line.contains(" is replaced by ");
        let lines = stderr.split_inclusive('\n');
        let (swept, stderr): (Vec<&str>, Vec<&str>) = lines.partition(is_swept);
        Ended {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: stderr.concat(),
            swept: swept.concat(),
        }
    }
}

#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    /// Text that the command wrote to the stream stderr, without the lines that are in `swept`.
    pub(crate) stderr: String,
    /// Notes in stderr about fields to which the config gives both a value and a sweep.
    pub(crate) swept: String,
}

pub(crate) fn with_flags(text: &str) -> String {
    rename_settings(text, |key| format!("--{}", key.replace('_', "-")))
}

impl Ended {
    /// Returns the text on stdout, after checking that the command succeeded. The text on stderr may contain only
    /// warnings that are also in the JSON on stdout.
    #[track_caller]
    pub(crate) fn printed(self) -> String {
        let printed = with_flags(&self.stdout);
        let is_of_json = |line: &str| {
            let warning = line.strip_prefix("warning: ").map(serde_json::Value::from);
            warning.is_some_and(|warning| printed.contains(&warning.to_string()))
        };
        assert_eq!(self.status, Some(0), "{self:?}");
        assert!(self.stderr.lines().all(is_of_json), "{self:?}");
        self.stdout
    }

    /// Returns the error message, after checking that the command failed with `status` and printed nothing else.
    #[track_caller]
    pub(crate) fn said(self, status: i32) -> String {
        assert_eq!(
            (self.status, self.stdout.as_str()),
            (Some(status), ""),
            "{self:?}"
        );
        let errors = self
            .stderr
            .lines()
            .filter(|line| line.starts_with("error: "));
        assert!(
            self.stderr.starts_with("error: ") && errors.count() == 1,
            "{}",
            self.stderr
        );
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self.stderr
    }

    #[track_caller]
    pub(crate) fn prints(self, words: &str) {
        self.prints_all(&[words]);
    }

    #[track_caller]
    pub(crate) fn prints_all(self, parts: &[&str]) {
        let printed = self.printed();
        for words in parts {
            assert!(printed.contains(words), "{words:?} is not in {printed}");
        }
    }

    #[track_caller]
    pub(crate) fn fails(self, status: i32, words: &str) {
        let said = self.said(status);
        assert!(said.contains(words), "{words:?} is not in {said}");
    }
}

pub(crate) struct Table {
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    fn parse(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let fields = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        Self {
            header: fields(reader.headers().unwrap()),
            rows: reader
                .records()
                .map(|record| fields(&record.unwrap()))
                .collect(),
        }
    }

    pub(crate) fn text(&self, row: usize, column: &str) -> &str {
        let place = self.header.iter().position(|name| name == column);
        &self.rows[row][place.unwrap_or_else(|| panic!("no column {column}"))]
    }

    pub(crate) fn number(&self, row: usize, column: &str) -> f64 {
        let text = self.text(row, column);
        text.parse()
            .unwrap_or_else(|_| panic!("{column} of row {row} is {text:?}"))
    }

    pub(crate) fn row_of(&self, cell: usize, quantity: &str) -> usize {
        (0..self.rows.len())
            .find(|&row| {
                self.text(row, "cell") == cell.to_string() && self.text(row, "quantity") == quantity
            })
            .unwrap_or_else(|| panic!("no {quantity} of cell {cell}"))
    }
}

/// The number at a JSON pointer such as `/meets/0/from`.
#[track_caller]
pub(crate) fn number_at(json: &serde_json::Value, place: &str) -> f64 {
    let number = json.pointer(place).and_then(serde_json::Value::as_f64);
    number.unwrap_or_else(|| panic!("{place}: {json}"))
}

#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, relative: f64) {
    let off = (found - expected).abs();
    assert!(
        off <= relative * expected.abs(),
        "{found} is not {expected} to {relative:e}"
    );
}

pub(crate) const RUN_FILES: [&str; 3] = ["cells.csv", "failures.csv", "run.toml"];

#[track_caller]
pub(crate) fn assert_untouched(dir: &Path) {
    let names: Vec<_> = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(names, ["c.toml"]);
}
