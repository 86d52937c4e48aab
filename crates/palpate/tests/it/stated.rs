//! Statements and mistakes of users about recorded readings: told in warnings, or refused.

use serde_json::Value;

use super::desk::Desk;

const PRESS: &str = include_str!("../../../../examples/press-readings.csv");
const ROLL: &str = include_str!("../../../../examples/roll-readings.csv");
const GLIDE: &str = include_str!("../../../../examples/glide-readings.csv");
const SENSOR: &str = "estimate press r.csv --sensor-radius 20 --depth 2";

/// A table with the columns of these numbers multiplied.
fn scaled(csv: &str, columns: &[usize], factor: f64) -> String {
    let mut lines = csv.lines();
    let mut text = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let fields = line.split(',').enumerate().map(|(column, field)| {
            let number: f64 = field.parse().unwrap();
            let factor = if columns.contains(&column) {
                factor
            } else {
                1.0
            };
            (number * factor).to_string()
        });
        text += &format!("{}\n", fields.collect::<Vec<_>>().join(","));
    }
    text
}

fn desk(readings: &str) -> Desk {
    let desk = Desk::new();
    desk.write("r.csv", readings);
    desk
}

/// The first contact of a table, with its normal turned round.
fn inward(csv: &str) -> String {
    let first: String = csv
        .lines()
        .take(2)
        .map(|line| format!("{line}\n"))
        .collect();
    let turned = scaled(&first, &[4, 5, 6], -1.0);
    turned.lines().nth(1).unwrap().to_owned()
}

/// All that a command says: the warnings of its JSON, which standard error repeats, or its error.
fn told(desk: &Desk, command: &str) -> String {
    let ended = desk.palpate(command);
    if ended.status != Some(0) {
        return ended.said(1);
    }
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    let warnings = json["warnings"].as_array().unwrap().iter();
    let lines = warnings.map(|warning| format!("warning: {}\n", warning["text"].as_str().unwrap()));
    assert_eq!(ended.stderr, lines.collect::<String>());
    json["warnings"].to_string()
}

#[test]
fn what_no_reading_tells_is_asked_for() {
    let desk = desk(PRESS);
    let surface = "they are taken to lie at the skin's surface";
    let skin = "estimate press r.csv --sensor-radius 20";
    assert!(told(&desk, skin).contains(surface));
    for options in ["--depth 0", "--depth 2"] {
        let said = told(&desk, &format!("{skin} {options}"));
        assert!(!said.contains(surface), "{options}: {said}");
    }
    let said = told(&desk, &format!("{SENSOR} --method gaussian --c 1"));
    assert!(said.contains("a Gaussian is no elastic body"), "{said}");
}

#[test]
fn stated_quantities_that_the_readings_contradict() {
    let known = "--indentation-std 0.02";
    for (options, words) in [
        ("", "[]"),
        (&*format!("--indentation 1.5 {known}"), "[]"),
        ("--indentation 1.5", "without a standard deviation"),
        (
            "--indentation 1.5 --indentation-std 0",
            "without a standard deviation",
        ),
        (
            &format!("--indentation 1 {known}"),
            "but the readings alone say 1.43 +- 0.0555 mm: they differ by 7.4",
        ),
        (&format!("--indentation 1.2 {known}"), "they differ by 4"),
        (
            &format!("--indentation 1.7 {known}"),
            "the curvature is not to be trusted",
        ),
        ("--indentation 2", "the readings alone say"),
        ("--indentation 3", "the readings alone say"),
        ("--indentation 15", "the readings alone say"),
        (
            "--indentation 2 --indentation-std 1e-6",
            "among them one of the contact itself (row 1, line 2)",
        ),
        ("--normal-std 0.01", "times the noise that is given"),
        (
            "--normal-std 0.5 --tangential-std 0.2",
            "times the residuals: intervals are too wide",
        ),
    ] {
        let said = told(&desk(PRESS), &format!("{SENSOR} {options}"));
        assert!(said.contains(words), "{options}: {said}");
    }
    let roll = "estimate roll r.csv --probe-radius 10 --shift-std";
    assert_eq!(
        told(
            &desk(ROLL),
            "estimate roll r.csv --probe-radius 10 --pitch 0.5"
        ),
        "[]"
    );
    let said = told(&desk(ROLL), &format!("{roll} 1e-6"));
    assert!(
        said.contains("times what the noise that is given explains"),
        "{said}"
    );
    let glide = "estimate glide r.csv --method two-pass --inter-finger-distance";
    for (distance, words) in [
        ("1000", "those of the readings are"),
        ("0.01", "is the unit right?"),
    ] {
        let said = told(&desk(GLIDE), &format!("{glide} {distance}"));
        assert!(said.contains(words), "{distance}: {said}");
    }
    let glide = "estimate glide r.csv --method quadric";
    for (options, words) in [
        ("--position-std 0.5 --normal-std-deg 2", "[]"),
        (
            "--position-std 5",
            "the noise of positions is stated as 5 mm, but the contacts show 0.4",
        ),
        ("--position-std 0.01", "stated as 0.01 mm"),
        // The fingers are 13.8 mm apart, as the readings show them.
        ("--position-fraction-of-ifd 0.03", "[]"),
        ("--position-fraction-of-ifd 0.5", "stated as 6.9 mm"),
        (
            "--position-fraction-of-ifd 0.05 --inter-finger-distance 100",
            "stated as 5 mm",
        ),
        (
            "--position-fraction-of-ifd 0.05 --inter-finger-distance 100",
            "the distance between fingers is stated as 100 mm, but those of the readings are 13.8",
        ),
        (
            "--normal-std-deg 20",
            "the noise of normals is stated as 20 degrees, but the contacts show 1.9",
        ),
    ] {
        let said = told(&desk(GLIDE), &format!("{glide} {options}"));
        assert!(said.contains(words), "{options}: {said}");
    }
}

