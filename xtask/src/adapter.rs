//! A graphics adapter for the tests that run the player's passes outside of a browser.

use std::path::Path;

use crate::command::install_debian;

/// Vulkan's loader, and Mesa's drivers: lavapipe, which plays the GPU on the processor, is one of them.
const PACKAGES: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];

/// Where Vulkan's loader looks for drivers.
const DRIVERS: [&str; 3] = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// Installs a software adapter where a Debian has no driver at all. Where that cannot be done, nothing fails: the tests that
/// need an adapter say so and are ignored.
pub fn install() {
    if !cfg!(target_os = "linux") || has_driver() {
        return;
    }
    if let Err(error) = install_debian("a software graphics adapter", &PACKAGES) {
        println!("== {error:#}; tests that need a graphics adapter will be ignored");
    }
}

fn has_driver() -> bool {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some());
    named || DRIVERS.iter().any(|folder| Path::new(folder).read_dir().is_ok_and(|mut entries| entries.next().is_some()))
}
