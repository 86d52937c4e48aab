//! Compares tables in Parquet format with the same tables in CSV format.

use std::collections::BTreeMap;
use std::fs::{self, File};

use parquet::basic::{LogicalType, Type as Physical};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use super::desk::{Desk, STUDY, edited};
use super::glide::GLIDE;
use super::report::with_plot;
use super::shards::{PRESSES, many};

const TABLES: [&str; 3] = ["cells", "failures", "map"];

/// A study of rolls whose swept fields have all types: integers, words, tables with unusual labels, and a parameter of
/// a formula.
const KINDS: &str = r#"name = "kinds"
length_unit = "cm"

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = { kind = "height-field", formula = "0.1*x^2 + k*y^2", parameters = { k = 0.1 } }
motion = { rate_rad_per_s = 0.1, duration_s = 0.5 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }
sensor = { kind = "ideal" }

[[sweep]]
path = "trials"
values = [3, 5]
[[sweep]]
path = "seed"
values = [1, 20000000, 9007199254740993]
[[sweep]]
path = "scene.sensor"
values = [{ kind = "ideal", label = "none, or \"ideal\"" }, { kind = "wrist", std = 0.01, label = "7" }]
[[sweep]]
path = "scene.object.parameters.k"
values = [0.1, 0.3]
[[sweep]]
path = "scene.motion.rate_rad_per_s"
from = 0.1
to = 0.2
count = 2
"#;

