//! Whoever changes a number says so.

use std::collections::BTreeSet;

use anyhow::{Result, bail};
use xshell::{Shell, cmd};

const FILE: &str = "CHANGELOG.md";
const HEADING: &str = "### Numerical changes";

/// Fails unless the section of numerical changes has a line that the last commit does not have.
pub(crate) fn demand_line(shell: &Shell) -> Result<()> {
    let committed = cmd!(shell, "git show HEAD:{FILE}")
        .quiet()
        .ignore_stderr()
        .read();
    if has_new_line(&committed.unwrap_or_default(), &shell.read_file(FILE)?) {
        return Ok(());
    }
    bail!(
        "an error is another than in the baseline, or has come or gone, but `{HEADING}` in {FILE} has no line more than the last commit: \
         write there what changes, why and by how much, then accept"
    )
}

fn has_new_line(committed: &str, now: &str) -> bool {
    let known: BTreeSet<&str> = section(committed).collect();
    section(now).any(|line| !known.contains(line))
}

/// The lines below the heading that say something, up to the next heading.
fn section(text: &str) -> impl Iterator<Item = &str> {
    let below = text
        .lines()
        .skip_while(|line| line.trim_end() != HEADING)
        .skip(1);
    let lines = below.take_while(|line| !line.starts_with('#'));
    lines.map(str::trim).filter(|line| !line.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMITTED: &str =
        "# Changelog\n\n### Added\n\n- A.\n\n### Numerical changes\n\n- Old.\n\n## 0.1\n\n- B.\n";

    #[test]
    fn only_a_line_below_the_heading_counts() {
        assert!(!has_new_line(COMMITTED, COMMITTED));
        let with = |old: &str, new: &str| has_new_line(COMMITTED, &COMMITTED.replace(old, new));
        assert!(with("- Old.\n", "- Old.\n- New: smaller by 2 %.\n"));
        assert!(!with("- A.\n", "- A.\n- New.\n"));
        assert!(!with("- B.\n", "- B.\n- New.\n"));
        assert!(!with("- Old.\n", "- Old.\n\n  \n"));
        assert!(!with("- Old.\n", ""));
        assert!(has_new_line("", COMMITTED));
    }
}
