//! The page of benches against the workspace.

use std::collections::BTreeSet;

use anyhow::{Context, Result, bail};
use serde_json::Value;
use xshell::Shell;

use crate::palpate;

const PAGE: &str = "crates/assay/BENCHES.md";

/// Fails unless the page lists every bench target of the workspace, and no other.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let there = targets(&palpate::packages(shell)?)?;
    let listed = listed(&shell.read_file(PAGE)?);
    let differences: Vec<String> = there
        .difference(&listed)
        .map(|bench| format!("{bench} is not listed"))
        .chain(
            listed
                .difference(&there)
                .map(|bench| format!("{bench} is listed but not there")),
        )
        .collect();
    if !differences.is_empty() {
        bail!("{PAGE}: {}", differences.join("; "));
    }
    println!("benches: {} targets as in {PAGE}", there.len());
    Ok(())
}

/// `package/target` of every bench.
fn targets(packages: &[Value]) -> Result<BTreeSet<String>> {
    let mut benches = BTreeSet::new();
    for package in packages {
        let name = package["name"]
            .as_str()
            .context("a package without a name")?;
        for target in package["targets"].as_array().into_iter().flatten() {
            if target["kind"][0] == "bench" {
                let target = target["name"].as_str().context("a target without a name")?;
                benches.insert(format!("{name}/{target}"));
            }
        }
    }
    Ok(benches)
}

/// The first cells of the page's table: `` `package/target` ``.
fn listed(page: &str) -> BTreeSet<String> {
    let cell = |line: &str| {
        line.strip_prefix("| `")?
            .split_once('`')
            .map(|(cell, _)| cell.to_owned())
    };
    page.lines().filter_map(cell).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn targets_are_those_of_benches() {
        let packages = [
            json!({"name": "a", "targets": [
                {"name": "a", "kind": ["lib"]}, {"name": "quick", "kind": ["bench"]}]}),
            json!({"name": "b", "targets": []}),
        ];
        let page =
            "# Benches\n\n| bench | path |\n| --- | --- |\n| `a/quick` | all of `b/slow` |\n";
        assert_eq!(targets(&packages).unwrap(), listed(page));
        assert_eq!(listed(page).len(), 1);
    }
}
