//! Tests long runs under difficult conditions: runs that are killed, runs on a full disk, and runs on a cluster. Each
//! interrupted run is resumed. It must then write the same bytes as a run without interruption.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use xshell::{Shell, TempDir, cmd};

use crate::programs;

#[derive(Args)]
pub(crate) struct Options {
    /// Number of runs of a study that are killed, each at a random time.
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub(crate) kills: u32,
}

/// Files of a run that are compared with those of a run without interruption.
const TABLES: [&str; 3] = ["cells.csv", "failures.csv", "run.toml"];
/// Number of shards into which the study on the cluster is divided.
const SHARDS: u64 = 16;
/// Longest time to wait for a job of the cluster.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let program = programs::build(shell, "palpate")?;
    let bench = TestBench {
        shell,
        program,
        dir: shell.create_temp_dir()?,
    };
    bench.kill(options.kills)?;
    bench.fill_a_disk()?;
    match missing(shell) {
        None => bench.cluster(),
        Some(what) => {
            println!("the cluster is skipped: {what}");
            Ok(())
        }
    }
}

/// Reason why this machine cannot start a local cluster: the first missing requirement. `None` if all requirements are
/// met.
fn missing(shell: &Shell) -> Option<String> {
    // Slurm's daemons are in /usr/sbin, which may not be in PATH. Look for the files instead of running the commands,
    // because the commands fail without a config.
    let places = ["/usr/sbin", "/usr/local/sbin", "/usr/bin", "/usr/local/bin"];
    let is_there = |program: &&str| {
        places
            .iter()
            .any(|place| Path::new(place).join(program).exists())
    };
    let programs = ["slurmctld", "slurmd", "munged", "sbatch"];
    if let Some(program) = programs.iter().find(|program| !is_there(program)) {
        let packages = "slurmctld slurmd slurm-client munge";
        return Some(format!(
            "{program} is missing (Debian: apt-get install {packages})"
        ));
    }
    (!is_root(shell)).then(|| "only root can start it".to_owned())
}

fn is_root(shell: &Shell) -> bool {
    cmd!(shell, "id -u")
        .quiet()
        .read()
        .is_ok_and(|id| id == "0")
}

struct TestBench<'a> {
    shell: &'a Shell,
    program: PathBuf,
    dir: TempDir,
}

