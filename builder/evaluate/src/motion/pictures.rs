//! Ten transitions frame by frame, to be looked at: those that add most, and others drawn evenly from the rest.

use std::collections::BTreeSet;

use actor::capture::Capture;
use actor::graph::EssentialGraph;
use actor::walk::{Leg, Walk};
use glam::Vec3;
use image::{Rgba, RgbaImage, imageops};
use kernels::align::{Placement, centre_of_mass};
use synthesis::{FrameKind, Synthesiser};

use super::added::Added;
use super::played::Borrowed;
use crate::EvaluateError;
use crate::clay::{self, Camera, DOWN};
use crate::document::Picture;

/// Transitions that add most, and others.
const WORST: usize = 5;
const OTHERS: usize = 5;
/// Frames of a strip at most, and the size of one in pixels.
const FRAMES: usize = 12;
const SIZE: [u32; 2] = [140, 190];

/// What strips are made from.
pub(super) struct Strips<'a> {
    pub capture: &'a Capture,
    pub order: &'a [u32],
    pub graph: &'a EssentialGraph,
    /// Height of the ground in metres.
    pub ground: f32,
}

impl Strips<'_> {
    /// A strip of frames for each of the chosen transitions.
    pub fn of(&self, added: &Added) -> Result<Vec<Picture>, EvaluateError> {
        let mut by_peak: Vec<(f64, u32)> = added.peaks.iter().copied().zip(added.transitions.iter().copied()).collect();
        by_peak.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        by_peak.dedup_by_key(|entry| entry.1);
        let stride = (by_peak.len().saturating_sub(WORST) / OTHERS).max(1);
        let chosen: BTreeSet<usize> =
            (0..WORST).chain((1..=OTHERS).map(|k| WORST + k * stride - 1)).filter(|&at| at < by_peak.len()).collect();
        let mut synthesiser = Synthesiser::new(&self.capture.topology, Some(self.order))?;
        chosen.into_iter().map(|at| self.strip(&mut synthesiser, by_peak[at])).collect()
    }

    fn strip(&self, synthesiser: &mut Synthesiser, (peak, index): (f64, u32)) -> Result<Picture, EvaluateError> {
        let Capture { topology, timeline, poses, .. } = self.capture;
        let transition = &self.graph.transitions()[index as usize];
        let walk = Walk { legs: vec![Leg::Synthetic(index)], ..Walk::default() };
        synthesiser.begin_walk(self.graph, timeline, (transition.from, Placement::IDENTITY), &walk)?;
        let (mut frames, mut pose) = (Vec::new(), vec![Vec3::ZERO; topology.vertex_count()]);
        while let Some(info) = synthesiser.next_frame(self.graph, timeline, &mut Borrowed(poses), &mut pose)? {
            frames.push((info.kind, pose.clone()));
        }
        let count = frames.len().min(FRAMES);
        let [width, height] = SIZE;
        let mut picture = RgbaImage::from_pixel(width * count as u32, height, Rgba([255, 255, 255, 255]));
        // All frames are seen from one place, beside the way that the body goes.
        let middle = |pose: &[Vec3]| centre_of_mass(pose, topology.weights());
        let (first, last) = (middle(&frames[0].1), middle(&frames[frames.len() - 1].1));
        let heading = (last.x - first.x).atan2(last.z - first.z) + std::f32::consts::FRAC_PI_2;
        for place in 0..count {
            let (kind, pose) = &frames[place * (frames.len() - 1) / (count - 1).max(1)];
            // Recorded is grey, and the more of both there is, the more it is red.
            let lambda = if let FrameKind::Synthetic { lambda, .. } = *kind { lambda } else { 0.0 };
            let mixed = 4.0 * lambda * (1.0 - lambda);
            let colour = Vec3::new(0.55, 0.55, 0.55).lerp(Vec3::new(0.8, 0.3, 0.2), mixed);
            let camera = Camera { height: 1.2 * self.height(), ..Camera::framing(&frames[0].1, SIZE, heading) };
            let camera = Camera { target: camera.target.with_x(first.x).with_z(first.z), ..camera };
            let left = i64::from(width) * place as i64;
            for x in 0..width {
                let y = f64::from(height) / 2.0
                    + f64::from((camera.target.y - self.ground) * height as f32 / camera.height)
                        * f64::from(DOWN.cos());
                if y >= 0.0 && (y as u32) < height {
                    picture.put_pixel(left as u32 + x, y as u32, Rgba([170, 200, 170, 255]));
                }
            }
            let drawn = clay::draw(pose, topology.triangles(), &vec![colour; pose.len()], &camera);
            imageops::overlay(&mut picture, &drawn, left, 0);
        }
        let name = |frame: u32| {
            let sequence = timeline.sequence_of(frame);
            sequence.map_or_else(String::new, |s| format!("{} {}", s.name, frame - s.first_frame))
        };
        let fps = timeline.fps();
        let caption = format!(
            "{} to {}: {} frames, {:.2} s, adds up to {:.2} radians a second. Seen from one place; the line is the ground.",
            name(transition.from),
            name(transition.to),
            frames.len(),
            (frames.len() - 1) as f32 / fps,
            peak * f64::from(fps)
        );
        let png = clay::png(&picture).map_err(EvaluateError::Picture)?;
        Ok(Picture { png, size: [picture.width(), picture.height()], caption })
    }

    /// Height of the body in metres.
    fn height(&self) -> f32 {
        let range = |(low, high): (f32, f32), point: &Vec3| (low.min(point.y), high.max(point.y));
        let (low, high) = self.capture.poses.frame(0).iter().fold((f32::MAX, f32::MIN), range);
        high - low
    }
}
