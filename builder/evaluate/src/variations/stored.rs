//! What alternatives look like as the bundle has them: not what was sampled, but what is played.

use std::ops::Range;
use std::sync::Arc;

use ::motion::hold::mean;
use actor::alternatives::Alternatives;
use actor::capture::Capture;
use actor::feet::Feet;
use glam::Vec3;
use synthesis::Varied;

/// Times that a sequence is played: players show nothing else.
const MIXED: u64 = 6;

/// Measures of a sequence's stretches, their alternatives mixed as players mix them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Played {
    /// Alternatives.
    pub count: usize,
    /// Mean acceleration of a vertex over that of the recording.
    pub acceleration: f64,
    /// Mean change of an edge's length, as a part of it.
    pub edges: f64,
    /// The largest distance of a vertex from the recording where the first stretch begins and the last one ends, in metres.
    pub ends: f64,
    /// The largest step into or out of a stretch over the recording's mean step in it.
    pub seam: f64,
    /// The same of the recording.
    pub recorded_seam: f64,
    /// Mean distance of a vertex between two alternatives of a stretch, in metres.
    pub apart: f64,
    /// Mean distance of a vertex from the recording, in metres.
    pub off: f64,
    /// How far soles that stand move a frame, in metres, and those of the recording.
    pub slide: [f64; 2],
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1.0;
    }

    fn value(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }
}

/// Measures the alternatives of the stretches in `frames`, a sequence that is played from its beginning to its end.
pub fn played(capture: &Capture, feet: &Feet, all: &Arc<Alternatives>, frames: Range<u32>) -> Played {
    let mut found = Played::default();
    let [mut own, mut recorded, mut edges, mut apart, mut off] = std::array::from_fn::<Mean, 5, _>(|_| Mean::default());
    let mut slide = [Mean::default(), Mean::default()];
    let within = || all.stretches().iter().filter(|one| frames.contains(&one.first));
    found.count = within().map(|stretch| stretch.coefficients.len()).sum();
    let (Some(first), Some(last)) = (within().map(|one| one.first).min(), within().map(|one| one.last).max()) else {
        return found;
    };
    let span: Vec<u32> = (first..=last).collect();
    let was: Vec<Vec<Vec3>> = span.iter().map(|&frame| capture.poses.frame(frame).to_vec()).collect();
    let every: Vec<Vec<Vec<Vec3>>> = (0..MIXED).map(|draw| shown(all, &span, &was, draw)).collect();
    let step = (1..was.len()).map(|k| distance(&was[k - 1], &was[k])).sum::<f64>() / (was.len() - 1) as f64;
    // The largest step at the ends of stretches.
    let seam = |poses: &[Vec<Vec3>]| {
        let ends = within().flat_map(|one| [one.first - first, one.last - 1 - first]);
        ends.map(|k| distance(&poses[k as usize], &poses[k as usize + 1])).fold(0.0, f64::max) / step.max(1e-9)
    };
    found.recorded_seam = seam(&was);
    bends(&was).for_each(|bend| recorded.add(bend));
    slides(feet, &span, &was).for_each(|moved| slide[1].add(moved));
    for (k, poses) in every.iter().enumerate() {
        let last = poses.len() - 1;
        found.ends = found.ends.max(most(&poses[0], &was[0])).max(most(&poses[last], &was[last]));
        found.seam = found.seam.max(seam(poses));
        bends(poses).for_each(|bend| own.add(bend));
        slides(feet, &span, poses).for_each(|moved| slide[0].add(moved));
        for (pose, was) in poses.iter().zip(&was) {
            off.add(distance(pose, was));
            edges.add(changes(capture.topology.triangles(), pose, was));
        }
        for other in &every[..k] {
            poses.iter().zip(other).for_each(|(a, b)| apart.add(distance(a, b)));
        }
    }
    found.acceleration = own.value() / recorded.value().max(1e-12);
    (found.edges, found.apart, found.off) = (edges.value(), apart.value(), off.value());
    found.slide = slide.map(|slide| slide.value());
    found
}

/// Frames as a player shows them, who draws by `draw`.
fn shown(all: &Arc<Alternatives>, span: &[u32], was: &[Vec<Vec3>], draw: u64) -> Vec<Vec<Vec3>> {
    let mut varied = Varied::new(Arc::clone(all), draw, 1.0);
    let pose = |(&frame, was): (&u32, &Vec<Vec3>)| {
        let mut pose = was.clone();
        varied.enters(frame);
        varied.add(frame, &mut pose);
        pose
    };
    span.iter().zip(was).map(pose).collect()
}

