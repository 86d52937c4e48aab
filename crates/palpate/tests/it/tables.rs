//! Tests tables that other programs wrote (names, units, delimiters, decimal signs, encodings, JSON), and invalid
//! files.

use palpate::config::LengthUnit;
use palpate::recorded::{Decimal, Delimiter, Form};
use serde_json::Value;

use super::desk::{Desk, SCENE, assert_close};
use super::readings::{
    GLIDE, ROLLS, glide, mean_curvature, named, press, refuses, roll, scaled, warnings,
};

/// Estimate from a table of rolls. The format of the table is detected, because no options state it.
#[track_caller]
fn rolls(contents: impl AsRef<[u8]>) -> Value {
    roll(contents, Form::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn as_json(table: &str) -> String {
    let mut lines = table.lines().map(|line| line.split(','));
    let names: Vec<&str> = lines.next().unwrap().collect();
    let object = |fields: std::str::Split<'_, char>| {
        let pairs = names.iter().zip(fields);
        let pairs: Vec<String> = pairs
            .map(|(name, field)| format!("\"{name}\": {field}"))
            .collect();
        format!("{{{}}}\n", pairs.join(", "))
    };
    lines.map(object).collect()
}

#[test]
fn delimiters_encodings_and_headers_do_not_change_the_estimate() {
    let expected = rolls(ROLLS);
    let semicolons = ROLLS.replace(',', ";");
    let commas = semicolons.replace('.', ",");
    let named_probes = ROLLS.replace("\n0,", "\nnorth,");
    let quoted = ROLLS.replace(',', "\",\"").replace('\n', "\"\n\"");
    let quoted = format!("\"{}", quoted.trim_end_matches('"'));
    for table in [
        semicolons,
        commas.clone(),
        ROLLS.replace(',', "\t"),
        commas.replace(';', "\t"),
        ROLLS.replace('\n', "\r\n"),
        ROLLS.replace('\n', "\r"),
        ROLLS.replace(',', " , "),
        ROLLS.trim_end().to_owned(),
        format!("\n\n{}\n  \n", ROLLS.replace('\n', "\n\n")),
        quoted,
        format!("\u{feff}{ROLLS}"),
        as_json(ROLLS),
        as_json(ROLLS).replace('\n', "\r\n"),
        ROLLS.replace("shift_u_mm", " Shift U [mm] "),
        ROLLS.replace("shift_v_mm", "shift_v(mm)"),
        named_probes,
        // This table has comments before the header, and a row of units after the header.
        format!("# rig 3\n#\n# 2026-11-23, \"quoted\n\n{ROLLS}"),
        format!("# rig 3\n# {ROLLS}"),
        format!("// rig 3\n% {}", ROLLS.replace("\n2,", "\n% turned\n2,")),
        ROLLS.replace(',', "|"),
        format!("sep=;\n{}", ROLLS.replace(',', ";")),
        ROLLS
            .replace("_rad", "")
            .replace("_mm", "")
            .replacen('\n', "\n,rad,rad,mm,mm\n", 1),
        ROLLS.replace("_rad", "").replace("_mm", "").replacen(
            '\n',
            "\n-,[rad],[rad],[mm],(mm)\n",
            1,
        ),
        ROLLS.replacen('\n', "\n,rad,rad,mm,mm\n", 1),
        ROLLS
            .replace(".25\n", ".25,\n")
            .replace("125\n", "125,\n")
            .replace("0\n", "0,\n"),
    ] {
        assert_eq!(rolls(&table), expected, "{table}");
    }
    let form = Form {
        delimiter: Some(Delimiter::Semicolon),
        decimal: Some(Decimal::Comma),
        ..Form::default()
    };
    assert_eq!(roll(&commas, form), Ok(expected.clone()));
    // Fingers may also have names.
    let fingers = GLIDE.replace("\n0,", "\nindex,").replace("\n1,", "\nring,");
    assert_eq!(
        glide(fingers, Form::default()),
        glide(GLIDE, Form::default())
    );
    let in_degrees = ROLLS.replace("_rad", "_deg");
    let found = rolls(&in_degrees)["warnings"].to_string();
    assert!(found.contains("in rad although"), "{found}");
}

/// A number such as `1,234` is ambiguous: 1.234 or 1234. Its decimal sign follows from the other numbers of the table,
/// or from the setting `decimal`.
#[test]
fn unambiguous_numbers_decide_the_decimal_sign() {
    let table =
        |rows: &str| format!("rotation_x_rad;rotation_y_rad;shift_u_nm;shift_v_nm\n{rows}\n");
    let form = |decimal| Form {
        decimal,
        length_unit: Some(LengthUnit::Um),
        ..Form::default()
    };
    let comma = form(Some(Decimal::Comma));
    let point = roll(table("0;-1;1.5;0"), comma.clone()).unwrap_err();
    assert!(point.contains("`1.5` is not a number with a decimal comma"));
    for (rows, form) in [
        ("0;-0,3;1234,5;0\n0,3;0;0;1234,5", form(None)),
        ("0;-0,3;1.234,5;0\n0,3;0;0;1.234,5", form(None)),
        ("0;-1;1.234,5;0\n1;0;0;1.234,5", comma),
        ("0;\u{2212}0.3;1,234.5;0\n0.3;0;0;1'234.5", form(None)),
    ] {
        let found = roll(table(rows), form).unwrap();
        assert_close(
            found["arc_length"]["value"].as_f64().unwrap(),
            1.2345,
            1e-12,
        );
        assert_eq!(warnings(&found).len(), 1);
    }
}

#[test]
fn units_come_from_the_header_or_the_option() {
    let with = |table: &str, length_unit: Option<LengthUnit>| {
        let form = Form {
            length_unit,
            ..Form::default()
        };
        roll(table, form)
    };
    let bare = ROLLS.replace("_mm", "");
    let unit = |table: &str, length_unit| {
        with(table, length_unit).unwrap()["gaussian_curvature"]["unit"].clone()
    };
    assert_eq!(unit(ROLLS, Some(LengthUnit::Mm)), "1/mm^2");
    assert_eq!(unit(&bare, Some(LengthUnit::Um)), "1/um^2");
    assert_eq!(unit(&bare, None), "1/unit^2");
    // If only one column states a unit, all columns have this unit. Inches are converted to millimetres.
    assert_eq!(unit(&ROLLS.replace("v_mm", "v"), None), "1/mm^2");
    let inches =
        scaled(ROLLS, &[3, 4], 1.0 / 25.4).replace("u_mm,shift_v_mm", "u_in,shift_v [inch]");
    assert_close(
        mean_curvature(&rolls(&inches)),
        mean_curvature(&rolls(ROLLS)),
        1e-12,
    );
    assert!(
        with(ROLLS, Some(LengthUnit::Unit))
            .unwrap_err()
            .contains("neither is a multiple")
    );
    let one_bare = ROLLS.replace("u_mm", "u");
    assert!(
        with(&one_bare, Some(LengthUnit::M))
            .unwrap_err()
            .contains("states no unit")
    );
}

const NO_ROLLS: &str = r#"
2.125 => 2,125 | - | :2 | decimal signs
2.125 => 1e999 | - | :2 | column `shift_u_mm`: must be finite, is 1e999
2.125 => 12:00:01 | - | :2 | column `shift_u_mm`: `12:00:01` is a date or time; write seconds
0.3,0,-0.25 => 17.2,0,-0.25 | - | - | probe 1 turned by 17.2 rad, 80.4 times as far as on a plane
rotation_x_rad,rotation_y_rad => rotation_x_mrad,rotation_y_mrad | - | - | the contact moved 
0,0,-0.3 => 0.5,0,-0.3 | - | :2 | column `probe`: must be a whole number from 0
\n1, => \n\n\n0, | - | :5 | probe 0 occurs twice
,shift_v_mm => ,v | - | :1 | no column `shift_v`; the file has `probe`
mm\n0 => mm,shift_u\n0 | - | :1 | column `shift_u` occurs twice
shift_v => SHIFT_U | - | :1 | column `shift_u` occurs twice
v_mm => v_cm | - | :1 | lengths are in mm and in cm
shift_u_mm => shift_u_mm [cm] | - | :1 | states the unit `cm`, but its name ends with another unit
shift_u_mm => shift_u [furlong] | - | :1 | cannot have the unit `furlong`; allowed: m, cm, mm, um, nm, in
,shift_v_mm => ,shift_u_mm | - | :1 | rename one of them
shift_u_mm => plate_in | shift_u=plate_in | :1 | may be in inches
shift_u_mm => u [cm] | shift_u_mm=u [cm] | :1 | states another unit
rotation_x_rad => rx | rotation_x=rx | :1 | `rx` states no unit (rad, mrad, deg)
probe => probe | shift_u=Shift | :1 | which is no column
probe => probe | x=probe | - | `x` is no column of these readings
probe => probe | shift_u=probe,shift_v=probe | - | are both `probe`
probe, => probe,pad_u,pad_v,t_s, | - | :1 | several of shift_u, shift_v
rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm => rotation_x [deg],rotation_y,shift_u,shift_v\n,rad,rad,mm,mm | - | :1 | the unit `rad` in the next line
shift_v_mm => shift_v_mm\n,rad,rad,mm,furlong | - | :2 | column `probe`: is empty
shift_v_mm\n0,0,-0.3 => shift_v_mm\r\n\r\n0,0,x | - | :3 | column `rotation_y_rad`: `x` is not a number
probe,rotation_x_rad,rotation_y_rad => sep=,\n# rig\n\nprobe,rotation_x_rad,rotation_z_rad | - | :4 | no column `rotation_y_rad`
probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm => id,rx,ry,du [mm],dv [mm] | - | :1 | 'rotation_x_rad=rx,rotation_y_rad=ry,shift_u=du [mm],shift_v=dv [mm]'
probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm => trial,rot x (rad),rot y (rad),u_mm,v_mm | - | :1 | 'rotation_x=rot x (rad),rotation_y=rot y (rad),shift_u=u_mm,shift_v=v_mm,probe=trial'
shift_u_deg,q,rotation_x_rad,rotation_y_rad,shift_v\n1,2,3,4,5\n | - | :1 | setting `columns` assigns other names
a;b,c\n1;2,3\n | - | :1 | separated by semicolon or comma
0,0,-0.5,4,0\n1,0.5,0,0,4\n | - | :1 | holds numbers
probe,t_s,rotation_x_rad,rotation_y_rad,shift_u_mm,pad_v_mm\n | - | :1 | no column `pad_u`
probe,t_s,rotation_x_rad,rotation_y_rad,pad_u,pad_v\n0,1,0,0,0,0\n1,9,0,0,0,0\n0,1,0,-0.5,4,0\n | - | :4 | all rows of probe 0 have the same time
 \n | - | - | is empty
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n | - | - | no readings
probe,q0x,q0y,q0z,q0w,q1x,q1y,q1z,q1w,shift_u,shift_v\n | - | :1 | as two rows of a time series
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n0,0,-0.5,4,0\n | - | - | 1 probe(s)
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n0,0,0,0,0\n1,0,0,0,0\n | - | - | do not span
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n0,0,-0.5,-4,0\n1,0.5,0,0,4\n | - | - | not a rolling contact
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n3,0,-0.5,4,0\n9,0.5,0,0,40\n | - | - | probe 9: a shift of 40
probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v\n0,0,-0.5,0,0\n1,0.5,0,0,4\n2,0,0.5,0,0\n | - | - | from u the contact did not move
{"columns":["rotation_x_rad","rotation_y_rad","shift_u_mm","shift_v_mm"],"data":[[0,-0.5,4,0],[0.5,0,4]]}\n | - | :2 | 3 values for 4 columns
{"columns":["rotation_x_rad","rotation_y_rad","shift_u_mm","shift_u_mm"],"data":[[0,-0.5,4,0],[0.5,0,0,4]]}\n | - | :1 | column `shift_u_mm` occurs twice
[3] | - | :1 | a list of objects is needed, or an object per line
{"probe": 1,\n"x": 2}\n | - | :1 | is no JSON object: EOF
{"probe": 1,\n"a": [{"x": 1}, {"x": 1,\n"x": 2}]}\n | - | :2 | the key `x` occurs twice
{}\n | - | :1 | is empty; its keys must name the columns
{"a.b": 1, "a": {"b": 2}}\n | - | :1 | the file has `a.b`, `a.b`
{"rotation_x_rad":1,"rotation_y_rad":1,"shift_u":1,"shift_v":1}\n{"shift_u":1}\n | - | - | 1 probe(s)
{"rotation_x_rad":1,"rotation_y_rad":1,"shift_u":1,"shift_v":true}\n | - | :1 | `true` is not a number
{"rotation_x_rad":1,"rotation_y_rad":1,"shift_u":1,"shift_v":1e999}\n | - | :1 | must be finite
"#;
/// Tables with semicolons as delimiters that contain a wrong number. Each row has the format of `refuses`.
const DECIMALS: &str = r#"
rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n0;-1;1,234;0\n1;0;0;2,345\n | - | :2 | `1,234` may be 1234 or 1.234
-1 => -1,5 | - | :2 | one decimal sign
rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n0;-1;1.234;0\n1;0;0;345\n | - | :2 | `1.234` may be 1.234 or 1234
"#;

const NO_GLIDES: &str = r#"
finger,x_mm,y_mm\n0,1,2 | - | :1 | no column `z`
finger,x,y,z,normal_x,normal_y\n0,1,2,3,0,0\n | - | :1 | no column `normal_z`
Test 5, ball\nDate;2026\nx,y,z\n0,1,2\n | - | :1 | line 3 names columns: write # before the lines above it
x,y,z\nwidth,depth,height\n0,1,2\n | - | :2 | write # before a line without numbers
x_mm,y_mm,z_mm\nx_mm,y_mm,z_mm \n0,1,2\n | - | - | 1 contact(s) give 1 equation(s)
1,0,0,2,0,1,0,3,0,0,1,4\n1,0,0,5,0,1,0,6,0,0,1,7\n | - | :1 | 'x=3,y=7,z=11'
t,x,y,z,x.1,y.1\n0,1,2,3,4,5\n | - | :1 | finger `1` has no column `z`, but finger `0` has one
finger,x,y,z\n0,,1,2\n1,-,NA,nan\n | - | :2 | column `x`: `` is no number
finger,x,y,z\n0.5,1,2,3\n | - | :2 | column `finger`: must be a whole number
finger,x,y,z\n0,1,2,3\n | - | - | 1 contact(s) give 1 equation(s)
finger,x,y,z\n0,1,1,1\n0,2,2,2\n0,3,3,3\n0,4,4,4\n0,5,5,5\n0,6,6,6\n | - | - | on a line
"#;

const NO_PRESSES: &str = r#"
x_mm,normal_displacement_mm\n0,1\n | - | :1 | no column `y`
x0,y0,z0,x1,y1,z1\n0,1,2,3,4,5\n | - | :1 | the z at rest minus the z of the pressed marker
x,y,normal_displacement,tangential_x\n0,1,2,3\n | - | :1 | no column `tangential_y`
x0,y0,un,ux,uy\n0,1,2,3,4\n | - | :1 | 'x=x0,y=y0,normal_displacement=un,tangential_x=ux,tangential_y=uy'
radial_position,normal_displacement,y,x\n0,1,2,3\n | - | :1 | both places x, y and radial_position
x,y,normal_displacement,tangential_x,tangential_y\n0,0,0,0,NaN\n | - | :2 | column `tangential_y`
x,y,normal_displacement\n0,0,1\n1,1,1e200\n2,2,1\n3,1,1\n4,1,1\n | - | :3 | marker 1
x,y,normal_displacement\n0,0,0\n9,0,0\n0,9,0\n9,9,0\n4,4,0\n4,0,0\n | - | - | no contact
"#;

#[test]
fn invalid_tables_are_refused_with_the_line() {
    refuses(|table, form| roll(table, form), ROLLS, NO_ROLLS);
    let decimals = "rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n0;-1;1.5;0\n1;0;0;2.5\n";
    refuses(|table, form| roll(table, form), decimals, DECIMALS);
    refuses(|table, form| glide(table, form), "", NO_GLIDES);
    refuses(|table, form| press(table, form), "", NO_PRESSES);
    for (bytes, words) in [
        (&b"probe\n\xb5m"[..], "byte 0xb5 in line 2"),
        (b"\xff\xfep\0r", "has bytes 0, so it is UTF-16"),
    ] {
        let error = roll(bytes, Form::default()).unwrap_err();
        assert!(
            error.starts_with("r.csv:") && error.contains(words),
            "{error}"
        );
    }
    let deep = format!("{{\"a\":{}1{}}}\n", "[".repeat(200), "]".repeat(200));
    let error = roll(deep, Form::default()).unwrap_err();
    assert!(error.contains("more than 100 levels"), "{error}");
    let wide: Vec<String> = (0..1001).map(|key| format!("\"{key}\":0")).collect();
    let error = roll(format!("{{{}}}\n", wide.join(",")), Form::default()).unwrap_err();
    assert!(error.contains("1001 columns; at most 1000"), "{error}");
}

#[test]
fn the_form_renames_columns_and_converts_units() {
    let expected = rolls(ROLLS);
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
    for columns in [
        "rotation_x=Rot A (deg),rotation_y=rot b [MRAD],\"shift_u=U, raw [m]\",shift_v=V [in]",
        "rotation_x=Rot A,rotation_y=Rot B,\"shift_u=U, raw\",shift_v=V",
    ] {
        let form = named(columns);
        let said = roll(&foreign, form.clone()).unwrap_err();
        assert!(said.contains("lengths are in m and in in"), "{said}");
        let length_unit = Some(LengthUnit::Mm);
        let found = roll(
            &foreign,
            Form {
                length_unit,
                ..form
            },
        )
        .unwrap();
        assert_close(mean_curvature(&found), mean_curvature(&expected), 1e-12);
        assert_eq!(found["arc_length"]["unit"], "mm");
        assert!(warnings(&found)[0].contains("each of the 4 rows counts as a probe"));
    }
    // If a header contains no unit, the unit in palpate's column name is used.
    let bare = ROLLS.replace("shift_u_mm", "u").replace("shift_v_mm", "v");
    assert_eq!(
        roll(bare, named("shift_u_mm=u,shift_v_mm=v")),
        Ok(expected.clone())
    );
    let nested = "{\"rot\": [0, -0.3], \"shift\": {\"u\": 2, \"v\": 0}, \"note\": null}\n\n\
                  {\"shift\": {\"v\": 2, \"u\": 0}, \"rot\": [0.3, 0]}\n";
    let columns = "rotation_x_rad=rot.0,rotation_y_rad=rot.1,shift_u_mm=shift.u,shift_v_mm=shift.v";
    let found = roll(nested, named(columns)).unwrap();
    assert_close(mean_curvature(&found), 0.05, 1e-12);
}

/// The book has two commands for a table of another program: the first fails and proposes the second, and the second
/// prints the curvature.
#[test]
fn the_second_command_prints_the_curvature() {
    const NAME: &str = "examples/foreign-glide.csv";
    const PAGE: &str = include_str!("../../../../docs/recorded-data.md");
    let desk = Desk::new();
    std::fs::create_dir(desk.path("examples")).unwrap();
    desk.write(NAME, include_str!("../../../../examples/foreign-glide.csv"));
    let said = desk.palpate(&format!("estimate glide {NAME}")).said(1);
    assert!(PAGE.contains(&said), "{said}");
    let typed = said.trim_end().split("write ").nth(1).unwrap();
    let line = format!("palpate estimate glide {NAME} {typed} --length-unit mm");
    assert!(PAGE.contains(&format!("\n{line}\n")), "{line}");
    let printed = desk
        .shell(&line.replacen("palpate", "\"$palpate\"", 1))
        .printed();
    let found: Value = serde_json::from_str(&printed).unwrap();
    // The contacts are those of examples/glide-readings.csv, without normals: a mug of radius 40 mm.
    let std = found["mean_curvature"]["std"].as_f64().unwrap();
    assert!(
        (mean_curvature(&found) - 1.0 / 80.0).abs() < 2.0 * std,
        "{found}"
    );
}

#[test]
fn flags_and_studies_set_the_form_of_a_table() {
    let desk = Desk::new();
    let expected = mean_curvature(&rolls(ROLLS));
    let assert_same = |line: &str| {
        let line = format!("\"$palpate\" estimate roll --probe-radius 10 {line}");
        let found = serde_json::from_str(&desk.shell(&line).printed()).unwrap();
        assert_close(mean_curvature(&found), expected, 1e-12);
    };
    let commas = ROLLS.replace(',', ";").replace('.', ",");
    desk.write("r.csv", commas.replace("shift_u_mm", "U, raw (mm)"));
    let columns = "--columns '\"shift_u=U, raw (mm)\"'";
    assert_same(&format!("r.csv --delimiter ';' --decimal , {columns}"));
    assert_same(&format!(
        "- --delimiter semicolon --decimal comma {columns} < r.csv"
    ));
    desk.write("r.csv", ROLLS.replace(',', "  "));
    assert_same("r.csv");

    let named = "columns = { shift_u = \"U (mm)\", shift_v = \"W (mm)\" }\n";
    desk.write("s.toml", format!("{named}{SCENE}"));
    let foreign = ROLLS.replace("shift_u", "U").replace("shift_v", "V");
    desk.write("r.csv", foreign.replace("_mm", " (mm)"));
    assert_same("r.csv --like s.toml --columns 'shift_v_mm=V (mm)'");
    desk.palpate("estimate roll r.csv --like s.toml")
        .fails(1, "--columns assigns `W (mm)` to `shift_v`");
    let line = "\"$palpate\" estimate roll - --probe-radius 10";
    desk.shell(&format!("{line} --columns ''"))
        .fails(2, "names no column");
    desk.shell(&format!("{line} < /dev/null"))
        .fails(1, "standard input: is empty");
}

#[test]
fn additional_columns_are_kept_as_labels() {
    let rolled = ROLLS.replace("0,0.3,-2,0", "0,0.01,0,0");
    let noted = rolled
        .replace("shift_v_mm\n", "shift_v_mm,Force [N],note\n")
        .replace(",0.25\n", ",0.25,1,\n")
        .replace("2.125\n2", "2.125,2,\n2")
        .replace("0,0\n", "0,0,3,\"slow, \"\"so\"\"\"\n")
        .replace(",-2\n", ",-2,4,\n");
    let mut found = rolls(&noted);
    let probe = found["unresolved_probes"][0].as_object_mut().unwrap();
    let columns = probe.remove("columns").unwrap();
    assert_eq!(
        columns,
        serde_json::json!({ "Force [N]": "3", "note": "slow, \"so\"" })
    );
    // Except for `columns`, which was removed above, the answer is the same as for the table without the columns `Force
    // [N]` and `note`.
    assert_eq!(found, rolls(&rolled));
    // The message about an outlier contains the label of its row.
    let rows = super::readings::PRESS.lines().enumerate();
    let labelled = rows.map(|(number, line)| match number {
        0 => format!("{line},label\n"),
        30 => line.replacen(line.split(',').nth(2).unwrap(), "1.2", 1) + ",m30\n",
        _ => format!("{line},m{number}\n"),
    });
    let found = press(labelled.collect::<String>(), Form::default()).unwrap();
    let wrong = found["wrong_markers"].as_array().unwrap();
    let row = wrong.iter().find(|row| row["row"] == 30).unwrap();
    assert_eq!(row["columns"]["label"], "m30");

    let desk = Desk::new();
    let mut bowl = "finger,x_mm,y_mm,z_mm,class,only\n".to_owned();
    for contact in 0..36 {
        let [x, y] = [contact % 6, contact / 6].map(f64::from);
        let (finger, z) = (contact / 6, 0.02 * (x * x + y * y));
        let note = if contact == 7 { "here" } else { "" };
        bowl += &format!("{finger},{x},{y},{z},a{contact},{note}\n");
    }
    desk.write("r.csv", &bowl);
    desk.palpate("estimate glide r.csv --map at.csv --at-contacts")
        .printed();
    let map = desk.table("at.csv");
    assert_eq!(map.header.last().unwrap(), "only");
    assert_eq!((map.text(7, "only"), map.text(8, "only")), ("here", ""));
    assert_eq!(map.text(35, "readings_class"), "a35");
    assert_ne!(map.text(35, "class"), "a35");
    desk.palpate("estimate glide r.csv --map grid.csv")
        .printed();
    assert!(!desk.read("grid.csv").contains("readings_class"));
}

/// A table with the contacts of three fingers on a bowl. The text `between` is inserted after each finger.
fn three_fingers(header: &str, between: &str, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let mut text = format!("{header}\n");
    for finger in 0..3 {
        for contact in 0..8 {
            let [x, y] = [f64::from(contact), 10.0 * finger as f64];
            text += &format!("{}\n", row(finger, [x, y, 0.01 * (x * x + y * y)]));
        }
        text += between;
    }
    text
}

#[test]
fn fingers_and_probes_without_names_are_separated_by_jumps_or_blank_lines() {
    let estimate = |contents: &str| glide(contents, Form::default()).unwrap();
    let numbers = |[x, y, z]: [f64; 3]| format!("{x},{y},{z}");
    let places = "x_mm,y_mm,z_mm";
    let named = estimate(&three_fingers(
        "finger,x_mm,y_mm,z_mm",
        "",
        |finger, place| format!("{finger},{}", numbers(place)),
    ));
    // The only warning is that the bowl is assumed to be touched from above.
    assert_eq!((&named["fingers"], warnings(&named).len()), (&3.into(), 1));
    for (between, words) in [
        ("", ": 3 fingers; all other steps"),
        ("\n  \n", "separated by blank lines: 3 fingers"),
        (",,\n", "separated by blank lines: 3 fingers"),
    ] {
        let found = estimate(&three_fingers(places, between, |_, place| numbers(place)));
        assert_eq!(found["mean_curvature"], named["mean_curvature"]);
        assert!(
            found["fingers"] == 3 && warnings(&found).iter().any(|text| text.contains(words)),
            "{found}"
        );
    }
    // Contacts on a path without jumps count as the contacts of one finger. Blank lines are ignored if there is a
    // column `finger`.
    let one = estimate(&three_fingers(places, "", |finger, [x, y, z]| {
        numbers([if finger == 1 { 7.0 - x } else { x }, 0.1 * y, z])
    }));
    assert!(
        one["fingers"] == 1
            && warnings(&one)
                .iter()
                .any(|text| text.contains("one finger")),
        "{one}"
    );
    let both = estimate(&three_fingers("finger,x_mm,y_mm,z_mm", "\n", |_, place| {
        format!("7,{}", numbers(place))
    }));
    assert_eq!((&both["fingers"], warnings(&both).len()), (&1.into(), 1));

    let header = "t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm\n";
    let [one, other, later] = [
        "0,0,0,0,0\n1,0,-0.3,2,0\n",
        "0,0,0,0,0\n1,0.3,0,0,2\n",
        "\n5,0,0,0,0\n6,0.3,0,0,2\n",
    ];
    for second in [other, later] {
        let found = rolls(format!("{header}{one}{second}"));
        assert_eq!(found["probes"], 2);
        assert_close(mean_curvature(&found), 0.05, 1e-12);
        assert!(warnings(&found)[0].contains("separate 2 probes"), "{found}");
    }
}
