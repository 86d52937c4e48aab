//! Families of random presses with a camera.

use palpate_sensing::Channel;

use super::Draws;

/// Curvature of the sensor, per mm.
const SENSOR_CURVATURE: f64 = 1.0 / 20.0;
/// Smallest and largest relative curvature, per mm: those of a dish of 60 mm and of a ball of 5 mm.
const CURVATURES: [f64; 2] = [SENSOR_CURVATURE - 1.0 / 60.0, SENSOR_CURVATURE + 1.0 / 5.0];
/// Smallest and largest values of the other parameters, in the units of the config.
const SIZES: [f64; 2] = [400.0, 1025.0];
const NOISES: [f64; 2] = [1.0, 5.0];
const INDENTATIONS: [f64; 2] = [0.6, 1.4];
const POLAR_ANGLES: [f64; 2] = [0.0, 20.0];
const MISALIGNMENTS: [f64; 2] = [0.0, 0.3];
const THICKNESSES: [f64; 2] = [4.0, 10.0];
/// Largest distance of a trial's contact from that of the scene, along either axis, degrees.
const JITTER: f64 = 1.0;
/// Standard deviation of a stated indentation, mm.
const INDENTATION_STD: f64 = 0.01;

/// Presses of one kind.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Family {
    /// Layers; the fit assumes layers.
    Sound,
    /// Layers of sensors that are stated half as accurately, but calibrated by simulated presses on a plane.
    Calibrated,
    /// Layers; the fit assumes half-spaces.
    LayerForHalfSpace,
    /// Half-spaces; the fit assumes layers.
    HalfSpaceForLayer,
}

impl Family {
    /// All families.
    pub(super) const ALL: [Self; 4] = [
        Self::Sound,
        Self::Calibrated,
        Self::LayerForHalfSpace,
        Self::HalfSpaceForLayer,
    ];

    /// Name of the family in the table.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sound => "layers",
            Self::Calibrated => "layers by calibrated sensors",
            Self::LayerForHalfSpace => "layers taken for half-spaces",
            Self::HalfSpaceForLayer => "half-spaces taken for layers",
        }
    }

    /// Whether the fit assumes the wrong body.
    pub(super) const fn is_wrong(self) -> bool {
        matches!(self, Self::LayerForHalfSpace | Self::HalfSpaceForLayer)
    }

    /// Number of trials of each scene, at most `requested`. Few trials show whether a wrong model gets a warning, and a
    /// calibration in every trial takes long.
    pub(super) fn trials(self, requested: u64) -> u64 {
        match self {
            Self::Sound => requested,
            Self::Calibrated => requested.div_ceil(3),
            Self::LayerForHalfSpace | Self::HalfSpaceForLayer => requested.div_ceil(10),
        }
    }

    /// Stated accuracy of the sensor without its frame at rest and without calibration presses, as in a config.
    const fn sensor(self) -> &'static str {
        match self {
            Self::Calibrated => {
                "{ centre_px = 0.29, scale = 0.004, place = 0.1, turn_deg = 0.6, disc_depth = 0.03, disc_diameter = 0.02, colour = 0.02 }"
            }
            _ => {
                "{ centre_px = 0.29, scale = 0.002, place = 0.05, turn_deg = 0.3, disc_depth = 0.03, disc_diameter = 0.01, colour = 0.01 }"
            }
        }
    }

    /// The true body and the body that the fit assumes, as in a config.
    fn bodies(self, thickness: f64) -> [String; 2] {
        let half_space = r#"{ kind = "half-space" }"#.to_owned();
        let layer = format!(r#"{{ kind = "bonded-layer", thickness = {thickness} }}"#);
        match self {
            Self::Sound | Self::Calibrated => [layer, String::new()],
            Self::LayerForHalfSpace => [layer, ", poisson = 0.5".to_owned()],
            Self::HalfSpaceForLayer => [half_space, format!(", thickness = {thickness}")],
        }
    }
}

/// A press with a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    pub(super) family: Family,
    pub(super) number: u64,
    /// Relative curvature, per mm.
    relative_curvature: f64,
    pub(super) indentation: f64,
    /// Whether the indentation is fitted instead of stated.
    pub(super) fits_indentation: bool,
    pub(super) polar_deg: f64,
    azimuth_deg: f64,
    pub(super) misalignment: f64,
    pub(super) thickness: f64,
    pub(super) size_px: u32,
    pub(super) pixel_std: f64,
}

