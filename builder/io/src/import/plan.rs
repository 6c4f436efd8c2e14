//! From inputs and options to a checked list of the sequences to read.

use std::path::{Path, PathBuf};

use actor::files::FilePlace;
use glam::DVec3;

use super::error::ImportError;
use super::families::{ManifestFamily, contradiction};
use super::folder::list;
use super::formats::unread_image;
use super::images::is_image;
use super::inputs::{Finder, Found, MANIFEST_NAME, Named, Source, with_slashes};
use super::layers::TextureLayer;
use super::manifest::{Manifest, ManifestSequence, UpAxis};
use super::paths::{ending, folder_of, name_of_folder, stem};
use super::vologram;
use super::warning::Warning;
use super::{Cyclic, DEFAULT_FPS, ImportOptions};

/// What is to be read, and how.
pub(super) struct Plan {
    pub name: String,
    pub fps: f32,
    pub up: UpAxis,
    /// Metres per unit of the input.
    pub unit: f32,
    pub weights: Option<PathBuf>,
    /// A file with the number of each vertex's part of the body.
    pub parts: Option<PathBuf>,
    pub sequences: Vec<PlannedSequence>,
    pub families: Vec<ManifestFamily>,
    pub warnings: Vec<Warning>,
}

impl Plan {
    /// Metres per unit of the input, with the decimals that were typed: 0.01 with 32 bits is wrong by 13 cm at 6,000 km.
    pub fn metres_per_unit(&self) -> f64 {
        self.unit.to_string().parse().unwrap_or(f64::from(self.unit))
    }

    /// Where the files are, when `offset` was taken off their positions, in metres.
    pub fn place(&self, offset: DVec3) -> FilePlace {
        FilePlace { offset, unit: self.metres_per_unit(), z_up: self.up == UpAxis::Z }
    }
}

/// One sequence to read.
pub(super) struct PlannedSequence {
    pub name: String,
    pub labels: Vec<String>,
    /// Whether the end meets the beginning; to be found out where it is not said.
    pub cyclic: Option<bool>,
    pub source: Source,
    /// Textures that the user names.
    pub textures: NamedImages,
    /// Masks that the user names, of some frames' textures.
    pub masks: Vec<PathBuf>,
    /// The texture of each frame, where they are pictures of KTX2 files; else empty.
    pub layers: Vec<TextureLayer>,
}

/// Images that the user names for a sequence: none, one for all frames, or one a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct NamedImages {
    pub files: Vec<PathBuf>,
    /// Whether a range of numbers says which they are, so that their order says which frame each belongs to.
    pub in_order: bool,
}

