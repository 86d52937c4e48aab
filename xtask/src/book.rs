//! Builds the book from `docs/`, and checks README.md and the book. The check also runs every command in these
//! documents.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Parser;
use xshell::{Shell, cmd};

use crate::{Cli, programs, python};

/// Folders of the repository that the commands in the documents read.
const COPIED: [&str; 3] = ["sim-configs", "examples", "results"];
/// Folder into which the commands of the documents write their output. Git ignores this folder.
const OUTPUT: &str = "out";
/// Folder with the pages of the book.
const BOOK: &str = "docs";
/// Documents outside the book's folder. Pages of the book link to them.
const PAGES: [&str; 6] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "SECURITY.md",
    "CITATION.cff",
];
const GLOSSARY: &str = "docs/glossary.md";
/// Page that lists the claims of the papers with their verdicts.
const CLAIMS: &str = "docs/papers.md";
/// Documents with a limited length: path, largest number of lines, and largest number of words.
const LIMITS: [(&str, usize, usize); 3] = [
    ("README.md", 200, 2200),
    ("ARCHITECTURE.md", 150, usize::MAX),
    ("CHANGELOG.md", 80, usize::MAX),
];

pub(crate) fn run(shell: &Shell) -> Result<()> {
    let program = programs::build_alone(shell)?;
    shell.write_file(GLOSSARY, glossary(shell, &program)?)?;
    build(shell)
}

/// Checks the documents: their length, the glossary, links, claims, quoted files, commands and paths.
///
/// Does not run commands that begin with `cargo`, because such a command could run this check again. For a command
/// `cargo xtask …`, only checks that the task exists.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    check_texts(shell)?;
    let program = programs::build(shell, "palpate")?;
    ensure!(
        glossary(shell, &program)? == shell.read_file(GLOSSARY)?,
        "{GLOSSARY} is old: run `cargo xtask book`"
    );
    if crate::tools::has(shell, "python3") {
        build(shell)?;
    }
    run_commands(shell, &program)
}

/// Checks the documents without other programs: their lengths, claims, quoted files and paths.
fn check_texts(shell: &Shell) -> Result<()> {
    for (name, lines, words) in LIMITS {
        let text = shell.read_file(name)?;
        let found = (text.lines().count(), text.split_whitespace().count());
        ensure!(
            found.0 <= lines && found.1 <= words,
            "{name} has {} lines and {} words, more than {lines} or {words}",
            found.0,
            found.1
        );
    }
    check_claims(shell)?;
    let root = shell.current_dir();
    let is_there =
        |path: &String| root.join(path).exists() || root.join("crates").join(path).exists();
    for page in pages(shell)?.into_iter().chain(PAGES.map(PathBuf::from)) {
        let (text, name) = (shell.read_file(&page)?, page.display());
        for (file, quoted) in quotes(&text) {
            let exact = shell.read_file(file)?.contains(&quoted);
            ensure!(
                exact,
                "{name}: {file} does not contain the lines quoted from it"
            );
        }
        if let Some(path) = source_paths(&text).iter().find(|path| !is_there(path)) {
            bail!("{name}: there is no {path}");
        }
    }
    Ok(())
}

/// Checks that the page of the papers' claims states the same verdicts as `results/*/claims.csv`.
fn check_claims(shell: &Shell) -> Result<()> {
    let page = shell.read_file(CLAIMS)?;
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| ")).collect();
    for folder in shell.read_dir("results")? {
        let Ok(mut table) = csv::Reader::from_path(folder.join("claims.csv")) else {
            continue;
        };
        let study = folder.file_name().unwrap_or_default().to_string_lossy();
        for record in table.records() {
            let record = record?;
            let (claim, verdict) = (&record[0], record[1].trim_end_matches('s'));
            let row = rows
                .iter()
                .find(|row| row.starts_with(&format!("| {claim} | ")));
            let stated = row.and_then(|row| row.split_once(&format!("`{study}`")));
            let stated = stated.and_then(|(_, rest)| rest.split_once(": "));
            ensure!(
                stated.is_some_and(|(_, words)| words.starts_with(verdict)),
                "{CLAIMS}: claim {claim} {} in the study {study}",
                &record[1]
            );
        }
    }
    Ok(())
}

/// Paths of source files that a document mentions in code spans. A path with braces, such as `{a,b}`, stands for
/// several paths.
fn source_paths(markdown: &str) -> Vec<String> {
    let spans = markdown.split('`').skip(1).step_by(2);
    let is_path = |span: &&str| {
        span.contains('/') && span.ends_with(".rs") && !span.contains(['*', ' ', '\n'])
    };
    let is_example = |span: &&str| !span.contains("NAME");
    let expanded = |span: &str| match span.split_once('{') {
        None => vec![span.to_owned()],
        Some((start, rest)) => {
            let (names, end) = rest.split_once('}').unwrap_or((rest, ""));
            names
                .split(',')
                .map(|name| format!("{start}{name}{end}"))
                .collect()
        }
    };
    spans
        .filter(is_path)
        .filter(is_example)
        .flat_map(expanded)
        .collect()
}

fn glossary(shell: &Shell, program: &Path) -> Result<String> {
    Ok(cmd!(shell, "{program} explain --markdown").quiet().read()? + "\n")
}

