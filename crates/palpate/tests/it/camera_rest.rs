//! `palpate sensor calibrate --rest`.

use crate::desk::Desk;

/// A sensor whose camera is not at the centre.
const SENSOR: &str = r#"
name = "beside"
length_unit = "mm"
trials = 1
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = 0.2 } }
object = { kind = "plane" }
motion = { indentation = 1.0 }
sensor = { kind = "rendered", size_px = 400, place = [0.5, 0.0, -0.4], calibration = { presses = 2, rest_frames = 1 } }
noise = { pixel = { kind = "gaussian", std = 2.0 } }
"#;

#[test]
fn one_frame_at_rest_locates_the_camera() {
    let desk = Desk::with(SENSOR);
    desk.palpate("trace c.toml --trial 0 --out t").printed();
    let central = SENSOR.replace("place = [0.5, 0.0, -0.4], ", "");
    desk.write("central.toml", central.replace("beside", "central"));
    let frame = desk
        .names("t")
        .into_iter()
        .find(|name| name.contains("rest") && name.ends_with(".png"))
        .unwrap();
    let run = format!("sensor calibrate --rest t/{frame} --layout central.toml --out camera.toml");
    let said = desk.palpate(&run).printed();
    assert!(
        said.contains("camera at (") && said.contains("px per rad"),
        "{said}"
    );
    let camera: toml::Table = desk.read("camera.toml").parse().unwrap();
    let of = |key: &str, axis: usize| camera[key].as_array().unwrap()[axis].as_float().unwrap();
    for (axis, place) in [0.5, 0.0, -0.4].into_iter().enumerate() {
        let (found, std) = (of("place", axis), of("place_std", axis));
        assert!(
            (found - place).abs() < 4.0 * std && std < 0.1,
            "{found} {std}"
        );
    }
    // The second of two cells describes this sensor.
    let sizes = "[[sweep]]\npath = \"scene.sensor.size_px\"\nvalues = [300, 400]\n";
    desk.write("sizes.toml", central.clone() + sizes);
    let run = format!("sensor calibrate --rest t/{frame} --layout sizes.toml");
    desk.palpate(&format!("{run} --cell 1 --out same.toml"))
        .printed();
    assert_eq!(desk.read("same.toml"), desk.read("camera.toml"));
    desk.palpate(&format!("{run} --out o.toml")).fails(1, "300");
    desk.palpate(&format!("{run} --cell 2 --out o.toml"))
        .fails(2, "--cell is 2");
}
