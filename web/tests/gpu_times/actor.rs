//! A small actor with a texture that changes: a bent sheet that walks, as a bundle.

use actor::capture::{Capture, Poses};
use actor::graph::EssentialGraph;
use actor::surface::{Corner, Material, Part, Surface};
use actor::timeline::{Sequence, Timeline};
use bundle::{AppearanceInput, AppearanceQuality, BundleInput, encode_with_appearance};
use glam::Vec3;
use kernels::topology::Topology;
use texture::TextureModel;

/// Vertices along a side of the sheet.
const SIDE: u32 = 12;
/// Frames of its only sequence.
pub const FRAMES: u32 = 24;
/// Texels along a side of its texture.
const TEXELS: usize = 80;
/// Modes of colours and of warps.
const MODES: [usize; 2] = [3, 2];

/// The bundle.
pub fn bundle() -> Vec<u8> {
    let sequence = Sequence { name: "walk".into(), labels: vec![], first_frame: 0, frame_count: FRAMES, cyclic: false };
    let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
    let graph = EssentialGraph::new(0.01, vec![], &timeline).unwrap();
    let (topology, surface) = sheet();
    let mut poses = Poses::new(topology.vertex_count());
    (0..FRAMES).for_each(|frame| poses.push(&pose(frame)));
    let capture =
        Capture { name: "sheet".into(), topology, surface, timeline, poses, vertex_of_file_vertex: Vec::new() };
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let looks = AppearanceInput { model: &model(), material: 0, quality: AppearanceQuality::default() };
    encode_with_appearance(&input, Some(&looks)).unwrap().0
}

/// Place of a vertex on the sheet, 0 to 1.
fn place(vertex: u32) -> [f32; 2] {
    [vertex % SIDE, vertex / SIDE].map(|at| at as f32 / (SIDE - 1) as f32)
}

fn pose(frame: u32) -> Vec<Vec3> {
    let along = 0.02 * frame as f32;
    let at = |vertex| {
        let [u, v] = place(vertex);
        Vec3::new(u - 0.5 + along, 1.8 * v, 0.3 * (3.0 * u + 2.0 * v + along).sin())
    };
    (0..SIDE * SIDE).map(at).collect()
}

fn sheet() -> (Topology, Surface) {
    let cells = (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |column| row * SIDE + column));
    let triangles: Vec<[u32; 3]> =
        cells.flat_map(|at| [[at, at + 1, at + SIDE], [at + 1, at + SIDE + 1, at + SIDE]]).collect();
    let corner = |vertex| Corner { vertex, uv: place(vertex).map(|at| 0.1 + 0.8 * at), colour: [255; 4] };
    let material = Material { name: String::new(), base_colour: [1.0; 4], image: None, double_sided: true };
    let surface = Surface {
        corners: (0..SIDE * SIDE).map(corner).collect(),
        triangles: triangles.clone(),
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: triangles.len() as u32 }],
        materials: vec![material],
        images: vec![],
    };
    let weights = vec![1.0; (SIDE * SIDE) as usize];
    (Topology::new(SIDE * SIDE, triangles, weights).unwrap(), surface)
}

/// Smooth waves over the sheet, with edges in the mean, so that every pass has something to do.
fn model() -> TextureModel {
    let inside = |at: usize| (TEXELS / 10..TEXELS * 9 / 10).contains(&at);
    let active: Vec<bool> = (0..TEXELS * TEXELS).map(|at| inside(at % TEXELS) && inside(at / TEXELS)).collect();
    let texels: Vec<[f32; 2]> = (0..TEXELS * TEXELS)
        .filter(|&at| active[at])
        .map(|at| [at % TEXELS, at / TEXELS].map(|side| side as f32 / TEXELS as f32))
        .collect();
    let wave = |index: usize, [x, y]: [f32; 2]| {
        ((5 + index * 37 % 17) as f32 * x + (3 + index * 53 % 23) as f32 * y + index as f32).sin()
    };
    let mode = |first: usize, channels: usize| {
        let mut values = Vec::new();
        for texel in &texels {
            values.extend((0..channels).map(|channel| wave(first + channel, *texel)));
        }
        let length = values.iter().map(|value: &f32| value * value).sum::<f32>().sqrt();
        values.iter().map(|value| value / length).collect::<Vec<f32>>()
    };
    let coefficients = |modes: usize, channels: usize, scale: f32| {
        let length = ((texels.len() * channels) as f32).sqrt() * scale;
        let of = |frame: u32, mode: usize| (0.3 * frame as f32 * (mode + 1) as f32).sin() * length;
        (0..FRAMES).flat_map(|frame| (0..modes).map(move |mode| of(frame, mode))).collect::<Vec<f32>>()
    };
    let check = |&[x, y]: &[f32; 2]| {
        let bright = ((x * 10.0) as u32 + (y * 10.0) as u32).is_multiple_of(2);
        let base = if bright { 0.62 } else { 0.38 };
        [base + 0.1 * x, base, base - 0.1 * y]
    };
    TextureModel {
        width: TEXELS as u32,
        height: TEXELS as u32,
        mean_texture: texels.iter().flat_map(check).collect(),
        textures: (0..MODES[0]).map(|index| mode(3 * index, 3)).collect(),
        mean_warp: texels.iter().flat_map(|&texel| [wave(90, texel), wave(91, texel)]).collect(),
        warps: (0..MODES[1]).map(|index| mode(40 + 2 * index, 2)).collect(),
        texture_coefficients: coefficients(MODES[0], 3, 0.08),
        warp_coefficients: coefficients(MODES[1], 2, 1.0),
        active,
    }
}
