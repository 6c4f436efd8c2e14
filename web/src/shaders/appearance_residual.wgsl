// What the texture moved directly lacks of the moved gradients, with the sign of minus the Laplacian. The twin of
// `Aligned::residual`, gathered instead of scattered.
@group(0) @binding(3) var mask: texture_2d<u32>;
@group(0) @binding(4) var residual: texture_storage_2d<rgba32uint, write>;

// Along the edge from `near` to `far`, as the warp of `near` moves it.
fn lacking(near: vec2i, far: vec2i) -> vec3f {
    return moved(far, warp_at(near)) - remapped(far);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(residual))) {
        return;
    }
    let at = vec2i(id.xy);
    let flags = textureLoad(mask, at, 0).r;
    var sum = vec3f(0.0);
    if ((flags & 2u) != 0u) {
        sum -= lacking(at, at + vec2i(1, 0));
    }
    if ((flags & 4u) != 0u) {
        sum += lacking(at - vec2i(1, 0), at);
    }
    if ((flags & 8u) != 0u) {
        sum -= lacking(at, at + vec2i(0, 1));
    }
    if ((flags & 16u) != 0u) {
        sum += lacking(at - vec2i(0, 1), at);
    }
    textureStore(residual, at, packed(mat2x3f(sum, vec3f(0.0))));
}
