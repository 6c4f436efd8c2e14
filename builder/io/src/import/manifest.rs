//! The capture manifest, a TOML file; every key is described in `docs/capture-manifest.md`.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::error::ImportError;
use super::families::ManifestFamily;
use super::images::read_file;
use super::text::utf8_without_mark;

/// Which axis of the input points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// +Y, as in glTF.
    #[default]
    Y,
    /// +Z; +Y then points away from the viewer.
    Z,
}

/// A manifest as written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    pub name: Option<String>,
    pub fps: Option<f32>,
    pub up: Option<UpAxis>,
    pub unit: Option<f32>,
    pub weights: Option<PathBuf>,
    pub parts: Option<PathBuf>,
    pub texture: Option<String>,
    #[serde(rename = "sequence", default)]
    pub sequences: Vec<ManifestSequence>,
    #[serde(rename = "family", default)]
    pub families: Vec<ManifestFamily>,
}

/// One `[[sequence]]` of a manifest.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ManifestSequence {
    pub name: Option<String>,
    pub input: String,
    pub clip: Option<String>,
    #[serde(default, alias = "behaviours")]
    pub labels: Vec<String>,
    /// Whether the end meets the beginning; found out where it is not said.
    pub cyclic: Option<bool>,
    pub texture: Option<String>,
    pub mask: Option<String>,
}

impl Manifest {
    /// Reads the manifest at `path`.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let wrong = |reason: String| ImportError::Manifest { path: path.to_owned(), reason };
        let bytes = read_file(path)?;
        let text = std::str::from_utf8(&utf8_without_mark(&bytes))
            .map_err(|_| wrong("it is not UTF-8 text".into()))?
            .to_owned();
        // TOML knows no carriage return alone.
        let text = text.replace("\r\n", "\n").replace('\r', "\n");
        let manifest: Self = toml::from_str(&text).map_err(|error| {
            let error = error.to_string();
            // "C:\Users" is no string of TOML.
            let hint =
                if error.contains("escape") || error.contains("unicode") { "\nwrite / for \\ in paths" } else { "" };
            wrong(format!("{}{hint}", error.trim_end()))
        })?;
        if manifest.sequences.is_empty() {
            return Err(wrong("there is no [[sequence]]".into()));
        }
        let mut names: Vec<&String> = manifest.sequences.iter().filter_map(|s| s.name.as_ref()).collect();
        names.sort();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(wrong(format!("two sequences are named \"{}\"", twice[0])));
        }
        for family in &manifest.families {
            family.check().map_err(|reason| wrong(format!("family \"{}\": {reason}", family.name)))?;
        }
        Ok(manifest)
    }
}
