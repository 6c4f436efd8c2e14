//! What can be typed after `builder`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use pipeline::transitions::TransitionOptions;
use search::{BehaviourRequest, PlaceRequest};

use super::typed::{TypedPose, parse_behaviour, parse_place, parse_pose, parse_seconds, parse_size};

/// Turns 4D surface captures into actors that anyone can direct on a web page.
#[derive(Debug, Parser)]
#[command(name = "builder", version, about, max_term_width = 100)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Number of threads; all cores by default. The output does not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print only errors on stderr.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Read a capture, compute its essential graph, and write a bundle.
    Pack(PackArguments),
    /// Turn a scan, of which every frame has its own mesh, into a capture of one mesh, as files that `pack` reads.
    #[cfg(feature = "complete")]
    Register(RegisterArguments),
    /// Learn how sequences move, draw variations of them, and pack the capture with those beside it.
    #[cfg(feature = "complete")]
    Vary(VaryArguments),
    /// Have an actor move as another one does, learned from a few pairs of poses, and write its capture with the new sequences.
    #[cfg(feature = "complete")]
    Transfer(TransferArguments),
    /// Write the built-in performer's capture, as files that `pack` reads like any other.
    Performer(PerformerArguments),
    /// Plan a walk through a bundle, make its frames, and write them as a GLB, as OBJ or PLY files, or as pictures.
    Direct(Box<DirectArguments>),
    /// Have an actor do what a clip of motion capture shows, and write its frames, or a capture with them beside the recorded ones.
    #[cfg(feature = "complete")]
    Drive(DriveArguments),
    /// Find what cycles in a capture, and make what lies between: walks of all speeds between a walk and a run.
    #[cfg(feature = "complete")]
    Family(FamilyArguments),
    /// Estimate a rig from how a capture's surface moves: bones, joints and weights.
    Rig(RigArguments),
    /// Tell what a bundle or an input holds.
    Inspect(InspectArguments),
    /// Check a bundle and list what is wrong with it, with stable codes.
    Validate(ValidateArguments),
    /// Make the papers' evaluations again on a capture, as a page with tables.
    #[cfg(feature = "complete")]
    Evaluate(EvaluateArguments),
    /// Tell how good a bundle's actor is, as a page.
    #[cfg(feature = "complete")]
    Report(ReportArguments),
    /// List what a work folder holds, or clean it.
    Work(WorkArguments),
}

/// Where results of stages last.
#[derive(Clone, Debug, Args)]
pub struct WorkFolderArgument {
    /// A folder in which the results of long stages are kept: what was interrupted goes on from there, and what was done
    /// with the same input and options is not done again.
    #[arg(long, value_name = "DIR", env = "REPRISE_WORK")]
    pub work: Option<PathBuf>,
}

/// Arguments of `builder work`.
#[derive(Debug, Args)]
pub struct WorkArguments {
    /// What to do with it.
    #[command(subcommand)]
    pub action: WorkAction,
}

/// What is done with a work folder.
#[derive(Debug, Subcommand)]
pub enum WorkAction {
    /// List the results that it holds.
    List {
        /// The folder.
        #[command(flatten)]
        folder: WorkFolderArgument,
    },
    /// Delete results: all of them, or those that the options name.
    Clean {
        /// The folder.
        #[command(flatten)]
        folder: WorkFolderArgument,
        /// Only results of this stage.
        #[arg(long, value_name = "STAGE")]
        stage: Option<String>,
        /// Only what was not used for so many days.
        #[arg(long, value_name = "DAYS")]
        unused: Option<u32>,
    },
}

