//! Labels of config fields.

use palpate_study::Label;

#[test]
fn labels_are_words_with_units() {
    let table = "\
        scene.object.radius_um: object radius (µm)
        scene.motion.rate_rad_per_s: rolling rate (rad/s)
        scene.motion.arc_length_cm: arc length (cm)
        scene.motion.angle_deg: roll angle (°)
        scene.object.c_per_cm: object c (1/cm)
        scene.noise.angular_velocity.fraction: angular velocity noise (%)
        scene.sensor: sensor
        scene.noise.position.fraction_of_ifd: position noise (% of the IFD)
        scene.noise.position.std_mm: position noise, std (mm)
        scene.noise.position.bound_mm: position noise (mm)
        scene.estimator.position_fraction_of_ifd: position noise that the estimator assumes (% of the IFD)
        scene.noise.normal.std_deg: normal noise, std (°)
        scene.motion.indentation_mm: indentation (mm)
        scene.motion.contact_deg.0: polar angle of the contact (°)
        scene.noise.normal_displacement.std_mm: normal displacement noise, std (mm)
        scene.noise.indentation.std_mm: indentation noise, std (mm)
        scene.noise.gain.std: gain error of a press, std (%)
        scene.noise.wrong_markers.count: wrong markers
        scene.probe.layout: marker layout
        scene.probe.layout.pitch_mm: marker pitch (mm)
        scene.probe.marker_depth_mm: marker depth (mm)
        scene.probe.radius_mm: probe radius (mm)
        scene.model: model
        scene.model.thickness_mm: layer thickness (mm)
        scene.estimator: estimator
        scene.estimator.indentation: estimator indentation
        scene.sensor.frames: frames averaged
        scene.sensor.kind: sensor
        scene.sensor.size_px: image size (px)
        scene.sensor.field_deg: half-angle of the field of view (°)
        scene.sensor.lens: lens
        scene.sensor.k3: odd term k3 of the lens
        scene.sensor.light_at_rim: light at the rim (% of the middle's)
        scene.sensor.blur_px: blur (px)
        scene.sensor.tangential: tangential readings
        scene.sensor.normal_from: normal displacement from
        scene.probe.discs.magenta_diameter_mm: diameter of the magenta discs (mm)
        scene.probe.discs.yellow_diameter_mm: diameter of the yellow discs (mm)
        scene.probe.discs.separation_mm: separation of the two discs (mm)
        scene.probe.discs.misalignment_mm: misalignment of the two discs (mm)
        scene.probe.layout.gores: gores
        scene.noise.pixel.std: pixel noise, std (levels of 255)
        scene.noise.hue.std: hue noise, std (turns)
        scene.noise.centroid.std: centroid noise, std (px)
        scene.noise.size.std: marker size noise, std (%)
        scene.noise.lost_markers.count: lost markers
        scene.motion.shift_mm: shift along the skin (mm)
        scene.view.polar_deg: polar angle of the marker (°)";
    for row in table.lines() {
        let (header, label) = row.trim().split_once(": ").unwrap();
        assert_eq!(Label::of_field(header).text(), label);
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
