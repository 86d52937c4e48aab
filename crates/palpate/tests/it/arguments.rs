//! Tests arguments that are rejected before any work: the status is 2, the message names the argument, and no file is
//! written.

use serde_json::Value;

use super::desk::{Desk, STUDY, edited};
use super::readings::{GLIDE, PRESS, ROLL};

const COMMANDS: &str = "
estimate walk r.csv | walk
run c.toml --trials many | --trials
run c.toml --budget 1e400s | --budget
run c.toml --budget 1e-6s | one trial of each cell does not fit into 1e-6 s; it needs about
run c.toml --budget 1h30m | --budget
run c.toml --target-error 1e-6 | in cell 0: scene.object.radius = 50
run c.toml --target-error 1e-6 | the maximum of 1e8
trace c.toml --out o --cell 2 | --cell is 2; the study has cells 0 to 1
sensor track a.png --out o | <PRESSED>
sensor calibrate a.csv --out . | --out
";

const SHARDS: &str = "
run c.toml --shard=0/4 | counted from 1
run c.toml --shard=5/4 | there is no shard 5 of 4
run c.toml --shard=1/0 | there is no shard 1 of 0
run c.toml --shard=a/b | written 1/4
run c.toml --shard=1/99999999 | at most 1000000
run c.toml --shard 1/2 --budget 10s | --budget depends on the machine
submit slurm c.toml --dry-run --shards 0 | must be a whole number from 1 to 1000000
submit slurm c.toml --dry-run --shards 4 --time foo | is not a time in Slurm's format
submit slurm c.toml --dry-run --shards 4 --time 0 | must be at least a minute
submit slurm c.toml --dry-run --shards 4 --mem 2X | is not a size in Slurm's format
submit slurm c.toml --dry-run --shards 4 --partition a;b | may have letters
";

const ROLLS: &str = "
| --probe-radius
--probe-radius 10 --method magic | 'magic'
--probe-radius 10 --length-unit ft | one of m, cm, mm, um, unit
--probe-radius 10 --columns shift_u | no pair of names
--probe-radius 10 --columns shift_u=a,shift_u=b | is given twice
--probe-radius 10 --delimiter dot | comma, semicolon, tab, pipe or space
--probe-radius 10 --decimal dot | point or comma
--probe-radius 10 --pitch 11 | at most the probe's radius, 10
--probe-radius 10 --pitch 1e-15 | at least 1e-15 of the probe's radius
--probe-radius 10 --shift-std 1e300 | at most the probe's radius, 10
--probe-radius 10 --rotation-std-rad 500 | from 0 to 3.14
--probe-radius 10 --relative-rotation-std 1e300 | from 0 to 1
--like glide.toml | scene.kind: must be \"roll\"
--like c.toml --cell 2 | --cell is 2; the study has cells 0 to 1
--like none.toml | no such file
--cell 1 | --like
--like c.toml --pitch 1 --shift-std 1 | --shift-std
";

const GLIDES: &str = "
--outward 0,0 | 3 numbers, X,Y,Z; has 2
--outward a,b,c | `a` is not a number
--outward 0,0,1 | only with readings without normals
--gaussian-threshold 0.1 | --mean-threshold
--gaussian-threshold 0.1 --mean-threshold 1 | below the square of the mean threshold 1
--gaussian-threshold -1 --mean-threshold 0 | finite and >= 0
--position-std 0 | finite and > 0
--position-fraction-of-ifd 0 | finite and > 0
--normal-std-deg 500 | <= 90
--method two-pass --position-std 1 | --method penalised or quadric
--inter-finger-distance 2 | --method two-pass or --position-fraction-of-ifd
--position-std 0.1 --position-fraction-of-ifd 0.01 | cannot be combined with --position-std
--reports centre | give --tip-radius too
--tip-radius -1 | --tip-radius
--tip-radius 4 --reports centre --outward 0,0,1 | --outward
";

