//! Which sequences an input names: a file, a folder, a glob or a frame pattern.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::error::ImportError;
use super::folder::list;
use super::formats::unread;
use super::gltf::GltfFile;
use super::layers::TextureLayer;
use super::numbered::{Run, double_warning, gap_warning, name_of, natural, negative_warning, run_of_folders, runs};
use super::paths::{ending, name_of_folder, stem};
use super::pattern::Pattern;
#[cfg(feature = "gltf")]
use super::uvol::{self, Uvol};
use super::vologram;
use super::vologram::take::Vologram;
use super::warning::Warning;

/// Name of the manifest within a folder.
pub(super) const MANIFEST_NAME: &str = "capture.toml";
/// From so many sequences of one frame on it is likely that they are one sequence.
const MANY_STILLS: usize = 3;

/// Where the frames of a sequence come from.
#[derive(Clone)]
pub(super) enum Source {
    /// OBJ, PLY or Draco files, one a frame, or the frames of a vologram.
    Files(Vec<PathBuf>),
    /// glTF files, one a frame.
    Stills(Vec<PathBuf>),
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
            Self::Files(paths) | Self::Stills(paths) => paths.first().map_or(Path::new(""), PathBuf::as_path),
            Self::Clip { file, .. } => file.path(),
        }
    }

    /// The files of the frames; none where they come from one file.
    pub fn files(&self) -> &[PathBuf] {
        match self {
            Self::Files(paths) | Self::Stills(paths) => paths,
            Self::Clip { .. } => &[],
        }
    }

    /// Number of frames at `fps`.
    pub fn frame_count(&self, fps: f32) -> u64 {
        match self {
            Self::Files(paths) | Self::Stills(paths) => paths.len() as u64,
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
    /// What the input itself says of them.
    pub described: Described,
}

impl Found {
    fn new(name: String, source: Source) -> Self {
        Self { name, source, described: Described::default() }
    }
}

/// What the manifest of a volumetric video says of its frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Described {
    /// Frames per second.
    pub fps: Option<f32>,
    /// Metres per unit.
    pub unit: Option<f32>,
    /// The texture of each frame; empty where none is named.
    pub layers: Vec<TextureLayer>,
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
        let input = &*with_slashes(input, base);
        let path = base.join(input);
        let found = if path.is_dir() {
            self.folder(&path)?
        } else if path.is_file() {
            return self.file(&path);
        } else {
            let named = Named::new(input, base);
            match named.files()? {
                Some(files) if named.is_pattern() => return self.pattern(&path, &named, files),
                Some(files) => self.matches(&path, files)?,
                None => return Err(ImportError::NotFound { path }),
            }
        };
        self.warn_about_stills(&path, &found);
        Ok(found)
    }

    fn file(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        match ending(path).as_str() {
            "glb" | "gltf" => self.clips(path),
            _ if vologram::may_be(path) => self.vologram(path).map(|found| vec![found]),
            "obj" | "ply" | "drc" => Ok(vec![Found::new(stem(path), Source::Files(vec![path.to_owned()]))]),
            #[cfg(feature = "gltf")]
            _ if uvol::may_be(path) => self.uvol(path).map(|found| vec![found]),
            _ => Err(ImportError::unknown_format(path)),
        }
    }

    /// The frames of a volumetric video.
    #[cfg(feature = "gltf")]
    fn uvol(&mut self, path: &Path) -> Result<Found, ImportError> {
        let Uvol { name, files, stills, fps, unit, layers, warnings } = Uvol::read(path)?;
        self.warnings.extend(warnings);
        let source = if stills { Source::Stills(files) } else { Source::Files(files) };
        Ok(Found { name, source, described: Described { fps: Some(fps), unit, layers } })
    }

    /// The frames of a vologram.
    fn vologram(&mut self, path: &Path) -> Result<Found, ImportError> {
        let Vologram { name, frames, fps, layers, warnings } = Vologram::read(path)?;
        self.warnings.extend(warnings);
        Ok(Found { name, source: Source::Files(frames), described: Described { fps, unit: None, layers } })
    }

    /// The volograms whose headers are among `files`.
    fn volograms(&mut self, files: &[PathBuf]) -> Result<Vec<Found>, ImportError> {
        files.iter().filter(|path| vologram::is_header(path)).map(|path| self.vologram(path)).collect()
    }

    /// All clips of a glTF file.
    fn clips(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
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
        Ok(names.map(|(clip, name)| Found::new(name, Source::Clip { file: Rc::clone(&file), clip })).collect())
    }

    /// glTF files: those of one run that hold a still each are the frames of a sequence; others give their clips.
    fn gltf_files(&mut self, input: &Path, files: &[PathBuf]) -> Result<Vec<Found>, ImportError> {
        let mut found = Vec::new();
        let (runs, joined) = runs_anywhere(files.to_vec());
        for run in runs {
            let alone = run.files.len() == files.len();
            if run.files.len() > 1 && Self::are_stills(&run.files)? {
                self.warn_about_run(&run, joined);
                let name = if alone && input.is_dir() { folder_name(&run) } else { run_name(&run) };
                found.push(Found::new(name, Source::Stills(run.files)));
                continue;
            }
            for file in &run.files {
                found.extend(self.clips(file)?);
            }
        }
        Ok(found)
    }

    /// Whether all of `files` hold one pose only. They are not kept open: there may be thousands.
    fn are_stills(files: &[PathBuf]) -> Result<bool, ImportError> {
        // At this rate no clip is so short that it would be one frame.
        const FAST: f32 = 1e6;
        for path in files {
            let file = GltfFile::open(path)?;
            if file.clip_names().len() != 1 || file.frame_count(0, FAST) != 1 {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn folder(&mut self, path: &Path) -> Result<Vec<Found>, ImportError> {
        let entries = list(path)?;
        #[cfg(feature = "gltf")]
        {
            let manifests: Vec<&PathBuf> = entries.iter().filter(|entry| uvol::is_manifest(entry)).collect();
            if !manifests.is_empty() {
                return manifests.into_iter().map(|manifest| self.uvol(manifest)).collect();
            }
        }
        let volograms = self.volograms(&entries)?;
        if !volograms.is_empty() {
            return Ok(volograms);
        }
        let meshes = files_of(&entries, is_mesh);
        let scenes = files_of(&entries, is_gltf);
        let folders: Vec<PathBuf> = entries.iter().filter(|p| p.is_dir()).cloned().collect();
        if !meshes.is_empty() || !scenes.is_empty() {
            self.warn_about_left_out(path, &meshes, &scenes, &folders);
            return if meshes.is_empty() { self.gltf_files(path, &scenes) } else { self.mesh_runs(path, meshes) };
        }
        let found = self.folders(path, &folders)?;
        if found.is_empty() { Err(ImportError::no_mesh_in(path, &entries)) } else { Ok(found) }
    }

    /// A folder of folders: each of them that holds meshes is a sequence, or each is a frame.
    fn folders(&mut self, path: &Path, folders: &[PathBuf]) -> Result<Vec<Found>, ImportError> {
        let (mut lists, mut scenes, mut volograms) = (Vec::new(), Vec::new(), Vec::new());
        for folder in folders {
            let entries = list(folder)?;
            volograms.extend(self.volograms(&entries)?);
            let meshes = files_of(&entries, is_mesh);
            if meshes.is_empty() {
                scenes.extend(files_of(&entries, is_gltf));
            } else {
                self.warn_about_manifest(folder);
                lists.push((folder, meshes));
            }
        }
        let all: Vec<PathBuf> = lists.iter().flat_map(|(_, meshes)| meshes.iter().cloned()).collect();
        if lists.is_empty() && volograms.is_empty() && !scenes.is_empty() {
            return self.gltf_files(path, &scenes);
        }
        if run_of_folders(&all).is_some() {
            return self.mesh_runs(path, all);
        }
        let mut found = volograms;
        for (folder, meshes) in lists {
            found.extend(self.mesh_runs(folder, meshes)?);
        }
        Ok(found)
    }

    /// What a glob matches.
    fn matches(&mut self, path: &Path, matches: Vec<PathBuf>) -> Result<Vec<Found>, ImportError> {
        let meshes = files_of(&matches, is_mesh);
        let mut found = if meshes.is_empty() { Vec::new() } else { self.mesh_runs(path, meshes)? };
        let scenes = files_of(&matches, is_gltf);
        found.extend(self.gltf_files(path, &scenes)?);
        found.extend(self.volograms(&matches)?);
        for folder in matches.iter().filter(|p| p.is_dir()) {
            self.warn_about_manifest(folder);
            found.extend(self.folder(folder)?);
        }
        let other = matches.iter().find(|path| path.is_file() && unread(path).is_some()).or(matches.first());
        match other.filter(|_| found.is_empty()) {
            Some(manifest) if ending(manifest) == "toml" => {
                let told = "a manifest is named by itself, not by a glob";
                Err(ImportError::UnknownFormat { path: manifest.clone(), told })
            }
            Some(other) => Err(ImportError::unknown_format(other)),
            None => Ok(found),
        }
    }

    /// The files of a pattern, which are always one sequence.
    fn pattern(&mut self, input: &Path, named: &Named, files: Vec<PathBuf>) -> Result<Vec<Found>, ImportError> {
        if let Some(other) = files.iter().find(|file| !is_mesh(file) && !is_gltf(file)) {
            return Err(ImportError::unknown_format(other));
        }
        check_one_kind(input, &files)?;
        let numbers = super::numbered::numbers_of(&files).unwrap_or_default();
        let name =
            runs(files.iter().take(2).cloned().collect()).first().map(|run| run.name.clone()).unwrap_or_default();
        let run = Run { name, files, numbers };
        if !named.has_range() {
            self.warn_about_run(&run, false);
        }
        let name = run_name(&run);
        if run.files.first().is_some_and(|file| is_mesh(file)) {
            return Ok(vec![Found::new(name, Source::Files(run.files))]);
        }
        if Self::are_stills(&run.files)? {
            return Ok(vec![Found::new(name, Source::Stills(run.files))]);
        }
        let clips = run.files.iter().map(|file| self.clips(file)).collect::<Result<Vec<_>, _>>()?;
        Ok(clips.concat())
    }

    /// Mesh files as sequences, one per run of numbers.
    fn mesh_runs(&mut self, input: &Path, files: Vec<PathBuf>) -> Result<Vec<Found>, ImportError> {
        check_one_kind(input, &files)?;
        let (runs, joined) = runs_anywhere(files);
        let alone = runs.len() == 1;
        let mut found = Vec::new();
        for run in runs {
            self.warn_about_run(&run, joined);
            let name = if alone && input.is_dir() { folder_name(&run) } else { run_name(&run) };
            found.push(Found::new(name, Source::Files(run.files)));
        }
        Ok(found)
    }

    /// Says what is unusual about the numbers of a run; `joined` where they are those of folders.
    fn warn_about_run(&mut self, run: &Run, joined: bool) {
        if joined {
            let first = run.files.first().map(|file| file.display().to_string()).unwrap_or_default();
            self.warnings.push(Warning::new(
                "W_FOLDERS_JOINED",
                format!(
                    "{first}: {} folders hold a file each and differ in a number: they are read as the frames of one sequence",
                    run.files.len()
                ),
            ));
        }
        self.warnings.extend(gap_warning(run));
        self.warnings.extend(double_warning(run));
        self.warnings.extend(negative_warning(run));
    }

    /// Files and folders of a capture beside those that are read.
    fn warn_about_left_out(&mut self, path: &Path, meshes: &[PathBuf], scenes: &[PathBuf], folders: &[PathBuf]) {
        let mut others: Vec<&PathBuf> = if meshes.is_empty() { Vec::new() } else { scenes.iter().collect() };
        let holds_mesh = |folder: &&PathBuf| {
            list(folder)
                .is_ok_and(|entries| entries.iter().any(|entry| (is_mesh(entry) || is_gltf(entry)) && entry.is_file()))
        };
        others.extend(folders.iter().filter(holds_mesh));
        let Some(first) = others.first() else { return };
        let more = if others.len() > 1 { format!(" and {} more", others.len() - 1) } else { String::new() };
        let read = if meshes.is_empty() {
            "the glTF files of this folder are read"
        } else {
            "the mesh files of this folder are read"
        };
        self.warnings.push(Warning::new(
            "W_INPUT_LEFT_OUT",
            format!(
                "{}: {read}, and {}{more} left out: name them, too, if they belong to the capture",
                path.display(),
                first.display()
            ),
        ));
    }

    /// A manifest in a folder that is not read as a capture of its own.
    fn warn_about_manifest(&mut self, folder: &Path) {
        let manifest = folder.join(MANIFEST_NAME);
        if manifest.is_file() {
            self.warnings.push(Warning::new(
                "W_MANIFEST_UNREAD",
                format!(
                    "{}: is not read, for its folder is only a part of this input: name the folder itself to use it",
                    manifest.display()
                ),
            ));
        }
    }

    /// Sequences of one frame that may be meant as the frames of one sequence.
    fn warn_about_stills(&mut self, path: &Path, found: &[Found]) {
        let alone = |found: &Found| match &found.source {
            Source::Files(files) | Source::Stills(files) => (files.len() == 1).then(|| files[0].clone()),
            Source::Clip { file, .. } => {
                (file.clip_names().len() == 1 && file.frame_count(0, 1e6) == 1).then(|| file.path().to_owned())
            }
        };
        let stills: Vec<PathBuf> = found.iter().filter_map(alone).collect();
        if stills.len() < MANY_STILLS || 2 * stills.len() <= found.len() {
            return;
        }
        let names: Vec<String> = stills.iter().take(2).map(|path| name_of(path)).collect();
        self.warnings.push(Warning::new(
            "W_SINGLE_FRAMES",
            format!(
                "{}: {} files become {} sequences of one frame each, for no number in their names orders them ({}, ...): if \
                 they are the frames of one sequence, number them, as in frame_0001",
                path.display(),
                stills.len(),
                stills.len(),
                names.join(", ")
            ),
        ));
    }
}

/// `input` with `/` for the `\` of another system, unless a file is named so.
pub(super) fn with_slashes<'a>(input: &'a str, base: &Path) -> Cow<'a, str> {
    if input.contains('\\') && !base.join(input).exists() { input.replace('\\', "/").into() } else { input.into() }
}

