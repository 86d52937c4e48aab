//! Tests `palpate sensor calibrate` and `palpate sensor track`.

use image::RgbImage;

use super::desk::{Desk, assert_close};
use super::frames::{DISTANCE, PX_PER_RAD, SIDE, frame, places, png, png_header, write};

const MARKERS: &str =
    "marker,x_px,y_px,hue_turns,dx_px,dy_px,dhue_turns,status,mean_hue_turns,dmean_hue_turns";

/// Normal displacement (mm) at a depth of 2 mm in an incompressible half-space, if a sensor of radius 20 mm is pressed
/// 1 mm onto a plane. The formula is the closed form for the Hertz pressure.
fn pressed([x, y]: [f64; 2]) -> f64 {
    let (radius, depth, nu): (f64, f64, f64) = (20.0, 2.0, 0.5);
    let r = radius * libm::hypot(x, y);
    let contact = radius.sqrt();
    let [near, far] = [r - contact, r + contact].map(|along| libm::hypot(along, depth));
    let [l_1, l_2] = [0.5 * (far - near), 0.5 * (far + near)];
    let angle = libm::asin(contact / l_2);
    let [a, z] = [contact, depth];
    let of_pressure = (2.0 * a * a - r * r + 2.0 * z * z) * angle
        + (3.0 * l_1 * l_1 - 2.0 * a * a) / a * (l_2 * l_2 - a * a).sqrt();
    let of_depth = (a * a - l_1 * l_1).sqrt() - z * angle;
    // Pressure at the centre of the contact, divided by the shear modulus.
    let pressure = 4.0 / std::f64::consts::PI / radius.sqrt() / (1.0 - nu);
    pressure / (4.0 * a) * ((1.0 - nu) * of_pressure + 2.0 * z * of_depth)
}

/// A directory with a frame at rest, a pressed frame, and a calibration from the marker sizes in three frames.
fn desk() -> Desk {
    let desk = Desk::new();
    write(&desk, "rest.png", frame(|_| 0.0, &[]));
    write(&desk, "pressed.png", frame(pressed, &[]));
    for (name, depth) in [("1.png", 0.4), ("2.png", 0.8), ("3.png", 1.2)] {
        write(
            &desk,
            name,
            frame(|place| depth * pressed(place) / pressed([0.0, 0.0]), &[]),
        );
    }
    desk.palpate("sensor calibrate rest.png 1.png 2.png 3.png --normal 0.4,0.8,1.2 --length-unit mm --from size --out c.toml")
        .printed();
    desk
}

#[test]
fn frames_calibrate_and_are_tracked() {
    let desk = desk();
    let calibration = desk.read("c.toml");
    assert!(calibration.contains(&format!("markers = {}", places().len())));
    let slope = calibration
        .lines()
        .find_map(|line| line.strip_prefix("slope = "));
    assert_close(slope.unwrap().parse().unwrap(), 1.0 / DISTANCE, 0.02);

    let track = |options: &str| -> serde_json::Value {
        let frames = "sensor track rest.png pressed.png --calibration c.toml --out o";
        let command = format!("{frames} --px-per-rad {PX_PER_RAD} {options}");
        serde_json::from_str(&desk.palpate(&command).printed()).unwrap()
    };
    let json = track("--sensor-radius 20 --depth 2 --indentation 1");
    assert_eq!(json["frames"]["tracked"], places().len());
    assert_close(
        json["effective_radius"]["value"].as_f64().unwrap(),
        20.0,
        0.05,
    );
    assert_eq!(
        desk.names("o"),
        [
            "difference.png",
            "field.csv",
            "markers.csv",
            "overlay.png",
            "readings.csv"
        ]
    );

    let markers = desk.table("o/markers.csv");
    assert_eq!(markers.header.join(","), MARKERS);
    assert_eq!(markers.text(0, "status"), "tracked");
    assert_close(markers.number(0, "x_px"), 0.5 * f64::from(SIDE), 0.02);
    let readings = desk.table("o/readings.csv");
    assert_eq!(readings.header, ["x_mm", "y_mm", "normal_displacement_mm"]);
    assert_eq!(readings.rows.len(), places().len());
    for row in 0..readings.rows.len() {
        let [x, y, normal] =
            ["x_mm", "y_mm", "normal_displacement_mm"].map(|name| readings.number(row, name));
        let expected = pressed([x / 20.0, y / 20.0]);
        assert!(
            (normal - expected).abs() < 0.05,
            "{x} {y}: {normal} is not {expected}"
        );
    }
    // `estimate press` computes the same estimate from the readings that `sensor track` wrote.
    let again =
        desk.json("estimate press o/readings.csv --sensor-radius 20 --depth 2 --indentation 1");
    assert_eq!(again["effective_radius"], json["effective_radius"]);
    // `sensor track` and `estimate press` also print the same estimate for a soft layer on a rigid core.
    let layer = "--sensor-radius 20 --depth 2 --method bonded-layer --thickness 12 --indentation 1";
    let tracked = track(layer);
    let estimated = desk.json(&format!("estimate press o/readings.csv {layer}"));
    assert_eq!(tracked["method"], "bonded-layer");
    assert_eq!(tracked["effective_radius"], estimated["effective_radius"]);
    let field = desk.table("o/field.csv");
    assert!(field.rows.len() > 600 && field.header == readings.header);

    let overlay = image::open(desk.path("o/overlay.png")).unwrap();
    assert!(overlay.width() >= 1000);
    let difference = image::open(desk.path("o/difference.png")).unwrap();
    assert_eq!(difference.width(), SIDE);
}

