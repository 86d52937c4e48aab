//! Tests `palpate design`, which finds the values of a field that meet a target.

use super::desk::{Desk, STUDY, edited, noiseless, number_at as number};

const TARGET: &str = "--target relative_rms_error(mean_curvature)<=0.05";
const NOISE: &str = "--vary scene.noise.angular_velocity.fraction=0.001..0.2";

#[test]
fn both_sides_are_printed_and_written() {
    // The last cell has larger errors than the first. The answer must be right for both cells.
    let desk = Desk::with(&edited(STUDY, "[50, 5]", "[5, 50]"));
    let answer = desk.json(&format!(
        "design c.toml {TARGET} {NOISE} --gap 0.3 --out out"
    ));
    let (meets, misses) = (
        number(&answer, "/meets/0/to"),
        number(&answer, "/misses/0/from"),
    );
    assert!(meets < misses && misses < 1.35 * meets, "{answer}");
    assert!((0.03..0.042).contains(&meets), "{meets}");
    assert_eq!(number(&answer, "/meets/0/from"), 0.001);
    assert_eq!(number(&answer, "/misses/0/to"), 0.2);
    assert_eq!(
        (&answer["format_version"], &answer["ended"]),
        (&1.into(), &"known".into())
    );
    // The written files contain the same answer as the JSON output.
    let files = [
        "design.csv",
        "design.png",
        "design.svg",
        "design.toml",
        "design.txt",
        "region.csv",
    ];
    assert_eq!(desk.names("out"), files);
    let sentence = answer["answer"].as_str().unwrap();
    assert!(desk.read("out/design.txt").starts_with(sentence));
    let table = desk.table("out/design.csv");
    let of = |row: &usize| table.number(*row, "scene.noise.angular_velocity.fraction");
    let verdicts = |value: f64| {
        let rows = (0..table.rows.len()).filter(|row| of(row) == value);
        rows.map(|row| table.text(row, "verdict").to_owned())
            .collect::<Vec<_>>()
    };
    assert!(verdicts(meets).iter().all(|verdict| verdict == "meets"));
    assert!(verdicts(misses).iter().all(|verdict| verdict == "misses"));
    let mut scanned: Vec<String> = table.rows.iter().map(|row| row[0].clone()).collect();
    scanned.sort();
    scanned.dedup();
    assert!(scanned.len() > 16);
}

#[test]
fn what_all_or_nothing_meets() {
    let desk = Desk::with(STUDY);
    let said = |limit: &str| {
        let target = format!("--target relative_rms_error(mean_curvature)<={limit}");
        desk.palpate(&format!("design c.toml {target} {NOISE}"))
            .printed()
    };
    let all = said("1000%");
    assert!(
        all.contains("every value from 0.1 to 20 % meets the target (95 % sure)."),
        "{all}"
    );
    let nothing = said("1e-6");
    assert!(nothing.contains("every value from 0.1 to 20 % misses the target (95 % sure); at best rms relative error is "), "{nothing}");
    let one = "--vary scene.noise.angular_velocity.fraction=0.001..0.001";
    desk.palpate(&format!("design c.toml {TARGET} {one}"))
        .prints("Angular velocity noise: 0.1 % meets the target (95 % sure).");
}

#[test]
fn values_may_be_listed_and_fields_set() {
    let desk = Desk::with(STUDY);
    let kinds = "--vary scene.noise.angular_velocity.kind=uniform,gaussian";
    let answer = desk.json(
        &format!(
            "design c.toml {kinds} --target relative_rms_error(mean_curvature)<=0.016 --set scene.noise.angular_velocity.fraction=0.01 --set scene.object.radius=50"
        ),
    );
    // The expected rms errors of the curvature are 1.2 % for uniform noise and 2.1 % for Gaussian noise. They differ
    // because the standard deviation of uniform noise within ±0.01 is 0.01/√3, and that of Gaussian noise is 0.01.
    assert_eq!(
        answer["meets"],
        serde_json::json!([{ "from": "uniform", "to": "uniform" }])
    );
    assert_eq!(
        answer["misses"],
        serde_json::json!([{ "from": "gaussian", "to": "gaussian" }])
    );
}

