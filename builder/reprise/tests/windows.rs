//! `--mode windows`: a small scan is packed with its frames as they were scanned.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;

use actor::surface::ImageFormat;
use bundle::{BundleReader, ScannedGroup, validate};
use geometry::mesh::Mesh;
use geometry::polygonise::polygonise;
use geometry::sdf::{blend, cone, ellipsoid};
use glam::{Quat, Vec3};
use reprise::pack::{AppearanceChoice, PackError, PackOptions, PackReport, ScanMode, pack};
use reprise::{Job, PoseSource};

/// A body with an arm that is raised by `angle`.
fn body(angle: f32, cell: f32) -> Mesh {
    let distance = |p: Vec3| {
        let trunk = ellipsoid(p, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.28, 0.8, 0.2));
        let shoulder = Vec3::new(0.2, 1.3, 0.0);
        let hand = shoulder + 0.6 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        blend(trunk, cone(p, shoulder, hand, 0.1, 0.07), 0.05)
    };
    polygonise(Vec3::new(-1.0, 0.0, -0.5), Vec3::new(1.0, 2.2, 0.5), cell, distance)
}

/// As an OBJ file with texture coordinates, which are places of `seen` from the front, and a crumb that floats beside.
fn write(path: &Path, mesh: &Mesh, seen: &[Vec3]) {
    let mut text = String::new();
    for (p, at) in mesh.positions.iter().zip(seen) {
        text.push_str(&format!("v {} {} {}\nvt {} {}\n", p.x, p.y, p.z, at.x / 3.0 + 0.5, at.y / 3.0));
    }
    let count = mesh.positions.len();
    text.push_str("v 3 0 0\nv 3.1 0 0\nv 3 0.1 0\nvt 0 0\nvt 0 0\nvt 0 0\n");
    for triangle in mesh.triangles.iter().map(|t| t.map(|v| v as usize + 1)).chain([[count + 1, count + 2, count + 3]])
    {
        let [a, b, c] = triangle;
        text.push_str(&format!("f {a}/{a} {b}/{b} {c}/{c}\n"));
    }
    fs::write(path, text).unwrap();
}

/// Frames 0 to 3 are two meshes that lean, frames 4 to 6 are a mesh each, and frame 5 is another size.
fn meshes() -> Vec<(Mesh, Vec<Vec3>)> {
    let lean = |mut mesh: Mesh, by: f32| {
        let before = mesh.positions.clone();
        mesh.positions.iter_mut().for_each(|p| *p = Quat::from_rotation_x(by * p.y) * *p);
        (mesh, before)
    };
    let mesh = |k: usize| match k {
        0..=3 => lean(body(-0.3 + 0.1 * (k / 2) as f32, 0.06 + 0.001 * (k / 2) as f32), 0.03 * (k % 2) as f32),
        5 => {
            let mut large = body(0.2, 0.06);
            large.positions.iter_mut().for_each(|p| *p *= 3.0);
            lean(large, 0.0)
        }
        _ => lean(body(0.05 * k as f32, 0.06 + 0.001 * k as f32), 0.0),
    };
    (0..8).map(mesh).collect()
}

fn scan(folder: &Path) -> Vec<String> {
    fs::create_dir_all(folder).unwrap();
    for (k, (mesh, seen)) in meshes().iter().enumerate() {
        write(&folder.join(format!("frame_{k:03}.obj")), mesh, seen);
        let colour = |x: u32, y: u32| image::Rgb([4 * x as u8, 255 - 4 * y as u8, 30 * k as u8]);
        image::RgbImage::from_fn(64, 64, colour).save(folder.join(format!("texture_{k:03}.png"))).unwrap();
    }
    vec![folder.to_string_lossy().into_owned()]
}

fn windows() -> PackOptions {
    let mut options = PackOptions::default();
    options.appearance = AppearanceChoice::Static;
    options.mode = ScanMode::Windows;
    options
}

fn packed(inputs: &[String], threads: usize) -> (Vec<u8>, PackReport) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| pack(inputs, &windows(), &Job::silent())).unwrap()
}

