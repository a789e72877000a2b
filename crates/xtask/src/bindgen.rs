//! Builds what a browser loads: cargo builds the wasm file, wasm-bindgen generates the module and its
//! JavaScript glue.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::process;
use crate::short_names;
use crate::site_file::Profile;
use crate::tools::{self, WASM_TARGET};
use crate::workspace::Workspace;

/// The package, the binary and the stem of its files: the page and its workers are one program.
pub const PROGRAM: &str = "motorlink";

/// The output of wasm-bindgen.
#[derive(Debug, Clone, Default)]
pub struct Module {
    /// The JavaScript between the wasm file and the browser.
    pub glue: String,
    /// The wasm file.
    pub wasm: Vec<u8>,
    /// Scripts of libraries that the glue imports from `./snippets/`: path below it and text.
    pub snippets: Vec<(PathBuf, Vec<u8>)>,
}

/// Builds the module.
pub fn build(workspace: &Workspace, profile: Profile) -> Result<Module> {
    tools::ensure_wasm_target()?;
    let programs = tools::ensure_wasm_bindgen(workspace)?;

    let mut cargo = process::cargo();
    cargo.current_dir(workspace.root());
    cargo.args([
        "build",
        "--target",
        WASM_TARGET,
        "--profile",
        profile.cargo_name(),
    ]);
    process::run(cargo.args(["--package", PROGRAM, "--bin", PROGRAM]))?;
    bind(workspace, profile, &programs.bindgen)
}

fn bind(workspace: &Workspace, profile: Profile, bindgen: &Path) -> Result<Module> {
    let built = workspace
        .target()
        .join(WASM_TARGET)
        .join(profile.target_dir())
        .join(format!("{PROGRAM}.wasm"));
    let out = workspace
        .target()
        .join("bindgen")
        .join(profile.target_dir());
    // Otherwise snippets of an earlier build would be included.
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("emptying {}", out.display()))?;
    }

    let mut command = Command::new(bindgen);
    command.args([
        "--target",
        "web",
        "--no-typescript",
        "--omit-default-module-path",
    ]);
    if matches!(profile, Profile::Release) {
        // The names of functions are a third of the file, and say nothing without the source.
        command.args(["--remove-name-section", "--remove-producers-section"]);
    }
    command.args(["--out-name", PROGRAM, "--out-dir"]);
    process::run(command.arg(&out).arg(&built))?;

    let file = |name: String| {
        let path = out.join(name);
        fs::read(&path).with_context(|| format!("reading {}", path.display()))
    };
    let glue = file(format!("{PROGRAM}.js"))?;
    let mut glue = String::from_utf8(glue).context("the glue is not text")?;
    let mut wasm = file(format!("{PROGRAM}_bg.wasm"))?;
    if matches!(profile, Profile::Release) {
        (wasm, glue) = short_names::shorten(&wasm, &glue)?;
    }
    Ok(Module {
        glue,
        wasm,
        snippets: files_below(&out.join("snippets"))?,
    })
}

/// Every file below a directory with its path from there, sorted; none where it does not exist.
pub fn files_below(dir: &Path) -> Result<Vec<(PathBuf, Vec<u8>)>> {
    let mut files = Vec::new();
    let mut open = vec![dir.to_path_buf()];
    while let Some(current) = open.pop() {
        if !current.is_dir() {
            continue;
        }
        let entries =
            fs::read_dir(&current).with_context(|| format!("reading {}", current.display()))?;
        for entry in entries {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
            } else {
                let content =
                    fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
                files.push((path.strip_prefix(dir)?.to_path_buf(), content));
            }
        }
    }
    files.sort();
    Ok(files)
}
