//! Modules of a package, and the files that hold them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use syn::{Attribute, Expr, ExprLit, Item, ItemMod, Lit, Meta};

use super::uses::{Use, attributes, defined, test_only, text, uses};

/// A module, without what is there only in tests.
pub(super) struct Module {
    /// Place of its file in the list of files.
    pub(super) file: usize,
    pub(super) parent: Option<usize>,
    pub(super) children: BTreeMap<String, usize>,
    /// Names of what it defines.
    pub(super) defined: BTreeSet<String>,
    pub(super) uses: Vec<Use>,
    /// All that it holds but for modules.
    pub(super) items: Vec<Item>,
}

/// The modules of a package's library and programs.
#[derive(Default)]
pub(super) struct Tree {
    pub(super) files: Vec<PathBuf>,
    pub(super) modules: Vec<Module>,
    /// The root of the library, by its name.
    pub(super) libraries: BTreeMap<String, usize>,
}

impl Tree {
    /// Reads a library or a program from its first file on.
    pub(super) fn add_root(&mut self, file: &Path, library: Option<&str>) -> Result<()> {
        let directory = file.parent().context("a root lies in no directory")?;
        let root = self.read(file, directory, None)?;
        if let Some(name) = library {
            self.libraries.insert(name.replace('-', "_"), root);
        }
        Ok(())
    }

    fn read(&mut self, path: &Path, directory: &Path, parent: Option<usize>) -> Result<usize> {
        let place = || path.display().to_string();
        let text = fs::read_to_string(path).with_context(place)?;
        let mut parsed = syn::parse_file(&text).with_context(place)?;
        if test_only(&parsed.attrs) {
            parsed.items.clear();
        }
        let file = match self.files.iter().position(|file| file == path) {
            Some(file) => file,
            None => {
                self.files.push(path.to_path_buf());
                self.files.len() - 1
            }
        };
        self.add(file, directory, parent, parsed.items)
    }

    fn add(
        &mut self,
        file: usize,
        directory: &Path,
        parent: Option<usize>,
        items: Vec<Item>,
    ) -> Result<usize> {
        let module = self.modules.len();
        self.modules.push(Module {
            file,
            parent,
            children: BTreeMap::new(),
            defined: BTreeSet::new(),
            uses: Vec::new(),
            items: Vec::new(),
        });
        for item in items {
            if test_only(attributes(&item)) {
                continue;
            }
            match item {
                Item::Mod(child) => self.add_child(module, directory, child)?,
                item => self.modules[module].hold(item),
            }
        }
        Ok(module)
    }

    fn add_child(&mut self, parent: usize, directory: &Path, child: ItemMod) -> Result<()> {
        let name = text(&child.ident);
        let file = self.modules[parent].file;
        let below = directory.join(&name);
        let module = match (child.content, elsewhere(&child.attrs)) {
            (Some((_, items)), _) => self.add(file, &below, Some(parent), items)?,
            (None, None) => self.read(&file_of(&below), &below, Some(parent))?,
            (None, Some(path)) => {
                let path = self.files[file].with_file_name(path);
                let below = path.parent().context("a module lies in no directory")?;
                self.read(&path, below, Some(parent))?
            }
        };
        self.modules[parent].children.insert(name, module);
        Ok(())
    }
}

impl Module {
    fn hold(&mut self, item: Item) {
        self.defined.extend(defined(&item));
        if let Item::Use(item) = &item {
            self.uses.extend(uses(item));
        }
        self.items.push(item);
    }
}

/// The file of a module whose own modules lie in the directory.
fn file_of(directory: &Path) -> PathBuf {
    let inside = directory.join("mod.rs");
    match inside.is_file() {
        true => inside,
        false => directory.with_extension("rs"),
    }
}

/// The file that `#[path]` names, as seen from the directory of the file that declares the module.
fn elsewhere(attributes: &[Attribute]) -> Option<String> {
    attributes
        .iter()
        .find_map(|attribute| match &attribute.meta {
            Meta::NameValue(meta) if meta.path.is_ident("path") => match &meta.value {
                Expr::Lit(ExprLit {
                    lit: Lit::Str(path),
                    ..
                }) => Some(path.value()),
                _ => None,
            },
            _ => None,
        })
}