/// Arguments of `builder pack`.
#[derive(Debug, Args)]
pub struct PackArguments {
    /// glTF or GLB files, folders of OBJ or PLY frames, folders with a capture.toml, globs, or patterns such as
    /// `frame_%05d.obj:0:174`.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// The bundle to write.
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Where results of stages last.
    #[command(flatten)]
    pub work: WorkFolderArgument,
    /// How the input is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Weight of a frame's duration against surface deformation in the essential graph.
    #[arg(long, default_value_t = actor::graph::DEFAULT_ALPHA, value_name = "COST")]
    pub alpha: f64,
    /// Weight w of stretch against rotation in the pose distance.
    #[arg(long, default_value_t = 0.01, value_name = "WEIGHT")]
    pub stretch_weight: f32,
    /// Weigh triangles by their area in the pose distance, instead of all alike.
    #[arg(long)]
    pub area_weighted: bool,
    /// Slope limit p of the temporal warps, 1 to 5, or none: at most p - 1 frames repeat in a row.
    #[arg(long, default_value = "3", value_name = "P", value_parser = slope)]
    pub slope: Slope,
    /// Shortest blended segment, in seconds.
    #[arg(long, default_value_t = 0.3, value_name = "SECONDS")]
    pub shortest: f32,
    /// Longest blended segment, in seconds.
    #[arg(long, default_value_t = 2.0, value_name = "SECONDS")]
    pub longest: f32,
    /// How the lengths of a transition's segments are chosen.
    #[arg(long, value_enum, default_value_t = TransitionLength::Total)]
    pub transition_length: TransitionLength,
    /// Let feet slide in transitions as in the papers, instead of keeping still what stands on both sides.
    #[arg(long)]
    pub no_contacts: bool,
    /// Largest error of a stored vertex position, in metres; by default 0.5 mm for an actor of 1.8 m.
    #[arg(long, value_name = "METRES")]
    pub max_error: Option<f32>,
    /// What becomes of textures that change from frame to frame. Eigen maps look as captured and do not ghost in
    /// transitions, but take minutes, and storing them in 8 KB a frame costs some detail at 1024 x 1024: see
    /// docs/appearance.md.
    #[arg(long, value_enum, default_value_t = AppearanceKind::Eigen)]
    pub appearance: AppearanceKind,
    /// Eigen textures and Eigen warps together, 50 by default; two in three are textures.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=150))]
    pub appearance_components: Option<u16>,
    /// Structural similarity of textures that is to be left after storing, for example 0.98: the split into textures and
    /// warps and the steps that reach it in the fewest bytes, however many those are. Takes several times as long. Where 50
    /// components do not reach it, up to 150 are tried, unless --appearance-components says how many.
    #[arg(long, value_name = "SSIM")]
    pub appearance_ssim: Option<f64>,
    /// Also store as many components of textures that are not aligned, so that the page can compare: about as many bytes
    /// again, or more with --appearance-ssim.
    #[arg(long)]
    pub appearance_compare: bool,
    /// Do not find the parts of the body, which the page shows in colours.
    #[arg(long)]
    pub no_parts: bool,
    /// Do not learn how sequences move, and store no other ways through them, of which the page shows another one whenever a walk comes by
    /// (docs/learning.md).
    #[cfg(feature = "complete")]
    #[arg(long)]
    pub no_variations: bool,
    /// Also estimate a rig, by which edits move the body (docs/editing.md); with =FILE corrected by a TOML or JSON file as
    /// `builder rig --toml` writes it.
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    pub rig: Option<PathBuf>,
    /// What the page shows of a scan, of which every frame has its own mesh: see docs/scans.md.
    #[cfg(feature = "complete")]
    #[arg(long, value_enum, default_value_t = Mode::Global)]
    pub mode: Mode,
    /// Print an object with times, sizes and errors on stdout at the end.
    #[arg(long)]
    pub json: bool,
}

/// What the page shows of a scan.
#[cfg(feature = "complete")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// All frames are brought onto one mesh, which is shown.
    Global,
    /// Recorded frames are shown as they were scanned, with their own mesh and image; transitions on the one mesh.
    Windows,
}

