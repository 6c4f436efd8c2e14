//! What the import tests share: folders of files, a writer of GLB files, checks that hold for every capture.
#![allow(dead_code, reason = "each test binary uses its own part")]

use job::Job;
use std::fs;
use std::path::Path;

use capture_io::import::{ImportError, ImportOptions, Imported, import};
use serde_json::{Value, json};

/// Imports `inputs`, given relative to `folder`.
pub fn try_read(folder: &Path, inputs: &[&str], options: &ImportOptions) -> Result<Imported, ImportError> {
    let inputs: Vec<String> = inputs.iter().map(|p| folder.join(p).to_str().unwrap().to_owned()).collect();
    import(&inputs, options, &Job::silent())
}

/// Imports `inputs` and checks what holds for every capture.
pub fn read(folder: &Path, inputs: &[&str], options: &ImportOptions) -> Imported {
    let imported = try_read(folder, inputs, options).unwrap_or_else(|e| panic!("{e}"));
    check(&imported);
    imported
}

/// Imports with 25 frames per second and no other option.
pub fn read_plain(folder: &Path, inputs: &[&str]) -> Imported {
    read(folder, inputs, &ImportOptions { fps: Some(25.0), ..ImportOptions::default() })
}

/// The code and the message with which `inputs` are refused.
pub fn refusal(folder: &Path, inputs: &[&str]) -> (&'static str, String) {
    match try_read(folder, inputs, &ImportOptions::default()) {
        Ok(_) => panic!("{inputs:?} was read"),
        Err(error) => (error.code(), error.to_string()),
    }
}

/// Writes files into `folder`, making folders on the way.
pub fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        write_bytes(folder, name, text.as_bytes());
    }
}

/// Writes one file.
pub fn write_bytes(folder: &Path, name: &str, bytes: &[u8]) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// A PNG of one colour.
pub fn png(size: u32, colour: [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let image = image::RgbImage::from_pixel(size, size, image::Rgb(colour));
    image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes
}

/// What holds for every capture.
pub fn check(imported: &Imported) {
    let capture = &imported.capture;
    let (topology, surface) = (&capture.topology, &capture.surface);
    assert_eq!(capture.poses.len(), capture.timeline.frame_count() as usize);
    assert_eq!(capture.poses.vertex_count(), topology.vertex_count());
    assert_eq!(surface.triangles.len(), topology.triangles().len());
    for (drawn, welded) in surface.triangles.iter().zip(topology.triangles()) {
        assert_eq!(drawn.map(|c| surface.corners[c as usize].vertex), *welded);
        assert!(welded[0] != welded[1] && welded[1] != welded[2] && welded[2] != welded[0]);
    }
    let mut used = vec![false; surface.corners.len()];
    surface.triangles.iter().flatten().for_each(|&c| used[c as usize] = true);
    assert!(used.iter().all(|&used| used), "a corner that no triangle uses");
    let mut next = 0;
    for part in &surface.parts {
        assert_eq!(part.first_triangle, next);
        assert!((part.material as usize) < surface.materials.len());
        next += part.triangle_count;
    }
    assert_eq!(next as usize, surface.triangles.len());
    for image in surface.materials.iter().filter_map(|m| m.image) {
        assert!((image as usize) < surface.images.len());
    }
    assert!(capture.vertex_of_file_vertex.iter().all(|&v| (v as usize) < topology.vertex_count()));
    assert!(capture.poses.iter().flatten().all(|p| p.is_finite()));
    if let Some(textures) = &imported.frame_textures {
        assert_eq!(textures.len(), capture.poses.len());
    }
}

/// Builds a glTF file piece by piece.
pub struct Gltf {
    /// The JSON; lists may be extended freely.
    pub json: Value,
    /// The one buffer.
    pub bin: Vec<u8>,
}

impl Gltf {
    /// A file without anything.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [], "animations": []
        });
        Self { json, bin: Vec::new() }
    }

    /// Appends an object to a list; its index.
    pub fn push(&mut self, list: &str, object: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(object);
        list.len() - 1
    }

    /// Appends bytes as a buffer view; its index.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    /// Appends floats as an accessor of `kind` ("VEC3"); its index.
    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let count = values.len() / width;
        self.push("accessors", json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind}))
    }

    /// Appends a node to the scene; its index.
    pub fn scene_node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(index.into());
        index
    }

    /// Appends a clip of one channel.
    pub fn clip(&mut self, name: Option<&str>, node: usize, path: &str, mode: &str, times: &[f32], values: usize) {
        let input = self.floats("SCALAR", times);
        let mut animation = json!({
            "samplers": [{"input": input, "output": values, "interpolation": mode}],
            "channels": [{"sampler": 0, "target": {"node": node, "path": path}}]
        });
        if let Some(name) = name {
            animation["name"] = name.into();
        }
        self.push("animations", animation);
    }

    /// The file as GLB.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut bytes = b"glTF".to_vec();
        let total = 12 + 8 + text.len() + 8 + bin.len();
        for word in [2, total as u32, text.len() as u32] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((bin.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(bin);
        bytes
    }

    /// The file as JSON, with its buffer at `uri`.
    pub fn gltf(&self, uri: &str) -> String {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len(), "uri": uri}]);
        json.to_string()
    }
}
