//! One template by another: where both lie on one frame, each vertex of the one lies at a point of the other, and goes with it to
//! other frames.

use glam::Vec3;
use rayon::prelude::*;

use super::groups::{at, complete, frame_of};
use super::template::Template;
use super::track::Target;

/// Where a vertex lies on the other template.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    triangle: [u32; 3],
    weights: Vec3,
    /// The vertex from the point, in the frame of the triangle.
    off: Vec3,
}

/// Where each vertex of a template lies on another one.
#[derive(Clone, Debug)]
pub(crate) struct Carried {
    anchors: Vec<Option<Anchor>>,
    neighbours: Vec<Vec<u32>>,
}

impl Carried {
    /// `template` in the pose `own` on `carrier` in the pose `others`: both lie on one frame.
    pub fn new((template, own): (&Template, &[Vec3]), (carrier, others): (&Template, &[Vec3])) -> Self {
        let posed = template.surface.posed(own.to_vec());
        let on = Target::new(carrier.surface.posed(others.to_vec()), template.scale);
        let of = |v: usize| -> Option<Anchor> {
            let place = posed.mesh.positions[v];
            let point = on.closest(place, posed.normals[v])?;
            let triangle = *carrier.surface.mesh.triangles.get(point.triangle as usize)?;
            let corners = triangle.map(|v| others[v as usize]);
            let off = frame_of(corners)?.transpose() * (place - at(corners, point.weights));
            Some(Anchor { triangle, weights: point.weights, off })
        };
        let anchors = (0..own.len()).into_par_iter().map(of).collect();
        Self { anchors, neighbours: template.surface.mesh.neighbours() }
    }

    /// The template where the other one has the pose `others`; `None` where too much of that has collapsed.
    pub fn pose(&self, others: &[Vec3]) -> Option<Vec<Vec3>> {
        let of = |anchor: &Option<Anchor>| -> Option<Vec3> {
            let anchor = (*anchor)?;
            let corners = anchor.triangle.map(|v| others[v as usize]);
            Some(at(corners, anchor.weights) + frame_of(corners)? * anchor.off)
        };
        complete(self.anchors.iter().map(of).collect(), &self.neighbours)
    }
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;
    use glam::Quat;

    use super::*;
    use crate::surface::Surface;

    #[test]
    fn a_template_goes_where_the_one_goes_that_it_lies_on() {
        let body = |cell: f32| {
            let mesh = polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), cell, |p| {
                (p / Vec3::new(0.3, 0.6, 0.2)).length() * 0.3 - 0.3
            });
            Template::new(Surface::new(mesh, None)).unwrap()
        };
        let bend = |p: Vec3| Quat::from_rotation_z(0.5 * p.y) * p + Vec3::new(0.2, 0.1, 0.0);
        let (own, other) = (body(0.05), body(0.04));
        let [here, there] = [&own, &other].map(|template| template.surface.mesh.positions.clone());
        let moved: Vec<Vec3> = there.iter().map(|&p| bend(p)).collect();
        let found = Carried::new((&own, &here), (&other, &there)).pose(&moved).unwrap();
        let worst = found.iter().zip(&here).map(|(found, &p)| found.distance(bend(p))).fold(0.0, f32::max);
        assert!(worst < 0.006, "{worst}");
        // A pose in which all has collapsed carries nothing.
        assert!(Carried::new((&own, &here), (&other, &there)).pose(&vec![Vec3::ZERO; there.len()]).is_none());
    }
}
