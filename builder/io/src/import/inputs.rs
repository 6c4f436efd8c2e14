//! Which sequences an input names: a file, a folder, a glob or a frame pattern.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::error::ImportError;
use super::gltf::GltfFile;
use super::numbered::{Run, gap_warning, natural, runs};
use super::pattern::Pattern;
use super::warning::Warning;

/// Name of the manifest within a folder.
pub(super) const MANIFEST_NAME: &str = "capture.toml";

/// Where the frames of a sequence come from.
#[derive(Clone)]
pub(super) enum Source {
    /// OBJ or PLY files, one a frame.
    Files(Vec<PathBuf>),
    /// A clip of a glTF file.
    Clip {
        /// The file.
        file: Rc<GltfFile>,
        /// Index of the clip in [`GltfFile::clips`].
        clip: usize,
    },
}

impl Source {
    /// The file that the first frame comes from.
    pub fn path(&self) -> &Path {
        match self {
            Self::Files(paths) => paths.first().map_or(Path::new(""), PathBuf::as_path),
            Self::Clip { file, .. } => file.path(),
        }
    }

    /// Number of frames at `fps`.
    pub fn frame_count(&self, fps: f32) -> u64 {
        match self {
            Self::Files(paths) => paths.len() as u64,
            Self::Clip { file, clip } => file.frame_count(*clip, fps),
        }
    }
}

/// A sequence that an input names.
#[derive(Clone)]
pub(super) struct Found {
    /// Its name.
    pub name: String,
    /// Its frames.
    pub source: Source,
}

/// Finds sequences; keeps opened glTF files and what the user should know.
#[derive(Default)]
pub(super) struct Finder {
    /// Sentences for the user.
    pub warnings: Vec<Warning>,
    gltf_files: HashMap<PathBuf, Rc<GltfFile>>,
}

impl Finder {
    /// The sequences of `input`, seen from the folder `base`.
    pub fn find(&mut self, input: &str, base: &Path) -> Result<Vec<Found>, ImportError> {
        let path = base.join(input);
        if path.is_dir() {
            self.folder(&path)
        } else if path.is_file() {
            self.file(&path)
        } else if Pattern::looks_like(input) {
            let files = Pattern::parse(input)?.files(base)?;
            self.mesh_runs(&path, files, true)
        } else if input.contains(['*', '?', '[']) {
            self.glob(&path)
        } else {
            Err(ImportError::NotFound { path })
        }
    }

    fn file(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        match ending(path).as_str() {
            "glb" | "gltf" => self.gltf(path),
            "obj" | "ply" => Ok(vec![Found { name: stem(path), source: Source::Files(vec![path.to_owned()]) }]),
            _ => Err(ImportError::UnknownFormat { path: path.to_owned() }),
        }
    }

    fn gltf(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        let file = match self.gltf_files.get(path) {
            Some(file) => Rc::clone(file),
            None => {
                let file = Rc::new(GltfFile::open(path)?);
                self.warnings.extend_from_slice(file.warnings());
                self.gltf_files.insert(path.to_owned(), Rc::clone(&file));
                file
            }
        };
        let names = file.clip_names().into_iter().enumerate();
        Ok(names.map(|(clip, name)| Found { name, source: Source::Clip { file: Rc::clone(&file), clip } }).collect())
    }

    fn folder(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        let entries = list(path)?;
        let meshes: Vec<PathBuf> = entries.iter().filter(|p| is_mesh(p) && p.is_file()).cloned().collect();
        if !meshes.is_empty() {
            return self.mesh_runs(path, meshes, false);
        }
        let mut found = Vec::new();
        for file in entries.iter().filter(|p| is_gltf(p) && p.is_file()) {
            found.extend(self.gltf(file)?);
        }
        if found.is_empty() {
            // A folder of folders: each of them that holds meshes is a sequence.
            for folder in entries.iter().filter(|p| p.is_dir()) {
                let meshes: Vec<PathBuf> = list(folder)?.into_iter().filter(|p| is_mesh(p) && p.is_file()).collect();
                if !meshes.is_empty() {
                    found.extend(self.mesh_runs(folder, meshes, false)?);
                }
            }
        }
        if found.is_empty() { Err(ImportError::EmptyFolder { path: path.to_owned() }) } else { Ok(found) }
    }

