//! Gives a bundle made-up appearance, for the browser tests, and writes what some of its textures should be.
//!
//! `dress BUNDLE FOLDER SIZE`: writes `dressed.reprise`, and the texture of its frame 25 as RGBA, made natively in the ways
//! `half`, `direct`, `poisson` and `exact` (Poisson reconstruction until nothing changes); alpha is 0 where nothing is active.
//! `scanned.reprise` has made-up scanned frames instead.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use bundle::BundleReader;
use tests::dressed::{dress, texture, with_scans};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [bundle, folder, size] = arguments.as_slice() else { bail!("usage: dress BUNDLE FOLDER SIZE") };
    let bytes = fs::read(bundle).with_context(|| format!("cannot read {bundle}"))?;
    let (dressed, _) = dress(&bytes, size.parse()?)?;
    let folder = Path::new(folder);
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let reader = BundleReader::from_bytes(&dressed)?;
    for (name, half, cycles) in [("half", true, 0), ("direct", false, 0), ("poisson", false, 1), ("exact", false, 12)] {
        fs::write(folder.join(format!("{name}.rgba")), texture(&reader, 25, half, cycles)?)?;
    }
    fs::write(folder.join("dressed.reprise"), dressed)?;
    fs::write(folder.join("scanned.reprise"), with_scans(&bytes)?)?;
    Ok(())
}
