//! The performer as a scan: its truth is what it says.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;

use capture_io::import::{ImportOptions, ScannedFrame, scans};
use glam::Vec3;
use performer::{PerformerOptions, ScannedOptions, write_scanned};

/// Where a vertex of a scan lies on the figure: a triangle and barycentric coordinates, and metres off.
type Truth = (u32, Vec3, f32);

fn truth(path: &Path) -> Vec<Truth> {
    let bytes = fs::read(path).unwrap();
    let float = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap());
    let of = |b: &[u8]| {
        let weights = Vec3::new(float(&b[4..8]), float(&b[8..12]), float(&b[12..16]));
        (u32::from_le_bytes(b[..4].try_into().unwrap()), weights, float(&b[16..]))
    };
    bytes.chunks_exact(20).map(of).collect()
}

fn at(frame: &ScannedFrame, (triangle, weights, _): Truth) -> Vec3 {
    let [a, b, c] = frame.triangles[triangle as usize].map(|v| frame.positions[v as usize]);
    a * weights.x + b * weights.y + c * weights.z
}

fn input(path: &Path) -> [String; 1] {
    [path.to_string_lossy().into_owned()]
}

#[test]
fn the_truth_of_a_scan_is_where_its_vertices_are() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let options = PerformerOptions { frames: 9, vertices: 1500, texture_size: 128, ..PerformerOptions::default() };
    let scanned = ScannedOptions { group: 1, noise: 0.001 };
    let summary = write_scanned(&options, &scanned, &f.join("scan"), &|_| {}).unwrap();
    write_scanned(&options, &scanned, &f.join("again"), &|_| {}).unwrap();
    let [scan, figure] =
        ["scan", "scan/truth"].map(|name| scans(&input(&f.join(name)), &ImportOptions::default()).unwrap());
    assert_eq!((scan.frame_count(), figure.frame_count()), (9, 9));
    let mut counts = Vec::new();
    for frame in 0..9 {
        let (take, number) = scan.place_of(frame).unwrap();
        let name = &summary.sequences[take].0;
        let points = truth(&f.join(format!("scan/truth/scan/{name}/frame_{number:05}.bin")));
        let (seen, figure) = (scan.read(frame).unwrap(), figure.read(frame).unwrap());
        assert_eq!(points.len(), seen.positions.len());
        let off = points
            .iter()
            .zip(&seen.positions)
            .map(|(&point, p)| (at(&figure, point).distance(*p) - point.2.abs()).abs());
        assert!(off.fold(0.0, f32::max) < 1e-4, "frame {frame}");
        let near = points.iter().filter(|point| point.2.abs() < 0.006).count();
        assert!(10 * near > 9 * points.len(), "frame {frame}: {near} of {}", points.len());
        assert!(seen.texture.is_some() && seen.uvs.len() == seen.triangles.len());
        counts.push(seen.triangles.len());
        let file = format!("{name}/frame_{number:05}.ply");
        assert_eq!(fs::read(f.join("scan").join(&file)).unwrap(), fs::read(f.join("again").join(&file)).unwrap());
    }
    counts.dedup();
    assert!(counts.len() > 6, "{counts:?}");
}
