//! Tests `palpate explain` and `palpate schema --quantities`.

use super::desk::Desk;

#[test]
fn words_are_explained() {
    let desk = Desk::new();
    for (word, words) in [
        (
            "not-rolling",
            "not-rolling\n  The contact moved against the direction of the roll",
        ),
        ("ifd", "Inter-finger distance"),
        ("rung", "One of several models"),
        ("class", "class\n  Shape class at a point of the patch"),
        ("relative curvature", "1/R_s + 1/R_o"),
        ("coverage95", "Share of the estimator's 95 % intervals"),
        ("u", "Tangent direction at the contact"),
        (
            "Encoder",
            "scene.noise.encoder\n  Rounding of the measured rotation",
        ),
        (
            "radius",
            "scene.probe.radius\n  Radius of the skin; `inf` for a flat pad.",
        ),
    ] {
        desk.palpate(&format!("explain {word}")).prints(words);
    }
    let all = desk.palpate("explain").printed();
    for word in [
        "Failures of rolls\n",
        "not-rolling",
        "knots-exhausted",
        "bonded-layer",
    ] {
        assert!(all.contains(word), "{word}: {all}");
    }
    assert!(all.lines().all(|line| line.chars().count() <= 102), "{all}");
    assert_eq!(
        desk.palpate("explain not-roling").said(2),
        "error: `not-roling` is not a word of palpate; did you mean not-rolling, not-round?\n"
    );
    desk.palpate("explain zzzzzz")
        .fails(2, "`palpate explain` lists all words");
}

#[test]
fn the_glossary_has_words_quantities_statistics_and_keys() {
    let glossary = Desk::new().palpate("explain --markdown").printed();
    for row in [
        "| rung | One of several models",
        "| `mean_curvature` | Mean curvature of the object. Unit: 1/length. Scenes: roll, glide. |",
        "| `rms_error` | Root mean square of the errors. |",
        "| `object` of a roll | sphere, dish, plane, cylinder, ellipsoid,",
        "| `noise` of a roll | angular_velocity, ",
        "| `scene.object.kind` | `dish`: The inside of a sphere. The probe touches its lower half. |",
    ] {
        assert!(glossary.contains(&format!("\n{row}")), "{row}: {glossary}");
    }
    let columns = glossary.lines().filter(|line| line.starts_with('|'));
    for line in columns {
        assert_eq!(line.replace("\\|", "").matches('|').count(), 3, "{line}");
    }
}

#[test]
fn scenes_and_quantities_are_listed() {
    let desk = Desk::new();
    for (arguments, parts) in [
        (
            "explain scenes",
            &[
                "roll\n  probe     sphere\n  object    sphere, dish, plane,",
                "\n  sensor    ideal, wrist, pads\n",
                "\n\npress\n  probe     marker-sphere\n",
            ][..],
        ),
        (
            "schema --quantities",
            &[
                "\nmean_curvature  [1/length; roll, glide]\n  Mean curvature of the object.\n",
                "\nrms_error  [unit of the quantity]\n  Root mean square of the errors.\n",
                "\ncoverage95  [number]\n",
            ],
        ),
        ("schema", &["A sensor with markers, without an object"]),
    ] {
        desk.palpate(arguments).prints_all(parts);
    }
}

#[test]
fn error_messages_name_the_term_to_explain() {
    let desk = Desk::new();
    let header = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n";
    desk.write("few.csv", format!("{header}0,0,-0.5,4,0\n"));
    desk.write("back.csv", format!("{header}0,0,-0.5,-4,0\n1,0.5,0,0,-4\n"));
    desk.write(
        "line.csv",
        "finger,x,y,z\n0,0,0,0\n0,1,0,0\n0,2,0,0\n0,3,0,0\n0,4,0,0\n0,5,0,0\n0,6,0,0\n",
    );
    desk.write(
        "still.csv",
        "x,y,normal_displacement\n0,0,0\n1,0,0\n0,1,0\n1,1,0\n2,0,0\n0,2,0\n",
    );
    for (arguments, term) in [
        ("estimate roll few.csv --probe-radius 10", "too-few-probes"),
        ("estimate roll back.csv --probe-radius 10", "not-rolling"),
        ("estimate glide line.csv", "collinear"),
        ("estimate press still.csv --sensor-radius 20", "no-contact"),
    ] {
        let said = desk.palpate(arguments).said(1);
        let line = said.trim_end().rsplit("; see `palpate ").next().unwrap();
        assert_eq!(line, format!("explain {term}`"), "{said}");
        desk.palpate(line.trim_end_matches('`')).prints(term);
    }
    // The message about an invalid setting is clear by itself, so it does not mention `palpate explain`.
    let said = desk
        .palpate("estimate press still.csv --sensor-radius 1e-320")
        .said(1);
    assert!(!said.contains("palpate explain"), "{said}");
}
