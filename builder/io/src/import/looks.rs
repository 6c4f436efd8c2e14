//! How mesh files say that their surface looks: materials of libraries, and the textures that these name.

use std::path::{Path, PathBuf};

use actor::surface::Material;

use super::beside;
use super::error::ImportError;
use super::images::read_file;
use super::mesh::{MeshFile, plain_material};
use super::mtl::{self, LibraryMaterial};
use super::warning::Note;
use super::worn::{NamedTexture, UvTransform};

/// A statement that names more libraries is none.
const MOST_LIBRARIES: usize = 64;

/// A material as a mesh file wants it drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Look {
    pub material: Material,
    pub texture: Option<NamedTexture>,
    pub uv: UvTransform,
}

/// The looks of `frame`, read from `path`, one per material name; what is lost or elsewhere goes to `notes`.
pub(super) fn looks(frame: &MeshFile, path: &Path, notes: &mut Vec<Note>) -> Result<Vec<Look>, ImportError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut known = Vec::new();
    let mut complete = true;
    for statement in &frame.libraries {
        for (written, found) in libraries(folder, statement) {
            let Some(found) = found else {
                complete = false;
                notes.push(Note::new("W_MATERIAL_MISSING", format!("the material library {written} is missing")));
                continue;
            };
            if found.moved {
                notes.push(moved("material library", &written, &found.path));
            }
            let library = mtl::parse(&read_file(&found.path)?, &found.path)?;
            notes.extend(library.notes);
            let of_library = found.path.parent().unwrap_or(Path::new("")).to_owned();
            known.extend(library.materials.into_iter().map(|material| (material, of_library.clone())));
        }
    }
    let mut looks = Vec::with_capacity(frame.material_names.len());
    for (k, name) in frame.material_names.iter().enumerate() {
        if !frame.material_textures.is_empty() {
            let texture = frame.material_textures.get(k).map(|written| texture(folder, written, notes));
            looks.push(Look { material: plain_material(name), texture, uv: UvTransform::default() });
            continue;
        }
        match find(&known, name) {
            Some((LibraryMaterial { material, texture: written, uv }, folder)) => {
                let texture = written.as_ref().map(|written| texture(folder, written, notes));
                looks.push(Look { material: material.clone(), texture, uv: *uv });
            }
            None => {
                if !name.is_empty() && complete && !frame.libraries.is_empty() {
                    let message =
                        format!("the material \"{name}\" is in no library that the file names: it is drawn white");
                    notes.push(Note::new("W_MATERIAL_MISSING", message));
                }
                looks.push(Look { material: plain_material(name), texture: None, uv: UvTransform::default() });
            }
        }
    }
    Ok(looks)
}

/// The material of a name, or of what stands before a comment in it.
fn find<'a>(known: &'a [(LibraryMaterial, PathBuf)], name: &str) -> Option<&'a (LibraryMaterial, PathBuf)> {
    let of = |name: &str| known.iter().find(|(known, _)| known.material.name == name);
    of(name).or_else(|| name.split_once('#').and_then(|(name, _)| of(name.trim_end())))
}

/// `mtllib` may name one file with spaces, or several without: each name as written, and the file.
fn libraries(folder: &Path, statement: &str) -> Vec<(String, Option<beside::FoundFile>)> {
    if let Some(whole) = beside::find(folder, statement) {
        return vec![(statement.to_owned(), Some(whole))];
    }
    let words = statement.split_ascii_whitespace().take(MOST_LIBRARIES);
    let each: Vec<_> = words.map(|word| (word.to_owned(), beside::find(folder, word))).collect();
    if each.iter().any(|(_, found)| found.is_some()) { each } else { vec![(statement.to_owned(), None)] }
}

fn texture(folder: &Path, written: &str, notes: &mut Vec<Note>) -> NamedTexture {
    match beside::find(folder, written) {
        Some(found) => {
            if found.moved {
                notes.push(moved("texture", written, &found.path));
            }
            NamedTexture::Found(found.path)
        }
        None => NamedTexture::Missing(written.to_owned()),
    }
}

fn moved(what: &str, written: &str, path: &Path) -> Note {
    Note::new("W_FILE_MOVED", format!("the {what} {written} is not there: {} is taken", path.display()))
}