#[test]
fn nothing_is_random() {
    let desk = Desk::with(&noiseless());
    // A ball with a radius of 20 mm has a mean curvature of 0.05 /mm.
    let said = desk
        .palpate(
            "design c.toml --target mean(mean_curvature)>=0.05 --vary scene.object.radius=1..100",
        )
        .printed();
    assert!(
        said.contains("trials   1 per value, because the scene has no random numbers"),
        "{said}"
    );
    assert!(said.starts_with("Object radius: 19"), "{said}");
}

#[test]
fn too_many_failures_miss_the_target() {
    // The pads are as wide as the whole path, so in many rolls the contact stays on one pad.
    let pads = edited(
        STUDY,
        "noise = {",
        "sensor = { kind = \"pads\", pitch = 1.0, layout = \"uniform\", offset = \"random\" }\nnoise = {",
    );
    let desk = Desk::with(&pads);
    let of = |most: &str| {
        let target =
            "--target relative_rms_error(mean_curvature)<=10000% --set scene.object.radius=30";
        desk.json(
            &format!("design c.toml {target} --vary scene.sensor.pitch=0.1..9 --gap 0.5 --max-failures {most}"),
        )
    };
    let [few, more] = ["0.05", "0.3"].map(of);
    let ends = [&few, &more].map(|answer| number(answer, "/meets/0/to"));
    assert!(ends[0] < ends[1], "{ends:?}");
    // The answer states why the value misses the target: the most frequent kind of failure, and its share.
    assert_eq!(few["failing_end"]["main_failure"], "not-rolling");
    assert!(number(&few, "/failing_end/failing") > 0.05);
    let said = few["answer"].as_str().unwrap();
    assert!(
        said.contains(" misses it, because ") && said.contains("(`not-rolling`"),
        "{said}"
    );
}

const QUESTIONS: &str = "
--target rms_error(weather)<=0.05 --vary a=1..2 | there is no quantity \"weather\"
--target rms_error<=0 --vary a=1..2 | rms_error is above 0, and the limit is 0
--target rms_error<=1 --vary scene.object.radius=1..2 --set scene.seed=1..2 | use --vary for a range
--target rms_error<=1 --vary scene.object.radius=1..2 --set scene.seed=1,2 | to a single value, but there are 2
--target rms_error(class)<=1 --vary scene.object.radius=1..2 | a roll has no quantity \"class\" (known: normal_curvature_u,
--target rms_error<=1 --vary object.radius=1..2 --maximise radios | c.toml: radios: no field has this name
--target rms_error<=1 --vary scene.object.kind=1..2 | scene.object.kind is not a numeric field, so it has no range: list its values
--target rms_error<=1 --vary title=a,b | cannot sweep `title`
--target rms_error<=1 --vary scene.object.radius=1..2 --set scene.object.radius=1 | scene.object.radius is given twice
--target rms_error<=1 --vary scene.object.radius=1..2 --max-failures 0 | 0 cannot be verified with any number of trials
--target rms_error<=1 --vary scene.object.radius=1..2 --gap -1 | gap is -1; it must be above 0
--target coverage95(arc_length)>=0.5 --vary scene.object.radius=1..2 | the estimator states no standard deviation
";

#[test]
fn what_cannot_be_asked() {
    Desk::with(STUDY).refuses("design c.toml", QUESTIONS);
    // If the statistic does not exist at one of the tried values, the error states this value.
    let flat = edited(
        STUDY,
        "{ kind = \"sphere\", radius = 50.0 }",
        "{ kind = \"saddle\", a = 0.01 }",
    );
    let flat = edited(
        &flat,
        "\n[[sweep]]\npath = \"scene.object.radius\"\nvalues = [50, 5]\n",
        "",
    );
    let desk = Desk::with(&flat);
    desk.palpate(&format!(
        "design c.toml {TARGET} --vary scene.object.a=-0.01..0.01"
    ))
    .fails(
        2,
        "relative_rms_error of mean_curvature has no value where scene.object.a = ",
    );
}
