//! Counts the work that scenes cause, such as integrated rolls and drawn random numbers. The tests check that no scene
//! does unnecessary work.

use palpate_scene::Scenes;
use palpate_statistics::work::{Tally, counted};
use palpate_study::config;

const ROLL: &str = r#"
name = "roll"
length_unit = "cm"
trials = 2
[scene]
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = OBJECT
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
sensor = SENSOR
NOISE
"#;

const GLIDE: &str = r#"
name = "glide"
length_unit = "cm"
trials = 2
[scene]
kind = "glide"
probe = PROBE
object = { kind = "saddle", a = 0.1 }
motion = { finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }
NOISE
estimator = { kind = "penalised" }
evaluate = { grid = 5, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }
"#;

const PRESS: &str = r#"
name = "press"
length_unit = "mm"
trials = 2
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, layout = "published", discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
object = { kind = "sphere", radius = 80.0 }
motion = { indentation = 1.0, contact_deg = [0.0, 0.0] }
model = MODEL
sensor = SENSOR
NOISE
estimator = { kind = "half-space", indentation = "known", indentation_std = 0.02 }
"#;

/// Counted work of a scene: the work of its set-up, and the work of its first trial.
fn work(template: &str, parts: &[(&str, &str)]) -> [Tally; 2] {
    run(template, parts, 1)
}

/// Counted work of a scene: the work of its set-up, and the total work of its first `trials` trials.
fn run(template: &str, parts: &[(&str, &str)], trials: u64) -> [Tally; 2] {
    let text = parts
        .iter()
        .fold(template.to_owned(), |text, (name, part)| {
            assert!(text.contains(name), "no {name}");
            text.replace(name, part)
        });
    let study = config::parse("scene.toml", &text).unwrap();
    let (setup, scene) = counted(|| study.estimable_scene(0).unwrap());
    let (trials, done): (Tally, Result<(), &str>) =
        counted(|| (0..trials).try_for_each(|trial| scene.trial(trial, |_, _| ())));
    done.unwrap();
    [setup, trials]
}

