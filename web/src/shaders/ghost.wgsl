// A pose that the actor could go to: a translucent shell, clearer at its rim.

// Metres that it gives way to the actor: where both stand at one place, the actor is seen and the ghost around it.
const BEHIND = 0.6;

struct Varying {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vertex(@location(0) vertex: u32) -> Varying {
    let world = position_of(vertex);
    var out: Varying;
    out.clip = frame.clip_from_world * vec4f(world + BEHIND * normalize(world - frame.eye), 1.0);
    out.world = world;
    out.normal = normal_of(vertex);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let view = normalize(frame.eye - in.world);
    let facing = abs(dot(normalize(in.normal), view));
    let rim = pow(1.0 - facing, 1.8);
    let alpha = mix(mix(0.34, 0.24, frame.dark), mix(0.95, 0.75, frame.dark), rim) * actor.opacity;
    // A little light from above keeps the body's form readable.
    let light = 0.86 + 0.22 * in.normal.y;
    return vec4f(frame.accent.rgb * light * alpha, alpha);
}
