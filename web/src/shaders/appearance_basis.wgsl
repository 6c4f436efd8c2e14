// Adds up the waves of the mean and the modes of a block, and restores the block from them; a workgroup for each block.
// Sums are whole numbers, so that their order does not matter. The twin of `Layer::rebuild`.
struct Layer {
    // Columns of the matrix from what is stored to colours.
    turn: array<vec4f, 3>,
    blocks: u32,
    modes: u32,
    // Texels along a restored block: 16, or 8 at half the size.
    side: u32,
}

@group(0) @binding(0) var<uniform> layer: Layer;
// Wave u at texel x: u * 16 + x.
@group(0) @binding(1) var<storage> cosines: array<f32>;
// Column and, in the high half, row of each block.
@group(0) @binding(2) var<storage> places: array<u32>;
// For each mode, where the entries of its blocks begin.
@group(0) @binding(3) var<storage> offsets: array<u32>;
// Index of the wave, and in the high half its number of steps.
@group(0) @binding(4) var<storage> entries: array<u32>;
@group(0) @binding(5) var<storage> weights: array<f32>;
@group(0) @binding(6) var mask: texture_2d<u32>;
@group(0) @binding(7) var restored: texture_storage_2d<rgba16float, write>;

const ONE = 1048576.0;
const PADDING = 1.0 / 1024.0;

var<workgroup> sums: array<atomic<i32>, 768>;
var<workgroup> waves: array<f32, 768>;
var<workgroup> rows: array<f32, 768>;

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) at: u32) {
    let block = group.x + group.y * 32768u;
    if (block >= layer.blocks) {
        return;
    }
    // Eight neighbours share a mode.
    for (var mode = at / 8u; mode < layer.modes; mode += 32u) {
        let first = mode * (layer.blocks + 1u) + block;
        let end = offsets[first + 1u];
        for (var entry = offsets[first] + at % 8u; entry < end; entry += 8u) {
            let packed = entries[entry];
            atomicAdd(&sums[packed & 0xffffu], i32(round(f32(i32(packed) >> 16u) * (weights[mode] * ONE))));
        }
    }
    workgroupBarrier();
    for (var channel = at; channel < 768u; channel += 256u) {
        waves[channel] = f32(atomicLoad(&sums[channel])) / ONE;
    }
    workgroupBarrier();
    let x = at % 16u;
    let y = at / 16u;
    for (var channel = 0u; channel < 768u; channel += 256u) {
        var sum = 0.0;
        for (var u = 0u; u < layer.side; u++) {
            sum += waves[channel + y * 16u + u] * cosines[u * 16u + x];
        }
        rows[channel + at] = sum;
    }
    workgroupBarrier();
    var colour = vec3f(0.0);
    for (var channel = 0u; channel < 3u; channel++) {
        var sum = 0.0;
        for (var v = 0u; v < layer.side; v++) {
            sum += rows[channel * 256u + v * 16u + x] * cosines[v * 16u + y];
        }
        colour += sum * layer.turn[channel].xyz;
    }
    let place = vec2u(places[block] & 0xffffu, places[block] >> 16u) * layer.side + vec2u(x, y);
    if (max(x, y) < layer.side && all(place < textureDimensions(restored))) {
        let shown = (textureLoad(mask, place, 0).r & 1u) == 1u;
        textureStore(restored, place, vec4f(colour, select(PADDING, 1.0, shown)));
    }
}
