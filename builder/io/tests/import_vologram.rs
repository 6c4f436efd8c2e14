//! Volograms of all versions, whole and in parts, with textures and without, and what is wrong with damaged ones.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::{Path, PathBuf};

use capture_io::import::{ImportOptions, Scans, import, scans};
use glam::{Vec2, Vec3};
use job::Job;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/ktx2/");

fn picture(name: &str) -> Vec<u8> {
    fs::read(format!("{DATA}{name}")).unwrap()
}

/// A vologram as it is written.
#[derive(Clone)]
struct Take {
    version: u32,
    normals: bool,
    /// A texture a frame.
    textures: Vec<Vec<u8>>,
    container: u8,
    sound: bool,
    translation: f32,
    /// Frames at which the mesh changes.
    keys: Vec<usize>,
    frames: usize,
}

impl Take {
    fn new(version: u32) -> Self {
        Self {
            version,
            normals: version >= 11,
            textures: Vec::new(),
            container: 1,
            sound: false,
            translation: 0.0,
            keys: vec![0],
            frames: 4,
        }
    }

    fn header(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let word = |out: &mut Vec<u8>, word: u32| out.extend(word.to_le_bytes());
        out.extend(if self.version < 13 { &b"\x04VOLS"[..] } else { b"VOLS" });
        word(&mut out, self.version);
        word(&mut out, 0);
        if self.version < 13 {
            out.extend(b"\x04mesh\x05paint\x00");
            word(&mut out, 0);
        }
        word(&mut out, self.frames as u32);
        if self.version >= 11 {
            out.extend([u8::from(self.normals), u8::from(!self.textures.is_empty())]);
        }
        match self.version {
            11 | 12 => out.extend([0, 2, 0, 2, 0, 0]),
            13 => {
                out.extend([if self.textures.is_empty() { 0 } else { 1 }, self.container]);
                let sound = [3_u32.to_le_bytes().as_slice(), b"abc"].concat();
                let body = 44 + if self.sound { sound.len() as u32 } else { 0 };
                for value in [32, 24, 25.0_f32.to_bits(), u32::from(self.sound), 44, body] {
                    word(&mut out, value);
                }
                out.extend(if self.sound { sound } else { Vec::new() });
            }
            _ => {}
        }
        if self.version == 12 {
            for number in [self.translation, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] {
                word(&mut out, number.to_bits());
            }
        }
        out
    }

    fn body(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut group = 0;
        for frame in 0..self.frames {
            let key = self.keys.contains(&frame);
            if key {
                group = frame;
            }
            let shape = Shape::new(frame, group);
            let mut arrays = vec![shape.vertices.clone()];
            if self.normals {
                arrays.push(shape.normals);
            }
            if key {
                arrays.extend([shape.indices, shape.uvs]);
            }
            arrays.extend(self.textures.get(frame).cloned());
            let data: usize = arrays.iter().map(Vec::len).sum();
            // Up to 1.1 the size leaves out the lengths of all arrays but the first.
            let lengths = if self.version < 12 { 4 } else { 4 * arrays.len() };
            let size = ((data + lengths) as u32).to_le_bytes();
            out.extend((frame as u32).to_le_bytes());
            out.extend(size);
            out.push(u8::from(key));
            for array in arrays {
                out.extend((array.len() as u32).to_le_bytes());
                out.extend(array);
            }
            out.extend(size);
        }
        out
    }

    fn whole(&self) -> Vec<u8> {
        [self.header(), self.body()].concat()
    }
}

