//! Scenes on which the answers of `design` and `distinguish` are checked.

/// A question for `design`, with a target and a varied field. It also states the largest allowed gap between a value
/// that meets the target and a value that misses it. With a larger gap, wrong answers would not be detected; with a
/// smaller gap, the check would need too many trials.
#[derive(Debug)]
pub(crate) struct Design {
    pub(crate) name: &'static str,
    pub(crate) config: &'static str,
    pub(crate) target: &'static str,
    pub(crate) vary: &'static str,
    pub(crate) gap: f64,
}

/// A scene with balls or cylinders of several radii, which `distinguish` must distinguish.
#[derive(Debug)]
pub(crate) struct Objects {
    pub(crate) name: &'static str,
    pub(crate) config: &'static str,
    pub(crate) radii: &'static [f64],
    pub(crate) trials: u64,
    pub(crate) quantity: &'static str,
}

/// Config of rolls with a probe of radius 10 mm. The macro's arguments are the object, and the sensor or its noise.
macro_rules! roll {
    ($object:literal, $rest:literal) => {
        concat!(
            "name = \"scene\"\nlength_unit = \"mm\"\n[scene]\nkind = \"roll\"\n",
            "probe = { kind = \"sphere\", radius = 10.0 }\n",
            "motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }\n",
            "object = ",
            $object,
            "\n",
            $rest,
            "\n"
        )
    };
}

/// Config of glides with three fingers that touch the object at five points each. The macro's arguments are the object
/// and the noise of the positions.
macro_rules! glide {
    ($object:literal, $noise:literal) => {
        concat!(
            "name = \"scene\"\nlength_unit = \"mm\"\n[scene]\nkind = \"glide\"\nprobe = { kind = \"point\" }\n",
            "motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, ",
            "patch_length = 30.0, contacts_per_finger = 5 }\n",
            "evaluate = { grid = 3, half_width = 10.0, gaussian_threshold = 0.0001, mean_threshold = 0.004 }\n",
            "object = ",
            $object,
            "\nnoise = { position = ",
            $noise,
            " }\n"
        )
    };
}

const PADS: &str = roll!(
    r#"{ kind = "sphere", radius = 30.0 }"#,
    r#"sensor = { kind = "pads", pitch = 1.0, layout = "uniform", offset = "random" }"#
);
const WRIST: &str = roll!(
    r#"{ kind = "sphere", radius = 30.0 }"#,
    r#"sensor = { kind = "wrist", std = 0.54 }"#
);
const RATES: &str = roll!(
    r#"{ kind = "sphere", radius = 30.0 }"#,
    r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }"#
);
const NOISY_RATES: &str = roll!(
    r#"{ kind = "sphere", radius = 30.0 }"#,
    r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.2 } }"#
);
const CYLINDER: &str = roll!(
    r#"{ kind = "cylinder", radius = 20.0, direction_deg = 30.0 }"#,
    r#"noise = { angular_velocity = { kind = "gaussian", fraction = 0.1 } }"#
);
const GLIDE: &str = glide!(
    r#"{ kind = "cylinder", radius = 40.0, direction_deg = 30.0 }"#,
    r#"{ kind = "gaussian", fraction_of_ifd = 0.02 }"#
);
const NOISY_GLIDE: &str = glide!(
    r#"{ kind = "sphere", radius = 30.0 }"#,
    r#"{ kind = "gaussian", fraction_of_ifd = 0.5 }"#
);
const PRESS: &str = r#"name = "scene"
length_unit = "mm"
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, layout = { kind = "lattice", pitch = 6.0, cap_deg = 50.0 } }
object = { kind = "sphere", radius = 30.0 }
motion = { indentation = 1.5 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.05 }, indentation = { kind = "gaussian", std = 0.05 } }
estimator = { kind = "half-space", indentation = "known", indentation_std = 0.05 }
"#;
const FINGERTIP: &str = r#"name = "scene"
length_unit = "mm"
[scene]
kind = "fingertip"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, layout = { kind = "lattice", pitch = 4.0, cap_deg = 65.0 }, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
sensor = { lens = "fisheye", size_px = 640, field_deg = 65.0 }
view = { polar_deg = 0.0 }
"#;

