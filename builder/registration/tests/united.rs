//! Frames that the template cannot be brought onto, on a template of their own that is joined with it where that can be.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Mutex;

use geometry::mesh::Mesh;
use geometry::polygonise::polygonise;
use geometry::sdf::{blend, cone, ellipsoid};
use glam::Vec3;
use job::{Job, Stopped};
use registration::checks::{Fault, Fit};
use registration::cut::Group;
use registration::detail::DetailError;
use registration::register::{Found, Lost, RegisterOptions, Source, Survey, register, survey, template};
use registration::scan::Scan;
use registration::unite::{United, unite};
use registration::written::write;

/// Frames of the second take, after three of the first.
const LATER: Range<usize> = 3..5;

/// Two takes.
struct Takes(Vec<Vec<Mesh>>);

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

impl Source for Takes {
    type Extra = ();
    type Error = Failed;

    fn count(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    fn sequence(&self, frame: usize) -> usize {
        usize::from(frame >= self.0[0].len())
    }

    fn read(&self, frame: usize) -> Result<(Scan, ()), Failed> {
        let mesh = self.0.iter().flatten().nth(frame).unwrap().clone();
        let colours = mesh.positions.iter().map(|&p| colour(p)).collect();
        Ok((Scan { positions: mesh.positions, triangles: mesh.triangles, uvs: Vec::new(), colours }, ()))
    }
}

/// The trunk, which stands still, has a colour everywhere; the arms have one each.
fn colour(p: Vec3) -> Vec3 {
    let near = p.clamp(Vec3::new(-0.2, 0.1, -0.2), Vec3::new(0.2, 1.7, 0.2));
    Vec3::new(0.5 + 2.0 * near.x, 0.55 * near.y, 0.5 + 2.0 * near.z)
}

/// A body with two arms, of which one is raised by `angle`: at -1.4 it is one with the body.
fn body(angle: f32, cell: f32) -> Mesh {
    let distance = |p: Vec3| {
        let trunk = ellipsoid(p, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.28, 0.8, 0.2));
        let shoulder = Vec3::new(0.2, 1.3, 0.0);
        let hand = shoulder + 0.6 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        let raised = cone(p, shoulder, hand, 0.1, 0.07);
        let other = cone(p, Vec3::new(-0.2, 1.3, 0.0), Vec3::new(-0.55, 0.75, 0.2), 0.1, 0.07);
        blend(blend(trunk, raised, 0.05), other, 0.05)
    };
    polygonise(Vec3::new(-1.0, 0.0, -0.5), Vec3::new(1.0, 2.2, 0.5), cell, distance)
}

/// Something else, of about as much surface.
fn other(lean: f32, cell: f32) -> Mesh {
    let distance = |p: Vec3| {
        let ring = Vec3::new((p.x * p.x + p.z * p.z).sqrt() - 0.42, p.y - 0.5 - lean * p.x, 0.0).length() - 0.13;
        ring.min(p.distance(Vec3::new(0.0, 0.5, 0.0)) - 0.1)
    };
    polygonise(Vec3::new(-0.7, 0.1, -0.7), Vec3::new(0.7, 0.9, 0.7), cell, distance)
}

fn take(angles: &[f32]) -> Vec<Mesh> {
    angles.iter().enumerate().map(|(k, &angle)| body(angle, 0.065 + 0.001 * k as f32)).collect()
}

/// All frames on that of `root`.
fn first(source: &Takes, root: usize) -> (Survey, Group, RegisterOptions) {
    let (mut options, job) = (RegisterOptions::default(), Job::silent());
    options.template = Some(root);
    let survey = survey(source, &options, &job).unwrap();
    let (tree, template) = (survey.tree(Some(root)), template(source, root).unwrap().unwrap());
    let registered = register(source, &survey, &tree, &template, &options, &job, &|_: Found<()>| Ok(())).unwrap();
    options.template = None;
    (survey, Group { template, root, registered }, options)
}

