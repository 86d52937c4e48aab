//! `palpate estimate press` on bad readings and with bad arguments.

use super::desk::Desk;

const HEADER: &str = "x_mm,y_mm,normal_displacement_mm";
const FULL: &str = "x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm";
const SENSOR: &str = "--sensor-radius 20 --depth 2";

/// Error message about a file of these lines.
#[track_caller]
fn said(lines: &[&str], options: &str) -> String {
    let desk = Desk::new();
    desk.write("r.csv", format!("{}\n", lines.join("\n")));
    let said = desk
        .palpate(&format!("estimate press r.csv {SENSOR} {options}"))
        .said(1);
    let said = said.strip_prefix("error: ").unwrap().trim_end();
    let (said, _) = said
        .split_once("; see `palpate explain ")
        .unwrap_or((said, ""));
    said.to_owned()
}

/// Markers on a grid of 7 × 7, 3 mm apart, that moved as a function says.
fn grid(moved: impl Fn(f64, f64) -> f64) -> Vec<String> {
    let mut lines = vec![HEADER.to_owned()];
    for row in 0..49 {
        let [x, y] = [row % 7, row / 7].map(|step| 3.0 * f64::from(step) - 9.0);
        lines.push(format!("{x},{y},{}", moved(x, y)));
    }
    lines
}

#[track_caller]
fn said_of(lines: &[String], options: &str) -> String {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    said(&lines, options)
}

#[test]
fn columns_and_fields() {
    assert_eq!(
        said(&["x_mm,normal_displacement_mm", "0,1"], ""),
        "r.csv:1: no column `y`; the file has `x_mm`, `normal_displacement_mm`; the columns must be x,y,normal_displacement, and may be tangential_x,tangential_y too"
    );
    assert_eq!(
        said(&["x,y,normal_displacement,tangential_x", "0,1,2,3"], ""),
        "r.csv:1: no column `tangential_y`; the file has `x`, `y`, `normal_displacement`, `tangential_x`; the columns must be \
         x,y,normal_displacement,tangential_x,tangential_y"
    );
    assert_eq!(
        said(
            &[
                "radial_position_mm,normal_displacement_mm,y_mm,x_mm",
                "0,1,2,3"
            ],
            ""
        ),
        "r.csv:1: there are both places x, y and radial_position; say by --columns which of them are meant, as in --columns \
         'radial_position=…'"
    );
    assert_eq!(
        said(&["x_mm,y_cm,normal_displacement_mm", "0,1,2"], ""),
        "r.csv:1: lengths are in mm and in cm; one unit is needed: --length-unit mm converts them"
    );
    for (row, message) in [
        ("0,1", "2 fields; the header has 3"),
        (
            "0,1,NaN",
            "column `normal_displacement_mm`: must be finite, is NaN; leave such rows out, as by grep -vi nan",
        ),
        ("0,-inf,1", "column `y_mm`: must be finite, is -inf"),
        (",1,1", "column `x_mm`: is empty"),
        ("one,1,1", "column `x_mm`: `one` is not a number"),
    ] {
        assert_eq!(
            said(&[HEADER, "0,0,0", row], ""),
            format!("r.csv:3: {message}")
        );
    }
    let tangential = said(&[FULL, "0,0,0,0,NaN"], "");
    assert_eq!(
        tangential,
        "r.csv:2: column `tangential_y_mm`: must be finite, is NaN; leave such rows out, as by grep -vi nan"
    );
    assert_eq!(said(&[HEADER], ""), "r.csv: has a header but no readings");
    let huge = said(
        &[HEADER, "0,0,1", "1,1,1e200", "2,2,1", "3,1,1", "4,1,1"],
        "",
    );
    assert!(huge.starts_with("r.csv:3: marker 1"), "{huge}");
}

#[test]
fn markers_that_tell_no_press() {
    let few = said(&[HEADER, "0,0,1", "1,0,1"], "--indentation 1");
    assert!(
        few.starts_with("r.csv: 2 marker(s) give 2 equation(s)"),
        "{few}"
    );
    for (moved, what) in [
        (0.0, "none moved"),
        (0.3, "all moved alike"),
        (-0.3, "outward"),
    ] {
        for options in [
            "",
            "--indentation 1",
            "--baseline fitted",
            "--normal-std 0.05",
        ] {
            let lines = grid(|_, _| moved);
            let desk = Desk::new();
            desk.write("r.csv", lines.join("\n"));
            let ended = desk.palpate(&format!("estimate press r.csv {SENSOR} {options}"));
            // An error, or an interval that does not claim to know.
            match ended.status {
                Some(1) => drop(ended.said(1)),
                _ => {
                    let told: serde_json::Value = serde_json::from_str(&ended.printed()).unwrap();
                    assert_ne!(told["verdict"], "convex", "{what} {options}: {told}");
                    assert_ne!(told["verdict"], "concave", "{what} {options}: {told}");
                }
            }
        }
    }
    let still = said_of(&grid(|_, _| 0.0), "--normal-std 0.05");
    assert!(still.contains("no contact"), "{still}");
    // All on one place.
    let one = vec![HEADER.to_owned(); 1]
        .into_iter()
        .chain((0..20).map(|_| "1,1,0.5".to_owned()))
        .collect::<Vec<_>>();
    assert!(said_of(&one, "").starts_with("r.csv: "));
}

