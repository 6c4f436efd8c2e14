//! Files that captures come in and that are not read here: what they are, and the way to go.

use super::paths::ending;
use std::path::Path;

/// A format by the ending of its files.
struct Format {
    endings: &'static [&'static str],
    /// What a file is, and how to make one of it that is read.
    told: &'static str,
}

/// The way for scenes and caches that Blender opens.
macro_rules! by_blender {
    ($what:literal) => {
        concat!($what, ", which is not read: import it in Blender and export it as glTF, or every frame as OBJ or PLY")
    };
}

/// Formats of meshes and of whole captures.
const MESHES: &[Format] = &[
    #[cfg(not(feature = "gltf"))]
    Format {
        endings: &["drc"],
        told: "a mesh compressed by Draco, and this program was compiled without glTF: cargo build --release -p \
               reprise-builder compiles one that reads it",
    },
    Format {
        endings: &["uvol", "crt"],
        told: "the geometry of Universal Volumetric 1 (Corto), which is not read: encode the frames as version 2 (Draco and \
               KTX2), or write every frame as OBJ",
    },
    Format { endings: &["abc"], told: by_blender!("an Alembic cache") },
    Format { endings: &["usd", "usda", "usdc", "usdz"], told: by_blender!("a USD scene") },
    Format {
        endings: &["fbx"],
        told: "an FBX scene, which is not read: make a GLB of it with FBX2glTF, or import it in Blender and export it as \
               glTF",
    },
    Format { endings: &["dae"], told: by_blender!("a COLLADA scene") },
    Format {
        endings: &["blend"],
        told: "a Blender file, which is not read: export it as glTF, or every frame as OBJ or PLY",
    },
    Format { endings: &["stl"], told: by_blender!("an STL mesh") },
    Format { endings: &["x3d", "wrl", "3ds"], told: by_blender!("a scene") },
    Format {
        endings: &["off", "vtk", "vtp", "msh", "npz", "npy", "pkl"],
        told: "a mesh, which is not read: write it as PLY, for example with meshio or trimesh",
    },
    Format {
        endings: &["mdd", "pc2", "bgeo"],
        told: "a cache of points without faces, which is not read: apply it to its mesh and export every frame as OBJ or PLY",
    },
    Format {
        endings: &["bvh", "asf", "amc", "c3d", "trc"],
        told: "motion without a surface, which is not read: apply it to a skinned character and export that as glTF",
    },
    Format {
        endings: &["4ds"],
        told: "a sequence of 4DViews, which is not read: export every frame as OBJ with its texture from the software of \
               4DViews, in parts that keep one mesh",
    },
    Format {
        endings: &["splat", "spz", "ksplat", "sog"],
        told: "a cloud of splats without a surface, which is not read: a tracked mesh is needed",
    },
    Format {
        endings: &["pcd", "xyz", "las", "laz", "e57", "pts"],
        told: "a cloud of points without a surface, which is not read: a tracked mesh is needed",
    },
    Format {
        endings: &["zip", "tar", "gz", "tgz", "xz", "bz2", "7z", "rar", "zst"],
        told: "an archive: unpack it and name the folder",
    },
    Format { endings: &["vrm"], told: "a glTF file under another ending: rename it to .glb" },
];

/// Formats of video.
const VIDEO: &str = "a video, which is not read: if it is the texture of a capture, write its frames as images (ffmpeg -i \
                     FILE texture_%05d.png); if it holds the capture itself, export meshes from the program that made it";
const VIDEO_ENDINGS: [&str; 7] = ["mp4", "mov", "webm", "mkv", "avi", "m4v", "mpg"];

/// Formats of images.
const IMAGES: &[Format] = &[
    Format {
        endings: &["ktx2", "ktx", "basis"],
        told: "a texture compressed for graphics cards, which is read within glTF at most: write it as PNG, for example with \
               \"ktx extract\"",
    },
    Format {
        endings: &[
            "dds", "tga", "bmp", "tif", "tiff", "gif", "psd", "exr", "hdr", "avif", "heic", "jxl", "jp2", "ppm", "pgm",
            "pnm",
        ],
        told: "an image that is not read: convert it to PNG, JPEG or WebP",
    },
];

/// What `path` is, judged by its ending, where it is a mesh or a capture that is not read.
pub(super) fn unread_mesh(path: &Path) -> Option<&'static str> {
    find(MESHES, path).or_else(|| video(path))
}

/// What `path` is, judged by its ending, where it is an image that is not read.
pub(super) fn unread_image(path: &Path) -> Option<&'static str> {
    find(IMAGES, path).or_else(|| video(path))
}

/// What `path` is, whatever it is.
pub(super) fn unread(path: &Path) -> Option<&'static str> {
    unread_mesh(path).or_else(|| unread_image(path))
}

fn find(formats: &[Format], path: &Path) -> Option<&'static str> {
    let ending = ending(path);
    formats.iter().find(|format| format.endings.contains(&ending.as_str())).map(|format| format.told)
}

fn video(path: &Path) -> Option<&'static str> {
    VIDEO_ENDINGS.contains(&ending(path).as_str()).then_some(VIDEO)
}

/// What the first bytes of a file named .obj or .ply show, where they show another format.
pub(super) fn disguised(bytes: &[u8], path: &Path) -> Option<&'static str> {
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    match bytes {
        _ if starts(b"glTF") => Some("a GLB file under another ending: rename it"),
        _ if starts(b"ply\n") || starts(b"ply\r") => {
            (ending(path) != "ply").then_some("a PLY file under another ending: rename it")
        }
        _ if starts(b"DRACO") => {
            (ending(path) != "drc").then_some("a mesh compressed by Draco under another ending: rename it to .drc")
        }
        _ if starts(b"Kaydara FBX") => Some("an FBX scene under another ending: make a GLB of it with FBX2glTF"),
        _ if starts(b"version https://git-lfs") => {
            Some("a placeholder of Git LFS, not the file itself: fetch it with \"git lfs pull\"")
        }
        _ if starts(b"PK\x03\x04") || starts(b"\x1f\x8b") || starts(b"\xfd7zXZ") || starts(b"\x28\xb5\x2f\xfd") => {
            Some("compressed: unpack it")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ending_is_named_once_and_none_is_read() {
        let mut endings: Vec<&str> = VIDEO_ENDINGS.to_vec();
        endings.extend(MESHES.iter().chain(IMAGES).flat_map(|format| format.endings));
        let count = endings.len();
        endings.sort_unstable();
        endings.dedup();
        assert_eq!(endings.len(), count);
        let others = if cfg!(feature = "gltf") { &["drc"][..] } else { &[] };
        let read = [
            "obj", "ply", "glb", "gltf", "toml", "png", "jpg", "jpeg", "webp", "reprise", "json", "manifest", "vols",
            "vol",
        ];
        for read in read.iter().chain(others) {
            assert!(!endings.contains(read));
        }
        assert!(unread_mesh(Path::new("A/WALK.FBX")).is_some_and(|told| told.contains("FBX2glTF")));
        assert!(unread_image(Path::new("t.mp4")).is_some() && unread_mesh(Path::new("t.mp4")).is_some());
        assert_eq!(unread(Path::new("notes.txt")), None);
    }
}
