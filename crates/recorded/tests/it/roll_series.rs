//! Rolls that were recorded as time series, with rotations in several forms, and series that are rejected.

use palpate_ep1::{PadCell, PadStart, ReadingNoise};
use palpate_recorded::{RecordedFile, RollOptions, RollRecording, estimate_roll};
use serde_json::{Value, json};

/// Radius of the probe and radius of the object, mm.
const RADII: [f64; 2] = [10.0, 40.0];
/// Pitch of the pads, mm.
const PITCH: f64 = 1.0;
const HEADER: &str = "probe,time_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm";

/// Rows of the time series of four rolls by 0.5 rad, in four directions. Each roll has `samples` samples. The contact
/// starts at the middle of a pad, so it crosses to the next pad at odd multiples of half a pitch.
fn rows(samples: u32) -> Vec<[f64; 6]> {
    flattening(samples, 4, PITCH, 0.0)
}

/// Like [`rows`], but with `count` rolls on an object whose curvature decreases along the rolls. After the rotation φ
/// (rad), the contact's distance from its start is (1 + `growth` φ²) times the distance on an object with constant
/// curvature.
fn flattening(samples: u32, count: u32, pitch: f64, growth: f64) -> Vec<[f64; 6]> {
    let [probe, object] = RADII;
    let mut rows = Vec::new();
    for number in 0..count {
        // The directions are rotated by 0.25 rad from the axes, so that no roll is parallel to the edges of the
        // pads.
        let (v, u) =
            libm::sincos(0.25 + f64::from(number) * std::f64::consts::TAU / f64::from(count));
        for sample in 0..=samples {
            let time = f64::from(sample) / f64::from(samples);
            let angle = 0.5 * time;
            let mobility = (1.0 + growth * angle * angle) / (1.0 / probe + 1.0 / object);
            let pad = |axis: f64| (axis * angle * mobility / pitch).round() * pitch + 0.0;
            let [x, y] = [v * angle, -u * angle];
            rows.push([f64::from(number), time, x, y, pad(u), pad(v)]);
        }
    }
    rows
}

fn table(rows: &[[f64; 6]]) -> String {
    let line = |row: &[f64; 6]| row.map(|number| number.to_string()).join(",");
    let lines: Vec<String> = rows.iter().map(line).collect();
    format!("{HEADER}\n{}\n", lines.join("\n"))
}

fn options(settings: &Value) -> Result<RollOptions, String> {
    let mut given = settings.as_object().unwrap().clone();
    given.entry("probe_radius").or_insert(json!(RADII[0]));
    RollOptions::with_settings(None, &given, None).map_err(|error| error.to_string())
}

fn estimate(table: &str, settings: &Value) -> Result<Value, String> {
    let file = RecordedFile::new("log.csv", table.as_bytes().to_vec());
    let readings = RollRecording::try_from(file).map_err(|error| error.to_string())?;
    let estimate = estimate_roll(readings, &options(settings)?);
    let estimate = estimate.map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(estimate).unwrap())
}

/// The method `auto` chooses `trajectory`. Its intervals must contain the true curvature, for constant and for changing
/// curvature.
#[test]
fn auto_follows_a_changing_curvature() {
    for (growth, rotation_std) in [(0.05, 0.0), (0.0, 0.001), (0.05, 0.001)] {
        let auto = json!({ "kind": "auto", "pitch": 0.5, "rotation_std_rad": rotation_std });
        let found = estimate(&table(&flattening(500, 8, 0.5, growth)), &auto).unwrap();
        assert_eq!(found["method"], "trajectory", "{found}");
        let truth = 1.0 / RADII[1];
        let [low, high] = [0, 1].map(|end| found["mean_curvature"]["interval95"][end].as_f64());
        assert!(low < Some(truth) && high > Some(truth), "{found}");
        assert!(high.unwrap() - low.unwrap() < 0.2 * truth, "{found}");
    }
}

/// The contact crosses at most one edge between two pads, so the readings do not determine how the curvature changes.
#[test]
fn auto_bounds_the_curvature_if_few_edges_are_crossed() {
    let auto = json!({ "kind": "auto", "pitch": 3.0 });
    let found = estimate(&table(&flattening(500, 4, 3.0, 0.0)), &auto).unwrap();
    assert_eq!(found["method"], "pad-edge", "{found}");
}

