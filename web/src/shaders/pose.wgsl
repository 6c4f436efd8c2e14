// The drawn corners of the surface, pulled from the two poses that the picture lies between.
struct Actor {
    // 0 shows `pose_a`, 1 shows `pose_b`.
    weight: f32,
    // Strength of the tint, and 0 for recorded to 1 for synthetic.
    tint: f32,
    synthetic: f32,
    opacity: f32,
    // How strong the colours of parts are.
    parts: f32,
}

@group(1) @binding(0) var<uniform> actor: Actor;
// Per welded vertex: position, then normal.
const NUMBERS = 6u;
@group(1) @binding(1) var<storage, read> pose_a: array<f32>;
@group(1) @binding(2) var<storage, read> pose_b: array<f32>;

fn position_of(vertex: u32) -> vec3f {
    let k = vertex * NUMBERS;
    let a = vec3f(pose_a[k], pose_a[k + 1u], pose_a[k + 2u]);
    let b = vec3f(pose_b[k], pose_b[k + 1u], pose_b[k + 2u]);
    return mix(a, b, actor.weight);
}

fn normal_of(vertex: u32) -> vec3f {
    let k = vertex * NUMBERS + 3u;
    let a = vec3f(pose_a[k], pose_a[k + 1u], pose_a[k + 2u]);
    let b = vec3f(pose_b[k], pose_b[k + 1u], pose_b[k + 2u]);
    return mix(a, b, actor.weight);
}

fn linear_from_srgb(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}
