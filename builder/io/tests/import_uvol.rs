//! Volumetric video: Draco files, one a frame, by themselves and named by a manifest of Universal Volumetric, with textures in KTX2
//! files of several frames each. Values are held against what the formats' own decoders made of the same files.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;

use capture_io::import::{ImportError, ImportOptions, Scans, import, scans};
use job::Job;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");

fn data(name: &str) -> Vec<u8> {
    fs::read(format!("{DATA}{name}")).unwrap()
}

fn write(path: &Path, bytes: impl AsRef<[u8]>) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Positions that the authors' decoder makes of a sample.
fn places(name: &str) -> Vec<f32> {
    data(&format!("draco/{name}.positions"))
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

/// The picture `layer` of a sample of 32 x 24 pixels as it is stored, without alpha.
fn pixels(name: &str, layer: usize) -> Vec<Vec<[u8; 3]>> {
    let all = data(&format!("ktx2/{name}.rgba"));
    let one = &all[layer * 32 * 24 * 4..(layer + 1) * 32 * 24 * 4];
    one.chunks_exact(32 * 4).map(|row| row.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect()).collect()
}

fn found(path: &Path) -> Scans {
    scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()).unwrap()
}

fn refusal(path: &Path) -> (&'static str, String) {
    let error: ImportError = scans(&[path.to_string_lossy().into_owned()], &ImportOptions::default()).unwrap_err();
    (error.code(), error.to_string())
}

#[test]
fn draco_files_are_frames() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let names = ["edgebreaker", "sequential", "valence"];
    for (k, name) in names.iter().enumerate() {
        write(&f.join(format!("scan/frame_{k:04}.drc")), data(&format!("draco/{name}.drc")));
        write(&f.join(format!("one/frame_{k:04}.drc")), data("draco/unquantised.drc"));
    }
    let scan = found(&f.join("scan"));
    assert_eq!((scan.frame_count(), scan.sequences[0].name.as_str()), (3, "scan"));
    for (k, name) in names.iter().enumerate() {
        let frame = scan.read(k).unwrap();
        let flat: Vec<f32> = frame.positions.iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(flat, places(name), "{name}");
        assert_eq!(
            (frame.uvs.len(), frame.triangles.len()),
            (frame.triangles.len(), data(&format!("draco/{name}.faces")).len() / 12)
        );
    }
    // Frames of one mesh are a capture as it is.
    let input = [f.join("one").to_string_lossy().into_owned()];
    let capture = import(&input, &ImportOptions::default(), &Job::silent()).unwrap().capture;
    assert_eq!((capture.timeline.frame_count(), capture.surface.triangles.len()), (3, 128));
    // Kinds are not mixed.
    write(&f.join("scan/frame_0009.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let (code, message) = refusal(&f.join("scan"));
    assert!(code == "E_FORMAT_MIXED" && message.contains("1 .obj and 3 .drc"), "{message}");
    write(&f.join("cut/frame_0000.drc"), &data("draco/valence.drc")[..300]);
    let error = import(&[f.join("cut").to_string_lossy().into_owned()], &ImportOptions::default(), &Job::silent());
    let error = error.unwrap_err();
    assert!(error.code() == "E_BINARY" && error.to_string().contains("frame_0000.drc"), "{error}");
}

/// A manifest of the newer form, with a finer and a coarser target of everything.
const TARGETS: &str = r#"{
  "version": "v2",
  "input": { "texture": { "baseColor": [{ "path": "in.png", "tag": "red" }, { "path": "b.png", "tag": "blue" }] } },
  "audio": { "path": "sound[ext]", "formats": ["mp3"], "playbackRate": 1 },
  "geometry": {
    "targets": {
      "coarse": { "format": "draco", "frameRate": 12, "frameCount": 3, "scale": 1, "settings": {} },
      "fine": { "format": "draco", "frameRate": 24, "frameCount": 6, "scale": 0.5, "settings": {} },
      "solved": { "format": "uniform-solve", "segmentCount": 4 }
    },
    "path": "geometry_[target]/[#####][ext]"
  },
  "texture": {
    "baseColor": {
      "targets": {
        "small": { "format": "ktx2", "frameRate": 12, "settings": { "resolution": { "width": 16, "height": 16 } } },
        "large": { "format": "ktx2", "frameRate": 12, "settings": { "resolution": { "width": 32, "height": 24 } } },
        "other": { "format": "astc/ktx", "frameRate": 12 }
      }
    },
    "normal": { "targets": {} },
    "path": "texture_[target]_[type]_[tag]/[####][ext]"
  }
}"#;

fn write_video(f: &Path) {
    for (k, name) in ["edgebreaker", "sequential", "valence"].iter().cycle().take(6).enumerate() {
        write(&f.join(format!("geometry_fine/{k:05}.drc")), data(&format!("draco/{name}.drc")));
    }
    write(&f.join("texture_large_baseColor_red/0000.ktx2"), data("ktx2/etc1s-layers.ktx2"));
    write(&f.join("walk.uvol.manifest.json"), TARGETS);
}

