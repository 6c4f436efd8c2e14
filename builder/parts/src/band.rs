//! The band in which a limb overlaps the torso, moved towards its end until the limb is a disc and the band a cylinder.

use crate::extremities::Extremity;
use crate::measured::Measured;
use crate::shape::{Shape, shape_of};

/// Half of the band's width: this much of the root of the surface's area, or so many edges, whichever is more.
const HALF: f32 = 0.025;
const EDGES: f32 = 2.0;
/// Steps by half an edge that are tried.
const STEPS: usize = 48;
/// A limb is not cut shorter than this share of what it should be.
const SHORTEST: f32 = 0.6;

/// A limb.
#[derive(Clone, Debug, PartialEq)]
pub struct Limb {
    /// The vertex at its end.
    pub tip: u32,
    /// How far along the surface from its end the middle of the band lies, in metres.
    pub hinge: f32,
    /// Half of the band's width, in metres.
    pub half_band: f32,
    /// For each vertex how far it belongs to the limb: 1 beyond the band, smooth within.
    pub weights: Vec<f32>,
    /// Whether it is a disc and its band a cylinder; not so on a mesh whose limbs have holes or handles.
    pub is_disc: bool,
}

/// The limb of an extremity that ends at `radius` metres from its tip.
pub fn limb(found: &Extremity, radius: f32, triangles: &[[u32; 3]], body: &Measured) -> Limb {
    let half = half_band(body);
    // The band must end before another limb begins, and leave something of this one.
    let first = radius.min(found.stop - half).max(1.5 * half);
    let tries = (0..STEPS).map(|step| first - 0.5 * step as f32 * body.edge).take_while(|&r| r >= SHORTEST * first);
    let good = tries.into_iter().find(|&radius| is_good(found, radius, half, triangles));
    let hinge = good.unwrap_or(first);
    let weights = found.distances.iter().map(|distance| smooth_step(hinge - distance, half)).collect();
    Limb { tip: found.tip, hinge, half_band: half, weights, is_disc: good.is_some() }
}

/// Half of a band's width on a body, in metres.
pub fn half_band(body: &Measured) -> f32 {
    (HALF * body.area.sqrt()).max(EDGES * body.edge)
}

/// How far what lies `within` metres inside of a part's border belongs to it: from 0 to 1 over the band.
pub fn smooth_step(within: f32, half: f32) -> f32 {
    let t = ((half + within) / (2.0 * half)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Limb {
    /// The shapes of all that belongs to the limb, and of its band.
    #[must_use]
    pub fn shapes(&self, triangles: &[[u32; 3]]) -> [Shape; 2] {
        let within = |most: f32| -> Vec<[u32; 3]> {
            let inside = |&vertex: &u32| {
                let weight = self.weights[vertex as usize];
                weight > 0.0 && weight < most
            };
            triangles.iter().filter(|corners| corners.iter().all(inside)).copied().collect()
        };
        [f32::INFINITY, 1.0].map(|most| shape_of(&within(most)))
    }
}

/// Whether limb and band are what they should be.
fn is_good(found: &Extremity, radius: f32, half: f32, triangles: &[[u32; 3]]) -> bool {
    let within = |from: f32, to: f32| -> Vec<[u32; 3]> {
        let inside = |&vertex: &u32| (from..to).contains(&found.distances[vertex as usize]);
        triangles.iter().filter(|corners| corners.iter().all(inside)).copied().collect()
    };
    shape_of(&within(0.0, radius + half)) == Shape::DISC
        && shape_of(&within(radius - half, radius + half)) == Shape::CYLINDER
}