#[test]
fn a_stated_indentation_that_the_readings_contradict_is_doubted() {
    for (indentation, is_doubted) in [("1.5", false), ("1", true), ("2", true), ("3", true)] {
        let ended = desk(PRESS).palpate(&format!("{SENSOR} --indentation {indentation}"));
        let json: Value = serde_json::from_str(&ended.stdout).unwrap();
        let warnings = json["warnings"].as_array().unwrap();
        let is_it = |warning: &Value| warning["code"] == "other-indentation";
        assert_eq!(
            warnings.iter().any(is_it),
            is_doubted,
            "{indentation}: {json}"
        );
    }
}

#[test]
fn noise_that_is_stated_a_little_too_small_is_told() {
    let ended = desk(PRESS).palpate(&format!(
        "{SENSOR} --normal-std 0.0385 --tangential-std 0.0155"
    ));
    let json: Value = serde_json::from_str(&ended.stdout).unwrap();
    let codes = json["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|warning| &warning["code"]);
    assert!(
        codes.into_iter().any(|code| code == "large-residuals"),
        "{json}"
    );
    let said = json["warnings"].to_string();
    assert!(said.contains("times the noise that is given"), "{said}");
}

#[test]
fn noise_larger_than_all_that_moved_is_told() {
    let said = told(
        &desk(PRESS),
        &format!("{SENSOR} --normal-std 5 --tangential-std 5"),
    );
    let words = "the noise is stated as 5 mm (--normal-std), and no marker moved by more than";
    assert!(said.contains(words), "{said}");
    let roll = "estimate roll r.csv --probe-radius 10 --rotation-std-rad";
    let said = told(&desk(ROLL), &format!("{roll} 0.5"));
    assert!(said.contains("is it in degrees?"), "{said}");
    assert!(!told(&desk(ROLL), &format!("{roll} 0.01")).contains("degrees"));
}

/// Rows of a table with two of its columns in each other's place.
fn swapped(csv: &str, one: usize, other: usize) -> String {
    let mut lines = csv.lines();
    let mut text = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields.swap(one, other);
        text += &format!("{}\n", fields.join(","));
    }
    text
}

