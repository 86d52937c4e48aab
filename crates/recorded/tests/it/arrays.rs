//! Estimates from arrays. They are equal to the estimates from files with the same numbers. Errors name the array, the
//! index and the value.

use palpate_recorded::{
    GlideOptions, GlideRecording, PressOptions, PressRecording, RecordedError, RecordedFile,
    RollOptions, RollRecording, estimate_glide, estimate_press, estimate_roll,
};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::LengthUnit;
use serde::Serialize;

fn example(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(name)
}

fn file(name: &str) -> RecordedFile {
    RecordedFile::read(&example(name)).unwrap()
}

/// Numbers from an example file: `D` columns of each row, beginning with the column `first`.
fn columns<const D: usize>(name: &str, first: usize) -> Vec<[f64; D]> {
    let text = std::fs::read_to_string(example(name)).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let row = |line: &str| -> [f64; D] {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        std::array::from_fn(|column| cells[first + column])
    };
    lines.map(row).collect()
}

fn assert_same_json(one: &impl Serialize, other: &impl Serialize) {
    assert_eq!(
        serde_json::to_string(one).unwrap(),
        serde_json::to_string(other).unwrap()
    );
}

const MM: Option<LengthUnit> = Some(LengthUnit::Mm);

#[test]
fn rolls_from_arrays_match_those_from_a_file() {
    let name = "roll-readings.csv";
    let (rotations, shifts) = (columns::<2>(name, 1), columns::<2>(name, 3));
    let options = RollOptions::new(10.0);
    let readings = RollRecording::new(&rotations, &shifts, MM).unwrap();
    let estimate = estimate_roll(readings, &options).unwrap();
    let of_file = estimate_roll(RollRecording::try_from(file(name)).unwrap(), &options).unwrap();
    assert_same_json(&estimate, &of_file);
    // A rotation about the normal (third component) does not move the contact, so it must not change the estimate.
    let spun: Vec<[f64; 3]> = rotations.iter().map(|[x, y]| [*x, *y, 0.7]).collect();
    let readings = RollRecording::new(&spun, &shifts, MM).unwrap();
    assert_same_json(&estimate_roll(readings, &options).unwrap(), &of_file);
    assert_eq!(estimate.covariance(), of_file.covariance());
}

#[test]
fn glides_from_arrays_match_those_from_a_file() {
    let name = "glide-readings.csv";
    let points = columns::<3>(name, 1);
    let normals = columns::<3>(name, 4);
    let fingers: Vec<u64> = columns::<1>(name, 0)
        .iter()
        .map(|[one]| *one as u64)
        .collect();
    let options = GlideOptions::default();
    let readings = GlideRecording::new(&points, Some(&normals), Some(&fingers), MM).unwrap();
    let (estimate, map) = estimate_glide(&readings, &options).unwrap();
    let (of_file, of_map) =
        estimate_glide(&GlideRecording::try_from(file(name)).unwrap(), &options).unwrap();
    assert_same_json(&estimate, &of_file);
    assert_eq!(map.to_csv(), of_map.to_csv());
}

#[test]
fn presses_from_arrays_match_those_from_a_file() {
    let name = "press-readings.csv";
    let (places, along) = (columns::<2>(name, 0), columns::<2>(name, 3));
    let normal: Vec<f64> = columns::<1>(name, 2).into_iter().flatten().collect();
    let options = PressOptions {
        marker_depth: Some(2.0),
        ..PressOptions::new(20.0)
    };
    let readings = PressRecording::new(&places, &normal, Some(&along), MM).unwrap();
    let object = estimate_press(&readings, &options).unwrap();
    let of_file = estimate_press(&PressRecording::try_from(file(name)).unwrap(), &options).unwrap();
    assert_same_json(&object, &of_file);
}

