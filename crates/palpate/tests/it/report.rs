//! Tests `palpate plot` and `palpate report`.

use super::desk::{Desk, RUN_FILES, SCENE, STUDY};

pub(crate) fn with_plot() -> String {
    format!(
        "claims = [1]\n{STUDY}\n[[plot]]\nname = \"error-against-radius\"\nx = \"scene.object.radius\"\n\
         y = \"rms_error\"\nquantity = \"normal_curvature_u\"\nscale = \"log-log\"\n"
    )
}

#[test]
fn plots_are_written_beside_the_tables() {
    let desk = Desk::with(&with_plot());
    desk.palpate("run c.toml --out o").printed();
    let printed = desk.palpate("plot o").printed();
    let [png, svg] = ["o/error-against-radius.png", "o/error-against-radius.svg"];
    let mut files: Vec<&str> = printed.lines().collect();
    files.sort_unstable();
    assert_eq!(files, [png, svg]);
    assert!(desk.read(svg).contains("</svg>"));
    assert!(
        std::fs::read(desk.path(png))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn a_study_without_sweeps_has_no_default_plot() {
    let desk = Desk::with(SCENE);
    desk.palpate("run c.toml --out o").printed();
    let printed = desk.palpate("plot o").printed();
    assert_eq!(
        printed,
        "a-study has no [[plot]] and no sweep, so there is nothing to plot\n"
    );
    assert_eq!(desk.names("o"), RUN_FILES);
}

#[test]
fn the_page_contains_all_studies() {
    let desk = Desk::with(&with_plot());
    desk.write("d.toml", STUDY.replace("a-study", "another-study"));
    desk.palpate("run c.toml --out c").printed();
    desk.palpate("run d.toml --out d").printed();
    let printed = desk.palpate("report c d --out page.html").printed();
    assert!(printed.ends_with("page -> page.html\n"), "{printed}");
    assert!(printed.lines().count() > 1, "no scorecard in {printed}");
    let page = desk.read("page.html");
    for part in ["a-study", "another-study", "<svg", "</html>"] {
        assert!(page.contains(part), "{part} is not on the page");
    }
    assert!(desk.names("c").contains(&"claims.csv".to_owned()));
}
