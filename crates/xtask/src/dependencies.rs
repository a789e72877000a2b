//! What cargo-deny checks.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::cargo;
use crate::content_hash::short_hash;
use crate::process;
use crate::tools;
use crate::workspace::Workspace;

/// The hash of all that decides about licences, sources and duplicates, as it was when they were checked last. While the
/// hash is the same, the result is the same. So a fresh machine need not build cargo-deny, which takes minutes.
const CHECKED: &str = "deny.checked";

/// Checks licences, sources and duplicates, unless nothing has changed since that was done last.
pub fn check(workspace: &Workspace) -> Result<()> {
    let hash = hash_of_all(workspace)?;
    let checked = workspace.root().join(CHECKED);
    if fs::read_to_string(&checked).is_ok_and(|text| text.trim_end() == hash) {
        println!("skipped: nothing has changed since the last check ({CHECKED})");
        return Ok(());
    }
    let all = ["--workspace"];
    cargo_deny(workspace, &all, &["licenses", "sources"])?;
    // First of the page, then of its workers.
    cargo_deny(workspace, &[], &["bans"])?;
    // The worker has fewer duplicates than are excepted for the page.
    let skips = ["--allow", "unmatched-skip", "--allow", "unnecessary-skip"];
    cargo_deny(
        workspace,
        &["--manifest-path", "crates/worker/Cargo.toml"],
        &[&skips[..], &["bans"]].concat(),
    )?;
    fs::write(&checked, hash + "\n").with_context(|| format!("writing {}", checked.display()))?;
    println!("{CHECKED} has a new hash: commit it");
    Ok(())
}

/// Checks for known vulnerabilities. Their database is on a host of its own.
pub fn check_advisories(workspace: &Workspace) -> Result<()> {
    cargo_deny(workspace, &["--workspace"], &["advisories"])
}

fn cargo_deny(workspace: &Workspace, of: &[&str], what: &[&str]) -> Result<()> {
    let mut command = Command::new(tools::ensure_cargo_deny()?);
    command
        .current_dir(workspace.root())
        .arg("--all-features")
        .args(of)
        .args(["check", "--hide-inclusion-graph", "--deny", "warnings"])
        .args(what);
    process::run(&mut command)
}

/// Of the rules, the locked versions, every manifest, the version of cargo-deny, and this file. Fails if a manifest asks
/// for what is not locked.
fn hash_of_all(workspace: &Workspace) -> Result<String> {
    let args = ["metadata", "--locked", "--format-version", "1"];
    let metadata = process::output(&mut cargo::command(workspace, &args))?;
    let root = workspace.root();
    let mut files = vec![root.join("deny.toml"), root.join("Cargo.lock")];
    files.extend(our_manifests(&metadata)?);
    let this = include_bytes!("dependencies.rs");
    let mut pieces = vec![tools::CARGO_DENY.1.as_bytes().to_vec(), this.to_vec()];
    for file in files {
        pieces.push(fs::read(&file).with_context(|| format!("reading {}", file.display()))?);
    }
    // Git may write other ends of lines on Windows.
    for piece in &mut pieces {
        piece.retain(|byte| *byte != b'\r');
    }
    Ok(short_hash(pieces.iter().map(Vec::as_slice)))
}

/// The manifests of the workspace, in the order of their paths.
fn our_manifests(metadata: &str) -> Result<Vec<PathBuf>> {
    let metadata: Value = serde_json::from_str(metadata).context("reading cargo metadata")?;
    let field = |of: &Value, name| of.get(name).and_then(Value::as_str).map(PathBuf::from);
    let packages = metadata.get("packages").and_then(Value::as_array);
    let ours = packages
        .into_iter()
        .flatten()
        .filter(|package| field(package, "source").is_none());
    let mut manifests: Vec<PathBuf> = ours
        .filter_map(|package| field(package, "manifest_path"))
        .collect();
    manifests.sort();
    Ok(manifests)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn our_manifests_are_those_from_no_registry() {
        let metadata = r#"{"packages": [{"source": null, "manifest_path": "/b/Cargo.toml"},
            {"source": "registry", "manifest_path": "/serde/Cargo.toml"},
            {"source": null, "manifest_path": "/a/Cargo.toml"}]}"#;
        let paths = ["/a/Cargo.toml", "/b/Cargo.toml"].map(PathBuf::from);
        assert_eq!(our_manifests(metadata).unwrap(), paths);
    }

    #[test]
    fn the_manifests_of_the_workspace_are_found() {
        let workspace = Workspace::find().unwrap();
        let args = ["metadata", "--no-deps", "--format-version", "1"];
        let metadata = process::output(&mut cargo::command(&workspace, &args)).unwrap();
        let manifests = our_manifests(&metadata).unwrap();
        for manifest in ["Cargo.toml", "crates/worker/Cargo.toml"] {
            assert!(manifests.contains(&workspace.root().join(manifest)));
        }
    }
}
