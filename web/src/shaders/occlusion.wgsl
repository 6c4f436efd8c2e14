// How much each point of the ground is covered, seen from above: red by what touches it, green by what is over it.
struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) height: f32,
}

@vertex
fn vertex(@location(0) vertex: u32) -> Varying {
    let world = position_of(vertex);
    let square = (world.xz - frame.shadow_origin) / frame.shadow_size * 2.0 - 1.0;
    var out: Varying;
    out.clip = vec4f(square.x, -square.y, 0.5, 1.0);
    out.height = max(world.y - frame.ground, 0.0);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return vec4f(exp(-in.height / 0.07), exp(-in.height / 1.1), 0.0, 1.0);
}
