//! Whole captures whose registration was thrown away are registered, and held against the truth.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::sync::Mutex;

use fixtures::{Scanned, captured, scanned};
use glam::{Quat, Vec3};
use job::{Job, Stopped};
use registration::checks::{Limits, fit};
use registration::detail::DetailError;
use registration::register::{Found, RegisterOptions, Registered, Source, register, survey, template};
use registration::scan::Scan;
use registration::template::Template;
use registration::track::{Target, TrackOptions, track};

/// The first frames of captures, each a sequence of its own.
struct Deregistered(Vec<(&'static str, usize)>);

impl Deregistered {
    /// The sequence of a frame, its capture, and its number there.
    fn place(&self, frame: usize) -> (usize, &'static str, usize) {
        let mut first = 0;
        for (sequence, &(name, count)) in self.0.iter().enumerate() {
            if frame < first + count {
                return (sequence, name, frame - first);
            }
            first += count;
        }
        panic!("there is no frame {frame}");
    }

    fn scan(&self, frame: usize) -> Scanned {
        let (_, name, number) = self.place(frame);
        scanned(name, number)
    }
}

#[derive(Debug)]
struct Failed;

impl From<Stopped> for Failed {
    fn from(_: Stopped) -> Self {
        Self
    }
}

impl From<DetailError> for Failed {
    fn from(_: DetailError) -> Self {
        Self
    }
}

impl Source for Deregistered {
    type Extra = ();
    type Error = Failed;

    fn count(&self) -> usize {
        self.0.iter().map(|(_, count)| count).sum()
    }

    fn sequence(&self, frame: usize) -> usize {
        self.place(frame).0
    }

    fn read(&self, frame: usize) -> Result<(Scan, ()), Failed> {
        let scan = self.scan(frame);
        let read =
            Scan { positions: scan.positions, triangles: scan.triangles, uvs: Vec::new(), colours: scan.colours };
        Ok((read, ()))
    }
}

/// The frame of the template, what was registered, and of each other frame its sequence, and the mean, the 95th percentile and the most of its
/// errors in millimetres.
fn figures(source: &Deregistered, options: &RegisterOptions) -> (usize, Registered, Vec<(usize, [f32; 3])>) {
    let job = Job::silent();
    let survey = survey(source, options, &job).unwrap();
    let tree = survey.tree(options.template);
    let root = survey.frames[tree.root];
    let template: Template = template(source, root).unwrap().unwrap();
    let poses: Mutex<Vec<Option<Vec<Vec3>>>> = Mutex::new(vec![None; source.count()]);
    let emit = |found: Found<()>| {
        poses.lock().unwrap()[found.tracked.frame] = Some(found.pose.to_vec());
        Ok(())
    };
    let registered = register(source, &survey, &tree, &template, options, &job, &emit).unwrap();
    // Cleaning may renumber the template's vertices: they are where they were.
    let scan = source.scan(root);
    let truth: Vec<usize> = template
        .surface
        .mesh
        .positions
        .iter()
        .map(|p| (0..scan.positions.len()).min_by_key(|&k| (scan.positions[k].distance(*p) * 1e7) as u64).unwrap())
        .collect();
    let poses = poses.into_inner().unwrap();
    let of = |frame: usize, pose: &Vec<Vec3>| {
        let (sequence, name, number) = source.place(frame);
        let (topology, original) = captured(name, &[number]);
        let mut errors: Vec<f32> = truth
            .iter()
            .zip(pose)
            .filter(|(k, _)| scan.truth[**k].2 < 0.005)
            .map(|(&k, place)| {
                let (face, weights, _) = scan.truth[k];
                let [a, b, c] = topology.triangles()[face as usize].map(|v| original[0][v as usize]);
                1000.0 * (a * weights.x + b * weights.y + c * weights.z).distance(*place)
            })
            .collect();
        errors.sort_by(f32::total_cmp);
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        (sequence, [mean, errors[errors.len() * 95 / 100], errors[errors.len() - 1]])
    };
    let others = poses.iter().enumerate().filter(|(frame, _)| *frame != root);
    let errors = others.filter_map(|(frame, pose)| pose.as_ref().map(|pose| of(frame, pose))).collect();
    (root, registered, errors)
}

#[test]
#[ignore = "reads ../shared/data"]
fn crane_and_jumping_are_registered() {
    // All of one capture with its colours, and the faster half of the other one by its geometry alone.
    for (name, count, colour) in [("crane", 60, 1.0), ("jumping", 20, 0.0)] {
        let mut options = RegisterOptions::default();
        options.track = TrackOptions { colour };
        let start = std::time::Instant::now();
        let (root, registered, errors) = figures(&Deregistered(vec![(name, count)]), &options);
        let seconds = start.elapsed().as_secs_f64();
        let mean = |k: usize| errors.iter().map(|(_, e)| e[k]).sum::<f32>() / errors.len() as f32;
        let worst = |k: usize| errors.iter().map(|(_, e)| e[k]).fold(0.0, f32::max);
        let fits = || registered.tracked.iter().map(|tracked| tracked.fit);
        let uncovered = fits().map(|fit| fit.uncovered).fold(0.0, f64::max);
        let backward = fits().map(|fit| fit.rms_backward).fold(0.0, f64::max);
        println!(
            "{name}, colour {colour}: root {root}, lost {}, mean {:.1} (worst {:.1}), p95 {:.1} (worst {:.1}) mm, \
             uncovered {:.2} %, backward {:.1} mm, {seconds:.0} s",
            registered.lost.len(),
            mean(0),
            worst(0),
            mean(1),
            worst(1),
            100.0 * uncovered,
            1000.0 * backward
        );
        assert!(registered.lost.is_empty(), "{:?}", registered.lost);
        assert!(uncovered <= 0.015 && backward <= 0.0035);
        assert!(mean(0) < if colour > 0.0 { 6.5 } else { 15.0 });
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_take_in_other_colours_is_found_by_its_shape() {
    // Both are the same body, but the colours of the one have nothing to do with those of the other.
    let source = Deregistered(vec![("crane", 6), ("jumping", 4)]);
    let (root, registered, errors) = figures(&source, &RegisterOptions::default());
    assert!(registered.lost.is_empty(), "{:?}", registered.lost);
    let other = 1 - source.place(root).0;
    let first: Vec<usize> = registered.recoloured.iter().map(|&frame| source.place(frame).0).collect();
    assert_eq!(first, [other]);
    for sequence in [0, 1] {
        let of: Vec<f32> = errors.iter().filter(|(of, _)| *of == sequence).map(|(_, e)| e[0]).collect();
        let mean = of.iter().sum::<f32>() / of.len() as f32;
        println!("root {root}, sequence {sequence}: {mean:.1} mm");
        assert!(mean < 6.5, "sequence {sequence}: {mean} mm, {of:?}");
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_wrong_heading_is_found_back_or_a_fault() {
    let source = Deregistered(vec![("crane", 60)]);
    for frame in [4, 20, 40] {
        let template: Template = template(&source, frame).unwrap().unwrap();
        let target = Target::new(source.read(frame + 1).unwrap().0.cleaned().unwrap().surface, template.scale);
        let (centre, mut right) = (template.surface.centroid(), Vec::new());
        for turn in [0.0_f32, 1.6, 3.1, -2.2] {
            let turned = |p: &Vec3| Quat::from_rotation_y(turn) * (*p - centre) + target.surface.centroid();
            let start: Vec<Vec3> = template.surface.mesh.positions.iter().map(turned).collect();
            let pose = track(&template, &start, &target, &TrackOptions::default());
            let found = fit(&template, &template.surface.posed(pose.clone()), &start, &target.surface);
            if right.is_empty() {
                right.clone_from(&pose);
            }
            let off = pose.iter().zip(&right).map(|(a, b)| a.distance(*b)).sum::<f32>() / pose.len() as f32;
            println!("{frame}, turned by {turn}: {off} m off, {found:?}");
            let fault = found.fault(&Limits::default(), template.scale);
            assert!(fault.is_some() || off < 0.003, "frame {frame} turned by {turn}: {off} m off, {found:?}");
            assert!(fault.is_none() || turn != 0.0);
        }
    }
}
