//! Passes the files of the corpus, and random variations of them, to the fuzz targets. The name of each file states
//! the expected result of its target.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use palpate_fuzz::{TARGETS, Target};

/// Number of random variations of each corpus file. For a target with many files, [`MAX_VARIATIONS`] reduces this
/// number.
const VARIATIONS: u64 = 40;
/// Largest total number of random variations of all files of a target.
const MAX_VARIATIONS: u64 = 4000;

/// Names and contents of the files of a target.
fn corpus(target: &Target) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(target.name);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read(path).unwrap())
        })
        .collect();
    files.sort();
    assert!(files.len() >= 4, "the corpus of {} is missing", target.name);
    files
}

/// Texts that often cause errors in parsers of numbers and files.
const WORDS: [&[u8]; 16] = [
    b"nan",
    b"inf",
    b"-inf",
    b"-0.0",
    b"1e999",
    b"5e-324",
    b"1e308",
    b"0",
    b"-1",
    b"18446744073709551616",
    b"\"",
    b"[",
    b"}",
    b",",
    b"\n",
    b"\xff",
];

fn varied(file: &[u8], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for _ in 0..=random.usize(..3) {
        let at = random.usize(..=bytes.len());
        let end = (at + random.usize(..12)).min(bytes.len());
        match random.usize(..5) {
            0 => drop(bytes.splice(at..end, WORDS[random.usize(..WORDS.len())].iter().copied())),
            1 => drop(bytes.drain(at..end)),
            2 => bytes.truncate(at),
            3 => {
                let copy = bytes[at..end].to_vec();
                let to = random.usize(..=bytes.len());
                drop(bytes.splice(to..to, copy));
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.usize(..8);
                }
            }
        }
    }
    bytes
}

fn check(name: &str) {
    let target = TARGETS.iter().find(|target| target.name == name).unwrap();
    let files = corpus(target);
    let misnamed: Vec<String> = files
        .iter()
        .filter_map(|(file, bytes)| {
            let outcome = (target.run)(bytes);
            let prefix = if outcome.is_ok() { "read-" } else { "refused-" };
            let is_named = file.starts_with(prefix);
            (!is_named).then(|| format!("rename {name}/{file} to {prefix}…: {outcome:?}"))
        })
        .collect();
    assert!(misnamed.is_empty(), "{}", misnamed.join("\n"));
    let each = VARIATIONS.min(MAX_VARIATIONS / files.len() as u64);
    for (number, (file, bytes)) in files.iter().enumerate() {
        for variation in 0..each {
            let mut random = fastrand::Rng::with_seed((number as u64) << 32 | variation);
            let varied = varied(bytes, &mut random);
            let run = target.run;
            let outcome = std::panic::catch_unwind(|| run(&varied).is_ok());
            let shown = String::from_utf8_lossy(&varied);
            assert!(outcome.is_ok(), "variation {variation} of {file}:\n{shown}");
        }
    }
}

#[test]
fn configs() {
    check("config");
}

#[test]
fn formulas() {
    check("formula");
}

#[test]
fn readings() {
    check("readings");
}

#[test]
fn frames() {
    check("frame");
}

#[test]
fn calibrations() {
    check("calibration");
}
