//! From inputs and options to a checked list of the sequences to read.

use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::images::is_image;
use super::inputs::{Finder, Found, MANIFEST_NAME, Source, ending, glob_files, list, stem};
use super::manifest::{Manifest, ManifestSequence, UpAxis};
use super::pattern::Pattern;
use super::warning::Warning;
use super::{DEFAULT_FPS, ImportOptions};

/// What is to be read, and how.
pub(super) struct Plan {
    pub name: String,
    pub fps: f32,
    pub up: UpAxis,
    /// Metres per unit of the input.
    pub unit: f32,
    pub weights: Option<PathBuf>,
    pub sequences: Vec<PlannedSequence>,
    pub warnings: Vec<Warning>,
}

/// One sequence to read.
pub(super) struct PlannedSequence {
    pub name: String,
    pub labels: Vec<String>,
    pub cyclic: bool,
    pub source: Source,
    /// Textures that the user names: none, one for all frames, or one a frame.
    pub textures: Vec<PathBuf>,
    /// Masks that the user names, of some frames' textures.
    pub masks: Vec<PathBuf>,
}

/// Finds all sequences of `inputs`; options win over manifests.
pub(super) fn plan(inputs: &[String], options: &ImportOptions) -> Result<Plan, ImportError> {
    let mut finder = Finder::default();
    let mut sequences = Vec::new();
    let mut settings = Settings::default();
    for input in inputs {
        match manifest_of(Path::new(input)) {
            Some(path) => {
                let manifest = Manifest::read(&path)?;
                let folder = path.parent().unwrap_or(Path::new(""));
                for entry in &manifest.sequences {
                    manifest_sequence(&mut finder, entry, &manifest, &path, folder, &mut sequences)?;
                }
                settings.merge(&manifest, folder, &path)?;
            }
            None => sequences.extend(finder.find(input, Path::new(""))?.into_iter().map(PlannedSequence::plain)),
        }
    }
    let Some(first) = sequences.first() else { return Err(ImportError::NoInput) };
    let name = options.name.clone().or(settings.name).unwrap_or_else(|| default_name(inputs, &first.source));
    let mut warnings = finder.warnings;
    make_names_unique(&mut sequences, &mut warnings);
    if let Some(texture) = &options.texture {
        let textures = textures_of(texture, Path::new(""))?;
        for sequence in &mut sequences {
            sequence.textures.clone_from(&textures);
        }
    }
    mark_cyclic(&mut sequences, &options.cyclic)?;
    let given = options.fps.or(settings.fps);
    if given.is_none() && sequences.iter().any(|s| matches!(s.source, Source::Files(_))) {
        warnings.push(Warning::new(
            "W_FPS_ASSUMED",
            format!("no frame rate was given for the mesh files: {DEFAULT_FPS} frames per second are assumed"),
        ));
    }
    let fps = positive(given.unwrap_or(DEFAULT_FPS), "the frame rate (fps)")?;
    let unit = positive(options.unit.or(settings.unit).unwrap_or(1.0), "the unit (metres per unit)")?;
    let up = options.up.or(settings.up).unwrap_or_default();
    let weights = options.weights.clone().or(settings.weights);
    Ok(Plan { name, fps, up, unit, weights, sequences, warnings })
}

impl PlannedSequence {
    fn plain(found: Found) -> Self {
        Self {
            name: found.name,
            labels: Vec::new(),
            cyclic: false,
            source: found.source,
            textures: Vec::new(),
            masks: Vec::new(),
        }
    }
}

/// The manifest that an input means, if it does.
fn manifest_of(input: &Path) -> Option<PathBuf> {
    if input.is_dir() {
        let path = input.join(MANIFEST_NAME);
        return path.is_file().then_some(path);
    }
    (ending(input) == "toml" && input.is_file()).then(|| input.to_owned())
}

/// What manifests say about the whole capture.
#[derive(Default)]
struct Settings {
    name: Option<String>,
    fps: Option<f32>,
    up: Option<UpAxis>,
    unit: Option<f32>,
    weights: Option<PathBuf>,
}

impl Settings {
    fn merge(&mut self, manifest: &Manifest, folder: &Path, path: &Path) -> Result<(), ImportError> {
        merge_one(&mut self.fps, manifest.fps, "fps", path)?;
        merge_one(&mut self.up, manifest.up, "up", path)?;
        merge_one(&mut self.unit, manifest.unit, "unit", path)?;
        let weights = manifest.weights.as_ref().map(|weights| folder.join(weights));
        merge_one(&mut self.weights, weights, "weights", path)?;
        if self.name.is_none() {
            self.name.clone_from(&manifest.name);
        }
        Ok(())
    }
}

