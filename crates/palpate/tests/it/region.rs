//! Tests `palpate design` with several fields: the region of values that meet a target, and the best value of one
//! field.

use serde_json::Value;

use super::desk::{Desk, STUDY, assert_close, edited, noiseless, number_at as number};

const TARGET: &str = "--target relative_rms_error(mean_curvature)<=0.05";
const RADII: &str = "--vary scene.object.radius=5,20,50";
const FRACTION: &str = "scene.noise.angular_velocity.fraction";

/// Entry of the list `columns` in an answer, for one value of the field at `path`. Each entry must belong to a single
/// field.
fn column<'a>(answer: &'a Value, path: &str, value: &str) -> &'a Value {
    let columns = answer["columns"].as_array().unwrap();
    let found = columns.iter().find(|column| {
        let at = &column["at"][path];
        at.as_str().map_or_else(|| at.to_string(), str::to_owned) == value
    });
    found.unwrap_or_else(|| panic!("{path} = {value}: {answer}"))
}

#[test]
fn both_sides_of_every_column_are_those_that_a_run_finds() {
    let desk = Desk::with(STUDY);
    let question =
        format!("design c.toml {TARGET} {RADII} --vary {FRACTION}=0.001..0.2 --gap 0.3 --out out");
    let answer = desk.json(&question);
    assert_eq!(answer["path"], FRACTION);
    for radius in ["5", "20", "50"] {
        let column = column(&answer, "scene.object.radius", radius);
        let ends = [("/meets/0/to", true), ("/misses/0/from", false)];
        for (place, is_met) in ends {
            let fraction = number(column, place);
            let one = edited(STUDY, "fraction = 0.01", &format!("fraction = {fraction}"));
            desk.write("one.toml", edited(&one, "[50, 5]", &format!("[{radius}]")));
            desk.palpate("run one.toml --trials 100000 --out one")
                .printed();
            let table = desk.table("one/cells.csv");
            let row = table.row_of(0, "mean_curvature");
            let rms = table.number(row, "relative_rms_error");
            assert_eq!(rms <= 0.05, is_met, "{radius}, {fraction}: {rms}");
        }
        assert!(number(column, "/misses/0/from") < 1.35 * number(column, "/meets/0/to"));
    }
    let names = ["csv", "png", "svg", "toml", "txt"].map(|ending| format!("design.{ending}"));
    let names: Vec<String> = names.into_iter().chain(["region.csv".to_owned()]).collect();
    assert_eq!(desk.names("out"), names);
    let runs = desk.table("out/region.csv");
    assert_eq!(runs.rows.len(), 6);
    let fifty = (0..6).find(|&row| {
        runs.text(row, "scene.object.radius_mm") == "50" && runs.text(row, "verdict") == "misses"
    });
    let from = runs.number(fifty.unwrap(), &format!("{FRACTION}.from"));
    let of_fifty = column(&answer, "scene.object.radius", "50");
    assert_eq!(from, number(of_fifty, "/misses/0/from"));
    let words = desk.read("out/design.txt");
    let first = "Angular velocity noise that meets the target (95 % sure of all): ";
    assert!(words.starts_with(first), "{words}");
    assert_eq!(
        words.lines().filter(|line| line.starts_with("at ")).count(),
        3
    );
}

#[test]
fn the_best_value_is_that_of_the_kinder_noise() {
    // Uniform noise within ±f has the standard deviation f/√3, and Gaussian noise has the standard deviation f.
    let kinds = "--vary scene.noise.angular_velocity.kind=gaussian,uniform";
    let question = format!(
        "design c.toml {TARGET} --set scene.object.radius=20 --vary {FRACTION}=0.001..0.2 {kinds} --maximise {FRACTION} --gap 0.1"
    );
    let answer = Desk::with(STUDY).json(&question);
    let [uniform, gaussian] = ["uniform", "gaussian"]
        .map(|kind| column(&answer, "scene.noise.angular_velocity.kind", kind));
    let limit =
        |column: &Value| (number(column, "/meets/0/to") * number(column, "/misses/0/from")).sqrt();
    assert_close(limit(uniform) / limit(gaussian), 3_f64.sqrt(), 0.1);
    let best = &answer["best_that_meets"];
    assert_eq!(best["scene.noise.angular_velocity.kind"], "uniform");
    assert_eq!(best[FRACTION], uniform["meets"][0]["to"]);
    let sentence = answer["answer"].as_str().unwrap();
    let missed = format!("{:.3}", 100.0 * number(uniform, "/misses/0/from"));
    let missed = format!("; {} % or more misses", missed.trim_end_matches(['0', '.']));
    assert!(sentence.contains(&missed), "{missed}: {sentence}");
    assert!(
        sentence.starts_with("Largest angular velocity noise that meets the target (95 % sure): ")
            && sentence.contains(", at angular velocity kind noise uniform; ")
            && sentence.ends_with(
                " misses it at both values of angular velocity kind noise that were tested."
            ),
        "{sentence}"
    );
}