#[test]
fn lost_markers_are_reported_and_the_others_used() {
    let desk = Desk::new();
    write(&desk, "rest.png", frame(|_| 0.0, &[]));
    write(&desk, "pressed.png", frame(pressed, &[3, 20]));
    let count = places().len();
    let printed = desk
        .palpate("sensor track rest.png pressed.png --out o")
        .printed();
    let expected = format!(
        "{count} markers at rest (0 more cut by the rim): {} tracked, 2 lost",
        count - 2
    );
    assert!(printed.starts_with(&expected), "{printed}");
    let markers = desk.table("o/markers.csv");
    let lost: Vec<usize> = (0..count)
        .filter(|&row| markers.text(row, "status") == "lost")
        .collect();
    assert_eq!(lost.len(), 2);
    assert_eq!(markers.text(lost[0], "dx_px"), "");
    assert!(markers.number(lost[0], "x_px") > 0.0);
    assert_eq!(
        desk.names("o"),
        ["difference.png", "markers.csv", "overlay.png"]
    );
}

#[test]
fn swapped_frames_cause_a_warning_and_other_sensors_an_error() {
    let desk = desk();
    let swapped = desk.palpate("sensor track pressed.png rest.png --out o");
    assert_eq!(swapped.status, Some(0));
    assert!(swapped.stderr.contains("warning: ") && swapped.stderr.contains("swapped"));

    let without: Vec<usize> = (0..places().len())
        .filter(|marker| marker % 3 > 0)
        .collect();
    write(&desk, "other.png", frame(|_| 0.0, &without));
    desk.palpate("sensor track rest.png other.png --out o")
        .fails(1, "frames of one sensor");

    let run = "--calibration c.toml --sensor-radius 20 --depth 2 --px-per-rad 151.3 --out o";
    desk.palpate(&format!("sensor track other.png other.png {run}"))
        .fails(1, &format!("a sensor with {} markers", places().len()));
    // The pressed frame is the frame at rest, so the estimate finds no contact.
    let said = desk
        .palpate(&format!("sensor track rest.png rest.png {run}"))
        .said(1);
    assert!(
        said.contains("o/readings.csv") && desk.names("o").len() == 5,
        "{said}"
    );
}

#[test]
fn unusable_frames_are_refused() {
    let desk = Desk::new();
    write(&desk, "rest.png", frame(|_| 0.0, &[]));
    let [small, black] = [SIDE - 1, SIDE].map(|side| png(RgbImage::new(SIDE, side)));
    let huge = png_header(20_000, 20_000);
    let frames: Vec<(&str, Vec<u8>, &str)> = vec![
        (
            "huge.png",
            huge,
            "too many pixels; at most 8192 px per side",
        ),
        ("small.png", small, "rest.png has 400 x 400"),
        ("black.png", black, "black.png: no markers"),
    ];
    for (name, bytes, word) in frames {
        desk.write(name, bytes);
        let said = desk
            .palpate(&format!("sensor track rest.png {name} --out o"))
            .said(1);
        assert!(said.contains(name) && said.contains(word), "{name}: {said}");
        assert!(desk.names("o").is_empty(), "{name}");
    }
    desk.write("dot.png", png(RgbImage::new(1, 1)));
    desk.palpate("sensor track dot.png dot.png --out o")
        .fails(1, "dot.png: the frame has 1 by 1 px");
}

