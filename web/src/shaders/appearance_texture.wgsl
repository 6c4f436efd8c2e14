// The finished texture: what the warp moves here, and what its gradients add. The twin of `Aligned::dealign`.
@group(0) @binding(3) var correction: texture_2d<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

// Colours are encoded up to here; the target encodes them again.
fn linear_from_srgb(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

@fragment
fn fragment(@builtin(position) clip: vec4f) -> @location(0) vec4f {
    let at = vec2i(clip.xy);
    var colour = remapped(at);
    if (all(at < vec2i(textureDimensions(correction)))) {
        colour += unpacked(textureLoad(correction, at, 0))[0];
    }
    return vec4f(linear_from_srgb(clamp(colour, vec3f(0.0), vec3f(1.0))), motion.fill.a);
}