/// Frames as they are written, each of which must come after its parent.
fn written(source: &Takes, group: &Group, options: &RegisterOptions) -> BTreeSet<usize> {
    let seen = Mutex::new(BTreeSet::new());
    let emit = |found: Found<()>| {
        let mut seen = seen.lock().unwrap();
        assert!(found.tracked.parent.is_none_or(|parent| seen.contains(&parent)), "{:?}", found.tracked);
        assert_eq!(found.pose.len(), group.template.surface.mesh.positions.len());
        seen.insert(found.tracked.frame);
        Ok(())
    };
    write(source, group, |_| true, options, &Job::silent(), &emit).unwrap();
    seen.into_inner().unwrap()
}

fn united(source: &Takes, survey: &Survey, group: Group, options: &RegisterOptions) -> United {
    unite(source, survey, group, options, &Job::silent()).unwrap()
}

#[test]
fn frames_that_were_lost_are_reached_through_a_template_of_their_own() {
    let source = Takes(vec![take(&[-0.3, -0.2, -0.1]), take(&[0.8, 0.7])]);
    let (survey, mut group, options) = first(&source, 0);
    assert_eq!(group.frames().len(), 5, "{:?}", group.registered.lost);
    // As if the second take had been lost: its template is brought onto the first take, and the first template goes the way back.
    let known = group.registered.poses.clone();
    group.retain(|frame| frame < 3);
    let fault = Lost::Untracked(Fault::Uncovered, Fit::default());
    group.registered.lost = LATER.map(|frame| (frame, fault)).collect();
    let found = united(&source, &survey, group, &options);
    assert!(found.others.is_empty() && found.main.registered.lost.is_empty(), "{:?}", found.main.registered.lost);
    assert_eq!((found.main.root, found.main.frames().len()), (0, 5));
    for tracked in &found.main.registered.tracked {
        let through = tracked.through.is_some_and(|through| through >= 3);
        assert_eq!(through, tracked.frame >= 3, "{tracked:?}");
    }
    // The trunk, which stands still, lies where it lay; so it does by what was tracked without another template.
    let own = &found.main.template.surface.mesh.positions;
    for frame in LATER {
        let off = |poses: &BTreeMap<usize, Vec<Vec3>>| {
            let off = own.iter().zip(&poses[&frame]).filter(|(p, _)| p.y < 1.0 && p.x.abs() < 0.25);
            let off: Vec<f32> = off.map(|(a, b)| a.distance(*b)).collect();
            off.iter().sum::<f32>() / off.len() as f32
        };
        let (found, known) = (off(&found.main.registered.poses), off(&known));
        println!("frame {frame}: {found} m, {known} m");
        assert!(found < 0.012 && found < known + 0.004, "frame {frame}: {found} m, {known} m");
    }
    assert_eq!(written(&source, &found.main, &options).len(), 5);
}

#[test]
fn a_template_that_covers_all_takes_the_place_of_one_that_does_not() {
    // In the first take the arm is one with the body, and the template is one of its frames.
    let source = Takes(vec![take(&[-1.5, -1.49, -1.48]), take(&[0.5, 0.4])]);
    let (survey, group, options) = first(&source, 0);
    assert_eq!(group.untracked(), [3, 4], "{:?}", group.registered);
    let found = united(&source, &survey, group, &options);
    assert!(found.main.root >= 3 && found.main.registered.lost.is_empty(), "{:?}", found.main.registered);
    assert!(found.others.is_empty());
    let of_first: Vec<usize> =
        found.main.registered.tracked.iter().filter(|tracked| tracked.through == Some(0)).map(|t| t.frame).collect();
    assert_eq!(of_first, [0, 1, 2]);
    assert_eq!(written(&source, &found.main, &options).len(), 5);
}

#[test]
fn what_cannot_be_joined_stays_on_a_template_of_its_own() {
    let others = (0..2).map(|k| other(0.1 * k as f32, 0.05 + 0.001 * k as f32)).collect();
    let source = Takes(vec![take(&[-0.3, -0.2, -0.1]), others]);
    let (survey, group, options) = first(&source, 1);
    assert_eq!(group.untracked(), [3, 4], "{:?}", group.registered);
    let found = united(&source, &survey, group, &options);
    assert_eq!((found.main.root, found.main.frames()), (1, vec![0, 1, 2]));
    assert_eq!(found.main.untracked(), [3, 4]);
    let [other] = &found.others[..] else { panic!("{} others", found.others.len()) };
    assert_eq!(other.frames(), [3, 4]);
    assert_eq!(written(&source, other, &options).len(), 2);
}
