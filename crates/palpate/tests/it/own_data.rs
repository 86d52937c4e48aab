//! Recorded readings as other programs write them: `palpate estimate` on foreign tables.

use super::desk::{Desk, assert_close};
use super::foreign::{ROLLS, desk, mean_curvature, refused, rolls, told, warnings};

#[test]
fn foreign_names_units_and_columns() {
    let expected = rolls(ROLLS, "");
    let mut foreign = "No;Rot A (deg);Rot B [mrad];U, raw [m];V [in];Force [N];note\n".to_owned();
    for row in ROLLS.lines().skip(1) {
        let field: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        let fields = [
            field[0],
            field[1].to_degrees(),
            field[2] * 1e3,
            field[3] / 1e3,
            field[4] / 25.4,
        ];
        let fields = fields.map(|field| field.to_string().replace('.', ","));
        foreign += &format!("{};1,5;\"a; b\"\n", fields.join(";"));
    }
    let columns =
        "'rotation_x=Rot A (deg),rotation_y=rot b [MRAD],\"shift_u=U, raw [m]\",shift_v=V [in]'";
    let found = rolls(&foreign, &format!("--columns {columns} --length-unit mm"));
    assert_close(mean_curvature(&found), mean_curvature(&expected), 1e-12);
    assert_eq!(found["arc_length"]["unit"], "mm");
    assert_eq!(
        warnings(&found),
        ["no column `probe`: each of the 4 rows counts as a probe"]
    );
    let without_units = "'rotation_x=Rot A,rotation_y=Rot B,\"shift_u=U, raw\",shift_v=V'";
    let same = rolls(
        &foreign,
        &format!("--columns {without_units} --length-unit mm"),
    );
    assert_eq!(same, found);
    // Without --length-unit there is no unit that the two of the header agree on.
    let said = refused(&foreign, &format!("--columns {columns}"));
    assert!(
        said.ends_with(
            "lengths are in m and in in; one unit is needed: --length-unit m converts them"
        ),
        "{said}"
    );
    // The unit of a header that states none stands behind palpate's name.
    let bare = ROLLS.replace("shift_u_mm", "u").replace("shift_v_mm", "v");
    let found = rolls(&bare, "--columns shift_u_mm=u,shift_v_mm=v");
    assert_eq!(found, expected);
    // Inches are read as millimetres.
    let inches = bare.replace("u,v", "shift_u_in,shift_v [inch]");
    let found = told(
        &desk(inches),
        "\"$palpate\" estimate roll r.csv --probe-radius 254",
    );
    assert_eq!(found["mean_curvature"]["unit"], "1/mm");
    assert_close(
        mean_curvature(&found),
        mean_curvature(&expected) / 25.4,
        1e-9,
    );
}

#[test]
fn a_message_names_what_there_is_and_what_to_type() {
    let foreign = "Nr;Rotation X [deg];Rotation Y [deg];Shift along U [m];Shift along V [m];Force [N]\n0;1;2;3;4;5\n";
    let said = refused(foreign, "");
    let pairs = "'rotation_x=Rotation X [deg]'";
    assert!(
        !said.contains(pairs),
        "rotations are found by themselves: {said}"
    );
    let typed = said.split("write --columns ").nth(1).unwrap();
    assert_eq!(
        typed,
        "'shift_u=Shift along U [m],shift_v=Shift along V [m]'"
    );
    assert!(
        said.contains("no columns `shift_u`, `shift_v`; the file has `Nr`, `Rotation X [deg]`"),
        "{said}"
    );
    // What it says to type goes further.
    let next = refused(foreign, &format!("--columns {typed}"));
    assert!(next.contains("1 probe(s)"), "{next}");
    // A column that resembles none is left to the reader, one in another unit is not proposed.
    let said = refused("p,q,r,Shift U [N],shift_v\n1,2,3,4,5\n", "");
    assert!(
        said.contains("shift_u` stands") || said.contains("`N` is none of its units"),
        "{said}"
    );
    let said = refused(
        "shift_u_deg,q,rotation_x_rad,rotation_y_rad,shift_v\n1,2,3,4,5\n",
        "",
    );
    assert!(said.contains("write --columns 'shift_u=…'"), "{said}");
    let said = refused("p,q,rotation_y,shift_u,shift_v\n1,2,3,4,5\n", "");
    assert!(
        said.ends_with("write --columns 'rotation_x_rad=…,rotation_y_rad=rotation_y', with the file's name for it at …"),
        "{said}"
    );
}

