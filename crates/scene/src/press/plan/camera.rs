//! Plan of a press before a camera: the discs, the optics, and the calibration by presses on a plane.

use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, Lens, MarkerArray, MarkerMotion,
    Optics, OpticsError, Seams,
};
use palpate_number::Number;
use palpate_press::{Body, MarkerDisplacement, Markers, PressError};
use palpate_sensing::{GaussianError, InvalidSensor};
use palpate_tracking::{Equidistant, Marker};

use super::super::PressFailure;
use super::super::camera::{CameraSensor, Eye, Rung, SightError};
use super::super::seen::{CameraPress, Shows};
use super::calibrated::Calibrated;
use crate::plan::PlanError;
use palpate_study::config::{
    CameraConfig, CentroidNoise, DiscsConfig, HueNoise, LayoutConfig, LayoutTable, PixelNoise,
    PressConfig, PressModelConfig, PressNoiseConfig, PressProbeConfig, PressSensorConfig,
    SizeNoise,
};

/// The number of the trial whose errors the first frame at rest has; further ones count down from here.
pub(in crate::press) const AT_REST: u64 = u64::MAX;

/// A sensor of markers with discs, ready to be looked at.
pub(super) struct Planned<'a> {
    pub(super) config: &'a PressConfig,
    pub(super) camera: &'a CameraConfig,
    pub(super) seed: u64,
    pub(super) places: &'a [[f64; 2]],
    pub(super) markers: &'a Markers,
    /// Body that moves the markers, midway between their discs.
    pub(super) body: &'a Body,
}

/// Bodies that move the discs of the markers in a press.
pub(super) struct DiscBodies {
    /// Depth of each disc, and the body there.
    magenta: (f64, Body),
    yellow: (f64, Body),
}

/// Indentation and place of a press, with the curvature and the sideways shift of its object.
#[derive(Clone, Copy)]
pub(in crate::press) struct Pressed {
    pub(in crate::press) object_curvature: f64,
    pub(in crate::press) indentation: f64,
    pub(in crate::press) at: [f64; 2],
    pub(in crate::press) shift: f64,
}

/// Adds to displacements at a depth those by an object that sticks to the skin and moves sideways.
pub(in crate::press) fn shifted(
    model: &PressModelConfig,
    markers: &Markers,
    depth: f64,
    contact_radius: f64,
    pressed: &Pressed,
    moved: &mut [MarkerDisplacement],
) -> Result<(), PressError> {
    let (poisson, depth) = match model.reference() {
        PressModelConfig::HalfSpace { poisson } => (poisson, depth),
        PressModelConfig::Hertz { poisson } => (poisson, 0.0),
        PressModelConfig::BondedLayer { .. } | PressModelConfig::Auto { .. } => return Ok(()),
    };
    if pressed.shift == 0.0 {
        return Ok(());
    }
    let sideways = markers.shifted(poisson, depth, contact_radius, pressed.at, pressed.shift)?;
    for (moved, more) in moved.iter_mut().zip(sideways) {
        moved.normal += more.normal;
        moved.tangential = [0, 1].map(|axis| moved.tangential[axis] + more.tangential[axis]);
    }
    Ok(())
}

