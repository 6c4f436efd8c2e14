//! Components of the mesh that stay on each other: how far they are from where they touch, in recorded frames and in blends.

use actor::capture::Capture;
use actor::graph::EssentialGraph;
use actor::ties::{Tie, Ties};
use geometry::closest::closest_of_triangle;
use glam::Vec3;
use kernels::align::Placement;
use pipeline::ties::place;
use rayon::prelude::*;
use synthesis::Synthesiser;

use super::played::{Begun, Borrowed};
use crate::EvaluateError;
use crate::document::{Cell, Table};
use crate::statistics::percentile;

/// One place where two components touch, as it is found in a frame that is recorded.
struct Touch {
    vertex: u32,
    /// The nearest triangle of the other one, and where on it.
    corners: [u32; 3],
    shares: Vec3,
}

/// What is measured of a tie.
struct Measured<'a> {
    tie: &'a Tie,
    touches: Vec<Touch>,
    reference: &'a [Vec3],
    /// Where the contact is on average, seen from the patch.
    usual: Vec3,
}

impl<'a> Measured<'a> {
    fn of(tie: &'a Tie, capture: &'a Capture) -> Self {
        let reference = capture.poses.frame(0);
        let component = capture.topology.component_of_vertex();
        let other = component[tie.patch[0] as usize];
        let triangles =
            || capture.topology.triangles().iter().filter(|corners| component[corners[0] as usize] == other);
        let touch = |&vertex: &u32| {
            let point = reference[vertex as usize];
            let near = triangles().map(|&corners| {
                let shares = closest_of_triangle(point, corners.map(|corner| reference[corner as usize]));
                (Touch { vertex, corners, shares }, shares)
            });
            let far = |touch: &Touch| touch.gap(reference);
            near.map(|(touch, _)| touch).min_by(|a, b| far(a).total_cmp(&far(b)))
        };
        let touches = tie.contact.iter().filter_map(touch).collect();
        let places: Vec<Vec3> = capture.poses.iter().map(|pose| place(tie, reference, pose)).collect();
        let usual = places.iter().sum::<Vec3>() / places.len().max(1) as f32;
        Self { tie, touches, reference, usual }
    }

    /// Mean distance between what touches, and how far the contact is from where it usually is; in metres.
    fn look(&self, pose: &[Vec3]) -> [f64; 2] {
        let gaps = self.touches.iter().map(|touch| f64::from(touch.gap(pose))).sum::<f64>();
        let moved = place(self.tie, self.reference, pose).distance(self.usual);
        [gaps / self.touches.len().max(1) as f64, f64::from(moved)]
    }
}

impl Touch {
    fn gap(&self, pose: &[Vec3]) -> f32 {
        let [a, b, c] = self.corners.map(|corner| pose[corner as usize]);
        (a * self.shares.x + b * self.shares.y + c * self.shares.z).distance(pose[self.vertex as usize])
    }
}

/// The head of the table.
pub(super) fn table() -> Table {
    Table::new(
        "motion_parts",
        "Components of the mesh that stay on another one, in all recorded frames and in the blended frames of the walks, in \
         percent of the body\u{2019}s height. Gap: distance between what touches in the first frame, mean over all that does. \
         Moved: how far the middle of that is from its usual place, seen from the other component. Worst: the largest \
         quotient of a tie\u{2019}s mean gap and its recorded one, of ties whose gap is at least 0.1 % then."
            .to_owned(),
        &[
            "frames",
            "ties",
            "of components",
            "looked at",
            "gap, mean",
            "gap, 99th",
            "gap, most",
            "gap, times recorded",
            "gap, 99th, times recorded",
            "worst tie, times",
            "moved, mean",
            "moved, 99th",
        ],
    )
}

/// What all ties look like, tie by tie and frame by frame.
type Looks = Vec<Vec<[f64; 2]>>;

