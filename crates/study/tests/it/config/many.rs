//! Tests studies with so many cells that only a sample of them is checked.

use std::collections::BTreeSet;

use super::{BASE, error, study};

const MILLION: &str = r#"[[sweep]]
path = "scene.object.radius"
from = 2.0
to = 80.0
count = 1000
[[sweep]]
path = "scene.motion.rate_rad_per_s"
from = 0.001
to = 1.0
count = 1000
"#;

#[test]
fn few_cells_are_all_checked() {
    let sections = MILLION.replace("count = 1000", "count = 100");
    let study = study(&sections);
    assert_eq!(study.sample, (0..10_000).collect::<Vec<_>>());
}

#[test]
fn of_a_million_cells_a_sample_has_every_value_and_every_corner() {
    let million = study(MILLION);
    assert_eq!(million.cell_count(), 1_000_000);
    assert!(million.sample.len() < 10_000, "{}", million.sample.len());
    let cells = million.sample.iter();
    let cells: Vec<_> = cells.map(|&number| million.cell(number).unwrap()).collect();
    for column in 0..2 {
        let values = cells.iter().map(|cell| cell.coordinates[column].as_str());
        assert_eq!(values.collect::<BTreeSet<_>>().len(), 1000);
    }
    for corner in [0, 999, 999_000, 999_999] {
        assert!(million.sample.contains(&corner), "{corner}");
    }
    assert_eq!(million.sample, study(MILLION).sample);
    assert_eq!(million.cell(999_999).unwrap().coordinates, ["80", "1"]);
}

#[test]
fn cells_of_plain_values_are_those_that_the_schema_checks() {
    // If an axis has tables as values, each cell is validated as a whole. If all values are numbers, words or Booleans,
    // each value is validated only once. Both studies must have equal cells.
    let plain = MILLION.replace("count = 1000", "count = 7");
    let table = format!(
        "{plain}[[sweep]]\npath = \"scene.probe\"\nvalues = [{{ label = \"p\", kind = \"sphere\", radius = 2.0 }}]\n"
    );
    let same = plain.clone() + "[[sweep]]\npath = \"scene.probe.radius\"\nvalues = [2.0]\n";
    let (plain, table) = (study(&same), study(&table));
    for number in 0..49 {
        let (one, other) = (plain.cell(number).unwrap(), table.cell(number).unwrap());
        assert_eq!(one.config.scene, other.config.scene);
        assert_eq!(one.coordinates[..2], other.coordinates[..2]);
    }
}

#[test]
fn the_extremes_of_a_long_axis_are_in_its_sample_wherever_they_stand() {
    for place in [1, 13_577, 19_998] {
        for extreme in [0.125, 70.0] {
            let mut values: Vec<String> = (1..=20_000)
                .map(|n| format!("{}", 1.0 + f64::from(n) / 1e3))
                .collect();
            values[place] = extreme.to_string();
            let values = values.join(", ");
            let long = study(&format!(
                "[[sweep]]\npath = \"scene.object.radius\"\nvalues = [{values}]\n"
            ));
            assert!(long.sample.contains(&place), "{place} {extreme}");
            assert!(long.sample.contains(&19_999));
            assert!((1000..10_000).contains(&long.sample.len()));
        }
    }
}

#[test]
fn many_short_axes_have_each_value_and_each_pair_of_ends() {
    let names: Vec<String> = (0..14).map(|place| format!("k{place}")).collect();
    let set: Vec<String> = names.iter().map(|name| format!("{name} = 1.0")).collect();
    let sum: Vec<String> = names.iter().map(|name| format!("{name} * x")).collect();
    let object = format!(
        "object = {{ kind = \"height-field\", formula = \"{}\", parameters = {{ {} }} }}",
        sum.join(" + "),
        set.join(", ")
    );
    let sweeps: String = names
        .iter()
        .map(|name| {
            format!("[[sweep]]\npath = \"scene.object.parameters.{name}\"\nvalues = [1.0, 2.0]\n")
        })
        .collect();
    let text = BASE.replace("object = { kind = \"sphere\", radius = 5.0 }", &object);
    assert_ne!(text, BASE);
    let study = palpate_study::config::parse("study.toml", &(text + &sweeps)).unwrap();
    assert_eq!(study.cell_count(), 1 << 14);
    let sample = study.sample;
    assert!(sample.len() < 10_000);
    for (a, b) in [(0, 1), (0, 13), (5, 9)] {
        assert!(sample.contains(&((1 << a) | (1 << b))), "{a} {b}");
    }
    assert!(sample.contains(&((1 << 14) - 1)), "the last cell");
}