/// Finds all sequences of `inputs`; options win over manifests.
pub(super) fn plan(inputs: &[String], options: &ImportOptions) -> Result<Plan, ImportError> {
    let mut finder = Finder::default();
    let mut sequences = Vec::new();
    let mut settings = Settings::default();
    let (mut families, mut told_in): (Vec<ManifestFamily>, Option<PathBuf>) = (Vec::new(), None);
    for input in inputs {
        match manifest_of(Path::new(input)) {
            Some(path) => {
                let manifest = Manifest::read(&path)?;
                let folder = path.parent().unwrap_or(Path::new(""));
                for entry in &manifest.sequences {
                    manifest_sequence((&mut finder, &mut settings), entry, &manifest, &path, folder, &mut sequences)?;
                }
                settings.merge(&manifest, folder, &path)?;
                if !manifest.families.is_empty() {
                    families.extend(manifest.families);
                    told_in = Some(path);
                }
            }
            None => {
                let found = finder.find(input, Path::new(""))?;
                found.iter().try_for_each(|found| settings.describe(found, Path::new(input)))?;
                sequences.extend(found.into_iter().map(PlannedSequence::plain));
            }
        }
    }
    if sequences.is_empty() {
        return Err(ImportError::NoInput);
    }
    let name = options.name.clone().or(settings.name).unwrap_or_else(|| default_name(inputs, &sequences));
    let mut warnings = finder.warnings;
    make_names_unique(&mut sequences, &mut warnings);
    let known: Vec<&String> = sequences.iter().map(|sequence| &sequence.name).collect();
    if let (Some(path), Some(reason)) = (told_in, contradiction(&families, &known)) {
        return Err(ImportError::Manifest { path, reason });
    }
    if let Some(texture) = &options.texture {
        let textures = images_of(texture, Path::new(""))?;
        for sequence in &mut sequences {
            sequence.textures.clone_from(&textures);
        }
    }
    mark_cyclic(&mut sequences, &options.cyclic)?;
    let given = options.fps.or(settings.fps);
    if given.is_none() && sequences.iter().any(|s| !s.source.files().is_empty()) {
        warnings.push(Warning::new(
            "W_FPS_ASSUMED",
            format!("no frame rate was given for the mesh files: {DEFAULT_FPS} frames per second are assumed"),
        ));
    }
    let fps = positive(given.unwrap_or(DEFAULT_FPS), "the frame rate (fps)")?;
    let unit = positive(options.unit.or(settings.unit).unwrap_or(1.0), "the unit (metres per unit)")?;
    let up = options.up.or(settings.up).unwrap_or_default();
    let weights = options.weights.clone().or(settings.weights);
    Ok(Plan { name, fps, up, unit, weights, parts: settings.parts, sequences, families, warnings })
}

