//! Builds, serves and checks Reprise: `cargo xtask demo`, `cargo xtask test`.

fn main() {}
