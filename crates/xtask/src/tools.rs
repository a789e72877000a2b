//! The tools of a build, installed if they are missing: the wasm target, wasm-bindgen and others.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::process;
use crate::workspace::Workspace;

/// The target of the page and the worker.
pub const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// The two programs of wasm-bindgen, in the version that the workspace links.
#[derive(Debug)]
pub struct WasmBindgen {
    /// Turns a wasm file into a module for the browser.
    pub bindgen: PathBuf,
    /// Runs a wasm test program in a browser.
    pub test_runner: PathBuf,
}

/// Adds the wasm target to the toolchain in use if it is missing.
pub fn ensure_wasm_target() -> Result<()> {
    let args = ["--print", "target-libdir", "--target", WASM_TARGET];
    let installed =
        process::output_of("rustc", &args).is_some_and(|dir| Path::new(dir.trim()).is_dir());
    if installed {
        return Ok(());
    }
    println!("adding the target {WASM_TARGET}");
    process::run(Command::new("rustup").args(["target", "add", WASM_TARGET])).with_context(|| {
        format!("install the target {WASM_TARGET} (with rustup: rustup target add {WASM_TARGET})")
    })
}

/// Finds wasm-bindgen in the cache or on the PATH, or builds it once.
pub fn ensure_wasm_bindgen(workspace: &Workspace) -> Result<WasmBindgen> {
    let lock = workspace.root().join("Cargo.lock");
    let lock = fs::read_to_string(&lock).with_context(|| format!("reading {}", lock.display()))?;
    let version = locked_version(&lock, "wasm-bindgen")
        .context("Cargo.lock names no version of wasm-bindgen")?;

    let cache = cache_dir()?;
    let root = cache.join("tools").join(format!("wasm-bindgen-{version}"));
    let cached = programs_in(&root.join("bin"));
    if has_version(&cached, version) {
        return Ok(cached);
    }
    let on_path = programs_in(Path::new(""));
    if has_version(&on_path, version) {
        return Ok(on_path);
    }

    // Not with its lock file, which names a crate that may be missing. Without TLS: the test runner
    // talks to programs on this machine.
    let flags = ["--no-default-features", "--bin", "wasm-bindgen"];
    let flags = [&flags[..], &["--bin", "wasm-bindgen-test-runner"]].concat();
    install(
        "wasm-bindgen-cli",
        version,
        &root,
        OptLevel::None,
        &WASM_BINDGEN_WORKS,
        &flags,
    )?;
    Ok(cached)
}

/// The crates in which wasm-bindgen spends its time.
const WASM_BINDGEN_WORKS: [&str; 7] = [
    "gimli",
    "id-arena",
    "walrus",
    "wasm-bindgen-cli",
    "wasm-bindgen-cli-support",
    "wasm-encoder",
    "wasmparser",
];

/// A program for one command, built once into the cache: its package and the version.
pub struct Pinned(&'static str, pub &'static str);

/// For fuzzing: see `reliability`.
const CARGO_FUZZ: Pinned = Pinned("cargo-fuzz", "0.13.1");

/// Checks licences, sources and duplicates of the dependencies.
pub const CARGO_DENY: Pinned = Pinned("cargo-deny", "0.18.9");

/// For mutation testing: see `mutants`.
const CARGO_MUTANTS: Pinned = Pinned("cargo-mutants", "27.1.0");

/// The router of Zenoh, in the version that `crates/ros` links: see `bench fleet`.
const ZENOHD: Pinned = Pinned("zenohd", "1.10.2");

impl Pinned {
    /// The directory of the program; builds it if it is missing.
    fn ensure(&self) -> Result<PathBuf> {
        self.ensure_with(OptLevel::None)
    }

    fn ensure_with(&self, level: OptLevel) -> Result<PathBuf> {
        let Self(package, version) = self;
        let cache = cache_dir()?;
        let root = cache.join("tools").join(format!("{package}-{version}"));
        let dir = root.join("bin");
        let program = dir.join(format!("{package}{}", env::consts::EXE_SUFFIX));
        if program.is_file() {
            return Ok(dir);
        }
        install(package, version, &root, level, &[], &["--locked"])?;
        Ok(dir)
    }
}

/// How a program is optimised.
#[derive(Clone, Copy, Debug)]
enum OptLevel {
    /// The build is much faster.
    None,
    /// For a program that is measured.
    Full,
}