/// Arguments of `builder register`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct RegisterArguments {
    /// Folders of OBJ, PLY or GLB frames, folders with a capture.toml, globs, or patterns such as `frame_%05d.obj:0:174`.
    #[arg(required = true, value_name = "SCAN")]
    pub inputs: Vec<String>,
    /// The folder to write; it must not exist, or be empty.
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// Where results of stages last.
    #[command(flatten)]
    pub work: WorkFolderArgument,
    /// How the input is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// The frame whose mesh all frames get, counted over all sequences from 0; chosen where not given.
    #[arg(long, value_name = "N")]
    pub template_frame: Option<usize>,
    /// How much colours count against shape where the template is tracked; 0 not at all. Without colours it may slide along the
    /// body.
    #[arg(long, default_value_t = 1.0, value_name = "WEIGHT")]
    pub colour: f32,
    /// How smooth the detail is that is added after tracking, in square metres on a person; 0 adds none.
    #[arg(long, default_value_t = 2e-4, value_name = "AREA")]
    pub detail: f32,
    /// Width and height of the textures in pixels; as dense as the scan's where not given.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=8192))]
    pub texture_size: Option<u32>,
    /// The folder with the truth, as `builder performer --scanned` writes it: frames are held against it, and it is told how far
    /// off they are.
    #[arg(long, value_name = "DIR")]
    pub truth: Option<PathBuf>,
    /// Write a page with figures of all frames, their order, and the worst of them as pictures.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Print an object with figures of all frames on stdout at the end.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `builder vary`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct VaryArguments {
    /// A capture, as `pack` takes it.
    #[arg(required = true, value_name = "CAPTURE")]
    pub inputs: Vec<String>,
    /// The bundle to write: the capture with alternatives of what was recorded, of which the player shows another one whenever it
    /// comes by.
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Where results of stages last.
    #[command(flatten)]
    pub work: WorkFolderArgument,
    /// How the input is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Names or labels of the sequences to vary; all by default.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub sequences: Vec<String>,
    /// Make sequences NAME~1, NAME~2, and so on of the variations of each sequence NAME, with transitions of their own.
    #[arg(long)]
    pub as_sequences: bool,
    /// Variations of each sequence.
    #[arg(long, default_value_t = 8, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub count: u16,
    /// How much they vary: 0.06 is hardly seen, 0.25 is much.
    #[arg(long, default_value_t = 0.12, value_name = "AMOUNT")]
    pub amount: f64,
    /// Seed of what is drawn: the same one gives the same variations.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
    /// Print an object with figures of all varied sequences on stdout at the end.
    #[arg(long)]
    pub json: bool,
}

/// What maps the poses of one actor to those of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KernelKind {
    /// A Gaussian process with the kernel of a neural network.
    Nn,
    /// A Gaussian process with the squared exponential kernel.
    Se,
    /// A Gaussian process with the linear kernel.
    Linear,
    /// The affine map of least squares.
    Affine,
}

/// Arguments of `builder transfer`.
#[derive(Debug, Args)]
pub struct TransferArguments {
    /// Whose motion it is: a bundle, or a capture as `pack` takes it.
    #[arg(long, value_name = "SOURCE")]
    pub from: String,
    /// Who is to move so: a bundle, or a capture as `pack` takes it.
    #[arg(long, value_name = "TARGET")]
    pub to: String,
    /// A TOML file with pairs of poses that mean the same.
    #[arg(long, value_name = "FILE")]
    pub keys: PathBuf,
    /// The folder to write: a capture of the target with the new sequences beside its own. It must not exist, or be empty.
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// Names or labels of the source's sequences to transfer; all by default, also those without keys.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub sequences: Vec<String>,
    /// Leave out what was recorded of the target.
    #[arg(long)]
    pub alone: bool,
    /// What maps the poses of one actor to those of the other.
    #[arg(long, value_enum, default_value = "nn", value_name = "KERNEL")]
    pub kernel: KernelKind,
    /// Learn the body as a whole instead of its parts.
    #[arg(long)]
    pub whole: bool,
    /// Pairs of frames that are learned from, at most.
    #[arg(long, default_value_t = 350, value_name = "N", value_parser = clap::value_parser!(u16).range(3..=2000))]
    pub pairs: u16,
    /// Let feet slide: do not hold soles where the source's stand.
    #[arg(long)]
    pub no_hold: bool,
    /// Do not correct lengths by the target's recorded poses.
    #[arg(long)]
    pub no_correct: bool,
    /// Do not let bones carry the pose: maps alone make it, as in the thesis
    #[arg(long)]
    pub no_bones: bool,
    /// How inputs that are not bundles are read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Print an object with what was done on stdout.
    #[arg(long)]
    pub json: bool,
}

/// What becomes of textures that change from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AppearanceKind {
    /// The first frame's texture is used for all.
    Static,
    /// Eigen textures and Eigen warps (thesis chapter 4) where frames have textures of their own.
    Eigen,
}

