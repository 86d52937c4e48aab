//! Allowed imports between the crates of the workspace.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use xshell::Shell;

use crate::programs;

/// Crates that each crate may import in addition to [`COMMON`]: the table of ARCHITECTURE.md, "The crates".
const ALLOWED: &[(&str, &[&str])] = &[
    ("geometry", &[]),
    ("study", &[]),
    ("rolling", &["geometry"]),
    ("sensing", &[]),
    ("ep1", &["geometry"]),
    ("ep2", &["geometry"]),
    ("press", &[]),
    ("chromatouch", &["sensing"]),
    ("tracking", &[]),
    (
        "estimators",
        &[
            "study",
            "geometry",
            "ep2",
            "press",
            "chromatouch",
            "tracking",
        ],
    ),
    (
        "scene",
        &[
            "study",
            "geometry",
            "rolling",
            "sensing",
            "ep1",
            "ep2",
            "press",
            "chromatouch",
            "tracking",
            "estimators",
            "sweep",
        ],
    ),
    (
        "recorded",
        &[
            "study",
            "geometry",
            "ep1",
            "ep2",
            "press",
            "chromatouch",
            "tracking",
            "estimators",
        ],
    ),
    ("sweep", &[]),
    ("report", &["study"]),
    ("answers", &["study", "scene", "sweep", "report"]),
    (
        "palpate",
        &["study", "scene", "recorded", "sweep", "report", "answers"],
    ),
    ("python", &["palpate"]),
    ("testkit", &[]),
    ("statistics", &[]),
    ("fuzz", &["geometry", "study", "recorded", "tracking"]),
    ("xtask", &[]),
];
/// The crate that may import any other.
const UNLIMITED: &str = "assay";
/// Crates that every crate may import.
const COMMON: [&str; 1] = ["statistics"];

/// Checks that crates import only what the table allows. Imports of tests and benchmarks do not count.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let packages = programs::packages(shell)?;
    let faults = faults(&packages)?;
    if !faults.is_empty() {
        bail!("{}", faults.join("\n"));
    }
    println!(
        "house: the imports of {} crates are as allowed",
        packages.len()
    );
    Ok(())
}

/// Messages about imports that the table forbids.
fn faults(packages: &[Value]) -> Result<Vec<String>> {
    let short = |value: &Value| -> Result<String> {
        let name = value["name"].as_str().context("a name is missing")?;
        Ok(name.strip_prefix("palpate-").unwrap_or(name).to_owned())
    };
    let crates: Vec<String> = packages.iter().map(short).collect::<Result<_>>()?;
    let mut faults = Vec::new();
    for (package, name) in packages.iter().zip(&crates) {
        if name == UNLIMITED {
            continue;
        }
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| known == name) else {
            faults.push(format!("crate {name} is not in the table of crates"));
            continue;
        };
        let allowed = [allowed, &COMMON[..]].concat();
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let import = short(dependency)?;
            let counts = dependency["kind"] != "dev" && crates.contains(&import);
            if counts && !allowed.contains(&import.as_str()) {
                let allowed = allowed.join(", ");
                faults.push(format!(
                    "crate {name} imports {import}; it may import {allowed}"
                ));
            }
        }
    }
    Ok(faults)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::faults;

    #[test]
    fn a_forbidden_import_of_a_crate_is_named() {
        let import = |name: &str| json!({"name": name, "kind": null});
        let packages = [
            json!({"name": "palpate-statistics"}),
            json!({"name": "palpate-sensing", "dependencies": [import("palpate-statistics"), import("libm")]}),
            json!({"name": "palpate-press", "dependencies": [
                import("palpate-sensing"), {"name": "palpate-assay", "kind": "dev"}]}),
            json!({"name": "palpate-assay", "dependencies": [import("palpate-press")]}),
            json!({"name": "palpate-elsewhere"}),
        ];
        assert_eq!(
            faults(&packages).unwrap(),
            [
                "crate press imports sensing; it may import statistics",
                "crate elsewhere is not in the table of crates"
            ]
        );
    }
}
