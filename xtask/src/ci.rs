//! Continuous integration: runs all steps.

use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, anyhow};
use xshell::{Shell, cmd};

use crate::programs::{FEATURES, PYTHON};
use crate::{bench_check, book, crate_imports, programs, python, reproduce, tools};

/// Environment variables for the build scripts of PyO3. With these variables, the compiler checks and links the Python
/// package without a Python interpreter.
const NO_INTERPRETER: [(&str, &str); 2] = [
    ("PYO3_NO_PYTHON", "1"),
    ("PYO3_BUILD_EXTENSION_MODULE", "1"),
];

type Step = (&'static str, fn(&Shell) -> Result<()>);

/// Steps that run one after another. Most of the time, each of them uses all processor cores.
const STEPS: [Step; 9] = [
    ("tools", tools::prepare),
    ("format", format),
    ("house", crate_imports::check),
    ("clippy", clippy),
    ("tests", tests),
    ("examples", examples),
    ("docs", docs),
    ("licences", licences),
    ("results", results),
];

/// Two lists of steps. The lists run at the same time, because a step of these lists uses only one core most of the
/// time.
const SIDE_BY_SIDE: [&[Step]; 2] = [
    &[("python", python), ("instructions and accuracy", bench)],
    &[
        ("answers", programs::check_answers),
        ("documents", book::check),
        ("WebAssembly", web_assembly),
    ],
];

pub(crate) fn run(shell: &Shell) -> Result<()> {
    let start = Instant::now();
    run_in_order(shell, &STEPS)?;
    let root = shell.current_dir();
    let in_own_shell = |steps: &[Step]| {
        let shell = Shell::new()?;
        shell.change_dir(&root);
        run_in_order(&shell, steps)
    };
    thread::scope(|scope| -> Result<()> {
        let lists = SIDE_BY_SIDE.map(|steps| scope.spawn(|| in_own_shell(steps)));
        let ends = lists.map(|list| list.join().map_err(|_| anyhow!("ci: a step panicked"))?);
        ends.into_iter().collect()
    })?;
    println!("ci: ok, {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

fn run_in_order(shell: &Shell, steps: &[Step]) -> Result<()> {
    for (name, step) in steps {
        println!("== {name}");
        let start = Instant::now();
        step(shell).with_context(|| format!("ci: step `{name}` failed"))?;
        println!("== {name}: ok, {:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}

fn format(shell: &Shell) -> Result<()> {
    Ok(cmd!(shell, "cargo fmt --all --check").run()?)
}

fn clippy(shell: &Shell) -> Result<()> {
    let clippy = cmd!(
        shell,
        "cargo clippy --release --workspace --all-targets --features {FEATURES} -- -D warnings"
    );
    Ok(clippy.envs(NO_INTERPRETER).run()?)
}

/// Runs all tests and doc tests, but no benchmarks. In CI, property tests use the same random cases in every run, so
/// that only a change of the code can change a result. Tests that a developer runs by hand use new random cases.
fn tests(shell: &Shell) -> Result<()> {
    let tests = cmd!(
        shell,
        "cargo test --release --workspace --exclude {PYTHON} --features {FEATURES}"
    );
    Ok(tests.env("PROPTEST_RNG_SEED", "1996").run()?)
}

fn examples(shell: &Shell) -> Result<()> {
    for file in shell.read_dir("crates/palpate/examples")? {
        let name = file.file_stem().unwrap_or_default();
        let program = programs::target_dir(shell)
            .join("release/examples")
            .join(name);
        cmd!(shell, "{program}").run()?;
    }
    Ok(())
}

fn docs(shell: &Shell) -> Result<()> {
    let doc = cmd!(
        shell,
        "cargo doc --release --workspace --features {FEATURES} --no-deps"
    );
    let doc = doc.env("RUSTDOCFLAGS", "-D warnings");
    Ok(doc.envs(NO_INTERPRETER).run()?)
}

/// Checks the licences of all dependencies. The check is skipped if cargo-deny is missing; the step `tools` has
/// reported this.
fn licences(shell: &Shell) -> Result<()> {
    match tools::has(shell, tools::DENY) {
        true => Ok(cmd!(shell, "cargo deny --offline check licenses bans sources").run()?),
        false => Ok(()),
    }
}

/// Compares instruction counts and errors with the baseline. The step `tests` has already checked the models that
/// `auto` chooses and the fuzz corpus.
fn bench(shell: &Shell) -> Result<()> {
    bench_check::run(shell, &bench_check::Options { accept: false })
}

/// Tests the Python package. Its wheel contains the crates that earlier steps have compiled. The test is skipped if
/// there is no Python interpreter; the step `tools` has reported this.
fn python(shell: &Shell) -> Result<()> {
    match tools::has(shell, "python3") {
        true => python::check(shell),
        false => Ok(()),
    }
}

/// Checks that the libraries compile for WebAssembly in a browser.
fn web_assembly(shell: &Shell) -> Result<()> {
    let target = tools::WASM;
    let check = cmd!(
        shell,
        "cargo check --release --package palpate --lib --no-default-features --target {target}"
    );
    Ok(check.run()?)
}

fn results(shell: &Shell) -> Result<()> {
    let options = reproduce::Options {
        studies: Vec::new(),
        quick: true,
        check: true,
        all: true,
    };
    reproduce::run_with(shell, &programs::build(shell, "palpate")?, &options)
}