    fn glob(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        let matches = glob_files(path)?;
        let meshes: Vec<PathBuf> = matches.iter().filter(|p| is_mesh(p) && p.is_file()).cloned().collect();
        let mut found = if meshes.is_empty() { Vec::new() } else { self.mesh_runs(path, meshes, false)? };
        for other in matches.iter().filter(|p| p.is_dir() || is_gltf(p)) {
            found.extend(if other.is_dir() { self.folder(other)? } else { self.gltf(other)? });
        }
        if found.is_empty() {
            Err(ImportError::NoMatch { pattern: path.to_string_lossy().into_owned() })
        } else {
            Ok(found)
        }
    }

    /// Mesh files as sequences: all of them as one where `together`, else one per run of numbers.
    fn mesh_runs(&mut self, input: &Path, files: Vec<PathBuf>, together: bool) -> Result<Vec<Found>, ImportError> {
        for file in &files {
            if !is_mesh(file) {
                return Err(ImportError::UnknownFormat { path: file.clone() });
            }
        }
        if files.iter().any(|f| ending(f) != ending(&files[0])) {
            return Err(ImportError::MixedFormats { path: input.to_owned() });
        }
        let runs = if together {
            let prefix = files.first().map(|f| super::numbered::prefix_and_number(f).0).unwrap_or_default();
            vec![Run { prefix, files }]
        } else {
            runs(files)
        };
        let alone = runs.len() == 1;
        let is_folder = input.is_dir();
        let mut found = Vec::new();
        for run in runs {
            if !together {
                self.warnings.extend(gap_warning(&run.files));
            }
            let name = if alone && is_folder { folder_name(&run) } else { run_name(&run) };
            found.push(Found { name, source: Source::Files(run.files) });
        }
        Ok(found)
    }
}

/// Prefixes that say nothing about the motion.
const DULL_PREFIXES: [&str; 9] = ["", "frame", "f", "mesh", "model", "obj", "ply", "pose", "scan"];

fn run_name(run: &Run) -> String {
    let prefix = run.prefix.trim_end_matches(['_', '-', '.', ' ']);
    if DULL_PREFIXES.contains(&prefix.to_ascii_lowercase().as_str()) { folder_name(run) } else { prefix.to_owned() }
}

fn folder_name(run: &Run) -> String {
    let folder = run.files.first().and_then(|f| f.parent()).and_then(Path::file_name);
    match folder {
        Some(name) => name.to_string_lossy().into_owned(),
        None => "sequence".to_owned(),
    }
}

/// The file name without its ending.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_else(|| "capture".to_owned())
}

/// The ending in lower case.
pub(super) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// The entries of a folder that are not hidden, by name.
pub(super) fn list(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let fail = |source| ImportError::Io { path: folder.to_owned(), source };
    let entries = fs::read_dir(folder).map_err(fail)?;
    let mut paths = entries.map(|e| e.map(|e| e.path()).map_err(fail)).collect::<Result<Vec<_>, _>>()?;
    // Hidden files are no frames: macOS leaves "._" twins behind.
    paths.retain(|path| path.file_name().is_none_or(|name| !name.to_string_lossy().starts_with('.')));
    paths.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(paths)
}

/// The files and folders that a glob names and that are not hidden, by name.
pub(super) fn glob_files(pattern: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let text = pattern.to_string_lossy().into_owned();
    let options = glob::MatchOptions { require_literal_leading_dot: true, ..glob::MatchOptions::default() };
    let paths = glob::glob_with(&text, options)
        .map_err(|e| ImportError::Pattern { pattern: text.clone(), reason: format!("not a glob: {e}") })?;
    let mut matches = Vec::new();
    for entry in paths {
        matches.push(entry.map_err(|e| ImportError::Io { path: e.path().to_owned(), source: e.into() })?);
    }
    matches.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(matches)
}

fn is_mesh(path: &Path) -> bool {
    matches!(ending(path).as_str(), "obj" | "ply")
}

fn is_gltf(path: &Path) -> bool {
    matches!(ending(path).as_str(), "glb" | "gltf")
}
