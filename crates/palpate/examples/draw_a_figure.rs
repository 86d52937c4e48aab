//! Runs a study and draws its plot as SVG text, without writing a file.
#![allow(clippy::print_stdout)]

use std::error::Error;

use palpate::{Files, figure};

const STUDY: &str = r#"
name = "balls"
length_unit = "mm"
trials = 2000

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 20.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
sensor = { kind = "pads", pitch = 0.1, offset = "random" }

[[sweep]]
path = "scene.object.radius"
values = [20.0, 40.0, 80.0]

[[plot]]
name = "error-against-radius"
x = "scene.object.radius"
y = "relative_rms_error"
quantity = "normal_curvature_u"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let study = palpate::parse("balls.toml", STUDY)?;
    let ran = palpate::run(&study)?;
    let plot = study.config.plot.first().ok_or("no plot")?;
    let figure = figure(plot, Files::in_memory([("cells.csv", ran.cells.to_csv())]))?;
    println!("{}: {} bytes of SVG", figure.name, figure.svg.len());
    Ok(())
}
