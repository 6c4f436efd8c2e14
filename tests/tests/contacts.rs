//! What is found to stand does stand.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

use actor::contacts::Contacts;
use actor::timeline::Timeline;
use capture_io::import::{ImportOptions, import};
use fixtures::{Captured, crane_and_jumping};
use job::Job;
use performer::{PerformerOptions, write_performer};
use pipeline::contacts::contacts;

/// Metres that a part moves on average from one frame to the next while it stands in both, and how often that is.
fn slide(timeline: &Timeline, contacts: &Contacts) -> (f32, usize) {
    let (mut sum, mut count) = (0.0, 0);
    for sequence in timeline.sequences() {
        for frame in sequence.first_frame..sequence.end_frame() - 1 {
            for (before, after) in contacts.of(frame).iter().zip(contacts.of(frame + 1)) {
                if before.weight.min(after.weight) > 0.9 {
                    sum += before.point.distance(after.point);
                    count += 1;
                }
            }
        }
    }
    (sum / count.max(1) as f32, count)
}

#[test]
fn the_performer_stands_on_its_feet() {
    let folder = tempfile::tempdir().unwrap();
    let small = PerformerOptions { frames: 400, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&small, folder.path(), &|_| ()).unwrap();
    let inputs = [folder.path().to_str().unwrap().to_owned()];
    let capture = import(&inputs, &ImportOptions::default(), &Job::silent()).unwrap().capture;
    let (contacts, _) = contacts(&capture.topology, &capture.timeline, &capture.poses);
    let (slide, count) = slide(&capture.timeline, &contacts);
    println!("{} parts, {count} steps that stand, {:.2} mm", contacts.parts(), slide * 1e3);
    assert!((2..=4).contains(&contacts.parts()), "two feet, of one or two parts each: {}", contacts.parts());
    assert!(slide < 0.001, "{slide}");

    // Whoever is idle stands on both feet; whoever jumps does not, for a while.
    let weight = |frame: u32| contacts.of(frame).iter().map(|contact| contact.weight).fold(f32::MAX, f32::min);
    let named = |name: &str| capture.timeline.sequences().iter().find(|sequence| sequence.name == name).unwrap();
    let frames = |name: &str| named(name).first_frame..named(name).end_frame();
    assert!(frames("idle").filter(|&frame| weight(frame) > 0.9).count() * 10 > 9 * frames("idle").len());
    let aloft = |frame: &u32| contacts.of(*frame).iter().all(|contact| contact.weight == 0.0);
    assert!(frames("jump").filter(aloft).count() > 3);
}

#[test]
#[ignore = "reads ../shared/data"]
fn captured_feet_are_found() {
    let Captured { topology, poses, timeline } = crane_and_jumping(1);
    let (contacts, _) = contacts(&topology, &timeline, &poses);
    let (slide, count) = slide(&timeline, &contacts);
    println!("{} parts, {count} steps that stand, {:.2} mm", contacts.parts(), slide * 1e3);
    assert!(contacts.parts() >= 1 && count > 30);
    assert!(slide < 0.004, "{slide}");
}
