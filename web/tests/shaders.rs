//! All WGSL through naga, and the Rust twins of its uniforms against its layout.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that panics has failed")]

use kernels::srgb::linear_from_srgb;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Literal, Module, TypeInner};
use texture::mask::NEIGHBOURS;
use texture::{basis, dealign, transform};
use web::gpu::appearance::basis::{GROUP, LayerUniform, ROW};
use web::gpu::appearance::dealign::{Motion, TILE};
use web::gpu::frame::FrameUniform;
use web::gpu::mesh::MaterialUniform;
use web::gpu::pose::{ActorUniform, NUMBERS};
use web::gpu::shadow::{BlurUniform, TAPS_PER_DEVIATION};
use web::shaders;

const ALL: [(&str, &str); 9] = [
    ("appearance_texture", shaders::APPEARANCE_TEXTURE),
    ("actor", shaders::ACTOR),
    ("ghost", shaders::GHOST),
    ("occlusion", shaders::OCCLUSION),
    ("blur", shaders::BLUR),
    ("ground", shaders::GROUND),
    ("trail", shaders::TRAIL),
    ("marks", shaders::MARKS),
    ("mipmap", shaders::MIPMAP),
];

/// What browsers offer without asking for features; packing half floats is part of WGSL, an extra only to naga.
const OFFERED: Capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32;

fn parse(name: &str, source: &str) -> Module {
    naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)))
}

#[test]
fn every_shader_is_valid_and_has_its_entry_points() {
    for (name, source) in ALL {
        let module = parse(name, source);
        let outcome = Validator::new(ValidationFlags::all(), OFFERED).validate(&module);
        assert!(outcome.is_ok(), "{name}: {:?}", outcome.err());
        let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(entries, ["vertex", "fragment"], "{name}");
    }
}

#[test]
fn every_compute_shader_is_valid_and_has_its_entry_points() {
    for (name, source, wanted) in [
        ("appearance_basis", shaders::APPEARANCE_BASIS, &["add", "along_rows", "along_columns"][..]),
        ("appearance_residual", shaders::APPEARANCE_RESIDUAL, &["main"]),
        ("appearance_cycle", shaders::APPEARANCE_CYCLE, &["down", "up"]),
    ] {
        let module = parse(name, source);
        let outcome = Validator::new(ValidationFlags::all(), OFFERED).validate(&module);
        assert!(outcome.is_ok(), "{name}: {:?}", outcome.err());
        let entries: Vec<_> = module.entry_points.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(entries, wanted, "{name}");
    }
}

/// Checks that struct `name` of `source` has exactly these members, as (name, offset), and this size.
fn check_layout(source: &str, name: &str, members: &[(&str, usize)], size: usize) {
    let module = parse(name, source);
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, ty)) = found else { panic!("there is no struct {name}") };
    let TypeInner::Struct { members: wgsl, span } = &ty.inner else { panic!("{name} is no struct") };
    let wgsl: Vec<_> =
        wgsl.iter().map(|member| (member.name.as_deref().unwrap_or_default(), member.offset as usize)).collect();
    assert_eq!(wgsl, members, "{name}");
    assert_eq!(*span as usize, size, "{name}");
}

macro_rules! layout {
    ($rust:ident, $($member:ident),+) => {
        &[$((stringify!($member), std::mem::offset_of!($rust, $member))),+]
    };
}

#[test]
fn uniforms_have_the_layout_of_their_twins() {
    let layer = layout!(LayerUniform, turn, blocks, modes, side);
    check_layout(shaders::APPEARANCE_BASIS, "Layer", layer, size_of::<LayerUniform>());
    let motion = layout!(Motion, fill, texel, cell);
    check_layout(shaders::APPEARANCE_TEXTURE, "Move", motion, size_of::<Motion>());
    let frame = layout!(
        FrameUniform,
        clip_from_world,
        eye,
        ground,
        key,
        reach,
        focus,
        shadow_origin,
        shadow_size,
        shadow_strength,
        grid,
        dark,
        background,
        floor,
        line,
        accent,
        recorded,
        synthetic
    );
    check_layout(shaders::GROUND, "Frame", frame, size_of::<FrameUniform>());
    let actor = layout!(ActorUniform, weight, tint, synthetic, opacity, parts);
    check_layout(shaders::ACTOR, "Actor", actor, size_of::<ActorUniform>());
    let material = layout!(MaterialUniform, base_colour, captured);
    check_layout(shaders::ACTOR, "Material", material, size_of::<MaterialUniform>());
    check_layout(shaders::BLUR, "Blur", layout!(BlurUniform, red, green), size_of::<BlurUniform>());
}

