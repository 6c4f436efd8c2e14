//! A capture with more sequences: its manifest beside the one that it is made from.

use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use toml::{Table, Value};

use super::args::{ImportArguments, UpAxis};

/// Name of the manifest within a folder.
const MANIFEST: &str = "capture.toml";

/// The sequence that is new.
pub struct NewSequence<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its frames, relative to the folder.
    pub input: String,
    /// The texture of all of them, where it is known.
    pub texture: Option<PathBuf>,
    /// Behaviours that it shows.
    pub labels: &'a [String],
    /// Whether its end meets its beginning.
    pub cyclic: bool,
}

/// The manifest of the capture in `folder`: what the input `actor`, read with these arguments, is at `fps` frames a second, and `new`
/// sequences beside.
pub fn manifest(
    folder: &Path,
    (actor, import): (&str, &ImportArguments),
    fps: f32,
    new: &[NewSequence],
) -> Result<String> {
    let path = Path::new(actor);
    let of_folder = path.join(MANIFEST);
    let file = if of_folder.is_file() { of_folder } else { path.to_owned() };
    let is_manifest = file.extension().is_some_and(|extension| extension == "toml");
    let mut table = if is_manifest { described(folder, &file)? } else { Table::new() };
    if !is_manifest {
        let mut sequence = Table::new();
        sequence.insert("input".into(), moved(folder, Path::new(""), actor)?.into());
        table.insert("sequence".into(), Value::Array(vec![sequence.into()]));
    }
    table.insert("fps".into(), Value::Float(fps.into()));
    if let Some(name) = &import.name {
        table.insert("name".into(), name.clone().into());
    }
    if let Some(unit) = import.unit {
        table.insert("unit".into(), Value::Float(unit.into()));
    }
    if let Some(up) = import.up {
        table.insert("up".into(), if up == UpAxis::Z { "z" } else { "y" }.into());
    }
    if let Some(texture) = &import.texture {
        table.insert("texture".into(), moved(folder, Path::new(""), texture)?.into());
    }
    if let Some(weights) = &import.weights {
        table.insert("weights".into(), moved(folder, Path::new(""), &weights.to_string_lossy())?.into());
    }
    let Some(Value::Array(sequences)) = table.get_mut("sequence") else {
        return Err(anyhow!("{} has no [[sequence]]", file.display()));
    };
    for new in new {
        let is_taken = |value: &Value| value.get("name").and_then(Value::as_str) == Some(new.name);
        if sequences.iter().any(is_taken) {
            return Err(anyhow!("there is a sequence {:?} already: name the new one with --as", new.name));
        }
        sequences.push(described_sequence(folder, new)?.into());
    }
    Ok(toml::to_string(&table)?)
}

/// A new sequence, as manifests have it.
pub fn described_sequence(folder: &Path, new: &NewSequence) -> Result<Table> {
    let mut sequence = Table::new();
    sequence.insert("name".into(), new.name.into());
    sequence.insert("input".into(), new.input.clone().into());
    sequence.insert("cyclic".into(), new.cyclic.into());
    let labels = new.labels.iter().map(|label| Value::String(label.clone())).collect();
    sequence.insert("labels".into(), Value::Array(labels));
    if let Some(texture) = &new.texture {
        sequence.insert("texture".into(), moved(folder, Path::new(""), &texture.to_string_lossy())?.into());
    }
    Ok(sequence)
}

/// Whether the frames of a capture are PLY files, as far as its manifest or its name says.
pub fn is_ply(actor: &Path) -> bool {
    let manifest = std::fs::read_to_string(actor.join(MANIFEST)).or_else(|_| std::fs::read_to_string(actor));
    let inside = || actor.read_dir().into_iter().flatten().flatten().any(|entry| names_ply(&entry.path()));
    manifest.is_ok_and(|text| text.contains(".ply")) || names_ply(actor) || inside()
}

fn names_ply(path: &Path) -> bool {
    path.to_string_lossy().to_ascii_lowercase().contains(".ply")
}

/// What a manifest says, its paths seen from `folder`.
fn described(folder: &Path, file: &Path) -> Result<Table> {
    let base = file.parent().unwrap_or(Path::new("")).to_owned();
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    let mut table: Table = text.parse().with_context(|| file.display().to_string())?;
    let path = |table: &mut Table, key: &str| -> Result<()> {
        if let Some(Value::String(path)) = table.get_mut(key) {
            *path = moved(folder, &base, path)?;
        }
        Ok(())
    };
    path(&mut table, "texture")?;
    path(&mut table, "weights")?;
    path(&mut table, "parts")?;
    if let Some(Value::Array(sequences)) = table.get_mut("sequence") {
        for sequence in sequences {
            if let Value::Table(sequence) = sequence {
                ["input", "texture", "mask"].into_iter().try_for_each(|key| path(sequence, key))?;
            }
        }
    }
    Ok(table)
}

/// `path`, which is seen from the folder `base`, as it is seen from `folder`. Patterns and globs keep what they are.
fn moved(folder: &Path, base: &Path, path: &str) -> Result<String> {
    let path = Path::new(path);
    let told = |path: &Path| path.to_string_lossy().replace('\\', "/");
    if path.is_absolute() {
        return Ok(told(path));
    }
    let (from, to) = (std::path::absolute(folder)?, std::path::absolute(base.join(path))?);
    let (from, to): (Vec<Component>, Vec<Component>) = (plain(&from), plain(&to));
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return Ok(told(&to.iter().collect::<PathBuf>()));
    }
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    Ok(told(&up.chain(to[shared..].iter().copied()).collect::<PathBuf>()))
}

/// The parts of an absolute path without steps back.
fn plain(path: &Path) -> Vec<Component<'_>> {
    let mut parts = Vec::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                parts.pop();
            }
            Component::CurDir => {}
            part => parts.push(part),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_seen_from_the_new_folder() {
        let seen = |path| moved(Path::new("/a/out"), Path::new("/a/b"), path).unwrap();
        assert_eq!(seen("walk/%05d.ply:0:9"), "../b/walk/%05d.ply:0:9");
        assert_eq!(seen("../out/x.png"), "x.png");
        assert_eq!(seen("/c/x.png"), "/c/x.png");
    }
}
