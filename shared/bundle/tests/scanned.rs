//! Frames as they were scanned: they come back, page by page as well as whole, and what is damaged is refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;
mod forge;

use std::collections::BTreeSet;

use actor::files::Files;
use actor::surface::{Image, ImageFormat};
use bundle::{
    BundleInput, BundleReader, Extras, ScannedCorner, ScannedFrames, ScannedGroup, SectionKind, code_group,
    encode_with_extras, ordered, validate,
};
use captures::{cloth, graph};
use forge::{assembled, raw_sections};
use glam::Vec3;
use proptest::prelude::*;

const STEP: f32 = 1.0 / 4096.0;

fn image(seed: u8, bytes: usize) -> Image {
    let bytes = (0..bytes).map(|at| (at as u8).wrapping_mul(seed)).collect();
    Image { format: ImageFormat::Jpeg, width: 64, height: 32, bytes }
}

/// A bumpy grid of `side` squared quads with a seam, scanned in `frames` frames from `first_frame` on.
fn grid(first_frame: u32, side: u32, frames: usize) -> ScannedGroup {
    let count = side + 1;
    let mut corners: Vec<ScannedCorner> = (0..count * count)
        .map(|vertex| ScannedCorner {
            vertex,
            uv: [(vertex % count) as f32, (vertex / count) as f32].map(|x| x / side as f32),
        })
        .collect();
    let mut triangles = Vec::new();
    for at in 0..side * side {
        let a = at / side * count + at % side;
        let [mut a, b, mut c, d] = [a, a + 1, a + count, a + count + 1];
        if at % side == side / 2 {
            // What lies right of the seam has corners of its own along it.
            for corner in [&mut a, &mut c] {
                corners.push(ScannedCorner { uv: [0.5, corners[*corner as usize].uv[1]], ..corners[*corner as usize] });
                *corner = corners.len() as u32 - 1;
            }
        }
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    let place = |frame: usize| {
        move |vertex: u32| {
            let (x, y) = ((vertex % count) as f32, (vertex / count) as f32);
            Vec3::new(x, y, (0.7 * x + 0.3 * frame as f32).sin() + 0.1 * frame as f32) * 0.01
        }
    };
    ScannedGroup {
        first_frame,
        corners,
        triangles,
        poses: (0..frames).map(|frame| (0..count * count).map(place(frame)).collect()).collect(),
        colours: Vec::new(),
        images: [image(3, 500), image(5, 300)].into_iter().take(frames).collect(),
        worn: (0..frames as u32).map(|frame| frame.min(1)).collect(),
    }
}

/// The same, without images, with colours of vertices.
fn coloured(first_frame: u32) -> ScannedGroup {
    let group = grid(first_frame, 5, 1);
    let colours = (0..group.poses[0].len()).map(|vertex| [vertex as u8, 7, 255 - vertex as u8]).collect();
    ScannedGroup { colours, images: Vec::new(), worn: Vec::new(), ..group }
}

fn frames(groups: &[ScannedGroup]) -> ScannedFrames {
    let mut all = ScannedFrames::default();
    groups.iter().for_each(|group| all.push(code_group(group, STEP).unwrap()));
    all
}

fn bundle_of(groups: &[ScannedGroup]) -> Vec<u8> {
    bundle_with(&frames(groups))
}

fn bundle_with(scanned: &ScannedFrames) -> Vec<u8> {
    let capture = cloth(4, 3, &[8, 5]);
    let graph = graph(&capture.timeline);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 0.001,
        poisson_order: None,
        generator: "reprise test".into(),
    };
    let mut extras = Extras::default();
    extras.scanned = Some(scanned);
    encode_with_extras(&input, &[], &Files::default(), &extras).unwrap().0
}

#[test]
fn groups_that_are_elsewhere_are_appended() {
    let groups = [grid(0, 4, 2), coloured(3)];
    let mut told = ScannedFrames::default();
    let mut behind = Vec::new();
    for group in &groups {
        let coded = code_group(group, STEP).unwrap();
        told.push_elsewhere(&coded);
        behind.extend(coded.bytes);
    }
    assert_eq!(told.bytes(), behind.len() as u64);
    let bytes = [bundle_with(&told), behind].concat();
    assert!(bytes == bundle_of(&groups));
}

/// Every triangle by the places, texture coordinates and colours of its corners, whatever they are numbered.
fn soup(group: &ScannedGroup) -> BTreeSet<Vec<u64>> {
    let corner = |&number: &u32| {
        let ScannedCorner { vertex, uv } = group.corners[number as usize];
        let vertex = vertex as usize;
        let near = |x: f32| (f64::from(x) / f64::from(STEP)).round() as i64 as u64;
        let mut told: Vec<u64> = group.poses.iter().flat_map(|pose| pose[vertex].to_array().map(near)).collect();
        if !group.worn.is_empty() {
            told.extend(uv.map(|x| (x * 1740.0).round() as u64));
        }
        told.extend(group.colours.get(vertex).into_iter().flatten().map(|&channel| u64::from(channel)));
        told
    };
    let turned = |triangle: &[u32; 3]| {
        let corners: Vec<Vec<u64>> = triangle.iter().map(corner).collect();
        (0..3).map(|turn| [0, 1, 2].map(|k| corners[(k + turn) % 3].clone()).concat()).min().unwrap()
    };
    group.triangles.iter().map(turned).collect()
}