impl Case {
    /// The case of a family with this number. Cases with the same number differ only in their bodies and sensors.
    pub(super) fn random(family: Family, seed: u64, number: u64) -> Self {
        let mut draws = Draws::new(seed, number, Channel::PadOffset);
        Self {
            family,
            number,
            relative_curvature: draws.log_between(CURVATURES),
            indentation: draws.between(INDENTATIONS),
            fits_indentation: number % 2 == 1,
            polar_deg: draws.between(POLAR_ANGLES),
            azimuth_deg: draws.between([0.0, 360.0]),
            misalignment: draws.between(MISALIGNMENTS),
            thickness: draws.between(THICKNESSES),
            size_px: draws.between(SIZES) as u32,
            pixel_std: draws.between(NOISES),
        }
    }

    /// Curvature of the object, per mm.
    pub(super) fn curvature(&self) -> f64 {
        self.relative_curvature - SENSOR_CURVATURE
    }

    /// Name of the case, by which options select it.
    pub(super) fn name(&self) -> String {
        let indentation = indentation_source(self.fits_indentation);
        format!(
            "{}, {}, indentation {indentation}",
            self.family.name(),
            self.number
        )
    }

    /// Name of the family in the coverage table.
    #[cfg(test)]
    pub(super) fn coverage_family(&self) -> String {
        coverage_family(self.fits_indentation)
    }

    /// Config of the case, with the contact of a block of trials.
    pub(super) fn config(&self, seed: u64, block: u64) -> String {
        let Self {
            number,
            indentation,
            thickness,
            misalignment,
            size_px,
            pixel_std,
            ..
        } = *self;
        let curvature = self.curvature();
        let kind = if curvature < 0.0 { "dish" } else { "sphere" };
        let radius = curvature.abs().recip();
        let source = indentation_source(self.fits_indentation);
        let std = if self.fits_indentation {
            0.0
        } else {
            INDENTATION_STD
        };
        let [polar, azimuth] = self.contact(seed, block);
        let sensor = self.family.sensor();
        let [model, assumed] = self.family.bodies(thickness);
        let seed = seed.wrapping_mul(1000).wrapping_add(number);
        format!(
            r#"
            name = "camera"
            length_unit = "mm"
            seed = {seed}
            [scene]
            kind = "press"
            object = {{ kind = "{kind}", radius = {radius} }}
            motion = {{ indentation = {indentation}, contact_deg = [{polar}, {azimuth}] }}
            model = {model}
            sensor = {{ kind = "rendered", size_px = {size_px}, calibration = {{ rest_frames = 1, presses = 2 }} }}
            estimator = {{ kind = "image", indentation = "{source}", indentation_std = {std}{assumed} }}
            [scene.probe]
            kind = "marker-sphere"
            radius = 20.0
            marker_depth = 2.0
            discs = {{ magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0, misalignment = {misalignment} }}
            [scene.noise]
            pixel = {{ kind = "gaussian", std = {pixel_std} }}
            indentation = {{ kind = "gaussian", std = {INDENTATION_STD} }}
            sensor = {sensor}
            "#
        )
    }

    /// Polar angle and azimuth of the contact in a block of trials, degrees.
    fn contact(&self, seed: u64, block: u64) -> [f64; 2] {
        let scene = seed.wrapping_add(self.number);
        let mut draws = Draws::new(scene, block, Channel::Position);
        let (sine, cosine) = libm::sincos(self.azimuth_deg.to_radians());
        let [x, y] =
            [cosine, sine].map(|along| self.polar_deg * along + draws.between([-JITTER, JITTER]));
        let azimuth = libm::atan2(y, x).to_degrees();
        [libm::hypot(x, y), azimuth]
    }
}

/// Source of the indentation, as in a config.
const fn indentation_source(is_fitted: bool) -> &'static str {
    if is_fitted { "fitted" } else { "known" }
}

/// Name of the sound family in the coverage table.
pub(super) fn coverage_family(fits_indentation: bool) -> String {
    let indentation = indentation_source(fits_indentation);
    format!("pictures of layers, indentation {indentation}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_of_the_family() {
        for number in 0..50 {
            let family = Family::ALL[number as usize % Family::ALL.len()];
            let case = Case::random(family, 7, number);
            assert!((-1.0 / 60.0..=0.2).contains(&case.curvature()), "{case:?}");
            assert!((400..=1024).contains(&case.size_px), "{case:?}");
            for block in 0..3 {
                let [polar, _] = case.contact(7, block);
                assert!((polar - case.polar_deg).abs() <= 2.0_f64.sqrt() * JITTER);
                palpate_study::config::parse("camera.toml", &case.config(7, block)).unwrap();
            }
        }
    }
}