fn merge_one<T: PartialEq>(slot: &mut Option<T>, value: Option<T>, key: &str, path: &Path) -> Result<(), ImportError> {
    if value.is_some() && slot.is_some() && *slot != value {
        let reason = format!("another manifest of this capture has another \"{key}\"");
        return Err(ImportError::Manifest { path: path.to_owned(), reason });
    }
    if value.is_some() {
        *slot = value;
    }
    Ok(())
}

fn manifest_sequence(
    finder: &mut Finder,
    entry: &ManifestSequence,
    manifest: &Manifest,
    path: &Path,
    folder: &Path,
    sequences: &mut Vec<PlannedSequence>,
) -> Result<(), ImportError> {
    let wrong = |reason: String| ImportError::Manifest { path: path.to_owned(), reason };
    let mut found = finder.find(&entry.input, folder)?;
    if let Some(clip) = &entry.clip {
        let known = names(found.iter().map(|f| &f.name));
        if !found.iter().all(|f| matches!(f.source, Source::Clip { .. })) {
            return Err(wrong(format!("clip = \"{clip}\": {} is no glTF file", entry.input)));
        }
        found.retain(|f| f.name == *clip);
        if found.is_empty() {
            return Err(ImportError::UnknownClip { path: folder.join(&entry.input), clip: clip.clone(), known });
        }
    }
    if let (Some(name), true) = (&entry.name, found.len() > 1) {
        let known = names(found.iter().map(|f| &f.name));
        return Err(wrong(format!(
            "sequence \"{name}\" ({}) holds {} sequences ({known}): name one with clip, or make an entry for each",
            entry.input,
            found.len()
        )));
    }
    let texture = entry.texture.as_ref().or(manifest.texture.as_ref());
    let textures = texture.map_or(Ok(Vec::new()), |texture| textures_of(texture, folder))?;
    let masks = entry.mask.as_ref().map_or(Ok(Vec::new()), |mask| textures_of(mask, folder))?;
    sequences.extend(found.into_iter().map(|found| PlannedSequence {
        name: entry.name.clone().unwrap_or(found.name),
        labels: entry.labels.clone(),
        cyclic: entry.cyclic,
        source: found.source,
        textures: textures.clone(),
        masks: masks.clone(),
    }));
    Ok(())
}

/// The image files that a texture input names: a file, a folder, a glob or a pattern.
fn textures_of(input: &str, base: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let path = base.join(input);
    let files: Vec<PathBuf> = if path.is_file() {
        vec![path]
    } else if path.is_dir() {
        list(&path)?.into_iter().filter(|p| is_image(p)).collect()
    } else if Pattern::looks_like(input) {
        Pattern::parse(input)?.files(base)?
    } else if input.contains(['*', '?', '[']) {
        glob_files(&path)?.into_iter().filter(|p| is_image(p)).collect()
    } else {
        return Err(ImportError::NotFound { path });
    };
    if files.is_empty() {
        return Err(ImportError::NoMatch { pattern: input.to_owned() });
    }
    Ok(files)
}

fn make_names_unique(sequences: &mut [PlannedSequence], warnings: &mut Vec<Warning>) {
    let mut seen = std::collections::HashSet::new();
    for sequence in sequences {
        if seen.insert(sequence.name.clone()) {
            continue;
        }
        let unique = (2_u32..).map(|k| format!("{} {k}", sequence.name)).find(|name| seen.insert(name.clone()));
        if let Some(unique) = unique {
            warnings.push(Warning::new(
                "W_NAME_TAKEN",
                format!("two sequences are named \"{}\": the later one becomes \"{unique}\"", sequence.name),
            ));
            sequence.name = unique;
        }
    }
}

fn mark_cyclic(sequences: &mut [PlannedSequence], cyclic: &[String]) -> Result<(), ImportError> {
    for name in cyclic {
        match sequences.iter_mut().find(|s| s.name == *name) {
            Some(sequence) => sequence.cyclic = true,
            None => {
                let known = names(sequences.iter().map(|s| &s.name));
                return Err(ImportError::UnknownSequence { name: name.clone(), known });
            }
        }
    }
    Ok(())
}

fn names<'a>(names: impl Iterator<Item = &'a String>) -> String {
    names.map(String::as_str).collect::<Vec<_>>().join(", ")
}

fn default_name(inputs: &[String], source: &Source) -> String {
    match inputs {
        [input] if Path::new(input).exists() => stem(&Path::new(input).canonicalize().unwrap_or_default()),
        _ => match source.path().parent().and_then(Path::file_name) {
            Some(folder) => folder.to_string_lossy().into_owned(),
            None => stem(source.path()),
        },
    }
}

fn positive(value: f32, what: &str) -> Result<f32, ImportError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(ImportError::Option(format!("{what} must be a positive number, not {value}")))
}