/// Builds a program into a directory of its own. Without optimisation the build is much faster, so that
/// only these crates are `optimised`, and only a little.
fn install(
    package: &str,
    version: &str,
    root: &Path,
    level: OptLevel,
    optimised: &[&str],
    flags: &[&str],
) -> Result<()> {
    println!(
        "building {package} {version} into {} (once)",
        root.display()
    );
    // One for each program: a check and a test may build at the same time.
    let build = cache_dir()?.join(format!("build-{package}"));
    let level = match level {
        OptLevel::None => "0",
        OptLevel::Full => "3",
    };
    let mut install = process::cargo();
    install
        .args(["install", package, "--version", version])
        .args(flags)
        .args(optimised.iter().flat_map(|name| {
            let setting = format!("profile.release.package.{name}.opt-level=1");
            ["--config".to_owned(), setting]
        }))
        .arg("--root")
        .arg(root)
        // In the workspace's directory both would rebuild common dependencies each time.
        .env("CARGO_TARGET_DIR", &build)
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", level)
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
    process::run(&mut install)?;
    // Some 300 MB that are not needed again.
    let _ = fs::remove_dir_all(build);
    Ok(())
}

/// A PATH on which cargo finds cargo-fuzz.
pub fn path_with_cargo_fuzz() -> Result<OsString> {
    path_with(&CARGO_FUZZ)
}

/// A PATH on which cargo finds cargo-mutants.
pub fn path_with_cargo_mutants() -> Result<OsString> {
    path_with(&CARGO_MUTANTS)
}

fn path_with(program: &Pinned) -> Result<OsString> {
    let dir = program.ensure()?;
    let path = env::var_os("PATH").unwrap_or_default();
    let dirs = std::iter::once(dir).chain(env::split_paths(&path));
    Ok(env::join_paths(dirs)?)
}

/// cargo-deny itself.
pub fn ensure_cargo_deny() -> Result<PathBuf> {
    let program = format!("cargo-deny{}", env::consts::EXE_SUFFIX);
    Ok(CARGO_DENY.ensure()?.join(program))
}

/// zenohd itself, optimised.
pub fn ensure_zenohd() -> Result<PathBuf> {
    let program = format!("zenohd{}", env::consts::EXE_SUFFIX);
    Ok(ZENOHD.ensure_with(OptLevel::Full)?.join(program))
}

/// Where tools outlive `cargo clean` and are shared by all checkouts.
pub fn cache_dir() -> Result<PathBuf> {
    if let Some(dir) = env::var_os("MOTORLINK_TOOLS") {
        return Ok(PathBuf::from(dir));
    }
    let cache = dirs::cache_dir().context("no cache directory: name one in MOTORLINK_TOOLS")?;
    Ok(cache.join("motorlink"))
}

fn programs_in(dir: &Path) -> WasmBindgen {
    let program = |name: &str| dir.join(format!("{name}{}", env::consts::EXE_SUFFIX));
    WasmBindgen {
        bindgen: program("wasm-bindgen"),
        test_runner: program("wasm-bindgen-test-runner"),
    }
}

/// The programs must have exactly the linked version.
fn has_version(programs: &WasmBindgen, version: &str) -> bool {
    [&programs.bindgen, &programs.test_runner]
        .into_iter()
        .all(|program| {
            let printed = process::output_of(&program.to_string_lossy(), &["--version"]);
            printed.as_deref().and_then(printed_version) == Some(version)
        })
}

/// The version in `wasm-bindgen 0.2.130`, or in `wasm-bindgen 0.2.130 (1a2b3c4)`.
fn printed_version(text: &str) -> Option<&str> {
    text.split_whitespace().nth(1)
}

/// The version of a package in a Cargo.lock.
fn locked_version<'a>(lock: &'a str, package: &str) -> Option<&'a str> {
    let name = format!("name = \"{package}\"");
    let mut lines = lock.lines().skip_while(|line| *line != name);
    let version = lines.nth(1)?;
    version.strip_prefix("version = \"")?.strip_suffix('"')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_comes_from_the_lock_file() {
        let lock = "\
[[package]]
name = \"wasm-bindgen-futures\"
version = \"0.4.80\"

[[package]]
name = \"wasm-bindgen\"
version = \"0.2.130\"
source = \"registry\"
";
        assert_eq!(locked_version(lock, "wasm-bindgen"), Some("0.2.130"));
        assert_eq!(locked_version(lock, "bindgen"), None);
        assert_eq!(locked_version("name = \"a\"", "a"), None);
    }

    #[test]
    fn printed_versions_may_carry_a_commit() {
        assert_eq!(printed_version("wasm-bindgen 0.2.130\n"), Some("0.2.130"));
        assert_eq!(
            printed_version("wasm-bindgen-test-runner 0.2.130 (1a2b3c4)"),
            Some("0.2.130")
        );
        assert_eq!(printed_version("wasm-bindgen"), None);
    }

    #[test]
    fn a_missing_program_has_no_version() {
        assert!(!has_version(&programs_in(Path::new("/nowhere")), "0.2.130"));
    }
}