/// Builds the book with MkDocs. Fails if a link is broken.
fn build(shell: &Shell) -> Result<()> {
    let place = programs::target_dir(shell).join("book");
    let source = place.join("source");
    shell.remove_path(&source)?;
    shell.create_dir(&source)?;
    let folders = COPIED.iter().chain([&BOOK]);
    let parts = PAGES.iter().chain(folders);
    cmd!(shell, "cp -r {parts...} {source}").quiet().run()?;
    shell.copy_file(source.join(BOOK).join("mkdocs.yml"), &place)?;
    let python = python::environment(shell, &place.join("venv"), "docs/requirements.txt")?;
    let config = place.join("mkdocs.yml");
    cmd!(
        shell,
        "{python} -m mkdocs --quiet build --strict --config-file {config}"
    )
    .run()?;
    println!("book: {}", place.join("site/index.html").display());
    Ok(())
}

/// Runs the commands of all `sh` blocks in a copy of the folders in [`COPIED`]. `palpate` is on the path.
fn run_commands(shell: &Shell, program: &Path) -> Result<()> {
    let directory = tempfile::tempdir()?;
    for name in COPIED {
        let to = directory.path();
        cmd!(shell, "cp -r {name} {to}").quiet().run()?;
    }
    let sandbox = Shell::new()?;
    sandbox.change_dir(directory.path());
    let binaries = program.parent().map(Path::to_path_buf);
    let path = env::var_os("PATH").unwrap_or_default();
    sandbox.set_var(
        "PATH",
        env::join_paths(binaries.into_iter().chain(env::split_paths(&path)))?,
    );
    let mut done = Vec::new();
    for page in pages(shell)? {
        let (text, name) = (shell.read_file(&page)?, page.display());
        for command in commands(&text) {
            // Do not run a command again if an earlier page contains it.
            if !done.contains(&command) {
                run_command(&sandbox, &command).with_context(|| format!("{name}: `{command}`"))?;
                done.push(command);
            }
        }
    }
    match strays(directory.path())?.as_slice() {
        [] => Ok(()),
        strays => bail!("commands of the documents write {strays:?} outside {OUTPUT}/"),
    }
}

/// README.md, and then the pages of the book in alphabetical order.
fn pages(shell: &Shell) -> Result<Vec<PathBuf>> {
    let mut pages = shell.read_dir(BOOK)?;
    pages.retain(|page| page.extension().is_some_and(|kind| kind == "md"));
    pages.insert(0, shell.current_dir().join("README.md"));
    Ok(pages)
}

/// Files that the `toml` blocks of a document quote, each with the quoted lines. Such a block begins with the line `#
/// from FILE`.
fn quotes(markdown: &str) -> Vec<(&str, String)> {
    markdown
        .split("```toml\n# from ")
        .skip(1)
        .filter_map(|block| block.split_once("```")?.0.split_once('\n'))
        .map(|(file, lines)| (file.trim(), lines.to_owned()))
        .collect()
}

/// Names of the files and folders in `directory` that the commands wrote outside of the output folder.
fn strays(directory: &Path) -> Result<Vec<OsString>> {
    let names = fs::read_dir(directory)?.map(|entry| Ok(entry?.file_name()));
    let mut names: Vec<OsString> = names.collect::<Result<_>>()?;
    names.retain(|name| name != OUTPUT && !COPIED.iter().any(|copied| name == copied));
    Ok(names)
}

fn run_command(sandbox: &Shell, command: &str) -> Result<()> {
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

/// The commands in all `sh` blocks of a document. If a line ends with `\`, the command continues on the next line.
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
    fn commands_run_except_cargo_whose_tasks_must_exist() {
        let shell = Shell::new().unwrap();
        assert!(run_command(&shell, "cargo install --path nowhere").is_ok());
        assert!(run_command(&shell, "cargo xtask ci").is_ok());
        assert!(run_command(&shell, "cargo xtask reproduce some-study --quick --check").is_ok());
        assert!(run_command(&shell, "cargo xtask reprodcue").is_err());
        assert!(run_command(&shell, "cargo xtask reproduce --fast").is_err());
        assert!(run_command(&shell, "true && test 1 = 1").is_ok());
        assert!(run_command(&shell, "exit 3").is_err());
    }

    #[test]
    fn the_documents_agree_with_the_repository() {
        let shell = Shell::new().unwrap();
        shell.change_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
        check_texts(&shell).unwrap();
    }

    #[test]
    fn paths_of_source_files_are_found_in_code_spans() {
        let markdown =
            "`ep1/src/{batch,fit}.rs` and `new/NAME.rs`, `a.rs`, `*/x.rs`, `press/src/body.rs`";
        assert_eq!(
            source_paths(markdown),
            ["ep1/src/batch.rs", "ep1/src/fit.rs", "press/src/body.rs"]
        );
    }

    #[test]
    fn quoted_lines_have_a_file() {
        let markdown = "```toml\n# from a/b.toml\nx = 1\ny = 2\n```\n```toml\nz = 3\n```\n";
        assert_eq!(
            quotes(markdown),
            [("a/b.toml", "x = 1\ny = 2\n".to_owned())]
        );
    }

    #[test]
    fn files_outside_inputs_and_outputs_are_strays() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["examples", "out", "mine.toml"] {
            fs::create_dir(directory.path().join(name)).unwrap();
        }
        assert_eq!(strays(directory.path()).unwrap(), ["mine.toml"]);
    }
}