#[test]
fn columns_that_are_not_asked_for() {
    let pitch = "--pitch 0.5";
    let rolled = ROLLS.replace("0,0.3,-2,0", "0,0.3,0,0");
    let plain = rolls(&rolled, pitch);
    let noted = rolled
        .replace("shift_v_mm\n", "shift_v_mm,Force [N],note\n")
        .replace(",0.25\n", ",0.25,1,\n")
        .replace("2.125\n2", "2.125,2,\n2")
        .replace("0,0\n", "0,0,3,\"slow, \"\"so\"\"\"\n")
        .replace(",-2\n", ",-2,4,\n");
    let mut found = rolls(&noted, pitch);
    let probes = found["unresolved_probes"].as_array_mut().unwrap();
    assert_eq!(probes.len(), 1);
    let columns = probes[0]
        .as_object_mut()
        .unwrap()
        .remove("columns")
        .unwrap();
    assert_eq!(columns["note"], "slow, \"so\"");
    assert_eq!(columns["Force [N]"], "3");
    // Nothing else depends on them.
    assert_eq!(found, plain);

    let desk = Desk::new();
    let mut bowl = "finger,x_mm,y_mm,z_mm,class,only\n".to_owned();
    for contact in 0..36 {
        let [x, y] = [contact % 6, contact / 6].map(f64::from);
        let note = if contact == 7 { "here" } else { "" };
        bowl += &format!(
            "{},{x},{y},{},a{contact},{note}\n",
            contact / 6,
            0.02 * (x * x + y * y)
        );
    }
    desk.write("r.csv", &bowl);
    told(
        &desk,
        "\"$palpate\" estimate glide r.csv --map at.csv --at-contacts",
    );
    let map = desk.table("at.csv");
    assert_eq!(map.header.last().unwrap(), "only");
    assert_eq!(map.text(7, "only"), "here");
    assert_eq!(map.text(8, "only"), "");
    assert_eq!(map.text(35, "readings_class"), "a35");
    assert_ne!(map.text(35, "class"), "a35");
    told(&desk, "\"$palpate\" estimate glide r.csv --map grid.csv");
    assert!(!desk.read("grid.csv").contains("readings_class"));
}

#[test]
fn a_marker_that_is_left_out_keeps_its_columns() {
    let example = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/press-readings.csv"
    );
    let rows = std::fs::read_to_string(example).unwrap();
    let mut lines: Vec<String> = rows.lines().map(str::to_owned).collect();
    for (number, line) in lines.iter_mut().enumerate() {
        line.push_str(&if number == 0 {
            ",label".to_owned()
        } else {
            format!(",m{number}")
        });
    }
    let wrong = 30;
    let mut fields: Vec<&str> = lines[wrong].split(',').collect();
    fields[2] = "1.2";
    lines[wrong] = fields.join(",");
    let found = told(
        &desk(lines.join("\n")),
        "\"$palpate\" estimate press r.csv --sensor-radius 20 --depth 2",
    );
    let left_out = found["wrong_markers"].as_array().unwrap();
    let row = left_out.iter().find(|row| row["row"] == wrong).unwrap();
    assert_eq!(row["columns"]["label"], format!("m{wrong}"));
}

/// Contacts of three fingers on a bowl, and what parts the fingers.
fn glide(header: &str, between: &str, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let mut text = format!("{header}\n");
    for finger in 0..3 {
        for contact in 0..8 {
            let [x, y] = [f64::from(contact), 10.0 * finger as f64];
            text += &row(finger, [x, y, 0.01 * (x * x + y * y)]);
            text.push('\n');
        }
        text += between;
    }
    text
}

