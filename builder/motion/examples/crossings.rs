//! How often the built-in performer's surface goes through itself where it is varied, beside the recording.
//!
//!     cargo run -p reprise-motion --example crossings -- 0.25 dance walk
#![allow(clippy::print_stdout, reason = "an example that prints")]

use std::collections::BTreeMap;

use actor::capture::Poses;
use actor::feet::Feet;
use glam::Vec3;
use job::Job;
use kernels::random::{mix, signed};
use kernels::topology::{Topology, barycentric_areas};
use motion::seen::Seen;
use motion::vary::{VaryOptions, vary};
use performer::Kind;
use performer::figure::Figure;
use performer::motion::BEHAVIOURS;
use performer::perform::{Take, perform};
use rayon::prelude::*;

const FPS: f32 = 25.0;
/// Mixtures.
const MIXED: u64 = 6;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let amount: f64 = arguments.next().and_then(|amount| amount.parse().ok()).unwrap_or(0.25);
    let names: Vec<String> = arguments.collect();
    let figure = Figure::of(Kind::Woman, 2500, 128);
    let triangles = figure.mesh.triangles.clone();
    for (behaviour, (name, seconds)) in
        BEHAVIOURS.iter().enumerate().filter(|(_, own)| names.iter().any(|name| name == own.0))
    {
        let frames = (seconds * FPS).round() as usize;
        let take = Take { name: (*name).into(), behaviour, first_frame: 0, frames, seed: mix(1, behaviour as u64) };
        let mut poses = Poses::new(figure.mesh.positions.len());
        perform(&figure, &take, FPS).iter().for_each(|frame| poses.push(&frame.positions));
        let areas = barycentric_areas(&triangles, poses.frame(0));
        let topology = Topology::new(poses.vertex_count() as u32, triangles.clone(), areas).expect("a surface");
        let mut options = VaryOptions::default();
        (options.amount, options.count) = (amount, 8);
        let count = poses.len() as u32;
        let varied = vary(&poses, &topology, (0..count, FPS), &options, &Job::silent()).expect("nobody stops it");
        let feet = Feet::default();
        let seen = Seen::new(&varied, &poses, &feet, None);
        let all: Vec<Vec<Vec<Vec3>>> =
            (0..8).map(|number| (0..count).map(|frame| seen.variation(number).pose(frame)).collect()).collect();
        let of_frame = |&frame: &u32| {
            let was = poses.frame(frame);
            let own = crossings(&triangles, was);
            let (mut off, mut found, mut worst, mut edges) = (0.0, 0, 0, 0.0);
            for draw in 0..MIXED {
                let mut shares: Vec<f32> = (0..8).map(|k| (0..4).map(|j| signed(draw, 4 * k + j)).sum()).collect();
                for cut in 0..2 {
                    let length = shares.iter().skip(cut).step_by(2).map(|share| share * share).sum::<f32>().sqrt();
                    shares
                        .iter_mut()
                        .skip(cut)
                        .step_by(2)
                        .for_each(|share| *share /= length * std::f32::consts::SQRT_2);
                }
                let mut pose = was.to_vec();
                for (share, poses) in shares.iter().zip(&all) {
                    pose.iter_mut()
                        .zip(&poses[frame as usize])
                        .zip(was)
                        .for_each(|((place, own), was)| *place += (*own - *was) * *share);
                }
                off += pose.iter().zip(was).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / was.len() as f64;
                let length = |pose: &[Vec3], [a, b, _]: [u32; 3]| pose[a as usize].distance(pose[b as usize]);
                let change = |&triangle: &[u32; 3]| {
                    f64::from((length(&pose, triangle) / length(was, triangle).max(1e-6) - 1.0).abs())
                };
                edges += triangles.iter().map(change).sum::<f64>() / triangles.len() as f64;
                let crossings = crossings(&triangles, &pose).saturating_sub(own);
                found += crossings;
                worst = worst.max(crossings);
            }
            (own, off, found, worst, edges)
        };
        let looked: Vec<u32> = (0..count).step_by(2).collect();
        let of: Vec<(usize, f64, usize, usize, f64)> = looked.par_iter().map(of_frame).collect();
        let n = of.len() as f64;
        println!(
            "{name} {amount}: recorded {:.1} crossings a frame, {:.2} more, {} at most, in {:.0} % of frames more than 5; {:.1} mm off, edges {:.2} %",
            of.iter().map(|own| own.0 as f64).sum::<f64>() / n,
            of.iter().map(|own| own.2 as f64).sum::<f64>() / n / MIXED as f64,
            of.iter().map(|own| own.3).max().unwrap_or(0),
            100.0 * of.iter().filter(|own| own.3 > 5).count() as f64 / n,
            1e3 * of.iter().map(|own| own.1).sum::<f64>() / n / MIXED as f64,
            1e2 * of.iter().map(|own| own.4).sum::<f64>() / n / MIXED as f64,
        );
    }
}

/// Edges that go through triangles.
fn crossings(triangles: &[[u32; 3]], pose: &[Vec3]) -> usize {
    let size = 0.04;
    let cells = |corners: [Vec3; 3]| {
        let low = (corners[0].min(corners[1]).min(corners[2]) / size).floor().as_ivec3();
        let high = (corners[0].max(corners[1]).max(corners[2]) / size).floor().as_ivec3();
        (low.x..=high.x).flat_map(move |x| (low.y..=high.y).flat_map(move |y| (low.z..=high.z).map(move |z| [x, y, z])))
    };
    let at = |triangle: [u32; 3]| triangle.map(|vertex| pose[vertex as usize]);
    let mut grid: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    for (k, &triangle) in triangles.iter().enumerate() {
        cells(at(triangle)).for_each(|cell| grid.entry(cell).or_default().push(k));
    }
    let mut count = 0;
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from < to) {
            let ends = [pose[from as usize], pose[to as usize]];
            let mut near: Vec<usize> =
                cells([ends[0], ends[1], ends[1]]).filter_map(|cell| grid.get(&cell)).flatten().copied().collect();
            near.sort_unstable();
            near.dedup();
            count += near
                .into_iter()
                .filter(|&k| {
                    !triangles[k].contains(&from) && !triangles[k].contains(&to) && goes_through(ends, at(triangles[k]))
                })
                .count();
        }
    }
    count
}

fn goes_through([from, to]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let side = |p: Vec3, q: Vec3, r: Vec3, s: Vec3| (q - p).cross(r - p).dot(s - p) > 0.0;
    side(a, b, c, from) != side(a, b, c, to)
        && side(from, to, a, b) == side(from, to, b, c)
        && side(from, to, b, c) == side(from, to, c, a)
}
