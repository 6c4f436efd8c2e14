// What tools draw on the ground: triangles in the page's own colours.
struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) colour: vec4f,
}

@vertex
fn vertex(@location(0) ground: vec2f, @location(1) colour: vec4f) -> Varying {
    var out: Varying;
    out.clip = frame.clip_from_world * vec4f(ground.x, frame.ground, ground.y, 1.0);
    // The page's colours are sRGB, near enough a power; blending is in linear light.
    out.colour = vec4f(pow(colour.rgb, vec3f(2.2)), colour.a);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return vec4f(in.colour.rgb * in.colour.a, in.colour.a);
}
