//! `auto` errs by at most its tolerance. What its choice costs is judged by counting instructions, which is no test;
//! here what stands for it is how often a roll asks for derivatives, and the order of the other ladders.

use palpate_assay::promise::{Kind, Promise, SCENES};
use palpate_scene::Scenes;
use palpate_statistics::work::counted;
use palpate_study::config;

#[track_caller]
fn judge(kind: Kind) -> Vec<Promise> {
    let promises: Vec<Promise> = (0..SCENES)
        .map(|number| Promise::of(kind, number).unwrap())
        .collect();
    let broken: Vec<String> = promises
        .iter()
        .filter(|promise| !promise.errs_within() || !promise.seems_cheap())
        .map(|promise| {
            format!(
                "{} for {:e}: {:?} of {:#?}",
                promise.number,
                promise.tolerance,
                promise.taken(),
                promise.rivals
            )
        })
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    // More than one rung is ever taken.
    let first = &promises[0].taken().name;
    assert!(
        promises
            .iter()
            .any(|promise| promise.taken().name != *first)
    );
    // There is something to choose from, and to judge by.
    let most = |holds: fn(&Promise) -> bool| {
        let count = promises.iter().filter(|promise| holds(promise)).count();
        2 * count > promises.len()
    };
    assert!(most(|promise| promise.competitors() > 0));
    assert!(promises.iter().all(Promise::is_judged_by_another));
    promises
}

#[test]
fn rolls_err_within_their_tolerance() {
    let promises = judge(Kind::Roll);
    let integrated = promises.iter().filter(|promise| {
        let name = &promise.taken().name;
        name.starts_with("RK4") || name.starts_with("DOP853")
    });
    assert!(integrated.count() >= 30);
}

#[test]
fn glides_err_within_their_tolerance() {
    judge(Kind::Glide);
}

#[test]
fn presses_err_within_their_tolerance() {
    judge(Kind::Press);
}

/// The coarser DOP853, the less it asks for; where rolls are disturbed as well, which `auto` does not try.
#[test]
fn a_coarser_integration_of_noisy_rolls_is_no_dearer() {
    for object in [
        "{ kind = \"saddle\", a = 0.1 }",
        "{ kind = \"ellipsoid\", semi_axes = [5.0, 3.0, 2.0] }",
    ] {
        for (rate, fraction) in [(0.1, 1.0), (1.0, 0.1), (3.0, 0.3)] {
            let asked = [1e-1, 1e-3, 1e-6, 1e-9].map(|tolerance| {
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
                asked[0] > 0 && asked.is_sorted(),
                "{object} {rate}: {asked:?}"
            );
        }
    }
}
