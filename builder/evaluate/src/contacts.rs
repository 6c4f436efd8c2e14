//! Foot skate: how far ground contacts slide from frame to frame.

use glam::{Vec3, Vec3Swizzles};

use super::performance::Recordings;
use super::statistics::percentile;
use super::truth::Truth;

/// A vertex this close to the ground touches it, in metres.
const TOUCHES: f32 = 0.02;
/// Vertices of a sole are below this in the capture's first frame, in metres.
const SOLE: f32 = 0.05;

/// What touches the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Contacts {
    /// Height of the ground.
    pub ground: f32,
    /// Vertices of the left and of the right sole, where the skeleton's truth tells them apart.
    pub soles: Option<[Vec<u32>; 2]>,
}

impl Contacts {
    /// The ground of a capture is where its lowest vertices are in most frames; soles are told apart by the ankles.
    #[must_use]
    pub fn of(recordings: &Recordings, truth: Option<&Truth>) -> Self {
        let lowest = |pose: &[Vec3]| pose.iter().map(|p| f64::from(p.y)).fold(f64::INFINITY, f64::min);
        let heights: Vec<f64> = recordings.poses.iter().map(lowest).collect();
        let ground = percentile(&heights, 0.25).unwrap_or(0.0) as f32;
        Self { ground, soles: truth.and_then(|truth| soles(recordings.poses.frame(0), ground, truth)) }
    }

    /// The mean slide in metres of the vertices that touch the ground in both of two frames in a row, and their number.
    #[must_use]
    pub fn slide(&self, before: &[Vec3], after: &[Vec3]) -> Option<(f64, usize)> {
        mean(before.iter().zip(after).filter(|(b, a)| self.touches(b) && self.touches(a)))
    }

    /// The same for the sole of one foot that is known to stand.
    #[must_use]
    pub fn slide_of_sole(&self, side: usize, before: &[Vec3], after: &[Vec3]) -> Option<(f64, usize)> {
        let sole = self.soles.as_ref()?.get(side)?;
        let pairs = sole.iter().filter_map(|&v| Some((before.get(v as usize)?, after.get(v as usize)?)));
        mean(pairs.filter(|(b, a)| self.touches(b) && self.touches(a)))
    }

    fn touches(&self, point: &Vec3) -> bool {
        point.y - self.ground < TOUCHES
    }
}

fn mean<'a>(pairs: impl Iterator<Item = (&'a Vec3, &'a Vec3)>) -> Option<(f64, usize)> {
    let (mut sum, mut count) = (0.0, 0);
    for (before, after) in pairs {
        sum += f64::from(before.xz().distance(after.xz()));
        count += 1;
    }
    (count > 0).then(|| (sum / f64::from(count), count as usize))
}

/// Low vertices of the first frame, by the nearer ankle; both feet have to stand there.
fn soles(pose: &[Vec3], ground: f32, truth: &Truth) -> Option<[Vec<u32>; 2]> {
    let ankles = [truth.position(0, "foot_l")?, truth.position(0, "foot_r")?];
    if truth.frames.first()?.planted != [true, true] {
        return None;
    }
    let mut soles = [Vec::new(), Vec::new()];
    for (vertex, point) in pose.iter().enumerate().filter(|(_, point)| point.y - ground < SOLE) {
        let distance = ankles.map(|ankle| ankle.xz().distance_squared(point.xz()));
        soles[usize::from(distance[1] < distance[0])].push(vertex as u32);
    }
    soles.iter().all(|sole| !sole.is_empty()).then_some(soles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_touches_slides() {
        let contacts = Contacts { ground: 0.1, soles: Some([vec![0], vec![1]]) };
        let before = [Vec3::new(0.0, 0.1, 0.0), Vec3::new(1.0, 0.11, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let after = [Vec3::new(0.03, 0.1, 0.04), Vec3::new(1.0, 0.11, 0.0), Vec3::new(9.0, 1.0, 0.0)];
        let (slide, count) = contacts.slide(&before, &after).unwrap();
        assert!((slide - 0.025).abs() < 1e-6 && count == 2);
        let (left, _) = contacts.slide_of_sole(0, &before, &after).unwrap();
        assert!((left - 0.05).abs() < 1e-6);
        assert_eq!(contacts.slide(&before[2..], &after[2..]), None);
    }
}