fn assert_same(read: &ScannedGroup, written: &ScannedGroup) {
    assert_eq!(read.first_frame, written.first_frame);
    assert_eq!(read.worn, written.worn);
    assert_eq!(read.triangles, ordered(written).triangles);
    assert_eq!(soup(read), soup(written));
    for (read, written) in read.poses.iter().zip(&ordered(written).poses) {
        for (read, written) in read.iter().zip(written) {
            assert!((*read - *written).abs().max_element() <= 0.5001 * STEP);
        }
    }
}

#[test]
fn scanned_frames_come_back() {
    let groups = [grid(0, 12, 3), coloured(4), grid(6, 3, 1), grid(9, 4, 4)];
    let bytes = bundle_of(&groups);
    assert!(validate(&bytes).iter().all(|finding| finding.code == "no-order"));
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!(reader.header().unwrap().minor, 15);
    let index = reader.scanned().unwrap();
    assert_eq!(index.frame_count(), 9);
    let places: Vec<Option<(u32, u32)>> = (0..14).map(|frame| index.place_of(frame)).collect();
    let expected = [Some((0, 0)), Some((0, 1)), Some((0, 2)), None, Some((1, 0)), None, Some((2, 0)), None, None];
    assert_eq!(places[..9], expected);
    assert_eq!(places[9..], [Some((3, 0)), Some((3, 1)), Some((3, 2)), Some((3, 3)), None]);
    for (ordinal, group) in (0..).zip(&groups) {
        let section = reader.scanned_group(ordinal).unwrap();
        let read = index.read(ordinal, section).unwrap();
        assert_same(&ScannedGroup { images: group.images.clone(), ..read }, group);
        let images = index.open(ordinal, section).unwrap().images;
        let images: Vec<&[u8]> = images.into_iter().map(|range| &section[range]).collect();
        assert_eq!(images, group.images.iter().map(|image| image.bytes.as_slice()).collect::<Vec<_>>());
    }
}

#[test]
fn a_page_plays_before_the_groups_have_come_and_fetches_each_by_itself() {
    let groups = [grid(0, 12, 3), coloured(4), grid(6, 3, 1)];
    let bytes = bundle_of(&groups);
    let whole = BundleReader::from_bytes(&bytes).unwrap();
    let sections = whole.sections();
    let entries: Vec<_> = sections.iter().filter(|section| section.name == "scanned-group").collect();
    // Nothing lies behind them.
    assert_eq!(entries.last().map(|last| last.offset + last.stored), whole.bytes_total());
    let mut page = BundleReader::new();
    let start = entries[0].offset as usize;
    page.push(&bytes[..start - 1]).unwrap();
    assert!(!page.is_playable());
    page.push(&bytes[start - 1..start]).unwrap();
    assert!(page.is_playable() && !page.is_complete() && page.finish().is_err());
    assert_eq!(page.scanned_group(0), None);
    for (ordinal, (entry, group)) in (0..).zip(entries.iter().zip(&groups)) {
        let bytes = &bytes[entry.offset as usize..][..entry.stored as usize];
        let read = page.scanned().unwrap().read(ordinal, page.check_scanned_group(ordinal, bytes).unwrap()).unwrap();
        assert_same(&read, group);
        assert!(page.check_scanned_group(ordinal, &bytes[1..]).is_err());
        let mut damaged = bytes.to_vec();
        damaged[7] ^= 1;
        assert!(page.check_scanned_group(ordinal, &damaged).is_err());
    }
    assert!(page.check_scanned_group(3, &bytes).is_err());
}

#[test]
fn older_readers_skip_them() {
    let bytes = bundle_of(&[grid(0, 3, 2)]);
    let entry = |number: u16| {
        let at = (48..).step_by(40).find(|&at| bytes[at..at + 2] == number.to_le_bytes()).unwrap();
        bytes[at + 2]
    };
    assert_eq!((entry(SectionKind::Scanned.number()), entry(SectionKind::ScannedGroup.number())), (1, 1));
    // Without them the bundle is as it always was.
    let mut plain = raw_sections(&bytes);
    plain.retain(|section| ![40, 41].contains(&section.number));
    assert_eq!(validate(&assembled(&plain)).iter().filter(|finding| finding.code == "inconsistent").count(), 0);
}

