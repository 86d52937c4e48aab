//! Tables of shortened studies on every host that this machine can be: one SHA-256 per study, or the hosts that differ.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use sha2::{Digest, Sha256};
use xshell::{Shell, cmd};

use crate::palpate::{self, target_dir};
use crate::tools::{WASM, has};

/// Status of the program where the processor lacks the instructions that are asked for.
const LACKING: i32 = 3;
/// Functions of the C library that round as it likes; roots, rounding and remainders are exact everywhere.
const ELEMENTARY: [&str; 36] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf",
    "erfc", "exp", "exp10", "exp2", "expm1", "fma", "hypot", "j0", "j1", "jn", "lgamma", "log",
    "log10", "log1p", "log2", "pow", "sin", "sincos", "sinh", "tan", "tanh", "tgamma", "y0", "y1",
    "yn",
];

#[derive(Args)]
pub(crate) struct Options {
    /// Only quick studies, each cut shorter, and WebAssembly unoptimised: a minute after the build.
    #[arg(long)]
    pub(crate) quick: bool,
}

/// Studies and examples that `--quick` leaves out: many frames take their time under an emulator.
const SLOW: [&str; 5] = [
    "press-effective-radius",
    "press-with-a-camera",
    "sensor-calibration",
    "sensor-design",
    "sensor-disturbances",
];

/// A way to run the program.
struct Host {
    name: &'static str,
    command: Vec<String>,
    environment: Option<(&'static str, &'static str)>,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let start = Instant::now();
    let (cells, trials) = if options.quick { (2, 4) } else { (4, 8) };
    let configs = configs(shell, options.quick)?;
    let hosts = hosts(shell, options.quick)?;
    let folder = shell.current_dir();
    // WebAssembly is one thread, and the emulator leaves time, too.
    let texts = std::thread::scope(|scope| {
        let ask = |host| {
            let (configs, folder) = (&configs, &folder);
            scope.spawn(move || answer(folder, host, cells, trials, configs))
        };
        let asked: Vec<_> = hosts.iter().map(ask).collect();
        asked
            .into_iter()
            .map(|asked| asked.join().map_err(|_| anyhow!("a thread ended badly"))?)
            .collect::<Result<Vec<_>>>()
    });
    let mut answers: Vec<(&str, BTreeMap<String, String>)> = Vec::new();
    for (host, text) in hosts.iter().zip(texts?) {
        match text {
            Some(text) => answers.push((host.name, digests(&text))),
            None => println!("{}: not on this processor", host.name),
        }
    }
    let differing = print(&answers)?;
    println!("total: {:.1} s", start.elapsed().as_secs_f64());
    if differing > 0 {
        bail!("tables of {differing} studies depend on the host");
    }
    Ok(())
}

/// Refuses a program that takes elementary functions from the C library.
pub(crate) fn refuse_imports(shell: &Shell, program: &Path) -> Result<()> {
    let dynamic = cmd!(shell, "nm --dynamic --undefined-only {program}").quiet();
    let symbols = dynamic.read().context("nm, of binutils, lists imports")?;
    let imported: Vec<&str> = symbols
        .lines()
        .filter_map(|line| line.split_whitespace().last()?.split('@').next())
        .filter(|name| {
            let double = name.strip_suffix('f').unwrap_or(name);
            [name, double].iter().any(|name| ELEMENTARY.contains(name))
        })
        .collect();
    if !imported.is_empty() {
        let (program, imported) = (program.display(), imported.join(", "));
        bail!(
            "{program} takes {imported} from the C library; see clippy.toml for what to call instead"
        );
    }
    Ok(())
}

/// Refuses powers of exponents that are known only when the program runs: the order of their products is the compiler's.
///
/// Tests are left out, and the harnesses.
pub(crate) fn refuse_powers(shell: &Shell) -> Result<()> {
    let mut found = Vec::new();
    for source in cmd!(shell, "git ls-files crates/*/src/*.rs")
        .quiet()
        .read()?
        .lines()
    {
        if source.contains("/assay/") || source.contains("/tests/") {
            continue;
        }
        let text = shell.read_file(source)?;
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        found.extend(powers(code).map(|line| format!("{source}:{line}")));
    }
    match &found[..] {
        [] => Ok(()),
        found => bail!(
            "powi takes constant exponents only, else libm::pow or a loop: {}",
            found.join(", ")
        ),
    }
}

/// Lines of the calls of `powi` whose exponent is no number.
fn powers(code: &str) -> impl Iterator<Item = usize> {
    let calls = code.match_indices("powi(").filter(|(place, call)| {
        if !code[..*place].ends_with('.') {
            return true;
        }
        let exponent = code[place + call.len()..].split(')').next();
        exponent.is_none_or(|exponent| exponent.trim().parse::<i32>().is_err())
    });
    calls.map(|(place, _)| code[..place].matches('\n').count() + 1)
}

/// Configs of all studies and examples, or of the quick ones.
fn configs(shell: &Shell, quick: bool) -> Result<Vec<PathBuf>> {
    let mut configs = shell.read_dir("examples")?;
    configs.extend(shell.read_dir("sim-configs")?);
    configs.retain(|path| {
        let name = path.file_stem().and_then(|name| name.to_str());
        let is_config = path
            .extension()
            .is_some_and(|extension| extension == "toml");
        is_config && name.is_some_and(|name| !quick || !SLOW.contains(&name))
    });
    Ok(configs)
}