const PRESSES: &str = "
| --sensor-radius
--sensor-radius 20 --depth 20 | less than --sensor-radius, 20
--sensor-radius 20 --poisson 0.6 | from 0 to 0.5
--sensor-radius 20 --gain-std 1e300 | from 0 to 1e100
--sensor-radius 20 --radial-scale 0 | finite and > 0
--sensor-radius 20 --baseline free | free
--sensor-radius 20 --indentation-std 0.02 | a given --indentation
--sensor-radius 20 --indentation 20 | less than --sensor-radius, 20
--sensor-radius 20 --thickness 5 | only with --method bonded-layer
--sensor-radius 20 --method bonded-layer | --thickness is missing, but --method bonded-layer requires it
--sensor-radius 20 --method bonded-layer --thickness 1 --depth 2 | --depth is 2; it must be at most --thickness, 1
--sensor-radius 20 --method bonded-layer --thickness 21 | at most --sensor-radius, 20
--sensor-radius 20 --method bonded-layer --thickness 5 --indentation 6 | less than --thickness, 5
--sensor-radius 20 --method bonded-layer --thickness 5 --poisson 0.4 | only with --method half-space
--sensor-radius 20 --c 1 | only with --method gaussian
--sensor-radius 20 --window 5 | only with --method gaussian
--sensor-radius 20 --method gaussian --c 1 --gain-std 0.1 | --method half-space or bonded-layer
--sensor-radius 20 --method gaussian | --c is missing, but --method gaussian requires it, or --indentation
--like camera.toml | requires frames
";

const CALIBRATIONS: &str = "
a.png b.png | --normal
a.png b.csv --normal 1 | not both
a.png b.png --normal 1,2 | 1 pressed frames
a.png b.png --normal 1,x | x
a.png b.png --normal 1 --columns series=a | --columns
a.csv --from hues | hues
a.csv --px-per-rad 100 | --px-per-rad
--rest r.png | --layout
--layout camera.toml | --rest
a.csv --cell 1 | --layout
a.csv --rest r.png --layout camera.toml | --rest
";

const TRACKS: &str = "
--indentation 1 | --calibration
--method gaussian | --calibration
--thickness 5 | --thickness needs --calibration FILE
--calibration k.toml | --sensor-radius
--calibration k.toml --sensor-radius 2 --depth 3 | --depth
--calibration k.toml --sensor-radius 2 --depth 1 --grid 0 | --grid
--calibration k.toml --sensor-radius 2 --depth 1 --method bonded-layer | --thickness
--like camera.toml --method bonded-layer | --like needs --calibration FILE
--method image | --like is missing, but --method image requires it
--like direct.toml --method image | scene.sensor: must have a camera
--like plain.toml --method image | `discs` is missing
--like camera.toml --sensor-radius 20 | --sensor-radius has no effect
--like camera.toml --normal-std 0.1 | --normal-std has no effect
--like camera.toml --px-per-rad 176 | --px-per-rad has no effect
--like camera.toml --baseline fitted | --baseline
--like camera.toml --indentation-std 0.1 | a given --indentation
--like camera.toml --indentation 6 | less than --thickness, 5
--like camera.toml --thickness 1 | at most --thickness, 1
--like camera.toml --cell 1 | --cell is 1; the study has cells 0 to 0
";

#[test]
fn arguments_are_refused_by_name() {
    let desk = Desk::with(STUDY);
    let camera = super::camera_press::PRESS;
    let direct = edited(
        camera,
        "noise = { pixel = { kind = \"gaussian\", std = 2.0 } }\n",
        "",
    );
    let direct = edited(&direct, "kind = \"image\"", "kind = \"half-space\"");
    let (from, to) = (
        direct.find("sensor = ").unwrap(),
        direct.find("estimator = ").unwrap(),
    );
    let discs = camera.find(", discs = ").unwrap();
    let plain = camera.split_at(discs).1.split(" }").next().unwrap();
    desk.write("plain.toml", edited(camera, &format!("{plain} }}"), ""));
    desk.write("camera.toml", camera);
    desk.write("direct.toml", direct.replace(&direct[from..to], ""));
    desk.write("glide.toml", super::glide::GLIDE);
    desk.write("r.csv", ROLL);
    desk.write("g.csv", GLIDE);
    desk.write("p.csv", PRESS);
    for name in ["a.png", "b.png", "r.png", "a.csv", "b.csv"] {
        desk.write(name, "");
    }
    for (command, table) in [
        ("", COMMANDS),
        ("", SHARDS),
        ("estimate roll r.csv", ROLLS),
        ("estimate glide g.csv", GLIDES),
        ("estimate press p.csv", PRESSES),
        ("sensor calibrate --out o.toml", CALIBRATIONS),
        ("sensor track a.png b.png --out o", TRACKS),
    ] {
        desk.refuses(command, table);
    }
    // Write tables of readings without the optional columns.
    let columns = |csv: &str, count: usize| -> String {
        let row = |line: &str| line.split(',').take(count).collect::<Vec<_>>().join(",") + "\n";
        csv.lines().map(row).collect()
    };
    desk.write("g.csv", columns(GLIDE, 4));
    desk.write("p.csv", columns(PRESS, 3));
    desk.palpate("estimate glide g.csv --normal-std-deg 1")
        .fails(2, "readings with normals");
    desk.palpate("estimate press p.csv --sensor-radius 20 --tangential-std 0.1")
        .fails(2, "tangential displacements");
}

