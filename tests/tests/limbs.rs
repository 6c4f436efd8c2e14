//! Bodies of files have as many limbs as they have.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use fixtures::data;
use parts::Parts;

#[test]
#[ignore = "reads ../shared/data"]
fn animals_and_others_have_as_many_as_they_have() {
    for (file, limbs) in [("fox/Fox.glb", 5), ("cesium-man/CesiumMan.glb", 4)] {
        let path = data().join("gltf").join(file).to_string_lossy().into_owned();
        let imported = capture_io::import::import(&[path], &Default::default(), &job::Job::silent()).unwrap();
        let capture = imported.capture;
        let parts = Parts::find(&capture.topology, &capture.poses);
        println!("{file}: {:?}", parts.limbs.iter().map(|l| (l.tip, l.hinge, l.is_disc)).collect::<Vec<_>>());
        assert_eq!(parts.limbs.len(), limbs, "{file}");
    }
}
