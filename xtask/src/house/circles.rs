//! Circles of files that import each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::names::{Named, named};
use super::resolve::Target;
use super::tree::{Module, Tree};

/// Names that a file imports from another, by the places of both in the list of files.
type Imports = BTreeMap<(usize, usize), BTreeSet<String>>;

/// A set of files each of which imports each other, straight or by way of others of the set.
#[derive(Debug)]
pub(super) struct Circle {
    pub(super) files: Vec<PathBuf>,
    pub(super) imports: Vec<Import>,
}

/// One file's import from another.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Import {
    pub(super) importer: PathBuf,
    pub(super) imported: PathBuf,
    pub(super) names: Vec<String>,
}

impl Circle {
    /// The files, and below them what one imports from the other, a line each; paths as seen from `root`.
    pub(super) fn text(&self, root: &Path) -> String {
        let place = |path: &Path| {
            path.strip_prefix(root)
                .unwrap_or(path)
                .display()
                .to_string()
        };
        let mut lines: Vec<String> = self
            .files
            .iter()
            .map(|file| format!("  {}", place(file)))
            .collect();
        lines.extend(self.imports.iter().map(|import| {
            let (importer, imported) = (place(&import.importer), place(&import.imported));
            format!(
                "    {importer} -> {imported} by {}",
                import.names.join(", ")
            )
        }));
        lines.join("\n")
    }
}

/// Finds all circles, none of which has a file of another.
pub(super) fn circles(tree: &Tree) -> Vec<Circle> {
    let imports = imports(tree);
    let reached: Vec<BTreeSet<usize>> = (0..tree.files.len())
        .map(|file| reached(&imports, file))
        .collect();
    let mut done: BTreeSet<usize> = BTreeSet::new();
    let mut circles = Vec::new();
    for file in 0..tree.files.len() {
        if reached[file].contains(&file) && !done.contains(&file) {
            let files = reached[file].iter().copied();
            let files: BTreeSet<usize> = files.filter(|&to| reached[to].contains(&file)).collect();
            done.extend(&files);
            circles.push(circle(tree, &imports, &files));
        }
    }
    circles.sort_by(|left, right| left.files.cmp(&right.files));
    circles
}

fn circle(tree: &Tree, imports: &Imports, members: &BTreeSet<usize>) -> Circle {
    let path = |file: &usize| tree.files[*file].clone();
    let mut files: Vec<PathBuf> = members.iter().map(path).collect();
    files.sort();
    let inside = imports
        .iter()
        .filter(|((from, to), _)| members.contains(from) && members.contains(to));
    let mut imports: Vec<Import> = inside
        .map(|((from, to), names)| Import {
            importer: path(from),
            imported: path(to),
            names: names.iter().cloned().collect(),
        })
        .collect();
    imports.sort();
    Circle { files, imports }
}

/// Files that one imports, straight or by way of others.
fn reached(imports: &Imports, file: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut ahead = vec![file];
    while let Some(file) = ahead.pop() {
        for &(_, to) in imports
            .range((file, 0)..=(file, usize::MAX))
            .map(|(key, _)| key)
        {
            if reached.insert(to) {
                ahead.push(to);
            }
        }
    }
    reached
}

fn imports(tree: &Tree) -> Imports {
    let mut imports = Imports::new();
    for (index, module) in tree.modules.iter().enumerate() {
        let named = named(&module.items);
        for named in named.iter().filter(|named| !hands_on(module, named)) {
            for target in tree.resolve(index, &named.path) {
                if let Target::Item(file, name) = target
                    && file != module.file
                {
                    imports.entry((module.file, file)).or_default().insert(name);
                }
            }
        }
    }
    imports
}

/// Test for an import that a module only passes on of a module below it.
fn hands_on(module: &Module, named: &Named) -> bool {
    let own = named.path.iter().find(|name| *name != "self");
    named.public && own.is_some_and(|name| module.children.contains_key(name))
}
