//! Checks that the crates of the workspace import only the crates that they may import.

use anyhow::{Context, Result, bail};
use serde_json::Value;
use xshell::Shell;

use crate::programs;

/// Document with a table that lists, for each crate, the crates that it may import in addition to [`COMMON`].
const DOCUMENT: &str = "ARCHITECTURE.md";
/// If the table of allowed imports has this word for a crate, the crate may import every other crate.
const ANY: &str = "any";
/// Crates that every crate may import.
const COMMON: [&str; 1] = ["statistics"];

/// Checks that every crate imports only crates that the table allows. Imports in tests and benchmarks are not checked.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let packages = programs::packages(shell)?;
    let document = shell.read_file(DOCUMENT)?;
    let faults = faults(&packages, &allowed_imports(&document))?;
    if !faults.is_empty() {
        bail!("{}", faults.join("\n"));
    }
    println!(
        "house: the imports of {} crates are as allowed",
        packages.len()
    );
    Ok(())
}

/// The crates in the table of the document, each with the crates that it may import. A row of the table is `| `crate` |
/// … | a, b |`: the first column has the name of a crate, the last column the allowed crates.
fn allowed_imports(document: &str) -> Vec<(&str, Vec<&str>)> {
    let cells = |line| {
        let row = str::strip_prefix(line, "| `")?.strip_suffix(" |")?;
        let (name, rest) = row.split_once("` |")?;
        let imports = rest.rsplit('|').next()?.split(", ").map(str::trim);
        Some((name, imports.collect()))
    };
    document.lines().filter_map(cells).collect()
}

fn faults(packages: &[Value], table: &[(&str, Vec<&str>)]) -> Result<Vec<String>> {
    let short = |value: &Value| -> Result<String> {
        let name = value["name"].as_str().context("a name is missing")?;
        Ok(name.strip_prefix("palpate-").unwrap_or(name).to_owned())
    };
    let crates: Vec<String> = packages.iter().map(short).collect::<Result<_>>()?;
    let mut faults = Vec::new();
    for (package, name) in packages.iter().zip(&crates) {
        let Some((_, allowed)) = table.iter().find(|(listed, _)| listed == name) else {
            faults.push(format!("crate {name} is not in the table of {DOCUMENT}"));
            continue;
        };
        if allowed.contains(&ANY) {
            continue;
        }
        let allowed = [&allowed[..], &COMMON].concat();
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

    use super::{allowed_imports, faults};

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
        let table = "| crate | holds | may import |\n|---|---|---|\n| `statistics` | chances | – |\n| `sensing` | noise | – |\n\
                     | `press` | contact | geometry, study |\n| `assay` | harnesses | any |\n";
        assert_eq!(
            faults(&packages, &allowed_imports(table)).unwrap(),
            [
                "crate press imports sensing; it may import geometry, study, statistics",
                "crate elsewhere is not in the table of ARCHITECTURE.md"
            ]
        );
    }
}