/// Each row has two parts, separated by `|`. The first part is a table: displacement and hue of each point, or a whole
/// table with its header. The second part contains words of the expected error.
const NO_CALIBRATIONS: &str = r"
1,0.02 | 1 points; a calibration needs at least 2
1,0.02\n2,nan | t.csv:3: column `hue_turns`
1,0.02\n2,9.3 | t.csv:3: column `hue_turns`: a change of hue must be between -0.5 and 0.5 turns, is 9.3
 | no readings
a,b\n1,2 | no columns `normal_displacement`
tangential_displacement_mm,centroid_shift_px\n1,7 | 1 points
";

#[test]
fn unusable_calibration_points_are_refused() {
    let desk = Desk::new();
    let header = "normal_displacement_mm,hue_turns";
    for row in NO_CALIBRATIONS.trim().lines() {
        let (rows, words) = row.split_once(" | ").unwrap();
        let rows = rows.replace("\\n", "\n");
        let has_header = rows.starts_with(char::is_alphabetic);
        let header = if has_header { "" } else { header };
        desk.write("t.csv", format!("{header}\n{rows}\n").trim_start());
        let said = desk.palpate("sensor calibrate t.csv --out c.toml").said(1);
        let is_named = said.contains("t.csv") && said.contains(words);
        assert!(is_named && !desk.path("c.toml").exists(), "{row}: {said}");
    }
    desk.write("t.csv", format!("{header}\n1,0.02\n2,0.05\n"));
    desk.palpate("sensor calibrate t.csv --from size --out c.toml")
        .fails(1, "no column `growth`");
    desk.write(
        "cm.csv",
        "tangential_displacement_cm,centroid_shift_px\n1,7\n2,14\n",
    );
    desk.palpate("sensor calibrate t.csv cm.csv --out c.toml")
        .fails(1, "cm.csv: the header says cm, t.csv says mm");
}

#[test]
fn poor_calibration_points_cause_warnings() {
    let desk = Desk::new();
    let calibration_warnings = |rows: &str| {
        desk.write("t.csv", format!("normal_displacement_mm,hue_turns\n{rows}"));
        let ended = desk.palpate("sensor calibrate t.csv --out c.toml --force");
        assert_eq!(ended.status, Some(0), "{ended:?}");
        ended.stderr
    };
    let good = "0.5,0.0126\n1,0.0249\n1.5,0.0377\n2,0.05\n";
    assert_eq!(calibration_warnings(good), "");
    let twice = calibration_warnings(&format!("{good}{good}"));
    assert!(twice.contains("4 points repeat others"), "{twice}");
    let absolute = calibration_warnings("0.5,0.3126\n1,0.3249\n1.5,0.3377\n2,0.35\n");
    assert!(
        absolute.contains("are they changes from rest"),
        "{absolute}"
    );
}

#[test]
fn invalid_calibration_files_are_refused() {
    let desk = desk();
    let good = desk.read("c.toml");
    let run = "sensor track rest.png pressed.png --calibration bad.toml --sensor-radius 20 --depth 2 --px-per-rad 151.3 --out o";
    for (text, word) in [
        (String::new(), "is empty"),
        (
            good.replace("length_unit = \"mm\"", "length_unit = \"ell\""),
            "ell",
        ),
        (
            good.replacen("slope = ", "slope = 0.0 # ", 1),
            "a line's slope is 0",
        ),
    ] {
        desk.write("bad.toml", &text);
        let said = desk.palpate(run).said(1);
        assert!(
            said.contains("bad.toml") && said.contains(word),
            "{word}: {said}"
        );
        assert!(desk.names("o").is_empty());
    }
    // The calibration contains no scale in px per length; therefore, --px-per-rad is required.
    desk.palpate("sensor track rest.png pressed.png --calibration c.toml --sensor-radius 20 --depth 2 --out o").fails(1, "--px-per-rad");
    assert!(desk.names("o").contains(&"markers.csv".to_owned()));
}
