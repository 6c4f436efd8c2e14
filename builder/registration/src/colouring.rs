//! The colours that a template is looked for with, sequence by sequence: takes of other days may show the same body in other clothes or another light.
//!
//! The first frame of a sequence that is tracked decides. Where colours there differ as those of any two points would, they tell nothing, and lead
//! astray: the frame is found by its shape alone, and what it shows is what the template wears in the rest of the sequence.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;

use super::surface::{Closest, Surface};
use super::template::Template;
use super::transport::Samples;

/// Colours that differ by at least so much of what they would by chance are others.
const OTHERS: f64 = 0.8;
/// So many points of each surface tell how much colours differ by chance.
const SAMPLES: usize = 300;

/// What a frame was found with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worn {
    /// One of the [`Colourings`], by its number.
    Known(usize),
    /// Its shape alone.
    Shape,
}

/// The template in all colours that it was found to have.
#[derive(Debug)]
pub struct Colourings {
    /// Its own come first.
    templates: Vec<Arc<Template>>,
    sequences: BTreeMap<usize, usize>,
    /// Frames that were found by their shape alone.
    changed: Vec<usize>,
}

impl Colourings {
    /// Of `template`, which is known in its own colours alone.
    #[must_use]
    pub fn new(template: &Template) -> Self {
        let own = template.coloured(template.surface.colours.clone());
        Self { templates: vec![Arc::new(own)], sequences: BTreeMap::new(), changed: Vec::new() }
    }

    /// The number of the colouring of a sequence; `None` where none of its frames was tracked.
    #[must_use]
    pub fn of(&self, sequence: usize) -> Option<usize> {
        self.sequences.get(&sequence).copied()
    }

    /// All that are known; the template's own come first.
    #[must_use]
    pub fn templates(&self) -> &[Arc<Template>] {
        &self.templates
    }

    /// Says what `frame` of a sequence was found with: `colours` are those that it shows, where it was found by its shape. The first one of a
    /// sequence decides.
    pub fn decide(&mut self, (sequence, frame): (usize, usize), worn: Worn, colours: Option<Vec<Vec3>>) {
        if self.sequences.contains_key(&sequence) {
            return;
        }
        let number = match worn {
            Worn::Known(number) => number,
            Worn::Shape => {
                self.templates.push(Arc::new(self.templates[0].coloured(colours)));
                self.changed.push(frame);
                self.templates.len() - 1
            }
        };
        self.sequences.insert(sequence, number);
    }

    /// The frames that were found by their shape alone, of each sequence that shows other colours the first.
    #[must_use]
    pub fn changed(self) -> Vec<usize> {
        self.changed
    }
}

/// Whether `difference`, the mean one of colours that lie on each other, says that these have nothing to do with each other.
#[must_use]
pub fn are_others(difference: f64, own: &Surface, target: &Surface) -> bool {
    by_chance(own, target).is_some_and(|chance| difference > OTHERS * chance)
}

/// The mean difference of the colours of any point of a surface and any of another; `None` where one has none, or both have one colour only.
#[must_use]
pub fn by_chance(a: &Surface, b: &Surface) -> Option<f64> {
    let (of_a, of_b) = (a.colours.as_ref()?, b.colours.as_ref()?);
    let (on_a, on_b) = (Samples::new(a, SAMPLES), Samples::new(b, SAMPLES));
    let mut mean = 0.0;
    for (&v, &mass) in on_a.vertices.iter().zip(&on_a.masses) {
        for (&w, &other) in on_b.vertices.iter().zip(&on_b.masses) {
            mean += f64::from(mass * other * of_a[v as usize].distance(of_b[w as usize]));
        }
    }
    (mean > 0.0).then_some(mean)
}

/// The colours that `target` shows under each vertex of `posed`, the template on it; `None` where it has none.
#[must_use]
pub fn shown(posed: &Surface, target: &Surface) -> Option<Vec<Vec3>> {
    let colours = target.colours.as_ref()?;
    let closest = Closest::new(target, 0.0);
    let of = |(&place, &normal): (&Vec3, &Vec3)| {
        let found = closest.find(target, place, normal);
        found.map_or(Vec3::ZERO, |found| target.interpolated(colours, found.triangle, found.weights))
    };
    Some(posed.mesh.positions.iter().zip(&posed.normals).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::sheet;

    /// A sheet with stripes along its first axis, of so many radians a metre.
    fn striped(stripes: f32, at: f32) -> Surface {
        let mesh = sheet(40);
        let colour = |p: &Vec3| Vec3::new((stripes * p.x + at).sin(), (stripes * p.z).cos(), 0.5) * 0.5 + 0.25;
        let colours = mesh.positions.iter().map(colour).collect();
        Surface::new(mesh, Some(colours))
    }

    fn differ(a: &Surface, b: &Surface) -> bool {
        let (of_a, of_b) = (a.colours.as_ref().unwrap(), b.colours.as_ref().unwrap());
        let mean = of_a.iter().zip(of_b).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / of_a.len() as f64;
        are_others(mean, a, b)
    }

    #[test]
    fn colours_that_slid_are_the_same_and_other_clothes_are_not() {
        let own = striped(40.0, 0.0);
        assert!(!differ(&own, &own));
        assert!(!differ(&own, &striped(40.0, 0.8)));
        assert!(differ(&own, &striped(57.0, 0.3)));
        // One colour tells nothing, and is no other one.
        let with = |colours| Surface::new(own.mesh.clone(), colours);
        let plain = with(Some(vec![Vec3::ONE; own.areas.len()]));
        assert!(!differ(&plain, &plain));
        assert!(!are_others(1.0, &own, &with(None)));
    }

    #[test]
    fn what_a_frame_shows_is_worn_in_its_sequence() {
        let (own, other) = (striped(40.0, 0.0), striped(57.0, 0.3));
        let template = Template::new(own.clone()).unwrap();
        let mut colourings = Colourings::new(&template);
        colourings.decide((0, 3), Worn::Known(0), None);
        assert_eq!((colourings.of(0), colourings.of(1)), (Some(0), None));
        colourings.decide((1, 8), Worn::Shape, shown(&own, &other));
        // What comes later changes nothing.
        colourings.decide((1, 9), Worn::Known(0), None);
        assert_eq!(colourings.of(1), Some(1));
        let worn = colourings.templates()[1].surface.colours.as_ref().unwrap();
        let off = worn.iter().zip(other.colours.as_ref().unwrap()).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off < 1e-5, "{off}");
        assert_eq!(colourings.changed(), [8]);
    }
}
