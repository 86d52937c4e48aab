//! Resolution of paths to the files that define what they name.

use std::collections::BTreeSet;

use super::tree::Tree;

/// Meaning of a name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Target {
    /// A module, by its place in the tree.
    Module(usize),
    /// An item, by its file's place in the list of files and the name that it has there.
    Item(usize, String),
}

/// Names that are being looked up, each in a module.
type Pending = BTreeSet<(usize, String)>;

impl Tree {
    /// Follows a path through modules and re-exports; nothing is found of what is another crate's.
    ///
    /// One name can stand for a module, a type, a function and a macro at once.
    pub(super) fn resolve(&self, from: usize, path: &[String]) -> Vec<Target> {
        self.follow(from, path, &mut Pending::new())
    }

    fn follow(&self, from: usize, path: &[String], pending: &mut Pending) -> Vec<Target> {
        let Some((head, rest)) = path.split_first() else {
            return Vec::new();
        };
        let mut targets = match head.as_str() {
            "crate" => vec![Target::Module(self.root(from))],
            "self" => vec![Target::Module(from)],
            "super" => self.above(from),
            _ => self.look_up(from, head, pending).unwrap_or_else(|| {
                let library = self.libraries.get(head);
                library.copied().map(Target::Module).into_iter().collect()
            }),
        };
        for name in rest {
            targets = self.step(targets, name, pending);
        }
        targets
    }

    /// Goes one name further; variants and other names below an item are the item's.
    fn step(&self, targets: Vec<Target>, name: &str, pending: &mut Pending) -> Vec<Target> {
        let modules = modules(&targets);
        if modules.is_empty() {
            return targets;
        }
        let mut found = Vec::new();
        for module in modules {
            match name {
                "self" => found.push(Target::Module(module)),
                "super" => found.extend(self.above(module)),
                // A macro can define what is not seen.
                _ => found.extend(self.look_up(module, name, pending).unwrap_or_else(|| {
                    vec![Target::Item(self.modules[module].file, name.to_string())]
                })),
            }
        }
        found
    }

    /// Looks a name up in a module; none where the module does not know it.
    fn look_up(&self, module: usize, name: &str, pending: &mut Pending) -> Option<Vec<Target>> {
        let here = &self.modules[module];
        let mut found = Vec::new();
        found.extend(here.children.get(name).copied().map(Target::Module));
        if here.defined.contains(name) {
            found.push(Target::Item(here.file, name.to_string()));
        }
        let mut known = !found.is_empty();
        let key = (module, name.to_string());
        if pending.insert(key.clone()) {
            for used in &here.uses {
                if used.name.as_deref() == Some(name) {
                    known = true;
                    found.extend(self.follow(module, &used.path, pending));
                }
            }
            for all in here.uses.iter().filter(|used| used.name.is_none()) {
                for below in modules(&self.follow(module, &all.path, pending)) {
                    if !known && let Some(targets) = self.look_up(below, name, pending) {
                        known = true;
                        found.extend(targets);
                    }
                }
            }
            pending.remove(&key);
        }
        known.then_some(found)
    }

    fn root(&self, mut module: usize) -> usize {
        while let Some(parent) = self.modules[module].parent {
            module = parent;
        }
        module
    }

    fn above(&self, module: usize) -> Vec<Target> {
        let parent = self.modules[module].parent;
        parent.map(Target::Module).into_iter().collect()
    }
}

fn modules(targets: &[Target]) -> Vec<usize> {
    let module = |target: &Target| match target {
        Target::Module(module) => Some(*module),
        Target::Item(..) => None,
    };
    targets.iter().filter_map(module).collect()
}