/// The value of constant `name` of `source`, as 32 bits.
fn constant(source: &str, name: &str) -> f32 {
    // The shader's own constants have no types of their own, and naga keeps none that has not.
    let module = parse(name, &format!("{source}const TWIN: f32 = f32({name});"));
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some("TWIN"));
    let (_, constant) = found.unwrap();
    match module.global_expressions[constant.init] {
        Expression::Literal(Literal::F32(value)) => value,
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn constants_have_the_values_of_their_twins() {
    let (basis_pass, cycle, motion) =
        (shaders::APPEARANCE_BASIS, shaders::APPEARANCE_CYCLE, shaders::APPEARANCE_TEXTURE);
    for (source, name, twin) in [
        (basis_pass, "ONE", f64::from(basis::ONE)),
        (basis_pass, "PADDING", f64::from(dealign::PADDING)),
        (basis_pass, "SIDE", transform::SIDE as f64),
        (basis_pass, "AREA", transform::AREA as f64),
        (basis_pass, "WAVES", 3.0 * transform::AREA as f64),
        (basis_pass, "ROW", f64::from(ROW)),
        (cycle, "LAMBDA", f64::from(dealign::LAMBDA)),
        (cycle, "OMEGA", f64::from(dealign::OMEGA)),
        (cycle, "LEAST", f64::from(dealign::LEAST)),
        (motion, "KNOWN", f64::from(dealign::KNOWN)),
        (shaders::BLUR, "FALL", 0.5 / f64::from(TAPS_PER_DEVIATION).powi(2)),
        (shaders::ACTOR, "NUMBERS", NUMBERS as f64),
    ] {
        assert_eq!(constant(source, name), twin as f32, "{name}");
    }
}

#[test]
fn neighbours_come_in_the_order_of_their_flags() {
    let places = NEIGHBOURS.map(|(_, [x, y])| format!("vec2i({x}, {y})")).join(", ");
    let wanted = format!("const NEIGHBOURS = array({places});");
    assert!(shaders::APPEARANCE_CYCLE.contains(&wanted), "{wanted}");
    // The shader's flag of neighbour k is 2 << k.
    assert_eq!(NEIGHBOURS.map(|(flag, _)| flag), [0, 1, 2, 3].map(|k| 2 << k));
}

#[test]
fn workgroups_are_as_large_as_they_are_dispatched() {
    let area = transform::AREA as u32;
    for (source, wanted) in [
        (shaders::APPEARANCE_BASIS, vec![[GROUP, 1, 1], [area, 1, 1], [area, 1, 1]]),
        (shaders::APPEARANCE_RESIDUAL, vec![[TILE, TILE, 1]]),
        (shaders::APPEARANCE_CYCLE, vec![[TILE, TILE, 1]; 2]),
    ] {
        let module = parse("workgroups", source);
        let sizes: Vec<_> = module.entry_points.iter().map(|entry| entry.workgroup_size).collect();
        assert_eq!(sizes, wanted);
    }
}

/// The numbers of function `linear_from_srgb` in `source`, in order.
fn numbers_of_srgb(source: &str) -> Vec<f32> {
    let (_, function) = source.split_once("fn linear_from_srgb").unwrap();
    let (body, _) = function.split_once('}').unwrap();
    let (_, body) = body.split_once("return").unwrap();
    let words = body.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    // `vec3f` and its like leave a lone digit.
    words.filter(|word| word.contains('.')).map(|word| word.parse().unwrap()).collect()
}

#[test]
fn srgb_is_decoded_as_on_the_processor() {
    for source in [shaders::ACTOR, shaders::APPEARANCE_TEXTURE] {
        let [shift, scale, power, slope, end] = numbers_of_srgb(source)[..] else { panic!("{source}") };
        for byte in 0..=255 {
            let srgb = byte as f32 / 255.0;
            let own = if srgb <= end { srgb / slope } else { ((srgb + shift) / scale).powf(power) };
            assert_eq!(own, linear_from_srgb(srgb), "{byte}");
        }
    }
}
