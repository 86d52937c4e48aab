//! Tests the columns of recorded readings: their names and units.

use std::collections::BTreeMap;

use palpate_study::config::LengthUnit;
use palpate_study::readings::{
    COLUMNS, ColumnUnit, Measure, check_names, columns_of, quaternion_part, spelt,
};

#[test]
fn factors_are_those_of_the_units() {
    let to_mm = |text: &str| Measure::Length.unit(text).unwrap().to(LengthUnit::Mm);
    for (text, factor) in [("m", 1e3), ("CM", 10.0), ("mm", 1.0), ("in", 25.4)] {
        assert_eq!(to_mm(text), Some(factor), "{text}");
    }
    for text in ["um", "\u{b5}m", "\u{3bc}m"] {
        assert_eq!(to_mm(text), Some(1e-3), "{text}");
    }
    assert!((to_mm("nm").unwrap() - 1e-6).abs() < 1e-21);
    assert_eq!(to_mm("unit"), None);
    let angle = |text: &str| Measure::Angle.unit(text).unwrap().to(LengthUnit::Unit);
    assert_eq!(angle("deg"), Some(1f64.to_radians()));
    assert_eq!(angle("\u{b0}"), angle("deg"));
    assert_eq!(Measure::Length.unit("deg"), None);
    assert_eq!(Measure::Angle.unit("mm"), None);
    assert_eq!(Measure::Length.unit("furlong"), None);
}

#[test]
fn names_have_units() {
    let [probe, angle, _, shift, _] = &COLUMNS.rolls;
    assert_eq!((angle.stem(), shift.stem()), ("rotation_x", "shift_u"));
    assert_eq!(shift.is_named("shift_u"), Some(None));
    let mm = ColumnUnit::Length(LengthUnit::Mm);
    assert_eq!(shift.is_named("shift_u_mm"), Some(Some(mm)));
    assert_eq!(shift.is_named("shift_u_deg"), None);
    assert_eq!(angle.is_named("rotation_x"), Some(None));
    assert!(angle.is_named("rotation_x_deg").is_some());
    assert_eq!(probe.is_named("probe_1"), None);
    let part = |name: &str| quaternion_part(name).map(|column| column.name);
    assert_eq!(part("qx"), Some("qx"));
    assert_eq!(part("field_pose_orientation_w"), Some("qw"));
    assert_eq!(
        [part("x"), part("q0"), part("rotation_x"), part("liq_x")],
        [None; 4]
    );
    assert_eq!(spelt(" Finger  X-[mm] "), "finger_x_mm");
    assert_eq!(spelt("\u{b5}m"), "\u{b5}m");
}

#[test]
fn names_that_contradict_are_refused() {
    let names = |pairs: &[(&str, &str)]| -> BTreeMap<String, String> {
        let owned = |(key, name): &(&str, &str)| ((*key).to_owned(), (*name).to_owned());
        pairs.iter().map(owned).collect()
    };
    let rolls = |pairs| check_names(&names(pairs), &columns_of("roll"));
    assert!(rolls(&[("shift_u_mm", "U")]).is_ok());
    for (pairs, words) in [
        (
            &[("x", "U")][..],
            "no column of these readings; known: probe,",
        ),
        (&[("shift_u", "U"), ("shift_u_mm", "V")], "are one column"),
        (&[("shift_u", "U"), ("shift_v", "U ")], "are both `U`"),
        (&[("shift_u", " ")], "has no name"),
    ] {
        let error = rolls(pairs).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let none = check_names(&names(&[("x", "X")]), &columns_of("fingertip"));
    assert!(none.unwrap_err().message.contains("no readings"));
}
