// What every pass of a picture shares: the camera, the ground and the theme. Colours are in linear light.
struct Frame {
    clip_from_world: mat4x4f,
    eye: vec3f,
    // Height of the ground, metres.
    ground: f32,
    // Direction towards the key light, which follows the camera.
    key: vec3f,
    // Radius in metres within which the ground is seen.
    reach: f32,
    // Point of the ground (X, Z) around which it fades.
    focus: vec2f,
    // Lower corner (X, Z) of the square that the shadow covers, and its side, metres.
    shadow_origin: vec2f,
    shadow_size: f32,
    shadow_strength: f32,
    grid: f32,
    // 1 where the theme is dark.
    dark: f32,
    background: vec4f,
    floor: vec4f,
    line: vec4f,
    accent: vec4f,
    recorded: vec4f,
    synthetic: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
