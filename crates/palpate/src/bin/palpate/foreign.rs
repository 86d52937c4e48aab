//! Protection of files that palpate did not write: a run that would replace one is refused.

use std::fs;
use std::path::Path;

use anyhow::anyhow;

use crate::failure::Failure;
use crate::output::names::{CONFIG, NEXT_CONFIG, is_of_a_run};
use crate::output::{Guard, Owned};

const REMEDY: &str = "the run would replace it; give another --out, or move it away";

/// Refuses where a run that writes `tables` into `dir` would replace a config that no run wrote, a table without the
/// config of a run beside it, or a file that palpate did not write.
pub(crate) fn refuse(dir: &Path, tables: &[&str], guard: &Guard) -> Result<(), Failure> {
    if guard.is_forced() {
        return Ok(());
    }
    let refused = |why: String| Err(Failure::usage(anyhow!("{why}: {REMEDY}")));
    for name in [CONFIG, NEXT_CONFIG] {
        let path = dir.join(name);
        if is_file(&path) && !is_of_a_run(&path) {
            let path = path.display();
            return refused(format!("{path} is no config that palpate wrote"));
        }
    }
    let owned = Owned::read(dir, guard.clone())?;
    if is_file(&dir.join(CONFIG)) {
        return tables.iter().try_for_each(|name| owned.refuse(name, None));
    }
    let mut found = tables.iter().filter(|name| is_file(&dir.join(name)));
    match found.find(|name| !owned.lists(name)) {
        Some(table) => {
            let table = dir.join(table);
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
