//! Logs as robots write them: of objects with simple shapes, with lost or repeated readings, or of a single stroke.

use palpate_recorded::{
    GlideOptions, GlideRecording, PressOptions, PressRecording, RecordedError, RecordedFile,
    RollOptions, RollRecording, estimate_glide, estimate_press, estimate_roll,
};
use palpate_sensing::{Channel, Stream};
use serde_json::{Value, json};

fn file(text: &str) -> RecordedFile {
    RecordedFile::new("readings.csv", text.as_bytes().to_vec())
}

/// Contacts of three fingers on a ball with a radius of 25 mm, with errors of about 0.03 mm. `row` replaces the text of
/// some rows.
fn ball(row: &dyn Fn(usize) -> Option<&'static str>) -> String {
    let mut noise = Stream::new(45, 0, Channel::Position);
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for index in 0..36 {
        let [x, y] = [index % 12, index / 12].map(|step| step as f64);
        let [x, y] = [2.0 * x - 11.0, 9.0 * (y - 1.0)];
        let error = 0.03 * noise.standard_normal();
        let z = (625.0 - x * x - y * y).sqrt() + error;
        let at = row(index).map_or_else(|| format!("{x},{y},{z}"), str::to_owned);
        text += &format!("{},{at}\n", index / 12);
    }
    text
}

pub(crate) fn estimate(text: &str, method: &str) -> Result<Value, RecordedError> {
    estimate_with(text, &json!({ "kind": method }))
}

fn estimate_with(text: &str, given: &Value) -> Result<Value, RecordedError> {
    let readings = GlideRecording::try_from(file(text))?;
    let options = GlideOptions::with_settings(
        None,
        given.as_object().unwrap(),
        None,
        readings.has_normals(),
    );
    let (estimate, map) = estimate_glide(&readings, &options.unwrap())?;
    assert_eq!(map.points.len(), 900);
    Ok(serde_json::to_value(estimate).unwrap())
}

pub(crate) fn codes(estimate: &Value) -> Vec<&str> {
    let warnings = estimate["warnings"].as_array().unwrap().iter();
    warnings.map(|one| one["code"].as_str().unwrap()).collect()
}

fn is_open(found: &Value) -> bool {
    found["std"].is_null() && found["interval95"] == json!([null, null])
}

fn assert_holds(found: &Value, truth: f64) {
    let [low, high] = [0, 1].map(|end| found["interval95"][end].as_f64());
    assert!(low < Some(truth) && high > Some(truth), "{truth}: {found}");
}

