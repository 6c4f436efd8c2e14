//! All WGSL through naga, and the Rust twins of its uniforms against its layout.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test that panics has failed")]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Literal, Module, TypeInner};
use texture::{basis, dealign};
use web::gpu::appearance::basis::LayerUniform;
use web::gpu::appearance::dealign::Motion;
use web::gpu::frame::FrameUniform;
use web::gpu::mesh::MaterialUniform;
use web::gpu::pose::ActorUniform;
use web::gpu::shadow::BlurUniform;
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
    let actor = layout!(ActorUniform, weight, tint, synthetic, opacity);
    check_layout(shaders::ACTOR, "Actor", actor, size_of::<ActorUniform>());
    let material = layout!(MaterialUniform, base_colour, captured);
    check_layout(shaders::ACTOR, "Material", material, size_of::<MaterialUniform>());
    check_layout(shaders::BLUR, "Blur", layout!(BlurUniform, red, green), size_of::<BlurUniform>());
}

/// The number that a constant of `source` is, as the shader has it. One without a type is none to naga until it is used.
fn constant(source: &str, name: &str) -> f32 {
    let module = parse(name, &format!("{source}\nconst PROBE: f32 = {name};\n"));
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some("PROBE"));
    match found.map(|(_, constant)| &module.global_expressions[constant.init]) {
        Some(&Expression::Literal(Literal::F32(value))) => value,
        other => panic!("{name} is no number: {other:?}"),
    }
}

#[test]
fn constants_are_those_of_their_twins() {
    for (source, name, twin) in [
        (shaders::APPEARANCE_BASIS, "ONE", basis::ONE),
        (shaders::APPEARANCE_BASIS, "PADDING", dealign::PADDING),
        (shaders::APPEARANCE_CYCLE, "LAMBDA", dealign::LAMBDA),
    ] {
        assert_eq!(constant(source, name), twin, "{name}");
    }
}

#[test]
fn workgroups_have_the_size_that_they_are_dispatched_by() {
    // One invocation for each block of a mode (`blocks.div_ceil(64)`), a workgroup for each restored block of 16 x 16 texels,
    // and 8 x 8 texels for each workgroup of a pass over a texture (`side.div_ceil(8)`).
    for (source, sizes) in [
        (shaders::APPEARANCE_BASIS, &[[64, 1, 1], [256, 1, 1], [256, 1, 1]][..]),
        (shaders::APPEARANCE_RESIDUAL, &[[8, 8, 1]]),
        (shaders::APPEARANCE_CYCLE, &[[8, 8, 1], [8, 8, 1]]),
    ] {
        let found: Vec<_> = parse("shader", source).entry_points.iter().map(|entry| entry.workgroup_size).collect();
        assert_eq!(found, sizes);
    }
}