#[test]
fn arguments() {
    let desk = Desk::new();
    desk.write(
        "r.csv",
        grid(|x, y| libm::exp(-0.05 * (x * x + y * y))).join("\n"),
    );
    for (options, words) in [
        ("", "--sensor-radius"),
        ("--sensor-radius 0", "must be finite and > 0, is 0"),
        ("--sensor-radius -20", "must be finite and > 0, is -20"),
        ("--sensor-radius nan", "must be finite and > 0, is nan"),
        (
            "--sensor-radius 20 --depth -1",
            "must be finite and >= 0, is -1",
        ),
        (
            "--sensor-radius 20 --depth 20",
            "--depth is 20; it must be less than --sensor-radius, 20",
        ),
        (
            "--sensor-radius 20 --poisson 0.6",
            "must be from 0 to 0.5, is 0.6",
        ),
        (
            "--sensor-radius 20 --poisson -0.1",
            "must be from 0 to 0.5, is -0.1",
        ),
        (
            "--sensor-radius 20 --indentation 0",
            "must be finite and > 0, is 0",
        ),
        (
            "--sensor-radius 20 --indentation -1",
            "must be finite and > 0, is -1",
        ),
        (
            "--sensor-radius 20 --indentation-std 0.02",
            "--indentation-std is of use only to a given --indentation",
        ),
        (
            "--sensor-radius 20 --thickness 5",
            "--thickness is of use only to --method bonded-layer",
        ),
        (
            "--sensor-radius 20 --method bonded-layer",
            "--method bonded-layer needs --thickness H",
        ),
        (
            "--sensor-radius 20 --method bonded-layer --thickness 1 --depth 2",
            "--depth is 2; it must be at most --thickness, 1",
        ),
        (
            "--sensor-radius 20 --method bonded-layer --thickness 21",
            "--thickness is 21; it must be at most --sensor-radius, 20",
        ),
        (
            "--sensor-radius 20 --method bonded-layer --thickness 5 --poisson 0.4",
            "--poisson is of use only to --method half-space",
        ),
        (
            "--sensor-radius 20 --c 1",
            "--c is of use only to --method gaussian",
        ),
        (
            "--sensor-radius 20 --window 5",
            "--window is of use only to --method gaussian",
        ),
        (
            "--sensor-radius 20 --method gaussian --c 1 --gain-std 0.1",
            "--gain-std is of use only to --method half-space or bonded-layer",
        ),
        (
            "--sensor-radius 20 --method gaussian",
            "needs --c C, or --indentation D",
        ),
        (
            "--sensor-radius 20 --tangential-std 0.1",
            "--tangential-std is of use only to readings with",
        ),
        (
            "--sensor-radius 20 --method bonded-layer --thickness 5 --indentation 6",
            "--indentation is 6; it must be less than --thickness, 5",
        ),
        (
            "--sensor-radius 20 --indentation 20",
            "--indentation is 20; it must be less than --sensor-radius, 20",
        ),
        ("--sensor-radius 20 --baseline free", "free"),
        ("--sensor-radius 20 --method hertz", "hertz"),
        (
            "--sensor-radius 20 --radial-scale 0",
            "must be finite and > 0, is 0",
        ),
    ] {
        let said = desk
            .palpate(&format!("estimate press r.csv {options}"))
            .said(2);
        assert!(said.contains(words), "{options}: {said}");
    }
    assert_eq!(
        desk.palpate("estimate press none.csv --sensor-radius 20")
            .said(1),
        "error: none.csv: no such file\n"
    );
}

#[test]
fn size_does_not_matter() {
    // Hertz's surface under R = 12, δ = 1 within the contact is 1 − r²/24; outside its falling tail.
    let surface = |r: f64| {
        let ratio = r / 12.0_f64.sqrt();
        if ratio <= 1.0 {
            return 1.0 - r * r / 24.0;
        }
        let angle = libm::asin(ratio.recip());
        ((2.0 - ratio * ratio) * angle + (ratio * ratio - 1.0).sqrt()) / std::f64::consts::PI
    };
    for scale in [1.0, 1e-9, 1e9] {
        let desk = Desk::new();
        let mut text = "radial_position,normal_displacement\n".to_owned();
        for step in -20..=20 {
            let position = 0.5 * f64::from(step);
            text += &format!("{},{}\n", position * scale, surface(position.abs()) * scale);
        }
        desk.write("r.csv", text);
        let printed = desk
            .palpate(&format!(
                "estimate press r.csv --sensor-radius {}",
                20.0 * scale
            ))
            .printed();
        let told: serde_json::Value = serde_json::from_str(&printed).unwrap();
        for (name, value) in [
            ("effective_radius", 12.0),
            ("object_radius", 30.0),
            ("indentation", 1.0),
        ] {
            let found = told[name]["value"].as_f64().unwrap() / scale;
            assert!(
                (found / value - 1.0).abs() < 1e-5,
                "{scale} {name}: {found}"
            );
        }
        assert_eq!(told["object_radius"]["unit"], "unit");
    }
}
