//! Tests `palpate estimate glide` with simulated contacts.

use serde_json::Value;

use super::desk::{Desk, assert_close, number_at as number};

const BARE: &str = "finger,x_mm,y_mm,z_mm";

/// Contacts on a grid of `side` × `side` points. `row` returns the table row of the contact at x and y in [−1, 1],
/// without the field `finger`.
fn grid(header: &str, side: usize, row: impl Fn(f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    let at = |index: usize| 2.0 * index as f64 / (side - 1) as f64 - 1.0;
    for finger in 0..side {
        for contact in 0..side {
            text += &format!("{finger},{}\n", row(at(contact), at(finger)));
        }
    }
    text
}

fn bowl() -> String {
    grid(BARE, 6, |x, y| format!("{x},{y},{}", 0.2 * (x * x + y * y)))
}

fn desk(contacts: &str) -> Desk {
    let desk = Desk::new();
    desk.write("r.csv", contacts);
    desk
}

fn estimate(contacts: &str, options: &str) -> Value {
    desk(contacts).json(&format!("estimate glide r.csv {options}"))
}

fn mean(json: &Value) -> f64 {
    number(json, "/mean_curvature/value")
}

#[test]
fn contacts_without_a_patch_are_refused() {
    let ball = grid(BARE, 12, |u, v| {
        let (sin, cos) = libm::sincos(3.1 * u);
        let (height, radius) = libm::sincos(1.5 * v);
        format!("{},{},{}", radius * cos, radius * sin, height)
    });
    let flat = grid(&format!("{BARE},normal_x,normal_y,normal_z"), 6, |x, y| {
        format!("{x},{y},0,0,0,1")
    });
    let with = |normal: &str| flat.replacen("-1,-1,0,0,0,1", &format!("-1,-1,0,{normal}"), 1);
    for (contacts, message) in [
        (ball, "r.csv: the contacts have no mean plane"),
        (
            with("0,0,0"),
            "r.csv:2: contact 0 (counting from 0): the normal has no direction",
        ),
        (
            with("1,0,0"),
            "r.csv:2: the patch is not a graph over its mean plane",
        ),
    ] {
        desk(&contacts)
            .palpate("estimate glide r.csv")
            .fails(1, message);
    }
}

#[test]
fn a_vertical_wall_needs_the_outward_direction() {
    // The patch is on the +x side of a cylinder of radius 5 around the z axis. The default outward direction is z,
    // which lies in the plane of this patch, so `--outward` is needed.
    let wall = grid(BARE, 6, |y, z| format!("{},{y},{z}", (25.0 - y * y).sqrt()));
    desk(&wall)
        .palpate("estimate glide r.csv")
        .fails(1, "give another with --outward");
    for (outward, sign) in [("1,0,0", 1.0), ("-2,0,0", -1.0)] {
        let found = estimate(&wall, &format!("--outward {outward}"));
        assert_close(mean(&found), sign * 0.1, 0.02);
    }
}

#[test]
fn duplicates_and_one_finger() {
    let bowl = bowl();
    let rows = || bowl.lines().skip(1);
    let doubled: String = rows().map(|row| format!("{row}\n{row}\n")).collect();
    // A single finger that moves back and forth over the patch results in the same estimate as several fingers.
    let one: String = rows().map(|row| format!("9{}\n", &row[1..])).collect();
    for (rows, fingers) in [(doubled, 6), (one, 1)] {
        let json = estimate(&format!("{BARE}\n{rows}"), "");
        assert_eq!(json["fingers"], fingers);
        assert_close(mean(&json), -0.4, 1e-9);
    }
}

#[test]
fn stated_thresholds_and_noise_are_used() {
    let json = estimate(
        &bowl(),
        "--gaussian-threshold 1 --mean-threshold 1 --position-std 0.02 --method quadric",
    );
    let classes = (
        &json["class"],
        &json["sign_class"],
        &json["thresholds"]["from"],
    );
    assert_eq!(
        classes,
        (&"flat".into(), &"concave".into(), &"given".into())
    );
    assert_close(number(&json, "/noise/position_std/value"), 0.02, 1e-9);
    assert!(number(&json, "/mean_curvature/std") > 1e-3);
}

#[test]
fn two_pass_of_one_finger_needs_a_unit() {
    let bowl = bowl();
    let rows = bowl.lines().skip(1);
    let one: String = rows.map(|row| format!("0{}\n", &row[1..])).collect();
    let one = format!("{BARE}\n{one}");
    desk(&one)
        .palpate("estimate glide r.csv --method two-pass")
        .fails(1, "needs --inter-finger-distance");
    // The fingers of the grid are 0.4 apart. The method `two-pass` uses this distance as its unit of length. If the
    // command states the distance, the estimate stays the same.
    let given = estimate(&bowl, "--method two-pass --inter-finger-distance 0.4");
    let found = estimate(&bowl, "--method two-pass");
    assert_close(mean(&given), mean(&found), 1e-9);
    assert!(found["status"].is_string() && estimate(&bowl, "")["status"].is_null());
    assert!(
        mean(&estimate(
            &one,
            "--method two-pass --inter-finger-distance 0.4"
        )) < 0.0
    );
    desk(&bowl)
        .palpate("estimate glide r.csv --method two-pass --inter-finger-distance 1e300")
        .fails(1, "--inter-finger-distance is 1e300");
}

#[test]
fn a_map_at_the_contacts_has_their_positions_in_their_order() {
    // The contacts have no noise, and the outward direction of the bowl is z. So the line through a contact in this
    // direction meets the surface z = 0.2 (x² + y²) at the contact itself.
    let desk = desk(&bowl());
    let on_grid = desk
        .palpate("estimate glide r.csv --map grid.csv")
        .printed();
    let at_contacts = desk
        .palpate("estimate glide r.csv --map m.csv --at-contacts")
        .printed();
    assert_eq!(on_grid, at_contacts);
    let (readings, map) = (desk.table("r.csv"), desk.table("m.csv"));
    assert_eq!(map.header, desk.table("grid.csv").header);
    assert_eq!(map.rows.len(), readings.rows.len());
    for row in 0..map.rows.len() {
        let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|column| {
            let place = readings.number(row, column);
            assert!(
                (map.number(row, column) - place).abs() < 1e-9,
                "{column} of row {row}"
            );
            place
        });
        let gaussian = map.number(row, "gaussian_curvature_per_mm2");
        assert_close(
            gaussian,
            0.16 / (1.0 + 0.16 * (x * x + y * y)).powi(2),
            1e-9,
        );
        assert_eq!((map.text(row, "region"), z >= 0.0), ("", true));
    }
}
