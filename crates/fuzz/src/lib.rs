//! Fuzz targets for the readers of files: configs, formulas, readings, frames and calibrations.
//!
//! Each target takes arbitrary bytes as the contents of a file and panics where a reader breaks its promise. A reader
//! must return a result or an error with a message. A result must hold no number that is NaN or infinite, and what is
//! written from it must read back the same. `corpus/` holds inputs that reach different parts of the code, found by
//! coverage; the tests replay them and variations of them.

use std::collections::BTreeMap;
use std::fmt::Debug;

use palpate_geometry::formula::Formula;
use palpate_scene::recorded::{
    self, CalibrateOptions, GlideOptions, PressOptions, RecordedError, RecordedFile, RollOptions,
};
use palpate_study::config::{self, GlideEstimatorConfig, PressEstimatorConfig};
use palpate_tracking::{Finder, FinderSettings};

/// A reader under test.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the reader, also of the folder of its corpus.
    pub name: &'static str,
    /// Function that feeds bytes to the reader; it panics where the reader breaks its promise.
    pub run: fn(&[u8]),
}

/// All readers.
pub const TARGETS: [Target; 5] = [
    Target {
        name: "config",
        run: config,
    },
    Target {
        name: "formula",
        run: formula,
    },
    Target {
        name: "readings",
        run: readings,
    },
    Target {
        name: "frame",
        run: frame,
    },
    Target {
        name: "calibration",
        run: calibration,
    },
];

/// Lines of a file beyond which no estimate of a glide or press is made, to keep a target quick.
const MOST_ROWS: usize = 60;
/// Pixels of a frame beyond which no markers are sought in it.
const MOST_PIXELS: u32 = 200 * 200;

/// Reads a study's config.
///
/// # Panics
/// If a resolved config is not read back the same, or an error says nothing.
pub fn config(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match config::parse("fuzz.toml", text) {
        Err(error) => says_something(&error.to_string()),
        Ok(study) => {
            let written = config::to_toml(&study.config);
            let again = config::parse("run.toml", &written);
            let again = again.unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
            assert_eq!(config::to_toml(&again.config), written);
            assert_eq!(again.cells.len(), study.cells.len());
            assert!(again.cells.first() == study.cells.first(), "{written}");
        }
    }
}

/// Parses and evaluates the formula of a height field.
///
/// # Panics
/// If value and jet differ, or an error says nothing.
pub fn formula(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let parameters = BTreeMap::from([("A".to_owned(), 0.15), ("k".to_owned(), 0.7)]);
    let none = BTreeMap::new();
    for parameters in [&parameters, &none] {
        match Formula::parse(text, parameters) {
            Err(error) => {
                says_something(&error.kind.to_string());
                if let Some(span) = error.span {
                    assert!(text.get(span.clone()).is_some(), "{span:?} of {text:?}");
                }
            }
            Ok(formula) => {
                for [x, y] in [[0.0, 0.0], [0.3, -0.7], [-1e9, 1e-9]] {
                    let (value, jet) = (formula.value(x, y), formula.jet(x, y));
                    let same = value.to_bits() == jet.value.to_bits()
                        || value.is_nan() && jet.value.is_nan();
                    assert!(same, "{value} is not {} at {x}, {y}", jet.value);
                }
            }
        }
    }
}

/// Reads recorded readings of rolls, glides and presses, and estimates from them.
///
/// # Panics
/// If an estimate is not finite, or an error says nothing.
pub fn readings(bytes: &[u8]) {
    let file = || RecordedFile::new("fuzz.csv", bytes.to_vec());
    let is_short = bytes.iter().filter(|&&byte| byte == b'\n').count() <= MOST_ROWS;
    if let Some(readings) = whole(recorded::parse_roll(file())) {
        whole(recorded::estimate_roll(&readings, &RollOptions::new(1.0)));
    }
    if let Some(readings) = whole(recorded::parse_glide(file())).filter(|_| is_short) {
        let options = GlideOptions {
            estimator: GlideEstimatorConfig::Quadric {
                position_std: None,
                normal_std_deg: None,
            },
            grid: 3,
            ..GlideOptions::default()
        };
        whole(recorded::estimate_glide(&readings, &options));
    }
    if let Some(readings) = whole(recorded::parse_press(file())).filter(|_| is_short) {
        let mut options = PressOptions {
            marker_depth: 2.0,
            indentation: Some(1.0),
            normal_std: Some(0.05),
            tangential_std: Some(0.02),
            ..PressOptions::new(20.0)
        };
        if let PressEstimatorConfig::HalfSpace {
            indentation_std, ..
        } = &mut options.estimator
        {
            *indentation_std = 0.02;
        }
        whole(recorded::estimate_press(&readings, &options));
    }
}

/// Reads a frame of a camera and finds the markers in it.
///
/// # Panics
/// If a marker is not finite, or an error says nothing.
pub fn frame(bytes: &[u8]) {
    let file = RecordedFile::new("fuzz.png", bytes.to_vec());
    let frame = match recorded::parse_frame(&file) {
        Ok(frame) => frame,
        Err(error) => return says_something(&error.to_string()),
    };
    if frame.image.width().saturating_mul(frame.image.height()) > MOST_PIXELS {
        return;
    }
    let finder = Finder::new(FinderSettings::default());
    let mut finder = finder.expect("the default settings are good");
    match finder.find(&frame.image) {
        Ok(found) => is_finite(&found),
        Err(error) => says_something(&error.to_string()),
    }
}

/// Reads a calibration, and points to make one from.
///
/// # Panics
/// If a calibration is not read back the same, is not finite, or an error says nothing.
pub fn calibration(bytes: &[u8]) {
    let file = || RecordedFile::new("fuzz", bytes.to_vec());
    let points = whole(recorded::parse_calibration_points(&file()));
    if let Some(points) = points {
        whole(recorded::calibrate(&[points], &CalibrateOptions::default()));
    }
    if let Some((calibration, unit)) = whole(recorded::parse_calibration(&file())) {
        let written = recorded::calibration_toml(&calibration, unit);
        let again = RecordedFile::new("again.toml", written.clone().into_bytes());
        let (again, unit) = recorded::parse_calibration(&again)
            .unwrap_or_else(|error| panic!("{error}\nof\n{written}"));
        assert_eq!(recorded::calibration_toml(&again, unit), written);
    }
}

/// Value that was read, after a check that all of its numbers are finite; `None` where the reader refused with a
/// message.
fn whole<T: Debug>(read: Result<T, RecordedError>) -> Option<T> {
    match read {
        Ok(whole) => {
            is_finite(&whole);
            Some(whole)
        }
        Err(error) => {
            says_something(&error.to_string());
            None
        }
    }
}

fn is_finite(what: &impl Debug) {
    let text = format!("{what:?}");
    let words = |c: char| !c.is_alphanumeric();
    let odd = text
        .split(words)
        .find(|&word| word == "NaN" || word == "inf");
    assert!(odd.is_none(), "{odd:?} in {text}");
}

fn says_something(error: &str) {
    assert!(error.trim().len() > 10, "{error:?}");
}