#[test]
fn fingers_that_are_not_named() {
    let estimate = |contents: String| {
        told(
            &desk(contents),
            "\"$palpate\" estimate glide r.csv --method two-pass --inter-finger-distance 10",
        )
    };
    let numbers = |[x, y, z]: [f64; 3]| format!("{x},{y},{z}");
    let named = estimate(glide("finger,x_mm,y_mm,z_mm", "", |finger, place| {
        format!("{finger},{}", numbers(place))
    }));
    assert_eq!((&named["fingers"], warnings(&named).len()), (&3.into(), 0));
    let jumps = estimate(glide("x_mm,y_mm,z_mm", "", |_, place| numbers(place)));
    let blanks = estimate(glide("x_mm,y_mm,z_mm", "\n  \n", |_, place| numbers(place)));
    let empty_rows = estimate(glide("x_mm,y_mm,z_mm", ",,\n", |_, place| numbers(place)));
    for (found, words) in [
        (&jumps, "3 fingers are told by steps of at least"),
        (&blanks, "blank lines part 3 fingers"),
        (&empty_rows, "blank lines part 3 fingers"),
    ] {
        assert_eq!(found["fingers"], 3);
        assert_eq!(found["mean_curvature"], named["mean_curvature"]);
        assert!(warnings(found)[0].contains(words), "{found}");
    }
    // One finger that goes steadily is one.
    let one = estimate(glide("x_mm,y_mm,z_mm", "", |finger, [x, y, z]| {
        numbers([if finger == 1 { 7.0 - x } else { x }, 0.1 * y, z])
    }));
    assert_eq!(one["fingers"], 1);
    assert!(
        warnings(&one)[0].contains("all contacts count as of one finger"),
        "{one}"
    );
    // Blank lines mean nothing beside a column.
    let both = estimate(glide("finger,x_mm,y_mm,z_mm", "\n", |_, place| {
        format!("7,{}", numbers(place))
    }));
    assert_eq!((&both["fingers"], warnings(&both).len()), (&1.into(), 0));
}

#[test]
fn series_of_probes_that_are_not_named() {
    let header = "t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm\n";
    let [one, other] = ["0,0,0,0,0\n1,0,-0.3,2,0\n", "0,0,0,0,0\n1,0.3,0,0,2\n"];
    let later = other
        .replace("0,0,0,0,0", "5,0,0,0,0")
        .replace("1,0.3", "6,0.3");
    for text in [
        format!("{header}{one}{other}"),
        format!("{header}{one}\n{later}"),
    ] {
        let found = rolls(&text, "");
        assert_eq!(found["probes"], 2, "{text}");
        assert_close(mean_curvature(&found), 0.05, 1e-12);
        assert!(warnings(&found)[0].contains("2 are told"), "{found}");
    }
}

#[test]
fn names_in_a_study() {
    let study = |columns: &str| {
        format!(
            "name = \"s\"\nlength_unit = \"mm\"\n{columns}\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 10.0 }}\nobject = {{ kind = \"sphere\", radius = 30.0 }}\nmotion = {{ rate_rad_per_s = 0.5, duration_s = 1.0 }}\n"
        )
    };
    let desk = desk(
        ROLLS
            .replace("shift_u_mm", "U (mm)")
            .replace("shift_v_mm", "V (mm)"),
    );
    desk.write(
        "s.toml",
        study("columns = { shift_u = \"U (mm)\", shift_v = \"W (mm)\" }"),
    );
    let found = told(
        &desk,
        "\"$palpate\" estimate roll r.csv --like s.toml --columns 'shift_v_mm=V (mm)'",
    );
    assert_close(
        mean_curvature(&found),
        mean_curvature(&rolls(ROLLS, "")),
        1e-12,
    );
    let said = desk.palpate("estimate roll r.csv --like s.toml").said(1);
    assert!(said.contains("`shift_v` is said to be `W (mm)`"), "{said}");
    desk.palpate("check s.toml").printed();
    desk.write("s.toml", study("columns = { shift = \"U\" }"));
    let said = desk.palpate("check s.toml").said(2);
    assert!(
        said.contains(
            "s.toml:3:21: columns.shift: `shift` is no column of these readings; known: probe"
        ),
        "{said}"
    );
}

