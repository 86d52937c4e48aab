//! Implements the command `palpate submit slurm`.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, anyhow};
use palpate::{check_outputs, resolved};

use crate::cli::SlurmArgs;
use crate::failure::Failure;
use crate::merge::shards_of;
use crate::output::names::{CONFIG, text_of};
use crate::output::{self, Contents, Format, Guard, LockedDir, StudyId};
use crate::run::{difference, overridden};

/// File name of the script that runs the shards. The next constants are the names of the script that merges the shards,
/// of the file with the submitted job numbers, and of the folders for shards and logs.
const SHARDS_SCRIPT: &str = "shards.sbatch";
const MERGE_SCRIPT: &str = "merge.sbatch";
const JOBS: &str = "jobs.txt";
const SHARDS: &str = "shards";
const LOGS: &str = "logs";

/// Largest time limit (minutes) of a job that gets no signal before its end. Longer jobs get a signal one minute before
/// their end. For a short job, one minute would be a large part of its time.
const SHORT_MIN: u64 = 3;

pub(crate) fn slurm(args: &SlurmArgs) -> Result<(), Failure> {
    args.format.supported()?;
    let study = overridden(&args.config, args.seed, args.trials, None)?;
    check_outputs(&study).map_err(Failure::usage)?;
    let name = &study.config.name;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(name));
    let out = std::path::absolute(&out).map_err(Failure::work)?;
    if let Some(bad) = out
        .to_string_lossy()
        .chars()
        .find(|c| c.is_control() || *c == '%')
    {
        return Err(Failure::usage(anyhow!(
            "--out {}: Slurm interprets {bad:?} in a path; choose another directory",
            out.display()
        )));
    }
    let config = resolved(&study);
    let left = left(&out, args.shards.get(), &config)?;
    if left.is_empty() {
        return output::print(&format!(
            "{name}: all {} shards are done; palpate merge {}",
            args.shards,
            out.display()
        ));
    }
    let program = std::env::current_exe().map_err(Failure::work)?;
    let shards = shards_script(args, name, &out, &program, &left);
    let merge = merge_script(args, name, &out, &program);
    if args.dry_run {
        return output::print(&format!(
            "# {}\n{shards}\n# {}\n{merge}",
            out.join(SHARDS_SCRIPT).display(),
            out.join(MERGE_SCRIPT).display()
        ));
    }
    refuse_long_array(args.shards.get())?;
    refuse_queued(&out)?;
    let mut folder = LockedDir::open(&out, Guard::new([&args.config], args.force))?;
    let of_study = StudyId::new(name, &config);
    folder
        .output()
        .refuse(CONFIG, Some(&Contents::Bytes(config.as_bytes())))?;
    let files = [
        (CONFIG, config.as_str()),
        (SHARDS_SCRIPT, shards.as_str()),
        (MERGE_SCRIPT, merge.as_str()),
    ];
    folder.write(&files, Some(&of_study))?;
    fs::create_dir_all(out.join(LOGS)).map_err(Failure::work)?;
    let array = sbatch(&[&format!("{}", out.join(SHARDS_SCRIPT).display())])?;
    // The merge also runs if a shard fails, because it then reports the missing shards.
    let after = format!("--dependency=afterany:{array}");
    let merging = sbatch(&[&after, &format!("{}", out.join(MERGE_SCRIPT).display())])?;
    let jobs = format!(
        "# Jobs of the last submission: of the shards, of the merge.\n{array}\n{merging}\n"
    );
    folder.write(&[(JOBS, jobs.as_str())], Some(&of_study))?;
    let (shown, left) = (out.display(), left.len());
    output::print(&format!(
        "{name}: {left} of {} shards as job {array}, then the merge as job {merging} -> {shown}\n\
         palpate status {shown}",
        args.shards,
    ))
}

