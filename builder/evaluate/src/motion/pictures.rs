//! Ten transitions frame by frame, to be looked at: those that add most, and others drawn evenly from the rest.

use std::collections::BTreeSet;

use actor::graph::EssentialGraph;
use glam::Vec3;
use image::{Rgba, RgbaImage, imageops};

use super::added::Added;
use crate::EvaluateError;
use crate::clay::{self, Camera};
use crate::document::Picture;
use crate::performance::{Performance, Recordings};

/// Transitions that add most, and others.
const WORST: usize = 5;
const OTHERS: usize = 5;
/// Frames of a strip at most, and the size of one in pixels.
const FRAMES: usize = 12;
const SIZE: [u32; 2] = [100, 160];

/// A strip of frames for each of the chosen transitions.
pub(super) fn strips(
    recordings: Recordings,
    order: &[u32],
    graph: &EssentialGraph,
    added: &Added,
) -> Result<Vec<Picture>, EvaluateError> {
    let mut by_peak: Vec<(f64, u32)> = added.peaks.iter().copied().zip(added.transitions.iter().copied()).collect();
    by_peak.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    by_peak.dedup_by_key(|entry| entry.1);
    let stride = (by_peak.len().saturating_sub(WORST) / OTHERS).max(1);
    let chosen: BTreeSet<usize> =
        (0..WORST).chain((1..=OTHERS).map(|k| WORST + k * stride - 1)).filter(|&at| at < by_peak.len()).collect();
    let mut stage = Performance::new(recordings, order)?;
    chosen.into_iter().map(|at| strip(&mut stage, graph, by_peak[at])).collect()
}

fn strip(stage: &mut Performance, graph: &EssentialGraph, (peak, index): (f64, u32)) -> Result<Picture, EvaluateError> {
    let recordings = stage.recordings;
    let transition = &graph.transitions()[index as usize];
    let blends = recordings.blends(transition)?;
    let count = blends.len().min(FRAMES);
    let [width, height] = SIZE;
    let mut picture = RgbaImage::from_pixel(width * count as u32, height, Rgba([255, 255, 255, 255]));
    for place in 0..count {
        let node = place * (blends.len() - 1) / (count - 1).max(1);
        let blend = &blends[node];
        let pose = stage.pose(blend, blend.lambda)?;
        // Recorded is grey, and the more of both there is, the more it is red.
        let mixed = 4.0 * blend.lambda * (1.0 - blend.lambda);
        let colour = Vec3::new(0.55, 0.55, 0.55).lerp(Vec3::new(0.8, 0.3, 0.2), mixed);
        let colours = vec![colour; pose.len()];
        let camera = Camera::framing(&pose, SIZE, 0.6 + blend.placements[0].heading);
        let drawn = clay::draw(&pose, recordings.topology.triangles(), &colours, &camera);
        imageops::overlay(&mut picture, &drawn, i64::from(width) * place as i64, 0);
    }
    let place = |frame: u32| {
        let sequence = recordings.timeline.sequence_of(frame);
        sequence.map_or_else(String::new, |s| format!("{} {}", s.name, frame - s.first_frame))
    };
    let fps = recordings.timeline.fps();
    let caption = format!(
        "{} to {}: {} frames, {:.2} s, adds up to {:.2} radians a second.",
        place(transition.from),
        place(transition.to),
        blends.len(),
        (blends.len() - 1) as f32 / fps,
        peak * f64::from(fps)
    );
    let png = clay::png(&picture).map_err(EvaluateError::Picture)?;
    Ok(Picture { png, size: [picture.width(), picture.height()], caption })
}
