//! Builds what a browser loads: cargo builds the wasm files, wasm-bindgen generates the modules and their
//! JavaScript glue.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::cargo;
use crate::parts;
use crate::process;
use crate::short_names;
use crate::site_file::Profile;
use crate::tools::{self, WASM_TARGET};
use crate::workspace::Workspace;

/// The program of the page, which is split into parts, as the site names it.
pub const PAGE: &str = "motorlink";
/// The same, as cargo names it.
const PAGE_OF_CARGO: &str = "page";

/// The program of the tasks beside the port, which is split too.
pub const TASKS: &str = "tasks";

/// The programs that a browser loads, by the stem of their files: what a person sees, the worker that owns the port, the
/// tasks beside it, and the worker that connects the page to a server.
pub const PROGRAMS: [&str; 4] = [PAGE, "worker", TASKS, "remote"];

/// The modules of the programs, by their names.
pub type Programs = BTreeMap<&'static str, Module>;

/// The output of wasm-bindgen.
#[derive(Debug, Clone, Default)]
pub struct Module {
    /// The JavaScript between the wasm file and the browser.
    pub glue: String,
    /// The wasm file.
    pub wasm: Vec<u8>,
    /// The parts that are fetched later: the name in the glue, and the wasm file.
    pub parts: Vec<(String, Vec<u8>)>,
    /// Scripts of libraries that the glue imports from `./snippets/`: path below it and text.
    pub snippets: Vec<(PathBuf, Vec<u8>)>,
}

/// Builds the programs.
pub fn build(workspace: &Workspace, profile: Profile) -> Result<Programs> {
    let tools = tools::ensure_wasm_bindgen(workspace)?;
    let mut cargo = cargo::wasm(workspace, "build", &["--bins"])?;
    if profile == Profile::Release {
        // In parts, and with one language: the others are files of their own.
        cargo.args([
            "--no-default-features",
            "--features",
            "motorlink/parts,motorlink-worker/parts",
        ]);
        // A panic names its file. Without the folder of the registry it takes less, and is the same on every machine.
        for sources in registry_sources()? {
            let short = format!("--remap-path-prefix={}/=", sources.display());
            let flags = format!("target.{WASM_TARGET}.rustflags=[{short:?}]");
            cargo.args(["--config", &flags]);
        }
    }
    process::run(cargo.args(["--profile", profile.cargo_name()]))?;
    PROGRAMS
        .into_iter()
        .map(|name| Ok((name, bind(workspace, profile, name, &tools.bindgen)?)))
        .collect()
}

/// The folders in which cargo keeps the sources of dependencies.
fn registry_sources() -> Result<Vec<PathBuf>> {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(dirs::home_dir()?.join(".cargo")));
    let folder = home.map(|home| home.join("registry/src"));
    let Some(folder) = folder.filter(|folder| folder.is_dir()) else {
        return Ok(Vec::new());
    };
    let entries = fs::read_dir(folder)?;
    entries.map(|entry| Ok(entry?.path())).collect()
}

fn bind(workspace: &Workspace, profile: Profile, name: &str, bindgen: &Path) -> Result<Module> {
    let built = workspace
        .target()
        .join(WASM_TARGET)
        .join(profile.target_dir())
        .join(if name == PAGE { PAGE_OF_CARGO } else { name })
        .with_extension("wasm");
    let out = workspace
        .target()
        .join("bindgen")
        .join(profile.target_dir())
        .join(name);
    // Otherwise snippets of an earlier build would be included.
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("emptying {}", out.display()))?;
    }

    let in_parts = matches!(name, PAGE | TASKS) && profile == Profile::Release;
    let split = in_parts
        .then(|| parts::split(name, &built, &out.join("split")))
        .transpose()?;
    let built = split.as_ref().map_or(built, |split| split.main.clone());

    let mut command = Command::new(bindgen);
    if in_parts {
        // The parts use what the main file exports.
        command.arg("--keep-lld-exports");
    }
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
    command.args(["--out-name", name, "--out-dir"]);
    process::run(command.arg(&out).arg(&built))?;

    let file = |name: String| {
        let path = out.join(name);
        fs::read(&path).with_context(|| format!("reading {}", path.display()))
    };
    let glue = file(format!("{name}.js"))?;
    let mut glue = String::from_utf8(glue).context("the glue is not text")?;
    let mut wasm = file(format!("{name}_bg.wasm"))?;
    let mut later = Vec::new();
    if let Some(split) = split {
        glue = split.join(&glue)?;
        later = split.parts;
    }
    if matches!(profile, Profile::Release) {
        (wasm, glue) = short_names::shorten(&parts::without_names(&wasm)?, &glue)?;
        wasm = short_names::without_commit(wasm);
        for (_, part) in &mut later {
            *part = short_names::without_commit(std::mem::take(part));
        }
    }
    Ok(Module {
        glue,
        wasm,
        parts: later,
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
