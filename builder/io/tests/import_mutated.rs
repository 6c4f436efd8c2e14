//! Files with random changes: nothing panics, and no file makes the reader hold much more memory than it is long.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use job::Job;
use std::path::Path;

use capture_io::import::{ImportOptions, import};
use import_support::{png, write, write_bytes};
use peak_alloc::PeakAlloc;
use proptest::prelude::*;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What may be held for each byte of a file: positions of 24 bytes for the 6 of `v 0 0 0`, more than once.
const BYTES_PER_BYTE: usize = 200;
/// What may be held whatever the file: threads, folders, the smallest tables.
const BYTES_ANYWAY: usize = 4 << 20;

/// A change of a file.
#[derive(Clone, Debug)]
enum Change {
    /// A byte becomes another.
    Replace(usize, u8),
    /// A stretch is left out.
    Cut(usize, usize),
    /// A stretch is there twice.
    Double(usize, usize),
    /// Text that means something is put in.
    Insert(usize, &'static str),
}

/// Text that readers know, and numbers at the limits of theirs.
const WORDS: [&str; 38] = [
    "\n",
    "\r",
    " ",
    "#",
    "\\",
    "\\\n",
    "/",
    "-",
    "0",
    "-1",
    "1e39",
    "nan",
    "inf",
    "4294967296",
    "99999999999999999999",
    "v 0 0 0",
    "f 1 2 3",
    "f -1 -2 -3",
    "vt 0 0",
    "usemtl x\n",
    "mtllib m.mtl\n",
    "\u{feff}",
    "\n\n\n",
    "element vertex 4000000000\n",
    "element face 4000000000\n",
    "property list int int vertex_indices\n",
    "property list double float z\n",
    "property float x\n",
    "end_header\n",
    "comment TextureFile t.png\n",
    "format binary_big_endian 1.0\n",
    "[[sequence]]\n",
    "input = \"f_%d.obj:0:9999999\"\n",
    "input = \"**/*\"\n",
    "unit = 1e-30\n",
    "texture = \"[\"\n",
    "cyclic = true\n",
    "\"",
];

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let at = 0_usize..1 << 16;
    let change = prop_oneof![
        (at.clone(), any::<u8>()).prop_map(|(at, byte)| Change::Replace(at, byte)),
        (at.clone(), 1_usize..40).prop_map(|(at, length)| Change::Cut(at, length)),
        (at.clone(), 1_usize..200).prop_map(|(at, length)| Change::Double(at, length)),
        (at, 0..WORDS.len()).prop_map(|(at, word)| Change::Insert(at, WORDS[word])),
    ];
    prop::collection::vec(change, 1..6)
}

fn changed(bytes: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for change in changes {
        let end = bytes.len();
        let place = |at: usize, length: usize| (at % (end + 1))..(at % (end + 1) + length).min(end);
        match *change {
            Change::Replace(at, byte) => {
                if let Some(slot) = bytes.get_mut(place(at, 1)).and_then(<[u8]>::first_mut) {
                    *slot = byte;
                }
            }
            Change::Cut(at, length) => drop(bytes.drain(place(at, length))),
            Change::Double(at, length) => {
                let range = place(at, length);
                let twice = bytes[range.clone()].to_vec();
                bytes.splice(range.start..range.start, twice);
            }
            Change::Insert(at, word) => {
                let start = place(at, 0).start;
                bytes.splice(start..start, word.bytes());
            }
        }
    }
    bytes
}

/// Reads `name` with these bytes; what it held at most must be in proportion.
fn attempt(folder: &Path, name: &str, bytes: &[u8]) {
    write_bytes(folder, name, bytes);
    let input = vec![folder.join(name).to_str().unwrap().to_owned()];
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let outcome = import(&input, &ImportOptions::default(), &Job::silent());
    let held = MEMORY.peak_usage().saturating_sub(before);
    let bound = BYTES_ANYWAY + BYTES_PER_BYTE * bytes.len();
    assert!(held <= bound, "{name}: {held} bytes held for a file of {}", bytes.len());
    if let Err(error) = outcome {
        assert!(error.code().starts_with("E_") && !error.to_string().is_empty());
    }
}

