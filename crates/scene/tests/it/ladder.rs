//! The ladder of a scene (the models that can compute it), and the model that `auto` chooses.

use palpate_scene::{Ladder, Rung, Scene, Scenes, SharedModels};
use palpate_study::config;
use palpate_study::config::{FieldError, Study, to_toml};

fn ladder(text: &str) -> Ladder {
    let study = config::parse("study.toml", text).unwrap();
    study.ladder(0).unwrap().unwrap()
}

fn roll(object: &str, contact: &str, model: &str) -> String {
    format!(
        "name = \"roll\"\n[scene]\nkind = \"roll\"\n\
         probe = {{ kind = \"sphere\", radius = 1.0 }}\n\
         object = {object}\n{contact}\n\
         motion = {{ rate_rad_per_s = 0.5, duration_s = 1.0 }}\nmodel = {model}\n"
    )
}

fn meets_its_tolerance(ladder: &Ladder) {
    let error = ladder.taken().accuracy.error().unwrap();
    assert!(error <= ladder.tolerance.unwrap(), "{ladder:#?}");
}

fn with_model(study: &Study, rung: &Rung) -> Result<Scene, FieldError> {
    let (config, models) = (&study.config, SharedModels::default());
    let scene = config.scene.with_model(&rung.model).unwrap();
    Scene::new(&scene, config.length_unit, config.seed, &models)
}

#[test]
fn any_rung_makes_the_same_scene_and_a_config_that_reads_back() {
    let text = roll(
        r#"{ kind = "saddle", a = 0.3 }"#,
        "object_contact = [0.2, 0.1]",
        r#"{ kind = "auto", tolerance = 1e-6 }"#,
    );
    let study = config::parse("study.toml", &text).unwrap();
    let ladder = study.ladder(0).unwrap().unwrap();
    meets_its_tolerance(&ladder);
    let arc_length = |scene: &Scene| scene.truth(4).unwrap();
    let error = |rung: &&Rung| rung.accuracy.error().unwrap_or(f64::INFINITY);
    let finest = |one: &&Rung, other: &&Rung| error(one).total_cmp(&error(other));
    let finest = ladder.rungs.iter().min_by(finest).unwrap();
    let truth = arc_length(&with_model(&study, finest).unwrap());
    let mut compared = 0;
    for rung in &ladder.rungs {
        let Some(error) = rung.accuracy.error() else {
            assert!(with_model(&study, rung).is_err(), "{}", rung.name);
            continue;
        };
        let off = arc_length(&with_model(&study, rung).unwrap()) - truth;
        assert!(off.abs() <= 10.0 * error + 1e-12, "{}: {off:e}", rung.name);
        compared += 1;

        let mut named = study.clone();
        named.config.scene = named.config.scene.with_model(&rung.model).unwrap();
        let again = config::parse("run.toml", &to_toml(&named.config)).unwrap();
        assert_eq!(again.config, named.config);
        let again = again.ladder(0).unwrap().unwrap();
        assert_eq!(again.taken().model, rung.model);
        assert_eq!(again.tolerance, None);
    }
    assert!(compared > 8, "{ladder:#?}");
}

fn glide(object: &str, probe: &str, model: &str) -> String {
    format!(
        "name = \"glide\"\n[scene]\nkind = \"glide\"\nprobe = {probe}\nobject = {object}\n{model}\n\
         motion = {{ finger_positions = [-1.0, 0.0, 1.0], inter_finger_distance = 1.0, patch_length = 2.0, \
         contacts_per_finger = 5 }}\n\
         evaluate = {{ half_width = 0.5, gaussian_threshold = 1e-3, mean_threshold = 1e-3 }}\n"
    )
}

const TIP: &str = r#"{ kind = "sphere", radius = 0.5 }"#;
const SADDLE: &str = r#"{ kind = "saddle", a = 0.2 }"#;

fn press(depth: f64, model: &str, indentation: f64, estimator: &str) -> String {
    format!(
        "name = \"press\"\n[scene]\nkind = \"press\"\n\
         probe = {{ kind = \"marker-sphere\", radius = 20.0, marker_depth = {depth} }}\n\
         object = {{ kind = \"plane\" }}\nmotion = {{ indentation = {indentation} }}\n\
         model = {model}\nestimator = {estimator}\n"
    )
}

const HALF_SPACE: &str = r#"{ kind = "half-space" }"#;

fn taken(text: &str) -> (String, f64) {
    let ladder = ladder(text);
    meets_its_tolerance(&ladder);
    let rung = ladder.taken();
    (rung.name.clone(), rung.accuracy.error().unwrap())
}

