//! Scenes of a glide: exact estimates, noise, sensors, maps, and settings that are rejected.

use palpate_scene::Scene;
use palpate_study::config::LengthUnit;

use super::press::{refused, scene_of};

/// Config of three fingers on the patch of the 1996 paper. `lines` contains additional fields of the scene.
fn text(probe: &str, object: &str, lines: &str) -> String {
    format!(
        r#"name = "a-study"
seed = 3

[scene]
kind = "glide"
probe = {probe}
object = {object}
motion = {{ finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }}
evaluate = {{ grid = 7, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }}
{lines}"#
    )
}

fn scene(probe: &str, object: &str, lines: &str) -> Scene {
    scene_of(&text(probe, object, lines))
}

/// Estimate, true value and standard error at each point of a trial, for each of the three estimated quantities.
fn trial(scene: &Scene, trial: u64) -> [Vec<(f64, f64, Option<f64>)>; 3] {
    let mut outcomes: [Vec<_>; 3] = Default::default();
    scene
        .trial(trial, |quantity, outcome| {
            outcomes[quantity].push((outcome.estimate, outcome.truth, outcome.std));
        })
        .unwrap();
    outcomes
}

const POINT: &str = r#"{ kind = "point" }"#;
const SADDLE: &str = r#"{ kind = "saddle", a = 0.1 }"#;
const NOISE: &str = r#"noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05 }, normal = { kind = "gaussian", std_deg = 2 } }
"#;

/// Gaussian curvature K and mean curvature H of z = a (x² − y²).
fn of_saddle(a: f64, x: f64, y: f64) -> (f64, f64) {
    let (p, q) = (2.0 * a * x, -2.0 * a * y);
    let d = 1.0 + p * p + q * q;
    let gaussian = -4.0 * a * a / (d * d);
    // The slopes are p = ∂z/∂x and q = ∂z/∂y, and d is 1 + p² + q². The second derivatives are ∂²z/∂x² = 2a, ∂²z/∂y² =
    // −2a and ∂²z/∂x∂y = 0. Therefore H is −((1 + q²) 2a − (1 + p²) 2a)/(2 d^{3/2}). It is positive where the surface
    // is convex.
    let mean = -a * (q * q - p * p) / libm::pow(d, 1.5);
    (gaussian, mean)
}

#[test]
fn without_noise_a_saddle_is_exact_everywhere() {
    for estimator in [
        r#"estimator = { kind = "quadric" }"#,
        r#"estimator = { kind = "penalised" }"#,
        r#"estimator = { kind = "penalised", criterion = "reml" }"#,
        "sensor = { kind = \"ideal\", normals = false }\nestimator = { kind = \"penalised\" }",
    ] {
        for probe in [POINT, r#"{ kind = "sphere", radius = 0.7 }"#] {
            let scene = scene(probe, SADDLE, estimator);
            assert_eq!(scene.trials(1000), 1);
            let [gaussian, mean, class] = trial(&scene, 0);
            assert_eq!([gaussian.len(), mean.len(), class.len()], [49; 3]);
            for place in 0..49 {
                let [x, y] = [place / 7, place % 7].map(|index| f64::from(index) / 3.0 - 1.0);
                let (true_gaussian, true_mean) = of_saddle(0.1, x, y);
                let place = place as usize;
                assert!((gaussian[place].1 - true_gaussian).abs() < 1e-15);
                assert!((mean[place].1 - true_mean).abs() < 1e-15);
                assert!(
                    (gaussian[place].0 - true_gaussian).abs() < 1e-9,
                    "{estimator} {probe}"
                );
                assert!(
                    (mean[place].0 - true_mean).abs() < 1e-9,
                    "{estimator} {probe}"
                );
                assert_eq!(
                    (class[place].0, class[place].1, class[place].2),
                    (1.0, 1.0, None)
                );
            }
        }
    }
}