/// Flags of a command whose value is a number, as its `--help` shows.
fn numeric_flags(command: &str) -> Vec<String> {
    const NUMBERS: &str = "R P S F N T D D,D,... Z E X I LENGTH X,Y,Z";
    let help = Desk::new().palpate(&format!("{command} --help")).printed();
    let flag = |line: &str| {
        let (flag, rest) = line.trim().strip_prefix("--")?.split_once(" <")?;
        let name = rest.split('>').next()?;
        NUMBERS
            .split(' ')
            .any(|number| number == name)
            .then(|| flag.to_owned())
    };
    help.lines().filter_map(flag).collect()
}

/// Other options that a flag needs. Without them, the flag would have no effect, so it is rejected.
fn needed(flag: &str) -> &'static str {
    match flag {
        "indentation-std" => "--indentation 1.5",
        "thickness" => "--method bonded-layer",
        "c" | "window" => "--method gaussian --indentation 1.5 --indentation-std 0.02",
        "gaussian-threshold" => "--mean-threshold 1",
        "mean-threshold" => "--gaussian-threshold 1",
        "smoothing"
        | "second-smoothing"
        | "first-degree"
        | "second-degree"
        | "passes"
        | "tangent-step"
        | "weight"
        | "inter-finger-distance" => "--method two-pass",
        _ => "",
    }
}

/// Whether a JSON value contains a standard error of 0.
fn claims_exactness(json: &Value) -> bool {
    match json {
        Value::Object(table) => {
            let std = table.get("std").and_then(Value::as_f64);
            std == Some(0.0) || table.values().any(claims_exactness)
        }
        Value::Array(items) => items.iter().any(claims_exactness),
        _ => false,
    }
}

const LOAD: &str = "indentation_mm,force_N\n1,1.1\n2,2.7\n3,5.2\n4,8.1\n";

/// Every flag rejects NaN, infinity and negative numbers; only the radius of a sensor may be infinite. With the value
/// 1e300, no standard error in the output is 0.
#[test]
fn every_number_has_bounds() {
    let mut flags = 0;
    for (readings, command, known) in [
        (ROLL, "estimate roll", "r.csv --probe-radius 10"),
        (GLIDE, "estimate glide", "r.csv --map m.csv"),
        (
            PRESS,
            "estimate press",
            "r.csv --sensor-radius 20 --depth 2",
        ),
        (LOAD, "estimate force", "r.csv --modulus-kpa 500"),
        ("", "sensor track", "a.png b.png --out o"),
        ("", "sensor calibrate", "a.png b.png --out c.toml"),
    ] {
        let desk = Desk::new();
        desk.write("r.csv", readings);
        for flag in numeric_flags(command) {
            flags += 1;
            // Only the radius of a sensor may be infinite: the sensor is then a flat pad.
            let may_be_infinite = flag == "sensor-radius";
            for value in ["nan", "inf", "-1"] {
                if value == "inf" && may_be_infinite {
                    continue;
                }
                let said = desk.palpate(&format!("{command} --{flag} {value}")).said(2);
                let is_named = said.contains(&format!("'{value}' for '--{flag} <"))
                    || said.contains("unexpected argument '-1' found");
                assert!(is_named, "{command} --{flag} {value}: {said}");
            }
            // A flag may be given only once, so remove the tested flag from the usual options.
            let known = match known.split_once(&format!("--{flag} ")) {
                Some((before, after)) => {
                    format!("{before}{}", after.split_once(' ').unwrap_or_default().1)
                }
                None => known.to_owned(),
            };
            let huge = format!("{command} {known} {} --{flag} 1e300", needed(&flag));
            let ended = desk.palpate(&huge);
            if ended.status == Some(0) {
                let json: Value = serde_json::from_str(&ended.stdout).unwrap();
                assert!(!claims_exactness(&json), "{huge}: {json}");
            } else {
                let status = ended.status.unwrap();
                let said = ended.said(status);
                assert!(
                    (1..=2).contains(&status) && said.len() < 1000,
                    "{huge}: {said}"
                );
            }
        }
    }
    assert!(flags > 50, "{flags}");
}
