//! A bundle with made-up scanned frames: in each the actor's own mesh, cut anew, a little fatter, in one colour.

use actor::surface::{Image, ImageFormat};
use anyhow::{Context, Result};
use bundle::{GROUP_FRAMES, ScannedCorner, ScannedFrames, ScannedGroup, code_group};
use glam::Vec3;

/// Metres by which a scanned frame stands off the registered mesh.
pub const OFF: f32 = 0.02;
/// So many frames at most: that is enough to look at.
const MOST: u32 = 120;
/// Every so many frames are as if they had been lost.
const LOST: u32 = 10;
/// A picture of one colour, which nothing of the actor has.
const BLUE: &[u8] = include_bytes!("blue.png");

/// Scanned frames for poses over `triangles`, which `read` gives: each third triangle is cut in three. Frames come in groups and
/// alone.
///
/// # Errors
/// A pose that cannot be read.
pub fn scanned(
    triangles: &[[u32; 3]],
    frame_count: u32,
    mut read: impl FnMut(u32) -> Result<Vec<Vec3>>,
) -> Result<ScannedFrames> {
    let mut all = ScannedFrames::default();
    let mut group: Option<ScannedGroup> = None;
    for frame in 0..frame_count.min(MOST) {
        if frame % LOST == LOST - 1 {
            group.take().map(|group| push(&mut all, &group)).transpose()?;
            continue;
        }
        let pose = read(frame)?;
        let next = cut(triangles, frame, &pose);
        match &mut group {
            Some(before) if frame % LOST < 5 && before.poses.len() < GROUP_FRAMES => before.poses.extend(next.poses),
            _ => {
                group.replace(next).map(|group| push(&mut all, &group)).transpose()?;
            }
        }
        if let Some(group) = &mut group {
            group.worn = vec![0; group.poses.len()];
        }
    }
    group.map(|group| push(&mut all, &group)).transpose()?;
    Ok(all)
}

fn push(all: &mut ScannedFrames, group: &ScannedGroup) -> Result<()> {
    all.push(code_group(group, 0.0005).context("the frames cannot be stored")?);
    Ok(())
}

fn cut(triangles: &[[u32; 3]], first_frame: u32, pose: &[Vec3]) -> ScannedGroup {
    let mut normals = vec![Vec3::ZERO; pose.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| pose[vertex as usize]);
        triangle.iter().for_each(|&vertex| normals[vertex as usize] += (b - a).cross(c - a));
    }
    let mut places: Vec<Vec3> = pose.iter().zip(normals).map(|(&p, n)| p + OFF * n.normalize_or_zero()).collect();
    let mut made = Vec::new();
    // Another triangle is cut in each group, so that no two have the same mesh.
    for (number, &[a, b, c]) in (first_frame..).zip(triangles) {
        if number % 3 == 0 {
            let middle = places.len() as u32;
            places.push([a, b, c].iter().map(|&vertex| places[vertex as usize]).sum::<Vec3>() / 3.0);
            made.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
        } else {
            made.push([a, b, c]);
        }
    }
    let corner = |vertex: u32| ScannedCorner { vertex, uv: [0.25, 0.75] };
    ScannedGroup {
        first_frame,
        corners: (0..places.len() as u32).map(corner).collect(),
        triangles: made,
        poses: vec![places],
        colours: Vec::new(),
        images: vec![Image { format: ImageFormat::Png, width: 8, height: 8, bytes: BLUE.to_vec() }],
        worn: vec![0],
    }
}