impl Planned<'_> {
    /// The press before the camera. The outer error is the config's; the inner one where there is no press.
    pub(super) fn press(
        &self,
        pressed: &Pressed,
    ) -> Result<Result<CameraPress, PressError>, PlanError> {
        let bodies = self.bodies()?;
        let eye = self.eye()?;
        let motions = match bodies.motions(self, pressed) {
            Ok(motions) => motions,
            Err(error) => return Ok(Err(error)),
        };
        let lost_markers = self.lost_markers()?;
        let rest = self
            .at_rest(&eye)
            .map_err(|error| PlanError::at("scene.sensor", error))?;
        if rest.iter().all(Option::is_none) {
            let message = "the camera sees no marker: see `scene.sensor.field_deg`";
            return Err(PlanError::at("scene.sensor", message));
        }
        let Calibrated { calibration, stds } = self.calibrated(&bodies, &eye, &rest)?;
        let under_contact = self.nearest(pressed.at).unwrap_or(0);
        let exact = self.exact(&eye, &motions, under_contact);
        let seen = rest.iter().flatten().count();
        Ok(Ok(CameraPress {
            shown: exact,
            seen: seen.saturating_sub(lost_markers),
            sensor: CameraSensor {
                eye,
                rest,
                calibration,
                stds,
            },
            motions,
            lost_markers,
            under_contact,
        }))
    }

    /// The markers at rest, the mean of several frames where these differ.
    fn at_rest(&self, eye: &Eye) -> Result<Vec<Option<Marker>>, PressFailure> {
        let frames = match eye.is_random {
            true => u64::from(self.camera.calibration.rest_frames),
            false => 1,
        };
        let first = eye.at_rest(Some(AT_REST))?;
        let mut means: Vec<Option<Mean>> = first.iter().map(|one| one.map(Mean::of)).collect();
        for frame in 1..frames {
            for (mean, marker) in means.iter_mut().zip(eye.at_rest(Some(AT_REST - frame))?) {
                if let (Some(mean), Some(marker)) = (mean, marker) {
                    mean.add(marker);
                }
            }
        }
        Ok(means
            .iter()
            .map(|mean| mean.as_ref().map(Mean::marker))
            .collect())
    }

    /// Picture of a marker without errors and pixels, as it changed in the press.
    fn exact(&self, eye: &Eye, motions: &[MarkerMotion], marker: usize) -> Option<Shows> {
        let none = GaussianError::new(0.0).ok()?;
        let exact = Eye {
            rung: Rung::Projected(SightError {
                hue: none,
                centroid: none,
                size: none,
            }),
            ..eye.clone()
        };
        let rest = exact.at_rest(None).ok()?;
        let motions: Vec<_> = motions.iter().copied().map(Some).collect();
        let sight = exact.sight(&rest, &motions, None).ok()?;
        Shows::of(&exact, &sight, marker)
    }

    /// The marker nearest to a place on the skin.
    pub(super) fn nearest(&self, place: [f64; 2]) -> Option<usize> {
        let distances = self.markers.distances(place);
        (0..distances.len()).min_by(|one, other| distances[*one].total_cmp(&distances[*other]))
    }

    fn lost_markers(&self) -> Result<usize, PlanError> {
        let lost = self.config.noise.lost_markers.as_ref();
        let count = lost.map_or(0, |lost| lost.count as usize);
        if count > self.places.len() {
            let message = format!(
                "must be at most the number of markers {}, is {count}",
                self.places.len()
            );
            return Err(PlanError::at("scene.noise.lost_markers.count", message));
        }
        Ok(count)
    }

    fn bodies(&self) -> Result<DiscBodies, PlanError> {
        let PressProbeConfig::MarkerSphere { radius, .. } = self.config.probe;
        let depths = disc_depths(&self.config.probe)?;
        let body = |depth: f64| super::body(self.config, radius, depth).map(|body| (depth, body));
        Ok(DiscBodies {
            magenta: body(depths.magenta)?,
            yellow: body(depths.yellow)?,
        })
    }

    fn eye(&self) -> Result<Eye, PlanError> {
        let noise = &self.config.noise;
        let error = |std: f64, key: &str| {
            GaussianError::new(std).map_err(|error: InvalidSensor| {
                PlanError::at(format!("scene.noise.{key}.std"), error)
            })
        };
        let frames = self.camera.frames;
        let pixel = noise
            .pixel
            .as_ref()
            .map_or(0.0, |PixelNoise::Gaussian { std }| *std);
        let camera = Camera::new(Lens::Fisheye, self.camera.size_px, self.camera.field_deg)
            .map_err(|error| of_optics(&error))?;
        let blemishes = Blemishes {
            light_at_rim: self.camera.light_at_rim,
            blur_px: self.camera.blur_px,
            seams: seams(self.camera, &self.config.probe),
            pixel_std: error(pixel, "pixel")?.averaged(frames).std(),
        };
        let array = array(&self.config.probe, self.places, self.seed)?;
        let optics = Optics::new(array, camera, Colours::default(), blemishes)
            .map_err(|error| of_optics(&error))?;
        let rung = match self.config.sensor {
            PressSensorConfig::Rendered(_) => Rung::Rendered,
            PressSensorConfig::Projected(_) | PressSensorConfig::Direct { .. } => {
                Rung::Projected(sight_error(noise, error)?.averaged(frames))
            }
        };
        let lens = Equidistant::new(camera.centre_px(), camera.px_per_rad())
            .map_err(|error| PlanError::at("scene.sensor", error))?;
        let is_random = match rung {
            Rung::Projected(error) => error.is_random(),
            Rung::Rendered => pixel > 0.0,
        };
        Ok(Eye {
            optics,
            lens,
            rung,
            is_random,
            seed: self.seed,
        })
    }
}

/// The mean of several sights of a marker.
struct Mean {
    first: Marker,
    count: f64,
    /// Sums of what others differ by: centroid, hue, size.
    sums: [f64; 4],
}

impl Mean {
    fn of(first: Marker) -> Self {
        Self {
            first,
            count: 1.0,
            sums: [0.0; 4],
        }
    }

    fn add(&mut self, marker: Marker) {
        let turn = marker.hue_turns - self.first.hue_turns;
        let differences = [
            marker.centroid_px[0] - self.first.centroid_px[0],
            marker.centroid_px[1] - self.first.centroid_px[1],
            turn - (turn + 0.5).floor(),
            marker.size_px2 - self.first.size_px2,
        ];
        for (sum, difference) in self.sums.iter_mut().zip(differences) {
            *sum += difference;
        }
        self.count += 1.0;
    }

    fn marker(&self) -> Marker {
        let [x, y, hue, size] = self.sums.map(|sum| sum / self.count);
        Marker {
            centroid_px: [self.first.centroid_px[0] + x, self.first.centroid_px[1] + y],
            hue_turns: (self.first.hue_turns + hue).rem_euclid(1.0),
            size_px2: self.first.size_px2 + size,
            ..self.first
        }
    }
}

