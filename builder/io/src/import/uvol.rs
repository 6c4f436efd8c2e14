//! Manifests of Universal Volumetric 2 (UVOL): a Draco or GLB file a frame, and textures in KTX2 files of some frames each.
//!
//! Two forms are read. The newer one lists *targets* of geometry and texture, of which the finest that is read is taken, and a
//! pattern for the files of each, in which stand `[target]`, `[type]`, `[tag]`, `[ext]` and the frame's number as `[####]`. The older
//! one has a pattern with `####` for each of both. Frames are counted from 0.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use super::error::ImportError;
use super::images::read_file;
use super::layers::{TextureLayer, layer_count};
use super::paths::{ending, folder_of, name_of_folder};
use super::warning::Warning;

/// A volumetric video as its manifest describes it.
pub(super) struct Uvol {
    pub name: String,
    /// The file of each frame.
    pub files: Vec<PathBuf>,
    /// Whether these are GLB files.
    pub stills: bool,
    pub fps: f32,
    /// Metres per unit, where another than 1.
    pub unit: Option<f32>,
    /// The texture of each frame; empty where there is none that is read.
    pub layers: Vec<TextureLayer>,
    pub warnings: Vec<Warning>,
}

#[derive(Deserialize)]
struct Targets<T> {
    #[serde(default)]
    targets: BTreeMap<String, T>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct GeometryTarget {
    format: String,
    frame_rate: f32,
    frame_count: Option<u64>,
    scale: Option<f32>,
    #[serde(default)]
    settings: Settings,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct TextureTarget {
    frame_rate: f32,
    #[serde(default)]
    settings: Settings,
}

/// What is known of how a target was encoded.
#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Settings {
    simplification_ratio: Option<f32>,
    resolution: Option<Resolution>,
}

#[derive(Deserialize)]
struct Resolution {
    width: f64,
    height: f64,
}

/// The older form.
#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Patterns {
    #[serde(rename = "DRCURLPattern")]
    geometry: String,
    #[serde(rename = "KTX2URLPattern")]
    texture: Option<String>,
    geometry_frame_count: Option<u64>,
    geometry_frame_rate: Option<f32>,
    texture_frame_rate: Option<f32>,
    frame_rate: Option<f32>,
    #[serde(rename = "AudioURL")]
    audio: Option<String>,
}

/// What a file's ending says that it may be a manifest.
pub(super) fn may_be(path: &Path) -> bool {
    matches!(ending(path).as_str(), "json" | "manifest")
}

/// Whether `path` holds a manifest of Universal Volumetric, of whatever version.
pub(super) fn is_manifest(path: &Path) -> bool {
    may_be(path)
        && path.is_file()
        && read_file(path).ok().and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok()).is_some_and(|value| {
            let has = |key: &str| value.get(key).is_some();
            has("DRCURLPattern") || has("geometry") && has("texture") || has("frameData") && has("maxVertices")
        })
}

impl Uvol {
    /// Reads the manifest `path` and finds the files that it names.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let manifest = Manifest { path, folder: folder_of(path) };
        let value: Value = serde_json::from_slice(&read_file(path)?)
            .map_err(|error| manifest.wrong(format!("is no manifest of Universal Volumetric: {error}")))?;
        if value.get("DRCURLPattern").is_some() {
            return manifest.patterns(value);
        }
        if value.get("frameData").is_some() && value.get("geometry").is_none() {
            return Err(manifest.wrong(
                "is of version 1 (Corto geometry and a video), which is not read: encode the frames as version 2 (Draco and \
                 KTX2), or write every frame as OBJ with its texture"
                    .into(),
            ));
        }
        if value.get("geometry").is_none() {
            return Err(manifest.wrong("is no manifest of Universal Volumetric: it names no geometry".into()));
        }
        manifest.targets(&value)
    }
}

