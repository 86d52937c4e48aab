//! Tests labels of config fields, and labels of statistics with their units.

use palpate_study::label::{split_unit, spoken_unit};
use palpate_study::{Label, Statistic};

#[test]
fn labels_are_words_with_units() {
    let table = "\
        scene.object.radius_um: object radius (µm)
        scene.motion.rate_rad_per_s: rolling rate (rad/s)
        scene.motion.angle_deg: roll angle (°)
        scene.object.c_per_cm: object c (1/cm)
        scene.noise.angular_velocity.fraction: angular velocity noise (%)
        scene.sensor: sensor
        scene.noise.position.fraction_of_ifd: position noise (% of the IFD)
        scene.noise.position.std_mm: position noise, std (mm)
        scene.noise.position.bound_mm: position noise (mm)
        scene.estimator.position_fraction_of_ifd: position noise that the estimator assumes (% of the IFD)
        scene.noise.normal.std_deg: normal noise, std (°)
        scene.motion.contact_deg.0: polar angle of the contact (°)
        scene.noise.gain.std: gain error of a press, std (%)
        scene.sensor.frames: frames averaged
        scene.sensor.size_px: image size (px)
        scene.sensor.field_deg: half-angle of the field of view (°)
        scene.sensor.k3: odd term k3 of the lens
        scene.sensor.light_at_rim: light at the rim (% of the middle's)
        scene.sensor.blur_px: blur (px)
        scene.sensor.normal_from: normal displacement from
        scene.probe.discs.magenta_diameter_mm: diameter of the magenta discs (mm)
        scene.probe.discs.separation_mm: separation of the two discs (mm)
        scene.noise.pixel.std: pixel noise, std (levels of 255)
        scene.noise.hue.std: hue noise, std (turns)
        scene.noise.size.std: marker size noise, std (%)
        scene.view.polar_deg: polar angle of the marker (°)";
    for row in table.lines() {
        let (header, label) = row.trim().split_once(": ").unwrap();
        assert_eq!(Label::of_field(header).to_string(), label);
    }
    assert_eq!(
        Label::of_field("scene.noise.angular_velocity.fraction").value("0.07"),
        "7 %"
    );
    assert_eq!(
        Label::of_field("scene.noise.normal.std_deg").value("2.50"),
        "2.5°"
    );
}

#[test]
fn units_come_off_headers_and_are_written_for_readers() {
    for (stem, unit, written) in [
        ("scene.object.radius", "cm", "cm"),
        ("scene.motion.rate", "rad_per_s", "rad/s"),
        ("scene.motion.duration", "s", "s"),
        ("scene.object.m", "per_cm", "1/cm"),
        ("gaussian_curvature", "per_cm2", "1/cm²"),
    ] {
        let header = format!("{stem}_{unit}");
        assert_eq!(split_unit(&header), (stem, unit), "{header}");
        assert_eq!(spoken_unit(unit), written);
    }
    for bare in ["scene.object.s", "a.A", ""] {
        assert_eq!(split_unit(bare), (bare, ""));
    }
    for (unit, written) in [
        ("1/mm^2", "1/mm²"),
        ("turn", "turns"),
        ("turn_per_mm", "turns/mm"),
        ("px^2", "px²"),
        ("1", ""),
    ] {
        assert_eq!(spoken_unit(unit), written);
    }
}

#[test]
fn statistics_stand_in_the_order_of_the_columns() {
    for (place, statistic) in Statistic::ALL
        .into_iter()
        .chain([Statistic::StdBound])
        .enumerate()
    {
        assert_eq!(statistic as usize, place);
        assert_eq!(Statistic::named(statistic.name()), Some(statistic));
    }
    assert_eq!(Statistic::named("variance"), None);
}

#[test]
fn statistics_are_words_with_units() {
    let table = "\
        rms_error; gaussian_curvature; per_cm2; rms error of Gaussian curvature (1/cm²)
        relative_mean_abs_error; normal_curvature_u; 1/cm; mean |relative error| of normal curvature along u (%)
        mean; class; ; share classified correctly (%)
        std_bound; relative_curvature; 1/mm; Cramér–Rao bound on the std of relative curvature (1/mm)
        mean; r_squared; 1; mean estimate of R² of the fit
        mean; hue_change; turn; hue change (turns)
        mean; centroid_shift; px; centroid shift (px)
        mean; marker_area; px^2; image area of a marker (px²)
        mean; greatest_fold_strain; 1; greatest strain of folding (%)
        mean; rms_fold_strain; 1; rms strain of folding (%)
        mean; markers_tracked; 1; markers tracked
        mean; wrong_matches; 1; wrong matches
        mean; pixels; 1; pixels evaluated per press
        rms_error; normal_displacement; mm; rms error of normal displacement (mm)
        rms_error; tangential_displacement; mm; rms error of tangential displacement (mm)
        mean; greatest_fold_strain,rms_fold_strain; 1; strain of folding (%)
        mean; hue_change,marker_area; %; each quantity (%)";
    for row in table.lines() {
        let [name, quantities, unit, label] = row.split(';').map(str::trim).collect::<Vec<_>>()[..]
        else {
            panic!("{row}")
        };
        let quantities: Vec<&str> = quantities.split(',').collect();
        let statistic = Statistic::named(name).unwrap();
        assert_eq!(statistic.label(&quantities, unit).to_string(), label);
    }
    let strain = Statistic::Mean.label(&["rms_fold_strain"], "1");
    assert_eq!(strain.value("0.47"), "47 %");
}