#[test]
fn the_finest_target_of_a_manifest_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path().join("video");
    write_video(&f);
    // By its folder, and by itself.
    for input in [f.clone(), f.join("walk.uvol.manifest.json")] {
        let scan = found(&input);
        assert_eq!((scan.fps, scan.frame_count(), scan.sequences[0].name.as_str()), (24.0, 6, "walk"));
        let codes: Vec<&str> = scan.warnings.iter().map(|warning| warning.code).collect();
        assert_eq!(codes, ["W_UVOL_LEFT_OUT"], "{:?}", scan.warnings);
        for part in ["normal", "sound", "blue"] {
            assert!(scan.warnings[0].message.contains(part), "{}", scan.warnings[0]);
        }
        for frame in 0..6 {
            let read = scan.read(frame).unwrap();
            let name = ["edgebreaker", "sequential", "valence"][frame % 3];
            let wanted: Vec<f32> = places(name).iter().map(|c| c * 0.5).collect();
            assert_eq!(read.positions.iter().flat_map(|p| p.to_array()).collect::<Vec<_>>(), wanted);
            let (width, height, texels) = read.texture.unwrap().decoded().unwrap();
            // Textures at half the rate; v upwards finds the first row that is stored lowest.
            let stored = pixels("etc1s-layers", (frame as f64 / 2.0).round() as usize);
            let wanted: Vec<[u8; 3]> = stored.into_iter().rev().flatten().collect();
            assert_eq!((width, height), (32, 24));
            assert!(texels == wanted, "frame {frame}");
        }
    }
}

#[test]
fn the_older_form_is_read_and_textures_that_end_early_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    for k in 0..9 {
        write(&f.join(format!("DRC/frame_{k:07}.drc")), data("draco/edgebreaker.drc"));
    }
    // A video whose pictures build on each other, and a last file of fewer.
    write(&f.join("KTX2/texture_0000000.ktx2"), data("ktx2/etc1s-video.ktx2"));
    write(&f.join("KTX2/texture_0000001.ktx2"), data("ktx2/uastc-zstd-layers.ktx2"));
    let manifest = r####"{ "DRCURLPattern": "DRC/frame_#######.drc", "KTX2URLPattern": "KTX2/texture_#######.ktx2", "BatchSize": 5,
        "GeometryFrameCount": 9, "TextureSegmentCount": 2, "GeometryFrameRate": 30, "TextureFrameRate": 30, "AudioURL": "" }"####;
    write(&f.join("dance.manifest"), manifest);
    let scan = found(&f.join("dance.manifest"));
    assert_eq!((scan.fps, scan.frame_count(), scan.sequences[0].name.as_str()), (30.0, 9, "dance"));
    assert_eq!(scan.warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["W_TEXTURE_LOST"]);
    for (frame, name, layer) in
        [(3, "etc1s-video", 3), (4, "etc1s-video", 4), (6, "uastc-zstd-layers", 1), (8, "uastc-zstd-layers", 2)]
    {
        let texels = scan.read(frame).unwrap().texture.unwrap().decoded().unwrap().2;
        assert!(texels == pixels(name, layer).into_iter().rev().flatten().collect::<Vec<_>>(), "frame {frame}");
    }
    // All frames have one mesh: the whole is a capture, with a texture a frame.
    let input = [f.to_string_lossy().into_owned()];
    let imported = import(&input, &ImportOptions::default(), &Job::silent()).unwrap();
    let textures = imported.frame_textures.unwrap();
    assert_eq!((textures.len(), imported.capture.timeline.fps()), (9, 30.0));
    let picture = image::open(&textures[4]).unwrap().into_rgb8();
    let wanted: Vec<u8> = pixels("etc1s-video", 4).into_iter().rev().flatten().flatten().collect();
    assert!(picture.into_raw() == wanted);
    assert_eq!(textures[7], textures[8]);
}

#[test]
fn manifests_that_cannot_be_used_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    let manifest = f.join("m.json");
    let of = |text: &str| {
        fs::write(&manifest, text).unwrap();
        refusal(&manifest)
    };
    for (text, said) in [
        ("{", "no manifest of Universal Volumetric"),
        ("{}", "names no geometry"),
        (r#"{ "maxVertices": 3, "frameData": [], "frameRate": 30 }"#, "version 1"),
        (
            r#"{ "geometry": { "targets": { "a": { "format": "uniform-solve" } }, "path": "x" }, "texture": {} }"#,
            "uniform-solve",
        ),
        (r#"{ "geometry": { "targets": { "a": { "format": "draco", "frameRate": 0 } }, "path": "x" } }"#, "positive"),
        (r#"{ "geometry": { "targets": { "a": { "format": "draco" } }, "path": "x" } }"#, "frameRate"),
        (r#"{ "DRCURLPattern": "a.drc", "GeometryFrameRate": 30 }"#, "no number of a frame"),
        (r#"{ "DRCURLPattern": "https://x/##.drc", "GeometryFrameRate": 30 }"#, "on the web"),
        (r#"{ "DRCURLPattern": "a##.drc" }"#, "GeometryFrameRate is missing"),
    ] {
        let (code, message) = of(text);
        assert!(code == "E_UVOL" && message.contains(said) && message.contains("m.json"), "{text}: {message}");
    }
    assert_eq!(of(r#"{ "DRCURLPattern": "a##.drc", "GeometryFrameRate": 30 }"#).0, "E_NOT_FOUND");
    // A frame that is missing, and a texture that is none.
    write_video(f);
    fs::remove_file(f.join("geometry_fine/00004.drc")).unwrap();
    let (code, message) = refusal(&f.join("walk.uvol.manifest.json"));
    assert!(code == "E_FRAME_MISSING" && message.contains("00004.drc"), "{message}");
    write_video(f);
    write(&f.join("texture_large_baseColor_red/0000.ktx2"), "no texture");
    let (code, message) = refusal(&f.join("walk.uvol.manifest.json"));
    assert!(code == "E_IMAGE" && message.contains("0000.ktx2"), "{message}");
    // What is encoded as version 1 is named by its ending, too.
    write(&f.join("old/x.uvol"), "x");
    assert!(refusal(&f.join("old")).1.contains("Corto"));
}
