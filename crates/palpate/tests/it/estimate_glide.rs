//! Tests `palpate estimate glide` with simulated contacts.

use super::desk::{Desk, assert_close, number_at as number};

/// Contacts on a grid of 6 × 6 points, with x and y in [−1, 1].
fn bowl() -> Desk {
    let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
    let at = |index: i32| 0.4 * f64::from(index) - 1.0;
    for (finger, contact) in (0..36).map(|number| (number / 6, number % 6)) {
        let (x, y) = (at(contact), at(finger));
        text += &format!("{finger},{x},{y},{}\n", 0.2 * (x * x + y * y));
    }
    let desk = Desk::new();
    desk.write("r.csv", &text);
    desk
}

#[test]
fn stated_thresholds_and_noise_are_used() {
    let json = bowl().json(
        "estimate glide r.csv --gaussian-threshold 1 --mean-threshold 1 --position-std 0.02 --method quadric",
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
fn a_map_at_the_contacts_has_their_positions_in_their_order() {
    // The contacts have no noise, and the outward direction of the bowl is z. So the line through a contact in this
    // direction meets the surface z = 0.2 (x² + y²) at the contact itself.
    let desk = bowl();
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