#[test]
fn the_grid_closes_in_on_the_best_value() {
    // Without noise, the estimated mean curvature of a ball is the inverse of its radius, for every radius of the
    // probe. So the largest ball with a mean curvature of at least 0.05 /mm has a radius of 20 mm.
    let question = "design c.toml --target mean(mean_curvature)>=0.05 --vary scene.object.radius=1..100 \
                    --vary scene.probe.radius=1..30 --maximise scene.object.radius --gap 0.01";
    let desk = Desk::with(&noiseless());
    let answer = desk.json(question);
    let best = number(&answer, "/best_that_meets/scene.object.radius");
    assert!((19.7..=20.0).contains(&best), "{best}");
    let columns = answer["columns"].as_array().unwrap();
    assert!(columns.len() > 9, "{}", columns.len());
    let probes: Vec<f64> = columns
        .iter()
        .map(|column| column["at"]["scene.probe.radius"].as_f64().unwrap())
        .collect();
    assert!(
        probes.windows(2).all(|pair| pair[0] < pair[1]),
        "{probes:?}"
    );
}

#[test]
fn the_best_of_listed_values_and_of_a_single_field() {
    let desk = Desk::with(STUDY);
    // At every noise in this range, the ball with a radius of 500 mm misses the target.
    let noise = format!("--vary {FRACTION}=0.05..0.2 --gap 0.3");
    let answer = desk.json(&format!(
        "design c.toml {TARGET} --vary scene.object.radius=5,20,500 {noise} --maximise scene.object.radius"
    ));
    let all = column(&answer, "scene.object.radius", "500");
    assert_eq!(all["meets"], serde_json::json!([]));
    let met = ["5", "20"].map(|radius| {
        let column = column(&answer, "scene.object.radius", radius);
        !column["meets"].as_array().unwrap().is_empty()
    });
    let largest = if met[1] { "20" } else { "5" };
    assert!(met[0], "{answer}");
    assert_eq!(answer["best_that_meets"]["scene.object.radius"], largest);
    // If only the noise varies, the search without `--maximise` reports the range of noise that meets the target. With
    // `--maximise`, it must report the upper end of this range.
    let alone = format!("--vary {FRACTION}=0.001..0.2 --gap 0.3");
    let [line, best] = ["".to_owned(), format!("--maximise {FRACTION}")]
        .map(|sought| desk.json(&format!("design c.toml {TARGET} {alone} {sought}")));
    assert_eq!(best["best_that_meets"][FRACTION], line["meets"][0]["to"]);
}

#[test]
fn what_nothing_meets() {
    let desk = Desk::with(STUDY);
    let question = format!(
        "design c.toml --target relative_rms_error(mean_curvature)<=1e-6 {RADII} --vary {FRACTION}=0.001..0.2"
    );
    let said = desk.palpate(&question).printed();
    assert!(
        said.starts_with("No value of angular velocity noise meets the target at any of 3 values of object radius that were tested (95 % sure); at best rms relative error is "),
        "{said}"
    );
    // The best result is for the ball with the smallest radius.
    assert!(
        said.lines()
            .next()
            .unwrap()
            .ends_with(" at 0.1 % and object radius 5 mm."),
        "{said}"
    );
}

#[test]
fn the_same_region_on_any_threads() {
    let question = format!(
        "design c.toml {TARGET} {RADII} --vary {FRACTION}=0.001..0.2 --maximise {FRACTION} --gap 0.3 --budget 1h"
    );
    let files = ["design.csv", "design.svg", "design.txt", "region.csv"];
    Desk::with(STUDY).assert_alike_on_any_threads(&question, &files);
}

const QUESTIONS: &str = "
--maximise scene.object.radius | is not varied, so it has no best value: vary it over a range, such as scene.object.radius=1..2
--vary scene.noise.angular_velocity.kind=uniform,gaussian --minimise scene.noise.angular_velocity.kind | no largest or smallest value, because \"uniform\" is not a number
--maximise scene.probe.radius --minimise scene.probe.radius | cannot be used with
--vary scene.noise.angular_velocity.fraction=1,2 | is given twice
--vary scene.object.radius=1..9 --vary scene.probe.radius=1..9 --vary scene.motion.duration_s=1..2 --vary scene.motion.rate_rad_per_s=0.1,0.2,0.3 | 81 combinations of values would each be searched; at most 64 are allowed
";

#[test]
fn what_cannot_be_asked_of_several_fields() {
    let question = format!("design c.toml {TARGET} --vary {FRACTION}=0.001..0.2");
    Desk::with(STUDY).refuses(&question, QUESTIONS);
}