/// Mean distance of vertices, in metres.
fn distance(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / a.len().max(1) as f64
}

fn most(a: &[Vec3], b: &[Vec3]) -> f64 {
    f64::from(a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max))
}

/// Mean acceleration of vertices at each inner frame.
fn bends(poses: &[Vec<Vec3>]) -> impl Iterator<Item = f64> {
    poses.windows(3).map(|three| {
        let bend = |v: usize| f64::from((three[0][v] + three[2][v] - 2.0 * three[1][v]).length());
        (0..three[1].len()).map(bend).sum::<f64>() / three[1].len().max(1) as f64
    })
}

/// Mean change of edges, as a part of their lengths.
fn changes(triangles: &[[u32; 3]], pose: &[Vec3], was: &[Vec3]) -> f64 {
    let change = |&[a, b, _]: &[u32; 3]| {
        let length = |pose: &[Vec3]| pose[a as usize].distance(pose[b as usize]);
        f64::from((length(pose) / length(was).max(1e-6) - 1.0).abs())
    };
    triangles.iter().map(change).sum::<f64>() / triangles.len().max(1) as f64
}

/// How far each sole moves along the ground from one frame to the next while it stands in both.
fn slides<'a>(feet: &'a Feet, span: &'a [u32], poses: &'a [Vec<Vec3>]) -> impl Iterator<Item = f64> + 'a {
    let stands = |k: usize, foot: usize| feet.stands(span[k], foot) && feet.stands(span[k - 1], foot);
    let moved = |k: usize, foot: usize| {
        let at = |k: usize| mean(feet.vertices(foot), &poses[k]).with_y(0.0);
        f64::from(at(k).distance(at(k - 1)))
    };
    (1..poses.len())
        .flat_map(move |k| (0..feet.count()).filter(move |&foot| stands(k, foot)).map(move |foot| moved(k, foot)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::alternatives::Stretch;
    use actor::capture::Poses;
    use actor::surface::Surface;
    use actor::timeline::{Sequence, Timeline};
    use kernels::random::mix;
    use kernels::topology::Topology;
    use synthesis::mixture;

    #[test]
    fn measures_are_those_of_hand() {
        // A triangle that goes 1 cm a frame; one alternative lifts all of it by 1 cm in the two inner frames.
        let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut poses = Poses::new(3);
        (0..4).for_each(|k| poses.push(&base.map(|point| point + 0.01 * k as f32 * Vec3::Z)));
        let topology = Topology::new(3, vec![[0, 1, 2]], vec![1.0; 3]).unwrap();
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 4, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let rows = |steps: i16| vec![steps; 2];
        let stretch = Stretch { first: 0, last: 3, headings: vec![0; 2], coefficients: vec![rows(100)] };
        let all = Alternatives::new(vec![vec![[0, 127, 0]; 3]], vec![stretch], 3, &timeline).unwrap();
        let surface = Surface::default();
        let capture =
            Capture { name: "t".into(), topology, surface, timeline, poses, vertex_of_file_vertex: Vec::new() };
        let found = played(&capture, &Feet::default(), &Arc::new(all), 0..4);
        assert_eq!((found.count, found.ends, found.edges), (1, 0.0, 0.0));
        // Up or down by some share of 0.75 cm in half of the frames; the step into it goes up or down by that much, and on by 1 cm.
        let shares: Vec<f64> = (0..MIXED).map(|draw| f64::from(mixture(mix(mix(draw, 0), 0), 1)[0])).collect();
        let off = shares.iter().map(|share| share.abs()).sum::<f64>() / MIXED as f64;
        let most = shares.iter().map(|share| share.abs()).fold(0.0, f64::max);
        assert!((found.off - 0.005 * 0.75 * off).abs() < 1e-6 && found.apart > 0.0, "{found:?}");
        assert!(
            (found.seam - (0.75 * most).hypot(1.0)).abs() < 1e-4 && (found.recorded_seam - 1.0).abs() < 1e-4,
            "{found:?}"
        );
        assert!(found.acceleration > 100.0, "what goes straight has none");
    }
}