/// Builds the program and lists the hosts that this machine can be.
fn hosts(shell: &Shell, quick: bool) -> Result<Vec<Host>> {
    let package = "palpate-replica";
    let program = palpate::build(shell, package)?;
    // No vectors there, so that an unoptimised module tells as much.
    let (profile, folder) = if quick {
        ("dev", "debug")
    } else {
        ("release", "release")
    };
    cmd!(
        shell,
        "cargo build --quiet -p {package} --profile {profile} --lib --target {WASM}"
    )
    .run()
    .with_context(|| format!("is the target there? rustup target add {WASM}"))?;
    let target = target_dir(shell);
    let text = |path: PathBuf| path.display().to_string();
    refuse_imports(shell, &program)?;
    let program = text(program);
    let module = text(target.join(WASM).join(folder).join("palpate_replica.wasm"));
    let script = text(shell.current_dir().join("crates/replica/src/run.mjs"));
    let host = |name, command: &[&str]| Host {
        name,
        command: command.iter().map(ToString::to_string).collect(),
        environment: None,
    };
    let tunables = ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA");
    let mut hosts = vec![
        host("this processor", &[&program, "widest"]),
        host("without vectors", &[&program, "scalar"]),
        host("vectors of AVX2", &[&program, "v3"]),
        host("vectors of AVX-512", &[&program, "v4"]),
        Host {
            environment: Some(tunables),
            ..host("C library without AVX2 and FMA", &[&program, "widest"])
        },
    ];
    if has(shell, "qemu-x86_64") {
        let emulated = ["qemu-x86_64", "-cpu", "Nehalem", &program, "widest"];
        hosts.push(host("processor of 2008 (qemu)", &emulated));
    } else {
        println!("processor of 2008: needs qemu-x86_64 (Debian: qemu-user)");
    }
    if has(shell, "node") {
        hosts.push(host("WebAssembly (Node)", &["node", &script, &module]));
    } else {
        println!("WebAssembly: needs node");
    }
    Ok(hosts)
}

/// Text that the program prints on a host; none where the processor lacks its instructions.
fn answer(
    folder: &Path,
    host: &Host,
    cells: usize,
    trials: u64,
    configs: &[PathBuf],
) -> Result<Option<String>> {
    let started = Instant::now();
    let shell = Shell::new()?;
    shell.change_dir(folder);
    let (program, arguments) = host.command.split_first().context("a host has a program")?;
    let (cells, trials) = (cells.to_string(), trials.to_string());
    let run = cmd!(
        shell,
        "{program} {arguments...} {cells} {trials} {configs...}"
    );
    let output = run
        .envs(host.environment)
        .quiet()
        .ignore_status()
        .output()?;
    println!("{}: {:.1} s", host.name, started.elapsed().as_secs_f64());
    match output.status.code() {
        Some(0) => Ok(Some(String::from_utf8(output.stdout)?)),
        Some(LACKING) => Ok(None),
        _ => bail!(
            "{}: {}",
            host.name,
            String::from_utf8_lossy(&output.stderr).trim()
        ),
    }
}

/// SHA-256 of the tables of each study, which stand after lines `# NAME`.
fn digests(text: &str) -> BTreeMap<String, String> {
    let mut tables: BTreeMap<String, Sha256> = BTreeMap::new();
    let mut name = String::new();
    for line in text.split_inclusive('\n') {
        match line.strip_prefix("# ") {
            Some(title) => name = title.trim_end().to_owned(),
            None => tables.entry(name.clone()).or_default().update(line),
        }
    }
    let digest = |hash: Sha256| {
        hash.finalize()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    };
    tables
        .into_iter()
        .map(|(name, hash)| (name, digest(hash)))
        .collect()
}

/// Prints a line per study and gives the number of those that differ.
fn print(answers: &[(&str, BTreeMap<String, String>)]) -> Result<usize> {
    let (first, reference) = answers.first().context("no host ran")?;
    let mut differing = 0;
    for (study, digest) in reference {
        let unlike: Vec<&str> = answers
            .iter()
            .filter(|(_, digests)| digests.get(study) != Some(digest))
            .map(|(host, _)| *host)
            .collect();
        let verdict = match &unlike[..] {
            [] => format!("on all of {} hosts", answers.len()),
            unlike => format!("on {first}, another on: {}", unlike.join(", ")),
        };
        differing += usize::from(!unlike.is_empty());
        println!("{study:28} {digest} {verdict}");
    }
    Ok(differing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_study_has_the_digest_of_its_own_lines() {
        let one = digests("# a\nx\ny\n# b\nz\n");
        assert_eq!(one["b"], digests("# b\nz\n")["b"]);
        assert_ne!(one["a"], digests("# a\nx\n")["a"]);
        // By sha256sum.
        let empty = digests("# c\nabc\n");
        assert_eq!(
            empty["c"],
            "edeaaff3f1774ad2888673770c6d64097e391bc362d7d6fb34982ddf0efd18cb"
        );
    }

    #[test]
    fn exponents_are_constants() {
        let code = "x.powi(2)\n  .powi(-3)\ny.powi(n)\nz.powi(2 * n) + x.powi(4)\nf64::powi(x, 2)";
        assert_eq!(powers(code).collect::<Vec<_>>(), [3, 4, 5]);
    }

    #[test]
    fn a_study_that_differs_or_lacks_is_counted() {
        let [one, other] = ["# a\nx\n# b\ny\n", "# a\nx\n# b\nz\n"].map(digests);
        assert_eq!(print(&[("one", one.clone())]).unwrap(), 0);
        assert_eq!(print(&[("one", one.clone()), ("other", other)]).unwrap(), 1);
        assert_eq!(
            print(&[("one", one), ("none", BTreeMap::new())]).unwrap(),
            2
        );
        assert!(print(&[]).is_err());
    }
}
