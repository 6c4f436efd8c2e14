// Finds what a backward warp moves to a texel. The twin of `Aligned` and `Field::sample`.
struct Move {
    // Colour where nothing is known; alpha is how much the result covers what was drawn before.
    fill: vec4f,
    // Texels of the full size along a texel of the aligned texture, and along one of the warp.
    texel: f32,
    cell: f32,
}

@group(0) @binding(0) var<uniform> motion: Move;
@group(0) @binding(1) var aligned: texture_2d<f32>;
@group(0) @binding(2) var warp: texture_2d<f32>;

const KNOWN = 1e-6;

fn sampled(field: texture_2d<f32>, at: vec2f, otherwise: vec3f) -> vec3f {
    let corner = floor(at);
    let part = at - corner;
    let size = vec2i(textureDimensions(field));
    var sum = vec4f(0.0);
    for (var k = 0; k < 4; k++) {
        let offset = vec2i(k & 1, k >> 1u);
        let place = vec2i(corner) + offset;
        if (all(place >= vec2i(0)) && all(place < size)) {
            let texel = textureLoad(field, place, 0);
            let near = select(1.0 - part, part, offset == vec2i(1));
            sum += vec4f(texel.rgb, 1.0) * (near.x * near.y * texel.a);
        }
    }
    return select(otherwise, sum.rgb / sum.a, sum.a > KNOWN);
}

fn warp_at(at: vec2i) -> vec2f {
    let place = (vec2f(at) + 0.5) * (motion.texel / motion.cell) - 0.5;
    return sampled(warp, place, vec3f(0.0)).xy / motion.texel;
}

fn moved(at: vec2i, by: vec2f) -> vec3f {
    return sampled(aligned, vec2f(at) + by, motion.fill.rgb);
}

fn remapped(at: vec2i) -> vec3f {
    return moved(at, warp_at(at));
}
