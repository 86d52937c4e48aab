//! `--help`, `--version` and bad arguments.

use super::desk::Desk;

#[test]
fn every_command_shows_an_example() {
    let commands = [
        "",
        "run",
        "trace",
        "estimate",
        "estimate roll",
        "estimate glide",
        "estimate press",
        "sensor",
        "sensor pattern",
        "sensor calibrate",
        "sensor track",
        "check",
        "plot",
        "report",
        "schema",
        "explain",
    ];
    for command in commands {
        let printed = Desk::new().palpate(&format!("{command} --help")).printed();
        let example = printed.split("Example").nth(1).unwrap_or_default();
        assert!(
            example.contains(&format!("palpate {command}")),
            "{command}: {printed}"
        );
    }
}

#[test]
fn the_version_is_printed() {
    let printed = Desk::new().palpate("--version").printed();
    assert_eq!(
        printed,
        concat!("palpate ", env!("CARGO_PKG_VERSION"), "\n")
    );
}

#[test]
fn bad_arguments_are_refused() {
    for (arguments, word) in [
        ("walk c.toml", "walk"),
        ("run", "<CONFIG>"),
        ("run c.toml --trials 0", "--trials"),
        ("run c.toml --trials many", "--trials"),
        ("run c.toml --threads 0", "--threads"),
        ("run c.toml --threads -1", "-1"),
        ("run c.toml --seed 0.5", "--seed"),
        ("run c.toml --every-nth-cell 0", "--every-nth-cell"),
        ("trace c.toml", "--out"),
        ("trace c.toml --out o --cell x", "--cell"),
        ("report", "<DIRS>"),
    ] {
        let said = Desk::new().palpate(arguments).said(2);
        assert!(said.contains(word), "{arguments}: {said}");
    }
}