#[test]
fn mistakes_of_displacements_along_the_skin() {
    let said = |csv: &str| told(&desk(csv), SENSOR);
    for (csv, words) in [
        (
            swapped(PRESS, 3, 4),
            "with tangential_x and tangential_y swapped",
        ),
        (
            scaled(PRESS, &[3], -1.0),
            "with the sign of tangential_x turned",
        ),
        (
            scaled(PRESS, &[4], -1.0),
            "with the sign of tangential_y turned",
        ),
        (scaled(PRESS, &[3, 4], -1.0), "with both signs turned"),
    ] {
        let said = said(&csv);
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(!said(PRESS).contains("along the skin"));
}

#[test]
fn rolls_that_are_there_twice() {
    let mut twice = ROLL.to_owned();
    let shifted = ROLL.lines().skip(1).map(|line| {
        let (probe, rest) = line.split_once(',').unwrap();
        format!("{},{rest}\n", probe.parse::<u32>().unwrap() + 100)
    });
    twice.extend(shifted);
    let said = told(&desk(&twice), "estimate roll r.csv --probe-radius 10");
    assert!(said.contains("repeat rolls of rows before"), "{said}");
}

#[test]
fn contacts_that_are_no_part_of_the_patch_or_too_few() {
    let lost = format!("{}0,0,0,0,0,0,1\n", scaled(GLIDE, &[1], 1.0));
    let far = scaled(&lost, &[], 1.0).replace("0,0,0,0,0,0,1", "0,300,0,0,0,0,1");
    let said = told(&desk(&far), "estimate glide r.csv");
    assert!(
        said.contains("lies") && said.contains("from the nearest other"),
        "{said}"
    );
    assert!(!told(&desk(GLIDE), "estimate glide r.csv").contains("nearest other"));
    let three = "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z\n0,0,0,0,0,0,1\n1,5,0,-0.3,0.1,0,1\n2,0,5,-0.3,0,0.1,1\n";
    let said = told(&desk(three), "estimate glide r.csv");
    assert!(
        said.contains("3 contacts do not tell their noise"),
        "{said}"
    );
    let line: String = (0..12)
        .map(|at| f64::from(at) - 6.0)
        .map(|x| format!("0,{x},0,{}\n", -0.01 * x * x))
        .collect();
    let said = told(
        &desk(&format!("finger,x_mm,y_mm,z_mm\n{line}")),
        "estimate glide r.csv",
    );
    assert!(
        said.contains("if the contacts lie along one curve"),
        "{said}"
    );
}

#[test]
fn mistakes_of_sign_and_unit() {
    for (columns, factor, words) in [
        (&[2][..], -1.0, "positive is inward: is the sign wrong?"),
        (&[2, 3, 4], 50.0, "more than the sensor's radius, 20 mm"),
        (
            &[0, 1, 2, 3, 4],
            1e-3,
            "are the readings in m and the radius in mm?",
        ),
        (
            &[2, 3, 4],
            1e-3,
            "are the displacements in m and the rest in mm?",
        ),
        (&[0, 1], 1e3, "beyond half the circumference"),
    ] {
        let said = told(&desk(&scaled(PRESS, columns, factor)), SENSOR);
        assert!(said.contains(words), "{columns:?} {factor}: {said}");
    }
    for (columns, factor, words) in [
        (
            &[1, 2][..],
            57.296,
            "are the rotations in degrees, or the shifts in cm",
        ),
        (
            &[3, 4],
            1e-3,
            "are the shifts in m and the radius in mm, or",
        ),
        (&[3, 4], 1e3, "passes half way round the probe"),
        (&[1, 2], 1e-3, "in a smaller unit than the radius?"),
    ] {
        let roll = "estimate roll r.csv --probe-radius 10";
        let said = told(&desk(&scaled(ROLL, columns, factor)), roll);
        assert!(said.contains(words), "{columns:?} {factor}: {said}");
    }
    for (factor, words) in [
        (57.296, "the normals have lengths of about 57.3, not 1"),
        (-1.0, "the normals point to -z"),
    ] {
        let said = told(
            &desk(&scaled(GLIDE, &[4, 5, 6], factor)),
            "estimate glide r.csv",
        );
        assert!(said.contains(words), "{factor}: {said}");
    }
    let still = scaled(ROLL, &[1, 2], 0.0);
    let said = told(&desk(&still), "estimate roll r.csv --probe-radius 10");
    assert!(said.contains("no probe turned"), "{said}");
    let one_inward = GLIDE.replacen(GLIDE.lines().nth(1).unwrap(), &inward(GLIDE), 1);
    let said = told(&desk(&one_inward), "estimate glide r.csv");
    assert!(said.contains("does its normal point inward?"), "{said}");
}

#[test]
fn arguments_have_the_bounds_of_configs() {
    let roll = "estimate roll r.csv --probe-radius 10";
    let glide = "estimate glide r.csv";
    for (readings, command, words) in [
        (
            ROLL,
            format!("{roll} --pitch 1e300"),
            "--pitch is 1e300; it must be > 0 and at most the probe's radius, 10",
        ),
        (
            ROLL,
            format!("{roll} --pitch 11"),
            "--pitch is 11; it must be > 0 and at most the probe's radius, 10",
        ),
        (
            ROLL,
            format!("{roll} --pitch 1e-15"),
            "it must be at least 1e-15 of the probe's radius",
        ),
        (
            ROLL,
            format!("{roll} --shift-std 1e300"),
            "--shift-std is 1e300; it must be at least 0 and at most the probe's radius, 10",
        ),
        (
            ROLL,
            format!("{roll} --rotation-std-rad 500"),
            "must be from 0 to 3.14",
        ),
        (
            ROLL,
            format!("{roll} --relative-rotation-std 1e300"),
            "must be from 0 to 1, is 1e300",
        ),
        (
            GLIDE,
            format!("{glide} --normal-std-deg 500"),
            "must be > 0 and <= 90, is 500",
        ),
        (
            PRESS,
            format!("{SENSOR} --gain-std 1e300"),
            "must be from 0 to 1e100, is 1e300",
        ),
        (
            GLIDE,
            format!("{glide} --outward 0,0,1"),
            "--outward is of use only to readings without normals",
        ),
    ] {
        let said = desk(readings).palpate(&command).said(2);
        assert!(said.contains(words), "{command}: {said}");
    }
    let bare: String = GLIDE
        .lines()
        .map(|line| {
            format!(
                "{}\n",
                line.split(',').take(4).collect::<Vec<_>>().join(",")
            )
        })
        .collect();
    desk(&bare)
        .palpate("estimate glide r.csv --normal-std-deg 1")
        .fails(
            2,
            "--normal-std-deg is of use only to readings with normals",
        );
}

#[test]
fn the_json_has_a_version() {
    for (readings, command) in [
        (PRESS, SENSOR),
        (ROLL, "estimate roll r.csv --probe-radius 10"),
        (GLIDE, "estimate glide r.csv"),
    ] {
        let printed = desk(readings).palpate(command).printed();
        let json: Value = serde_json::from_str(&printed).unwrap();
        assert_eq!(json["format_version"], 2, "{command}");
    }
}

/// Flags of a command that take a number, by its help.
fn numeric_flags(command: &str) -> Vec<String> {
    let help = Desk::new().palpate(&format!("{command} --help")).printed();
    let flag = |line: &str| {
        let (flag, rest) = line.trim().strip_prefix("--")?.split_once(" <")?;
        let name = rest.split('>').next()?;
        let is_number = matches!(
            name,
            "R" | "P"
                | "S"
                | "F"
                | "N"
                | "T"
                | "D"
                | "D,D,..."
                | "Z"
                | "E"
                | "X"
                | "I"
                | "LENGTH"
                | "X,Y,Z"
        );
        is_number.then(|| flag.to_owned())
    };
    help.lines().filter_map(flag).collect()
}

/// Settings without which a flag is of no use.
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

/// Whether a JSON has a standard deviation of 0 for a value that is not.
fn claims_exactness(json: &Value) -> bool {
    match json {
        Value::Object(table) => {
            table.get("std").and_then(Value::as_f64) == Some(0.0)
                || table.values().any(claims_exactness)
        }
        Value::Array(items) => items.iter().any(claims_exactness),
        _ => false,
    }
}

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
        ("", "sensor track", "a.png b.png --out o"),
        ("", "sensor calibrate", "a.png b.png --out c.toml"),
    ] {
        let desk = desk(readings);
        for flag in numeric_flags(command) {
            flags += 1;
            for value in ["nan", "inf", "-1"] {
                let said = desk.palpate(&format!("{command} --{flag} {value}")).said(2);
                let is_named = said.contains(&format!("'{value}' for '--{flag} <"))
                    || said.contains("unexpected argument '-1' found");
                assert!(is_named, "{command} --{flag} {value}: {said}");
            }
            // The flag stands once, with its number.
            let words: Vec<&str> = known.split(' ').collect();
            let stands = words.iter().position(|word| *word == format!("--{flag}"));
            let known: Vec<&str> = (0..words.len())
                .filter(|&place| stands.is_none_or(|at| place != at && place != at + 1))
                .map(|place| words[place])
                .collect();
            let huge = format!(
                "{command} {} {} --{flag} 1e300",
                known.join(" "),
                needed(&flag)
            );
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