/// An input that is no single file or folder: a pattern or a glob.
pub(super) struct Named {
    /// The folders that the input begins with and that exist as they are written, whatever characters they hold.
    base: PathBuf,
    /// What follows them.
    rest: String,
}

impl Named {
    /// What `input` means, seen from the folder `base`.
    pub fn new(input: &str, base: &Path) -> Self {
        let (mut base, mut rest) = (base.to_owned(), input);
        if let Some(tail) = rest.strip_prefix('/') {
            (base, rest) = (PathBuf::from("/"), tail);
        }
        while let Some((folder, tail)) = rest.split_once(['/', std::path::MAIN_SEPARATOR])
            && (folder.is_empty() || base.join(folder).is_dir())
        {
            base.push(folder);
            rest = tail;
        }
        Self { base, rest: rest.to_owned() }
    }

    /// Whether it is a pattern (`frame_%05d.obj`).
    pub fn is_pattern(&self) -> bool {
        Pattern::looks_like(&self.rest)
    }

    /// Whether it is a pattern with a range.
    pub fn has_range(&self) -> bool {
        self.is_pattern() && Pattern::parse(&self.rest).is_ok_and(|pattern| pattern.has_range())
    }

    /// The files of a pattern by number, or the files and folders of a glob by name; `None` where it is neither.
    pub fn files(&self) -> Result<Option<Vec<PathBuf>>, ImportError> {
        if self.is_pattern() {
            return Pattern::parse(&self.rest)?.files(&self.base).map(Some);
        }
        if !self.rest.contains(['*', '?', '[']) {
            return Ok(None);
        }
        // Brackets mean one of several characters, or themselves where that names nothing.
        let matches = match glob_files(&self.base, &self.rest, true) {
            Ok(matches) if !matches.is_empty() => matches,
            _ if self.rest.contains('[') => glob_files(&self.base, &self.rest.replace('[', "[[]"), true)?,
            matches => matches?,
        };
        if !matches.is_empty() {
            return Ok(Some(matches));
        }
        let pattern = self.base.join(&self.rest).to_string_lossy().into_owned();
        let almost = glob_files(&self.base, &self.rest, false)?.into_iter().next();
        Err(ImportError::NoMatch {
            pattern,
            hint: almost.map(|path| format!(", but {} almost does", path.display())).unwrap_or_default(),
        })
    }
}