const OBJ: &str = "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.5\nusemtl a\n\
                   f 1/1 2/2 3/1\nf -4 -2 -1\nf 1 2 3 4 # four\n";
const MTL: &str = "newmtl a\nKd 1 0.5 0\nd 0.5\nmap_Kd -s 1 1 t.png\nnewmtl b\nKe 1 1 1\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile t.png\nelement vertex 4\nproperty float x\nproperty double y\n\
                   property float z\nproperty ushort red\nproperty float s\nproperty float t\nelement face 2\n\
                   property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n\
                   end_header\n0 0 0 9 0 0\n1 0 0 9 1 0\n1 1 0 9 1 1\n0 1 0 9 0 1\n3 0 1 2 0 0\n\
                   4 3 2 1 0 8 0 0 1 0 1 1 0 1 0\n";
const MANIFEST: &str = "name = \"a\"\nfps = 25\nup = \"z\"\nunit = 0.01\nweights = \"w.txt\"\ntexture = \"t.png\"\n\
                        [[sequence]]\nname = \"b\"\ninput = \"f_%d.obj:1:2:1\"\nlabels = [\"c\"]\ncyclic = true\n\
                        [[sequence]]\ninput = \"f_*.obj\"\nmask = \"t*.png\"\n";

fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty list uchar int extra\nelement face 1\nproperty list uint uint vertex_indices\nend_header\n"
        .to_vec();
    for c in [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        bytes.extend(c.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([1, 7, 0, 0, 0]);
    }
    [3_u32, 0, 1, 2].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes
}

// One test, for what is held is counted over the whole process.
#[test]
fn changed_files_are_read_or_refused_in_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let f = folder.path();
    write(f, &[("f_1.obj", OBJ), ("f_2.obj", OBJ), ("m.mtl", MTL), ("w.txt", "1 1 1 1")]);
    write_bytes(f, "t.png", &png(1, [1, 2, 3]));
    let binary = binary_ply();
    let whole: [(&str, &[u8]); 5] = [
        ("a.obj", OBJ.as_bytes()),
        ("a.ply", PLY.as_bytes()),
        ("b.ply", &binary),
        ("capture.toml", MANIFEST.as_bytes()),
        ("w.txt", b"1 1 1 1"),
    ];
    for (name, bytes) in whole {
        let name = if name == "w.txt" { "capture.toml" } else { name };
        let bytes = if name == "capture.toml" { MANIFEST.as_bytes() } else { bytes };
        write_bytes(f, name, bytes);
        let input = vec![f.join(name).to_str().unwrap().to_owned()];
        if let Err(error) = import(&input, &ImportOptions::default(), &Job::silent()) {
            panic!("{name} must be sound at first: {error}");
        }
    }
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(3000));
    let strategy = (0..whole.len() + 1, changes());
    runner
        .run(&strategy, |(which, changes)| {
            match whole.get(which) {
                // Weights and the library are read for files that name them.
                Some(("w.txt", bytes)) => {
                    write_bytes(f, "w.txt", &changed(bytes, &changes));
                    attempt(f, "capture.toml", MANIFEST.as_bytes());
                    write(f, &[("w.txt", "1 1 1 1")]);
                }
                Some((name, bytes)) => attempt(f, name, &changed(bytes, &changes)),
                None => {
                    write_bytes(f, "m.mtl", &changed(MTL.as_bytes(), &changes));
                    attempt(f, "f_1.obj", OBJ.as_bytes());
                    write(f, &[("m.mtl", MTL)]);
                }
            }
            Ok(())
        })
        .unwrap();
    // Long files of what is costly.
    for line in
        ["v 0 0 0\n", "f 1 2 3\n", "f 1 \\\n", "usemtl \\\n", "vt 0\n", "\r", "# \\\n", "v 1 \\", "usemtl a#b#c#d\n"]
    {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", line.repeat(200_000 / line.len()));
        attempt(f, "long.obj", text.as_bytes());
    }
    let long = format!("mtllib {}\n{OBJ}", "a#b ".repeat(50_000));
    attempt(f, "long.obj", long.as_bytes());
    attempt(f, "long.obj", format!("mtllib {}\n{OBJ}", "m.mtl ".repeat(10_000)).as_bytes());
}
