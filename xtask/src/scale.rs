//! Runs that are killed, that fill a disk, and that a cluster shares: each must end with the bytes of an undisturbed run.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use xshell::{Shell, TempDir, cmd};

use crate::palpate;

/// Settings of the task.
#[derive(Args)]
pub(crate) struct Options {
    /// Kill so many runs, each at a random moment.
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub(crate) kills: u32,
}

/// Tables that are compared.
const TABLES: [&str; 3] = ["cells.csv", "failures.csv", "run.toml"];
/// Number of shards on the cluster.
const SHARDS: u64 = 16;
/// Longest time that the cluster may take for a submission.
const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let program = palpate::build(shell, "palpate")?;
    let desk = Desk {
        shell,
        program,
        dir: shell.create_temp_dir()?,
    };
    desk.kill(options.kills)?;
    desk.fill_a_disk()?;
    match missing(shell) {
        None => desk.cluster(),
        Some(what) => {
            println!("no cluster is tried: {what}");
            Ok(())
        }
    }
}

/// Lack of this machine that keeps a cluster from being tried, if there is one.
fn missing(shell: &Shell) -> Option<String> {
    // Daemons stand where root alone looks, and no command of Slurm runs without a config.
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
    (!is_root(shell)).then(|| "it takes root to start one".to_owned())
}

fn is_root(shell: &Shell) -> bool {
    cmd!(shell, "id -u")
        .quiet()
        .read()
        .is_ok_and(|id| id == "0")
}

/// Directory with configs, and the program that is tried there.
struct Desk<'a> {
    shell: &'a Shell,
    program: PathBuf,
    dir: TempDir,
}

