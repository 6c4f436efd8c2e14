//! Which extensions of a file are read, which may be passed over, and which stand in the way.

use gltf::json::Root;

use super::document::Document;
use crate::import::error::ImportError;
use crate::import::warning::Warning;

/// Read here, or without anything that an actor has.
const READ: [&str; 22] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "KHR_texture_transform",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_node_visibility",
    // Reading says itself which of its channels are left out.
    "KHR_animation_pointer",
    // Gloss on a base colour that stays the same.
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    // The default variant is the file's own material.
    "KHR_materials_variants",
    "KHR_lights_punctual",
    "KHR_xmp_json_ld",
];
/// Passed over although they change how the surface looks.
const LOOKS: [&str; 4] = [
    "KHR_materials_transmission",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
];

/// Refuses a file that requires what is not read, and says what else of it is passed over.
pub(super) fn check(document: &Document, warnings: &mut Vec<Warning>) -> Result<(), ImportError> {
    let Root { extensions_required, extensions_used, .. } = document.root();
    let path = document.path();
    let unread = |name: &&String| !READ.contains(&name.as_str()) && !LOOKS.contains(&name.as_str());
    if let Some(extension) = extensions_required.iter().find(unread) {
        return Err(ImportError::Extension { path: path.to_owned(), extension: extension.clone() });
    }
    let mut passed_over: Vec<&str> = extensions_used.iter().filter(unread).map(String::as_str).collect();
    passed_over.sort_unstable();
    passed_over.dedup();
    if !passed_over.is_empty() {
        let names = passed_over.join(", ");
        warnings.push(Warning::new(
            "W_GLTF_EXTENSION",
            format!("{}: what {names} adds to the file is not read and left out", path.display()),
        ));
    }
    let all = extensions_used.iter().chain(extensions_required);
    if let Some(extension) = all.into_iter().find(|name| LOOKS.contains(&name.as_str())) {
        warnings.push(Warning::new(
            "W_GLTF_LOOKS",
            format!("{}: {extension} lets light through the surface: it is drawn opaque", path.display()),
        ));
    }
    Ok(())
}