/// A manifest that is being read.
struct Manifest<'a> {
    path: &'a Path,
    folder: &'a Path,
}

impl Manifest<'_> {
    fn wrong(&self, reason: String) -> ImportError {
        ImportError::Uvol { path: self.path.to_owned(), reason }
    }

    /// The older form.
    fn patterns(&self, value: Value) -> Result<Uvol, ImportError> {
        let found: Patterns = serde_json::from_value(value).map_err(|error| self.wrong(error.to_string()))?;
        let fps = found.geometry_frame_rate.or(found.frame_rate);
        let fps = self.rate(fps.ok_or_else(|| self.wrong("GeometryFrameRate is missing".into()))?)?;
        let files = self.files(&found.geometry, found.geometry_frame_count)?;
        let mut warnings = Vec::new();
        let layers = match &found.texture {
            Some(pattern) => {
                let rate = self.rate(found.texture_frame_rate.unwrap_or(fps))?;
                self.layers(pattern, rate, (files.len(), fps), true, &mut warnings)?
            }
            None => Vec::new(),
        };
        let audio = found.audio.filter(|audio| !audio.is_empty());
        self.left_out(audio.map(|_| "the sound".to_owned()).into_iter().collect(), &mut warnings);
        Ok(Uvol { name: self.name(), files, stills: false, fps, unit: None, layers, warnings })
    }

    /// The newer form.
    fn targets(&self, value: &Value) -> Result<Uvol, ImportError> {
        let part = |key: &str| value.get(key).cloned().unwrap_or(Value::Null);
        let parsed = |key: &str, error: serde_json::Error| self.wrong(format!("\"{key}\": {error}"));
        let path_of = |key: &str| part(key).get("path").and_then(Value::as_str).map(str::to_owned);
        let all: Targets<Value> =
            serde_json::from_value(part("geometry")).map_err(|error| parsed("geometry", error))?;
        let mut geometry: Vec<(String, GeometryTarget)> = Vec::new();
        for (name, target) in all.targets.iter().filter(|(_, target)| format_of(target, &["draco", "glb"])) {
            let target = serde_json::from_value(target.clone()).map_err(|error| parsed("geometry", error))?;
            geometry.push((name.clone(), target));
        }
        // The finest: whole before simplified, then the fastest.
        geometry.sort_by(|(_, a), (_, b)| {
            let of = |t: &GeometryTarget| (t.settings.simplification_ratio.unwrap_or(1.0), t.frame_rate);
            of(b).0.total_cmp(&of(a).0).then(of(b).1.total_cmp(&of(a).1))
        });
        let Some((name, target)) = geometry.first() else {
            let formats: Vec<&str> = all.targets.values().filter_map(|t| t.get("format")?.as_str()).collect();
            return Err(self.wrong(format!(
                "has no target of geometry that is read (it has: {}): encode the frames as draco or glb",
                if formats.is_empty() { "none".into() } else { formats.join(", ") }
            )));
        };
        let fps = self.rate(target.frame_rate)?;
        let pattern = path_of("geometry").ok_or_else(|| self.wrong("\"geometry\" has no path".into()))?;
        let stills = target.format == "glb";
        let words = [("target", name.as_str()), ("ext", if stills { ".glb" } else { ".drc" })];
        let files = self.files(&filled(&pattern, &words), target.frame_count)?;
        let mut warnings = Vec::new();
        let mut others = self.other_maps(&part("texture"));
        let layers = match path_of("texture") {
            Some(pattern) => {
                let colour = part("texture").get("baseColor").cloned().unwrap_or(Value::Null);
                self.colours(value, &pattern, colour, (files.len(), fps), !stills, (&mut others, &mut warnings))?
            }
            None => Vec::new(),
        };
        if part("audio").get("path").and_then(Value::as_str).is_some_and(|path| !path.is_empty()) {
            others.push("the sound".into());
        }
        self.left_out(others, &mut warnings);
        let unit = target.scale.filter(|&scale| scale != 1.0);
        Ok(Uvol { name: self.name(), files, stills, fps, unit, layers, warnings })
    }

    /// The textures of the finest target that is read.
    fn colours(
        &self,
        value: &Value,
        pattern: &str,
        colour: Value,
        geometry: (usize, f32),
        lowest_first: bool,
        (others, warnings): (&mut Vec<String>, &mut Vec<Warning>),
    ) -> Result<Vec<TextureLayer>, ImportError> {
        if colour.is_null() {
            return Ok(Vec::new());
        }
        let parsed = |error: serde_json::Error| self.wrong(format!("\"texture\": {error}"));
        let all: Targets<Value> = serde_json::from_value(colour).map_err(parsed)?;
        let mut targets: Vec<(&String, TextureTarget)> = Vec::new();
        for (name, target) in all.targets.iter().filter(|(_, target)| format_of(target, &["ktx2"])) {
            targets.push((name, serde_json::from_value(target.clone()).map_err(parsed)?));
        }
        let texels = |target: &TextureTarget| target.settings.resolution.as_ref().map_or(0.0, |r| r.width * r.height);
        targets.sort_by(|(_, a), (_, b)| texels(b).total_cmp(&texels(a)).then(b.frame_rate.total_cmp(&a.frame_rate)));
        let Some((name, target)) = targets.first() else {
            let formats: Vec<&str> = all.targets.values().filter_map(|t| t.get("format")?.as_str()).collect();
            return Err(self.wrong(format!(
                "has no target of textures that is read (it has: {}): encode the textures as ktx2",
                if formats.is_empty() { "none".into() } else { formats.join(", ") }
            )));
        };
        let tags = tags(value);
        others.extend(tags.iter().skip(1).map(|tag| format!("the textures \"{tag}\"")));
        let tag = tags.first().map_or("default", String::as_str);
        let words = [("target", name.as_str()), ("type", "baseColor"), ("tag", tag), ("ext", ".ktx2")];
        let rate = self.rate(target.frame_rate)?;
        self.layers(&filled(pattern, &words), rate, geometry, lowest_first, warnings)
    }

    /// Maps that are no colours.
    fn other_maps(&self, texture: &Value) -> Vec<String> {
        let maps = texture.as_object().into_iter().flatten().map(|(name, _)| name.as_str());
        maps.filter(|name| !matches!(*name, "path" | "baseColor")).map(|name| format!("the textures {name}")).collect()
    }

    fn left_out(&self, others: Vec<String>, warnings: &mut Vec<Warning>) {
        if !others.is_empty() {
            let message =
                format!("{}: {} left out: only shape and colour are read", self.path.display(), others.join(", "));
            warnings.push(Warning::new("W_UVOL_LEFT_OUT", message));
        }
    }

    fn rate(&self, rate: f32) -> Result<f32, ImportError> {
        if rate.is_finite() && rate > 0.0 {
            return Ok(rate);
        }
        Err(self.wrong(format!("a frame rate must be a positive number, not {rate}")))
    }

    /// The files of `pattern`: `count` of them, or as many as there are.
    fn files(&self, pattern: &str, count: Option<u64>) -> Result<Vec<PathBuf>, ImportError> {
        if pattern.contains("://") {
            return Err(self.wrong(format!("names files on the web ({pattern}): fetch them, and write where they are")));
        }
        let Some(numbered) = Numbered::new(pattern) else {
            return Err(self.wrong(format!("the path \"{pattern}\" has no number of a frame, as in [####]")));
        };
        let file = |frame: u64| self.folder.join(numbered.at(frame));
        let mut files = Vec::new();
        for frame in 0..count.unwrap_or(u64::MAX) {
            let path = file(frame);
            if !path.is_file() {
                match count {
                    Some(_) if frame > 0 => {
                        return Err(ImportError::MissingFrame {
                            path,
                            number: i64::try_from(frame).unwrap_or(i64::MAX),
                        });
                    }
                    _ => break,
                }
            }
            files.push(path);
        }
        if files.is_empty() { Err(ImportError::NotFound { path: file(0) }) } else { Ok(files) }
    }

    /// The picture of each of `count` frames at `fps` among those of the KTX2 files of `pattern`, which are shown at `rate`.
    fn layers(
        &self,
        pattern: &str,
        rate: f32,
        (count, fps): (usize, f32),
        lowest_first: bool,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<TextureLayer>, ImportError> {
        let mut pictures = Vec::new();
        for path in self.files(pattern, None)? {
            let layers = layer_count(&path)?;
            pictures.extend((0..layers).map(|layer| TextureLayer { path: path.clone(), layer, lowest_first }));
        }
        let picture = |frame: usize| (frame as f64 / f64::from(fps) * f64::from(rate)).round() as usize;
        let late = (0..count).filter(|&frame| picture(frame) >= pictures.len()).count();
        // The last one may be rounded up.
        if late > usize::from(rate < fps) {
            warnings.push(Warning::new(
                "W_TEXTURE_LOST",
                format!(
                    "{}: no texture for the last {late} of {count} frames: they wear that of the last frame that has one",
                    self.path.display()
                ),
            ));
        }
        let last = pictures.len().saturating_sub(1);
        Ok((0..count).filter_map(|frame| pictures.get(picture(frame).min(last)).cloned()).collect())
    }

    /// The name of the file without what all such files end in, or that of its folder.
    fn name(&self) -> String {
        let name = self.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut name = name.as_str();
        while let Some(shorter) = [".json", ".manifest", ".uvol"].iter().find_map(|end| name.strip_suffix(end)) {
            name = shorter;
        }
        if matches!(name, "" | "manifest" | "uvol") { name_of_folder(self.folder) } else { name.to_owned() }
    }
}