#[test]
fn a_ball_has_its_radius_without_lost_readings() {
    let clean = estimate(&ball(&|_| None), "shape").unwrap();
    let lost = ball(&|row| (row % 9 == 4).then_some("9999,9999,9999"));
    let rows =
        [5, 14, 23, 32].map(|row| json!({ "row": row, "line": row + 1, "reason": "sentinel" }));
    let of_shape = estimate(&lost, "shape").unwrap();
    for estimate in [&clean, &of_shape] {
        let radius = &estimate["radius"];
        let [low, high] = [0, 1].map(|end| radius["interval95"][end].as_f64().unwrap());
        assert!(low < 25.0 && 25.0 < high && high - low < 2.0, "{radius}");
        let named = ["shape", "method"].map(|key| &estimate[key]);
        assert_eq!(named, ["sphere", "shape"]);
        assert!(estimate["shape_probabilities"]["sphere"].as_f64().unwrap() > 0.9);
        assert!(estimate["rms_misfit"]["value"].as_f64().unwrap() < 0.06);
        let ends = ["curvature", "mean_curvature", "k_max"].map(|key| &estimate[key]["interval95"]);
        assert!(ends.iter().all(|one| *one == ends[0]), "{ends:?}");
        assert_eq!(estimate["class"], "peak");
    }
    assert_eq!(clean["effective_contacts"], 36.0);
    // The centres of the tip are on a sphere. If the tip's radius is nearly that of the sphere, the object's
    // radius may be nearly 0.
    let [mean, other] = ["centre", "lowest-point"].map(|reports| {
        let given = json!({ "kind": "sphere", "tip_radius": 24.9, "reports": reports });
        let sharp = estimate_with(&ball(&|_| None), &given).unwrap();
        let [curvature, radius] = ["curvature", "radius"].map(|key| &sharp[key]["interval95"][1]);
        assert!(curvature.is_null() && radius.is_number(), "{sharp}");
        sharp["thresholds"]["mean"]["value"].as_f64().unwrap()
    });
    assert!((mean / other - 1.0).abs() < 1e-6, "{mean} {other}");
    let is_clean = codes(&clean).is_empty() && clean["left_out"] == json!([]);
    assert!(is_clean, "{clean}");
    // Intervals must contain the true value also if the stated noise is far too small or too large.
    for (std, is_wrong) in [(0.03, false), (0.005, true), (3e-4, true), (3.0, true)] {
        for kind in ["sphere", "shape"] {
            let given = json!({ "kind": kind, "position_std": std });
            let stated = estimate_with(&ball(&|_| None), &given).unwrap();
            assert_eq!(codes(&stated).contains(&"stated-noise"), is_wrong);
            assert_holds(&stated["curvature"], 0.04);
        }
    }
    for method in ["penalised", "quadric", "two-pass", "sphere"] {
        let of_lost = estimate(&lost, method).unwrap();
        assert_eq!(of_lost["left_out"], json!(rows));
        assert_eq!(of_lost["contacts"], 36);
        assert!(codes(&of_lost).contains(&"left-out"));
        let kept: Vec<&str> = lost.lines().filter(|line| !line.contains("9999")).collect();
        let alone = estimate(&(kept.join("\n") + "\n"), method).unwrap();
        assert_eq!(of_lost["mean_curvature"], alone["mean_curvature"]);
    }
    let many = ball(&|row| (row % 4 == 1).then_some("9999,0,0"));
    for method in ["sphere", "penalised"] {
        let error = estimate(&many, method).unwrap_err().to_string();
        let is_named = error.contains("9 of 36 contacts are outliers") && error.contains("line 3");
        assert!(is_named, "{error}");
    }
}

#[test]
fn lost_readings_may_have_normals_of_zeros() {
    let mut text = "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z\n".to_owned();
    for row in ball(&|_| None).lines().skip(1) {
        let [_, x, y, z] = row.split(',').collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        text += &format!("{row},{x},{y},{z}\n");
    }
    let rows: Vec<&str> = text.lines().collect();
    let replaced = |with: &str| text.replacen(rows[8], with, 1);
    let lost = estimate(&replaced("0,5,7,9000,0,0,0"), "penalised").unwrap();
    let expected = json!([{ "row": 8, "line": 9, "reason": "far" }]);
    assert_eq!(lost["left_out"], expected);
    let error = estimate(&replaced("0,5,0,24.4,0,0,0"), "penalised").unwrap_err();
    assert!(error.to_string().contains(":9:"), "{error}");
    // The lost readings have different normals, so they do not count as copies.
    let lost = |(row, text): (usize, &str)| match (text.split_once(','), row % 4) {
        (Some((finger, _)), 2) => format!("{finger},9999,9999,9999,1,{row},50\n"),
        _ => format!("{text}\n"),
    };
    let lost: String = text.lines().enumerate().map(lost).collect();
    let error = estimate(&lost, "penalised").unwrap_err().to_string();
    assert!(error.contains("9 of 36 contacts are outliers"), "{error}");
    // The contacts are in a random order. In 16 successive rows, the height is the same wrong number.
    let mut scan = "x_mm,y_mm,z_mm\n".to_owned();
    for row in 0..200 {
        let (sin, cos) = libm::sincos(2.4 * f64::from(row * 7 % 200));
        let out = f64::from(row * 7 % 200).sqrt();
        let z = if (60..76).contains(&row) {
            999.0
        } else {
            (900.0 - out * out).sqrt()
        };
        scan += &format!("{},{},{z}\n", out * sin, out * cos);
    }
    let left = estimate(&scan, "penalised").unwrap()["left_out"].take();
    let reasons = left.as_array().unwrap().iter().map(|one| &one["reason"]);
    assert_eq!(reasons.collect::<Vec<_>>(), ["sentinel"; 16]);
}

