//! `palpate estimate roll` on bad readings and with bad arguments.

use super::desk::Desk;

const HEADER: &str = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm";
const SERIES: &str = "probe,t_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm";

/// Error message about a file of these bytes.
#[track_caller]
fn said(bytes: &[u8], options: &str) -> String {
    let desk = Desk::new();
    desk.write("r.csv", bytes);
    let said = desk
        .palpate(&format!("estimate roll r.csv --probe-radius 10 {options}"))
        .said(1);
    let said = said.strip_prefix("error: ").unwrap().trim_end();
    let (said, _) = said
        .split_once("; see `palpate explain ")
        .unwrap_or((said, ""));
    said.to_owned()
}

#[track_caller]
fn said_of(rows: &[&str]) -> String {
    said(format!("{}\n", rows.join("\n")).as_bytes(), "")
}

#[test]
fn columns() {
    let columns = "the columns must be probe,rotation_x_rad,rotation_y_rad,shift_u,shift_v";
    assert_eq!(
        said_of(&[
            "probe,rotation_x_rad,rotation_y_rad,shift_u_mm",
            "0,0,-0.5,4"
        ]),
        format!(
            "r.csv:1: no column `shift_v`; the file has `probe`, `rotation_x_rad`, `rotation_y_rad`, `shift_u_mm`; {columns}"
        )
    );
    assert_eq!(
        said_of(&[&format!("{HEADER},shift_u"), "0,0,-0.5,4,0,4"]),
        "r.csv:1: column `shift_u` stands twice, as `shift_u_mm` and as `shift_u`; say which: --columns \
         'shift_u=shift_u_mm'"
    );
    assert_eq!(
        said_of(&["", "probe,rotation_x_rad_mm,rotation_y_rad,shift_u,shift_v"]),
        format!(
            "r.csv:2: no column `rotation_x_rad`; the file has `probe`, `rotation_x_rad_mm`, `rotation_y_rad`, `shift_u`, \
             `shift_v`; {columns}; write --columns 'rotation_x_rad=…', with the file's name for it at …"
        )
    );
    assert_eq!(
        said_of(&["0,0,-0.5,4,0", "1,0.5,0,0,4"]),
        "r.csv:1: no column `rotation_x_rad`: the first line holds numbers; put the columns' names before it: \
         (echo rotation_x_rad,rotation_y_rad,shift_u,shift_v; cat FILE) > named.csv"
    );
    assert_eq!(
        said_of(&["probe,t_s,rotation_x_rad,rotation_y_rad,shift_u_mm,pad_v_mm"]),
        "r.csv:1: no column `pad_u`; the file has `probe`, `t_s`, `rotation_x_rad`, `rotation_y_rad`, `shift_u_mm`, \
         `pad_v_mm`; the columns must be probe,t_s,rotation_x_rad,rotation_y_rad,pad_u,pad_v; write --columns \
         'pad_u=…', with the file's name for it at …"
    );
}

#[test]
fn units() {
    let mixed = HEADER.replace("v_mm", "v_cm");
    assert_eq!(
        said_of(&[&mixed, "0,0,-0.5,4,0"]),
        "r.csv:1: lengths are in mm and in cm; one unit is needed: --length-unit mm converts them"
    );
    let readings = format!("{HEADER}\n0,0,-0.5,4,0\n1,0.5,0,0,4\n");
    assert_eq!(
        said(readings.as_bytes(), "--length-unit unit"),
        "r.csv:1: the header says mm, --length-unit says unit, and neither is a multiple of the other"
    );
}

#[test]
fn fields() {
    for (row, message) in [
        ("0,0,-0.5,4", "4 fields; the header has 5"),
        (
            "0,0,-0.5,4,0,0",
            "6 fields; the header has 5; if its commas are decimal ones, separate fields by ; or tabs",
        ),
        (
            "0,0,-0.5,four,0",
            "column `shift_u_mm`: `four` is not a number",
        ),
        (
            "0,0,-0.5,4 mm,0",
            "column `shift_u_mm`: `4 mm` is not a number",
        ),
        ("0,0,-0.5,,0", "column `shift_u_mm`: is empty"),
        (
            "0,0,NaN,4,0",
            "column `rotation_y_rad`: must be finite, is NaN; leave such rows out, as by grep -vi nan",
        ),
        (
            "0,0,-inf,4,0",
            "column `rotation_y_rad`: must be finite, is -inf",
        ),
        (
            "0,0,-0.5,1e999,0",
            "column `shift_u_mm`: must be finite, is 1e999",
        ),
        (
            "0.5,0,-0.5,4,0",
            "column `probe`: must be a whole number from 0, is 0.5",
        ),
        (
            "-1,0,-0.5,4,0",
            "column `probe`: must be a whole number from 0, is -1",
        ),
        ("7,0,-0.5,4,0", "probe 7 stands twice"),
    ] {
        assert_eq!(
            said_of(&[HEADER, "7,0.5,0,0,4", row]),
            format!("r.csv:3: {message}")
        );
    }
}

/// The line is the editor's, whatever ends lines and however many are blank.
#[test]
fn lines_are_counted() {
    for end in ["\n", "\r\n"] {
        let text = ["", HEADER, "0,0,-0.5,4,0", "", "", "1,0.5,x,0,4"].join(end);
        assert_eq!(
            said(format!("\u{feff}{text}{end}").as_bytes(), ""),
            "r.csv:6: column `rotation_y_rad`: `x` is not a number"
        );
    }
}

