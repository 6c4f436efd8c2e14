// The path walked so far: a ribbon on the ground that fades with age.
struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) side: f32,
    @location(1) alpha: f32,
    @location(2) synthetic: f32,
}

@vertex
fn vertex(@location(0) ground: vec2f, @location(1) side: f32, @location(2) alpha: f32, @location(3) synthetic: f32) -> Varying {
    var out: Varying;
    out.clip = frame.clip_from_world * vec4f(ground.x, frame.ground, ground.y, 1.0);
    out.side = side;
    out.alpha = alpha;
    out.synthetic = synthetic;
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let edge = fwidth(in.side);
    let covered = 1.0 - smoothstep(1.0 - 1.5 * edge, 1.0, abs(in.side));
    let alpha = in.alpha * covered;
    let colour = mix(frame.recorded.rgb, frame.synthetic.rgb, in.synthetic);
    return vec4f(colour * alpha, alpha);
}