fn format_of(target: &Value, formats: &[&str]) -> bool {
    target.get("format").and_then(Value::as_str).is_some_and(|format| formats.contains(&format))
}

/// The names of the variants of the textures, as the manifest tells what they were made from.
fn tags(value: &Value) -> Vec<String> {
    let input = value.pointer("/input/texture/baseColor");
    let one = |input: &Value| input.get("tag").and_then(Value::as_str).map(str::to_owned);
    match input {
        Some(Value::Array(inputs)) => inputs.iter().filter_map(one).collect(),
        Some(input) => one(input).into_iter().collect(),
        None => Vec::new(),
    }
}

/// `pattern` with words for their names in brackets.
fn filled(pattern: &str, words: &[(&str, &str)]) -> String {
    words.iter().fold(pattern.to_owned(), |text, (name, word)| {
        text.replace(&format!("[{name}]"), word).replace(&format!("{{{name}}}"), word)
    })
}

/// A path with a frame's number in it.
struct Numbered<'a> {
    before: &'a str,
    digits: usize,
    after: &'a str,
}

impl<'a> Numbered<'a> {
    /// `####` with or without brackets, or `[index]`.
    fn new(pattern: &'a str) -> Option<Self> {
        for name in ["[index]", "{index}"] {
            if let Some((before, after)) = pattern.split_once(name) {
                return Some(Self { before, digits: 6, after });
            }
        }
        let start = pattern.find('#')?;
        let digits = pattern[start..].bytes().take_while(|&byte| byte == b'#').count();
        let (before, after) = (&pattern[..start], &pattern[start + digits..]);
        match (before.strip_suffix(['[', '{']), after.strip_prefix([']', '}'])) {
            (Some(before), Some(after)) => Some(Self { before, digits, after }),
            _ => Some(Self { before, digits, after }),
        }
    }

    fn at(&self, frame: u64) -> String {
        format!("{}{frame:0digits$}{}", self.before, self.after, digits = self.digits)
    }
}