const SPHERE: (&str, &str) = ("OBJECT", r#"{ kind = "sphere", radius = 5.0 }"#);
const IDEAL: (&str, &str) = ("SENSOR", r#"{ kind = "ideal" }"#);
const QUIET: (&str, &str) = ("NOISE", "");
const NOISY_RATE: (&str, &str) = (
    "NOISE",
    r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-probe", side = "motion" } }"#,
);

#[test]
fn an_ideal_sensor_draws_nothing_and_a_closed_form_steps_no_integrator() {
    // Two probes roll in each of the four directions, but the roll in each direction is computed only once.
    let rolls = Tally {
        rolls: 4,
        ..Tally::default()
    };
    assert_eq!(
        work(ROLL, &[SPHERE, IDEAL, QUIET]),
        [rolls, Tally::default()]
    );
}

#[test]
fn noise_draws_what_it_needs_and_nothing_else() {
    let [_, trial] = work(ROLL, &[SPHERE, IDEAL, NOISY_RATE]);
    // Two random numbers are drawn for each of the eight probes.
    let expected = Tally {
        draws: 16,
        ..Tally::default()
    };
    assert_eq!(trial, expected);
}

#[test]
fn pads_at_random_draw_their_place_only() {
    let pads = r#"{ kind = "pads", pitch = 0.05, layout = "uniform", offset = "random" }"#;
    let [setup, trial] = work(ROLL, &[SPHERE, ("SENSOR", pads), QUIET]);
    assert_eq!(setup.draws, 0);
    // For each of the eight rolls, two coordinates and one angle of the pad array are drawn at random.
    assert_eq!(trial.draws, 24, "{trial:?}");
    let [_, trial] = work(
        ROLL,
        &[
            SPHERE,
            ("SENSOR", &pads.replace("random", "random-per-trial")),
            QUIET,
        ],
    );
    assert_eq!(trial.draws, 3, "{trial:?}");
    let centred = r#"{ kind = "pads", pitch = 0.05, layout = "uniform", offset = "centred" }"#;
    let [_, trial] = work(ROLL, &[SPHERE, ("SENSOR", centred), QUIET]);
    assert_eq!(trial, Tally::default());
}

/// The counted work of a scene, without the number of random 64-bit words that are drawn.
fn without_draws(tally: Tally) -> Tally {
    Tally { draws: 0, ..tally }
}

const OBJECTS: [&str; 4] = [
    r#"{ kind = "sphere", radius = 5.0 }"#,
    r#"{ kind = "ellipsoid", semi_axes = [5.0, 3.0, 2.0] }"#,
    r#"{ kind = "torus", major_radius = 5.0, minor_radius = 2.0 }"#,
    r#"{ kind = "height-field", formula = "0.1*x^2 + 0.02*x*y^2", parameters = {} }"#,
];

#[test]
fn trials_without_noise_in_the_motion_roll_no_probe() {
    let wrist = r#"{ kind = "wrist", std = 0.001 }"#;
    let pads = r#"{ kind = "pads", pitch = 0.05, layout = "uniform", offset = "random" }"#;
    let measured = r#"noise = { rotation = { kind = "gaussian", std_deg = 0.1 }, angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-instant", instants = 10, side = "measurement" } }"#;
    for object in OBJECTS {
        for sensor in [IDEAL.1, wrist, pads] {
            for noise in ["", measured] {
                let parts = [("OBJECT", object), ("SENSOR", sensor), ("NOISE", noise)];
                let [setup, trials] = run(ROLL, &parts, 50);
                assert!(setup.rolls >= 4, "{parts:?}: {setup:?}");
                assert_eq!(without_draws(trials), Tally::default(), "{parts:?}");
            }
        }
    }
}

#[test]
fn a_doubled_direction_is_rolled_once() {
    for object in OBJECTS {
        for length in ["duration_s = 1.0", "arc_length = 0.1"] {
            let setup = |directions: &str| {
                let motion = format!("directions_deg = {directions}, {length} }}");
                let template = ROLL.replace("duration_s = 1.0 }", &motion);
                let parts = [("OBJECT", object), IDEAL, NOISY_RATE];
                run(&template, &parts, 0)[0]
            };
            let once = setup("[0, 50, 120]");
            assert!(once.rolls >= 3, "{once:?}");
            assert_eq!(setup("[0, 50, 120, 0, 50, 120, 120]"), once, "{object}");
        }
    }
}

#[test]
fn the_true_contacts_of_glides_and_presses_are_computed_once() {
    let round = ("PROBE", r#"{ kind = "sphere", radius = 0.3 }"#);
    let noise = r#"noise = { position = { kind = "gaussian", fraction_of_ifd = 0.01 } }"#;
    let [setup, trials] = run(GLIDE, &[round, ("NOISE", noise)], 20);
    assert_eq!(setup.searches, 30);
    assert_eq!(without_draws(trials), Tally::default());

    let noise = r#"noise = { normal_displacement = { kind = "gaussian", std = 0.02 } }"#;
    let noise = ("NOISE", noise);
    for (model, noise) in [(HALF_SPACE, noise), (LAYER, QUIET)] {
        let [_, trials] = run(PRESS, &[model, DIRECT, noise], 20);
        assert_eq!(without_draws(trials), Tally::default(), "{model:?}");
    }
}

#[test]
fn point_tips_search_for_no_contacts() {
    let point = ("PROBE", r#"{ kind = "point" }"#);
    assert_eq!(work(GLIDE, &[point, QUIET]), [Tally::default(); 2]);
    let noise =
        r#"noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05, axis = "z" } }"#;
    let [setup, trial] = work(GLIDE, &[point, ("NOISE", noise)]);
    assert_eq!(setup, Tally::default());
    // Some normally distributed numbers need two random 64-bit words instead of one, so the expected number of words is
    // a range.
    assert!((30..=40).contains(&trial.draws), "{trial:?}");
}

const HALF_SPACE: (&str, &str) = ("MODEL", r#"{ kind = "half-space", poisson = 0.5 }"#);
const LAYER: (&str, &str) = ("MODEL", r#"{ kind = "bonded-layer", thickness = 5.0 }"#);
const DIRECT: (&str, &str) = ("SENSOR", r#"{ kind = "direct" }"#);

#[test]
fn a_direct_press_renders_nothing_and_solves_no_layer() {
    assert_eq!(
        work(PRESS, &[HALF_SPACE, DIRECT, QUIET]),
        [Tally::default(); 2]
    );
    let [setup, trial] = work(PRESS, &[LAYER, DIRECT, QUIET]);
    assert!(setup.layers > 0, "{setup:?}");
    let frames = |tally: Tally| (tally.frames, tally.projections, tally.draws);
    assert_eq!([setup, trial].map(frames), [(0, 0, 0); 2]);
}

#[test]
fn a_camera_without_pixels_paints_no_frame() {
    let projected = ("SENSOR", r#"{ kind = "projected" }"#);
    let [setup, trial] = work(PRESS, &[HALF_SPACE, projected, QUIET]);
    assert!(setup.projections > 0 && setup.frames == 0, "{setup:?}");
    assert_eq!((trial.frames, trial.draws), (0, 0));
}

#[test]
fn a_camera_paints_one_frame_for_each_press_and_draws_only_noise() {
    let rendered = ("SENSOR", r#"{ kind = "rendered", size_px = 265 }"#);
    let clean = work(PRESS, &[HALF_SPACE, rendered, QUIET])[1];
    assert_eq!((clean.frames, clean.draws), (1, 0));
    let noise = (
        "NOISE",
        r#"noise = { pixel = { kind = "gaussian", std = 2.0 } }"#,
    );
    let noisy = work(PRESS, &[HALF_SPACE, rendered, noise])[1];
    assert_eq!(noisy.frames, 1);
    // Each of the 55,155 pixels in the image circle needs three random numbers, and one random 64-bit word gives two
    // numbers. If a row of pixels needs an odd number, the second number of its last word is not used.
    assert!((82_733..85_000).contains(&noisy.draws), "{noisy:?}");
    // The true positions of the 77 markers are computed once, to detect wrong matches.
    assert_eq!(noisy.projections, 77);
}
