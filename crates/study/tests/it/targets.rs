//! Tests the texts of targets: those that are read, and those that are rejected.

use palpate_study::Target;

#[test]
fn targets_read_back() {
    for text in [
        "relative_rms_error(mean_curvature) <= 0.05",
        "coverage95(object_curvature) >= 0.9",
        "bias >= -0.001",
        "q95(object_radius) <= 35",
    ] {
        assert_eq!(
            text.parse::<Target>().map(|target| target.to_string()),
            Ok(text.into())
        );
    }
    let short: Target = " rms_error ( gaussian_curvature )≤1e-3 ".parse().unwrap();
    assert_eq!(short.to_string(), "rms_error(gaussian_curvature) <= 0.001");
    let far: Target = "relative_rms_error <= 500 %".parse().unwrap();
    assert_eq!(far.limit, 5.0);
}

#[test]
fn what_is_no_target() {
    for (text, words) in [
        ("", "is not of the form STATISTIC(QUANTITY) <= LIMIT"),
        ("rms_error", "is not of the form STATISTIC"),
        ("rms_error() <= 5", "is not of the form STATISTIC"),
        ("rms_eror <= 5", "did you mean `rms_error`?"),
        ("rms_error(mean_curvatur) <= 5", "mean `mean_curvature`?"),
        ("rms_error(weather) <= 5", "known: normal_curvature_u"),
        ("failures <= 5", "--max-failures"),
        ("truth <= 5", "before any trial"),
        ("rms_error <= five", "\"five\" is not a finite number"),
        ("rms_error <= inf %", "\"inf %\" is not a finite number"),
        ("rms_error <= 0", "is above 0, and the limit is 0"),
        ("coverage95 >= 95", "95 % or 9500 %"),
        ("relative_rms_error <= 5", "write 5 % or 0.05"),
        ("mean(class) >= 90", "write 90 % or 0.9"),
        (
            "rms_error(mean_curvature) <= 5 %",
            "is not a share; write its limit without %",
        ),
        ("coverage95 >= 200 %", "at most 1, and the limit is 2"),
    ] {
        let error = text.parse::<Target>().expect_err(text).to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
}
