//! Why a capture cannot be read.

use std::io;
use std::path::{Path, PathBuf};

use actor::timeline::TimelineError;
use kernels::topology::TopologyError;
use thiserror::Error;

use super::formats::{unread, unread_mesh};

/// Why an input is not a capture. Each message names the file, the place in it, and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] job::Stopped),
    /// Nothing was given.
    #[error("no input was given: name glTF files, folders or patterns of OBJ or PLY frames, or a capture.toml")]
    NoInput,
    /// A file or folder does not exist.
    #[error("{path}: no such file or folder")]
    NotFound {
        /// What was looked for.
        path: PathBuf,
    },
    /// The operating system refused to read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file name ends in nothing that can be read.
    #[error("{path}: {told}")]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What it is, as far as its ending shows, and what to do.
        told: &'static str,
    },
    /// A folder holds no mesh.
    #[error("{path}: the folder holds no .obj, .ply, .drc, .glb or .gltf file and no capture.toml")]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
    },
    /// A folder or glob holds mesh files of several kinds.
    #[error("{path}: holds mesh files of several kinds ({found}): name one kind, for example with a glob *.obj")]
    MixedFormats {
        /// The folder or glob.
        path: PathBuf,
        /// How many of each kind.
        found: String,
    },
    /// A pattern or glob names no existing file.
    #[error("{pattern}: no file matches{hint}")]
    NoMatch {
        /// The pattern or glob.
        pattern: String,
        /// What comes near; may be empty.
        hint: String,
    },
    /// A pattern or glob is not written correctly.
    #[error("{pattern}: {reason}")]
    Pattern {
        /// The pattern or glob.
        pattern: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A frame that a pattern's range asks for does not exist.
    #[error("{path}: frame {number} of the pattern's range is missing: restore the file or shorten the range")]
    MissingFrame {
        /// The file that should exist.
        path: PathBuf,
        /// Its number.
        number: i64,
    },
    /// A line of a text file cannot be understood.
    #[error("{path}, line {line}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A binary mesh file holds a value that makes no sense.
    #[error("{path}: {reason}. Export the file again")]
    Binary {
        /// The file.
        path: PathBuf,
        /// Element and fault.
        reason: String,
    },
    /// A file ends before all that it announces.
    #[error("{path}: the file is cut short: {reason}. Copy or export it again")]
    Truncated {
        /// The file.
        path: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// An index names an element that does not exist.
    #[error("{path}, {place}: index {index} is out of range, there are {count}. Export the file again")]
    IndexRange {
        /// The file.
        path: PathBuf,
        /// Line or element that holds the index.
        place: String,
        /// The index as the file writes it.
        index: i64,
        /// Number of elements.
        count: usize,
    },
    /// A coordinate is not a number, infinite, or absurdly far away.
    #[error(
        "{path}, frame {frame}: {element} is not finite or lies more than 1,000 km away: repair the frame, or leave it out"
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Frame within its sequence, from 0.
        frame: usize,
        /// The element, for example `vertex 12`.
        element: String,
    },
    /// A frame has another number of vertices than the first one.
    #[error(
        "{path}, frame {frame}: {found} vertices, but {reference} has {expected}{more}. All frames need the same mesh: \
         make one of them with `builder register`, or pack only frames that share one"
    )]
    VertexCount {
        /// The file.
        path: PathBuf,
        /// Frame within its sequence, from 0.
        frame: usize,
        /// Vertices found.
        found: usize,
        /// Vertices of the first frame.
        expected: usize,
        /// The file that the frame is compared with.
        reference: PathBuf,
        /// Which other frames differ; may be empty.
        more: String,
    },
    /// A frame has other faces than the first one.
    #[error(
        "{path}, frame {frame}: face {face} differs from {reference}{more}. All frames need the same faces in the same \
         order: make one mesh of them with `builder register`, or pack only frames that share one"
    )]
    FaceList {
        /// The file.
        path: PathBuf,
        /// Frame within its sequence, from 0.
        frame: usize,
        /// The first face that differs, from 0.
        face: usize,
        /// The file that the frame is compared with.
        reference: PathBuf,
        /// Which other frames differ; may be empty.
        more: String,
    },
    /// There is nothing to draw.
    #[error("{path}: there is no triangle with an area: points, lines and splats are not read")]
    NoTriangles {
        /// The file.
        path: PathBuf,
    },
    /// An image cannot be decoded or is of another format.
    #[error("{path}: not a readable PNG, JPEG or WebP image ({reason}): convert or export it again")]
    Image {
        /// The file, or the file that embeds it.
        path: PathBuf,
        /// What the decoder says.
        reason: String,
    },
    /// A texture that a file names does not exist.
    #[error(
        "{path}: the texture {texture} is not there, nor beside it: put it there, name another one (--texture), or take it \
         out of the file"
    )]
    TextureMissing {
        /// The mesh file.
        path: PathBuf,
        /// The texture as it is written.
        texture: String,
    },
    /// It cannot be told which texture belongs to which frame.
    #[error("{input}: {reason}. Number textures like the frames, or name both by patterns with ranges (START:END)")]
    TexturePairing {
        /// The first texture.
        input: String,
        /// Why not.
        reason: String,
    },
    /// The number of textures is not the number of frames.
    #[error("{input}: {found} textures for the {expected} frames of sequence \"{sequence}\": give one, or one a frame")]
    TextureCount {
        /// The texture input.
        input: String,
        /// Textures found.
        found: usize,
        /// Frames of the sequence.
        expected: usize,
        /// The sequence.
        sequence: String,
    },
    /// A mask that fits no frame.
    #[error("{path}: {reason}. Masks are numbered like the textures that they belong to")]
    Mask {
        /// The mask.
        path: PathBuf,
        /// What does not fit, and where.
        reason: String,
    },
    /// A glTF file breaks the format's rules.
    #[error("{path}: {reason}. Check the file with the glTF validator and export it again")]
    Gltf {
        /// The file.
        path: PathBuf,
        /// Object and fault, for example `accessor 3: ...`.
        reason: String,
    },
    /// A file shows one mesh after the other, and they do not go together as the frames of one.
    #[error(
        "{path}: {reason}. All frames need the same mesh (tracked geometry), each of them once: export one mesh that moves, \
         by shape keys or a rig"
    )]
    ChangingMesh {
        /// The file.
        path: PathBuf,
        /// Which meshes, and where they differ.
        reason: String,
    },
    /// A frame has no surface.
    #[error(
        "{path}, frame {frame}: the whole mesh has no area there (is its scale 0?): leave the frame out, or let the motion \
         begin and end at full size"
    )]
    Collapsed {
        /// The file.
        path: PathBuf,
        /// Frame within its sequence, from 0.
        frame: usize,
    },
    /// A glTF file requires an extension that is not read.
    #[error("{path}: requires the extension {extension}, which is not read: export without it")]
    Extension {
        /// The file.
        path: PathBuf,
        /// The extension.
        extension: String,
    },
    /// A glTF file has no such clip.
    #[error("{path}: no clip \"{clip}\"; the file holds: {known}")]
    UnknownClip {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        clip: String,
        /// The names that exist.
        known: String,
    },
    /// A manifest is not written correctly.
    #[error("{path}: {reason}. Every key is described in docs/capture-manifest.md")]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// Line, key and fault.
        reason: String,
    },
    /// A manifest of Universal Volumetric cannot be used.
    #[error("{path}: {reason}")]
    Uvol {
        /// The manifest.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// An option names a sequence that does not exist.
    #[error("no sequence \"{name}\"; the capture holds: {known}")]
    UnknownSequence {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// The vertex weights do not fit the mesh.
    #[error("{path}: {reason}. Write one number, not negative, per vertex of the mesh files, in their order")]
    Weights {
        /// The file of weights.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The painted parts do not fit the mesh.
    #[error(
        "{path}: {reason}. Write one whole number from 0 to 255 per vertex of the mesh files, in their order: its part of the body"
    )]
    Parts {
        /// The file of parts.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The capture is larger than this program handles.
    #[error("{path}: {reason}. Pack fewer sequences, a lower frame rate or a coarser mesh")]
    TooLarge {
        /// The file that goes over the limit.
        path: PathBuf,
        /// What is too large.
        reason: String,
    },
    /// An option's value makes no sense.
    #[error("{0}")]
    Option(String),
    /// The welded mesh is no topology.
    #[error("the capture is no usable mesh: {0}")]
    Topology(#[from] TopologyError),
    /// The sequences are no timeline.
    #[error("the capture's sequences cannot be played: {0}")]
    Timeline(#[from] TimelineError),
}

impl ImportError {
    /// The error for a file that is no capture.
    pub(super) fn unknown_format(path: &Path) -> Self {
        let told = unread(path)
            .unwrap_or("not a capture: inputs end in .glb, .gltf, .obj, .ply, .drc or .toml, or are folders of those");
        Self::UnknownFormat { path: path.to_owned(), told }
    }

    /// The error for a folder without any mesh, whose entries are `entries`.
    pub(super) fn no_mesh_in(path: &Path, entries: &[PathBuf]) -> Self {
        match entries.iter().find(|entry| entry.is_file() && unread_mesh(entry).is_some()) {
            Some(other) => Self::unknown_format(other),
            None => Self::EmptyFolder { path: path.to_owned() },
        }
    }

    /// A name for the kind of error that never changes, for scripts and for `builder validate`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Stopped(_) => "E_STOPPED",
            Self::NoInput => "E_NO_INPUT",
            Self::NotFound { .. } => "E_NOT_FOUND",
            Self::Io { .. } => "E_IO",
            Self::UnknownFormat { .. } => "E_FORMAT_UNKNOWN",
            Self::EmptyFolder { .. } => "E_FOLDER_EMPTY",
            Self::MixedFormats { .. } => "E_FORMAT_MIXED",
            Self::NoMatch { .. } => "E_NO_MATCH",
            Self::Pattern { .. } => "E_PATTERN",
            Self::MissingFrame { .. } => "E_FRAME_MISSING",
            Self::Syntax { .. } => "E_SYNTAX",
            Self::Binary { .. } => "E_BINARY",
            Self::Truncated { .. } => "E_TRUNCATED",
            Self::IndexRange { .. } => "E_INDEX_RANGE",
            Self::NotFinite { .. } => "E_NOT_FINITE",
            Self::VertexCount { .. } => "E_VERTEX_COUNT",
            Self::FaceList { .. } => "E_FACE_LIST",
            Self::NoTriangles { .. } => "E_NO_TRIANGLES",
            Self::Image { .. } => "E_IMAGE",
            Self::TextureMissing { .. } => "E_TEXTURE_MISSING",
            Self::TexturePairing { .. } => "E_TEXTURE_PAIRING",
            Self::TextureCount { .. } => "E_TEXTURE_COUNT",
            Self::Mask { .. } => "E_MASK",
            Self::Gltf { .. } => "E_GLTF",
            Self::ChangingMesh { .. } => "E_MESH_CHANGES",
            Self::Collapsed { .. } => "E_COLLAPSED",
            Self::Extension { .. } => "E_GLTF_EXTENSION",
            Self::UnknownClip { .. } => "E_CLIP_UNKNOWN",
            Self::Manifest { .. } => "E_MANIFEST",
            Self::Uvol { .. } => "E_UVOL",
            Self::UnknownSequence { .. } => "E_SEQUENCE_UNKNOWN",
            Self::Weights { .. } => "E_WEIGHTS",
            Self::Parts { .. } => "E_PARTS",
            Self::TooLarge { .. } => "E_TOO_LARGE",
            Self::Option(_) => "E_OPTION",
            Self::Topology(_) => "E_TOPOLOGY",
            Self::Timeline(_) => "E_TIMELINE",
        }
    }
}