#[test]
fn the_truth_exists_if_it_is_the_same_everywhere() {
    let truths = |object: &str| {
        let scene = scene(POINT, object, NOISE);
        [0, 1, 2].map(|quantity| scene.truth(quantity))
    };
    let sphere = truths(r#"{ kind = "sphere", radius = 5 }"#);
    assert!((sphere[0].unwrap() - 0.04).abs() < 1e-16 && (sphere[1].unwrap() - 0.2).abs() < 1e-16);
    for direction in ["0", "30", "45", "90"] {
        let cylinder = truths(&format!(
            r#"{{ kind = "cylinder", radius = 5, direction_deg = {direction} }}"#
        ));
        assert_eq!(cylinder, [Some(0.0), Some(0.1), Some(1.0)], "{direction}");
    }
    assert_eq!(truths(SADDLE), [None, None, Some(1.0)]);
}

#[test]
fn trials_differ_and_can_be_replayed_and_methods_share_draws() {
    let noisy = |estimator: &str| scene(POINT, SADDLE, &format!("{NOISE}estimator = {estimator}"));
    let quadric = noisy(r#"{ kind = "quadric" }"#);
    assert_eq!(quadric.trials(1000), 1000);
    assert_eq!(trial(&quadric, 4), trial(&quadric, 4));
    assert_ne!(trial(&quadric, 4), trial(&quadric, 5));
    let readings = |scene: &Scene| scene.trace(Some(4), LengthUnit::Unit).unwrap().readings;
    assert_eq!(
        readings(&quadric),
        readings(&noisy(r#"{ kind = "two-pass", passes = 1 }"#))
    );
}

#[test]
fn noise_has_the_stated_size() {
    let scene = scene(
        POINT,
        r#"{ kind = "plane" }"#,
        r#"noise = { position = { kind = "uniform", fraction_of_ifd = 0.3, axis = "z" } }
"#,
    );
    let (mut square, mut count) = (0.0, 0);
    for trial in 0..100 {
        let table = scene.trace(Some(trial), LengthUnit::Unit).unwrap().readings;
        for row in &table.rows {
            let number = |column: usize| row[column].parse::<f64>().unwrap();
            assert!(number(3).abs() <= 0.3);
            assert_eq!((number(4), number(5), number(6)), (0.0, 0.0, 1.0));
            square += number(3).powi(2);
            count += 1;
        }
    }
    let std = (square / f64::from(count)).sqrt();
    assert!((std / (0.3 / 3.0_f64.sqrt()) - 1.0).abs() < 0.03, "{std}");
}

/// Tests contacts that are computed from the lowest points of a tip. If a tip of radius r slides on a sphere of radius
/// R, its lowest points lie on a sphere of radius R + r. The contacts computed from them lie on the sphere of radius R,
/// whether or not the sensor also reports normals.
#[test]
fn contacts_are_found_from_the_lowest_points_of_round_tips() {
    let sphere = |sensor: &str, method: &str| {
        let lines = format!(
            "sensor = {{ kind = \"ideal\", {sensor} }}\nestimator = {{ kind = \"{method}\" }}"
        );
        let scene = scene(
            r#"{ kind = "sphere", radius = 50 }"#,
            r#"{ kind = "sphere", radius = 100 }"#,
            &lines,
        );
        let [_, mean, _] = trial(&scene, 0);
        mean[24].0
    };
    for normals in ["normals = true", "normals = false"] {
        for reports in ["contact", "lowest-point"] {
            for method in ["penalised", "sphere", "shape"] {
                let found = sphere(&format!("reports = \"{reports}\", {normals}"), method);
                assert!(
                    (found * 100.0 - 1.0).abs() < 2e-3,
                    "{reports}, {normals}, {method}: {found}"
                );
            }
        }
    }
}

#[test]
fn pads_quantise_position_and_normal_alike() {
    let traced = |pitch: f64| {
        let scene = scene(
            r#"{ kind = "sphere", radius = 2 }"#,
            r#"{ kind = "sphere", radius = 5 }"#,
            &format!("sensor = {{ kind = \"pads\", pitch = {pitch} }}"),
        );
        assert_eq!(scene.trials(10), 1);
        scene.trace(None, LengthUnit::Unit).unwrap()
    };
    let numbers =
        |row: &[String]| -> Vec<f64> { row.iter().map(|field| field.parse().unwrap()).collect() };
    let trace = traced(0.5);
    let mut pads = std::collections::BTreeSet::new();
    for (truth, reading) in trace.contacts.rows.iter().zip(&trace.readings.rows) {
        let (truth, reading) = (numbers(truth), numbers(reading));
        let mut off = 0.0_f64;
        for axis in 0..3 {
            // The sensor reports the centre of the tip minus the radius (2) times the sensed normal.
            let [centre, normal, position] =
                [truth[7 + axis], reading[4 + axis], reading[1 + axis]];
            assert!((position - (centre - 2.0 * normal)).abs() < 1e-12);
            off = off.max((position - truth[1 + axis]).abs());
        }
        assert!(off < 0.5, "{off}");
        pads.insert(format!("{} {}", reading[4], reading[5]));
    }
    assert!((4..15).contains(&pads.len()), "{}", pads.len());
    // Pads with a very small pitch (1e-6) report the true contacts almost exactly.
    let fine = traced(1e-6);
    for (truth, reading) in fine.contacts.rows.iter().zip(&fine.readings.rows) {
        let (truth, reading) = (numbers(truth), numbers(reading));
        assert!((1..7).all(|column| (truth[column] - reading[column]).abs() < 2e-6));
    }
}

#[test]
fn scenes_that_cannot_be() {
    let saddle = |lines: &str| text(POINT, SADDLE, lines);
    let pads = r#"sensor = { kind = "pads", pitch = 0.1, cap_deg = 5 }"#;
    for (text, message) in [
        (
            saddle(r#"sensor = { kind = "pads", pitch = 0.1 }"#),
            r#"scene.sensor: pads need a round tip: `scene.probe` with kind = "sphere""#,
        ),
        (
            text(POINT, r#"{ kind = "sphere", radius = 2 }"#, ""),
            "scene.motion: finger 0, contact 0 (counting from 0): the finger left the object",
        ),
        (
            text(r#"{ kind = "sphere", radius = 1 }"#, SADDLE, pads),
            "scene.sensor.cap_deg: the contact is ",
        ),
        (
            saddle("").replace("half_width = 1.0", "half_width = 1e200"),
            "scene.evaluate.half_width: the grid: ",
        ),
        (
            saddle(r#"estimator = { kind = "two-pass", first_degree = 1, passes = 1 }"#),
            "scene.estimator.first_degree: ",
        ),
    ] {
        let said = refused(&text);
        assert!(said.starts_with(message), "{said}");
    }
}

#[test]
fn maps_hold_truth_and_estimate_of_every_place() {
    let scene = scene(POINT, r#"{ kind = "saddle", a = 0.3 }"#, NOISE);
    let mut table = palpate_estimators::map_table(LengthUnit::Mm, true);
    scene.map(3, 0, &mut table).unwrap();
    let csv = table.to_csv();
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(header.len(), 31);
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let [gaussian, _, class] = trial(&scene, 0);
    let mut rows = 0;
    for (line, place) in lines.zip(0..) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 31);
        assert_eq!(fields[0], "3");
        let number = |name: &str| fields[column(name)].parse::<f64>().unwrap();
        let place: usize = place;
        assert!((number("gaussian_curvature_per_mm2") - gaussian[place].0).abs() < 1e-12);
        let is_right = fields[column("class")] == fields[column("true_class")];
        assert_eq!(f64::from(u8::from(is_right)), class[place].0);
        let probabilities: f64 = header
            .iter()
            .filter(|name| name.starts_with("probability_"))
            .map(|name| number(name))
            .sum();
        assert!((probabilities - 1.0).abs() < 1e-9);
        rows += 1;
    }
    assert_eq!(rows, 49);
}

#[test]
fn noise_in_lengths_is_that_in_shares_of_the_fingers_distance() {
    // The inter-finger distance is 0.5, so that a fraction of this distance and a length are different numbers.
    let near = "inter_finger_distance = 0.5";
    let trial_of = |lines: &str| {
        let text = text(POINT, SADDLE, lines).replace("inter_finger_distance = 1.0", near);
        trial(&scene_of(&text), 4)
    };
    for [share, length] in [
        [
            "kind = \"gaussian\", fraction_of_ifd = 0.06",
            "kind = \"gaussian\", std = 0.03",
        ],
        [
            "kind = \"uniform\", fraction_of_ifd = 0.06",
            "kind = \"uniform\", bound = 0.03",
        ],
    ] {
        let noise = |position: &str| format!("noise = {{ position = {{ {position} }} }}\n");
        assert_eq!(trial_of(&noise(share)), trial_of(&noise(length)));
        // The config also states the noise that the estimator assumes, either as a length or as a fraction of the
        // inter-finger distance.
        let stated = |key: &str| {
            format!(
                "{}estimator = {{ kind = \"penalised\", {key} }}\n",
                noise(length)
            )
        };
        let stated_length = trial_of(&stated("position_std = 0.03"));
        assert_eq!(
            stated_length,
            trial_of(&stated("position_fraction_of_ifd = 0.06"))
        );
        assert_ne!(stated_length, trial_of(&stated("position_std = 0.3")));
    }
    for (lines, said) in [
        (
            "noise = { position = { kind = \"gaussian\", std = 0.1, fraction_of_ifd = 0.1 } }",
            "scene.noise.position.fraction_of_ifd: cannot be combined with `std`; keep one of them",
        ),
        (
            "noise = { position = { kind = \"gaussian\" } }",
            "scene.noise.position: needs `std`, a length, or `fraction_of_ifd`",
        ),
        (
            "noise = { position = { kind = \"uniform\", std = 0.1 } }",
            "scene.noise.position.std: unknown key for kind `uniform`; known: axis, bound, fraction_of_ifd, kind; kind `gaussian` has it",
        ),
        (
            "estimator = { kind = \"quadric\", position_std = 0.1, position_fraction_of_ifd = 0.1 }",
            "scene.estimator.position_fraction_of_ifd: cannot be combined with `position_std`; keep one of them",
        ),
    ] {
        assert_eq!(refused(&text(POINT, SADDLE, lines)), said);
    }
}
