//! Tests warnings about wrong signs, columns and units in readings of rolls and glides. Readings without a mistake
//! must cause no warning.

use std::path::Path;

use palpate_recorded::{
    GlideOptions, GlideRecording, ReadingNoise, RecordedFile, RollOptions, RollRecording,
    estimate_glide, estimate_roll,
};
use palpate_scene::{Scene, Scenes};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::{LengthUnit, SceneConfig, StudyConfig, load};

/// Parts of the texts of the tested warnings.
const WORDS: [&str; 7] = [
    "contradict the positions of the contacts",
    "but the readings show",
    "less than the distance between two pads",
    "as far as on a plane",
    "times as far in one direction",
    "whole turn",
    "point inward",
];

fn warnings(estimate: &impl serde::Serialize) -> Vec<String> {
    let json = serde_json::to_value(estimate).unwrap();
    let all = json["warnings"].as_array().unwrap().iter();
    all.map(|warning| warning["text"].as_str().unwrap().to_owned())
        .filter(|warning| WORDS.iter().any(|words| warning.contains(words)))
        .collect()
}

/// Simulates the readings of one trial, estimates the curvature with the settings of the study, and returns the warnings.
/// `None` if the trial fails.
fn of_trial(scene: &Scene, config: &StudyConfig, trial: u64) -> Option<Vec<String>> {
    let unit = config.length_unit;
    let trace = scene.trace(Some(trial), unit).ok()?;
    let file = RecordedFile::new("readings.csv", trace.readings.to_csv().into_bytes());
    match config.scene {
        SceneConfig::Roll(_) => {
            let options = palpate::roll_options(config, unit).unwrap();
            let estimate = estimate_roll(RollRecording::try_from(file).ok()?, &options).ok()?;
            Some(warnings(&estimate))
        }
        SceneConfig::Glide(_) => {
            let options = GlideOptions {
                grid: 3,
                ..GlideOptions::from_study(config, unit).unwrap()
            };
            let (estimate, _) =
                estimate_glide(&GlideRecording::try_from(file).ok()?, &options).ok()?;
            Some(warnings(&estimate))
        }
        _ => None,
    }
}

/// None of the committed studies and examples of rolls and glides causes one of the tested warnings.
#[test]
fn readings_of_studies_cause_no_warnings() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut estimated = 0;
    for folder in ["sim-configs", "examples"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let study = load(&path).unwrap();
            let step = study.cell_count().div_ceil(3);
            for number in (0..study.cell_count()).step_by(step) {
                let config = study.cell(number).unwrap().config;
                if !matches!(config.scene, SceneConfig::Roll(_) | SceneConfig::Glide(_)) {
                    continue;
                }
                let Ok(scene) = study.estimable_scene(number) else {
                    continue;
                };
                for trial in 0..scene.trials(1) {
                    if let Some(warnings) = of_trial(&scene, &config, trial) {
                        let place = format!("{} cell {number}", path.display());
                        assert!(warnings.is_empty(), "{place}: {warnings:#?}");
                        estimated += 1;
                    }
                }
            }
        }
    }
    assert!(estimated > 40, "{estimated}");
}

/// Eight rolls by 0.5 rad of a probe of radius 8 mm on a ball of radius 30 mm. The shifts have Gaussian noise; `set`
/// selects the random numbers.
fn rolls(std: f64, set: u64) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let mut stream = Stream::new(set, 0, Channel::WristContact);
    let mobility = 1.0 / (1.0 / 8.0 + 1.0 / 30.0);
    (0..8)
        .map(|probe| {
            let angle = f64::from(probe) * std::f64::consts::FRAC_PI_4;
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            let shift =
                [cos, sin].map(|part| 0.5 * mobility * part + std * stream.standard_normal());
            ([0.5 * sin, -0.5 * cos], shift)
        })
        .unzip()
}

fn of_rolls(rotations: &[[f64; 2]], shifts: &[[f64; 2]], noise: ReadingNoise) -> Vec<String> {
    let readings = RollRecording::new(rotations, shifts, Some(LengthUnit::Mm)).unwrap();
    let options = RollOptions {
        noise,
        ..RollOptions::new(8.0)
    };
    warnings(&estimate_roll(readings, &options).unwrap())
}

fn shift_noise(shift_std: f64) -> ReadingNoise {
    ReadingNoise {
        shift_std,
        ..ReadingNoise::default()
    }
}

/// If the noise is stated correctly, none of 2,000 sets of readings causes a warning. If it is stated eight times too
/// large, or if shifts in cm are declared as mm, each of 250 sets causes a warning.
#[test]
fn a_far_too_large_stated_noise_causes_a_warning() {
    let says = |found: &[String], words| usize::from(found.iter().any(|one| one.contains(words)));
    let (mut sound, mut large, mut in_cm) = (0, 0, 0);
    for set in 0..2000 {
        let (rotations, shifts) = rolls(0.1, set);
        sound += of_rolls(&rotations, &shifts, shift_noise(0.1)).len();
        if set < 250 {
            let found = of_rolls(&rotations, &shifts, shift_noise(0.8));
            large += says(&found, "noise of shifts is stated as 0.8 mm");
            let shifts = shifts.iter().map(|shift| shift.map(|part| 0.1 * part));
            let shifts: Vec<[f64; 2]> = shifts.collect();
            let found = of_rolls(&rotations, &shifts, shift_noise(0.1));
            in_cm += says(&found, "noise of shifts is stated as 0.1 mm");
        }
    }
    assert_eq!((sound, large, in_cm), (0, 250, 250));
}