#[test]
fn series_in_one_direction_determine_the_curvature_along_it() {
    let rolls = flattening(200, 12, 0.1, 0.0).into_iter();
    let one_way: Vec<_> = rolls.filter(|row| row[0] % 6.0 == 0.0).collect();
    for method in ["auto", "pad-edge", "trajectory"] {
        let settings = json!({ "kind": method, "pitch": 0.1, "rotation_std_rad": 1e-4 });
        let found = estimate(&table(&one_way), &settings).unwrap();
        assert_eq!(found["method"], "least-squares");
        let along = &found["single_direction"]["curvature_along"];
        let [low, high] = [0, 1].map(|end| along["interval95"][end].as_f64().unwrap());
        let truth = 1.0 / RADII[1];
        assert!(
            low < truth && truth < high && high - low < 0.2 * truth,
            "{along}"
        );
    }
}

/// Each roll has an error of the rotation about the contact normal. The expected paths are bent, but the measured paths
/// are straight.
#[test]
fn contact_paths_that_contradict_the_rotations_cause_a_warning() {
    let mut table =
        "probe,time_s,rotation_x_rad,rotation_y_rad,rotation_z_rad,contact_u_mm,contact_v_mm"
            .to_owned();
    for number in 0..8 {
        let (sin, cos) = libm::sincos(0.25 + f64::from(number) * std::f64::consts::FRAC_PI_4);
        let error = if number % 2 == 0 { 0.2 } else { -0.2 };
        for sample in 0..100 {
            let angle = 0.01 * f64::from(sample);
            let [noise_u, noise_v] = <[f64; 2]>::from(libm::sincos(12.9898 * f64::from(sample)));
            let [u, v] = [
                8.0 * angle * cos + 0.02 * noise_u,
                8.0 * angle * sin + 0.02 * noise_v,
            ];
            let [x, y, z] = [sin * angle, -cos * angle, error * angle];
            table += &format!("\n{number},{angle},{x},{y},{z},{u},{v}");
        }
    }
    let found = estimate(&table, &json!({ "kind": "trajectory" })).unwrap();
    let said = found["warnings"].to_string();
    assert!(
        said.contains("the shapes of the contact paths contradict"),
        "{found}"
    );
    let [low, high] = [0, 1].map(|end| found["mean_curvature"]["interval95"][end].as_f64());
    assert!(low < Some(0.025) && Some(0.025) < high, "{found}");
}

/// Rotations with three decimals. As exact rotations, they would contradict the pads, or give an interval without the
/// true curvature.
#[test]
fn rounded_rotations_have_noise() {
    for samples in [100, 1000] {
        let mut rows = flattening(samples, 8, PITCH, 0.0);
        for row in &mut rows {
            [row[2], row[3]] = [row[2], row[3]].map(|angle| (angle * 1e3).round() / 1e3);
        }
        let settings = json!({ "kind": "pad-edge", "pitch": PITCH });
        let found = estimate(&table(&rows), &settings).unwrap();
        assert_eq!(found["std_from"], "the steps of the rotations");
        let [low, high] = [0, 1].map(|end| found["mean_curvature"]["interval95"][end].as_f64());
        let truth = Some(1.0 / RADII[1]);
        assert!(
            low < truth && truth < high && found["left_out"] == json!([]),
            "{found}"
        );
    }
}