impl SightError {
    fn averaged(self, frames: u32) -> Self {
        Self {
            hue: self.hue.averaged(frames),
            centroid: self.centroid.averaged(frames),
            size: self.size.averaged(frames),
        }
    }
}

impl DiscBodies {
    pub(super) fn motions(
        &self,
        planned: &Planned<'_>,
        pressed: &Pressed,
    ) -> Result<Vec<MarkerMotion>, PressError> {
        let markers = planned.markers;
        let of_disc = |(depth, body): &(f64, Body)| {
            let contact =
                markers
                    .skin()
                    .contact(body, pressed.object_curvature, pressed.indentation)?;
            let mut moved = markers.displacements(&contact, pressed.at);
            let model = &planned.config.model;
            shifted(model, markers, *depth, contact.radius, pressed, &mut moved)?;
            Ok::<_, PressError>(moved)
        };
        let (magenta, yellow) = (of_disc(&self.magenta)?, of_disc(&self.yellow)?);
        let motion = |moved: MarkerDisplacement| DiscMotion {
            normal: moved.normal,
            tangential: moved.tangential,
        };
        let pairs = magenta.into_iter().zip(yellow);
        Ok(pairs
            .map(|(magenta, yellow)| MarkerMotion {
                magenta: motion(magenta),
                yellow: motion(yellow),
            })
            .collect())
    }
}

fn sight_error(
    noise: &PressNoiseConfig,
    error: impl Fn(f64, &str) -> Result<GaussianError, PlanError>,
) -> Result<SightError, PlanError> {
    let hue = noise.hue.as_ref();
    let centroid = noise.centroid.as_ref();
    let size = noise.size.as_ref();
    Ok(SightError {
        hue: error(hue.map_or(0.0, |HueNoise::Gaussian { std }| *std), "hue")?,
        centroid: error(
            centroid.map_or(0.0, |CentroidNoise::Gaussian { std }| *std),
            "centroid",
        )?,
        size: error(size.map_or(0.0, |SizeNoise::Gaussian { std }| *std), "size")?,
    })
}

/// Seams run between the gores of the layout.
fn seams(camera: &CameraConfig, probe: &PressProbeConfig) -> Option<Seams> {
    let PressProbeConfig::MarkerSphere { layout, .. } = probe;
    let gores = match layout {
        LayoutConfig::Named(_) => 4,
        LayoutConfig::Table(LayoutTable::Gores { gores, .. }) => *gores,
        LayoutConfig::Table(_) => return None,
    };
    (camera.seam_width > 0.0).then_some(Seams {
        gores,
        width: camera.seam_width,
    })
}

/// The discs of a probe.
pub(crate) fn discs(probe: &PressProbeConfig) -> Result<&DiscsConfig, PlanError> {
    let PressProbeConfig::MarkerSphere { discs, .. } = probe;
    discs.as_ref().ok_or_else(|| {
        PlanError::at(
            "scene.probe",
            "`discs` is missing: the markers that a camera sees are made of two discs",
        )
    })
}

/// How deep each disc lies.
pub(crate) fn disc_depths(probe: &PressProbeConfig) -> Result<DiscDepths, PlanError> {
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = *probe;
    let half = 0.5 * discs(probe)?.separation;
    if half > marker_depth {
        let message = format!(
            "the yellow discs would lie {} above the skin: must be at most twice `scene.probe.marker_depth`, {}",
            Number(half - marker_depth),
            Number(2.0 * marker_depth)
        );
        return Err(PlanError::at("scene.probe.discs.separation", message));
    }
    Ok(DiscDepths {
        magenta: marker_depth + half,
        yellow: marker_depth - half,
    })
}

/// The markers of a probe at these places, as they were made.
fn array(
    probe: &PressProbeConfig,
    places: &[[f64; 2]],
    seed: u64,
) -> Result<MarkerArray, PlanError> {
    let PressProbeConfig::MarkerSphere { radius, .. } = *probe;
    let config = discs(probe)?;
    let diameters = Discs {
        magenta: config.magenta_diameter,
        yellow: config.yellow_diameter,
    };
    MarkerArray::new(radius, places, diameters, disc_depths(probe)?)
        .and_then(|array| match config.misalignment {
            0.0 => Ok(array),
            most => array.misaligned(most, seed),
        })
        .map_err(|error| of_optics(&error))
}

/// Error at the setting that is out of its range.
pub(crate) fn of_optics(error: &OpticsError) -> PlanError {
    let path = match error.setting() {
        Some(
            setting @ ("magenta_diameter" | "yellow_diameter" | "separation" | "misalignment"),
        ) => {
            format!("scene.probe.discs.{setting}")
        }
        Some("pixel_std") => "scene.noise.pixel.std".to_owned(),
        Some(setting) => format!("scene.sensor.{setting}"),
        None => "scene.probe.discs".to_owned(),
    };
    PlanError::at(path, error)
}
