//! Files and texts: encodings, line ends, and excerpts of odd lines.

use super::{BASE, edited, message};
use palpate_study::config::{load, parse};

#[test]
fn a_byte_order_mark_and_crlf_change_nothing() {
    let plain = parse("study.toml", BASE).unwrap();
    let windows = format!("\u{feff}{}", BASE.replace('\n', "\r\n"));
    let same = parse("study.toml", &windows).unwrap();
    assert!(same.cells().eq(plain.cells()));
    assert_eq!(
        message(&windows.replace("5.0", "-5.0")),
        message(&BASE.replace("5.0", "-5.0")),
    );
}

#[test]
fn the_caret_stands_under_its_column() {
    assert_eq!(
        message(
            &edited("object = {", "object\t=\t{")
                .replace(r#"kind = "sphere", radius = 5.0"#, r#"kind = "Größe→∞""#)
        ),
        "study.toml:7:19: scene.object.kind: unknown kind \"Größe→∞\" (known: sphere, dish, plane, cylinder, \
         ellipsoid, torus, paraboloid, saddle, height-field)\n  |\n\
         7 | object\t=\t{ kind = \"Größe→∞\" }\n  |       \t \t         ^^^^^^^^^"
    );
}

#[test]
fn long_lines_are_cut_around_the_caret() {
    let count =
        |range: std::ops::Range<u32>| range.map(|value| format!("{value}, ")).collect::<String>();
    let list = format!("[{}-1, {}]", count(1..999), count(1000..2000));
    let text = format!("{BASE}[[sweep]]\npath = \"scene.probe.radius\"\nvalues = {list}\n");
    let message = message(&text);
    let lines: Vec<&str> = message.lines().collect();
    assert!(
        lines.iter().all(|line| line.chars().count() < 140),
        "{message}"
    );
    let caret = lines[3].chars().position(|c| c == '^').unwrap();
    let shown: String = lines[2].chars().skip(caret).take(2).collect();
    assert_eq!(shown, "-1", "{message}");
}

#[test]
fn an_error_at_the_end_of_the_text_is_shown() {
    assert_eq!(
        message("name = "),
        "study.toml:1:8: string values must be quoted, expected literal string\n  |\n1 | name = \n  |        ^"
    );
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let show = |name: &str| {
        let error = load(&folder.path().join(name)).unwrap_err().to_string();
        error.replace(folder.path().to_str().unwrap(), "DIR")
    };
    assert_eq!(show(""), "DIR/: is a directory, not a config");
    assert_eq!(show("absent.toml"), "DIR/absent.toml: no such file");
    std::fs::write(
        folder.path().join("latin1.toml"),
        b"name = \"a\"\ntitle = \"gr\xf6\xdfe\"\n",
    )
    .unwrap();
    assert_eq!(
        show("latin1.toml"),
        "DIR/latin1.toml: is not UTF-8: byte 0xf6 in line 2"
    );
}

#[test]
fn a_file_is_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("study.toml");
    std::fs::write(&path, BASE).unwrap();
    assert_eq!(load(&path).unwrap().config.name, "a-study");
    std::fs::write(&path, BASE.replace("a-study", "A")).unwrap();
    let error = load(&path).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with(&format!("{}:1:8: name: ", path.display())),
        "{error}"
    );
}