#[test]
fn a_pitch_longer_than_the_shifts_causes_a_warning() {
    let (rotations, shifts) = rolls(0.0, 0);
    for (pitch, is_long) in [(0.5, false), (3.0, false), (7.0, true), (8.0, true)] {
        let noise = RollOptions::noise_of_pads(8.0, pitch).unwrap();
        let found = of_rolls(&rotations, &shifts, noise);
        assert_eq!(
            found.iter().any(|one| one.contains("is the pitch correct")),
            is_long,
            "{pitch}: {found:?}"
        );
    }
    // Shifts that are shorter than the pitch cause a warning, but shifts of 0 do not, because pads may report them.
    let still = vec![[0.0, 0.0]; 8];
    let readings = RollRecording::new(&rotations, &still, Some(LengthUnit::Mm)).unwrap();
    let options = RollOptions {
        noise: RollOptions::noise_of_pads(8.0, 2.0).unwrap(),
        ..RollOptions::new(8.0)
    };
    let said = estimate_roll(readings, &options).unwrap_err().to_string();
    assert!(!said.contains("is the pitch correct"), "{said}");
}

/// Noisy contacts of three fingers on z = −0.03 x² − 0.012 x y − 0.008 y² + 0.1 x, with their normals.
fn contacts(set: u64, std: f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>, Vec<u64>) {
    let mut stream = Stream::new(set, 0, Channel::Position);
    let (mut points, mut normals, mut fingers) = (Vec::new(), Vec::new(), Vec::new());
    for finger in 0..3_u32 {
        for contact in 0..6_u32 {
            let (x, y) = (
                2.0 * f64::from(contact) - 5.0,
                5.0 * f64::from(finger) - 5.0,
            );
            let z = -0.03 * x * x - 0.012 * x * y - 0.008 * y * y + 0.1 * x;
            let slopes = [-0.06 * x - 0.012 * y + 0.1, -0.012 * x - 0.016 * y];
            let length = (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt();
            let normal = [-slopes[0] / length, -slopes[1] / length, 1.0 / length];
            points.push([x, y, z].map(|part| part + std * stream.standard_normal()));
            normals.push(normal.map(|part| part + 0.02 * stream.standard_normal()));
            fingers.push(u64::from(finger));
        }
    }
    (points, normals, fingers)
}

/// Text of the warnings about contacts, or text of the error.
fn of_contacts(points: &[[f64; 3]], normals: &[[f64; 3]], fingers: &[u64]) -> String {
    let readings =
        GlideRecording::new(points, Some(normals), Some(fingers), Some(LengthUnit::Mm)).unwrap();
    match estimate_glide(&readings, &GlideOptions::default()) {
        Ok((estimate, _)) => warnings(&estimate).join("; "),
        Err(error) => error.to_string(),
    }
}

type Change = fn([f64; 3]) -> [f64; 3];

#[test]
fn mirrored_or_swapped_normals_cause_a_warning() {
    let changes: [(Change, &str); 6] = [
        (|[x, y, z]| [-x, y, z], "the sign of normal_x reversed"),
        (|[x, y, z]| [x, -y, z], "the sign of normal_y reversed"),
        (|[x, y, z]| [x, y, -z], "the sign of normal_z reversed"),
        (|[x, y, z]| [y, x, z], "normal_x and normal_y swapped"),
        (|[x, y, z]| [z, y, x], "normal_x and normal_z swapped"),
        (|[x, y, z]| [x, z, y], "normal_y and normal_z swapped"),
    ];
    for set in 0..20 {
        let (points, normals, fingers) = contacts(set, 0.02);
        assert_eq!(of_contacts(&points, &normals, &fingers), "", "set {set}");
        for (change, words) in changes {
            let changed: Vec<[f64; 3]> = normals.iter().map(|normal| change(*normal)).collect();
            let found = of_contacts(&points, &changed, &fingers);
            assert!(found.contains(words), "set {set}, {words}: {found}");
        }
        let inward: Vec<[f64; 3]> = normals
            .iter()
            .map(|normal| normal.map(|part| -part))
            .collect();
        let found = of_contacts(&points, &inward, &fingers);
        assert!(
            found.contains("point inward") && !found.contains("contradict the positions"),
            "{found}"
        );
    }
}

/// Seven contacts are too few to detect wrong components of normals. Contacts on a plane with correct normals cause no
/// warning.
#[test]
fn few_contacts_or_a_plane_cause_no_warning_of_normals() {
    let (points, normals, fingers) = contacts(1, 0.02);
    let turned: Vec<[f64; 3]> = normals.iter().map(|[x, y, z]| [-x, *y, *z]).collect();
    let few = [0, 1, 2, 6, 7, 12, 13];
    let pick = |all: &[[f64; 3]]| few.map(|place| all[place]);
    let found = of_contacts(
        &pick(&points),
        &pick(&turned),
        &few.map(|place| fingers[place]),
    );
    assert!(!found.contains("contradict the positions"), "{found}");
    let flat: Vec<[f64; 3]> = points.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
    let up = vec![[0.0, 0.0, 1.0]; flat.len()];
    assert_eq!(of_contacts(&flat, &up, &fingers), "");
}