/// A tetrahedron that is apart in its corners, as textures want it: x runs to the left, triangles clockwise.
struct Shape {
    vertices: Vec<u8>,
    normals: Vec<u8>,
    indices: Vec<u8>,
    uvs: Vec<u8>,
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u16; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

fn place(corner: usize, frame: usize) -> Vec3 {
    Vec3::from(CORNERS[corner]) + Vec3::new(0.25, 0.125, 0.0) * frame as f32
}

impl Shape {
    /// `group` says which texture coordinates it has.
    fn new(frame: usize, group: usize) -> Self {
        let floats = |all: Vec<f32>| all.iter().flat_map(|value| value.to_le_bytes()).collect();
        let corners = || FACES.as_flattened().iter().map(|&corner| usize::from(corner));
        let uv = |k: usize| [k as f32 / 16.0, (group as f32 + 1.0) / 8.0];
        Self {
            vertices: floats(corners().flat_map(|corner| place(corner, frame).to_array()).collect()),
            normals: floats(corners().flat_map(|_| [1.0, 0.0, 0.0]).collect()),
            indices: (0..12_u16).flat_map(u16::to_le_bytes).collect(),
            uvs: floats((0..12).flat_map(uv).collect()),
        }
    }
}

fn write(path: &Path, bytes: impl AsRef<[u8]>) -> String {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
    path.to_string_lossy().into_owned()
}

fn found(path: &Path) -> Scans {
    scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()).unwrap()
}

fn refusal(path: &Path) -> (&'static str, String) {
    let error = scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()).unwrap_err();
    (error.code(), error.to_string())
}

/// Positions, triangles and texture coordinates are those that were written, turned to our axes.
fn assert_frames(scan: &Scans, take: &Take) {
    assert_eq!(scan.frame_count(), take.frames);
    let mut group = 0;
    for frame in 0..take.frames {
        if take.keys.contains(&frame) {
            group = frame;
        }
        let read = scan.read(frame).unwrap();
        assert_eq!(read.triangles.len(), 4);
        for (face, (triangle, uvs)) in FACES.iter().zip(read.triangles.iter().zip(&read.uvs)) {
            // The last corner comes first.
            for (k, (&vertex, uv)) in triangle.iter().zip(uvs).enumerate() {
                let written = place(face[2 - k].into(), frame);
                assert_eq!(read.positions[vertex as usize], Vec3::new(-written.x, written.y, written.z));
                assert_eq!(*uv, Vec2::new(vertex as f32 / 16.0, 1.0 - (group as f32 + 1.0) / 8.0), "frame {frame}");
            }
        }
        // Outwards: away from the middle.
        let [a, b, c] = read.triangles[3].map(|vertex| read.positions[vertex as usize]);
        let middle = read.positions.iter().sum::<Vec3>() / read.positions.len() as f32;
        assert!((b - a).cross(c - a).dot(a - middle) > 0.0);
    }
}

#[test]
fn every_version_is_read() {
    let folder = tempfile::tempdir().unwrap();
    for version in 10..=13 {
        let take = Take { keys: vec![0, 2], sound: version == 13, ..Take::new(version) };
        let path = folder.path().join(format!("walk{version}.vols"));
        write(&path, take.whole());
        let scan = found(&path);
        assert_frames(&scan, &take);
        assert_eq!(scan.sequences[0].name, format!("walk{version}"));
        assert_eq!(scan.fps, if version == 13 { 25.0 } else { 30.0 });
        let told =
            scan.warnings.iter().any(|warning| warning.code == "W_VOLS_LEFT_OUT" && warning.message.contains("sound"));
        assert_eq!(told, version == 13);
    }
    // A folder of volograms, and several that are named by a glob, are several sequences.
    assert_eq!(found(folder.path()).sequences.len(), 4);
    let glob = folder.path().join("walk1[12].vols");
    assert_eq!(found(&glob).sequences.len(), 2);
}

