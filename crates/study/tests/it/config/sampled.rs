//! Tests sweeps of quasi-random points, and rules that end the trials of a cell early.

use palpate_study::config::parse;

use super::{BASE, study};

const POINTS: &str = r#"[[sweep]]
sample = "sobol"
count = 256
[sweep.ranges]
"scene.object.radius" = { from = 2.0, to = 10.0 }
"scene.motion.rate_rad_per_s" = { from = 0.01, to = 1.0, spacing = "log" }
"#;

fn column(sections: &str, place: usize, count: usize) -> Vec<f64> {
    let study = study(sections);
    let cell = |number| {
        study.cell(number).unwrap().coordinates[place]
            .parse()
            .unwrap()
    };
    (0..count).map(cell).collect()
}

#[test]
fn points_fill_every_part_of_every_range_and_of_every_pair() {
    let study = study(POINTS);
    assert_eq!((study.cell_count(), study.paths.len()), (256, 2));
    assert_eq!(
        study.columns,
        ["scene.motion.rate_rad_per_s", "scene.object.radius_cm"]
    );
    let rates = column(POINTS, 0, 256);
    let radii = column(POINTS, 1, 256);
    let part = |number: f64, from: f64, to: f64, parts: f64| {
        ((number - from) / (to - from) * parts) as usize
    };
    let mut of_radii = [0; 64];
    let mut of_rates = [0; 64];
    let mut pairs = [0; 64];
    for (&rate, &radius) in rates.iter().zip(&radii) {
        let rate = libm::log10(rate);
        of_radii[part(radius, 2.0, 10.0, 64.0)] += 1;
        of_rates[part(rate, -2.0, 0.0, 64.0)] += 1;
        pairs[part(rate, -2.0, 0.0, 8.0) * 8 + part(radius, 2.0, 10.0, 8.0)] += 1;
    }
    // Sobol's points in two dimensions form a (0, m, 2) net. Therefore, each of the 64 parts of a range contains 4 of
    // the 256 points. The same is true of each of the 8 × 8 parts of both ranges.
    assert_eq!((of_radii, of_rates, pairs), ([4; 64], [4; 64], [4; 64]));
    // The first points of a larger sample equal those of this sample.
    let more = POINTS.replace("count = 256", "count = 1000");
    assert_eq!(column(&more, 1, 256), radii);
    let seeded = parse("study.toml", &format!("seed = 9\n{BASE}{POINTS}")).unwrap();
    assert_eq!(
        seeded.cell(7).unwrap().coordinates,
        study.cell(7).unwrap().coordinates
    );
}

#[test]
fn points_read_back_from_a_resolved_config() {
    let first = study(POINTS);
    let text = palpate_study::config::to_toml(&first.config);
    let again = parse("run.toml", &text).unwrap();
    for number in [0, 1, 255] {
        assert_eq!(again.cell(number).unwrap(), first.cell(number).unwrap());
    }
    assert_eq!(palpate_study::config::to_toml(&again.config), text);
}

#[test]
fn a_rule_decides_the_number_of_trials() {
    let rule = "stop = { relative_standard_error = 0.01, max_trials = 50000 }\n";
    let ruled = parse("study.toml", &format!("{rule}{BASE}")).unwrap();
    assert_eq!((ruled.config.trials, ruled.trials_of(0)), (50_000, 50_000));
    let text = palpate_study::config::to_toml(&ruled.config);
    assert_eq!(parse("run.toml", &text).unwrap().config, ruled.config);
}
