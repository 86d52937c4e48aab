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
    let error = roll(in_degrees, Form::default()).unwrap_err();
    assert!(error.contains("in rad although"), "{error}");
}

/// A number such as `1,234` is ambiguous: 1.234 or 1234. Its decimal sign follows from the other numbers of the table,
/// or from the setting `decimal`.
#[test]
fn unambiguous_numbers_decide_the_decimal_sign() {
    let table =
        |rows: &str| format!("rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n{rows}\n");
    let decimal = Form {
        decimal: Some(Decimal::Comma),
        ..Form::default()
    };
    let point = roll(table("0;-1;1.5;0"), decimal.clone()).unwrap_err();
    assert!(point.contains("`1.5` is not a number with a decimal comma"));
    for (rows, form) in [
        ("0;-0,3;1,234;0\n0,3;0;0;1,234", Form::default()),
        ("0;-1;1,234;0\n1;0;0;1,234", decimal),
    ] {
        let found = roll(table(rows), form).unwrap();
        assert_close(found["arc_length"]["value"].as_f64().unwrap(), 1.234, 1e-12);
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

const NO_ROLLS: &str = include_str!("tables/rolls.txt");
/// Tables with semicolons as delimiters that contain a wrong number. Each row has the format of `refuses`.
const DECIMALS: &str = include_str!("tables/decimals.txt");

const NO_GLIDES: &str = include_str!("tables/glides.txt");

const NO_PRESSES: &str = include_str!("tables/presses.txt");

#[test]
fn invalid_tables_are_refused_with_the_line() {
    refuses(|table, form| roll(table, form), ROLLS, NO_ROLLS);
    let decimals = "rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n0;-1;1.5;0\n1;0;0;2.5\n";
    refuses(|table, form| roll(table, form), decimals, DECIMALS);
    refuses(|table, form| glide(table, form), "", NO_GLIDES);
    refuses(|table, form| press(table, form), "", NO_PRESSES);
    for (bytes, words) in [
        (&b"probe\n\xb5m"[..], "byte 0xb5 in line 2"),
        (b"\xff\xfep\0r", "has bytes 0, as text in UTF-16 has"),
    ] {
        let error = roll(bytes, Form::default()).unwrap_err();
        assert!(
            error.starts_with("r.csv:") && error.contains(words),
            "{error}"
        );
    }
    let deep = format!("{{\"a\":{}1{}}}\n", "[".repeat(200), "]".repeat(200));
    assert!(
        roll(deep, Form::default())
            .unwrap_err()
            .contains("recursion limit")
    );
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
