//! Tests estimates of the effective radius from load curves.

use palpate_press::Body;
use palpate_recorded::{LoadCurve, LoadOptions, RecordedFile, estimate_force};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::LengthUnit;
use serde_json::Value;

const OPTIONS: LoadOptions = LoadOptions {
    modulus_kpa: Some(500.0),
    modulus_std_kpa: None,
    poisson: 0.5,
    sensor_radius: Some(20.0),
    force_std_n: None,
    length_unit: None,
};

fn estimate(table: &str, options: &LoadOptions) -> Result<Value, String> {
    let file = RecordedFile::new("curve.csv", table.to_owned().into_bytes());
    let curve = LoadCurve::try_from(file).map_err(|error| error.to_string())?;
    let estimate = estimate_force(&curve, options).map_err(|error| error.to_string())?;
    Ok(serde_json::to_value(&estimate).unwrap())
}

/// A load curve as text, with indentations from 0.1 to 2 mm. `force` returns the force (N) at an indentation (mm).
fn table(force: impl Fn(f64) -> f64) -> String {
    let rows = (1..=20).map(|step| 0.1 * f64::from(step));
    let rows = rows.map(|indentation| format!("{indentation},{}\n", force(indentation)));
    format!("indentation_mm,force_N\n{}", rows.collect::<String>())
}

/// Force on a half-space with Young's modulus 500 kPa, N. The unit kPa mm² is equal to mN.
fn hertz(indentation: f64) -> f64 {
    let body = Body::half_space(0.5, 2.0).unwrap();
    let contact = body.press(1.0 / 16.0, indentation).unwrap();
    1e-3 * contact.force(500.0).unwrap()
}

fn number(json: &Value) -> f64 {
    json.as_f64().unwrap()
}

fn holds(value: &Value, truth: f64) -> bool {
    let [low, high] = [0, 1].map(|end| value["interval95"][end].as_f64());
    low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high)
}

#[test]
fn exact_forces_determine_the_radius() {
    let found = estimate(&table(hertz), &OPTIONS).unwrap();
    let close = |key: &str, truth: f64| {
        let value = number(&found[key]["value"]);
        assert!(
            (value - truth).abs() <= 1e-11 * truth,
            "{key}: {value} for {truth}"
        );
    };
    close("effective_radius", 16.0);
    close("stiffness", 500.0 / 0.75 * 4.0);
    close("exponent", 1.5);
    assert!((number(&found["object_curvature"]["value"]) - 1.0 / 80.0).abs() < 1e-12);
    assert_eq!(found["warnings"], Value::Array(Vec::new()));
    // Neither a copied row nor the indentation before touch may change the estimate.
    let far = table(hertz)
        + "0.1,x\n-900,0\n"
            .replace("x", &hertz(0.1).to_string())
            .as_str();
    let far = estimate(&far, &OPTIONS).unwrap();
    assert_eq!(far["readings"], 21);
    assert_eq!(far["warnings"][0]["code"], "repeated-rows");
    assert_eq!(far["warnings"].as_array().unwrap().len(), 1);
    // The same load curve, with indentations in m and forces in mN, must give the same curvature.
    let rows = (1..=20).map(|step| {
        let indentation = 0.1 * f64::from(step);
        format!("{},{}\n", 1e-3 * indentation, 1e3 * hertz(indentation))
    });
    let options = LoadOptions {
        sensor_radius: Some(0.02),
        ..OPTIONS
    };
    let table = format!("indentation_m,force_mN\n{}", rows.collect::<String>());
    let metres = estimate(&table, &options).unwrap();
    let radius = number(&metres["effective_radius"]["value"]);
    assert!((radius - 0.016).abs() < 1e-12, "{radius}");
    // Without Young's modulus, no radius is estimated.
    let options = LoadOptions {
        modulus_kpa: None,
        sensor_radius: None,
        ..OPTIONS
    };
    let found = estimate(&self::table(hertz), &options).unwrap();
    assert!(found["effective_radius"].is_null() && found["object_curvature"].is_null());
    assert!((number(&found["stiffness"]["value"]) - 8000.0 / 3.0).abs() < 1e-8);
    assert_eq!(found["stiffness"]["unit"], "kPa mm^0.5");
}

