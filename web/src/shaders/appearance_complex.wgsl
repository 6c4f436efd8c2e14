// Three channels of complex numbers: real parts, then imaginary parts; stored as half floats.
fn unpacked(texel: vec4u) -> mat2x3f {
    let middle = unpack2x16float(texel.y);
    return mat2x3f(vec3f(unpack2x16float(texel.x), middle.x), vec3f(middle.y, unpack2x16float(texel.z)));
}

fn packed(z: mat2x3f) -> vec4u {
    return vec4u(pack2x16float(z[0].xy), pack2x16float(vec2f(z[0].z, z[1].x)), pack2x16float(z[1].yz), 0u);
}
