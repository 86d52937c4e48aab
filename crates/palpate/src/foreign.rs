//! What a run must not replace: files that palpate did not write.

use std::fs;
use std::path::Path;

use anyhow::anyhow;

use crate::failure::Failure;
use crate::output::{CONFIG, NEXT_CONFIG};

const REMEDY: &str = "the run would replace it; give another --out, or move it away";

/// Refuses where a run that writes `tables` into `dir` would replace a config that no run wrote, or a table without the
/// config of a run beside it.
pub(crate) fn refuse(dir: &Path, tables: &[&str]) -> Result<(), Failure> {
    let refused = |why: String| Err(Failure::usage(anyhow!("{why}: {REMEDY}")));
    for name in [CONFIG, NEXT_CONFIG] {
        let path = dir.join(name);
        if is_file(&path) && !is_of_a_run(&path) {
            let path = path.display();
            return refused(format!("{path} is no config that palpate wrote"));
        }
    }
    if is_file(&dir.join(CONFIG)) {
        return Ok(());
    }
    match tables
        .iter()
        .map(|name| dir.join(name))
        .find(|path| is_file(path))
    {
        Some(table) => {
            let table = table.display();
            refused(format!("{table} has no {CONFIG} of palpate beside it"))
        }
        None => Ok(()),
    }
}

/// Whether there is something that can be replaced; a directory cannot.
fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| !found.is_dir())
}

/// Whether a run wrote this config, and nobody a comment into it.
fn is_of_a_run(path: &Path) -> bool {
    fs::read_to_string(path).is_ok_and(|text| {
        let mut lines = text.lines();
        lines.any(|line| line.starts_with("crate_version = ")) && !text.lines().any(has_comment)
    })
}

/// Whether a line of TOML has a comment: a `#` that begins it, or that no string is closed after.
fn has_comment(line: &str) -> bool {
    let after = line.rsplit_once('#').map(|(_, after)| after);
    line.trim_start().starts_with('#') || after.is_some_and(|after| !after.contains(['"', '\'']))
}

#[cfg(test)]
mod tests {
    use super::has_comment;

    #[test]
    fn comments_are_told_from_strings() {
        for line in ["# a note", "  # it's", "trials = 3 # more", "x = \"#\" #"] {
            assert!(has_comment(line), "{line}");
        }
        for line in ["trials = 3", "title = \"no. # 3\"", "title = '# 1'", ""] {
            assert!(!has_comment(line), "{line}");
        }
    }
}
