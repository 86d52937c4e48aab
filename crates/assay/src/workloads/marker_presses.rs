//! Workloads with presses of the published sensor, which has 77 markers at a depth of 2 mm under a skin of radius 20
//! mm.

use std::hint::black_box;

use anyhow::Result;
use palpate_chromatouch::Layout;
use palpate_press::{Body, ForwardFit, MarkerDisplacement, Markers, Measured, Reading, Skin};
use palpate_sensing::{Channel, Stream};

use crate::timing::Evaluation;

/// Radius of the skin, mm.
pub const SKIN: f64 = 20.0;
/// Position (mm) of the contact relative to the middle marker.
pub const AT: [f64; 2] = [1.5, 1.0];
/// Curvature of the object, 1/mm.
pub const OBJECT: f64 = 1.0 / 80.0;
/// Indentation of the presses, mm.
pub const INDENTATION: f64 = 1.0;
const NORMAL_STD: f64 = 0.07;
const TANGENTIAL_STD: f64 = 0.05;

/// The markers of the published sensor.
///
/// # Errors
/// An error if the layout is invalid.
pub fn markers() -> Result<Markers> {
    let places = Layout::published().places(SKIN)?;
    Ok(Markers::new(Skin::new(SKIN)?, &places)?)
}

/// Simulated readings of the markers in one trial of a press, with Gaussian errors.
pub struct MarkerReadings {
    /// Inward displacement of each marker, mm.
    pub normal: Vec<f64>,
    /// Displacement of each marker along the skin, mm.
    pub tangential: Vec<[f64; 2]>,
}

impl MarkerReadings {
    /// Creates readings: the displacements `moved` plus random errors, which differ from trial to trial.
    pub fn new(moved: &[MarkerDisplacement], trial: u64) -> Self {
        let mut noise = Stream::new(1, trial, Channel::Position);
        let mut off = |value: f64, std: f64| value + std * noise.standard_normal();
        Self {
            normal: moved
                .iter()
                .map(|one| off(one.normal, NORMAL_STD))
                .collect(),
            tangential: moved
                .iter()
                .map(|one| one.tangential.map(|along| off(along, TANGENTIAL_STD)))
                .collect(),
        }
    }

    /// The readings in the form that an estimator needs, with an indentation whose standard deviation is 0.02 mm.
    pub fn reading<'a>(&'a self, markers: &'a Markers) -> Reading<'a> {
        Reading {
            markers,
            normal: &self.normal,
            tangential: Some(&self.tangential),
            indentation: Some(Measured {
                value: INDENTATION,
                std: 0.02,
            }),
        }
    }
}

/// The estimator for presses on this body. It uses the standard deviations of the simulated readings.
pub fn fit(body: Body) -> ForwardFit {
    ForwardFit {
        normal_std: Some(NORMAL_STD),
        tangential_std: Some(TANGENTIAL_STD),
        ..ForwardFit::new(body)
    }
}

/// The workload that computes the displacements of 77 markers in a press on this body.
///
/// # Errors
/// An error if the press is impossible.
pub fn displacements(name: &str, body: Body) -> Result<Evaluation> {
    let markers = markers()?;
    markers.skin().contact(&body, OBJECT, INDENTATION)?;
    Ok(Evaluation::new(name, move || {
        let contact = markers
            .skin()
            .contact(&body, OBJECT, black_box(INDENTATION));
        contact.map(|contact| markers.displacements(&contact, AT))
    }))
}

/// The workload that fits a press on this body to the readings of 77 markers.
///
/// # Errors
/// An error if the press is impossible.
pub fn fit_workload(name: &str, body: Body) -> Result<Evaluation> {
    let markers = markers()?;
    let contact = markers.skin().contact(&body, OBJECT, INDENTATION)?;
    let readings = MarkerReadings::new(&markers.displacements(&contact, AT), 1);
    drop(contact);
    let fit = fit(body);
    fit.estimate(&readings.reading(&markers))?;
    Ok(Evaluation::new(name, move || {
        fit.estimate(black_box(&readings.reading(&markers)))
    }))
}
