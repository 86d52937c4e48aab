//! Regimes of contact between a round sensor and an object, by their relative curvature.

use strum::IntoStaticStr;

/// The ways in which a sphere touches an object of some curvature (2020 paper, Fig. 2).
///
/// ```
/// use palpate_press::ContactRegime;
///
/// // A sensor of radius 20 on a bulge and in two hollows.
/// let on = |object_radius: f64| ContactRegime::of(1.0 / 20.0, 1.0 / object_radius);
/// assert_eq!(on(80.0), ContactRegime::Convex);
/// assert_eq!(on(-80.0), ContactRegime::Concave);
/// assert_eq!(on(-10.0), ContactRegime::Edge);
/// ```
#[derive(Clone, Copy, Debug, Eq, Hash, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum ContactRegime {
    /// The object bulges towards the sensor.
    Convex,
    /// The object is flat.
    Flat,
    /// The object is hollow, but less so than the sensor is round: one point is touched first.
    Concave,
    /// The object is as hollow as the sensor is round: no point is touched first.
    Conforming,
    /// The object is more hollow than the sensor is round: its edge is touched.
    Edge,
}

/// Relative curvatures below this share of the sensor's own count as none.
const NONE: f64 = 1e-12;

impl ContactRegime {
    /// The regime of a sensor of curvature `sensor > 0` on an object of curvature `object`, positive where convex.
    pub fn of(sensor: f64, object: f64) -> Self {
        let relative = sensor + object;
        if relative.abs() <= NONE * sensor {
            Self::Conforming
        } else if relative < 0.0 {
            Self::Edge
        } else if object < 0.0 {
            Self::Concave
        } else if object > 0.0 {
            Self::Convex
        } else {
            Self::Flat
        }
    }

    /// The stable name.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_sensor_of_20_mm() {
        let on = |object| ContactRegime::of(1.0 / 20.0, object);
        assert_eq!(on(1.0 / 80.0), ContactRegime::Convex);
        assert_eq!(on(0.0), ContactRegime::Flat);
        assert_eq!(on(-1.0 / 80.0), ContactRegime::Concave);
        assert_eq!(on(-1.0 / 20.0), ContactRegime::Conforming);
        assert_eq!(on(-1.0 / 20.000_000_1), ContactRegime::Concave);
        assert_eq!(on(-1.0 / 10.0), ContactRegime::Edge);
    }
}