#[test]
fn groups_that_do_not_fit_are_not_written() {
    let good = grid(0, 3, 2);
    let refused = |group: &ScannedGroup| code_group(group, STEP).unwrap_err().to_string();
    assert!(refused(&ScannedGroup { triangles: Vec::new(), ..good.clone() }).contains("no surface"));
    assert!(refused(&ScannedGroup { triangles: vec![[0, 1, 99]], ..good.clone() }).contains("without a corner"));
    assert!(refused(&ScannedGroup { colours: vec![[0; 3]; 16], ..good.clone() }).contains("images besides"));
    assert!(refused(&ScannedGroup { poses: vec![good.poses[0].clone(); 65], ..good.clone() }).contains("too many"));
    let mut far = good.clone();
    far.poses[1][2].y = 1e5;
    assert!(refused(&far).contains("vertex 2 of frame 1"));
    // Groups that overlap, or reach beyond the capture, are told when the bundle is written.
    let capture = cloth(4, 3, &[8]);
    let graph = graph(&capture.timeline);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 0.001,
        poisson_order: None,
        generator: String::new(),
    };
    for groups in [[grid(0, 3, 2), grid(1, 3, 1)], [grid(0, 3, 2), grid(7, 3, 2)]] {
        let scanned = frames(&groups);
        let mut extras = Extras::default();
        extras.scanned = Some(&scanned);
        let refused = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap_err();
        assert!(refused.to_string().contains("index of scanned frames"), "{refused}");
    }
}

#[test]
fn what_is_damaged_is_refused_or_is_another_group() {
    let bytes = bundle_of(&[grid(0, 4, 2), coloured(5)]);
    let sections = raw_sections(&bytes);
    let at = |number: u16| sections.iter().position(|section| section.number == number).unwrap();
    for number in [40, 41] {
        let index = at(number);
        for place in 0..sections[index].raw.len() {
            let mut forged = sections.clone();
            forged.iter_mut().for_each(|section| section.may_be_skipped = section.number >= 32);
            forged[index].raw[place] ^= 0x55;
            let _ = validate(&assembled(&forged));
            forged[index].raw.truncate(place);
            let told = validate(&assembled(&forged));
            assert!(
                told.iter().any(|finding| ["inconsistent", "damaged-scan"].contains(&finding.code)),
                "{place}: {told:?}"
            );
        }
    }
    // Something behind the groups is refused.
    let mut forged = sections.clone();
    forged.swap(at(41), at(40) - 1);
    assert!(BundleReader::from_bytes(&assembled(&forged)).is_err());
    let mut forged = sections;
    forged.push(forge::Section { number: 127, may_be_skipped: true, ordinal: 0, raw: vec![1] });
    let refused = BundleReader::from_bytes(&assembled(&forged)).unwrap_err();
    assert!(refused.to_string().contains("behind its groups"), "{refused}");
}

#[test]
fn a_smooth_mesh_costs_little() {
    let coded = code_group(&ScannedGroup { images: Vec::new(), worn: Vec::new(), ..grid(0, 60, 1) }, STEP).unwrap();
    let vertices = f64::from(coded.head.vertices);
    let bytes = coded.bytes.len() as f64 / vertices;
    assert!(bytes < 2.5, "{bytes:.2} bytes a vertex");
    let four = code_group(&ScannedGroup { images: Vec::new(), worn: Vec::new(), ..grid(0, 60, 4) }, STEP).unwrap();
    let more = (four.bytes.len() as f64 / vertices - bytes) / 3.0;
    assert!(more < 1.5, "{more:.2} bytes a vertex of each further frame");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever the triangles are: loose, folded, doubled.
    #[test]
    fn any_triangles_come_back(
        triangles in prop::collection::vec([0..30_u32, 0..30_u32, 0..30_u32], 1..80),
        vertices in prop::collection::vec(0..20_u32, 30),
        places in prop::collection::vec([-3000..3000_i32, -3000..3000_i32, -3000..3000_i32], 40),
        coloured in any::<bool>(),
    ) {
        let corners = vertices.iter().zip(0..).map(|(&vertex, k)| ScannedCorner { vertex, uv: [k as f32 / 29.0, 0.25] });
        let pose = |at: usize| places[at..at + 20].iter().map(|p| Vec3::from_array(p.map(|x| x as f32 * STEP))).collect();
        let group = ScannedGroup {
            first_frame: 2,
            corners: corners.collect(),
            triangles,
            poses: vec![pose(0), pose(20)],
            colours: if coloured { (0..20).map(|k| [k, 200, 9 * k]).collect() } else { Vec::new() },
            images: if coloured { Vec::new() } else { vec![image(1, 9)] },
            worn: if coloured { Vec::new() } else { vec![0, 0] },
        };
        let scanned = frames(std::slice::from_ref(&group));
        let bytes = code_group(&group, STEP).unwrap().bytes;
        let read = scanned.index().read(0, &bytes).unwrap();
        assert_same(&ScannedGroup { images: group.images.clone(), ..read }, &group);
    }
}
