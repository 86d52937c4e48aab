//! Studies whose fields take other values than their configs say.

use super::study;

#[test]
fn errors_about_given_values_name_the_file_and_no_line_of_it() {
    let study = study("");
    for value in [-3.0, 0.0, f64::INFINITY] {
        let error = study
            .varied(&[(
                "scene.object.radius".to_owned(),
                vec![5.0.into(), value.into()],
            )])
            .expect_err("out of its limits")
            .to_string();
        assert!(error.starts_with("study.toml: "), "{error}");
        assert!(error.contains("scene.object.radius"), "{error}");
        assert!(!error.contains(" | "), "{error}");
    }
}
