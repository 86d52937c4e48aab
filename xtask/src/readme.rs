//! Check of the README: its commands must work as they are printed.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Parser;
use xshell::{Shell, cmd};

use crate::{Cli, programs};

/// Folders of the repository that the commands need.
const COPIED: [&str; 3] = ["sim-configs", "examples", "results"];
/// Folder of the outputs, which git ignores.
const OUTPUT: &str = "out";

/// Runs the commands of the `sh` blocks in a copy of the repository's inputs, with `palpate` on the path.
///
/// Commands of cargo are not run, because they would run this check again. But `cargo xtask …` must parse.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let readme = shell.read_file("README.md")?;
    let binary = programs::build(shell, "palpate")?;
    let directory = tempfile::tempdir()?;
    for name in COPIED {
        let to = directory.path();
        cmd!(shell, "cp -r {name} {to}").quiet().run()?;
    }

    let sandbox = Shell::new()?;
    sandbox.change_dir(directory.path());
    let binaries = binary.parent().map(Path::to_path_buf);
    let path = env::var_os("PATH").unwrap_or_default();
    sandbox.set_var(
        "PATH",
        env::join_paths(binaries.into_iter().chain(env::split_paths(&path)))?,
    );
    for command in commands(&readme) {
        run(&sandbox, &command).with_context(|| format!("README.md: `{command}`"))?;
    }
    match strays(directory.path())?.as_slice() {
        [] => Ok(()),
        strays => bail!("README.md: its commands write {strays:?} outside {OUTPUT}/"),
    }
}

/// Names that are neither inputs nor the folder of outputs.
fn strays(directory: &Path) -> Result<Vec<OsString>> {
    let names = fs::read_dir(directory)?.map(|entry| Ok(entry?.file_name()));
    let mut names: Vec<OsString> = names.collect::<Result<_>>()?;
    names.retain(|name| name != OUTPUT && !COPIED.iter().any(|copied| name == copied));
    Ok(names)
}

fn run(sandbox: &Shell, command: &str) -> Result<()> {
    let mut words = command.split_whitespace();
    if words.next() != Some("cargo") {
        println!("$ {command}");
        return Ok(cmd!(sandbox, "sh -c {command}")
            .quiet()
            .ignore_stdout()
            .run()?);
    }
    if words.next() == Some("xtask")
        && let Err(error) = Cli::try_parse_from(["xtask"].into_iter().chain(words))
    {
        bail!("{error}");
    }
    Ok(())
}

/// The commands of all blocks with the tag `sh`. A line that ends with `\` continues in the next one.
fn commands(markdown: &str) -> Vec<String> {
    let mut commands = Vec::new();
    let mut block: Option<bool> = None;
    let mut command = String::new();
    for line in markdown.lines() {
        match (block, line.trim_start().strip_prefix("```")) {
            (None, Some(tag)) => block = Some(tag.trim() == "sh"),
            (Some(_), Some(_)) => block = None,
            (Some(true), None) => match line.trim().strip_suffix('\\') {
                Some(start) => command.push_str(start),
                None => {
                    command.push_str(line.trim());
                    commands.push(std::mem::take(&mut command));
                }
            },
            (Some(false) | None, None) => {}
        }
    }
    commands.retain(|command| !command.is_empty() && !command.starts_with('#'));
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_sh_blocks_give_commands() {
        let markdown = "\
text `palpate nothing`
```sh
palpate run a.toml   # a comment stays
# a line of comment

palpate plot \\
    out/a
```
```toml
name = \"x\"
```
```sh no-ci
palpate never
```
```
palpate untagged
```
1. in a list
   ```sh
   cargo xtask ci
   ```
";
        assert_eq!(
            commands(markdown),
            [
                "palpate run a.toml   # a comment stays",
                "palpate plot out/a",
                "cargo xtask ci"
            ]
        );
    }

    #[test]
    fn cargo_is_not_run_but_tasks_must_exist() {
        let shell = Shell::new().unwrap();
        assert!(run(&shell, "cargo install --path nowhere").is_ok());
        assert!(run(&shell, "cargo xtask ci").is_ok());
        assert!(run(&shell, "cargo xtask reproduce some-study --quick --check").is_ok());
        assert!(run(&shell, "cargo xtask reprodcue").is_err());
        assert!(run(&shell, "cargo xtask reproduce --fast").is_err());
    }

    #[test]
    fn files_outside_inputs_and_outputs_are_strays() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["examples", "out", "mine.toml"] {
            fs::create_dir(directory.path().join(name)).unwrap();
        }
        assert_eq!(strays(directory.path()).unwrap(), ["mine.toml"]);
    }

    #[test]
    fn a_command_that_fails_is_an_error() {
        let shell = Shell::new().unwrap();
        assert!(run(&shell, "true && test 1 = 1").is_ok());
        assert!(run(&shell, "exit 3").is_err());
    }
}