/// The runs of `files`, or the one that is numbered by folders; and whether it is that one.
fn runs_anywhere(files: Vec<PathBuf>) -> (Vec<Run>, bool) {
    match run_of_folders(&files) {
        Some(run) => (vec![run], true),
        None => (runs(files), false),
    }
}

fn check_one_kind(input: &Path, files: &[PathBuf]) -> Result<(), ImportError> {
    let kinds = ["obj", "ply", "drc"].map(|kind| (kind, files.iter().filter(|file| ending(file) == kind).count()));
    let found: Vec<String> =
        kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, n)| format!("{n} .{kind}")).collect();
    if found.len() < 2 {
        return Ok(());
    }
    Err(ImportError::MixedFormats { path: input.to_owned(), found: found.join(" and ") })
}

fn files_of(entries: &[PathBuf], kind: fn(&Path) -> bool) -> Vec<PathBuf> {
    entries.iter().filter(|path| kind(path) && path.is_file()).cloned().collect()
}

/// Names that say nothing about the motion.
const DULL_NAMES: [&str; 12] =
    ["", "frame", "f", "mesh", "model", "obj", "ply", "pose", "scan", "glb", "drc", "geometry"];

fn run_name(run: &Run) -> String {
    if DULL_NAMES.contains(&run.name.to_ascii_lowercase().as_str()) { folder_name(run) } else { run.name.clone() }
}

