//! Group 1 of the actor's passes: the two poses that the picture lies between; the twin of `shaders/pose.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use wgpu::{BufferUsages, ShaderStages};

use super::context::{Gpu, STORAGE, UNIFORM};

/// `Actor` of `pose.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ActorUniform {
    /// 0 shows the pose before, 1 the pose after.
    pub weight: f32,
    /// Strength of the tint.
    pub tint: f32,
    /// 0 tints as recorded, 1 as synthetic.
    pub synthetic: f32,
    /// Of ghosts.
    pub opacity: f32,
    /// How strong the colours of parts are.
    pub parts: f32,
}

/// Numbers of a vertex: its position, then its normal.
pub const NUMBERS: usize = 6;

/// A pose as it is uploaded, told from others by its number.
#[derive(Clone, Copy)]
pub struct Numbered<'a> {
    /// Equal numbers are equal poses.
    pub number: u64,
    /// World positions, metres, one per welded vertex.
    pub pose: &'a [Vec3],
}

/// Layout of group 1.
#[must_use]
pub fn pose_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    gpu.layout("reprise.pose.layout", ShaderStages::VERTEX_FRAGMENT, &[UNIFORM, STORAGE, STORAGE])
}

/// Two pose buffers. Stepping on to the next frame uploads one pose and swaps their roles.
pub struct PoseGroup {
    uniform: wgpu::Buffer,
    poses: [wgpu::Buffer; 2],
    numbers: [u64; 2],
    /// `poses[0]` first, then `poses[1]` first.
    groups: [wgpu::BindGroup; 2],
    swapped: bool,
    written: Option<ActorUniform>,
    scratch: Vec<f32>,
}

impl PoseGroup {
    /// Buffers for poses of `vertex_count` vertices.
    #[must_use]
    pub fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, vertex_count: usize) -> Self {
        let uniform = gpu.buffer("reprise.pose.uniform", size_of::<ActorUniform>() as u64, BufferUsages::UNIFORM);
        let poses = [(); 2].map(|()| {
            gpu.buffer(
                "reprise.pose.vertices",
                (vertex_count * NUMBERS * size_of::<f32>()) as u64,
                BufferUsages::STORAGE,
            )
        });
        let group = |a: usize, b: usize| {
            let [first, second] = [&poses[a], &poses[b]].map(wgpu::Buffer::as_entire_binding);
            gpu.group("reprise.pose.group", layout, &[uniform.as_entire_binding(), first, second])
        };
        let groups = [group(0, 1), group(1, 0)];
        Self { uniform, poses, numbers: [u64::MAX; 2], groups, swapped: false, written: None, scratch: Vec::new() }
    }

    /// Uploads what is not there yet of `before` and `after`. True where anything changed.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        triangles: &[[u32; 3]],
        before: Numbered<'_>,
        after: Numbered<'_>,
        uniform: ActorUniform,
    ) -> bool {
        if self.numbers[usize::from(!self.swapped)] == before.number && self.numbers[0] != self.numbers[1] {
            self.swapped = !self.swapped;
        }
        let slots = [usize::from(self.swapped), usize::from(!self.swapped)];
        let mut changed = self.written != Some(uniform);
        for (slot, numbered) in slots.into_iter().zip([before, after]) {
            if self.numbers[slot] != numbered.number {
                interleave(triangles, numbered.pose, &mut self.scratch);
                let room = self.poses[slot].size() as usize;
                let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
                gpu.queue.write_buffer(&self.poses[slot], 0, &bytes[..bytes.len().min(room)]);
                self.numbers[slot] = numbered.number;
                changed = true;
            }
        }
        if self.written != Some(uniform) {
            gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
            self.written = Some(uniform);
        }
        changed
    }

    /// Forgets what it holds, so that the next poses are uploaded whatever their numbers.
    pub fn forget(&mut self) {
        self.numbers = [u64::MAX; 2];
        self.written = None;
    }

    /// Whether the pose `number` is there already.
    #[must_use]
    pub fn has(&self, number: u64) -> bool {
        self.numbers.contains(&number)
    }

    /// Vertices that a pose may have.
    #[must_use]
    pub fn room(&self) -> usize {
        self.poses[0].size() as usize / (NUMBERS * size_of::<f32>())
    }

    /// Group 1 as it was last written.
    #[must_use]
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.groups[usize::from(self.swapped)]
    }
}

/// Positions and smooth normals of `pose`, six numbers per vertex, into `out`.
pub fn interleave(triangles: &[[u32; 3]], pose: &[Vec3], out: &mut Vec<f32>) {
    out.clear();
    out.reserve(pose.len() * NUMBERS);
    for p in pose {
        out.extend_from_slice(&[p.x, p.y, p.z, 0.0, 0.0, 0.0]);
    }
    for corners in triangles {
        let [Some(&a), Some(&b), Some(&c)] = corners.map(|vertex| pose.get(vertex as usize)) else { continue };
        // Twice the triangle's area long: large triangles count for more.
        let normal = (b - a).cross(c - a);
        for &vertex in corners {
            let start = vertex as usize * NUMBERS + 3;
            if let Some(sum) = out.get_mut(start..start + 3) {
                sum[0] += normal.x;
                sum[1] += normal.y;
                sum[2] += normal.z;
            }
        }
    }
    for vertex in out.chunks_exact_mut(NUMBERS) {
        let normal = Vec3::new(vertex[3], vertex[4], vertex[5]).normalize_or(Vec3::Y);
        vertex[3..].copy_from_slice(&normal.to_array());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_point_out_of_a_closed_surface() {
        let pose = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
        let mut out = Vec::new();
        interleave(&triangles, &pose, &mut out);
        let centre = Vec3::splat(0.25);
        for (vertex, p) in out.chunks_exact(6).zip(pose) {
            assert_eq!(vertex[..3], p.to_array());
            let normal = Vec3::new(vertex[3], vertex[4], vertex[5]);
            assert!(normal.dot(p - centre) > 0.0);
            assert!((normal.length() - 1.0).abs() < 1e-6);
        }
    }
}