struct Read {
    columns: Vec<(String, &'static str, Option<String>)>,
    rows: Vec<Vec<Field>>,
    groups: usize,
}

fn read(desk: &Desk, name: &str) -> Read {
    let reader = SerializedFileReader::new(File::open(desk.path(name)).unwrap()).unwrap();
    let metadata = reader.metadata();
    let entries = metadata.file_metadata().key_value_metadata().unwrap();
    let entry = |entry: &parquet::file::metadata::KeyValue| {
        (entry.key.clone(), entry.value.clone().unwrap())
    };
    let mut about: BTreeMap<String, String> = entries.iter().map(entry).collect();
    let types = metadata.file_metadata().schema().get_fields();
    let columns = types.iter().map(|column| {
        let info = column.get_basic_info();
        let kind = match (column.get_physical_type(), info.logical_type_ref()) {
            (Physical::DOUBLE, None) => "f64",
            (Physical::BYTE_ARRAY, Some(LogicalType::String)) => "text",
            (Physical::INT64, Some(integer)) if *integer == LogicalType::integer(64, true) => "i64",
            (Physical::INT64, Some(integer)) if *integer == LogicalType::integer(64, false) => {
                "u64"
            }
            other => panic!("{other:?}"),
        };
        let unit = about.remove(&format!("unit.{}", column.name()));
        (column.name().to_owned(), kind, unit)
    });
    let columns = columns.collect();
    let rows = reader.get_row_iter(None).unwrap().map(|row| {
        let row = row.unwrap();
        row.get_column_iter()
            .map(|(_, field)| field.clone())
            .collect()
    });
    Read {
        columns,
        rows: rows.collect(),
        groups: metadata.num_row_groups(),
    }
}

/// Compares every column name and every value with a CSV table. Returns the number of compared values.
fn compare_tables(desk: &Desk, name: &str, csv: &str) -> usize {
    let (found, expected) = (read(desk, name), desk.table(csv));
    let names: Vec<&String> = found.columns.iter().map(|(name, ..)| name).collect();
    assert_eq!(names, expected.header.iter().collect::<Vec<_>>(), "{name}");
    assert_eq!(found.rows.len(), expected.rows.len(), "{name}");
    let mut values = 0;
    for (row, texts) in found.rows.iter().zip(&expected.rows) {
        for ((field, text), (column, kind, _)) in row.iter().zip(texts).zip(&found.columns) {
            let is_same = match field {
                Field::Null => text.is_empty(),
                Field::Double(number) => {
                    *kind == "f64" && text.parse::<f64>().unwrap().to_bits() == number.to_bits()
                }
                Field::ULong(number) => *kind == "u64" && text.parse() == Ok(*number),
                Field::Long(number) => {
                    let of_float = || text.parse::<f64>().unwrap() == *number as f64;
                    *kind == "i64" && (text.parse() == Ok(*number) || of_float())
                }
                Field::Str(found) => *kind == "text" && found == text,
                _ => false,
            };
            assert!(is_same, "{name}, {column}: {field:?} is not {text:?}");
            values += usize::from(!text.is_empty());
        }
    }
    values
}

#[test]
fn every_value_equals_that_of_the_csv() {
    // Each tuple contains a study, whether some trials must fail, and whether the study has a map.
    for (study, fails, maps) in [
        (many(), false, false),
        (KINDS.to_owned(), false, false),
        (PRESSES.to_owned(), true, true),
        (GLIDE.to_owned(), false, true),
    ] {
        let desk = Desk::with(&study);
        let trials = "--trials-out";
        desk.palpate(&format!("run c.toml --out c {trials} t.csv"));
        let line = format!("run c.toml --out p --format parquet {trials} t.parquet");
        let ended = desk.palpate(&line);
        assert_eq!(ended.status, Some(0), "{ended:?}");
        for table in TABLES {
            let [csv, parquet] = ["c", "p"].map(|dir| {
                let ending = if dir == "c" { "csv" } else { "parquet" };
                format!("{dir}/{table}.{ending}")
            });
            let is_there = table != "map" || maps;
            assert_eq!(desk.path(&parquet).exists(), is_there, "{parquet}");
            if is_there {
                let values = compare_tables(&desk, &parquet, &csv);
                assert!(values > 0 || table == "failures" && !fails, "{parquet}");
            }
        }
        assert!(compare_tables(&desk, "t.parquet", "t.csv") > 0);
        // All files other than the tables are the same in a run with Parquet tables and in a run with CSV tables.
        let others = |dir: &str| {
            let mut names = desk.names(dir);
            names.retain(|name| !TABLES.iter().any(|table| name.starts_with(table)));
            let read =
                |name: String| (fs::read(desk.path(&format!("{dir}/{name}"))).unwrap(), name);
            names.into_iter().map(read).collect::<Vec<_>>()
        };
        assert!(others("c") == others("p"));
    }
}

#[test]
fn columns_have_types_and_units() {
    let run = |study: &str| {
        let desk = Desk::with(study);
        desk.palpate("run c.toml --out o --format parquet --trials-out o/t.parquet");
        desk
    };
    let types = |desk: &Desk, table: &str| {
        let columns = read(desk, &format!("o/{table}.parquet"))
            .columns
            .into_iter();
        let words = columns.map(|(name, kind, unit)| {
            let unit = unit.map_or_else(String::new, |unit| format!(" in {unit}"));
            format!("{name} {kind}{unit}")
        });
        words.collect::<Vec<_>>().join("\n")
    };
    let statistics = "quantity text\nunit text\ntruth f64 in column unit\ntrials u64 in 1\nfailures u64 in 1\n\
        mean f64 in column unit\nstd f64 in column unit\nbias f64 in column unit\nrms_error f64 in column unit\n\
        rms_error_std f64 in column unit\nmean_abs_error f64 in column unit\nrelative_rms_error f64 in 1\nrelative_mean_abs_error f64 in 1\n\
        q05 f64 in column unit\nq50 f64 in column unit\nq95 f64 in column unit\n\
        mean_reported_std f64 in column unit\ncoverage50 f64 in 1\ncoverage80 f64 in 1\ncoverage95 f64 in 1";
    assert_eq!(
        types(&run(KINDS), "cells"),
        format!(
            "cell u64 in 1\nseed i64 in 1\nscene.sensor text\nscene.object.parameters.k f64\n\
             scene.motion.rate_rad_per_s f64 in rad/s\n{statistics}"
        )
    );
    let presses = run(PRESSES);
    assert_eq!(
        types(&presses, "cells"),
        format!(
            "cell u64 in 1\nscene.motion.indentation_mm f64 in mm\n{statistics}\n\
             std_bound f64 in column unit"
        )
    );
    assert_eq!(
        types(&presses, "failures"),
        "cell u64 in 1\nkind text\ncount u64 in 1\nfirst_trial u64 in 1"
    );
    assert_eq!(
        types(&run(STUDY), "t"),
        "cell u64 in 1\ntrial u64 in 1\nquantity text\nunit text\nestimate f64 in column unit\n\
         truth f64 in column unit\nstd f64 in column unit\nfailure text"
    );
    let of_maps = types(&run(GLIDE), "map");
    for words in [
        "cell u64 in 1\nx_mm f64 in mm\n",
        "\nnormal_x f64 in 1\n",
        "\ngaussian_curvature_std_per_mm2 f64 in 1/mm^2\n",
        "\nk_min_per_mm f64 in 1/mm\n",
        "\nclass text\ntrue_class text\nregion u64 in 1\n",
        "\nprobability_peak f64 in 1\n",
    ] {
        assert!(of_maps.contains(words), "{words}: {of_maps}");
    }
    assert!(types(&presses, "map").contains("\nradial_position_mm f64 in mm\n"));
}

#[test]
fn merges_and_pipes_write_the_same_bytes() {
    let desk = Desk::with(&many());
    desk.palpate("run c.toml --format parquet --trials-out t.parquet --out whole");
    for number in [1, 2] {
        desk.palpate(&format!(
            "run c.toml --shard {number}/2 --out s/{number} --trials-out no.csv"
        ));
    }
    // Standard output must contain only the Parquet file.
    let ended =
        desk.shell("\"$palpate\" merge s --out m --format parquet --trials-out - > m.parquet");
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let bytes = |name: &str| fs::read(desk.path(name)).unwrap();
    for [whole, merged] in [
        ["whole/cells.parquet", "m/cells.parquet"],
        ["whole/failures.parquet", "m/failures.parquet"],
        ["t.parquet", "m.parquet"],
    ] {
        assert!(bytes(whole) == bytes(merged), "{whole}");
    }
}

#[test]
fn long_tables_have_groups_of_rows() {
    let desk = Desk::with(&edited(STUDY, "trials = 20", "trials = 7000"));
    desk.palpate("run c.toml --out o --trials-out t.csv")
        .printed();
    desk.palpate("run c.toml --out o --trials-out t.parquet")
        .printed();
    compare_tables(&desk, "t.parquet", "t.csv");
    let table = read(&desk, "t.parquet");
    assert_eq!(table.groups, table.rows.len().div_ceil(1 << 16));
    assert!(table.groups > 1);
}

#[test]
fn a_run_removes_the_tables_of_an_earlier_run() {
    let desk = Desk::with(&with_plot());
    desk.palpate("run c.toml --out o").printed();
    desk.palpate("plot o").printed();
    desk.palpate("run c.toml --out o --format parquet")
        .printed();
    assert_eq!(
        desk.names("o"),
        ["cells.parquet", "failures.parquet", "run.toml"]
    );
    let said = desk.palpate("status o").printed();
    let words = "study    a-study\nstate    done\ncells    2\ntrials   40, 0 failed\n";
    assert_eq!(said, words);
    for command in ["plot o", "report o --out page.html"] {
        desk.palpate(command)
            .fails(1, "o has its tables as Parquet");
    }
    // A run with another seed, or a run with CSV tables, is allowed to overwrite the tables of this run.
    desk.palpate("run c.toml --out o --format parquet --seed 8")
        .printed();
    desk.palpate("run c.toml --out o --seed 9").printed();
    assert_eq!(desk.names("o"), ["cells.csv", "failures.csv", "run.toml"]);
    assert_eq!(desk.palpate("status o").printed(), words);
    // A table that was edited by hand is kept, and the message names it.
    let edited = desk.read("o/cells.csv") + "\n";
    desk.write("o/cells.csv", &edited);
    let ended = desk.palpate("run c.toml --out o --format parquet --seed 9");
    assert_eq!(
        ended.stderr,
        "note: o/cells.csv was changed since palpate wrote it, and stays\n"
    );
    assert_eq!(desk.read("o/cells.csv"), edited);
    desk.write("o/cells.parquet", "mine");
    desk.palpate("run c.toml --out o --format parquet")
        .fails(2, "o/cells.parquet was changed since");
}

#[test]
fn a_table_of_trials_overwrites_only_another_one() {
    let desk = Desk::with(STUDY);
    let line = "run c.toml --out o --trials-out t.parquet";
    desk.palpate(line).printed();
    let first = fs::read(desk.path("t.parquet")).unwrap();
    desk.palpate(&format!("{line} --seed 3")).printed();
    assert!(fs::read(desk.path("t.parquet")).unwrap() != first);
    // The command overwrites neither a table of another kind nor a file that is not a table.
    desk.palpate("run c.toml --out p --format parquet")
        .printed();
    fs::copy(desk.path("p/cells.parquet"), desk.path("t.parquet")).unwrap();
    desk.palpate(line)
        .fails(2, "t.parquet is not a file that palpate wrote");
    desk.write("t.parquet", "mine");
    desk.palpate(line)
        .fails(2, "t.parquet is not a file that palpate wrote");
    assert_eq!(desk.read("t.parquet"), "mine");
    desk.palpate("run c.toml --out q --trials-out q/cells.parquet")
        .fails(2, "the run writes another file of that name");
    // The extension of the file overrides --format.
    desk.palpate("run c.toml --out q --format parquet --trials-out u.csv")
        .printed();
    assert!(desk.read("u.csv").starts_with("cell,trial,"));
    desk.palpate("run c.toml --shard 1/2 --format parquet")
        .fails(2, "give --format to `palpate merge`");
    desk.palpate("submit slurm c.toml --shards 2 --format parquet --dry-run")
        .prints("--format parquet\n");
}

#[test]
fn a_damaged_table_is_named() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o --format parquet")
        .printed();
    let sound = fs::read(desk.path("o/cells.parquet")).unwrap();
    for cut in [0, 4, sound.len() / 2, sound.len() - 1] {
        desk.write("o/cells.parquet", &sound[..cut]);
        desk.palpate("status o")
            .fails(1, "cannot read o/cells.parquet");
    }
}
