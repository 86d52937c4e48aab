//! Runs the command lines of the table `hostile.txt`, which contain many kinds of mistakes. Each call must end with
//! the stated exit status and print the stated words. No call may panic or change a user's files.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::desk::{Desk, STUDY};
use super::frames::{frame, write};

const TABLE: &str = include_str!("hostile.txt");
/// Number of bytes at the beginning of a file that are compared. The length of the file is compared too.
const MOST_BYTES: u64 = 1 << 24;
/// Smallest expected number of command lines in the table. If there are fewer, the table was not read completely.
const LEAST: usize = 250;
const PLOT: &str = "\n[[plot]]\nname = \"error\"\nx = \"scene.object.radius\"\ny = \"rms_error\"\nquantity = \
                    \"normal_curvature_u\"\n";
const SHELL: &str = "palpate() { \"$palpate\" \"$@\"; }; E={examples}; F={shared}; ";

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Call {
    before: String,
    line: String,
    status: i32,
    words: String,
}

/// Replaces each `@name` by the text with this name. Longer names are replaced first, because a short name may be the
/// beginning of a long one.
fn replace_names(text: &str, names: &BTreeMap<&str, String>) -> String {
    let mut text = text.to_owned();
    let mut known: Vec<&str> = names.keys().copied().collect();
    known.sort_by_key(|name| std::cmp::Reverse(name.len()));
    for name in known {
        text = text.replace(&format!("@{name}"), &names[name]);
    }
    text
}

/// Expands `{a,b}` into one line per choice, like a shell. A comma after a backslash does not separate choices.
fn expand_braces(line: &str) -> Vec<String> {
    let Some(start) = line.find('{') else {
        return vec![line.replace("\\,", ",")];
    };
    let (mut depth, mut choices, mut last) = (0, vec![String::new()], ' ');
    for (at, one) in line[start..].char_indices() {
        match one {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 && last != '\\' => {
                choices.push(String::new());
                continue;
            }
            _ => {}
        }
        if depth == 0 {
            let rest = &line[start + at + 1..];
            let lines = choices
                .iter()
                .map(|choice| format!("{}{choice}{rest}", &line[..start]));
            return lines.flat_map(|line| expand_braces(&line)).collect();
        }
        if at > 0 {
            choices.last_mut().unwrap().push(one);
        }
        last = one;
    }
    panic!("a brace is open in {line}")
}

fn calls() -> Vec<Call> {
    let (mut names, mut before, mut calls) = (BTreeMap::new(), String::new(), Vec::new());
    for line in TABLE.lines().filter(|line| !line.is_empty()) {
        if let Some(line) = line.strip_prefix('@') {
            let (name, text) = line.split_once(' ').unwrap();
            names.insert(name, replace_names(text, &names));
        } else if let Some(line) = line.strip_prefix(':') {
            before = replace_names(line.trim(), &names);
        } else if !line.starts_with('#') {
            let parts: Vec<&str> = line.splitn(3, '"').collect();
            let (status, words) = (
                parts[0].trim().parse().unwrap(),
                replace_names(parts[1], &names),
            );
            calls.extend(
                expand_braces(&replace_names(parts[2].trim(), &names))
                    .into_iter()
                    .map(|line| Call {
                        before: before.clone(),
                        line,
                        status,
                        words: words.clone(),
                    }),
            );
        }
    }
    calls
}

/// Kind and contents of each file in a directory, except files that palpate wrote (`o`, `o.*` and their contents).
fn user_files(dir: &Path, within: &str, is_ours: bool) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(dir.join(within)).unwrap() {
        let (entry, name) = entry
            .map(|entry| (entry.path(), entry.file_name().into_string().unwrap()))
            .unwrap();
        let inner = Path::new(within).join(&name).to_str().unwrap().to_owned();
        let is_ours =
            (is_ours || inner == "o" || inner.starts_with("o.")) && !name.starts_with("mine");
        let about = fs::symlink_metadata(&entry).unwrap();
        if about.is_dir() {
            found.extend(user_files(dir, &inner, is_ours));
        } else if !is_ours {
            let link = fs::read_link(&entry).unwrap_or_default();
            let mut bytes =
                format!("{:?} {} {link:?}", about.file_type(), about.len()).into_bytes();
            if about.is_file() {
                let mut start = fs::File::open(&entry).unwrap().take(MOST_BYTES);
                start.read_to_end(&mut bytes).unwrap();
            }
            found.insert(inner, bytes);
        }
    }
    found
}

/// Runs a command line of the table, and returns a report if its result is not as expected.
fn find_fault(call: &Call, shell: &str) -> Option<String> {
    let desk = Desk::with(&(STUDY.to_owned() + PLOT));
    let before = desk.shell(&format!("{shell}{}", call.before));
    let known = user_files(&desk.path(""), "", false);
    let ended = desk.shell(&format!("{shell}{}", call.line));
    let after = user_files(&desk.path(""), "", false);
    let said = &ended.stderr;
    let lost: Vec<&String> = known
        .iter()
        .filter(|(name, was)| after.get(*name) != Some(was))
        .map(|(name, _)| name)
        .collect();
    let is_right = before.status == Some(0)
        && ended.status == Some(call.status)
        && said.contains(&call.words)
        && !said.contains("panicked")
        && lost.is_empty();
    (!is_right).then(|| format!("{call:#?}\nlost: {lost:?}\n{before:?}\n{ended:?}\n"))
}

/// A directory with frames, a calibration, and the results of a run in `o`.
fn shared() -> Desk {
    let desk = Desk::with(&(STUDY.to_owned() + PLOT));
    for (name, depth) in [("rest", 0.0), ("pressed", 0.8), ("more", 1.2)] {
        let place = |[x, y]: [f64; 2]| depth * libm::exp(-20.0 * (x * x + y * y));
        write(&desk, &format!("{name}.png"), frame(place, &[]));
    }
    let calibrate = "sensor calibrate rest.png pressed.png more.png --normal 0.8,1.2 --length-unit mm --from size";
    desk.palpate(&format!("{calibrate} --out calibration.toml"))
        .printed();
    desk.palpate("run c.toml --out o").printed();
    desk.palpate("plot o").printed();
    desk
}

#[test]
fn calls_end_as_the_table_states_and_change_no_file() {
    let calls = calls();
    let distinct: BTreeSet<(&str, &str)> = calls
        .iter()
        .map(|call| (call.before.as_str(), call.line.as_str()))
        .collect();
    assert!(
        distinct.len() == calls.len() && calls.len() >= LEAST,
        "{} of {}",
        distinct.len(),
        calls.len()
    );
    let shared = shared();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let shell = SHELL
        .replace("{examples}", examples)
        .replace("{shared}", shared.path("").to_str().unwrap());
    let (next, workers) = (
        AtomicUsize::new(0),
        thread::available_parallelism().map_or(2, usize::from),
    );
    let work = || {
        let mine = std::iter::from_fn(|| calls.get(next.fetch_add(1, Ordering::Relaxed)));
        mine.filter_map(|call| find_fault(call, &shell))
            .collect::<Vec<String>>()
    };
    let faults: Vec<String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap())
            .collect()
    });
    assert!(
        faults.is_empty(),
        "{} of {} calls:\n{}",
        faults.len(),
        calls.len(),
        faults.concat()
    );
}
