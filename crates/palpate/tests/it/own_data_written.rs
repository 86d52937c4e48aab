//! Recorded readings in the forms in which other programs write tables: delimiters, decimal signs, encodings, JSON.

use super::desk::assert_close;
use super::foreign::{ROLLS, desk, mean_curvature, refused, rolls, told};

/// Rolls as JSON, one object per line.
fn as_json(table: &str) -> String {
    let mut lines = table.lines().map(|line| line.split(','));
    let names: Vec<&str> = lines.next().unwrap().collect();
    lines
        .map(|fields| {
            let pairs = names.iter().zip(fields);
            let pairs: Vec<String> = pairs
                .map(|(name, field)| format!("\"{name}\": {field}"))
                .collect();
            format!("{{{}}}\n", pairs.join(", "))
        })
        .collect()
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let units = format!("\u{feff}{text}");
    units.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn the_writing_of_a_table_does_not_matter() {
    let expected = rolls(ROLLS, "");
    assert_close(mean_curvature(&expected), 0.05, 0.1);
    let semicolons = ROLLS.replace(',', ";");
    let commas = semicolons.replace('.', ",");
    for (what, contents) in [
        ("semicolons", semicolons.clone().into_bytes()),
        ("decimal commas", commas.clone().into_bytes()),
        ("tabs", ROLLS.replace(',', "\t").into_bytes()),
        (
            "tabs and decimal commas",
            commas.replace(';', "\t").into_bytes(),
        ),
        ("CRLF", ROLLS.replace('\n', "\r\n").into_bytes()),
        ("CR", ROLLS.replace('\n', "\r").into_bytes()),
        (
            "no end of the last line",
            ROLLS.trim_end().as_bytes().to_vec(),
        ),
        (
            "quoted",
            ROLLS
                .replace(',', "\",\"")
                .replace('\n', "\"\n\"")
                .trim_end_matches('"')
                .replacen("probe", "\"probe", 1)
                .into_bytes(),
        ),
        ("UTF-8 with a mark", format!("\u{feff}{ROLLS}").into_bytes()),
        ("UTF-16, low byte first", utf16(ROLLS, u16::to_le_bytes)),
        ("UTF-16, high byte first", utf16(ROLLS, u16::to_be_bytes)),
        ("JSON", as_json(ROLLS).into_bytes()),
        (
            "JSON and CRLF",
            as_json(ROLLS).replace('\n', "\r\n").into_bytes(),
        ),
        (
            "capitals and spaces",
            ROLLS.replace("shift_u_mm", " Shift U [mm] ").into_bytes(),
        ),
        (
            "parentheses",
            ROLLS.replace("shift_v_mm", "shift_v(mm)").into_bytes(),
        ),
    ] {
        assert_eq!(rolls(contents, ""), expected, "{what}");
    }
    assert_eq!(rolls(&commas, "--delimiter ';' --decimal ,"), expected);
    assert_eq!(
        rolls(&commas, "--delimiter semicolon --decimal comma"),
        expected
    );
    let stdin = "\"$palpate\" estimate roll - --probe-radius 10 < r.csv";
    assert_eq!(told(&desk(ROLLS), stdin), expected);
    assert_eq!(told(&desk(as_json(ROLLS)), stdin), expected);
}

#[test]
fn what_may_be_two_things_is_told() {
    let table =
        |rows: &str| format!("rotation_x_rad;rotation_y_rad;shift_u_mm;shift_v_mm\n{rows}\n");
    for (contents, options, words) in [
        (
            table("0;-1;1,234;0\n1;0;0;2,345"),
            "",
            "r.csv:2: column `shift_u_mm`: `1,234` may be 1.234 or 1234",
        ),
        (
            table("0;-1,5;1.5;0"),
            "",
            "write all numbers with one decimal sign",
        ),
        (table("0;-1;1,234.5;0"), "", "separator of thousands"),
        (
            table("0;-1;1,234,567;0\n0;0,5;1;1"),
            "",
            "`1,234,567` is not a number",
        ),
        (
            table("0;-1;1.5;0"),
            "--decimal comma",
            "`1.5` is not a number with a decimal comma",
        ),
        (
            ROLLS.replace("2.125", "2,125"),
            "",
            "if its commas are decimal ones",
        ),
        (
            ROLLS.replace("shift_v", "SHIFT_U"),
            "",
            "`shift_u` stands twice, as `shift_u_mm` and as `SHIFT_U_mm`",
        ),
        (
            ROLLS.replace("shift_u_mm", "shift_u_mm [cm]"),
            "",
            "`cm` is none of its units",
        ),
        (
            ROLLS.replace("shift_u_mm", "shift_u [furlong]"),
            "",
            "`furlong` is none of its units (m, cm, mm, um, nm, in)",
        ),
        (
            ROLLS.replace("shift_u_mm", "shift_u"),
            "--length-unit m",
            "column `shift_u` states no unit and others are in mm",
        ),
        (
            ROLLS.replace("shift_u_mm", "plate_in"),
            "--columns shift_u=plate_in",
            "may be in inches",
        ),
        (
            ROLLS.replace("shift_u_mm", "u [cm]"),
            "--columns 'shift_u_mm=u [cm]'",
            "states another unit",
        ),
        (
            ROLLS.replace("rotation_x_rad", "rx"),
            "--columns rotation_x=rx",
            "`rx` states no unit (rad, mrad, deg)",
        ),
        (
            ROLLS.replace("_mm", ""),
            "--columns shift_u=Shift",
            "`shift_u` is said to be `Shift`, which is no column",
        ),
        (
            ROLLS.to_owned(),
            "--columns x=probe",
            "`x` is no column of these readings; known: probe, rotation_x_rad",
        ),
        (
            ROLLS.to_owned(),
            "--columns shift_u=probe,shift_v=probe",
            "are both `probe`",
        ),
        (
            "a;b,c\n1;2,3\n".to_owned(),
            "",
            "separated by semicolon or comma; say which: --delimiter semicolon",
        ),
        (
            ROLLS
                .replace("shift_v_mm", "shift_v_mm,pad_u,pad_v,t_s")
                .replace('\n', ",1,1,1\n")
                .replacen(",1,1,1\n", "\n", 1),
            "",
            "there are both shift_u, shift_v and pad_u, pad_v",
        ),
    ] {
        let said = refused(&contents, options);
        assert!(said.contains(words), "{contents}{options}: {said}");
    }
    // What decides is a number that can be but one thing.
    let found = rolls(table("0;-0,3;1,234;0\n0,3;0;0;1,234"), "");
    assert_close(found["arc_length"]["value"].as_f64().unwrap(), 1.234, 1e-12);
    let found = rolls(table("0;-1;1,234;0\n1;0;0;1,234"), "--decimal comma");
    assert_close(found["arc_length"]["value"].as_f64().unwrap(), 1.234, 1e-12);
    assert_eq!(found["warnings"].as_array().unwrap().len(), 1, "{found}");
}

#[test]
fn tables_of_json() {
    let nested = "{\"rot\": [0, -0.3], \"shift\": {\"u\": 2, \"v\": 0}, \"note\": null}\n\n\
                  {\"shift\": {\"v\": 2, \"u\": 0}, \"rot\": [0.3, 0]}\n";
    let found = rolls(
        nested,
        "--columns rotation_x_rad=rot.0,rotation_y_rad=rot.1,shift_u=shift.u,shift_v=shift.v --length-unit mm",
    );
    assert_close(mean_curvature(&found), 0.05, 1e-12);
    for (contents, words) in [
        (
            "[{\"probe\": 1}]",
            "an object per line is needed, as `jq -c '.[]'` writes",
        ),
        (
            "[\n{\"probe\": 1}\n]\n",
            "r.csv:1: is no JSON object of one line",
        ),
        (
            "{\"probe\": 1,\n\"x\": 2}\n",
            "r.csv:1: is no JSON object of one line",
        ),
        ("{}\n", "the first object has no keys"),
        (
            "{\"probe\": 1, \"probe\": 2}\n",
            "no columns `rotation_x_rad`",
        ),
        (
            "{\"a.b\": 1, \"a\": {\"b\": 2}}\n",
            "the file has `a.b`, `a.b`",
        ),
        (
            "{\"rotation_x_rad\":1,\"rotation_y_rad\":1,\"shift_u\":1,\"shift_v\":1}\n{\"shift_u\":1}\n",
            "r.csv:2: column `rotation_x_rad`: is empty",
        ),
        (
            "{\"rotation_x_rad\":1,\"rotation_y_rad\":1,\"shift_u\":1,\"shift_v\":true}\n",
            "`true` is not a number",
        ),
        (
            "{\"rotation_x_rad\":1,\"rotation_y_rad\":1,\"shift_u\":1,\"shift_v\":1e999}\n",
            "r.csv:1: is no JSON object of one line: number out of range",
        ),
        (
            "{\"rotation_x_rad\":1,\"rotation_y_rad\":1,\"shift_u\":1,\"shift_v\":NaN}\n",
            "r.csv:1: is no JSON",
        ),
    ] {
        let said = refused(contents, "");
        assert!(said.contains(words), "{contents}: {said}");
    }
    let deep = format!("{{\"a\":{}1{}}}\n", "[".repeat(200), "]".repeat(200));
    assert!(refused(deep, "").contains("recursion limit"));
    let wide: Vec<String> = (0..1001).map(|key| format!("\"{key}\":0")).collect();
    let said = refused(format!("{{{}}}\n", wide.join(",")), "");
    assert!(
        said.contains("has 1001 columns; at most 1000 are read"),
        "{said}"
    );
}

/// Lines before the first row: comments, a line of Excel, a second line with units, a header in a comment.
#[test]
fn what_stands_before_the_rows() {
    let expected = mean_curvature(&rolls(ROLLS, ""));
    let (header, rows) = ROLLS.split_once('\n').unwrap();
    let bare = "probe,rotation_x,rotation_y,shift_u,shift_v";
    let semicolons = ROLLS.replace(',', ";");
    for (what, contents) in [
        (
            "comments",
            format!("# rig 3\n#\n# 2026-11-23, \"quoted\n\n{ROLLS}"),
        ),
        ("a header of NumPy", format!("# rig 3\n# {header}\n{rows}")),
        ("the delimiter of Excel", format!("sep=;\n{semicolons}")),
        ("units", format!("{bare}\n,rad,rad,mm,mm\n{rows}")),
        (
            "units in brackets",
            format!("{bare}\n-,[rad],[rad],[mm],(mm)\n{rows}"),
        ),
        (
            "units in both lines",
            format!(
                "probe,rotation_x (rad),rotation_y [rad],shift_u_mm,shift_v\n,rad,rad,mm,mm\n{rows}"
            ),
        ),
        (
            "units and comments",
            format!("# rig\n{bare}\n\n,rad,rad,mm,mm\n{rows}"),
        ),
        (
            "a delimiter at each end",
            ROLLS
                .replacen(header, "HEAD", 1)
                .replace('\n', ",\n")
                .replacen("HEAD,", header, 1),
        ),
    ] {
        let found = rolls(&contents, "");
        assert_close(mean_curvature(&found), expected, 1e-15);
        assert_eq!(found["mean_curvature"]["unit"], "1/mm", "{what}");
    }
    let degrees = format!("{bare}\n,deg,deg,mm,mm\n{rows}");
    let found = mean_curvature(&rolls(degrees, ""));
    assert!((found - expected).abs() > 0.01, "{found}");
    // Lines are those of the file, whatever stands before.
    let bad = format!("sep=,\n# rig\n\n{}", ROLLS.replace("-2\n", "x\n"));
    assert!(
        refused(&bad, "").starts_with("r.csv:8: column `shift_v_mm`: `x`"),
        "{}",
        refused(&bad, "")
    );
    let unlike =
        format!("probe,rotation_x [deg],rotation_y,shift_u,shift_v\n,rad,rad,mm,mm\n{rows}");
    assert_eq!(
        refused(unlike, ""),
        "r.csv:1: column `rotation_x [deg]` has the unit `rad` in the next line"
    );
    let words = format!("{header}\n,rad,rad,mm,furlong\n{rows}");
    assert!(refused(words, "").contains("r.csv:2: column `probe`: is empty"));
}

#[test]
fn names_of_probes_and_fingers() {
    let named = ["\n0,", "\n1,", "\n2,", "\n3,"]
        .iter()
        .zip(["\nnorth,", "\neast,", "\nsouth,", "\nwest,"])
        .fold(ROLLS.to_owned(), |text, (number, name)| {
            text.replacen(number, name, 1)
        });
    let expected = rolls(ROLLS, "");
    assert_eq!(rolls(named, ""), expected);
    let readings = include_str!("../../../../examples/glide-readings.csv");
    let named: Vec<String> = readings
        .lines()
        .map(|line| match line.split_once(',') {
            Some(("0", rest)) => format!("index,{rest}"),
            Some(("1", rest)) => format!("middle,{rest}"),
            Some(("2", rest)) => format!("ring,{rest}"),
            _ => line.to_owned(),
        })
        .collect();
    let line = "\"$palpate\" estimate glide r.csv --method quadric";
    let [one, other] = [readings.to_owned(), named.join("\n")].map(|text| told(&desk(text), line));
    assert_eq!(one, other);
    assert_eq!(one["fingers"], 3);
}

/// A table that cannot be read as it is: the message has the line that makes it readable.
#[test]
fn messages_have_the_line_to_type() {
    let spaces = ROLLS.replace(',', "  ");
    let said = refused(&spaces, "");
    let line = said.split_once("commas: ").map(|(_, line)| line).unwrap();
    let desk = desk(&spaces);
    desk.shell(line).printed();
    let read = "\"$palpate\" estimate roll commas.csv --probe-radius 10";
    assert_eq!(told(&desk, read), rolls(ROLLS, ""));

    let bare = ROLLS.split_once('\n').unwrap().1;
    let said = refused(bare, "");
    assert!(
        said.contains("(echo rotation_x_rad,rotation_y_rad,shift_u,shift_v; cat FILE) > named.csv"),
        "{said}"
    );

    let large = ROLLS
        .replace(',', ";")
        .replace("2.125", "2,125.0")
        .replace("mm", "um");
    let said = refused(&large, "");
    assert!(
        said.contains("write it without: tr -d , < r.csv > plain.csv"),
        "{said}"
    );

    let said = refused(ROLLS.replace("0.25", "nan"), "");
    assert!(
        said.contains("must be finite, is nan; leave such rows out, as by grep -vi nan"),
        "{said}"
    );

    let latin = [b"probe,note \xb5\n".as_slice(), b"0,1\n"].concat();
    let said = refused(latin, "");
    assert!(
        said.contains("iconv -f latin1 -t utf-8 r.csv > utf-8.csv"),
        "{said}"
    );

    let twice = ROLLS.replace("shift_v_mm", "shift_u_mm");
    let said = refused(twice, "");
    assert!(
        said.contains("column `shift_u` stands twice") && said.contains("rename one of them"),
        "{said}"
    );
}

/// The line that a message proposes makes the table readable, whatever the file calls its columns.
#[test]
fn proposed_names_are_those_of_the_axes() {
    let (_, rows) = ROLLS.split_once('\n').unwrap();
    for header in [
        "id,rx,ry,du [mm],dv [mm]",
        "trial,rot x (rad),rot y (rad),u_mm,v_mm",
        "n,Rotation.0,Rotation.1,Shift.0,Shift.1",
    ] {
        let table = format!("{header}\n{rows}");
        let said = refused(&table, "");
        let (_, columns) = said
            .split_once("write --columns '")
            .unwrap_or_else(|| panic!("{said}"));
        let columns = columns.split_once('\'').unwrap().0;
        assert!(!columns.contains('…'), "{header}: {said}");
        let found = rolls(&table, &format!("--columns '{columns}'"));
        assert_close(
            mean_curvature(&found),
            mean_curvature(&rolls(ROLLS, "")),
            1e-12,
        );
    }
    let places = "{\"normal\": [0, 0, 1], \"position\": [1, 2, 3]}\n";
    let line = "\"$palpate\" estimate glide r.csv";
    let said = desk(places).shell(line).said(1);
    assert!(
        said.contains("--columns 'x=position.0,y=position.1,z=position.2'"),
        "{said}"
    );
    let lists = "{\"d\": [1, 2, 3], \"p\": [1, 2, 3]}\n";
    let said = desk(lists).shell(line).said(1);
    assert!(said.contains("--columns 'x=p.0,y=p.1,z=p.2'"), "{said}");
    let said = desk("nx,ny,nz,px_mm,py_mm,pz_mm\n0,0,1,1,2,3\n")
        .shell(line)
        .said(1);
    assert!(
        said.contains("--columns 'x=px_mm,y=py_mm,z=pz_mm'"),
        "{said}"
    );
}