#[test]
fn a_finger_at_rest_with_noise_does_not_make_the_others_outliers() {
    for (count, std) in [(60, 0.03), (400, 0.15), (400, 0.5)] {
        let mut noise = Stream::new(47, 0, Channel::Position);
        let mut text = ball(&|_| None);
        for _ in 0..count {
            let [x, y, z] = [11.0, 9.0, 20.57].map(|at| at + std * noise.standard_normal());
            text += &format!("2,{x},{y},{z}\n");
        }
        for method in ["penalised", "sphere"] {
            let found = estimate(&text, method).unwrap();
            assert_eq!(found["left_out"], json!([]));
            assert_holds(&found["mean_curvature"], 0.04);
        }
    }
}

/// A few strokes along a cylinder with a radius of 25 mm do not determine the curvature across the strokes, because the
/// surface between them is not measured.
#[test]
fn strokes_along_a_cylinder_are_open_across_it() {
    let strokes = |count: i32, std: f64| {
        let mut noise = Stream::new(48, 0, Channel::Position);
        let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
        for row in 0..13 * count {
            let share = f64::from(row / 13) / f64::from(count - 1);
            let [x, y] = [1.6 * f64::from(row % 13), 20.0 * share - 10.0];
            let [x, y, z] =
                [x, y, (625.0 - y * y).sqrt()].map(|at| at + std * noise.standard_normal());
            text += &format!("{},{x},{y},{z}\n", row / 13);
        }
        text
    };
    for (count, std) in [(3, 0.0), (3, 1e-5), (4, 0.0), (4, 0.01)] {
        let found = estimate(&strokes(count, std), "penalised").unwrap();
        assert_holds(&found["mean_curvature"], 0.02);
        assert!(!codes(&found).contains(&"two-groups"), "{found}");
    }
    for std in [0.0, 0.05] {
        for method in ["penalised", "quadric"] {
            let error = estimate(&strokes(2, std), method).unwrap_err().to_string();
            assert!(error.contains("only 5 of its 6 unknowns"), "{error}");
        }
    }
}

/// Dense strokes whose noise exceeds their step: some steps within a stroke are longer than three medians.
#[test]
fn noisy_dense_strokes_are_divided_at_their_jumps() {
    let mut noise = Stream::new(51, 0, Channel::Position);
    let mut text = "x_mm,y_mm,z_mm\n".to_owned();
    for row in 0..3000 {
        let x = 0.01 * f64::from(row % 1000) + 0.05 * noise.standard_normal();
        let y = 20.0 * f64::from(row / 1000) + 0.05 * noise.standard_normal();
        text += &format!("{x},{y},{}\n", 0.05 * noise.standard_normal());
    }
    assert_eq!(estimate(&text, "plane").unwrap()["fingers"], 3);
}

/// A finger whose contacts are farther apart than those of the other fingers must not lose contacts as outliers.
#[test]
fn a_finger_with_long_steps_is_not_beside_its_path() {
    let mut noise = Stream::new(49, 0, Channel::Position);
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for finger in 0..7 {
        // The surface under the last finger is 0.3 mm higher.
        let (count, y, ridge) = match finger {
            6 => (50, 6.0, 0.3),
            finger => (200, 3.2 * f64::from(finger) - 8.0, 0.0),
        };
        for step in 0..count {
            let x = 16.0 * f64::from(step) / f64::from(count - 1) - 8.0;
            let z = (625.0 - x * x - y * y).sqrt() + ridge + 0.005 * noise.standard_normal();
            text += &format!("{finger},{x},{y},{z}\n");
        }
    }
    assert_eq!(estimate(&text, "penalised").unwrap()["left_out"], json!([]));
}

