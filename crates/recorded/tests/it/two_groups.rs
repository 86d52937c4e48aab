//! The warning `two-groups`, which reports two objects in one log.

use palpate_sensing::{Channel, Stream};

use crate::logs::{codes, estimate};

/// Three strokes on each side of a gap: on two balls and on two plates at an angle, then on one surface. The last gap is
/// 51 mm wide, between two balls.
#[test]
fn only_groups_without_a_common_surface_cause_a_warning() {
    let surfaces: [fn(f64, f64) -> f64; 7] = [
        |x, y| (400.0 - (x.abs() - 9.0).powi(2) - y * y).sqrt(),
        |x, _| -0.3 * x.abs(),
        |x, _| -0.5 * x.max(0.0),
        |x, y| 0.4 * (900.0 - x * x - 2.0 * y * y).sqrt(),
        |x, y| 0.01 * (x * x - y * y),
        |x, _| 0.4 * libm::sin(0.12 * x + 0.5),
        |x, y| (400.0 - (x.abs() - 30.0).powi(2) - y * y).sqrt(),
    ];
    for (case, surface) in surfaces.iter().enumerate() {
        let mut noise = Stream::new(51, 0, Channel::Position);
        let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
        for row in 0..60 {
            let side = f64::from(row / 30 * 2 - 1);
            let [x, y] = [row % 10, row % 30 / 10].map(f64::from);
            let gap = if case < 6 { 4.5 } else { 25.5 };
            let [x, y] = [side * (x + gap), 4.0 * y - 4.0];
            let z = surface(x, y) + 0.02 * noise.standard_normal();
            text += &format!("{},{x},{y},{z}\n", row / 10);
        }
        for method in ["penalised", "quadric", "shape"] {
            let found = estimate(&text, method).unwrap();
            let expected = case < 3 || case == 6;
            assert_eq!(codes(&found).contains(&"two-groups"), expected, "{found}");
        }
    }
}

/// Three fingers with normals, the third on the same ball or on a smaller ball. One smooth surface can
/// follow the heights of three straight strokes on two balls, but not their normals.
#[test]
fn normals_reveal_a_finger_on_another_object() {
    for radius in [30.0, 15.0] {
        let mut noise = Stream::new(54, 0, Channel::Position);
        let mut text = "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z\n".to_owned();
        for row in 0..90 {
            let [x, y] = [row % 30, row / 30].map(f64::from);
            let [x, y] = [0.6 * x - 8.7, 6.0 * y - 6.0];
            let radius: f64 = if y > 0.0 { radius } else { 30.0 };
            let z = (radius * radius - x * x - y * y).sqrt();
            let mut error = |std: f64| std * noise.standard_normal();
            let [a, b] = [x, y].map(|at| at / radius + error(0.01));
            text += &format!(
                "{},{x},{y},{},{a},{b},{}\n",
                row / 30,
                z - radius + error(0.03),
                z / radius
            );
        }
        let found = estimate(&text, "penalised").unwrap();
        assert_eq!(
            codes(&found).contains(&"two-groups"),
            radius < 30.0,
            "{found}"
        );
    }
}

/// Five strokes without a gap: on two balls, on a ball and a plate, on a roof and on a step; then on smooth surfaces.
#[test]
fn touching_objects_cause_a_warning() {
    let ball = |x: f64, y: f64| (225.0 - x * x - y * y).max(0.0).sqrt();
    let surfaces: [&dyn Fn(f64, f64) -> f64; 6] = [
        &|x, y| ball(x.abs() - 10.0, y),
        &|x, y| (ball(x - 6.0, y) - 9.0).max(0.0),
        &|x, y| -0.4 * (x + 0.2 * y).abs(),
        &|x, _| 3.0 * f64::from(u8::from(x > 1.5)),
        &|x, y| 0.6 * ball(0.9 * x, 0.7 * y),
        &|x, y| libm::sin(0.25 * x + 0.1 * y),
    ];
    for (case, surface) in surfaces.into_iter().enumerate() {
        let mut noise = Stream::new(53, 0, Channel::Position);
        let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
        for row in 0..150 {
            let [x, y] = [row % 30, row / 30].map(f64::from);
            let [x, y] = [0.7 * x - 10.0, 3.0 * y - 6.0];
            let z = surface(x, y) + 0.05 * noise.standard_normal();
            text += &format!("{},{x},{y},{z}\n", row / 30);
        }
        let found = estimate(&text, "penalised").unwrap();
        let expected = case < 4;
        assert_eq!(
            codes(&found).contains(&"two-groups"),
            expected,
            "{case}: {found}"
        );
    }
}

/// Five fingers touch one object and five touch another at the same place, or all ten touch an object with an edge. In the
/// last case, all fingers touch one ball, and each records its first contact many times. Then there is no warning.
#[test]
fn two_surfaces_at_the_same_place_cause_a_warning() {
    let height = |radius: f64, x: f64, y: f64| (radius * radius - x * x - y * y).sqrt() - radius;
    let cases = [(15.0, 0.0, 0.0), (40.0, 2.0, 0.0), (40.0, 0.0, 0.7)];
    let cases = cases.map(|case| (case, 1));
    for ((radius, step, edge), rest) in cases.into_iter().chain([((40.0, 0.0, 0.0), 50)]) {
        let mut noise = Stream::new(52, 0, Channel::Position);
        let mut text = "finger,x_mm,y_mm,z_mm\n".to_owned();
        for row in 0..200 {
            let (finger, x) = (row / 20, 0.8 * f64::from(row % 20) - 7.6);
            let y = 3.5 * f64::from(finger % 5) - 7.0;
            let (radius, step) = if finger < 5 {
                (40.0, 0.0)
            } else {
                (radius, step)
            };
            let z = height(radius, x, y) + step - edge * (x + 0.3 * y).abs();
            let z = z + 0.05 * noise.standard_normal();
            let times = if row % 20 == 0 { rest } else { 1 };
            text += &format!("{finger},{x},{y},{z}\n").repeat(times);
        }
        let found = estimate(&text, "penalised").unwrap();
        assert_eq!(codes(&found).contains(&"two-groups"), rest == 1, "{found}");
    }
}
