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

/// Circles among files that there are today; to be lowered with each that is cut.
const MOST_CIRCLES: usize = 17;

/// Prints every circle among files, then checks as [`check`] does.
pub(crate) fn run(shell: &Shell) -> Result<()> {
    check_telling(shell, |circle| println!("{circle}"))
}

/// Checks that files import each other in no more circles than today, and crates only what they may.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    check_telling(shell, |_| ())
}

fn check_telling(shell: &Shell, tell: impl Fn(&str)) -> Result<()> {
    let packages = packages::read(shell)?;
    let mut number = 0;
    for package in &packages {
        for circle in circles(&tree(package)?) {
            let files = circle.text(&shell.current_dir());
            tell(&format!("circle in {}:\n{files}", package.name));
            number += 1;
        }
    }
    println!("house: {number} circles among files, {MOST_CIRCLES} allowed");

    let mut faults = crates::faults(&packages);
    if number > MOST_CIRCLES {
        faults.push(format!(
            "files import each other in {number} circles, at most {MOST_CIRCLES} may be: `cargo xtask house` lists them, cut the new one"
        ));
    }
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
