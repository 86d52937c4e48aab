//! Sensors that read the contacts of gliding fingers.

use nalgebra::{Point3, Vector3};
use palpate_ep2::{RoundTip, TipPoint};
use palpate_rolling::Touch;
use palpate_sensing::{BeyondPads, PadPlacement, Pads, direction_at, displacement_between};

use palpate_study::config::Reports;

#[derive(Clone, Debug)]
pub(super) struct GlideSensor {
    pub(super) kind: SensorKind,
    pub(super) normals: bool,
}

#[derive(Clone, Debug)]
pub(super) enum SensorKind {
    Ideal(Reports),
    Pads { pads: Pads, placement: PadPlacement },
}

impl GlideSensor {
    pub(super) fn read(
        &self,
        touch: &Touch,
        radius: f64,
    ) -> Result<(Point3<f64>, Option<Vector3<f64>>), BeyondPads> {
        let (position, normal) = match &self.kind {
            SensorKind::Ideal(Reports::Contact) => (touch.point, touch.normal),
            SensorKind::Ideal(Reports::LowestPoint) => {
                (touch.tip_centre - Vector3::z() * radius, touch.normal)
            }
            SensorKind::Pads { pads, placement } => {
                let pad = pad_direction(pads, placement, radius, &-touch.normal)?;
                (touch.tip_centre + pad * radius, -pad)
            }
        };
        Ok((position, self.normals.then_some(normal)))
    }

    /// The round fingertip, if the sensor reports its lowest point instead of the contact; otherwise `None`.
    pub(super) fn tip(&self, radius: f64) -> Option<RoundTip> {
        let is_lowest = matches!(self.kind, SensorKind::Ideal(Reports::LowestPoint));
        (is_lowest && radius > 0.0).then_some(RoundTip {
            radius,
            point: TipPoint::Lowest,
        })
    }

    pub(super) fn need(&self) -> String {
        let normals = if self.normals { "with" } else { "without" };
        match &self.kind {
            SensorKind::Ideal(Reports::Contact) => {
                format!("ideal sensor: the contact, {normals} its normal")
            }
            SensorKind::Ideal(Reports::LowestPoint) => {
                format!("ideal sensor: the lowest point of the tip, {normals} the contact's normal")
            }
            SensorKind::Pads { .. } => {
                format!("pads: the nearest one reports the contact, {normals} the normal")
            }
        }
    }
}

/// Direction from the centre of the fingertip to the pad that reports a contact. `direction` (unit vector) is the
/// direction from this centre to the contact. The pads are arranged around the lowest point of the tip.
fn pad_direction(
    pads: &Pads,
    placement: &PadPlacement,
    radius: f64,
    direction: &Vector3<f64>,
) -> Result<Vector3<f64>, BeyondPads> {
    // [`Pads`] are arranged around the direction +z, but the pads of a fingertip are arranged around its lowest point,
    // in the direction −z. So reverse z.
    let upside_down =
        |direction: &Vector3<f64>| Vector3::new(direction.x, direction.y, -direction.z);
    let displacement = displacement_between(&Vector3::z(), &upside_down(direction)) * radius;
    let read = pads.read(placement, &displacement)?;
    Ok(upside_down(&direction_at(&(read / radius))))
}
