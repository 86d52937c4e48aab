//! The order of the house: which file imports which, which crate which.

mod circles;
mod crates;
mod names;
mod packages;
mod resolve;
#[cfg(test)]
mod tests;
mod tree;
mod uses;

use anyhow::{Result, bail};
use xshell::Shell;

use circles::circles;
use packages::Package;
use tree::Tree;

/// Checks that no files import each other in a circle, and crates only what they may; every circle is told.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let packages = packages::read(shell)?;
    let mut faults = Vec::new();
    for package in &packages {
        for circle in circles(&tree(package)?) {
            let files = circle.text(&shell.current_dir());
            faults.push(format!("circle in {}:\n{files}", package.name));
        }
    }
    println!("house: {} circles among files", faults.len());
    faults.extend(crates::faults(&packages));
    match faults.is_empty() {
        true => Ok(()),
        false => bail!("{}", faults.join("\n")),
    }
}

fn tree(package: &Package) -> Result<Tree> {
    let mut tree = Tree::default();
    for root in &package.roots {
        tree.add_root(&root.file, root.library.as_deref())?;
    }
    Ok(tree)
}
