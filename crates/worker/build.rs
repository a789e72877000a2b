//! Makes the linker keep the relocations that `cargo xtask build` needs to split the program of the tasks beside the port.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var_os("CARGO_FEATURE_PARTS").is_some() {
        println!("cargo::rustc-link-arg-bin=tasks=--emit-relocs");
    }
}
