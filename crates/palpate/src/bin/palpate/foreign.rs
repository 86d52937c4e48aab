//! Protection of files that palpate did not write: a run that would replace one is refused.

use std::fs;
use std::path::Path;

use anyhow::anyhow;
use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

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

/// Whether there is an entry at `path` other than a directory; links count as themselves.
fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| !found.is_dir())
}

/// Whether a run wrote this config: it states the version of palpate and has no comment, which a run never writes.
fn is_of_a_run(path: &Path) -> bool {
    fs::read_to_string(path).is_ok_and(|text| {
        let is_comment = |token: Token| token.kind() == TokenKind::Comment;
        let has_version = text
            .lines()
            .any(|line| line.starts_with("crate_version = "));
        has_version && !Source::new(&text).lex().any(is_comment)
    })
}