fn assert_array_error<T>(
    found: Result<T, RecordedError>,
    name: &str,
    place: &[usize],
    bad: Option<f64>,
) {
    match found.err() {
        Some(RecordedError::Array {
            array,
            index,
            value,
            ..
        }) => {
            assert_eq!((array, index.as_slice()), (name, place));
            assert_eq!(value.map(f64::to_bits), bad.map(f64::to_bits));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn errors_name_invalid_arrays() {
    let mut shifts = [[2.0, 0.0], [0.0, 2.0]];
    let rotations = [[0.0, -0.3], [0.3, 0.0]];
    assert_array_error(
        RollRecording::new(&rotations, &shifts[..1], None),
        "shifts",
        &[],
        None,
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        shifts[1][0] = bad;
        let found = RollRecording::new(&rotations, &shifts, None);
        assert_array_error(found, "shifts", &[1, 0], Some(bad));
        let points = [[0.0, 0.0, 0.0], [1.0, bad, 0.0]];
        let found = GlideRecording::new(&points, None, None, None);
        assert_array_error(found, "points", &[1, 1], Some(bad));
        let found = PressRecording::new(&[[0.0, 0.0], [1.0, bad]], &[0.0, 0.0], None, None);
        assert_array_error(found, "positions", &[1, 1], Some(bad));
        let found = PressRecording::new(&[[0.0, 0.0], [1.0, 0.0]], &[bad, 0.0], None, None);
        assert_array_error(found, "displacements", &[0], Some(bad));
    }
    let points = [[0.0; 3]; 2];
    let found = GlideRecording::new(&points, Some(&points[..1]), None, None);
    assert_array_error(found, "normals", &[], None);
    assert_array_error(
        GlideRecording::new(&points, None, Some(&[0]), None),
        "fingers",
        &[],
        None,
    );
}

/// Presses of almost flat sensors and of a flat pad on a ball with a radius of 4 mm. The indentation is stated or
/// fitted.
#[test]
fn sensors_of_large_radius_are_pressed() {
    let bytes = include_bytes!("../data/press-flat-pad-ball4.csv").to_vec();
    let readings = PressRecording::try_from(RecordedFile::new("pad.csv", bytes)).unwrap();
    for radius in [1e3, 1e4, 1e6] {
        for indentation in [None, Some(0.5)] {
            let options = PressOptions {
                marker_depth: Some(0.0),
                indentation,
                ..PressOptions::new(radius)
            };
            let report = estimate_press(&readings, &options).unwrap();
            let interval = &serde_json::to_value(report).unwrap()["object_curvature"]["interval95"];
            let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
            let is_within = (low..=high).contains(&(0.25 - 1.0 / radius));
            assert!(is_within && high - low < 0.1, "{options:?}: {interval}");
        }
    }
    // Wrong displacements cause a warning that names the mistake.
    let text = include_str!("../data/press-flat-pad-ball4.csv");
    let rows = text.lines().skip(1);
    let numbers = rows
        .flat_map(|row| row.split(','))
        .map(|one| one.parse().unwrap());
    let numbers: Vec<f64> = numbers.collect();
    let rows = numbers.as_chunks::<3>().0;
    let places: Vec<[f64; 2]> = rows.iter().map(|[x, y, _]| [*x, *y]).collect();
    for (factor, offset, most, words) in [
        (1e-3, 0.0, 1.0, "displacements in m"),
        (1.0, 0.02, 1.0, "a common offset of 0.0"),
        (1.0, 0.0, 0.3, "the largest normal displacement, 0.3"),
    ] {
        let change = |[_, _, normal]: &[f64; 3]| (factor * normal + offset).min(most);
        let normal: Vec<f64> = rows.iter().map(change).collect();
        let readings = PressRecording::new(&places, &normal, None, MM).unwrap();
        let report = estimate_press(&readings, &PressOptions::new(f64::INFINITY)).unwrap();
        let said = serde_json::to_string(&report).unwrap();
        assert!(said.contains(words), "{said}");
    }
}

/// A layer is fitted to a press of a half-space. Its fit rejects the markers at the contact as outliers, so only the
/// comparison with the half-space reveals the wrong body.
#[test]
fn a_layer_on_a_press_of_a_half_space_causes_a_warning() {
    let bytes = include_bytes!("../data/press-flat-pad-ball4.csv").to_vec();
    let readings = PressRecording::try_from(RecordedFile::new("pad.csv", bytes)).unwrap();
    for (thickness, is_wrong) in [(4.0, true), (8.0, true), (1e6, false)] {
        let estimator = serde_json::json!({ "kind": "bonded-layer", "thickness": thickness });
        let options = PressOptions {
            marker_depth: Some(0.0),
            estimator: serde_json::from_value(estimator).unwrap(),
            ..PressOptions::new(f64::INFINITY)
        };
        let report = serde_json::to_value(estimate_press(&readings, &options).unwrap()).unwrap();
        let mut warnings = report["warnings"].as_array().unwrap().iter();
        let is_found = warnings.any(|one| one["code"] == "other-body");
        assert_eq!(is_found, is_wrong, "{thickness}: {report}");
    }
}

/// A press of a flat pad with many markers at random places. The displacements follow Hertz's theory, with noise.
#[test]
fn intervals_from_many_markers_are_as_wide_as_their_noise() {
    let mut noise = Stream::new(46, 0, Channel::Position);
    let (radius, depth) = (10.0, 0.1_f64);
    let contact = (radius * depth).sqrt();
    for count in [2_000, 30_000, 30_001, 30_002, 30_003, 30_004] {
        let mut places = Vec::new();
        let mut normal = Vec::new();
        for _ in 0..count {
            let [x, y] = [0, 1].map(|_| 3.0 * noise.standard_normal());
            let r = libm::hypot(x, y).max(contact);
            let outside = (2.0 * contact * contact - r * r) * libm::asin(contact / r)
                + contact * (r * r - contact * contact).sqrt();
            let moved = match r > contact {
                true => outside / (std::f64::consts::PI * radius),
                false => depth - (x * x + y * y) / (2.0 * radius),
            };
            places.push([x, y]);
            normal.push(moved + 0.002 * noise.standard_normal());
        }
        let readings = PressRecording::new(&places, &normal, None, MM).unwrap();
        let options = PressOptions {
            marker_depth: Some(0.0),
            ..PressOptions::new(f64::INFINITY)
        };
        let report = serde_json::to_value(estimate_press(&readings, &options).unwrap()).unwrap();
        let curvature = &report["object_curvature"];
        let [low, high] = [0, 1].map(|end| curvature["interval95"][end].as_f64().unwrap());
        assert!((low..=high).contains(&0.1), "{count}: {curvature}");
        let widths = (high - low) / (2.0 * 1.96 * curvature["std"].as_f64().unwrap());
        assert!((widths - 1.0).abs() < 0.1, "{count}: {curvature}");
    }
}
