//! Packages of the workspace, as cargo reads them.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::Value;
use xshell::{Shell, cmd};

/// A package: where its sources begin, and what it imports of the workspace.
pub(super) struct Package {
    pub(super) name: String,
    pub(super) roots: Vec<Root>,
    /// Names of packages, those for tests and benchmarks left out.
    pub(super) imports: BTreeSet<String>,
}

/// The first file of a library or a program.
pub(super) struct Root {
    pub(super) file: PathBuf,
    /// The name by which the package's programs import it.
    pub(super) library: Option<String>,
}

/// Reads all packages of the workspace.
pub(super) fn read(shell: &Shell) -> Result<Vec<Package>> {
    let command = cmd!(
        shell,
        "cargo metadata --no-deps --format-version 1 --offline"
    );
    let metadata: Value = serde_json::from_str(&command.quiet().read()?)?;
    let packages = list(&metadata, "packages")?;
    let names: Vec<&str> = packages
        .iter()
        .map(|package| text(package, "name"))
        .collect::<Result<_>>()?;
    packages
        .iter()
        .map(|value| package(value, &names))
        .collect()
}

fn package(value: &Value, names: &[&str]) -> Result<Package> {
    let mut imports = BTreeSet::new();
    for dependency in list(value, "dependencies")? {
        let name = text(dependency, "name")?;
        if dependency["kind"] != "dev" && names.contains(&name) {
            imports.insert(name.to_string());
        }
    }
    let mut roots = Vec::new();
    for target in list(value, "targets")? {
        let is = |kind: &str| target["kind"].to_string().contains(kind);
        if is("lib") || is("bin") {
            let name = text(target, "name")?;
            roots.push(Root {
                file: text(target, "src_path")?.into(),
                library: is("lib").then(|| name.to_string()),
            });
        }
    }
    Ok(Package {
        name: text(value, "name")?.to_string(),
        roots,
        imports,
    })
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    value[key]
        .as_array()
        .with_context(|| format!("cargo metadata: no list `{key}`"))
}

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str> {
    value[key]
        .as_str()
        .with_context(|| format!("cargo metadata: no text `{key}`"))
}