/// The name of the folder that holds the files of a run, or their folders where these are the frames.
fn folder_name(run: &Run) -> String {
    let folders: Vec<&Path> = run.files.iter().take(2).filter_map(|file| file.parent()).collect();
    let folder = match folders.as_slice() {
        [first, second] if first != second => first.parent(),
        folders => folders.first().copied(),
    };
    let name = name_of_folder(folder.unwrap_or(Path::new("")));
    if name.is_empty() { "sequence".to_owned() } else { name }
}

/// The files and folders that a glob names within `base` and that are not hidden, by name.
fn glob_files(base: &Path, glob: &str, case_sensitive: bool) -> Result<Vec<PathBuf>, ImportError> {
    let options =
        glob::MatchOptions { require_literal_leading_dot: true, case_sensitive, ..glob::MatchOptions::default() };
    let literal = PathBuf::from(glob::Pattern::escape(&base.to_string_lossy()));
    let text = literal.join(glob).to_string_lossy().into_owned();
    let shown = || base.join(glob).to_string_lossy().into_owned();
    let paths = glob::glob_with(&text, options)
        .map_err(|e| ImportError::Pattern { pattern: shown(), reason: format!("not a glob: {e}") })?;
    let mut matches = Vec::new();
    for entry in paths {
        matches.push(entry.map_err(|e| ImportError::Io { path: e.path().to_owned(), source: e.into() })?);
    }
    matches.sort_by(|a, b| natural(&a.to_string_lossy(), &b.to_string_lossy()));
    Ok(matches)
}

fn is_mesh(path: &Path) -> bool {
    matches!(ending(path).as_str(), "obj" | "ply" | "drc")
}

fn is_gltf(path: &Path) -> bool {
    matches!(ending(path).as_str(), "glb" | "gltf")
}