#[test]
fn a_scan_is_packed_with_its_own_frames() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"));
    let (bytes, report) = packed(&inputs, 1);
    assert!(validate(&bytes).iter().all(|finding| finding.severity < bundle::Severity::Error));
    let mut reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, report.capture.frames), (15, 7));
    let index = reader.scanned().unwrap().clone();
    // Frame 5 of the scan is lost: what the capture has as frame 5 is the scan's frame 6.
    let groups: Vec<(u32, u32)> = index.groups.iter().map(|head| (head.first_frame, head.frames)).collect();
    assert_eq!(groups, [(0, 2), (2, 2), (4, 1), (5, 1), (6, 1)]);
    let summary = report.scanned.unwrap();
    assert_eq!((summary.frames, summary.groups), (7, 5));
    let stored = report.bundle.sections.iter().find(|section| section.name == "scanned-group").unwrap().stored;
    assert_eq!(stored as f64 / 7.0, summary.bytes_per_frame);
    let meshes = meshes();
    for (frame, of_scan) in (0..).zip([0, 1, 2, 3, 4, 6, 7_usize]) {
        let (ordinal, place) = index.place_of(frame).unwrap();
        let section = reader.scanned_group(ordinal).unwrap().to_vec();
        let group = index.read(ordinal, &section).unwrap();
        let mesh = &meshes[of_scan].0;
        // All of it but the crumb.
        assert_eq!(group.triangles.len(), mesh.triangles.len(), "frame {frame}");
        let (low, high) = bounds(&group.poses[place as usize]);
        let (expected_low, expected_high) = bounds(&mesh.positions);
        assert!((low - expected_low).abs().max_element() < 0.001, "frame {frame} is elsewhere");
        assert!((high - expected_high).abs().max_element() < 0.001, "frame {frame} is elsewhere");
        check_corners(&group, place);
        check_image((&index.open(ordinal, &section).unwrap().images, &section), &group, place, of_scan);
        // The registered mesh stands in the same place.
        let mut pose = vec![Vec3::ZERO; reader.topology().unwrap().vertex_count()];
        reader.read(frame, &mut pose).unwrap();
        let (own_low, own_high) = bounds(&pose);
        assert!((low - own_low).abs().max_element() < 0.05 && (high - own_high).abs().max_element() < 0.05);
    }
    let (other, _) = packed(&inputs, 2);
    assert!(other == bytes, "bytes differ with the number of threads");
}

/// Texture coordinates are where the vertex is seen from the front, as they were written, v turned.
fn check_corners(group: &ScannedGroup, place: u32) {
    // Leaning does not move anything sideways.
    for corner in &group.corners {
        let p = group.poses[place as usize][corner.vertex as usize];
        assert!((corner.uv[0] - (p.x / 3.0 + 0.5)).abs() < 0.001, "{corner:?} at {p}");
    }
}

/// The image of a frame is the one that was beside it.
fn check_image(
    (images, section): (&[std::ops::Range<usize>], &[u8]),
    group: &ScannedGroup,
    place: u32,
    of_scan: usize,
) {
    let range = images[group.worn[place as usize] as usize].clone();
    let image = image::load_from_memory_with_format(&section[range], image::ImageFormat::Jpeg).unwrap().into_rgb8();
    assert_eq!(image.dimensions(), (64, 64));
    let [r, g, b] = image.get_pixel(32, 16).0.map(i32::from);
    let wanted = [128, 191, 30 * of_scan as i32];
    assert!((r - wanted[0]).abs() + (g - wanted[1]).abs() + (b - wanted[2]).abs() < 24, "{r} {g} {b}, not {wanted:?}");
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

#[test]
fn what_is_no_scan_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = body(0.1, 0.1);
    for k in 0..3 {
        write(&folder.path().join(format!("frame_{k}.obj")), &mesh, &mesh.positions);
    }
    let refused = pack(&[folder.path().to_string_lossy().into_owned()], &windows(), &Job::silent()).unwrap_err();
    assert!(matches!(refused, PackError::Option(_)) && refused.to_string().contains("--mode windows"), "{refused}");
    assert_eq!(refused.code(), "E_OPTION");
}

#[test]
fn colours_of_vertices_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    for k in 0..2 {
        let mesh = body(0.1 * k as f32, 0.07 + 0.002 * k as f32);
        let mut text = String::new();
        for p in &mesh.positions {
            text.push_str(&format!("v {} {} {} {} 0.5 0.25\n", p.x, p.y, p.z, p.y / 2.2));
        }
        mesh.triangles.iter().for_each(|[a, b, c]| text.push_str(&format!("f {} {} {}\n", a + 1, b + 1, c + 1)));
        fs::write(folder.path().join(format!("frame_{k}.obj")), text).unwrap();
    }
    let (bytes, _) = packed(&[folder.path().to_string_lossy().into_owned()], 2);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let index = reader.scanned().unwrap();
    assert_eq!(index.groups.len(), 2);
    let group = index.read(1, reader.scanned_group(1).unwrap()).unwrap();
    assert!(index.groups[1].coloured && index.groups[1].images.is_empty());
    for (p, colour) in group.poses[0].iter().zip(&group.colours) {
        assert!((f32::from(colour[0]) - p.y / 2.2 * 255.0).abs() < 1.5 && colour[1..] == [128, 64], "{p} {colour:?}");
    }
    let formats = index.groups.iter().flat_map(|head| &head.images).map(|image| image.0);
    assert!(formats.into_iter().all(|format| format == ImageFormat::Jpeg));
}
