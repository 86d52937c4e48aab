//! `palpate estimate glide` on bad readings and with bad arguments.

use super::desk::{Desk, assert_close};

const HEADER: &str = "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z";
const BARE: &str = "finger,x_mm,y_mm,z_mm";

/// Error message about a file of these lines.
#[track_caller]
fn said(lines: &[&str], options: &str) -> String {
    let desk = Desk::new();
    desk.write("r.csv", format!("{}\n", lines.join("\n")));
    let said = desk
        .palpate(&format!("estimate glide r.csv {options}"))
        .said(1);
    let said = said.strip_prefix("error: ").unwrap().trim_end();
    let (said, _) = said
        .split_once("; see `palpate explain ")
        .unwrap_or((said, ""));
    said.to_owned()
}

/// Contacts on a grid of `side` × `side`, placed by a function of x and y in [−1, 1].
fn grid(header: &str, side: usize, row: impl Fn(f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    let at = |index: usize| 2.0 * index as f64 / (side - 1) as f64 - 1.0;
    for finger in 0..side {
        for contact in 0..side {
            text += &format!("{finger},{}\n", row(at(contact), at(finger)));
        }
    }
    text
}

/// A bowl of 0.2 (x² + y²), in lengths of `scale`.
fn bowl(scale: f64) -> String {
    grid(BARE, 6, |x, y| {
        format!(
            "{},{},{}",
            x * scale,
            y * scale,
            0.2 * (x * x + y * y) * scale
        )
    })
}

#[track_caller]
fn said_of(text: &str) -> String {
    said(&text.lines().collect::<Vec<_>>(), "")
}

#[test]
fn columns_and_fields() {
    assert_eq!(
        said(&["finger,x_mm,y_mm", "0,1,2"], ""),
        "r.csv:1: no column `z`; the file has `finger`, `x_mm`, `y_mm`; the columns must be finger,x,y,z, and may be normal_x,normal_y,normal_z too"
    );
    assert_eq!(
        said(&["finger,x,y,z,normal_x,normal_y", "0,1,2,3,0,0"], ""),
        "r.csv:1: no column `normal_z`; the file has `finger`, `x`, `y`, `z`, `normal_x`, `normal_y`; the columns must be \
         finger,x,y,z,normal_x,normal_y,normal_z"
    );
    assert_eq!(
        said(&["finger,x_mm,y_cm,z_mm", "0,1,2,3"], ""),
        "r.csv:1: lengths are in mm and in cm; one unit is needed: --length-unit mm converts them"
    );
    for (row, message) in [
        ("0,1,2", "3 fields; the header has 4"),
        (
            "0,1,2,NaN",
            "column `z_mm`: must be finite, is NaN; leave such rows out, as by grep -vi nan",
        ),
        ("0,1,inf,3", "column `y_mm`: must be finite, is inf"),
        ("0,,2,3", "column `x_mm`: is empty"),
        ("0,one,2,3", "column `x_mm`: `one` is not a number"),
        (
            "0.5,1,2,3",
            "column `finger`: must be a whole number from 0, is 0.5",
        ),
        (
            "-1,1,2,3",
            "column `finger`: must be a whole number from 0, is -1",
        ),
    ] {
        assert_eq!(
            said(&[BARE, "0,0,0,0", row], ""),
            format!("r.csv:3: {message}")
        );
    }
    assert_eq!(said(&[BARE], ""), "r.csv: has a header but no readings");
}

#[test]
fn contacts_that_tell_no_patch() {
    let one = said(&[BARE, "0,1,2,3"], "");
    assert!(
        one.starts_with("r.csv: 1 contact(s) give 1 equation(s)"),
        "{one}"
    );
    let five = said(
        &[BARE, "0,0,0,0", "0,1,0,0", "1,0,1,0", "1,1,1,0", "1,2,1,0"],
        "",
    );
    assert!(
        five.starts_with("r.csv: 5 contact(s) give 5 equation(s)"),
        "{five}"
    );
    let same = format!("{BARE}\n{}", "0,1,2,3\n".repeat(50_000));
    assert_eq!(
        said_of(&same),
        "r.csv: all 50000 contacts lie on one point, within 0"
    );
    let line = said_of(&grid(BARE, 6, |x, _| format!("{x},{x},{x}")));
    assert!(
        line.starts_with("r.csv: all 36 contacts lie on a line"),
        "{line}"
    );
    let closed = grid(BARE, 12, |u, v| {
        let (sin, cos) = libm::sincos(3.1 * u);
        let (height, radius) = libm::sincos(1.5 * v);
        format!("{},{},{}", radius * cos, radius * sin, height)
    });
    let closed = said_of(&closed);
    assert!(
        closed.starts_with("r.csv: the contacts have no mean plane"),
        "{closed}"
    );
}

#[test]
fn normals_that_cannot_be() {
    let flat = grid(HEADER, 6, |x, y| format!("{x},{y},0,0,0,1"));
    let with =
        |normal: &str| said_of(&flat.replacen("-1,-1,0,0,0,1", &format!("-1,-1,0,{normal}"), 1));
    assert_eq!(
        with("0,0,0"),
        "r.csv:2: contact 0 (counting from 0): the normal has no direction: its largest component is 0"
    );
    let tangent = with("1,0,0");
    assert!(
        tangent.starts_with("r.csv:2: the patch is not a graph over its mean plane"),
        "{tangent}"
    );
}

#[test]
fn a_wall_is_a_patch_like_any_other() {
    // A cylinder of radius 5 around z, seen from +x: outward lies in its plane unless told.
    let wall = grid(BARE, 6, |y, z| format!("{},{y},{z}", (25.0 - y * y).sqrt()));
    let refused = said_of(&wall);
    assert!(
        refused.starts_with("r.csv: the outward direction lies in the patch's plane")
            && refused.ends_with("; give another with --outward X,Y,Z"),
        "{refused}"
    );
    let desk = Desk::new();
    desk.write("r.csv", &wall);
    for (outward, sign) in [("1,0,0", 1.0), ("-2,0,0", -1.0)] {
        let printed = desk
            .palpate(&format!("estimate glide r.csv --outward {outward}"))
            .printed();
        let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
        assert_close(
            json["mean_curvature"]["value"].as_f64().unwrap(),
            sign * 0.1,
            0.02,
        );
    }
}

#[test]
fn size_does_not_matter() {
    let relative = |scale: f64| {
        let desk = Desk::new();
        desk.write("r.csv", bowl(scale));
        let printed = desk.palpate("estimate glide r.csv").printed();
        let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
        let number = |name: &str| json[name]["value"].as_f64().unwrap();
        let class = json["class"].as_str().unwrap().to_owned();
        assert_eq!(json["regions"].as_array().unwrap().len(), 1);
        (
            number("gaussian_curvature") * scale * scale,
            number("mean_curvature") * scale,
            class,
        )
    };
    let (gaussian, mean, class) = relative(1.0);
    assert_close(mean, -0.4, 1e-9);
    assert_close(gaussian, 0.16, 1e-9);
    assert_eq!(class, "pit");
    for scale in [1e-9, 1e9] {
        let (scaled_gaussian, scaled_mean, scaled_class) = relative(scale);
        assert_close(scaled_gaussian, gaussian, 1e-9);
        assert_close(scaled_mean, mean, 1e-9);
        assert_eq!(scaled_class, class);
    }
}

#[test]
fn duplicates_and_one_finger() {
    let desk = Desk::new();
    let rows = bowl(1.0);
    let doubled: String = rows
        .lines()
        .skip(1)
        .map(|row| format!("{row}\n{row}\n"))
        .collect();
    desk.write("r.csv", format!("{BARE}\n{doubled}"));
    let printed = desk.palpate("estimate glide r.csv").printed();
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_close(
        json["mean_curvature"]["value"].as_f64().unwrap(),
        -0.4,
        1e-9,
    );
    // One finger may go to and fro over the patch.
    let one: String = rows
        .lines()
        .skip(1)
        .map(|row| format!("9{}\n", &row[1..]))
        .collect();
    desk.write("r.csv", format!("{BARE}\n{one}"));
    let printed = desk.palpate("estimate glide r.csv").printed();
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(json["fingers"], 1);
    assert_close(
        json["mean_curvature"]["value"].as_f64().unwrap(),
        -0.4,
        1e-9,
    );
}

#[test]
fn arguments() {
    let desk = Desk::new();
    desk.write("r.csv", bowl(1.0));
    for (options, words) in [
        ("--outward 0,0,0", "must be finite and not zero"),
        ("--outward 0,0", "needs 3 numbers, X,Y,Z; has 2"),
        ("--outward a,b,c", "`a` is not a number"),
        ("--grid 0", "0 is not in 1..=1000"),
        ("--grid 1001", "1001 is not in 1..=1000"),
        ("--gaussian-threshold 0.1", "--mean-threshold"),
        (
            "--gaussian-threshold 0.1 --mean-threshold 1",
            "gaussian threshold 0.1 is below the square of the mean threshold 1",
        ),
        (
            "--gaussian-threshold -1 --mean-threshold 0",
            "must be finite and >= 0, is -1",
        ),
        ("--position-std 0", "must be finite and > 0, is 0"),
        (
            "--method two-pass --position-std 1",
            "is of use only to --method penalised or quadric",
        ),
        ("--method spline", "spline"),
        (
            "--inter-finger-distance 2",
            "is of use only to --method two-pass or --position-fraction-of-ifd",
        ),
        (
            "--position-std 0.1 --position-fraction-of-ifd 0.01",
            "--position-fraction-of-ifd cannot stand beside --position-std; give one of them",
        ),
        (
            "--position-fraction-of-ifd 0",
            "must be finite and > 0, is 0",
        ),
        (
            "--method two-pass --inter-finger-distance 0",
            "must be finite and > 0, is 0",
        ),
        ("--at-contacts", "--map"),
    ] {
        let said = desk
            .palpate(&format!("estimate glide r.csv {options}"))
            .said(2);
        assert!(said.contains(words), "{options}: {said}");
    }
    let said = desk.palpate("estimate glide none.csv").said(1);
    assert_eq!(said, "error: none.csv: no such file\n");
    desk.palpate("estimate glide r.csv --map .")
        .fails(2, "--map");
    desk.write("file", "");
    let said = desk
        .palpate("estimate glide r.csv --map file/m.csv")
        .said(1);
    assert_eq!(said, "error: --map file/m.csv: no directory file\n");
    let said = desk.palpate("estimate glide r.csv --map a/b/m.csv").said(1);
    assert_eq!(said, "error: --map a/b/m.csv: no directory a/b\n");
    assert!(!desk.path("a").exists());
}

#[test]
fn given_thresholds_and_noise_are_used() {
    let desk = Desk::new();
    desk.write("r.csv", bowl(1.0));
    let printed = desk
        .palpate(
            "estimate glide r.csv --gaussian-threshold 1 --mean-threshold 1 --position-std 0.02 --method quadric",
        )
        .printed();
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(
        (&json["class"], &json["sign_class"]),
        (&"flat".into(), &"concave".into())
    );
    assert_eq!(json["thresholds"]["from"], "given");
    assert_close(
        json["noise"]["position_std"]["value"].as_f64().unwrap(),
        0.02,
        1e-9,
    );
    assert!(json["mean_curvature"]["std"].as_f64().unwrap() > 1e-3);
}

#[test]
fn two_pass_of_one_finger_needs_a_unit() {
    let desk = Desk::new();
    let bowl = bowl(1.0);
    let rows = bowl.lines().skip(1);
    let one: String = rows.map(|row| format!("0{}\n", &row[1..])).collect();
    desk.write("one.csv", format!("{BARE}\n{one}"));
    desk.write("many.csv", &bowl);
    let run = |arguments: &str| desk.palpate(&format!("estimate glide {arguments}"));
    assert_eq!(
        run("one.csv --method two-pass").said(1),
        "error: one.csv: the contacts are of one finger, which has no distance to another: \
         two-pass needs --inter-finger-distance\n"
    );
    let told = |arguments: &str| -> serde_json::Value {
        serde_json::from_str(&run(arguments).printed()).unwrap()
    };
    // The fingers of the grid stand 0.4 apart, which is then the unit.
    let given = told("many.csv --method two-pass --inter-finger-distance 0.4");
    let found = told("many.csv --method two-pass");
    let mean = |json: &serde_json::Value| json["mean_curvature"]["value"].as_f64().unwrap();
    assert_close(mean(&given), mean(&found), 1e-9);
    assert!(found["status"].is_string());
    assert!(told("many.csv")["status"].is_null());
    assert!(
        mean(&told(
            "one.csv --method two-pass --inter-finger-distance 0.4"
        )) < 0.0
    );
    let huge = run("many.csv --method two-pass --inter-finger-distance 1e300").said(1);
    assert!(
        huge.len() < 150 && huge.contains("--inter-finger-distance is 1e300"),
        "{huge}"
    );
}

#[test]
fn a_map_at_the_contacts_has_their_places_in_their_order() {
    let desk = Desk::new();
    // z = 0.2 (x² + y²) seen from above, so that lines along z meet it at its contacts.
    desk.write("r.csv", bowl(1.0));
    let on_grid = desk
        .palpate("estimate glide r.csv --map grid.csv")
        .printed();
    let at_contacts = desk
        .palpate("estimate glide r.csv --map m.csv --at-contacts")
        .printed();
    assert_eq!(on_grid, at_contacts);
    let (readings, map) = (desk.table("r.csv"), desk.table("m.csv"));
    assert_eq!(map.header, desk.table("grid.csv").header);
    assert_eq!(map.rows.len(), readings.rows.len());
    for row in 0..map.rows.len() {
        for column in ["x_mm", "y_mm", "z_mm"] {
            let off = map.number(row, column) - readings.number(row, column);
            assert!(off.abs() < 1e-9, "{column} of row {row}");
        }
        let slope_squared =
            0.16 * (map.number(row, "x_mm").powi(2) + map.number(row, "y_mm").powi(2));
        let gaussian = map.number(row, "gaussian_curvature_per_mm2");
        assert_close(gaussian, 0.16 / (1.0 + slope_squared).powi(2), 1e-9);
        assert_eq!(map.text(row, "region"), "");
    }
}
