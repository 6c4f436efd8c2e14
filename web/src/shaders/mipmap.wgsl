// The next smaller level of a texture: the mean of four texels, in linear light since its views are sRGB.
@group(0) @binding(0) var level_above: texture_2d<f32>;
@group(0) @binding(1) var level_sampler: sampler;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    var out: Varying;
    out.clip = vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
    out.uv = corner;
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return textureSample(level_above, level_sampler, in.uv);
}