#[test]
fn time() {
    assert_eq!(
        said_of(&[
            SERIES,
            "0,0,0,0,0,0",
            "1,9,0,0,0,0",
            "0,1,0,-0.5,4,0",
            "0,0.5,0,-0.6,5,0"
        ]),
        "r.csv:5: column `t_s`: probe 0 goes from 1 s back to 0.5 s"
    );
    assert_eq!(
        said_of(&[SERIES, "0,1,0,0,0,0", "0,1,0,-0.5,4,0"]),
        "r.csv:3: column `t_s`: probe 0 goes from 1 s back to 1 s"
    );
}

#[test]
fn files() {
    let empty = "r.csv: is empty; a header and one row per reading are needed";
    for text in ["", "\n \n", "\u{feff}"] {
        assert_eq!(said(text.as_bytes(), ""), empty, "{text:?}");
    }
    assert_eq!(said_of(&[HEADER]), "r.csv: has a header but no readings");
    assert_eq!(
        said(b"probe\n\xb5m", ""),
        "r.csv: is not UTF-8 text: byte 0xb5 in line 2; save it as UTF-8, as by iconv -f latin1 -t utf-8 r.csv > utf-8.csv"
    );
    for bytes in [&b"\xff\xfep\0r"[..], b"\xfe\xff\xd8\0"] {
        assert_eq!(
            said(bytes, ""),
            "r.csv: is not UTF-8 text, nor UTF-16, whose byte order mark it has"
        );
    }
    assert!(said(b"\0\0\0\0", "").starts_with("r.csv:1: no columns `rotation_x_rad`"));
    let desk = Desk::new();
    for (path, message) in [
        ("none.csv", "none.csv: no such file"),
        (".", ".: is a directory, not a file"),
    ] {
        let said = desk
            .palpate(&format!("estimate roll {path} --probe-radius 10"))
            .said(1);
        assert_eq!(said, format!("error: {message}\n"));
    }
}

#[test]
fn too_few_probes_or_all_parallel() {
    assert_eq!(
        said_of(&[HEADER, "0,0,-0.5,4,0"]),
        "r.csv: 1 probe(s); at least 2 in different directions are needed"
    );
    let parallel = said_of(&[HEADER, "0,0,-0.5,4,0", "1,0,0.5,-4,0", "2,0,-0.2,1.6,0"]);
    assert!(
        parallel.starts_with("r.csv: the 3 probes do not span the tangent plane"),
        "{parallel}"
    );
    let still = said_of(&[HEADER, "0,0,0,0,0", "1,0,0,0,0"]);
    assert!(still.contains("do not span the tangent plane"), "{still}");
}

#[test]
fn readings_that_no_roll_gives() {
    let backwards = said_of(&[HEADER, "0,0,-0.5,-4,0", "1,0.5,0,0,4"]);
    assert!(backwards.contains("not a rolling contact"), "{backwards}");
    let far = said_of(&[HEADER, "3,0,-0.5,4,0", "9,0.5,0,0,40"]);
    assert!(
        far.starts_with("r.csv: probe 9: a shift of 40 mm passes half way round the probe (31.4"),
        "{far}"
    );
}

/// The contact stands still along u, however far the probes roll there.
#[test]
fn an_edge_is_too_sharp_to_resolve() {
    let readings = format!("{HEADER}\n0,0,-0.5,0,0\n1,0.5,0,0,4\n2,0,0.5,0,0\n");
    let bounded = said(readings.as_bytes(), "--pitch 1");
    assert!(
        bounded.starts_with("r.csv: at 0.0 degrees from u"),
        "{bounded}"
    );
    let radius = bounded.split("radius below ").nth(1).expect("a bound");
    let (radius, unit) = radius.split_once(' ').unwrap();
    assert!(radius.parse::<f64>().unwrap() < 10.0);
    assert_eq!(unit, "mm");
    let unbounded = said(readings.as_bytes(), "");
    assert!(unbounded.contains("did not move"), "{unbounded}");
    assert!(!unbounded.contains("radius below"), "{unbounded}");
}

#[test]
fn arguments() {
    let desk = Desk::new();
    desk.write("r.csv", format!("{HEADER}\n0,0,-0.5,4,0\n1,0.5,0,0,4\n"));
    for (arguments, words) in [
        ("", "--probe-radius"),
        ("--probe-radius 0", "must be finite and > 0, is 0"),
        ("--probe-radius -10", "must be finite and > 0, is -10"),
        ("--probe-radius nan", "must be finite and > 0, is nan"),
        ("--probe-radius inf", "must be finite and > 0, is inf"),
        ("--probe-radius ten", "'ten'"),
        (
            "--probe-radius 10 --pitch 0",
            "must be finite and > 0, is 0",
        ),
        (
            "--probe-radius 10 --pitch -1",
            "must be finite and > 0, is -1",
        ),
        ("--probe-radius 10 --method magic", "'magic'"),
        (
            "--probe-radius 10 --length-unit ft",
            "must be one of m, cm, mm, um, unit",
        ),
    ] {
        let said = desk
            .palpate(&format!("estimate roll r.csv {arguments}"))
            .said(2);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    desk.palpate("estimate walk r.csv").fails(2, "walk");
}