#[test]
fn markers_count_as_at_the_surface_only_if_they_are() {
    let auto = r#"{ kind = "auto", tolerance = 1e-3 }"#;
    let (name, error) = taken(&press(0.0, auto, 1.0, HALF_SPACE));
    assert!(name.starts_with("Hertz") && error == 0.0, "{name} {error}");
    let (name, error) = taken(&press(1e-3, auto, 1.0, HALF_SPACE));
    // The error of Hertz contact is small here, but the half-space costs the same and has no error.
    assert!(
        name.starts_with("half-space") && error == 0.0,
        "{name} {error}"
    );
}

#[test]
fn a_shape_counts_and_not_its_name() {
    let auto = r#"{ kind = "auto", tolerance = 1e-9 }"#;
    for (object, contact) in [
        (r#"{ kind = "sphere", radius = 5.0 }"#, ""),
        (
            r#"{ kind = "ellipsoid", semi_axes = [5, 5, 5] }"#,
            "object_contact = [1.0, 2.0]",
        ),
        (r#"{ kind = "saddle", a = 0 }"#, ""),
        (
            r#"{ kind = "paraboloid", c = 0 }"#,
            "object_contact = [1.0, 2.0]",
        ),
    ] {
        let ladder = ladder(&roll(object, contact, auto));
        assert_eq!(ladder.taken().name, "closed form", "{object}");
        meets_its_tolerance(&ladder);
    }
}

#[test]
fn a_layer_is_solved_only_where_it_is_thin() {
    let auto = |thickness: f64, tolerance: f64| {
        format!(r#"{{ kind = "auto", thickness = {thickness}, tolerance = {tolerance} }}"#)
    };
    let thin = press(1.0, &auto(4.0, 1e-3), 0.5, HALF_SPACE);
    assert!(taken(&thin).0.starts_with("bonded layer"));
    // The displacements of a thick layer are smaller than those of a half-space, because the core under the layer is
    // rigid. The relative difference is about a/t, with the contact radius a and the thickness t of the layer.
    let thick = press(0.01, &auto(20.0, 1e-3), 1e-9, HALF_SPACE);
    let ladder = ladder(&thick);
    let [_, half_space, layer] = &ladder.rungs[..] else {
        panic!("{ladder:#?}");
    };
    assert!(half_space.accuracy.error().unwrap() < 2e-2 && layer.accuracy.error() == Some(0.0));
    let thick = press(0.01, &auto(20.0, 0.02), 1e-9, HALF_SPACE);
    assert!(taken(&thick).0.starts_with("half-space"));
}

#[test]
fn an_estimator_uses_the_layer_of_auto() {
    let estimator = r#"{ kind = "bonded-layer" }"#;
    // Because the tolerance (0.2) is large, `auto` chooses the half-space. The estimator still assumes the layer.
    let model = r#"{ kind = "auto", thickness = 20.0, tolerance = 0.2 }"#;
    let text = press(1.0, model, 0.1, estimator);
    let study = config::parse("study.toml", &text).unwrap();
    let ladder = study.ladder(0).unwrap().unwrap();
    assert!(ladder.taken().name.starts_with("half-space"), "{ladder:#?}");
    let outcomes = |scene: &Scene| {
        let mut outcomes = Vec::new();
        let trial = scene.trial(0, |_, outcome| outcomes.push(outcome.estimate));
        trial.unwrap_or_else(|error| panic!("{error}: {:?}", scene.needs()));
        outcomes
    };
    let auto = outcomes(&study.scene(0).unwrap());
    // Replace `auto` in the config by the model that it chose, which has no layer. The estimator must still use the
    // thickness of the layer.
    let mut explicit = study.clone();
    explicit.config.scene = explicit
        .config
        .scene
        .with_model(&ladder.taken().model)
        .unwrap();
    let again = config::parse("run.toml", &to_toml(&explicit.config)).unwrap();
    assert_eq!(outcomes(&again.scene(0).unwrap()), auto);
    let layer = ladder.rungs.last().unwrap();
    let exact = outcomes(&with_model(&study, layer).unwrap());
    assert!((exact[0] / 0.05 - 1.0).abs() < 1e-5, "{exact:?}");
    assert!((auto[0] / 0.05 - 1.0).abs() > 1e-3, "{auto:?}");
}

#[test]
fn tolerances_out_of_range_are_refused() {
    for tolerance in ["nan", "0.0", "1e-15", "0.11"] {
        let auto = format!("{{ kind = \"auto\", tolerance = {tolerance} }}");
        for text in [
            roll(SADDLE, "", &auto),
            glide(SADDLE, TIP, &format!("model = {auto}")),
        ] {
            let study = config::parse("study.toml", &text);
            let error = study.and_then(|study| study.ladder(0)).unwrap_err();
            assert_eq!(error.path, "scene.model.tolerance", "{tolerance}");
        }
    }
}