#[test]
fn unusable_series_are_refused() {
    let sound = table(&rows(200));
    let pad_edge = json!({ "kind": "pad-edge", "pitch": PITCH });
    let moved = |row: usize, column: usize, by: f64| {
        let mut rows = rows(200);
        rows[row][column] += by;
        table(&rows)
    };
    let turned = |[x, y]: [f64; 2]| {
        let mut rows = rows(200);
        for row in &mut rows {
            row[2] *= x;
            row[3] *= y;
        }
        table(&rows)
    };
    let changed = |change: fn(&mut [f64; 6])| {
        let mut rows = rows(200);
        rows.iter_mut().for_each(change);
        table(&rows)
    };
    let trajectory = json!({ "kind": "trajectory", "pitch": PITCH });
    let rolls =
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,0,-0.5,4,0\n1,0.5,0,0,4\n";
    let contacts = sound.replacen("pad_u_mm,pad_v_mm", "contact_u_mm,contact_v_mm", 1);
    for (table, settings, words) in [
        (
            moved(60, 1, -0.2),
            &pad_edge,
            "log.csv:62: column `time_s`: the times of probe 0 must increase, but 0.0999",
        ),
        (
            moved(450, 2, 1e300),
            &pad_edge,
            "probe 2 after 0.24 s: the rotation is 1e300 rad",
        ),
        (
            turned([1.0, -1.0]),
            &pad_edge,
            "against the direction of the roll: this is not a rolling contact",
        ),
        (
            changed(|row| row.swap(4, 5)),
            &pad_edge,
            "this is not a rolling contact; check the signs and axes of the rotations",
        ),
        (
            changed(|row| row.swap(4, 5)),
            &trajectory,
            "this is not a rolling contact; check the signs and axes of the rotations",
        ),
        (
            "time_s,rotation_x_rad,rotation_y_rad,pad_u_mm,pad_v_mm\n0,0,0,0,0\n1,0,-0.5,4,0\n9,0,0,0,0\n".to_owned(),
            &pad_edge,
            "no column `probe`: blank lines, or times that do not increase, separate 1 probe",
        ),
        (
            rolls.to_owned(),
            &pad_edge,
            "setting `kind` pad-edge needs rolls as time series",
        ),
        (contacts, &pad_edge, "needs columns pad_u, pad_v"),
        (
            sound.clone(),
            &json!({ "kind": "pad-edge" }),
            "needs setting `pitch`",
        ),
        (
            sound.clone(),
            &json!({ "kind": "pad-edge", "pad_layout": "hexagonal" }),
            "only with setting `pitch`",
        ),
        (
            sound,
            &json!({ "kind": "pad-edge", "pitch": 1, "pad_layout": "uniform" }),
            "must be square or hexagonal",
        ),
    ] {
        let error = estimate(&table, settings).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
    let late = changed(|row| row[2] += 0.25 * (row[0] - 1.0));
    let said = estimate(&late, &pad_edge).unwrap()["warnings"].to_string();
    assert!(
        said.contains("the rotations of the first samples are 0.25 rad"),
        "{said}"
    );
}

/// A pitch replaces the pitch of given options, but not the arrangement of their pads and the start of their rolls.
#[test]
fn a_pitch_keeps_the_arrangement_of_the_pads() {
    let mut base = options(&json!({ "pitch": 1, "pad_layout": "hexagonal" })).unwrap();
    base.noise = ReadingNoise::of_pads(1.0, PadStart::Centred);
    let pitch = json!({ "pitch": 0.5 });
    let given = pitch.as_object().unwrap();
    let options = RollOptions::with_settings(Some(base), given, None).unwrap();
    let hexagons = PadCell {
        pitch: 0.5,
        is_hexagonal: true,
    };
    assert_eq!(options.series.pads, Some(hexagons));
    assert_eq!(options.noise, ReadingNoise::of_pads(0.5, PadStart::Centred));
}

#[test]
fn least_squares_uses_the_ends_alone() {
    let settings = json!({ "pitch": PITCH });
    let series = estimate(&table(&rows(200)), &settings).unwrap();
    let ends: Vec<[f64; 6]> = rows(200).into_iter().filter(|row| row[1] == 1.0).collect();
    let ends = estimate(&table(&ends), &settings).unwrap();
    assert_eq!(series["mean_curvature"], ends["mean_curvature"]);
    // A roll with a single sample, whatever its pad, adds no information.
    let mut single = rows(200);
    single.push([9.0, 0.0, 0.3, 0.2, 4.0, 3.0]);
    let single = estimate(&table(&single), &settings).unwrap();
    assert_eq!(
        single["mean_curvature"]["value"],
        series["mean_curvature"]["value"]
    );
    let mut moved = rows(200);
    moved.iter_mut().for_each(|row| row[4] += 3.0);
    let moved = table(&moved);
    let of_moved = estimate(&moved, &settings).unwrap();
    assert_eq!(of_moved["mean_curvature"], ends["mean_curvature"]);
    // The shift has the errors of two contacts, as it has the rounding errors of two pads.
    let contacts = moved.replacen("pad_u_mm,pad_v_mm", "contact_u_mm,contact_v_mm", 1);
    let contacts = estimate(&contacts, &json!({ "shift_std": PITCH / 12_f64.sqrt() })).unwrap();
    let stds = [contacts, ends].map(|one| one["mean_curvature"]["std"].as_f64().unwrap());
    assert!((stds[0] / stds[1] - 1.0).abs() < 1e-12, "{stds:?}");
    assert_eq!(series["method"], "least-squares");
    assert!(series.get("terms").is_none());
}

#[test]
fn arrays_are_as_files() {
    let all = rows(200);
    let times: Vec<f64> = all.iter().map(|row| row[1]).collect();
    let rotations: Vec<[f64; 2]> = all.iter().map(|row| [row[2], row[3]]).collect();
    let places: Vec<[f64; 2]> = all.iter().map(|row| [row[4], row[5]]).collect();
    let readings = RollRecording::of_series(&times, &rotations, &places, true, None).unwrap();
    let options = options(&json!({ "pitch": PITCH })).unwrap();
    let of_arrays = serde_json::to_value(estimate_roll(readings, &options).unwrap()).unwrap();
    let of_file = estimate(&table(&all), &json!({ "pitch": PITCH })).unwrap();
    for key in ["mean_curvature", "gaussian_curvature", "arc_length"] {
        assert_eq!(of_arrays[key]["value"], of_file[key]["value"], "{key}");
    }
    let short = RollRecording::of_series(&times[1..], &rotations, &places, true, None);
    assert!(short.unwrap_err().to_string().contains("times"));
}

#[test]
fn columns_state_the_start_of_each_roll() {
    let rolls = table(&rows(1000));
    let settings = json!({ "kind": "pad-edge", "pitch": PITCH });
    let with_starts = |start: &str| {
        let rows = rolls.lines().skip(1).map(|row| format!("{row},{start}"));
        let rows: Vec<String> = rows.collect();
        format!("{HEADER},start_u_mm,start_v_mm\n{}\n", rows.join("\n"))
    };
    let known = json!({ "kind": "pad-edge", "pitch": PITCH, "start": [0.0, 0.0] });
    assert_eq!(
        estimate(&with_starts("0,0"), &settings),
        estimate(&rolls, &known)
    );
    for (starts, settings, part) in [
        ("0.6,0", &settings, "probe 0: the stated start (0.6, 0) mm"),
        ("0,0", &known, "setting `start`"),
    ] {
        let error = estimate(&with_starts(starts), settings).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    let changed = format!("{}3,1.1,0,0.5,0,0,0.1,0\n", with_starts("0,0"));
    let error = estimate(&changed, &settings).unwrap_err();
    assert!(error.contains("the same in all of its rows"), "{error}");
}

#[test]
fn copied_series_count_once() {
    let once = rows(1000);
    let copies = once.iter().map(|&[probe, rest @ ..]| {
        let [time, x, y, u, v] = rest;
        [probe + 4.0, time, x, y, u, v]
    });
    let twice: Vec<_> = once.iter().copied().chain(copies).collect();
    for kind in ["pad-edge", "trajectory"] {
        let settings = json!({ "kind": kind, "pitch": PITCH, "rotation_std_rad": 0.002 });
        let [once, twice] = [&once, &twice].map(|rows| estimate(&table(rows), &settings).unwrap());
        assert_eq!(once["mean_curvature"], twice["mean_curvature"], "{kind}");
        assert_eq!(twice["warnings"][0]["code"], "repeated-rows", "{kind}");
    }
}

/// Large files are read line by line, and of very many samples only a part is used. All crossings of pad edges are
/// used, and wrong rows at the end of the file are found.
#[test]
fn very_long_series_are_thinned_out() {
    let mut rows = rows(280_000);
    let path = std::env::temp_dir().join(format!("palpate-long-{}.csv", std::process::id()));
    let settings = json!({ "kind": "pad-edge", "pitch": PITCH });
    let estimate = |rows: &[[f64; 6]]| {
        std::fs::write(
            &path,
            table(rows).replace("\n", &format!("{}\n", " ".repeat(12))),
        )
        .unwrap();
        let readings = RecordedFile::read(&path).and_then(RollRecording::try_from);
        readings.map(|readings| estimate_roll(readings, &options(&settings).unwrap()))
    };
    let found = serde_json::to_value(estimate(&rows).unwrap().unwrap()).unwrap();
    let text = found["warnings"][0]["text"].as_str().unwrap();
    assert!(text.contains(" of 1120004 readings are used: "), "{text}");
    let bound =
        |end: usize| RADII[1] * found["mean_curvature"]["interval95"][end].as_f64().unwrap();
    assert!(
        bound(0) < 1.0 && bound(1) > 1.0 && bound(1) - bound(0) < 1e-4,
        "{found}"
    );
    let last = rows.len() - 1;
    rows[last][1] = 0.5;
    let error = estimate(&rows).unwrap_err().to_string();
    std::fs::remove_file(&path).unwrap();
    assert!(error.contains(":1120005: column `time_s`"), "{error}");
}

#[test]
fn few_crossings_cause_a_warning() {
    for (end_s, is_warned) in [(0.3, true), (1.0, false)] {
        let mut all = rows(1000);
        all.retain(|row| row[1] <= end_s);
        let settings = json!({ "kind": "pad-edge", "pitch": PITCH, "start": [0.0, 0.0] });
        let found = estimate(&table(&all), &settings).unwrap();
        let mut warnings = found["warnings"].as_array().unwrap().iter();
        let is_found = warnings.any(|warning| warning["code"] == "few-crossings");
        assert_eq!(is_found, is_warned, "{found}");
    }
}

/// The mean curvature by the method `pad-edge` with pads of `pitch`, and the texts of all warnings.
fn mean_and_warnings(rows: &[[f64; 6]], pitch: f64) -> (f64, String) {
    let settings = json!({ "kind": "pad-edge", "pitch": pitch });
    let found = estimate(&table(rows), &settings).unwrap();
    let mean = found["mean_curvature"]["value"].as_f64();
    (mean.unwrap(), found["warnings"].to_string())
}

/// The rows between two updates of a sensor repeat its readings. Without these rows, the estimate is that of the updates.
#[test]
fn held_readings_are_left_out() {
    let rows = flattening(1000, 8, PITCH, 0.0);
    let is_fresh = |row: &usize| (row % 1001).is_multiple_of(5);
    let fresh = (0..rows.len()).filter(is_fresh).map(|row| rows[row]);
    let (mean, warnings) = mean_and_warnings(&fresh.collect::<Vec<_>>(), PITCH);
    assert_eq!(warnings, "[]");
    for columns in [2..4, 4..6, 2..6] {
        let mut held = rows.clone();
        for (row, held) in held.iter_mut().enumerate() {
            let update = row - row % 1001 % 5;
            held[columns.clone()].copy_from_slice(&rows[update][columns.clone()]);
        }
        let (found, warnings) = mean_and_warnings(&held, PITCH);
        assert_eq!(found, mean, "{columns:?}");
        assert!(warnings.contains("only every 5 rows"), "{warnings}");
    }
    let (_, warnings) = mean_and_warnings(&rows, PITCH);
    assert_eq!(warnings, "[]");
}

#[test]
fn a_stale_pad_is_named() {
    let mut rows = flattening(1000, 8, PITCH, 0.0);
    let (sound, stale) = (rows.clone(), 3 * 1001 + 700);
    rows.remove(stale);
    let (mean, _) = mean_and_warnings(&rows, PITCH);
    rows = sound;
    rows[stale] = [&rows[stale][..4], &rows[stale - 300][4..]].concat()[..]
        .try_into()
        .unwrap();
    let (found, warnings) = mean_and_warnings(&rows, PITCH);
    assert_eq!(found, mean);
    assert!(warnings.contains("probe 3 after 0.7 s"), "{warnings}");
}

#[test]
fn rounded_centres_of_pads_are_replaced_by_their_lattice() {
    let pitch = 1.0 / 3.0;
    let mut rows = flattening(1000, 8, pitch, 0.0);
    let (mean, _) = mean_and_warnings(&rows, pitch);
    for number in rows.iter_mut().flat_map(|row| &mut row[4..]) {
        *number = (*number * 100.0).round() / 100.0;
    }
    let (found, warnings) = mean_and_warnings(&rows, pitch);
    assert!((found / mean - 1.0).abs() < 1e-4, "{found} {mean}");
    assert_eq!(warnings, "[]");
    // Move the pad at u = 5/3 by more than its rounding error of 0.005. The centres are then not replaced by a lattice, and
    // the pad is rejected.
    let rows_of_pad = rows.iter_mut().filter(|row| row[4] == 1.67);
    rows_of_pad.for_each(|row| row[4] = 1.69);
    let message = estimate(
        &table(&rows),
        &json!({ "kind": "pad-edge", "pitch": pitch }),
    );
    assert!(message.unwrap_err().contains("there is no pad at"));
}

/// A clock with steps of 10 ms gives ten rows the same time. The order of the rows is then used.
#[test]
fn rows_with_equal_times_keep_their_order() {
    let mut rows = flattening(1000, 8, PITCH, 0.0);
    let (mean, _) = mean_and_warnings(&rows, PITCH);
    for row in &mut rows {
        row[1] = (row[1] * 100.0 + 1e-6).floor() / 100.0;
    }
    let (found, warnings) = mean_and_warnings(&rows, PITCH);
    assert!((found / mean - 1.0).abs() < 1e-9, "{found} {mean}");
    assert!(warnings.contains("the order of the rows"), "{warnings}");
    rows.iter_mut().for_each(|row| row[1] = 0.0);
    let message = estimate(
        &table(&rows),
        &json!({ "kind": "pad-edge", "pitch": PITCH }),
    );
    assert!(message.unwrap_err().contains("have the same time"));
}
