//! Tests the models that `auto` chooses: they must be cheap, and their errors must be at most the tolerance of `auto`.
//! A test cannot count processor instructions. Therefore, the tests of rolls compare the numbers of evaluations of the
//! contact equations. A glide must use the closed form if it is within the tolerance. For a press, the error of every
//! cheaper model must exceed the tolerance.

use palpate_assay::auto_check::{AutoChoice, Kind, SCENES};
use palpate_scene::Scenes;
use palpate_statistics::work::counted;
use palpate_study::config;

#[track_caller]
fn check(kind: Kind) -> Vec<AutoChoice> {
    let choices: Vec<AutoChoice> = (0..SCENES)
        .map(|number| AutoChoice::new(kind, number).unwrap())
        .collect();
    let failed: Vec<String> = choices
        .iter()
        .filter(|choice| !choice.errs_within() || !choice.seems_cheap())
        .map(|choice| {
            format!(
                "{} for {:e}: {:?} of {:#?}",
                choice.number,
                choice.tolerance,
                choice.taken(),
                choice.models
            )
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    // `auto` must not choose the same model in all scenes.
    let first = &choices[0].taken().name;
    assert!(choices.iter().any(|choice| choice.taken().name != *first));
    // In most scenes, several models meet the tolerance. In all scenes, the true values come from an independent
    // reference.
    let most = |holds: fn(&AutoChoice) -> bool| {
        let count = choices.iter().filter(|choice| holds(choice)).count();
        2 * count > choices.len()
    };
    assert!(most(|choice| choice.competitors() > 0));
    assert!(choices.iter().all(AutoChoice::has_independent_truth));
    choices
}

#[test]
fn rolls_err_within_their_tolerance() {
    let choices = check(Kind::Roll);
    let integrated = choices.iter().filter(|choice| {
        let name = &choice.taken().name;
        name.starts_with("RK4") || name.starts_with("DOP853")
    });
    assert!(integrated.count() >= 30);
}

#[test]
fn glides_err_within_their_tolerance() {
    check(Kind::Glide);
}

#[test]
fn presses_err_within_their_tolerance() {
    check(Kind::Press);
}

#[test]
fn a_coarser_integration_of_noisy_rolls_is_no_dearer() {
    for object in [
        "{ kind = \"saddle\", a = 0.1 }",
        "{ kind = \"ellipsoid\", semi_axes = [5.0, 3.0, 2.0] }",
    ] {
        for (rate, fraction) in [(0.1, 1.0), (1.0, 0.1), (3.0, 0.3)] {
            let derivatives = [1e-1, 1e-3, 1e-6, 1e-9].map(|tolerance| {
                let text = format!(
                    "name = \"noisy\"\n[scene]\nkind = \"roll\"\n\
                     probe = {{ kind = \"sphere\", radius = 1.0 }}\nobject = {object}\n\
                     object_contact = [0.3, 0.2]\n\
                     motion = {{ rate_rad_per_s = {rate}, duration_s = 1.0 }}\n\
                     model = {{ kind = \"dop853\", tolerance = {tolerance:e} }}\n\
                     noise = {{ angular_velocity = {{ kind = \"gaussian\", fraction = {fraction}, \
                     when = \"per-probe\", side = \"motion\" }} }}\n"
                );
                let study = config::parse("noisy.toml", &text).unwrap();
                let scene = study.scene(0).unwrap();
                let trials = || {
                    (0..10)
                        .filter(|&trial| scene.trial(trial, |_, _| ()).is_ok())
                        .count()
                };
                counted(trials).0.derivatives
            });
            assert!(
                derivatives[0] > 0 && derivatives.is_sorted(),
                "{object} {rate}: {derivatives:?}"
            );
        }
    }
}