pub(crate) const DESIGNS: &[Design] = &[
    Design {
        name: "roll: pads",
        config: PADS,
        target: "relative_rms_error(mean_curvature) <= 5 %",
        vary: "scene.sensor.pitch=0.05..2",
        gap: 0.3,
    },
    Design {
        name: "roll: wrist sensor",
        config: WRIST,
        target: "relative_rms_error(mean_curvature) <= 10 %",
        vary: "scene.sensor.std=0.01..1",
        gap: 0.2,
    },
    Design {
        name: "roll: largest ball",
        config: RATES,
        target: "relative_rms_error(mean_curvature) <= 2 %",
        vary: "scene.object.radius=5..200",
        gap: 0.1,
    },
    Design {
        name: "roll: noise on a cylinder",
        config: CYLINDER,
        target: "rms_error(normal_curvature_u) <= 0.002",
        vary: "scene.noise.angular_velocity.fraction=0.001..0.2",
        gap: 0.1,
    },
    Design {
        name: "glide: noise of positions",
        config: GLIDE,
        target: "rms_error(mean_curvature) <= 0.0005",
        vary: "scene.noise.position.fraction_of_ifd=0.01..0.5",
        gap: 0.5,
    },
    Design {
        name: "glide: share of classes",
        config: GLIDE,
        target: "mean(class) >= 95 %",
        vary: "scene.noise.position.fraction_of_ifd=0.1..2",
        gap: 0.8,
    },
    Design {
        name: "press: largest ball",
        config: PRESS,
        target: "relative_rms_error(object_curvature) <= 25 %",
        vary: "scene.object.radius=10..100",
        gap: 1.0,
    },
    Design {
        name: "press: least indentation",
        config: PRESS,
        target: "relative_rms_error(object_curvature) <= 15 %",
        vary: "scene.motion.indentation=1..4",
        gap: 0.8,
    },
    Design {
        name: "press: honest intervals",
        config: PRESS,
        target: "coverage95(object_curvature) >= 0.85",
        vary: "scene.estimator.indentation_std=0.005..0.2",
        gap: 1.0,
    },
    Design {
        name: "fingertip: size of a marker",
        config: FINGERTIP,
        target: "mean(marker_area) >= 900",
        vary: "scene.view.polar_deg=0..60",
        gap: 0.05,
    },
];

/// Scenes for the check of `distinguish`. In each scene, every pair of radii is checked. Together, the scenes have
/// twenty pairs.
pub(crate) const OBJECTS: &[Objects] = &[
    Objects {
        name: "roll: balls by noisy rates",
        config: NOISY_RATES,
        radii: &[30.0, 33.0, 40.0, 60.0],
        trials: 1000,
        quantity: "mean_curvature",
    },
    Objects {
        name: "roll: balls by pads",
        config: PADS,
        radii: &[30.0, 33.0, 40.0, 60.0],
        trials: 1000,
        quantity: "mean_curvature",
    },
    Objects {
        name: "roll: balls by the wrist",
        config: WRIST,
        radii: &[25.0, 50.0],
        trials: 1000,
        quantity: "mean_curvature",
    },
    Objects {
        name: "roll: cylinders by noisy rates",
        config: CYLINDER,
        radii: &[20.0, 30.0],
        trials: 1000,
        quantity: "normal_curvature_u",
    },
    Objects {
        name: "glide: balls",
        config: NOISY_GLIDE,
        radii: &[40.0, 45.0, 60.0],
        trials: 2000,
        quantity: "mean_curvature",
    },
    Objects {
        name: "press: balls",
        config: PRESS,
        radii: &[30.0, 35.0, 50.0],
        trials: 1000,
        quantity: "object_curvature",
    },
];