impl TestBench<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Writes a config of rolls on balls, with one radius per cell. `trials[0]` is the number of trials of the first
    /// cell, `trials[1]` is the number of trials of each other cell.
    fn config(&self, name: &str, cells: u64, trials: [u64; 2]) -> Result<PathBuf> {
        let rows: Vec<String> = (0..cells)
            .map(|cell| format!("[{}, {}]", 20 + cell, trials[usize::from(cell > 0)]))
            .collect();
        let text = format!(
            "name = \"rolls\"\nlength_unit = \"mm\"\nseed = 1\n\n[scene]\nkind = \"roll\"\n\
             probe = {{ kind = \"sphere\", radius = 10.0 }}\nobject = {{ kind = \"sphere\", radius = 30.0 }}\n\
             motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n\
             noise = {{ angular_velocity = {{ kind = \"uniform\", fraction = 0.05 }} }}\n\n\
             [[sweep]]\npaths = [\"scene.object.radius\", \"trials\"]\nvalues = [{}]\n",
            rows.join(", ")
        );
        let path = self.path(name);
        fs::write(&path, text)?;
        Ok(path)
    }

    fn start(&self, config: &Path, out: &Path) -> Result<Child> {
        let mut command = Command::new(&self.program);
        command.arg("run").arg(config).arg("--out").arg(out);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        child.context("cannot start palpate")
    }

    fn complete(&self, config: &Path, out: &Path) -> Result<()> {
        let status = self.start(config, out)?.wait()?;
        ensure!(
            status.success(),
            "palpate run {}: {status}",
            config.display()
        );
        Ok(())
    }

    fn kill(&self, kills: u32) -> Result<()> {
        // The study has 24 cells. The first cell has many trials, and all other cells have few trials.
        let config = self.config("killed.toml", 24, [2_200_000, 20_000])?;
        let whole = self.path("whole");
        let start = Instant::now();
        self.complete(&config, &whole)?;
        let time = start.elapsed();
        let mut random = fastrand::Rng::with_seed(1);
        for number in 0..kills {
            let share = random.f64();
            let out = self.path("killed");
            let mut child = self.start(&config, &out)?;
            sleep(time.mul_f64(share));
            child.kill()?;
            child.wait()?;
            self.complete(&config, &out)?;
            same(&whole, &out)
                .with_context(|| format!("kill {number}, after {share:.3} of the time"))?;
            fs::remove_dir_all(&out)?;
        }
        println!("{kills} of {kills} random kills resume to the same bytes");
        Ok(())
    }

    /// Runs a study until the disk is full. Then enlarges the disk, and resumes the run of the study.
    fn fill_a_disk(&self) -> Result<()> {
        if !is_root(self.shell) {
            println!("the full disk is skipped: only root can mount one");
            return Ok(());
        }
        let config = self.config("full.toml", 400, [100, 100])?;
        let (whole, disk) = (self.path("roomy"), self.path("disk"));
        self.complete(&config, &whole)?;
        fs::create_dir(&disk)?;
        let shell = self.shell;
        if cmd!(shell, "mount -t tmpfs -o size=128k tmpfs {disk}")
            .quiet()
            .ignore_stderr()
            .run()
            .is_err()
        {
            println!("the full disk is skipped: it cannot be mounted on this machine");
            return Ok(());
        }
        let outcome = self.fill(&config, &whole, &disk);
        cmd!(shell, "umount {disk}").quiet().run()?;
        outcome
    }

    fn fill(&self, config: &Path, whole: &Path, disk: &Path) -> Result<()> {
        let shell = self.shell;
        let out = disk.join("o");
        for (full, size) in ["128k", "600k", "1m", "8m"].into_iter().enumerate() {
            cmd!(shell, "mount -o remount,size={size} {disk}")
                .quiet()
                .run()?;
            if self.start(config, &out)?.wait()?.success() {
                same(whole, &out).context("a run on a disk that was full")?;
                ensure!(full > 0, "the disk was never full");
                println!("a run on a disk that was full {full} times ends with the same bytes");
                return Ok(());
            }
            ensure!(
                !out.join("cells.csv").exists(),
                "a table was written on a full disk"
            );
        }
        bail!("a disk of 8 MB was too small")
    }

    /// Runs a study on several nodes of a cluster. One shard is killed, one shard fails, and one node is shut down.
    fn cluster(&self) -> Result<()> {
        let shell = self.shell;
        let start = Instant::now();
        let lab = self.path("lab");
        let scripts = shell.current_dir().join("xtask/slurm");
        let (up, down) = (scripts.join("up.sh"), scripts.join("down.sh"));
        if let Err(error) = cmd!(shell, "{up} {lab}").quiet().run() {
            // The daemons need their own /etc/hosts, which `unshare --mount` makes. Some machines do not allow this
            // command.
            println!("the cluster is skipped: it does not start on this machine: {error}");
            cmd!(shell, "{down} {lab}")
                .quiet()
                .ignore_stderr()
                .ignore_status()
                .run()?;
            return Ok(());
        }
        let outcome = {
            let _conf = shell.push_env("SLURM_CONF", lab.join("slurm.conf"));
            self.share()
        };
        cmd!(shell, "{down} {lab}")
            .quiet()
            .ignore_stderr()
            .ignore_status()
            .run()?;
        outcome?;
        println!("cluster: ok, {:.1} s", start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share(&self) -> Result<()> {
        let shell = self.shell;
        let config = self.config("shared.toml", 64, [3_000_000, 700_000])?;
        let (whole, out) = (self.path("alone"), self.path("cluster"));
        self.complete(&config, &whole)?;

        // Each job runs the program that submitted it. Submit the jobs with a copy of the program, so that the test can
        // replace the copy by a script that fails.
        let program = self.path("palpate");
        fs::copy(&self.program, &program)?;
        self.hold(true)?;
        let array = self.submit(&program, &config, &out)?;
        self.replace_by_failing(&program, 5)?;
        self.hold(false)?;
        let killed = self.running()?;
        // Ignore an error of `kill`, because the process may already have ended.
        let kill = cmd!(shell, "kill -9 {killed}");
        kill.quiet().ignore_status().ignore_stderr().run()?;
        self.running()?;
        cmd!(shell, "scontrol update NodeName=n2 State=DOWN Reason=test")
            .quiet()
            .run()?;
        sleep(Duration::from_millis(500));
        // Ignore an error of `scontrol`, because the node may already be up again.
        let back = cmd!(shell, "scontrol update NodeName=n2 State=RESUME");
        back.quiet().ignore_status().ignore_stderr().run()?;
        self.wait()?;
        let log = fs::read_to_string(out.join("logs/merge.txt")).unwrap_or_default();
        ensure!(
            log.contains("shard 5 of 16 is missing"),
            "the log of `palpate merge` does not report the missing shard: {log}"
        );
        ensure!(
            !out.join("cells.csv").exists(),
            "a table was written although a shard is missing"
        );
        let job = format!("{array}_5");
        let state = cmd!(shell, "scontrol show job {job}").quiet().read()?;
        ensure!(
            state.contains("JobState=FAILED") && state.contains("ExitCode=3:0"),
            "{state}"
        );
        fs::remove_file(&program)?;
        fs::copy(&self.program, &program)?;
        let status = cmd!(shell, "{program} status {out}").quiet().read()?;
        ensure!(
            status.contains("done     15: ") && status.contains("missing  1: shards 5"),
            "{status}"
        );

        let shards = SHARDS.to_string();
        let script = cmd!(
            shell,
            "{program} submit slurm {config} --out {out} --shards {shards} --dry-run"
        );
        let script = script.quiet().read()?;
        ensure!(script.contains("#SBATCH --array=5\n"), "{script}");
        self.submit(&program, &config, &out)?;
        self.wait()?;
        same(&whole, &out).context("merged shards")?;
        println!(
            "{SHARDS} shards, one killed, one that exits with 3, a node down: the same bytes as one run"
        );
        Ok(())
    }

    /// Submits the shards to the cluster, and returns the number of the job that runs them.
    fn submit(&self, program: &Path, config: &Path, out: &Path) -> Result<String> {
        let (shell, shards) = (self.shell, SHARDS.to_string());
        let said = cmd!(
            shell,
            "{program} submit slurm {config} --out {out} --shards {shards}"
        );
        let said = said.quiet().read()?;
        let mut words = said.split(" as job ").skip(1);
        let job = words.next().and_then(|rest| rest.split(',').next());
        Ok(job.with_context(|| said.clone())?.to_owned())
    }

    /// If `is_held` is true, stops the cluster from starting queued jobs. Otherwise, lets the cluster start queued jobs
    /// again.
    fn hold(&self, is_held: bool) -> Result<()> {
        let state = if is_held { "DOWN" } else { "UP" };
        let shell = self.shell;
        let update = cmd!(shell, "scontrol update PartitionName=main State={state}");
        Ok(update.quiet().run()?)
    }

    /// Replaces the program by a script that runs the original program. For the shard `shard`, the script only ends
    /// with exit status 3.
    fn replace_by_failing(&self, program: &Path, shard: u64) -> Result<()> {
        let real = self.program.display();
        let script = format!(
            "#!/bin/sh\ncase \" $* \" in *\" --shard {shard}/{SHARDS} \"*) exit 3;; esac\nexec '{real}' \"$@\"\n"
        );
        fs::remove_file(program)?;
        fs::write(program, script)?;
        let shell = self.shell;
        Ok(cmd!(shell, "chmod +x {program}").quiet().run()?)
    }

    /// Waits until a shard is running, and returns the process number of its program. The function never finds shard 5,
    /// because the program of shard 5 fails at once.
    fn running(&self) -> Result<String> {
        let shell = self.shell;
        let start = Instant::now();
        // `pgrep` searches command lines for this pattern. The pattern with brackets does not match the command line of
        // `pgrep` itself.
        let words = "[c]luster/run.toml --shard";
        while start.elapsed() < PATIENCE {
            let found = cmd!(shell, "pgrep -n -f {words}");
            let found = found.quiet().ignore_status().ignore_stderr().read()?;
            if !found.is_empty() {
                return Ok(found);
            }
            sleep(Duration::from_millis(20));
        }
        bail!("no shard is running")
    }

    fn wait(&self) -> Result<()> {
        let shell = self.shell;
        let start = Instant::now();
        while !cmd!(shell, "squeue -h").quiet().read()?.is_empty() {
            if start.elapsed() > PATIENCE {
                let queue = cmd!(shell, "squeue").quiet().read()?;
                bail!("the queue is not empty:\n{queue}");
            }
            sleep(Duration::from_millis(200));
        }
        Ok(())
    }
}

fn same(one: &Path, other: &Path) -> Result<()> {
    for name in TABLES {
        let [one, other] = [one, other].map(|dir| fs::read(dir.join(name)));
        ensure!(one? == other?, "{name} differs");
    }
    Ok(())
}
