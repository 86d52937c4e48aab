//! The ladders of models, and what `auto` takes of them.

use palpate_scene::config::{ModelConfig, RollModelConfig, to_toml};
use palpate_scene::{Ladder, Rung, Scene, config};

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

/// The rung that is taken errs by at most the tolerance, and no cheaper one does.
fn keeps_its_word(ladder: &Ladder) {
    let error = ladder.taken().outcome.as_ref().unwrap();
    assert!(*error <= ladder.tolerance.unwrap(), "{ladder:#?}");
}

#[test]
fn a_roll_on_a_sphere_is_in_closed_form() {
    let text = roll(
        r#"{ kind = "sphere", radius = 5.0 }"#,
        "",
        r#"{ kind = "auto", tolerance = 1e-9 }"#,
    );
    let ladder = ladder(&text);
    assert_eq!(ladder.taken, 0);
    let model = ModelConfig::Roll(RollModelConfig::ClosedForm {});
    assert_eq!(ladder.taken().model, model);
    keeps_its_word(&ladder);
    // The meridian cannot: its contact is no apex of a graph.
    let meridian = &ladder.rungs[1];
    assert_eq!(meridian.name, "meridian");
    assert!(meridian.outcome.is_err());
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
    keeps_its_word(&ladder);
    let arc_length = |scene: &Scene| scene.truth(4).unwrap();
    let error = |rung: &&Rung| rung.outcome.clone().unwrap_or(f64::INFINITY);
    let finest = |one: &&Rung, other: &&Rung| error(one).total_cmp(&error(other));
    let finest = ladder.rungs.iter().min_by(finest).unwrap();
    let truth = arc_length(&study.with_model(0, finest).unwrap());
    let mut judged = 0;
    for rung in &ladder.rungs {
        let Ok(error) = rung.outcome else {
            assert!(study.with_model(0, rung).is_err(), "{}", rung.name);
            continue;
        };
        let off = arc_length(&study.with_model(0, rung).unwrap()) - truth;
        assert!(off.abs() <= 10.0 * error + 1e-12, "{}: {off:e}", rung.name);
        judged += 1;

        let mut named = study.clone();
        named.override_model(&rung.model).unwrap();
        let again = config::parse("run.toml", &to_toml(&named.config)).unwrap();
        assert_eq!(again.config, named.config);
        let again = again.ladder(0).unwrap().unwrap();
        assert_eq!(again.taken().model, rung.model);
        assert_eq!(again.tolerance, None);
    }
    assert!(judged > 8, "{ladder:#?}");
}

#[test]
fn a_model_that_is_swept_cannot_be_replaced() {
    let text = roll(
        r#"{ kind = "saddle", a = 0.3 }"#,
        "",
        r#"{ kind = "auto", tolerance = 1e-6 }"#,
    ) + "[[sweep]]\npath = \"scene.model.tolerance\"\nvalues = [1e-3, 1e-6]\n";
    let mut study = config::parse("study.toml", &text).unwrap();
    let error = study
        .override_model(&ModelConfig::Roll(RollModelConfig::ClosedForm {}))
        .unwrap_err();
    assert_eq!(error.path(), "scene.model");
    assert!(error.message().contains("swept"), "{error}");
}