/// Numbers of the shards that are not finished yet. Returns an error if the directory contains shards of another run.
fn left(out: &Path, of: u64, config: &str) -> Result<Vec<u64>, Failure> {
    let place = out.join(SHARDS);
    let known = match place.is_dir() {
        true => shards_of(&[place])?.sound()?,
        false => Default::default(),
    };
    for (dir, found) in known.values() {
        let header = &found.header;
        let known = header.request.shard.map_or(1, |(_, of)| of);
        let why = if known != of {
            format!("is one of {known} shards, not {of}")
        } else if header.request.config != config {
            format!(
                "belongs to another config:{}",
                difference(&header.request.config, config)
            )
        } else {
            continue;
        };
        return Err(Failure::usage(anyhow!(
            "{} {why}\nchoose another --out, or move it away",
            dir.display()
        )));
    }
    let is_done = |number: &u64| {
        known
            .get(number)
            .is_some_and(|(_, found)| found.is_ended && !found.is_torn)
    };
    Ok((1..=of).filter(|number| !is_done(number)).collect())
}

/// Numbers in the format of Slurm's job arrays, which writes consecutive numbers as a range: `1-3,5`.
fn ranges(numbers: &[u64]) -> String {
    let runs = numbers.chunk_by(|one, next| one + 1 == *next);
    let runs: Vec<String> = runs
        .map(|run| match run {
            [one] => one.to_string(),
            run => format!("{}-{}", run[0], run[run.len() - 1]),
        })
        .collect();
    runs.join(",")
}

fn directives(args: &SlurmArgs) -> String {
    let mut lines = String::new();
    let given = [("partition", &args.partition), ("account", &args.account)];
    for (key, value) in given {
        if let Some(value) = value {
            lines += &format!("#SBATCH --{key}={value}\n");
        }
    }
    lines
}

fn shards_script(args: &SlurmArgs, name: &str, out: &Path, program: &Path, left: &[u64]) -> String {
    let quoted = |path: &Path| quoted(&path.display().to_string());
    let time = args.time.as_ref().map_or(String::new(), |time| {
        // Slurm sends a signal to a shard one minute before the time limit. The shard then stops, and Slurm queues it
        // again.
        let signal = match time.minutes > SHORT_MIN {
            true => "#SBATCH --signal=B:USR1@60\n",
            false => "",
        };
        format!("#SBATCH --time={}\n{signal}", time.text)
    });
    let memory = args
        .mem
        .as_ref()
        .map_or(String::new(), |mem| format!("#SBATCH --mem={mem}\n"));
    format!(
        "#!/bin/bash\n\
         #SBATCH --job-name={name}\n\
         #SBATCH --array={}\n\
         #SBATCH --cpus-per-task={}\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={}/%a.txt\n\
         {}{time}{memory}\n\
         # One shard of {} per element. A shard that is run again resumes after the last cell in its journal.\n\
         shard=$SLURM_ARRAY_TASK_ID\n\
         threads=${{SLURM_CPUS_PER_TASK:-${{SLURM_CPUS_ON_NODE:-1}}}}\n\
         {} run {} --shard \"$shard/{}\" --out {}/\"$shard\" --threads \"$threads\" &\n\
         run=$!\n\
         cancelled= late=\n\
         trap 'cancelled=1; kill -TERM $run' TERM\n\
         trap 'late=1; kill -TERM $run' USR1\n\
         wait $run; status=$?\n\
         # A trap ends the first wait.\n\
         while kill -0 $run 2>/dev/null; do wait $run; status=$?; done\n\
         \n\
         # Slurm requeues after the failure of a node; after death by a signal, and when the time is up, this does,\n\
         # at most {} times in all.\n\
         if [ -z \"$cancelled\" ] && {{ [ -n \"$late\" ] || [ $status -gt 128 ]; }} &&\n\
         \x20  [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {} ]; then\n\
         \x20 scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_$shard\" && exit 0\n\
         fi\n\
         exit $status\n",
        ranges(left),
        args.cpus_per_task,
        out.join(LOGS).display(),
        directives(args),
        args.shards,
        quoted(program),
        quoted(&out.join(CONFIG)),
        args.shards,
        quoted(&out.join(SHARDS)),
        args.max_restarts,
        args.max_restarts,
    )
}

