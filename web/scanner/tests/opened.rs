//! A group's section is read as the builder wrote it; what is no section is refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

use actor::surface::{Image, ImageFormat};
use bundle::{CodedGroup, ScannedCorner, ScannedGroup, ScannedHead, code_group};
use glam::Vec3;
use scanner::opened::{CORNER_BYTES, Opened};

/// A tetrahedron in two frames, painted or with an image.
fn coded(painted: bool) -> CodedGroup {
    let places = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let corner = |vertex: u32| ScannedCorner { vertex, uv: [vertex as f32 / 4.0, 0.5] };
    let image = Image { format: ImageFormat::Jpeg, width: 8, height: 4, bytes: vec![7; 50] };
    let group = ScannedGroup {
        first_frame: 3,
        corners: (0..4).map(corner).collect(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        poses: vec![places.to_vec(), places.map(|p| p * 2.0).to_vec()],
        colours: if painted { vec![[10, 20, 30], [40, 50, 60], [70, 80, 90], [1, 2, 3]] } else { Vec::new() },
        images: if painted { Vec::new() } else { vec![image] },
        worn: if painted { Vec::new() } else { vec![0, 0] },
    };
    code_group(&group, 1e-3).unwrap()
}

fn words(head: &ScannedHead) -> Vec<u32> {
    head.words().collect()
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(*bytes[4 * at..].first_chunk().unwrap())
}

#[test]
fn a_group_comes_as_the_device_reads_it() {
    let CodedGroup { head, bytes } = coded(true);
    let opened = Opened::read(&words(&head), &bytes).unwrap();
    assert!(opened.images.is_empty());
    assert_eq!((opened.triangles.len(), opened.poses.len()), (12, 24));
    let corners: Vec<&[u8]> = opened.corners.chunks_exact(CORNER_BYTES).collect();
    assert_eq!(corners.len(), 4);
    for corner in corners {
        let vertex = word(corner, 0) as usize;
        let place = |frame: usize| Vec3::from_slice(&opened.poses[12 * frame + 3 * vertex..]);
        assert!((place(1) - 2.0 * place(0)).length() < 4e-3, "vertex {vertex}");
        // Which corner of the tetrahedron it is tells its colour.
        let which = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].iter().position(|p| p.distance(place(0)) < 2e-3).unwrap();
        let colours = [[10, 20, 30, 255], [40, 50, 60, 255], [70, 80, 90, 255], [1, 2, 3, 255]];
        assert_eq!(corner[12..16], colours[which]);
        assert_eq!(corner[16..], [0; 4]);
    }
}

#[test]
fn images_are_found_and_corners_are_white() {
    let CodedGroup { head, bytes } = coded(false);
    let opened = Opened::read(&words(&head), &bytes).unwrap();
    let [first, end] = opened.images[..] else { panic!("{:?}", opened.images) };
    assert_eq!(bytes[first as usize..end as usize], [7; 50]);
    assert!(opened.corners.chunks_exact(CORNER_BYTES).all(|corner| corner[12..16] == [255; 4]));
    let uv = f32::from_bits(word(&opened.corners, 2));
    assert!((uv - 0.5).abs() < 1e-4, "{uv}");
}

#[test]
fn what_is_no_group_is_refused() {
    let CodedGroup { head, bytes } = coded(true);
    let told = words(&head);
    assert!(Opened::read(&told, &bytes[..bytes.len() - 1]).is_err());
    assert!(Opened::read(&told[..4], &bytes).is_err());
    for number in 0..told.len() {
        let mut wrong = told.clone();
        wrong[number] = u32::MAX;
        // Which frame of the capture it is does not matter here, and that it has colours can be said by any number.
        assert_eq!(Opened::read(&wrong, &bytes).is_err(), ![0, 5].contains(&number), "word {number}");
    }
}