#[test]
fn arguments() {
    let desk = desk(ROLLS);
    for (options, words) in [
        ("--columns shift_u", "`shift_u` is no pair of names"),
        ("--columns =u", "is no pair of names"),
        ("--columns ''", "names no column"),
        ("--columns shift_u=a,shift_u=b", "`shift_u` stands twice"),
        ("--delimiter dot", "must be comma, semicolon or tab"),
        ("--decimal dot", "must be point or comma"),
    ] {
        let line = format!("\"$palpate\" estimate roll r.csv --probe-radius 10 {options}");
        let said = desk.shell(&line).said(2);
        assert!(said.contains(words), "{options}: {said}");
    }
    let empty = desk
        .shell("\"$palpate\" estimate roll - --probe-radius 10 < /dev/null")
        .said(1);
    assert_eq!(
        empty,
        "error: standard input: is empty; a header and one row per reading are needed\n"
    );
    desk.write("rest.png", "");
    desk.palpate("sensor calibrate rest.png rest.png --normal 1 --columns series=a --out c.toml")
        .fails(2, "--columns is of use only to tables");
}

#[test]
fn known_displacements_of_another_program() {
    let header = "normal_displacement_mm,hue_turns";
    let rows = [(1.0, 0.02), (2.0, 0.05), (3.0, 0.07)];
    let plain: String = rows
        .iter()
        .map(|(moved, hue)| format!("{moved},{hue}\n"))
        .collect();
    let foreign: String = rows
        .iter()
        .map(|(moved, hue)| format!("{};{};x\n", moved / 1e3, hue * 360.0).replace('.', ","))
        .collect();
    let desk = desk(format!("{header}\n{plain}"));
    desk.write("f.csv", format!("Depth [m];Hue [deg];operator\n{foreign}"));
    desk.palpate("sensor calibrate r.csv --out a.toml")
        .printed();
    let line = "\"$palpate\" sensor calibrate - --columns 'normal_displacement=Depth [m],hue=Hue [deg]' --length-unit mm --out b.toml < f.csv";
    assert_eq!(desk.shell(line).status, Some(0));
    let slope = |name: &str| -> f64 {
        let text = desk.read(name);
        let line = text
            .lines()
            .find(|line| line.starts_with("slope = "))
            .unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    assert_close(slope("b.toml"), slope("a.toml"), 1e-9);
}

/// The README's way from a foreign table to a curvature: a message, and what that says to type.
#[test]
fn the_second_command_tells_the_curvature() {
    const NAME: &str = "examples/foreign-glide.csv";
    const README: &str = include_str!("../../../../README.md");
    let desk = Desk::new();
    std::fs::create_dir(desk.path("examples")).unwrap();
    desk.write(NAME, include_str!("../../../../examples/foreign-glide.csv"));
    let said = desk.palpate(&format!("estimate glide {NAME}")).said(1);
    assert!(README.contains(&said), "{said}");
    let typed = said.trim_end().split("write ").nth(1).unwrap();
    let line = format!("palpate estimate glide {NAME} {typed} --length-unit mm");
    assert!(README.contains(&format!("\n{line}\n")), "{line}");
    let found = told(&desk, &line.replacen("palpate", "\"$palpate\"", 1));
    // The same contacts as examples/glide-readings.csv, without normals: a mug of radius 40 mm.
    let (value, std) = (
        mean_curvature(&found),
        found["mean_curvature"]["std"].as_f64().unwrap(),
    );
    assert!((value - 1.0 / 80.0).abs() < 2.0 * std, "{value} +- {std}");
}
