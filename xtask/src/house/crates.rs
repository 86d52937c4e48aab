//! Crates, and which of the others each may import.

use super::packages::Package;

/// Permission of a crate to import others.
enum May {
    /// Crates that it may import beside that which everybody may.
    Import(&'static [&'static str]),
    Anything,
    Nothing,
}

use May::{Anything, Import, Nothing};

/// The table of ARCHITECTURE.md, "The crates".
const CRATES: &[(&str, May)] = &[
    ("geometry", Import(&[])),
    ("study", Import(&[])),
    ("rolling", Import(&["geometry"])),
    ("sensing", Import(&[])),
    ("ep1", Import(&["geometry"])),
    ("ep2", Import(&["geometry"])),
    ("press", Import(&[])),
    ("chromatouch", Import(&["sensing"])),
    ("tracking", Import(&[])),
    (
        "scene",
        Import(&[
            "study",
            "geometry",
            "rolling",
            "sensing",
            "ep1",
            "ep2",
            "press",
            "chromatouch",
            "tracking",
        ]),
    ),
    ("sweep", Import(&[])),
    ("report", Import(&["study"])),
    ("palpate", Import(&["study", "scene", "sweep", "report"])),
    ("replica", Import(&["palpate"])),
    ("python", Import(&["palpate"])),
    ("tally", Import(&[])),
    ("frames", Import(&[])),
    ("number", Import(&[])),
    ("chance", Import(&[])),
    ("assay", Anything),
    ("fuzz", Import(&["geometry", "study", "scene", "tracking"])),
    ("xtask", Nothing),
];
/// Crates that each of the others may import.
const EVERYBODYS: [&str; 3] = ["tally", "number", "chance"];

/// Finds imports that the table forbids, each told as a sentence.
pub(super) fn faults(packages: &[Package]) -> Vec<String> {
    let mut faults = Vec::new();
    for package in packages {
        let name = short(&package.name);
        let Some((_, may)) = CRATES.iter().find(|(known, _)| *known == name) else {
            faults.push(format!("crate {name} is not in the table of crates"));
            continue;
        };
        for import in package.imports.iter().map(|import| short(import)) {
            if !may.import(import) {
                faults.push(format!(
                    "crate {name} imports {import}; it may import {}",
                    may.text()
                ));
            }
        }
    }
    faults
}

impl May {
    fn import(&self, name: &str) -> bool {
        match self {
            Import(allowed) => EVERYBODYS.contains(&name) || allowed.contains(&name),
            Anything => true,
            Nothing => false,
        }
    }

    fn text(&self) -> String {
        match self {
            Import(allowed) => [allowed, &EVERYBODYS[..]].concat().join(", "),
            Anything => "anything".to_string(),
            Nothing => "nothing".to_string(),
        }
    }
}

fn short(package: &str) -> &str {
    package.strip_prefix("palpate-").unwrap_or(package)
}
