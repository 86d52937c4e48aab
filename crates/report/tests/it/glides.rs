//! Makes small studies of glides: tables with invented errors, maps with given classes, and traces of a few contacts.

use crate::fixture::{self, NO_FAILURES, STATISTICS};
use palpate_report::Study;

/// Config of a glide over a saddle z = a (x² − y²), in units of the distance between fingers. `rest` is added to the
/// config.
pub(crate) fn config(a: f64, rest: &str) -> String {
    format!(
        "name = \"study\"\ntitle = \"A question?\"\n{rest}\n\
         [scene]\nkind = \"glide\"\nobject = {{ kind = \"saddle\", a = {a} }}\nmotion = {{ inter_finger_distance = 1.0 }}\n\
         [[sweep]]\npath = \"scene.object\"\nvalues = [{{ label = \"sphere\", kind = \"sphere\", radius = 5.0 }}, \
         {{ label = \"saddle\", kind = \"saddle\", a = {a} }}]\n"
    )
}

/// Invented errors of one estimator, on one surface and at one noise level.
#[derive(Clone, Copy)]
pub(crate) struct Made {
    pub(crate) gaussian: f64,
    pub(crate) mean: f64,
    pub(crate) share: f64,
    pub(crate) failures: u64,
}

pub(crate) const SURFACES: [&str; 4] = ["sphere", "cylinder", "turned cylinder", "saddle"];
pub(crate) const METHODS: [&str; 3] = ["first pass", "two-pass", "penalised"];

/// A study with all surfaces, methods and noise levels (0, 5 and 10 %). `made(surface, noise, method)` returns the
/// invented errors.
pub(crate) fn patches(claims: &str, made: impl Fn(&str, f64, &str) -> Made) -> Study {
    let mut text = format!(
        "cell,scene.object,scene.noise.position.fraction_of_ifd,scene.estimator,quantity,unit,{STATISTICS}\n"
    );
    let mut cell = 0;
    for surface in SURFACES {
        for noise in [0.0, 0.05, 0.1] {
            for method in METHODS {
                let Made {
                    gaussian,
                    mean,
                    share,
                    failures,
                } = made(surface, noise, method);
                let (true_gaussian, true_mean) = match surface {
                    // The true curvature of these surfaces varies over the patch, so the table contains no true value.
                    // Claims then use the shape of the object in the config.
                    "sphere" | "saddle" => ("", ""),
                    _ => ("0", "0.1"),
                };
                let label = method.replace("first pass", "first pass alone");
                let place = format!("{cell},{surface},{noise},{label}");
                for (quantity, unit, truth, rms, average) in [
                    (
                        "gaussian_curvature",
                        "1/unit^2",
                        true_gaussian,
                        gaussian.to_string(),
                        String::new(),
                    ),
                    (
                        "mean_curvature",
                        "1/unit",
                        true_mean,
                        mean.to_string(),
                        String::new(),
                    ),
                    ("class", "1", "", String::new(), share.to_string()),
                ] {
                    text += &format!(
                        "{place},{quantity},{unit},{truth},200,{failures},{average},,,{rms},,,,,,,,,,,\n"
                    );
                }
                cell += 1;
            }
        }
    }
    study(&config(0.1, &format!("claims = {claims}")), &text, &[])
}

pub(crate) fn study(config: &str, cells: &str, others: &[(&str, &str)]) -> Study {
    fixture::study(config, cells, NO_FAILURES, others)
}

/// Text of `cells.csv` with one row of the quantity `class` per cell. `axes` are the headers of the swept fields, and
/// `places` the swept values of each cell.
pub(crate) fn cells(axes: &str, places: &[&str]) -> String {
    let mut text = format!("cell,{axes},quantity,unit,{STATISTICS}\n");
    for (cell, place) in places.iter().enumerate() {
        text += &format!("{cell},{place},class,1,,1,0,1,,,,,,,,,,,,,,\n");
    }
    text
}

/// Text of `map.csv` for the cells 0, 1, … on a square grid from −0.5 in steps of 0.5. Each letter is the class at a
/// point: r is ridge, p is peak, s is saddle ridge, and a space is no class. The points are sorted by x, then by y.
pub(crate) fn map(cells: &[(&str, &str)]) -> String {
    let name = |letter: char| match letter {
        'r' => "ridge",
        'p' => "peak",
        's' => "saddle-ridge",
        ' ' => "",
        other => panic!("{other}"),
    };
    let mut text = "cell,x_mm,y_mm,z_mm,class,true_class,region\n".to_owned();
    for (cell, (estimated, truth)) in cells.iter().enumerate() {
        let side = estimated.len().isqrt();
        for (at, (found, truth)) in estimated.chars().zip(truth.chars()).enumerate() {
            let place = |k: usize| 0.5 * k as f64 - 0.5;
            let (x, y) = (place(at / side), place(at % side));
            text += &format!("{cell},{x},{y},0,{},{},0\n", name(found), name(truth));
        }
    }
    text
}