impl Desk<'_> {
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Writes a config of rolls on balls of these many radii, the first with so many trials more.
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

    fn begun(&self, config: &Path, out: &Path) -> Result<Child> {
        let mut command = Command::new(&self.program);
        command.arg("run").arg(config).arg("--out").arg(out);
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        child.context("palpate does not start")
    }

    /// Runs a study to its end.
    fn ended(&self, config: &Path, out: &Path) -> Result<()> {
        let status = self.begun(config, out)?.wait()?;
        ensure!(
            status.success(),
            "palpate run {}: {status}",
            config.display()
        );
        Ok(())
    }

    /// Kills runs at random moments, and resumes them.
    fn kill(&self, kills: u32) -> Result<()> {
        // A heavy cell, and some light ones.
        let config = self.config("killed.toml", 24, [2_200_000, 20_000])?;
        let whole = self.path("whole");
        let start = Instant::now();
        self.ended(&config, &whole)?;
        let time = start.elapsed();
        let mut random = fastrand::Rng::with_seed(1);
        for number in 0..kills {
            let share = random.f64();
            let out = self.path("killed");
            let mut child = self.begun(&config, &out)?;
            sleep(time.mul_f64(share));
            child.kill()?;
            child.wait()?;
            self.ended(&config, &out)?;
            same(&whole, &out)
                .with_context(|| format!("kill {number}, after {share:.3} of the time"))?;
            fs::remove_dir_all(&out)?;
        }
        println!("{kills} of {kills} random kills resume to the same bytes");
        Ok(())
    }

    /// Fills a disk, makes room and goes on.
    fn fill_a_disk(&self) -> Result<()> {
        if !is_root(self.shell) {
            println!("no disk is filled: it takes root to mount one");
            return Ok(());
        }
        let config = self.config("full.toml", 400, [100, 100])?;
        let (whole, disk) = (self.path("roomy"), self.path("disk"));
        self.ended(&config, &whole)?;
        fs::create_dir(&disk)?;
        let shell = self.shell;
        if cmd!(shell, "mount -t tmpfs -o size=128k tmpfs {disk}")
            .quiet()
            .ignore_stderr()
            .run()
            .is_err()
        {
            println!("no disk is filled: none can be mounted here");
            return Ok(());
        }
        let tried = self.fill(&config, &whole, &disk);
        cmd!(shell, "umount {disk}").quiet().run()?;
        tried
    }

    fn fill(&self, config: &Path, whole: &Path, disk: &Path) -> Result<()> {
        let shell = self.shell;
        let out = disk.join("o");
        for (full, size) in ["128k", "600k", "1m", "8m"].into_iter().enumerate() {
            cmd!(shell, "mount -o remount,size={size} {disk}")
                .quiet()
                .run()?;
            if self.begun(config, &out)?.wait()?.success() {
                same(whole, &out).context("a run on a disk that was full")?;
                ensure!(full > 0, "the disk was never full");
                println!("a run that found the disk full {full} times ends with the same bytes");
                return Ok(());
            }
            ensure!(
                !out.join("cells.csv").exists(),
                "a table was written on a full disk"
            );
        }
        bail!("a disk of 8 MB was too small")
    }

    /// Shares a study among the nodes of a cluster, with all that can go wrong there.
    fn cluster(&self) -> Result<()> {
        let shell = self.shell;
        let start = Instant::now();
        let lab = self.path("lab");
        let scripts = shell.current_dir().join("xtask/slurm");
        let (up, down) = (scripts.join("up.sh"), scripts.join("down.sh"));
        if let Err(error) = cmd!(shell, "{up} {lab}").quiet().run() {
            // Not every machine lets daemons bind to names of their own.
            println!("no cluster is tried: it does not start here: {error}");
            cmd!(shell, "{down} {lab}")
                .quiet()
                .ignore_stderr()
                .ignore_status()
                .run()?;
            return Ok(());
        }
        let tried = {
            let _conf = shell.push_env("SLURM_CONF", lab.join("slurm.conf"));
            self.share()
        };
        cmd!(shell, "{down} {lab}")
            .quiet()
            .ignore_stderr()
            .ignore_status()
            .run()?;
        tried?;
        println!("cluster: ok, {:.1} s", start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share(&self) -> Result<()> {
        let shell = self.shell;
        let config = self.config("shared.toml", 64, [3_000_000, 700_000])?;
        let (whole, out) = (self.path("alone"), self.path("cluster"));
        self.ended(&config, &whole)?;

        // Scripts run the program that submits them: a copy, in whose place another stands until all shards have ended.
        let program = self.path("palpate");
        fs::copy(&self.program, &program)?;
        self.hold(true)?;
        let array = self.submit(&program, &config, &out)?;
        self.replace_by_failing(&program, 5)?;
        self.hold(false)?;
        let killed = self.running()?;
        // It may have ended by now.
        let kill = cmd!(shell, "kill -9 {killed}");
        kill.quiet().ignore_status().ignore_stderr().run()?;
        self.running()?;
        cmd!(shell, "scontrol update NodeName=n2 State=DOWN Reason=test")
            .quiet()
            .run()?;
        sleep(Duration::from_millis(500));
        // Unless it has come back by itself.
        let back = cmd!(shell, "scontrol update NodeName=n2 State=RESUME");
        back.quiet().ignore_status().ignore_stderr().run()?;
        self.wait()?;
        let said = fs::read_to_string(out.join("logs/merge.txt")).unwrap_or_default();
        ensure!(
            said.contains("shard 5 of 16 is missing"),
            "the merge said: {said}"
        );
        ensure!(!out.join("cells.csv").exists(), "a table lacks a shard");
        let job = format!("{array}_5");
        let state = cmd!(shell, "scontrol show job {job}").quiet().read()?;
        ensure!(
            state.contains("JobState=FAILED") && state.contains("ExitCode=3:0"),
            "{state}"
        );
        fs::remove_file(&program)?;
        fs::copy(&self.program, &program)?;
        let told = cmd!(shell, "{program} status {out}").quiet().read()?;
        ensure!(
            told.contains("done     15: ") && told.contains("missing  1: shards 5"),
            "{told}"
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
        same(&whole, &out).context("shards put together")?;
        println!(
            "{SHARDS} shards, one killed, one that exits 3, a node down: the bytes of one run"
        );
        Ok(())
    }

    /// Submits the shards, and gives the number of their job.
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

    /// Keeps jobs from being started, or lets them start.
    fn hold(&self, is_held: bool) -> Result<()> {
        let state = if is_held { "DOWN" } else { "UP" };
        let shell = self.shell;
        let update = cmd!(shell, "scontrol update PartitionName=main State={state}");
        Ok(update.quiet().run()?)
    }

    /// Puts a program in place of another that does the same, but exits with 3 where it is to run one of the shards.
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

    /// Process of a shard; that of shard 5 ends at once.
    fn running(&self) -> Result<String> {
        let shell = self.shell;
        let start = Instant::now();
        // The brackets keep the search from finding itself.
        let words = "[c]luster/run.toml --shard";
        while start.elapsed() < PATIENCE {
            let found = cmd!(shell, "pgrep -n -f {words}");
            let found = found.quiet().ignore_status().ignore_stderr().read()?;
            if !found.is_empty() {
                return Ok(found);
            }
            sleep(Duration::from_millis(20));
        }
        bail!("no shard runs")
    }

    /// Waits until the queue is empty.
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

/// Compares the tables of two runs.
fn same(one: &Path, other: &Path) -> Result<()> {
    for name in TABLES {
        let [one, other] = [one, other].map(|dir| fs::read(dir.join(name)));
        ensure!(one? == other?, "{name} differs");
    }
    Ok(())
}