/// Arguments that say how an input is read.
#[derive(Clone, Debug, Args)]
pub struct ImportArguments {
    /// Name of the actor; the input's by default.
    #[arg(long)]
    pub name: Option<String>,
    /// Frames per second: of the recorded frames, and what glTF animations are baked at.
    #[arg(long, value_name = "RATE")]
    pub fps: Option<f32>,
    /// The axis that points up in the input.
    #[arg(long, value_enum, value_name = "AXIS")]
    pub up: Option<UpAxis>,
    /// Metres per unit of length of the input, for example 0.01 for centimetres.
    #[arg(long, value_name = "METRES")]
    pub unit: Option<f32>,
    /// Sequences whose end meets their beginning: by name, or none, or those that do so in place and speed.
    #[arg(long, value_delimiter = ',', default_value = "auto", value_name = "auto|none|NAMES")]
    pub cyclic: Vec<String>,
    /// A texture for all frames, or a folder, glob or pattern with one per frame.
    #[arg(long, value_name = "FILE")]
    pub texture: Option<String>,
    /// A text file with one weight per vertex for the planar alignment; areas by default.
    #[arg(long, value_name = "FILE")]
    pub weights: Option<PathBuf>,
    /// Vertices closer than this in every frame are one, in metres.
    #[arg(long, value_name = "METRES")]
    pub weld: Option<f32>,
}

/// The axis of the input that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    /// +Y, as in glTF.
    Y,
    /// +Z.
    Z,
}

/// How the lengths of a transition's segments are chosen (TVCG equation 8 against the text of thesis section 2.5.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TransitionLength {
    /// The least sum of pose distances.
    Total,
    /// The least mean of pose distances.
    Mean,
    /// The least haste: what the blend adds to the motion, with the time it takes.
    Haste,
}

/// Arguments of `builder performer`.
#[derive(Debug, Args)]
pub struct PerformerArguments {
    /// The folder to write; it must not exist, or be empty.
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// Who performs.
    #[arg(long, value_enum, default_value = "woman", value_name = "FIGURE")]
    pub figure: FigureKind,
    /// Frames a second: 50 where not given.
    #[arg(long, value_name = "RATE")]
    pub rate: Option<f32>,
    /// Number of frames of all sequences together.
    #[arg(long, value_name = "N")]
    pub frames: Option<u32>,
    /// Number of vertices, roughly.
    #[arg(long, value_name = "N")]
    pub vertices: Option<u32>,
    /// Width and height of the texture in pixels.
    #[arg(long, value_name = "PIXELS")]
    pub texture_size: Option<u32>,
    /// Capture artefacts to add, with their truth.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES", conflicts_with = "scanned")]
    pub artefacts: Vec<Artefact>,
    /// As a volumetric studio would deliver it: every frame with its own mesh, atlas and texture; the capture itself is its truth.
    #[arg(long)]
    pub scanned: bool,
    /// Frames that share a mesh and an atlas, as keyframe groups do.
    #[arg(long, value_name = "K", default_value_t = 1, requires = "scanned")]
    pub group: u32,
    /// Noise of the scans along normals: its standard deviation in millimetres.
    #[arg(long, value_name = "S", default_value_t = 1.0, requires = "scanned")]
    pub noise: f32,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
}

/// Who performs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FigureKind {
    /// In a skirt, with a ponytail.
    Woman,
    /// Taller and broader, in trousers.
    Man,
    /// Small, with a large head and short limbs, in shorts.
    Child,
}

/// What real captures suffer from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Artefact {
    /// Noise of the reconstructed surface.
    Noise,
    /// Texture that slides along the surface, as tracking drifts.
    Drift,
    /// Colour that depends on pose and facing.
    Light,
    /// Patches that no camera saw.
    Holes,
    /// All of them.
    All,
}

