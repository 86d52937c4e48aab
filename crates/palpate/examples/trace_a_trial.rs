//! Traces one trial of a roll on a saddle, and prints the last contacts and the readings of the sensor.
#![allow(clippy::print_stdout)]

use std::error::Error;

use palpate::{Values, columns};

const STUDY: &str = r#"
name = "a-saddle"
length_unit = "mm"

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "saddle", a = 0.01 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0, directions_deg = [0.0, 45.0, 90.0] }
sensor = { kind = "pads", pitch = 0.1, offset = "random" }
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let study = palpate::parse("a-saddle.toml", STUDY)?;
    let trial = Some(17);
    let trace = palpate::trace(&study, 0, trial)?;
    println!("{}", trace.what);
    let contacts = &trace.contacts;
    for (column, values) in columns(&contacts.to_csv(), &contacts.columns)? {
        if let Values::Numbers(numbers) = &values {
            println!("last {}: {:?}", column.name, numbers.last());
        }
    }
    print!("{}", trace.readings.to_csv());
    Ok(())
}
