// The ground: no horizon, a faint grid of one metre, the actor's shadow. Premultiplied, drawn over the background.
@group(1) @binding(0) var shadow_map: texture_2d<f32>;
@group(1) @binding(1) var shadow_sampler: sampler;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) ground: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let ground = frame.focus + corner * frame.reach * 1.6;
    var out: Varying;
    out.clip = frame.clip_from_world * vec4f(ground.x, frame.ground, ground.y, 1.0);
    out.ground = ground;
    return out;
}

// Coverage of lines `width` metres wide at whole multiples of `spacing`, averaged over the pixel's footprint.
fn lines(p: vec2f, spacing: f32, width: f32, footprint: vec2f) -> f32 {
    let drawn = max(vec2f(width), footprint);
    let nearest = abs(fract(p / spacing - 0.5) - 0.5) * spacing;
    let edge = footprint;
    var covered = smoothstep(drawn * 0.5 + edge * 0.75, drawn * 0.5 - edge * 0.75, nearest);
    // A line thinner than a pixel is drawn a pixel wide and as much fainter.
    covered *= clamp(vec2f(width) / drawn, vec2f(0.0), vec2f(1.0));
    // Where lines crowd into a pixel, only their mean is left.
    covered = mix(covered, vec2f(width / spacing), smoothstep(vec2f(0.25), vec2f(0.6), footprint / spacing));
    return max(covered.x, covered.y);
}

// Breaks up the bands that eight bits leave in a wide, soft gradient: half a step of the sRGB encoding at `light`.
fn dither(pixel: vec2f, light: vec3f) -> vec3f {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715)))) - 0.5;
    return noise * 2.0 * sqrt(max(light, vec3f(1e-4))) / 255.0;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let p = in.ground;
    let footprint = max(fwidth(p), vec2f(1e-5));
    let away = distance(p, frame.focus) / frame.reach;
    let fade = exp(-2.2 * away * away);
    let floor_cover = frame.floor.a * fade * (1.0 - smoothstep(1.0, 1.6, away));
    let grid = frame.grid * frame.line.a * lines(p, 1.0, 0.012, footprint) * exp(-3.0 * away * away)
        * (1.0 - smoothstep(0.9, 1.3, away));

    let uv = (p - frame.shadow_origin) / frame.shadow_size;
    let covered = textureSampleLevel(shadow_map, shadow_sampler, uv, 0.0).rg;
    let border = smoothstep(vec2f(0.5), vec2f(0.44), abs(uv - 0.5));
    let cover = covered * border.x * border.y * frame.shadow_strength;
    let shade = 1.0 - (1.0 - 0.70 * cover.r) * (1.0 - 0.66 * cover.g);

    var rgb = frame.floor.rgb * floor_cover;
    var alpha = floor_cover;
    rgb = rgb * (1.0 - grid) + frame.line.rgb * grid;
    alpha = 1.0 - (1.0 - alpha) * (1.0 - grid);
    rgb *= 1.0 - shade;
    alpha = 1.0 - (1.0 - alpha) * (1.0 - shade);
    let light = rgb + frame.background.rgb * (1.0 - alpha);
    return vec4f(max(rgb + dither(in.clip.xy, light), vec3f(0.0)), alpha);
}