#[test]
fn a_value_that_is_beyond_its_limit_is_found_wherever_it_stands() {
    let values: Vec<String> = (1..=20_000).map(|n| format!("{n}.5")).collect();
    let all = |values: &[String]| {
        let values = values.join(", ");
        format!("{BASE}[[sweep]]\npath = \"scene.object.radius\"\nvalues = [{values}]\n")
    };
    assert!(palpate_study::config::parse("study.toml", &all(&values)).is_ok());
    for place in [1, 13_577, 19_998] {
        let mut values = values.clone();
        values[place] = "-5.5".to_owned();
        let error = error(&all(&values));
        assert_eq!(error.path, "scene.object.radius");
        assert!(error.to_string().contains(&format!("in cell {place}: ")));
    }
}

#[test]
fn a_cell_that_is_not_in_the_sample_is_checked_when_it_is_asked_for() {
    // The study sweeps 150 marker depths (up to 5.149) and 150 models of layers. If `thin` is set, the layer of the
    // model with this index has a thickness of only 5.1485. This model is invalid with the largest marker depth,
    // because the markers would be below the layer.
    let study = |thin: Option<usize>| {
        let depths: Vec<String> = (0..150)
            .map(|n| (5.0 + f64::from(n) / 1000.0).to_string())
            .collect();
        let model = |n: usize| {
            let thickness = if Some(n) == thin { 5.1485 } else { 9.0 };
            format!("{{ label = \"layer {n}\", kind = \"bonded-layer\", thickness = {thickness} }}")
        };
        let models: Vec<String> = (0..150).map(model).collect();
        let text = format!(
            "name = \"a-press\"\n[scene]\nkind = \"press\"\nobject = {{ kind = \"plane\" }}\n\
             probe = {{ kind = \"marker-sphere\", radius = 20.0, marker_depth = 2.0 }}\n\
             motion = {{ indentation = 1.0 }}\nmodel = {{ kind = \"bonded-layer\", thickness = 9.0 }}\n\
             [[sweep]]\npath = \"scene.probe.marker_depth\"\nvalues = [{}]\n\
             [[sweep]]\npath = \"scene.model\"\nvalues = [{}]\n",
            depths.join(", "),
            models.join(", "),
        );
        palpate_study::config::parse("study.toml", &text)
    };
    let of_last = |row: &usize| 149 * 150 + row;
    let good = study(None).unwrap();
    let is_unseen = |row: &usize| good.sample.binary_search(&of_last(row)).is_err();
    let row = (0..150).find(is_unseen).unwrap();
    let study = study(Some(row)).unwrap();
    assert!(study.cell(of_last(&row) - 150).is_ok());
    let said = study.cell(of_last(&row)).unwrap_err().to_string();
    assert!(said.contains("below the layer"), "{said}");
    assert!(
        said.contains(&format!("in cell {}: ", of_last(&row))),
        "{said}"
    );
}

#[test]
fn trials_are_counted_without_the_cells() {
    let seven = palpate_study::config::parse("study.toml", &format!("trials = 7\n{BASE}{MILLION}"));
    assert_eq!(seven.unwrap().trials(), 7_000_000);
    let swept = format!("{MILLION}[[sweep]]\npath = \"trials\"\nvalues = [3, 4]\n");
    let fewer = swept.replacen("count = 1000", "count = 10", 1);
    let fewer = study(&fewer);
    assert_eq!(fewer.trials(), 70_000);
    for number in [0, 1, 777, 19_999] {
        let trials = fewer.cell(number).unwrap().config.trials;
        assert_eq!(fewer.trials_of(number), trials, "{number}");
    }
}
