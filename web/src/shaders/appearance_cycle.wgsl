// The two ways of a multigrid cycle for (M + i lambda) z = right, M being minus the Laplacian with natural boundaries.
// The twins of `down`, `prolonged` and `step`; the first Jacobi step, which starts from zero, is made again wherever it is
// needed instead of being stored.
struct Level {
    // Weight of an edge of M.
    stiffness: f32,
    // 1 where there is no smaller level.
    last: u32,
}

@group(0) @binding(0) var<uniform> level: Level;
@group(0) @binding(1) var mask: texture_2d<u32>;
@group(0) @binding(2) var right: texture_2d<u32>;
// Mask and solution of the next smaller level; on the way down that level's right side is written.
@group(0) @binding(3) var smaller_mask: texture_2d<u32>;
@group(0) @binding(4) var smaller: texture_2d<u32>;
@group(0) @binding(5) var written: texture_storage_2d<rgba32uint, write>;

const LAMBDA = 0.02;
const OMEGA = 0.8;
const LEAST = 3.0;
const NEIGHBOURS = array(vec2i(1, 0), vec2i(-1, 0), vec2i(0, 1), vec2i(0, -1));

fn flags_at(at: vec2i) -> u32 {
    return textureLoad(mask, at, 0).r;
}

fn jacobi(rest: mat2x3f, flags: u32) -> mat2x3f {
    let diagonal = level.stiffness * f32(countOneBits(flags >> 1u));
    let scale = OMEGA / (diagonal * diagonal + LAMBDA * LAMBDA);
    return scale * mat2x3f(diagonal * rest[0] + LAMBDA * rest[1], diagonal * rest[1] - LAMBDA * rest[0]);
}

fn right_at(at: vec2i) -> mat2x3f {
    return unpacked(textureLoad(right, at, 0));
}

// The smaller level's solution at `at`, between its active texels.
fn prolonged(at: vec2i) -> mat2x3f {
    var sum = mat2x3f();
    var total = 0.0;
    let size = vec2i(textureDimensions(smaller_mask));
    for (var k = 0; k < 4; k++) {
        let aside = vec2i(k & 1, k >> 1u);
        let place = at / 2 + aside * (at % 2 * 2 - 1);
        if (all(place >= vec2i(0)) && all(place < size) && (textureLoad(smaller_mask, place, 0).r & 1u) == 1u) {
            let near = select(vec2f(0.75), vec2f(0.25), aside == vec2i(1));
            let weight = near.x * near.y;
            sum += weight * unpacked(textureLoad(smaller, place, 0));
            total += weight;
        }
    }
    return sum * (1.0 / total);
}

// The solution before the last Jacobi step: the first one, and on the way up what the smaller level adds.
fn before(at: vec2i, up: bool) -> mat2x3f {
    let first = jacobi(right_at(at), flags_at(at));
    if (up && level.last == 0u) {
        return first + prolonged(at);
    }
    return first;
}

// right - (M + i lambda) z.
fn rest(at: vec2i, z: mat2x3f, up: bool) -> mat2x3f {
    let flags = flags_at(at);
    var sum = right_at(at) + LAMBDA * mat2x3f(z[1], -z[0]);
    for (var k = 0u; k < 4u; k++) {
        if ((flags & (2u << k)) != 0u) {
            sum -= level.stiffness * (z - before(at + NEIGHBOURS[k], up));
        }
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn down(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(written))) {
        return;
    }
    var sum = mat2x3f();
    var count = 0.0;
    let size = vec2i(textureDimensions(mask));
    for (var k = 0; k < 4; k++) {
        let at = vec2i(id.xy) * 2 + vec2i(k & 1, k >> 1u);
        if (all(at < size) && (flags_at(at) & 1u) == 1u) {
            sum += rest(at, before(at, false), false);
            count += 1.0;
        }
    }
    textureStore(written, id.xy, packed(sum * (1.0 / max(count, LEAST))));
}

@compute @workgroup_size(8, 8)
fn up(@builtin(global_invocation_id) id: vec3u) {
    let at = vec2i(id.xy);
    if (any(id.xy >= textureDimensions(written)) || (flags_at(at) & 1u) == 0u) {
        return;
    }
    let z = before(at, true);
    textureStore(written, at, packed(z + jacobi(rest(at, z, true), flags_at(at))));
}