/// Rows of the table: recorded, blends without ties, blends with them. None where nothing is tied.
pub(super) fn rows(
    capture: &Capture,
    order: &[u32],
    graph: &EssentialGraph,
    walks: &[Begun],
) -> Result<Vec<Vec<Cell>>, EvaluateError> {
    let ties: Vec<Measured> = graph.ties().all().par_iter().map(|tie| Measured::of(tie, capture)).collect();
    if ties.is_empty() {
        return Ok(Vec::new());
    }
    let recorded: Looks =
        ties.par_iter().map(|tie| capture.poses.iter().map(|pose| tie.look(pose)).collect()).collect();
    let free = blended(capture, order, &graph.clone().with_ties(Ties::default()), walks, &ties)?;
    let tied = blended(capture, order, graph, walks, &ties)?;
    let components = capture.topology.component_count();
    let height = height(capture.poses.frame(0));
    let named = [("recorded", &recorded), ("blended without ties", &free), ("blended", &tied)];
    Ok(named.into_iter().map(|(name, looks)| row(name, looks, &recorded, components, height)).collect())
}

fn row(name: &str, looks: &Looks, recorded: &Looks, components: usize, height: f64) -> Vec<Cell> {
    let values = |looks: &Looks, of: usize| -> Vec<f64> { looks.iter().flatten().map(|look| look[of]).collect() };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let at = |values: &[f64], share| percentile(values, share).unwrap_or(0.0);
    let [gaps, moved] = [0, 1].map(|of| values(looks, of));
    let own = values(recorded, 0);
    let percent = |metres: f64| Cell::Number(100.0 * metres / height, 3);
    let gap = |looks: &[[f64; 2]]| mean(&looks.iter().map(|look| look[0]).collect::<Vec<f64>>());
    let pairs = looks.iter().zip(recorded).filter(|(looks, _)| gap(looks) > 1e-3 * height);
    let worst = pairs.map(|(looks, own)| gap(looks) / gap(own)).fold(0.0, f64::max);
    vec![
        name.into(),
        Cell::Count(looks.len() as u64),
        Cell::Count(components as u64),
        Cell::Count(looks.first().map_or(0, Vec::len) as u64),
        percent(mean(&gaps)),
        percent(at(&gaps, 0.99)),
        percent(gaps.iter().copied().fold(0.0, f64::max)),
        Cell::Number(mean(&gaps) / mean(&own), 2),
        Cell::Number(at(&gaps, 0.99) / at(&own, 0.99), 2),
        Cell::Number(worst, 2),
        percent(mean(&moved)),
        percent(at(&moved, 0.99)),
    ]
}

/// All blended frames of the walks.
fn blended(
    capture: &Capture,
    order: &[u32],
    graph: &EssentialGraph,
    walks: &[Begun],
    ties: &[Measured],
) -> Result<Looks, EvaluateError> {
    let some = |walks: &[Begun]| -> Result<Looks, EvaluateError> {
        let mut synthesiser = Synthesiser::new(&capture.topology, Some(order))?;
        let (mut looks, mut pose) = (vec![Vec::new(); ties.len()], vec![Vec3::ZERO; capture.topology.vertex_count()]);
        let mut source = Borrowed(&capture.poses);
        for begun in walks {
            synthesiser.begin_walk(graph, &capture.timeline, (begun.start, Placement::IDENTITY), &begun.walk)?;
            while let Some(info) = synthesiser.next_frame(graph, &capture.timeline, &mut source, &mut pose)? {
                if info.kind.is_synthetic() {
                    looks.iter_mut().zip(ties).for_each(|(looks, tie)| looks.push(tie.look(&pose)));
                }
            }
        }
        Ok(looks)
    };
    let mut all: Looks = vec![Vec::new(); ties.len()];
    for looks in walks.par_chunks(8).map(some).collect::<Result<Vec<_>, _>>()? {
        all.iter_mut().zip(looks).for_each(|(all, looks)| all.extend(looks));
    }
    Ok(all)
}

fn height(pose: &[Vec3]) -> f64 {
    let heights = || pose.iter().map(|point| point.y);
    f64::from(heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min)).max(f64::MIN_POSITIVE)
}