#[test]
fn header_and_frames_may_be_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let take = Take { translation: 2.0, ..Take::new(12) };
    write(&f.join("dance/header.vols"), take.header());
    write(&f.join("dance/sequence_0.vols"), take.body());
    for named in ["dance", "dance/header.vols", "dance/sequence_0.vols"] {
        let scan = found(&f.join(named));
        assert_frames(&scan, &take);
        assert_eq!((scan.sequences.len(), scan.sequences[0].name.as_str()), (1, "dance"), "{named}");
        assert_eq!(scan.name, "dance", "{named}");
        assert!(scan.warnings.iter().any(|warning| warning.message.contains("moves, turns and scales")));
    }
    // Several takes in a folder are told apart by their names.
    let short = Take { frames: 2, ..Take::new(12) };
    for (name, take) in [("cone", &take), ("cube", &short)] {
        write(&f.join(format!("both/{name}_hdr.vol")), take.header());
        write(&f.join(format!("both/{name}_seq.vol")), take.body());
    }
    let both = found(&f.join("both"));
    let lengths: Vec<(&str, usize)> = both.sequences.iter().map(|s| (s.name.as_str(), s.files.len())).collect();
    assert_eq!(lengths, [("cone", 4), ("cube", 2)]);
    write(&f.join("alone/sequence_0.vols"), take.body());
    let (code, message) = refusal(&f.join("alone/sequence_0.vols"));
    assert!(code == "E_BINARY" && message.contains("header.vols"), "{message}");
    write(&f.join("bare/header.vols"), take.header());
    let (code, message) = refusal(&f.join("bare"));
    assert!(code == "E_BINARY" && message.contains("sequence_0.vols"), "{message}");
}

#[test]
fn one_mesh_is_a_capture_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let take = Take::new(13);
    let input = [write(&folder.path().join("walk.vols"), take.whole())];
    let capture = import(&input, &ImportOptions::default(), &Job::silent()).unwrap().capture;
    assert_eq!((capture.timeline.frame_count(), capture.timeline.fps()), (4, 25.0));
    // Corners of one place are one vertex.
    assert_eq!((capture.topology.vertex_count(), capture.surface.triangles.len()), (4, 4));
    let changes = Take { keys: vec![0, 1, 2, 3], ..take };
    let mut other = changes.body();
    // Another order of corners in the second frame.
    let frame = other.len() / 4;
    let at = 2 * frame - 4 - 12 * 8 - 4 - 24;
    other[at..at + 6].rotate_left(2);
    write(&folder.path().join("other.vols"), [changes.header(), other].concat());
    let input = [folder.path().join("other.vols").to_string_lossy().into_owned()];
    let error = import(&input, &ImportOptions::default(), &Job::silent()).unwrap_err();
    assert!(error.code() == "E_FACE_LIST" && error.to_string().contains("frame_00001"), "{error}");
}

#[test]
fn textures_within_are_those_of_their_frames() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["basis-etc1s", "basis-uastc", "etc1s", "uastc"];
    let ending = |name: &str| if name.starts_with("basis") { "basis" } else { "ktx2" };
    let textures = names.map(|name| picture(&format!("{name}.{}", ending(name)))).to_vec();
    let take = Take { textures, ..Take::new(13) };
    let path = folder.path().join("walk.vols");
    write(&path, take.whole());
    let scan = found(&path);
    assert_frames(&scan, &take);
    for (frame, name) in names.iter().enumerate() {
        let (width, height, texels) = scan.read(frame).unwrap().texture.unwrap().decoded().unwrap();
        let written: Vec<[u8; 3]> =
            picture(&format!("{name}.rgba")).chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!((width, height, texels.len()), (32, 24, written.len()));
        assert_eq!(texels, written, "{name}");
    }
    // As a capture of one mesh, each frame wears its own.
    let input = [path.to_string_lossy().into_owned()];
    let imported = import(&input, &ImportOptions::default(), &Job::silent()).unwrap();
    assert!(imported.warnings.iter().all(|warning| !warning.code.contains("TEXTURE")), "{:?}", imported.warnings);
    let damaged = Take { textures: vec![vec![1; 40]; 4], ..take.clone() };
    write(&path, damaged.whole());
    let error = found(&path).read(2).unwrap().texture.unwrap().decoded().unwrap_err();
    assert!(error.to_string().contains("frame_00002"), "{error}");
    let video = Take { container: 0, ..take };
    let mut bytes = video.whole();
    bytes[18] = 0;
    write(&path, bytes);
    let scan = found(&path);
    assert!(
        scan.warnings.iter().any(|w| w.code == "W_VOLS_LEFT_OUT" && w.message.contains("video")),
        "{:?}",
        scan.warnings
    );
    assert!(scan.read(0).unwrap().texture.is_none());
}

