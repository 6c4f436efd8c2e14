//! Scanned frames of several materials.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;

use capture_io::import::{ImportError, ImportOptions, scans};
use glam::Vec2;

fn picture(path: &Path, colour: [u8; 3]) {
    image::RgbImage::from_pixel(4, 4, image::Rgb(colour)).save(path).unwrap();
}

/// Two triangles, each of its own material.
fn write(folder: &Path, second: &str) {
    fs::write(
        folder.join("frame_0000.obj"),
        "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.1 0.1\nvt 0.9 0.1\nvt 0.9 0.9\nvt 0.1 0.9\n\
         usemtl body\nf 1/1 2/2 3/3\nusemtl head\nf 1/1 3/3 4/4\n",
    )
    .unwrap();
    fs::write(folder.join("looks.mtl"), format!("newmtl body\nmap_Kd body.png\nnewmtl head\n{second}\n")).unwrap();
    picture(&folder.join("body.png"), [200, 10, 10]);
    picture(&folder.join("head.png"), [10, 10, 200]);
}

fn colours(second: &str) -> Result<Vec<[u8; 3]>, ImportError> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), second);
    let inputs = [folder.path().to_str().unwrap().to_owned()];
    let frame = scans(&inputs, &ImportOptions::default())?.read(0)?;
    let (width, height, texels) = frame.texture.unwrap().decoded()?;
    let at = |uv: Vec2| texels[(uv.y * height as f32) as usize * width + (uv.x * width as f32) as usize];
    Ok(frame.uvs.iter().map(|[a, b, c]| at((*a + *b + *c) / 3.0)).collect())
}

#[test]
fn each_material_keeps_its_picture() {
    assert_eq!(colours("map_Kd head.png").unwrap(), [[200, 10, 10], [10, 10, 200]]);
    assert_eq!(colours("map_Kd body.png").unwrap(), [[200, 10, 10]; 2]);
    // Of one colour, which is given as it is seen.
    let plain = colours("Kd 0 1 0").unwrap();
    assert_eq!(plain[0], [200, 10, 10]);
    assert_eq!(plain[1], [0, 255, 0]);
}

#[test]
fn a_picture_that_is_missing_is_told() {
    let error = colours("map_Kd nose.png").unwrap_err();
    assert!(error.to_string().contains("nose.png"), "{error}");
}