#[test]
fn intervals_hold_the_radius() {
    let (trials, mut held, mut warned) = (400, [0; 2], 0);
    for (index, force_std_n) in [None, Some(0.3)].into_iter().enumerate() {
        let options = LoadOptions {
            modulus_std_kpa: Some(100.0),
            force_std_n,
            ..OPTIONS
        };
        for trial in 0..trials {
            let mut stream = Stream::new(43, trial, Channel::NormalDisplacement);
            // In each trial, the true modulus is a random number around the stated one.
            let modulus = 1.0 + 0.2 * stream.standard_normal();
            let noise: Vec<f64> = (0..20).map(|_| 0.3 * stream.standard_normal()).collect();
            let noisy = |indentation: f64| {
                modulus * hertz(indentation) + noise[(10.0 * indentation).round() as usize - 1]
            };
            let found = estimate(&table(noisy), &options).unwrap();
            held[index] += u32::from(holds(&found["effective_radius"], 16.0));
            let warnings = found["warnings"].to_string();
            let codes = ["other-body", "poor-fit"];
            warned += usize::from(codes.iter().any(|code| warnings.contains(code)));
        }
    }
    // Of 400 intervals with a probability of 95 %, 380 ± 4.4 (one standard deviation) are expected to contain the true
    // value.
    for held in held {
        assert!((366..=394).contains(&held), "{held}");
    }
    assert!(warned <= 16, "{warned}");
}

#[test]
fn other_laws_have_warnings() {
    let code = |force: &dyn Fn(f64) -> f64, options: &LoadOptions| {
        let found = estimate(&table(force), options).unwrap();
        found["warnings"][0]["code"].as_str().map(str::to_owned)
    };
    let cubic = table(|indentation| indentation.powi(3));
    let exponent = number(&estimate(&cubic, &OPTIONS).unwrap()["exponent"]["value"]);
    assert!((exponent - 3.0).abs() < 1e-9, "{exponent}");
    // These two curves must cause warnings: the force of a flat punch, and the force of a contact that is too wide.
    let punch = |indentation: f64| 3.0 * indentation;
    assert_eq!(code(&punch, &OPTIONS).as_deref(), Some("other-body"));
    let stiff = LoadOptions {
        modulus_kpa: Some(1500.0),
        ..OPTIONS
    };
    assert_eq!(code(&hertz, &stiff).as_deref(), Some("large-contact"));
    let exact = LoadOptions {
        force_std_n: Some(1e-3),
        ..OPTIONS
    };
    let rough = |indentation: f64| hertz(indentation) + 0.05 * libm::sin(40.0 * indentation);
    let found = estimate(&table(rough), &exact).unwrap();
    assert!(
        found["warnings"].to_string().contains("poor-fit"),
        "{found}"
    );
}

#[test]
fn bad_curves_and_settings_have_errors() {
    let few = "indentation_mm,force_N\n1,1\n1,1\n2,3\n";
    let good = table(hertz);
    let tables = [
        (good.replace("2,", "2,x"), "curve.csv:3: column `force_N`: "),
        (good.replace("force_N", "load"), "curve.csv:1: "),
        (
            good.replace("_mm", ""),
            "curve.csv: the unit of the indentation is not stated",
        ),
        (
            few.to_owned(),
            "curve.csv: has 2 different indentations above 0; at least 3",
        ),
        (table(|_| 0.0), "curve.csv: the force does not increase"),
    ];
    for (table, message) in tables {
        let error = estimate(&table, &OPTIONS).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    for (modulus_kpa, poisson, message) in [
        (
            Some(-1.0),
            0.5,
            "setting `modulus_kpa` is -1; it must be finite and > 0",
        ),
        (
            Some(500.0),
            0.6,
            "setting `poisson` is 0.6; it must be from 0 to 0.5",
        ),
        (
            None,
            0.5,
            "setting `sensor_radius` has an effect only with setting `modulus_kpa`",
        ),
        (Some(1e-300), 0.5, "the numbers are too large or too small"),
    ] {
        let options = LoadOptions {
            modulus_kpa,
            poisson,
            ..OPTIONS
        };
        let error = estimate(&good, &options).unwrap_err();
        assert!(
            error.starts_with(&format!("curve.csv: {message}")),
            "{error}"
        );
    }
}

#[test]
fn extreme_numbers_are_estimates_or_errors() {
    let sizes = [1e-300, 1e-150, 1e-20, 1.0, 1e20, 1e150, 1e300];
    let mut estimates = 0;
    for (length, force) in sizes
        .iter()
        .flat_map(|one| sizes.iter().map(move |two| (one, two)))
    {
        let rows = [0.0, 1.0, 2.0, 3.0, -1.0]
            .map(|row: f64| format!("{:e},{:e}\n", row * length, row * row.abs().sqrt() * force));
        let options = LoadOptions {
            modulus_std_kpa: Some(1e3),
            length_unit: Some(LengthUnit::Mm),
            ..OPTIONS
        };
        let table = format!("indentation_mm,force_N\n{}", rows.concat());
        let Ok(found) = estimate(&table, &options) else {
            continue;
        };
        estimates += 1;
        // In the JSON output, a number that is not finite would be null.
        for key in [
            "stiffness",
            "exponent",
            "effective_radius",
            "object_curvature",
        ] {
            assert!(found[key]["value"].is_number(), "{length} {force} {found}");
        }
    }
    assert!(estimates >= 3, "{estimates}");
}