#[test]
fn a_video_is_told_and_its_images_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let take = Take::new(12);
    write(&f.join("header.vols"), take.header());
    write(&f.join("sequence_0.vols"), take.body());
    write(&f.join("texture_1024_h264.mp4"), "a video");
    let scan = found(f);
    let told = scan.warnings.iter().find(|warning| warning.code == "W_VOLS_VIDEO").unwrap();
    assert!(told.message.contains("ffmpeg") && told.message.contains("-start_number 0"), "{told:?}");
    for frame in 0..4_u8 {
        let image = image::RgbImage::from_pixel(8, 8, image::Rgb([50 * frame, 0, 0]));
        image.save(f.join(format!("texture_{frame:05}.png"))).unwrap();
    }
    let scan = found(f);
    assert!(scan.warnings.iter().all(|warning| warning.code != "W_VOLS_VIDEO"));
    for frame in 0..4 {
        let (.., texels) = scan.read(frame).unwrap().texture.unwrap().decoded().unwrap();
        assert_eq!(usize::from(texels[0][0]), 50 * frame);
    }
}

#[test]
fn damaged_files_are_told_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.vols");
    let take = Take { keys: vec![0, 2], ..Take::new(13) };
    let (whole, head) = (take.whole(), take.header().len());
    let told = |bytes: &[u8]| {
        write(&path, bytes);
        match scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()) {
            Ok(scan) => {
                (0..scan.frame_count()).find_map(|k| scan.read(k).err()).map_or(String::new(), |e| e.to_string())
            }
            Err(error) => {
                assert_eq!(error.code(), "E_BINARY", "{error}");
                error.to_string()
            }
        }
    };
    assert_eq!(told(&whole), "");
    let cut = told(&whole[..whole.len() - 7]);
    assert!(cut.contains("frame 3") && cut.contains("cut short") && cut.contains("fetch"), "{cut}");
    let fewer = told(&[&take.header()[..], &Take { frames: 2, ..take.clone() }.body()].concat());
    assert!(fewer.contains("4 frames, and there are 2"), "{fewer}");
    let no_key = told(&[&take.header()[..], &Take { keys: vec![1], ..take.clone() }.body()].concat());
    assert!(no_key.contains("frame 0") && no_key.contains("keyframe"), "{no_key}");
    let mut size = whole.clone();
    size[head + 4] ^= 1;
    assert!(told(&size).contains("frame 0"));
    let mut index = whole.clone();
    // The first index of the first frame: behind its vertices and normals.
    let at = head + 9 + 2 * (4 + 12 * 12) + 4;
    index[at] = 200;
    let message = told(&index);
    assert!(message.contains("triangle 0 names vertex 200, of 12"), "{message}");
    let mut compressed = whole.clone();
    compressed[8] = 1;
    assert!(told(&compressed).contains("compressed"));
    let mut newer = whole.clone();
    newer[4] = 21;
    assert!(told(&newer).contains("version 2.1"));
    // Whatever is changed, nothing panics.
    for at in (0..whole.len()).step_by(3) {
        let mut damaged = whole.clone();
        damaged[at] ^= 0xff;
        write(&path, &damaged);
        let Ok(scan) = scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()) else { continue };
        (0..scan.frame_count()).for_each(|frame| drop(scan.read(frame)));
    }
    let gone: PathBuf = folder.path().join("gone.vols");
    assert_eq!(refusal(&gone).0, "E_NOT_FOUND");
}
