// Adds up the waves of the mean and the modes, block by block, and restores the blocks from them: along rows, then along
// columns. Sums are whole numbers, so that their order does not matter. No invocation waits for another: on a processor that
// plays the GPU, barriers cost more than all the rest. The twin of `Layer::rebuild`.
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
struct Block {
    // Column and, in the high half, row.
    place: u32,
    // How much larger its steps are.
    scale: f32,
}

@group(0) @binding(2) var<storage> blocks: array<Block>;
// For each mode, where the entries of its blocks begin.
@group(0) @binding(3) var<storage> offsets: array<u32>;
// Index of the wave, and in the high half its number of steps.
@group(0) @binding(4) var<storage> entries: array<u32>;
@group(0) @binding(5) var<storage> weights: array<f32>;
@group(0) @binding(6) var mask: texture_2d<u32>;
@group(0) @binding(7) var restored: texture_storage_2d<rgba16float, write>;

const ONE = 1048576.0;
const PADDING = 1.0 / 1024.0;
// Texels along a stored block, its waves in a channel and in all three; workgroups in a row of them.
const SIDE = 16u;
const AREA = 256u;
const WAVES = 768u;
const ROW = 32768u;

// Of each block 3 channels of 256 waves; zero to begin with.
@group(0) @binding(8) var<storage, read_write> sums: array<atomic<i32>>;
// The same, restored along rows.
@group(0) @binding(9) var<storage, read_write> rows: array<f32>;

// An invocation for each block of each mode.
@compute @workgroup_size(64)
fn add(@builtin(global_invocation_id) id: vec3u) {
    let block = id.x;
    if (block >= layer.blocks) {
        return;
    }
    let first = id.y * (layer.blocks + 1u) + block;
    let weight = weights[id.y] * ONE;
    let end = offsets[first + 1u];
    for (var entry = offsets[first]; entry < end; entry++) {
        let packed = entries[entry];
        atomicAdd(&sums[block * WAVES + (packed & 0xffffu)], i32(round(f32(i32(packed) >> 16u) * weight)));
    }
}

// Block, column and row of an invocation of a workgroup for each block; a block that is none where there is nothing to do.
fn place_of(group: vec3u, at: u32) -> vec3u {
    let place = vec3u(group.x + group.y * ROW, at % SIDE, at / SIDE);
    return select(place, vec3u(layer.blocks), max(place.y, place.z) >= layer.side);
}

@compute @workgroup_size(256)
fn along_rows(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) at: u32) {
    let place = place_of(group, at);
    if (place.x >= layer.blocks) {
        return;
    }
    for (var channel = 0u; channel < 3u; channel++) {
        let first = place.x * WAVES + channel * AREA;
        var sum = 0.0;
        for (var u = 0u; u < layer.side; u++) {
            sum += f32(atomicLoad(&sums[first + place.z * SIDE + u])) / ONE * cosines[u * SIDE + place.y];
        }
        rows[first + at] = sum * blocks[place.x].scale;
    }
}

@compute @workgroup_size(256)
fn along_columns(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) at: u32) {
    let place = place_of(group, at);
    if (place.x >= layer.blocks) {
        return;
    }
    var colour = vec3f(0.0);
    for (var channel = 0u; channel < 3u; channel++) {
        let first = place.x * WAVES + channel * AREA + place.y;
        var sum = 0.0;
        for (var v = 0u; v < layer.side; v++) {
            sum += rows[first + v * SIDE] * cosines[v * SIDE + place.z];
        }
        colour += sum * layer.turn[channel].xyz;
    }
    let corner = vec2u(blocks[place.x].place & 0xffffu, blocks[place.x].place >> 16u) * layer.side;
    let texel = corner + place.yz;
    if (all(texel < textureDimensions(restored))) {
        let shown = (textureLoad(mask, texel, 0).r & 1u) == 1u;
        textureStore(restored, texel, vec4f(colour, select(PADDING, 1.0, shown)));
    }
}
