//! The faces and the place of the files that a capture came from: exact through a bundle, absent where they say nothing, and
//! refused where they contradict what is drawn.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;
mod forge;

use actor::capture::Capture;
use actor::files::{FaceRun, FileFaces, FilePlace, Files};
use bundle::{BundleInput, BundleReader, EncodeError, SectionKind, encode, encode_with_files, validate};
use captures::{cloth, graph};
use forge::{assembled, raw_sections};
use glam::DVec3;
use kernels::random::mix;
use proptest::prelude::*;

fn written(capture: &Capture, files: &Files) -> Result<Vec<u8>, EncodeError> {
    let graph = graph(&capture.timeline);
    let generator = "reprise test".into();
    let input =
        BundleInput { capture, graph: &graph, first_frame: 0, max_error: 0.001, poisson_order: None, generator };
    encode_with_files(&input, &[], files).map(|(bytes, _)| bytes)
}

/// Any faces over the cloth: every welded vertex was one to three of the files, triangles are joined to polygons here and
/// there, and the faces of its two parts stand in any order.
fn any_files(seed: u64, normals: bool) -> (Capture, Files) {
    let mut drawn = 0;
    let mut below = |bound: u32| {
        drawn += 1;
        (mix(seed, drawn) % u64::from(bound)) as u32
    };
    let mut capture = cloth(5, 4, &[3]);
    let vertex_count = capture.topology.vertex_count() as u32;
    let mut file_vertices: Vec<u32> = (0..vertex_count).collect();
    (0..2 * vertex_count).for_each(|_| file_vertices.push(below(vertex_count)));
    for k in (1..file_vertices.len()).rev() {
        file_vertices.swap(k, below(k as u32 + 1) as usize);
    }
    let members = |vertex: u32| -> Vec<u32> {
        (0..file_vertices.len() as u32).filter(|&v| file_vertices[v as usize] == vertex).collect()
    };
    let surface = &capture.surface;
    let mut faces = FileFaces::default();
    for triangle in &surface.triangles {
        faces.corners.push(triangle.map(|corner| {
            let members = members(surface.corners[corner as usize].vertex);
            members[below(members.len() as u32) as usize]
        }));
        let starts_part = surface.parts.iter().any(|part| part.first_triangle == faces.joined.len() as u32);
        faces.joined.push(!starts_part && below(3) == 0);
        if normals {
            faces.normals.push([0, 1, 2].map(|_| below(3)));
        }
    }
    let mut left: Vec<u32> = surface
        .parts
        .iter()
        .map(|part| {
            let (first, end) = (part.first_triangle as usize, (part.first_triangle + part.triangle_count) as usize);
            faces.joined[first..end].iter().filter(|&&joined| !joined).count() as u32
        })
        .collect();
    while left.iter().any(|&left| left > 0) {
        let part = below(left.len() as u32);
        let count = below(4).min(left[part as usize]);
        if count > 0 {
            left[part as usize] -= count;
            faces.runs.push(FaceRun { part, faces: count });
        }
    }
    capture.vertex_of_file_vertex = file_vertices;
    let place =
        FilePlace { offset: DVec3::new(432_187.0, -3.0, 5_839_921.0), unit: 0.001, z_up: seed.is_multiple_of(2) };
    (capture, Files { faces: Some(faces), place })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_faces_come_back(seed: u64, normals: bool) {
        let (capture, files) = any_files(seed, normals);
        let bytes = written(&capture, &files).unwrap();
        let reader = BundleReader::from_bytes(&bytes).unwrap();
        prop_assert_eq!(reader.file_faces().unwrap(), files.faces);
        prop_assert_eq!(reader.file_place(), files.place);
        prop_assert_eq!(reader.header().unwrap().minor, 9);
        prop_assert!(validate(&bytes).iter().all(|finding| finding.code == "no-order"));
    }

    #[test]
    fn damaged_faces_are_refused_or_faces(seed: u64, at: prop::sample::Index, value: u8) {
        let (capture, files) = any_files(seed, true);
        let mut sections = raw_sections(&written(&capture, &files).unwrap());
        for kind in [SectionKind::FileFaces, SectionKind::FilePlace] {
            let section = sections.iter_mut().find(|section| section.number == kind.number()).unwrap();
            let at = at.index(section.raw.len());
            section.raw[at] = value;
        }
        sections.iter_mut().for_each(|section| section.may_be_skipped = section.number >= 32);
        // Either is an answer; no panic is one.
        if let Ok(reader) = BundleReader::from_bytes(&assembled(&sections)) && let Ok(Some(faces)) = reader.file_faces() {
            let surface = reader.surface().unwrap();
            prop_assert_eq!(faces.check(surface, reader.file_vertices().unwrap()), Ok(()));
        }
    }
}

#[test]
fn cut_off_sections_are_refused() {
    let (capture, files) = any_files(7, true);
    let sections = raw_sections(&written(&capture, &files).unwrap());
    let refused = |kind: SectionKind, length: usize| -> bool {
        let mut sections = sections.clone();
        sections.iter_mut().for_each(|section| section.may_be_skipped = section.number >= 32);
        let section = sections.iter_mut().find(|section| section.number == kind.number()).unwrap();
        section.raw.resize(length, 0);
        let bytes = assembled(&sections);
        match BundleReader::from_bytes(&bytes) {
            Ok(reader) => {
                let told = validate(&bytes).iter().any(|finding| finding.code == "inconsistent");
                reader.file_faces().is_err() && told
            }
            Err(error) => error.to_string().contains("contradicts itself"),
        }
    };
    assert!(
        refused(SectionKind::FilePlace, 32)
            && refused(SectionKind::FilePlace, 34)
            && !refused(SectionKind::FilePlace, 33)
    );
    let whole = sections.iter().find(|section| section.number == SectionKind::FileFaces.number()).unwrap().raw.len();
    assert!((0..whole).all(|length| refused(SectionKind::FileFaces, length)));
    assert!(refused(SectionKind::FileFaces, whole + 1) && !refused(SectionKind::FileFaces, whole));
}

#[test]
fn what_says_nothing_is_not_written_and_what_is_wrong_is_refused() {
    let (capture, files) = any_files(3, false);
    let graph = graph(&capture.timeline);
    let generator = "reprise test".into();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 0.001,
        poisson_order: None,
        generator,
    };
    assert_eq!(written(&capture, &Files::default()).unwrap(), encode(&input).unwrap().0);
    let plain = BundleReader::from_bytes(&encode(&input).unwrap().0).unwrap();
    assert_eq!((plain.file_faces(), plain.file_place()), (Ok(None), FilePlace::default()));

    let mut wrong = files.clone();
    wrong.faces.as_mut().unwrap().runs[0].faces += 1;
    let error = written(&capture, &wrong).unwrap_err().to_string();
    assert!(error.contains("more faces of a part than it has"), "{error}");
}