impl PlannedSequence {
    fn plain(found: Found) -> Self {
        Self {
            name: found.name,
            labels: Vec::new(),
            cyclic: None,
            source: found.source,
            textures: NamedImages::default(),
            masks: Vec::new(),
            layers: found.described.layers,
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
    parts: Option<PathBuf>,
}

impl Settings {
    fn merge(&mut self, manifest: &Manifest, folder: &Path, path: &Path) -> Result<(), ImportError> {
        merge_one(&mut self.fps, manifest.fps, "fps", path)?;
        merge_one(&mut self.up, manifest.up, "up", path)?;
        merge_one(&mut self.unit, manifest.unit, "unit", path)?;
        let weights = manifest.weights.as_ref().map(|weights| folder.join(weights));
        merge_one(&mut self.weights, weights, "weights", path)?;
        let parts = manifest.parts.as_ref().map(|parts| folder.join(parts));
        merge_one(&mut self.parts, parts, "parts", path)?;
        if self.name.is_none() {
            self.name.clone_from(&manifest.name);
        }
        Ok(())
    }

    /// What the manifest of a volumetric video says.
    fn describe(&mut self, found: &Found, path: &Path) -> Result<(), ImportError> {
        merge_one(&mut self.fps, found.described.fps, "frameRate", path)?;
        merge_one(&mut self.unit, found.described.unit, "scale", path)
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
    (finder, settings): (&mut Finder, &mut Settings),
    entry: &ManifestSequence,
    manifest: &Manifest,
    path: &Path,
    folder: &Path,
    sequences: &mut Vec<PlannedSequence>,
) -> Result<(), ImportError> {
    let wrong = |reason: String| ImportError::Manifest { path: path.to_owned(), reason };
    let mut found = finder.find(&entry.input, folder)?;
    found.iter().try_for_each(|found| settings.describe(found, path))?;
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
    let images = |input: Option<&String>| input.map_or(Ok(NamedImages::default()), |input| images_of(input, folder));
    let (textures, masks) = (images(texture)?, images(entry.mask.as_ref())?.files);
    sequences.extend(found.into_iter().map(|found| PlannedSequence {
        name: entry.name.clone().unwrap_or(found.name),
        labels: entry.labels.clone(),
        cyclic: entry.cyclic,
        source: found.source,
        textures: textures.clone(),
        masks: masks.clone(),
        layers: found.described.layers,
    }));
    Ok(())
}

/// The image files that a texture input names: a file, a folder, a glob or a pattern.
fn images_of(input: &str, base: &Path) -> Result<NamedImages, ImportError> {
    let input = &*with_slashes(input, base);
    let path = base.join(input);
    if path.is_file() {
        return Ok(NamedImages { files: vec![path], in_order: false });
    }
    let (all, in_order) = if path.is_dir() {
        (list(&path)?, false)
    } else {
        let named = Named::new(input, base);
        let files = named.files()?.ok_or_else(|| ImportError::NotFound { path: path.clone() })?;
        // The files of a pattern are meant, whatever they are.
        if named.is_pattern() {
            return Ok(NamedImages { files, in_order: named.has_range() });
        }
        (files, false)
    };
    let files: Vec<PathBuf> = all.iter().filter(|path| is_image(path)).cloned().collect();
    match all.iter().find(|path| unread_image(path).is_some()).or(all.first()) {
        _ if !files.is_empty() => Ok(NamedImages { files, in_order }),
        Some(other) => {
            let told = unread_image(other).unwrap_or("not an image that is read: textures are PNG, JPEG or WebP");
            Err(ImportError::UnknownFormat { path: other.clone(), told })
        }
        None => Err(ImportError::NoMatch { pattern: path.to_string_lossy().into_owned(), hint: String::new() }),
    }
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

/// Settles what is asked about loops; what stays `None` is to be found out.
fn mark_cyclic(sequences: &mut [PlannedSequence], cyclic: &Cyclic) -> Result<(), ImportError> {
    let names_given = match cyclic {
        Cyclic::Auto => return Ok(()),
        Cyclic::None => {
            sequences.iter_mut().for_each(|sequence| sequence.cyclic = Some(false));
            return Ok(());
        }
        Cyclic::Names(names) => names,
    };
    for name in names_given {
        match sequences.iter_mut().find(|s| s.name == *name) {
            Some(sequence) => sequence.cyclic = Some(true),
            None => {
                let known = names(sequences.iter().map(|s| &s.name));
                return Err(ImportError::UnknownSequence { name: name.clone(), known });
            }
        }
    }
    sequences.iter_mut().for_each(|sequence| sequence.cyclic = sequence.cyclic.or(Some(false)));
    Ok(())
}

fn names<'a>(names: impl Iterator<Item = &'a String>) -> String {
    names.map(String::as_str).collect::<Vec<_>>().join(", ")
}

/// The name of the one input, or of the folder that holds all files; their sequences' names where they share none.
fn default_name(inputs: &[String], sequences: &[PlannedSequence]) -> String {
    if let [input] = inputs
        && let Ok(path) = Path::new(input).canonicalize()
    {
        return stem_of_input(&path);
    }
    let mut shared: Option<PathBuf> = None;
    for sequence in sequences {
        // The first two files show whether folders are frames.
        let files = sequence.source.files().iter().take(2).map(PathBuf::as_path);
        for file in files.chain([sequence.source.path()]) {
            let folder = folder_of(file);
            let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
            shared = Some(shared.map_or_else(|| folder.clone(), |shared| common_folder(&shared, &folder)));
        }
    }
    let name = shared.map(|folder| if folder.parent().is_some() { name_of_folder(&folder) } else { String::new() });
    name.filter(|name| !name.is_empty()).unwrap_or_else(|| names(sequences.iter().take(3).map(|s| &s.name)))
}

/// A folder's whole name, also where its manifest is named; a file's without its ending.
fn stem_of_input(path: &Path) -> String {
    if path.is_dir() {
        name_of_folder(path)
    } else if path.file_name().is_some_and(|name| name == MANIFEST_NAME) {
        name_of_folder(folder_of(path))
    } else if vologram::may_be(path) {
        vologram::name(path)
    } else {
        stem(path)
    }
}

/// The deepest folder that holds both.
fn common_folder(a: &Path, b: &Path) -> PathBuf {
    a.components().zip(b.components()).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
}

fn positive(value: f32, what: &str) -> Result<f32, ImportError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(ImportError::Option(format!("{what} must be a positive number, not {value}")))
}
