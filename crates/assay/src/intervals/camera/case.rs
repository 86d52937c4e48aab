//! Random presses of a camera sensor.

use palpate_sensing::Channel;

use super::super::draws::Draws;

/// The sensor's curvature, per mm.
const SENSOR: f64 = 1.0 / 20.0;
/// Smallest and largest relative curvature: of a dish of 60 mm and of a ball of 5 mm, per mm.
const CURVATURES: [f64; 2] = [SENSOR - 1.0 / 60.0, SENSOR + 1.0 / 5.0];
/// Smallest and largest values of the others, in the units of their fields.
const SIZES: [f64; 2] = [400.0, 1025.0];
const NOISES: [f64; 2] = [1.0, 5.0];
const INDENTATIONS: [f64; 2] = [0.6, 1.4];
const POLAR_ANGLES: [f64; 2] = [0.0, 20.0];
const MISALIGNMENTS: [f64; 2] = [0.0, 0.3];
const THICKNESSES: [f64; 2] = [4.0, 10.0];
/// The contact of a trial lies so far from the scene's at most, along either way, degrees.
const JITTER: f64 = 1.0;
/// Standard deviation of an indentation that is known, mm.
const INDENTATION_STD: f64 = 0.01;

/// Presses of one kind.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(in crate::intervals) enum Family {
    /// Layers, which the fit knows.
    Sound,
    /// Layers, by sensors that are known half as well, but that simulated presses on a plane calibrate.
    Calibrated,
    /// Layers, which the fit takes for half-spaces.
    LayerForHalfSpace,
    /// Half-spaces, which the fit takes for layers.
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

    /// The family in words.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sound => "layers",
            Self::Calibrated => "layers by calibrated sensors",
            Self::LayerForHalfSpace => "layers taken for half-spaces",
            Self::HalfSpaceForLayer => "half-spaces taken for layers",
        }
    }

    /// Whether the press is not what the fit believes.
    pub(super) const fn is_wrong(self) -> bool {
        matches!(self, Self::LayerForHalfSpace | Self::HalfSpaceForLayer)
    }

    /// Trials of each scene, of those that are asked for: few tell whether a wrong model is doubted, and sensors that are
    /// calibrated in every trial take long.
    pub(super) fn trials(self, asked: u64) -> u64 {
        match self {
            Self::Sound => asked,
            Self::Calibrated => asked.div_ceil(3),
            Self::LayerForHalfSpace | Self::HalfSpaceForLayer => asked.div_ceil(10),
        }
    }

    /// Knowledge of a sensor before its frame at rest and before presses that calibrate it, as a config has it.
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

    /// The model and the body that the fit believes in, as a config has them.
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

/// A press of a sensor by a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::intervals) struct Case {
    pub(super) family: Family,
    pub(super) number: u64,
    /// Relative curvature, per mm.
    relative_curvature: f64,
    pub(super) indentation: f64,
    /// Whether the indentation is fitted, not given.
    pub(super) fits_indentation: bool,
    pub(super) polar_deg: f64,
    azimuth_deg: f64,
    pub(super) misalignment: f64,
    pub(super) thickness: f64,
    pub(super) size_px: u32,
    pub(super) pixel_std: f64,
}

impl Case {
    /// The case of a family with this number: cases of one number differ by the bodies alone.
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
        self.relative_curvature - SENSOR
    }

    /// The case in words.
    pub(super) fn name(&self) -> String {
        let known = match self.fits_indentation {
            true => "fitted",
            false => "known",
        };
        format!(
            "{}, {}, indentation {known}",
            self.family.name(),
            self.number
        )
    }

    /// The case as a config, with the contact of a block of trials.
    pub(super) fn text(&self, seed: u64, block: u64) -> String {
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
        let (known, std) = match self.fits_indentation {
            true => ("fitted", 0.0),
            false => ("known", INDENTATION_STD),
        };
        let [polar, azimuth] = self.contact(seed, block);
        let sensor = self.family.sensor();
        let [model, believed] = self.family.bodies(thickness);
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
            estimator = {{ kind = "image", indentation = "{known}", indentation_std = {std}{believed} }}
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
                palpate_study::config::parse("camera.toml", &case.text(7, block)).unwrap();
            }
        }
    }
}
