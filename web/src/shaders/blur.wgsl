// One direction of a Gaussian blur, narrow for red (contact), wide for green (soft).
struct Blur {
    // Step of a tap in texture coordinates, per channel.
    red: vec2f,
    green: vec2f,
}

@group(0) @binding(0) var<uniform> blur: Blur;
@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var source_sampler: sampler;

const FALL = 0.08;

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
    var sum = vec2f(0.0);
    var total = 0.0;
    for (var tap = -6; tap <= 6; tap++) {
        let x = f32(tap);
        // Six taps reach 2.4 standard deviations.
        let weight = exp(-FALL * x * x);
        let red = textureSampleLevel(source, source_sampler, in.uv + blur.red * x, 0.0).r;
        let green = textureSampleLevel(source, source_sampler, in.uv + blur.green * x, 0.0).g;
        sum += weight * vec2f(red, green);
        total += weight;
    }
    return vec4f(sum / total, 0.0, 1.0);
}
