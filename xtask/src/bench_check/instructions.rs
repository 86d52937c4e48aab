//! Instructions of the hot paths: the bench `instructions` of palpate-assay, by gungraun under callgrind.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use xshell::{Shell, cmd};

use super::baseline::Figures;
use crate::palpate::{RELEASED, target_dir};
use crate::tools::has;

/// Counts every hot path, or says what is missing on this machine.
pub(crate) fn count(shell: &Shell) -> Result<Result<Figures, &'static str>> {
    if !has(shell, "valgrind") {
        return Ok(Err("valgrind is missing"));
    }
    if !has(shell, "gungraun-runner") {
        return Ok(Err(
            "gungraun-runner is missing: `cargo install gungraun-runner --version 0.20.0 --locked`",
        ));
    }
    let home = target_dir(shell).join("gungraun");
    let bench = cmd!(
        shell,
        "cargo bench {RELEASED...} --bench instructions -- --output-format=json"
    );
    let lines = bench.quiet().env("GUNGRAUN_HOME", home).read()?;
    read(&lines).map(Ok)
}

/// Reads counts from lines of JSON, one summary per line.
fn read(lines: &str) -> Result<Figures> {
    let mut counts = Figures::default();
    for line in lines.lines().filter(|line| line.starts_with('{')) {
        let summary: Value = serde_json::from_str(line)?;
        let name = ["function_name", "id"].map(|key| summary[key].as_str().unwrap_or_default());
        let [function, id] = name;
        let count =
            instructions(&summary).with_context(|| format!("no count of {function} {id}"))?;
        ensure!(
            count > 0,
            "{function} {id} runs no instruction: is its entry point inlined?"
        );
        counts.add(
            &format!("{function}, {}", id.replace('_', " ")),
            count as f64,
        )?;
    }
    Ok(counts)
}

fn instructions(summary: &Value) -> Option<u64> {
    let callgrind = summary["profiles"]
        .as_array()?
        .iter()
        .find(|profile| profile["tool"] == "Callgrind")?;
    callgrind["data"]["total"]["metrics"]["Ir"]["values"]["new"].as_u64()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(id: &str, values: &str) -> String {
        format!(
            "{{\"function_name\": \"rolling\", \"id\": \"{id}\", \"profiles\": [{{\"tool\": \"Callgrind\", \
             \"data\": {{\"total\": {{\"metrics\": {{\"Ir\": {{\"values\": {values}}}}}}}}}}}]}}\n"
        )
    }

    #[test]
    fn counts_are_those_of_this_run() {
        let lines = summary("closed_form", "{\"new\": 1140}")
            + "a line that is no summary\n"
            + &summary("meridian", "{\"new\": 7, \"old\": 9}");
        let table = read(&lines).unwrap().to_csv("instructions").unwrap();
        assert_eq!(
            table,
            "name,instructions\n\"rolling, closed form\",1140\n\"rolling, meridian\",7\n"
        );
    }

    #[test]
    fn a_path_that_is_not_counted_is_an_error() {
        assert!(read(&summary("closed_form", "{\"old\": 1140}")).is_err());
        assert!(read(&summary("closed_form", "{\"new\": 0}")).is_err());
    }
}