#[test]
fn a_flat_log_bounds_the_radius() {
    let mut noise = Stream::new(46, 0, Channel::Position);
    let mut at = |_| 0.05 * noise.standard_normal();
    let places = (0..36).map(|row| {
        format!(
            "{},{},{},{}\n",
            row / 12,
            2 * (row % 12),
            9 * (row / 12),
            at(row)
        )
    });
    let flat = format!("finger,x_mm,y_mm,z_mm\n{}", places.collect::<String>());
    let open = estimate(&flat, "sphere").unwrap();
    assert!(open["radius"]["value"].is_null() && open["radius"]["interval95"][1].is_null());
    let least = open["radius"]["interval95"][0].as_f64().unwrap();
    assert!(least > 50.0, "{open}");
    assert_eq!(codes(&open), ["not-resolved"]);
    assert!(open["mean_curvature"]["value"].is_null() && open["sign_class"].is_null());
    // A warning is expected if the user states a plane but the contacts lie on a ball.
    let ball = estimate(&ball(&|_| None), "plane").unwrap();
    assert_eq!(codes(&ball), ["poor-fit"]);
    let all_round = (0..60).map(|row| {
        let (sin, cos) = libm::sincos(2.4 * f64::from(row));
        let z = 29.5 - f64::from(row);
        let out = (900.0 - z * z).sqrt();
        format!("{},{},{z}\n", out * cos, out * sin)
    });
    let text = format!("x_mm,y_mm,z_mm\n{}", all_round.collect::<String>());
    assert!(codes(&estimate(&text, "plane").unwrap()).contains(&"poor-fit"));
    let plane = estimate(&flat, "shape").unwrap();
    assert!(plane["shape"] == "plane" && plane["radius"].is_null());
}

#[test]
fn a_saddle_is_no_simple_shape_and_has_open_curvatures() {
    let mut noise = Stream::new(50, 0, Channel::Position);
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for row in 0..150 {
        let [x, y] = [row % 30, row / 30].map(f64::from);
        let [x, y] = [0.6 * x - 8.7, 4.0 * y - 8.0];
        let z = 0.02 * (x * x - y * y) + 0.03 * noise.standard_normal();
        text += &format!("{},{x},{y},{z}\n", row / 30);
    }
    let saddle = estimate(&text, "shape").unwrap();
    assert!(saddle["shape"] == "none" && codes(&saddle).contains(&"none-of-these"));
    let curvatures = ["mean_curvature", "gaussian_curvature", "k_min", "k_max"];
    for key in curvatures.iter().chain(&["curvature", "radius"]) {
        assert!(is_open(&saddle[*key]), "{key}");
    }
    for key in ["class", "class_probabilities", "sign_class", "shape_index"] {
        assert!(saddle[key].is_null(), "{key}");
    }
}

#[test]
fn a_single_stroke_is_not_resolved_across() {
    let log = |bend: f64| {
        let mut text = "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z\n".to_owned();
        for row in 0..21 {
            let x = f64::from(row) - 10.0;
            let [noise, error] =
                [5.3, 7.1].map(|rate| 0.05 * libm::sin(rate * f64::from(row * row)));
            let y = bend * libm::sin(0.3 * x);
            let z = (625.0 - x * x - y * y).sqrt();
            text += &format!("0,{x},{},{},{x},{y},{z}\n", y + noise, z + error);
        }
        text
    };
    let methods = ["penalised", "quadric", "shape"].map(|method| (method, 0.0, 0.04));
    let straight = methods.into_iter().chain([("shape", 5.0, 0.05)]);
    let straight = straight.map(|case| (0.0, case));
    for (bend, (method, tip_radius, truth)) in straight.chain([(2.0, ("quadric", 0.0, 0.04))]) {
        let given = json!({ "kind": method, "tip_radius": tip_radius, "reports": "centre" });
        let stroke = estimate_with(&log(bend), &given).unwrap();
        assert_holds(&stroke["stroke"]["curvature_along"], truth);
        for key in ["mean_curvature", "gaussian_curvature", "k_min", "k_max"] {
            assert!(is_open(&stroke[key]) && stroke[key]["value"].is_null());
        }
        assert!(codes(&stroke).contains(&"not-resolved-across") && stroke["class"].is_null());
        assert!(stroke["radius"]["value"].is_null());
    }
}

