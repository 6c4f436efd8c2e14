// The actor. A captured colour holds its light already and is drawn unlit; bare geometry is lit like clay.
struct Material {
    base_colour: vec4f,
    // 1 where the texture's (or the vertices') colour was captured, 0 where the surface is lit.
    captured: f32,
}

@group(2) @binding(0) var<uniform> material: Material;
@group(2) @binding(1) var colour_map: texture_2d<f32>;
@group(2) @binding(2) var colour_sampler: sampler;

struct Varying {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) colour: vec4f,
    // The colour of the body's part, as far as it is known.
    @location(4) part: vec4f,
}

@vertex
fn vertex(@location(0) vertex: u32, @location(1) uv: vec2f, @location(2) colour: vec4f, @location(3) part: vec4f) -> Varying {
    let world = position_of(vertex);
    var out: Varying;
    out.clip = frame.clip_from_world * vec4f(world, 1.0);
    out.world = world;
    out.normal = normal_of(vertex);
    out.uv = uv;
    out.colour = vec4f(linear_from_srgb(colour.rgb), colour.a);
    out.part = vec4f(linear_from_srgb(part.rgb), part.a);
    return out;
}

// Light that a point near the ground and facing down does not get.
fn ambient(normal: vec3f, height: f32) -> f32 {
    let down = 0.5 - 0.5 * normal.y;
    let below = 0.30 * down * down * exp(-max(height, 0.0) / 0.7);
    let contact = 0.22 * exp(-max(height, 0.0) / 0.045);
    return (1.0 - below) * (1.0 - contact);
}

fn clay(albedo: vec3f, normal: vec3f, view: vec3f) -> vec3f {
    let sky = mix(vec3f(1.02, 1.0, 0.98), vec3f(0.86, 0.90, 1.0), frame.dark);
    let bounce = mix(vec3f(0.56, 0.46, 0.40), vec3f(0.34, 0.27, 0.25), frame.dark);
    let hemisphere = mix(bounce, sky, smoothstep(-1.0, 1.0, normal.y));
    let wrapped = max((dot(normal, frame.key) + 0.35) / 1.35, 0.0);
    let key = vec3f(1.0, 0.94, 0.86) * wrapped * wrapped;
    let grazing = 1.0 - max(dot(normal, view), 0.0);
    let rim = pow(grazing, 3.0) * (0.25 + 0.75 * smoothstep(-0.3, 0.9, normal.y));
    let halfway = normalize(frame.key + view);
    let sheen = 0.05 * pow(max(dot(normal, halfway), 0.0), 24.0);
    let exposure = mix(1.26, 1.0, frame.dark);
    return albedo * exposure * (0.52 * hemisphere + 0.62 * key) + rim * mix(0.16, 0.30, frame.dark) * vec3f(1.0, 0.95, 0.90) + sheen;
}

// A captured colour keeps its light. A trace of sky and of the key lets the form be read where the texture is plain.
fn relief(normal: vec3f) -> f32 {
    let sky = 0.5 + 0.5 * normal.y;
    let key = max((dot(normal, frame.key) + 0.5) / 1.5, 0.0);
    return 0.80 + 0.10 * sky + 0.12 * key;
}

@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let texel = textureSample(colour_map, colour_sampler, in.uv) * material.base_colour * in.colour;
    let normal = normalize(select(-in.normal, in.normal, front));
    let view = normalize(frame.eye - in.world);
    if (texel.a < 0.5) {
        discard;
    }
    var rgb = mix(clay(texel.rgb, normal, view), texel.rgb * relief(normal), material.captured);
    // The parts of the body are painted clay; a trace of what is worn tells which side is seen.
    rgb = mix(rgb, clay(in.part.rgb, normal, view), 0.86 * in.part.a * actor.parts);
    rgb *= ambient(normal, in.world.y - frame.ground);
    // The tint keeps the lightness: recorded and synthetic differ in hue, most at the rim.
    let tint = mix(frame.recorded.rgb, frame.synthetic.rgb, actor.synthetic);
    let weights = vec3f(0.2126, 0.7152, 0.0722);
    let tinted = tint * (dot(rgb, weights) + 0.02) / dot(tint, weights);
    let grazing = 1.0 - max(dot(normal, view), 0.0);
    rgb = mix(rgb, min(tinted, vec3f(1.0)), actor.tint * (0.26 + 0.5 * grazing * grazing));
    return vec4f(rgb, 1.0);
}
