//! Tests `palpate distinguish`, which computes how often single trials put swept objects in the right order.

use serde_json::Value;

use super::desk::{Desk, STUDY, edited, noiseless};

/// A study of balls with radii of 50, 40 and 5 mm, in which the angular velocity of the probe has an error of 20 %.
fn balls() -> String {
    let noisy = edited(STUDY, "fraction = 0.01", "fraction = 0.2");
    edited(
        &edited(&noisy, "values = [50, 5]", "values = [50, 40, 5]"),
        "trials = 20",
        "trials = 4000",
    )
}

#[test]
fn the_probability_is_that_of_single_trials() {
    let desk = Desk::with(&balls());
    let answer = desk.json("distinguish c.toml --out out");
    let pairs = answer["groups"][0]["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 3);
    // The pairs are sorted by the curvature of the balls, whose radii are 50, 40 and 5 mm.
    let of = |pair: &Value, key: &str| pair[key].as_f64().unwrap();
    assert_eq!(
        (&pairs[0]["first"], &pairs[0]["second"]),
        (&"50 mm".into(), &"40 mm".into())
    );
    // Also compute the share of trials in the right order from a run. This computation pairs the trials in another way
    // than `palpate distinguish`.
    desk.palpate("run c.toml --trials 4000 --out run --trials-out trials.csv")
        .printed();
    let table = desk.table("trials.csv");
    let estimates = |cell: &str| -> Vec<f64> {
        let rows = (0..table.rows.len()).filter(|&row| {
            table.text(row, "cell") == cell && table.text(row, "quantity") == "mean_curvature"
        });
        rows.map(|row| table.number(row, "estimate")).collect()
    };
    let (flat, curved) = (estimates("0"), estimates("1"));
    // Pair trials with different numbers, because trials with the same number use the same random numbers.
    let pairs_of = flat.iter().zip(curved.iter().cycle().skip(7));
    let right = pairs_of.filter(|(one, other)| one < other).count() as f64 / flat.len() as f64;
    assert!(
        (of(&pairs[0], "told_apart") - right).abs() < 0.03,
        "{right}: {answer}"
    );
    assert!(of(&pairs[0], "low95") < right + 0.02 && of(&pairs[0], "high95") > right - 0.02);
    assert!(of(&pairs[1], "told_apart") > 0.999 && of(&pairs[1], "repeats") == 1.0);
    assert!(of(&pairs[0], "repeats") > 1.0);
    let names = [
        "distinguish.csv",
        "distinguish.png",
        "distinguish.svg",
        "distinguish.txt",
    ];
    assert_eq!(desk.names("out"), names);
    assert_eq!(desk.table("out/distinguish.csv").rows.len(), 3);
}

#[test]
fn threads_do_not_change_a_byte_and_groups_differ_in_nothing_else() {
    let desk = Desk::with(&balls());
    let vary = "--vary scene.noise.angular_velocity.fraction=0.01,0.05 --trials 500";
    let files = ["distinguish.csv", "distinguish.svg", "distinguish.txt"];
    desk.assert_alike_on_any_threads(&format!("distinguish c.toml {vary}"), &files);
    let words = desk.read("out-1/distinguish.txt");
    assert_eq!(words.lines().count(), 4);
    assert!(
        words.starts_with("angular velocity noise 1 %: 50 mm and 40 mm: "),
        "{words}"
    );
}

#[test]
fn classes_are_told_by_most_places() {
    let desk = Desk::with(
        r#"name = "shapes"
length_unit = "mm"
trials = 40
[scene]
kind = "glide"
probe = { kind = "point" }
object = { kind = "plane" }
motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, patch_length = 30.0, contacts_per_finger = 10 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.001 } }
evaluate = { grid = 5, half_width = 10.0, gaussian_threshold = 0.0001, mean_threshold = 0.004 }
[[sweep]]
path = "scene.object"
values = [{ label = "flat", kind = "plane" }, { label = "ball", kind = "sphere", radius = 40.0 }, { label = "larger ball", kind = "sphere", radius = 50.0 }]
"#,
    );
    let said = desk
        .palpate("distinguish c.toml --quantity class")
        .printed();
    assert!(
        said.contains("flat and ball: 100 % of single glides put them in the right order"),
        "{said}"
    );
    assert!(
        said.contains("ball and larger ball have the same "),
        "{said}"
    );
}

/// Each row: arguments | words of the expected error. If the arguments contain two wrong names, the error mentions the
/// earlier one.
const QUESTIONS: &str = "
--set scene.object.radius=5 | no field of `scene.object` is swept
--confidence 1 | confidence is 1; it must be above 0 and below 1
--vary scene.object.radius=1..2 | list the values of scene.object.radius
--vary scene.object.radius=1,1 | occurs twice on this axis
--vary scene.object.radios=1,2 | c.toml: scene.object.radios
";

#[test]
fn what_cannot_be_told_apart() {
    Desk::with(STUDY).refuses("distinguish c.toml", QUESTIONS);
    // In a sweep, values that are tables need a label. In `--vary`, they do not.
    let shapes = "scene.object={kind=\"sphere\",radius=20},{kind=\"plane\"}";
    Desk::with(STUDY)
        .palpate(&format!("distinguish c.toml --trials 20 --vary {shapes}"))
        .prints("plane and sphere: ");
    // Without noise, every single trial puts the two balls in the right order.
    let desk = Desk::with(&noiseless());
    desk.palpate("distinguish c.toml").prints("50 mm and 5 mm: 100 % of single trials of 8 rolls put them in the right order (100 to 100); one is enough for 95 %.");
}