fn merge_script(args: &SlurmArgs, name: &str, out: &Path, program: &Path) -> String {
    let quoted = |path: &Path| quoted(&path.display().to_string());
    format!(
        "#!/bin/bash\n\
         #SBATCH --job-name={name}-merge\n\
         #SBATCH --output={}/merge.txt\n\
         {}\n\
         # Lists the missing shards, and fails if any is missing.\n\
         exec {} merge {} --out {}{}\n",
        out.join(LOGS).display(),
        directives(args),
        quoted(program),
        quoted(&out.join(SHARDS)),
        quoted(out),
        match args.format {
            Format::Csv => "",
            Format::Parquet => " --format parquet",
        },
    )
}

/// A word of a shell script, in quotation marks if necessary.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:@".contains(c);
    match word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// Rejects a number of shards above the cluster's limit for job arrays. If the cluster states no limit, any number
/// passes.
fn refuse_long_array(shards: u64) -> Result<(), Failure> {
    let config = Command::new("scontrol").args(["show", "config"]).output();
    let text = config.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let most = text.ok().and_then(|text| {
        let line = text
            .lines()
            .find(|line| line.starts_with("MaxArraySize"))?
            .to_owned();
        line.split('=').nth(1)?.trim().parse::<u64>().ok()
    });
    match most {
        Some(most) if shards >= most => Err(Failure::usage(anyhow!(
            "--shards {shards}: this cluster accepts array indices up to {} (MaxArraySize is \
             {most})",
            most - 1
        ))),
        _ => Ok(()),
    }
}

/// Rejects a new submission while a job of the last submission waits or runs.
fn refuse_queued(out: &Path) -> Result<(), Failure> {
    let jobs = text_of(&out.join(JOBS)).unwrap_or_default();
    let is_number =
        |line: &&str| !line.is_empty() && line.bytes().all(|byte| byte.is_ascii_digit());
    for job in jobs.lines().filter(is_number) {
        let queue = Command::new("squeue").args(["-h", "-j", job]).output();
        // `squeue` fails for a job that ended long ago, because Slurm no longer lists it.
        if queue.is_ok_and(|queue| queue.status.success() && !queue.stdout.is_empty()) {
            return Err(Failure::work(anyhow!(
                "job {job} of the last submission has not ended: wait for it, or `scancel {job}`"
            )));
        }
    }
    Ok(())
}

fn sbatch(arguments: &[&str]) -> Result<String, Failure> {
    let output = Command::new("sbatch")
        .arg("--parsable")
        .args(arguments)
        .output();
    let output = output.map_err(|error| match error.kind() {
        ErrorKind::NotFound => Failure::work(anyhow!(
            "there is no `sbatch` on the PATH: submit from a login node of the cluster, or look at the scripts with --dry-run"
        )),
        _ => Failure::work(error),
    })?;
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    if !output.status.success() {
        return Err(Failure::work(anyhow!(
            "sbatch {}: {said}",
            arguments.join(" ")
        )));
    }
    let job = String::from_utf8(output.stdout)
        .context("sbatch")
        .map_err(Failure::work)?;
    // If Slurm manages several clusters, it prints the number of the job followed by the name of the cluster.
    Ok(job.trim().split(';').next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_numbers_are_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 5, 7, 8]), "1-3,5,7-8");
        assert_eq!(ranges(&[16]), "16");
    }

    #[test]
    fn words_with_spaces_and_quotes_are_quoted() {
        assert_eq!(quoted("/a/b-c_1.toml"), "/a/b-c_1.toml");
        assert_eq!(quoted("/a b/it's"), r"'/a b/it'\''s'");
    }
}