/// A stroke over a ball with a radius of 25 mm. At the stroke, the direction out of the ball is tilted from +z by 50
/// degrees about the stroke.
#[test]
fn a_stroke_without_normals_holds_for_any_outer_side() {
    let (sin, cos) = (libm::sin(0.87), libm::cos(0.87));
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    for row in 0..41 {
        let x = 0.5 * f64::from(row) - 10.0;
        let height = (625.0 - x * x).sqrt() + 0.01 * libm::sin(7.1 * f64::from(row * row));
        text += &format!("0,{x},{},{}\n", height * sin, height * cos);
    }
    let stroke = estimate(&text, "quadric").unwrap();
    let along = &stroke["stroke"]["curvature_along"];
    let [low, high] = [0, 1].map(|end| along["interval95"][end].as_f64().unwrap());
    assert!(low < 0.0 && 0.04 < high && high < 0.06, "{along}");
    assert!(stroke["noise"]["normal_std_deg"].is_null(), "{stroke}");
    let plane = estimate(&text, "plane").unwrap();
    assert!(codes(&plane).contains(&"not-resolved-across"));
    assert!(along["std"].is_null() && codes(&stroke).contains(&"assumed-side"));
    let given = json!({ "kind": "sphere", "outward": [0, 0, 1] });
    let stated = estimate_with(&text, &given).unwrap();
    assert!(stated["stroke"]["curvature_along"]["std"].is_number());
    assert!(!stated["warnings"].to_string().contains("at least"));
}

#[test]
fn copies_count_once() {
    // The copies differ by `step` in their last number.
    let changed = |text: &str, times: usize, step: f64| {
        let (header, rows) = text.split_once('\n').unwrap();
        let copies = rows.lines().flat_map(|row| {
            let (row, last) = row.rsplit_once(',').unwrap();
            let last: f64 = last.parse().unwrap();
            (0..times).map(move |copy| format!("{row},{}\n", last + step * copy as f64))
        });
        format!("{header}\n{}", copies.collect::<String>())
    };
    let rows = |text: &str, times: usize| changed(text, times, 0.0);
    let near = |one: &Value, four: &Value, key: &str| {
        for key in ["value", "std"].map(|part| format!("/{key}/{part}")) {
            let [one, four] = [one, four].map(|of| of.pointer(&key).unwrap().as_f64().unwrap());
            assert!((four / one - 1.0).abs() < 0.01, "{key}: {one}, {four}");
        }
        assert!(codes(four).contains(&"repeated-rows"));
    };
    let same = |one: &Value, four: &Value, keys: &[&str]| {
        for key in keys {
            assert_eq!(one[*key], four[*key], "{key}");
        }
        assert!(codes(four).contains(&"repeated-rows"));
    };
    let glide = ball(&|_| None);
    for method in ["penalised", "quadric", "sphere"] {
        let one = estimate(&glide, method).unwrap();
        for copied in [rows(&glide, 4), glide.repeat(2)] {
            let copied = estimate(&copied, method).unwrap();
            same(&one, &copied, &["mean_curvature", "effective_contacts"]);
        }
    }
    let stroke: String = glide.split_inclusive('\n').take(13).collect();
    let [one, four] = [1, 4].map(|times| estimate(&rows(&stroke, times), "shape").unwrap());
    same(&one, &four, &["stroke"]);
    // A finger that scans a raster, and moves back at the end of each line, must not count as a resting finger.
    let raster = glide.replace("\n1,", "\n0,").replace("\n2,", "\n0,");
    let of_raster = estimate(&raster, "penalised").unwrap();
    assert_eq!(of_raster["effective_contacts"], 36.0);
    let roll = "rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n0,-0.3,2.01,0\n0.3,0,0,2\n0.2,-0.2,1.32,1.3\n0.2,0.2,-1.31,1.33\n";
    let of_rolls = |text: &str| {
        let readings = RollRecording::try_from(file(text)).unwrap();
        let estimate = estimate_roll(readings, &RollOptions::new(10.0)).unwrap();
        serde_json::to_value(estimate).unwrap()
    };
    let [one, four] = [1, 4].map(|times| of_rolls(&rows(roll, times)));
    same(&one, &four, &["mean_curvature", "residual_rms"]);
    near(&one, &of_rolls(&changed(roll, 4, 1e-5)), "mean_curvature");
    let named: Vec<String> = (0..)
        .zip(roll.lines())
        .map(|(row, line)| format!("{row},{line}"))
        .collect();
    let named = named.join("\n").replacen('0', "probe", 1);
    for copied in [rows(&named, 4), format!("{named}\n{named}")] {
        same(
            &one,
            &of_rolls(&copied),
            &["mean_curvature", "residual_rms"],
        );
    }
    // A slow sweep has no copies, although an outlier makes its residuals large.
    let mut sweep = "rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n".to_owned();
    for (roll, turn) in (0..400).map(|roll| (roll, 5e-4 * (roll % 200 + 1) as f64)) {
        let shift = 20.0 / 3.0 * turn + if roll == 50 { 3.0 } else { 0.0 };
        let [x, y, u, v] = [[0.0, -turn, shift, 0.0], [turn, 0.0, 0.0, shift]][roll / 200];
        sweep += &format!("{x},{y},{u},{v}\n");
    }
    assert!(!codes(&of_rolls(&sweep)).contains(&"repeated-rows"));
    let mut press = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
    for marker in 0..49 {
        let [x, y] = [marker % 7, marker / 7].map(|step| f64::from(step) - 3.0);
        let error = 0.01 * libm::sin(7.7 * f64::from(marker * marker));
        let depth = 1.0 * libm::exp(-0.15 * (x * x + y * y)) + error;
        press += &format!("{x},{y},{depth}\n");
    }
    let given = json!({ "sensor_radius": 20.0, "depth": 2.0 });
    let of_press = |text: &str| {
        let readings = PressRecording::try_from(file(text)).unwrap();
        let options = PressOptions::with_settings(None, given.as_object().unwrap(), None, false);
        let report = estimate_press(&readings, &options.unwrap()).unwrap();
        serde_json::to_value(report).unwrap()
    };
    let [one, four] = [1, 4].map(|times| of_press(&rows(&press, times)));
    same(&one, &four, &["object_curvature", "indentation", "noise"]);
    let changed = of_press(&changed(&press, 4, 1e-5));
    near(&one, &changed, "object_curvature");
}