/// Arguments of `builder direct`. What is asked for is done in the order path, keys, place, behaviour, wander, to.
#[derive(Debug, Args)]
pub struct DirectArguments {
    /// The bundle of the actor.
    #[arg(value_name = "FILE")]
    pub bundle: PathBuf,
    /// What to write: walk.glb, or frames as frames/%05d.obj, frames/%05d.ply, or pictures as frames/%05d.png.
    #[arg(long, short, value_name = "FILE")]
    pub output: String,
    /// A JSON file with a path to follow: {"points": [[x, z], ...], "shape": "spline"}.
    #[arg(long, value_name = "FILE")]
    pub path: Option<PathBuf>,
    /// How far the walk is bent onto its paths and places, from 0 (not at all) to 1; what the path says where not given, or 1.
    #[arg(long, value_name = "SHARE")]
    pub exactness: Option<f64>,
    /// What a frame's duration costs: 0.01 for smooth ways, 0.2 for quick ones; as the actor was packed, if not given.
    #[arg(long, value_name = "ALPHA", allow_negative_numbers = true)]
    pub quickness: Option<f64>,
    /// How much what was recorded varies, where the actor has alternatives of it: from 0, as recorded, to 1. Not with --edits or
    /// --sequence.
    #[arg(long, default_value_t = 1.0, value_name = "AMOUNT")]
    pub variety: f32,
    /// A TOML file with key poses: `[[poses]]` with pose = 12 and time = 1.5.
    #[arg(long, value_name = "FILE")]
    pub keys: Option<PathBuf>,
    /// Go to a place, in metres, and face a heading there, in radians about +Y from +Z, if one is given; end in a pose there, if one
    /// is given: NAME:SECONDS or a frame's number.
    #[arg(long, value_name = "X,Z[,HEADING][@POSE]", value_parser = parse_place, allow_hyphen_values = true)]
    pub place: Option<PlaceRequest>,
    /// Go to a behaviour, a label or a sequence's name, and hold it for so many seconds, if they are given. gait@1.4 is what
    /// the family `gait` has that is nearest to 1.4 metres a second, or whatever its unit is.
    #[arg(long, value_name = "NAME[@VALUE][:SECONDS]", value_parser = parse_behaviour)]
    pub behaviour: Option<BehaviourRequest>,
    /// Wander about for this long, for example 60s.
    #[arg(long, value_name = "DURATION", value_parser = parse_seconds)]
    pub wander: Option<f64>,
    /// Go to a pose: a sequence's name and a time in seconds within it, or a frame's number; may be given again.
    #[arg(long, value_name = "NAME:TIME", value_parser = parse_pose)]
    pub to: Vec<TypedPose>,
    /// Write a sequence as it was recorded, from its first frame to its last, instead of a walk.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["path", "keys", "place", "behaviour", "wander", "to", "request", "start", "times"])]
    pub sequence: Option<String>,
    /// A JSON file with a whole request (docs/directing.md), by itself or with where the actor was, as the page saves it.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["path", "keys", "place", "behaviour", "wander", "to"])]
    pub request: Option<PathBuf>,
    /// A JSON file with edits of recorded frames (docs/editing.md): they and the transitions that pass there are changed.
    #[arg(long, value_name = "FILE")]
    pub edits: Option<PathBuf>,
    /// A TOML or JSON file that corrects the rig by which edits move the body, as `builder rig --toml` writes it. Without one the
    /// bundle's rig is taken, where it has one.
    #[arg(long, value_name = "FILE", requires = "edits")]
    pub rig: Option<PathBuf>,
    /// The pose to begin with; whatever suits best where not given.
    #[arg(long, value_name = "NAME:TIME", value_parser = parse_pose)]
    pub start: Option<TypedPose>,
    /// Seed of what is random; the request's where not given.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// States that the search expands for each target at most.
    #[arg(long, default_value_t = 1_000_000, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub effort: u32,
    /// Write the table of key poses, wanted and reached, as .csv or .json.
    #[arg(long, value_name = "FILE")]
    pub times: Option<PathBuf>,
    /// Write only every so many frames.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub every: u32,
    /// Width and height of pictures in pixels.
    #[arg(long, default_value = "720x720", value_name = "SIZE", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Seconds in which the camera of pictures turns once about the actor.
    #[arg(long, default_value = "8s", value_name = "DURATION", value_parser = parse_seconds)]
    pub turn: f64,
    /// Megabytes that the textures of a GLB's frames may take in a viewer, where they change; beyond, all wear the first.
    #[arg(long, default_value_t = 512, value_name = "MB", value_parser = clap::value_parser!(u64).range(0..=65_536))]
    pub glb_textures: u64,
    /// Print an object with the walk and what it reaches on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `builder drive`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct DriveArguments {
    /// The clip: a .bvh file, an .asf file with an .amc file (`02.asf+02_01.amc`), or a .glb or .gltf file with a skin.
    #[arg(value_name = "CLIP")]
    pub clip: String,
    /// Who does it: a bundle, or a capture as `pack` takes it.
    #[arg(long, value_name = "ACTOR")]
    pub actor: String,
    /// How an actor that is not a bundle is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Where frames go: `walk.glb`, a pattern such as `walk/%05d.obj` (or .ply, .png), or a new folder for a capture that has
    /// them as one more sequence.
    #[arg(long, short, value_name = "OUT")]
    pub output: String,
    /// Leave beginning and end of the new sequence as the clip has them. Otherwise they are edited towards the recording, where that
    /// makes the ways in and out cheaper.
    #[arg(long)]
    pub as_driven: bool,
    /// Pack that capture, too, into this bundle.
    #[arg(long, value_name = "FILE")]
    pub into: Option<PathBuf>,
    /// Where results of packing last.
    #[command(flatten)]
    pub work: WorkFolderArgument,
    /// Name of the sequence; the clip's by default.
    #[arg(long = "as", value_name = "NAME")]
    pub sequence: Option<String>,
    /// Behaviours that the sequence shows.
    #[arg(long, value_delimiter = ',', value_name = "LABELS")]
    pub labels: Vec<String>,
    /// A TOML file that says which joint is which where that is not found, as hip_l = "LeftUpLeg" in its table "joints".
    #[arg(long, value_name = "FILE")]
    pub mapping: Option<PathBuf>,
    /// A TOML file to write, with the joints that were found.
    #[arg(long, value_name = "FILE")]
    pub write_mapping: Option<PathBuf>,
    /// A TOML or JSON file that corrects the actor's rig, as `builder rig --toml` writes it.
    #[arg(long, value_name = "FILE")]
    pub rig: Option<PathBuf>,
    /// Frames a second of the clip, instead of what it says; AMC files say nothing and are taken for 120.
    #[arg(long, value_name = "RATE")]
    pub rate: Option<f32>,
    /// Metres per unit of the clip; told from the skeleton's height where not given.
    #[arg(long, value_name = "METRES")]
    pub clip_unit: Option<f32>,
    /// The axis that points up in the clip.
    #[arg(long, value_enum, default_value = "y", value_name = "AXIS")]
    pub clip_up: UpAxis,
    /// Which clip of a glTF file; the first by default.
    #[arg(long, value_name = "NAME")]
    pub take: Option<String>,
    /// Keep a first frame that is no motion but the pose in which the skeleton was bound.
    #[arg(long)]
    pub keep_first: bool,
    /// Write only every so many frames; of a capture all are written.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub every: u32,
    /// Width and height of pictures in pixels.
    #[arg(long, default_value = "720x720", value_name = "SIZE", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Seconds in which the camera of pictures turns once about the actor.
    #[arg(long, default_value = "8s", value_name = "DURATION", value_parser = parse_seconds)]
    pub turn: f64,
    /// Print an object with what was measured on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `builder family`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct FamilyArguments {
    /// A capture, as `pack` takes it: a folder with a capture.toml, a manifest, a file, a pattern.
    #[arg(value_name = "CAPTURE")]
    pub capture: String,
    /// How it is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// A new folder for a capture that has the samples as further sequences. Without it, what cycles is listed, and families
    /// are proposed as text for the manifest.
    #[arg(long, short, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Sequences of one family, instead of those of the manifest or those proposed.
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub sequences: Vec<String>,
    /// By which number families are asked; all proposals, and speed for --sequences, where not given.
    #[arg(long, value_enum, value_name = "PARAMETER")]
    pub by: Option<FamilyKind>,
    /// Name of the family of --sequences; their names where not given.
    #[arg(long = "as", value_name = "NAME", requires = "sequences")]
    pub family: Option<String>,
    /// So many samples at even distances, from the least value to the greatest.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=64))]
    pub samples: Option<u16>,
    /// Samples at these values.
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "VALUES",
        conflicts_with = "samples",
        allow_negative_numbers = true
    )]
    pub at: Vec<f32>,
    /// Print an object with what was found and made on stdout.
    #[arg(long)]
    pub json: bool,
}

