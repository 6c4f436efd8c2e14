//! Work that is stopped goes on where it was, and comes to the same bytes.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use job::work::WorkFolder;
use job::{Job, Progress};
use performer::{Artefacts, PerformerOptions, write_performer};
use reprise::pack::{PackError, PackOptions, pack};

/// A performer with textures of its own in every frame, some of them with holes.
fn capture(folder: &Path) -> Vec<String> {
    let artefacts = Artefacts { drift: true, light: true, holes: true, ..Artefacts::default() };
    let options =
        PerformerOptions { frames: 30, vertices: 1_500, texture_size: 128, artefacts, ..PerformerOptions::default() };
    write_performer(&options, folder, &|_| ()).unwrap();
    vec![folder.to_str().unwrap().to_owned()]
}

#[test]
fn what_was_stopped_goes_on_and_comes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = capture(&folder.path().join("performer"));
    let options = PackOptions::default();
    let plain = pack(&inputs, &options, &Job::silent()).unwrap().0;

    let work = WorkFolder::open(&folder.path().join("work")).unwrap();
    let mut attempts = 0;
    let bytes = loop {
        // Each attempt is stopped a little later than the one before.
        let (told, limit) = (AtomicU32::new(0), 3 + 23 * attempts);
        let report = |_: Progress| match told.fetch_add(1, Ordering::Relaxed) < limit {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        };
        match pack(&inputs, &options, &Job::new(&report).with_work(Some(&work))) {
            Ok((bytes, _)) => break bytes,
            Err(error) => assert!(error.is_stopped(), "{error}"),
        }
        attempts += 1;
    };
    assert!(attempts > 3, "{attempts}");
    assert!(bytes == plain, "another bundle after {attempts} interruptions");

    // Damage is noticed, and made good.
    for entry in std::fs::read_dir(work.root()).unwrap() {
        for file in std::fs::read_dir(entry.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let mut bytes = std::fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            if let Some(byte) = bytes.get_mut(middle) {
                *byte ^= 0x40;
            }
            std::fs::write(&path, bytes).unwrap();
        }
    }
    assert!(pack(&inputs, &options, &Job::silent().with_work(Some(&work))).unwrap().0 == plain);
}

#[test]
fn another_alpha_measures_nothing_again() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = capture(&folder.path().join("performer"));
    let work = WorkFolder::open(&folder.path().join("work")).unwrap();
    let job = Job::silent().with_work(Some(&work));
    let first = pack(&inputs, &PackOptions::default(), &job).unwrap().0;
    let entries = work.entries().unwrap();
    let mut options = PackOptions::default();
    options.graph.alpha = 0.05;
    let second = pack(&inputs, &options, &job).unwrap().0;
    assert!(first != second && second == pack(&inputs, &options, &Job::silent()).unwrap().0);
    let names = |entries: &[job::work::Entry]| {
        entries.iter().map(|entry| (entry.stage.clone(), entry.hash.clone(), entry.bytes)).collect::<Vec<_>>()
    };
    assert_eq!(names(&work.entries().unwrap()), names(&entries), "something was measured again");
}

#[test]
fn two_packs_at_once_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = capture(&folder.path().join("performer"));
    let work = WorkFolder::open(&folder.path().join("work")).unwrap();
    let packed = || -> Result<Vec<u8>, PackError> {
        Ok(pack(&inputs, &PackOptions::default(), &Job::silent().with_work(Some(&work)))?.0)
    };
    let (one, other) = rayon::join(packed, packed);
    assert!(one.unwrap() == other.unwrap());
}