#[test]
fn a_stated_tip_radius_is_compared_with_the_column() {
    let rows = ball(&|_| None).replace("z_mm\n", "z_mm,tip_radius_mm\n");
    let mut lines = rows.lines();
    let header = lines.next().unwrap().to_owned();
    let text = lines.fold(header, |text, line| format!("{text}\n{line},5"));
    for (stated, is_other) in [(0.0, false), (3.0, true), (5.0, false)] {
        let given = json!({ "tip_radius": stated, "reports": "centre" });
        let estimate = estimate_with(&text, &given).unwrap();
        assert_eq!(
            codes(&estimate).contains(&"stated-scale"),
            is_other,
            "{estimate}"
        );
    }
}

/// Swapped components of normals must cause a warning. Correct normals of contacts on a single arc, on two lines or on
/// three lines must cause none, although an arc or two lines do not determine the surface across them.
#[test]
fn swapped_normals_on_lines_cause_a_warning() {
    let mut noise = Stream::new(1996, 0, Channel::Position);
    let mut warnings = |apart: f64, lines: usize, swap: bool| {
        let mut error = |std: f64| [(); 3].map(|()| std * noise.standard_normal());
        let (mut places, mut normals, mut fingers) = (Vec::new(), Vec::new(), Vec::new());
        for contact in 0..21 * lines {
            let line = contact / 21;
            let [x, y] = [(contact % 21) as f64 - 10.0, apart * line as f64];
            let outward = [x, y, (900.0 - x * x - y * y).sqrt()].map(|part| part / 30.0);
            let (of_place, of_normal) = (error(0.02), error(0.017));
            places.push([0, 1, 2].map(|axis| 30.0 * outward[axis] + of_place[axis]));
            let [x, y, z] = [0, 1, 2].map(|axis| outward[axis] + of_normal[axis]);
            let length = (x * x + y * y + z * z).sqrt();
            let [y, z] = if swap { [z, y] } else { [y, z] };
            normals.push([x, y, z].map(|part| part / length));
            fingers.push(line as u64);
        }
        let readings = GlideRecording::new(&places, Some(&normals), Some(&fingers), None).unwrap();
        match estimate_glide(&readings, &GlideOptions::default()) {
            Ok((estimate, _)) => serde_json::to_string(&estimate).unwrap(),
            Err(error) => error.to_string(),
        }
    };
    let words = "normal_y and normal_z swapped";
    for apart in [1.0, 4.0] {
        let found = warnings(apart, 3, true);
        assert!(found.contains(words), "{found}");
    }
    for (apart, lines) in [(0.0, 3), (4.0, 2), (1.0, 3), (4.0, 3)] {
        let found = warnings(apart, lines, false);
        assert!(!found.contains("contradict the positions"), "{found}");
    }
}