/// By which number a family is asked.
#[cfg(feature = "complete")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FamilyKind {
    /// Metres a second.
    Speed,
    /// Turn in radians per metre of the way; to the left is positive.
    Turn,
    /// How far a jump rises, in metres.
    Height,
    /// How far a jump leads, in metres.
    Length,
}

/// Arguments of `builder rig`.
#[derive(Debug, Args)]
pub struct RigArguments {
    /// A bundle, or inputs as `pack` takes them.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// How an input that is not a bundle is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// A picture to write: bones and joints over the surface, from the front and from the side, as a PNG.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// A TOML file to write, with the bones that were found: change it and give it back with --rig.
    #[arg(long, value_name = "FILE")]
    pub toml: Option<PathBuf>,
    /// A TOML or JSON file that corrects what was found. Without it and --parts, a bundle's own rig is shown.
    #[arg(long, value_name = "FILE")]
    pub rig: Option<PathBuf>,
    /// Rigid parts that the surface is split into at most; the file's where one is given, else 26.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=120))]
    pub parts: Option<u16>,
    /// Print an object on stdout instead of text.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `builder inspect`.
#[derive(Debug, Args)]
pub struct InspectArguments {
    /// A bundle, or inputs as `pack` takes them.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// How an input that is not a bundle is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Print an object on stdout instead of text.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `builder validate`.
#[derive(Debug, Args)]
pub struct ValidateArguments {
    /// A bundle, or inputs as `pack` takes them.
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<String>,
    /// How an input that is not a bundle is read.
    #[command(flatten)]
    pub import: ImportArguments,
    /// Print an object on stdout instead of text.
    #[arg(long)]
    pub json: bool,
}

/// A slope limit, or none.
#[derive(Clone, Copy, Debug)]
pub struct Slope(pub Option<u8>);

fn slope(text: &str) -> Result<Slope, String> {
    let most = TransitionOptions::MAX_SLOPE;
    match text.parse() {
        _ if text == "none" => Ok(Slope(None)),
        Ok(slope) if (1..=most).contains(&slope) => Ok(Slope(Some(slope))),
        _ => Err(format!("a slope limit is a number from 1 to {most}, or none")),
    }
}

/// Arguments of `builder report`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// The bundle to report on.
    #[arg(value_name = "BUNDLE")]
    pub bundle: PathBuf,
    /// The page to write; beside the bundle by default.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Arguments of `builder evaluate`.
#[cfg(feature = "complete")]
#[derive(Debug, Args)]
pub struct EvaluateArguments {
    /// Where results of stages last.
    #[command(flatten)]
    pub work: WorkFolderArgument,
    /// A capture, as `pack` takes it; the built-in performer's by default.
    #[arg(value_name = "CAPTURE")]
    pub inputs: Vec<String>,
    /// The folder to write the report into; made if it is missing.
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// The sections to make; all by default.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    pub sections: Vec<EvaluateSection>,
    /// Frames of the built-in performer's capture.
    #[arg(long, value_name = "N", conflicts_with = "inputs")]
    pub frames: Option<u32>,
    /// Vertices of the built-in performer, roughly.
    #[arg(long, value_name = "N", conflicts_with = "inputs")]
    pub vertices: Option<u32>,
    /// Seed of all that is drawn at random, and of the built-in performer.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
    /// Clips of motion capture for the section `editing`, as `builder drive` takes them.
    #[arg(long, value_delimiter = ',', value_name = "CLIPS")]
    pub clips: Vec<String>,
    /// How the input is read.
    #[command(flatten)]
    pub import: ImportArguments,
}

/// A section of the evaluation.
#[cfg(feature = "complete")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EvaluateSection {
    /// Pose distance against the skeleton's truth.
    Poses,
    /// Transitions: standard, warped, with varying lengths.
    Transitions,
    /// Essential graph against motion graph.
    Graphs,
    /// Trajectories, foot skate and seams.
    Blending,
    /// Linear, Poisson and as-rigid-as-possible in-betweens.
    Interpolation,
    /// Walks along paths and through poses at times.
    Walks,
    /// Size and speed of each stage.
    Scaling,
    /// Eigen appearance maps.
    Appearance,
    /// What blends add to walks, their seams, stutter and slide.
    Motion,
    /// Random walks of five minutes.
    Wandering,
    /// Transfer between the built-in performers, whatever the capture; only where it is asked for.
    Transfer,
    /// Families of cycles: asked against measured, soles, acceleration, volume.
    Families,
    /// Variations: how well motion is learned, and what alternatives look like as they are stored; only where they are asked for.
    Variations,
    /// Edits, rigs and driven sequences.
    Editing,
    /// A scan brought onto one mesh, against the truth where that lies beside it: takes a scan, and stands alone; without one the
    /// built-in performer is scanned.
    Scans,
}
