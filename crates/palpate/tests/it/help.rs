//! Tests `--help`, `--version`, and arguments that do not exist.

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
        "estimate force",
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
        let (example, _) = printed.split_once("\n\n").unwrap_or_default();
        assert!(
            example.starts_with("Example") && example.contains(&format!("palpate {command}")),
            "{command}: {printed}"
        );
    }
}

#[test]
fn no_command_shows_first_steps() {
    let printed = Desk::new().palpate("").printed();
    assert_eq!(printed.matches("\n  palpate ").count(), 4, "{printed}");
}
