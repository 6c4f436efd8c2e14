//! Tracking along real captures whose registration was thrown away, against the truth.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use fixtures::{Scanned, captured, scanned};
use geometry::mesh::Mesh;
use glam::{Quat, Vec3};
use registration::checks::{Limits, fit};
use registration::surface::Surface;
use registration::template::Template;
use registration::track::{Target, TrackOptions, track};

fn surface(scan: &Scanned) -> Surface {
    let mesh = Mesh { positions: scan.positions.clone(), triangles: scan.triangles.clone() };
    Surface::new(mesh, Some(scan.colours.clone()))
}

/// A template from a frame of a scan, and where its vertices are in truth.
struct Tracked {
    name: &'static str,
    root: usize,
    scan: Scanned,
    template: Template,
}

impl Tracked {
    fn new(name: &'static str, root: usize) -> Self {
        let scan = scanned(name, root);
        let template = Template::new(surface(&scan)).unwrap();
        Self { name, root, scan, template }
    }

    /// Distances of the template's vertices in `pose` to where they are in truth in `frame`; what lies off the original, as
    /// webs do, is left out.
    fn errors(&self, frame: usize, pose: &[Vec3]) -> Vec<f32> {
        let (topology, poses) = captured(self.name, &[self.root, frame]);
        let truth = self.scan.truth.iter().zip(pose).filter(|((_, _, off), _)| *off < 0.005);
        let mut errors: Vec<f32> = truth
            .map(|(&(face, weights, _), place)| {
                let [a, b, c] = topology.triangles()[face as usize].map(|v| poses[1][v as usize]);
                (a * weights.x + b * weights.y + c * weights.z).distance(*place)
            })
            .collect();
        errors.sort_by(f32::total_cmp);
        errors
    }
}

/// `pose` turned and moved so that its centroid is that of `target`.
fn moved(template: &Template, pose: &[Vec3], target: &Surface, turn: f32) -> Vec<Vec3> {
    let posed = template.surface.posed(pose.to_vec());
    let (from, to, turn) = (posed.centroid(), target.centroid(), Quat::from_rotation_y(turn));
    pose.iter().map(|&p| turn * (p - from) + to).collect()
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_template_follows_a_crane() {
    for colour in [0.0, 1.0] {
        let tracked = Tracked::new("crane", 0);
        let template = &tracked.template;
        let mut pose = template.surface.mesh.positions.clone();
        let (mut means, mut worst) = (Vec::new(), 0.0_f32);
        for frame in 1..24 {
            let target = Target::new(surface(&scanned("crane", frame)), template.scale);
            let start = moved(template, &pose, &target.surface, 0.0);
            pose = track(template, &start, &target, &TrackOptions { colour });
            let found = fit(template, &template.surface.posed(pose.clone()), &start, &target.surface);
            let errors = tracked.errors(frame, &pose);
            let mean = 1000.0 * errors.iter().sum::<f32>() / errors.len() as f32;
            let p95 = 1000.0 * errors[errors.len() * 95 / 100];
            println!("{frame}: mean {mean:.1} mm, p95 {p95:.1} mm, {found:?}");
            assert_eq!(found.fault(&Limits::default(), template.scale), None, "frame {frame}");
            means.push(mean);
            worst = worst.max(mean);
        }
        let mean = means.iter().sum::<f32>() / means.len() as f32;
        println!("colour {colour}: {mean:.1} mm, worst frame {worst:.1} mm");
        assert!(mean < if colour > 0.0 { 6.5 } else { 11.0 }, "{mean} mm");
    }
}
