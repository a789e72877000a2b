//! Directories of the workspace.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::process;

/// The top directory, cargo's output directory, and the programs of tests.
#[derive(Debug)]
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
    test_programs: Vec<String>,
    tested_programs: Vec<String>,
}

impl Workspace {
    /// Asks cargo, which reads `CARGO_TARGET_DIR` and its configuration files.
    pub fn find() -> Result<Self> {
        let mut metadata = process::cargo();
        metadata.args(["metadata", "--no-deps", "--format-version", "1"]);
        Self::from_metadata(&process::output(&mut metadata)?)
    }

    fn from_metadata(json: &str) -> Result<Self> {
        let metadata: Value = serde_json::from_str(json).context("reading cargo metadata")?;
        let directory = |key: &str| -> Result<PathBuf> {
            let text = metadata.get(key).and_then(Value::as_str);
            Ok(PathBuf::from(text.with_context(|| {
                format!("cargo metadata does not name its {key}")
            })?))
        };
        Ok(Self {
            root: directory("workspace_root")?,
            target: directory("target_directory")?,
            test_programs: names_of_targets(&metadata, is_native_test),
            tested_programs: names_of_targets(&metadata, is_tested_program),
        })
    }

    /// The native programs of tests, in the folders `tests` of the packages.
    pub fn test_programs(&self) -> &[String] {
        &self.test_programs
    }

    /// The programs with tests in their own files.
    pub fn tested_programs(&self) -> &[String] {
        &self.tested_programs
    }

    /// The top of the repository.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Cargo's output directory.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// The released site.
    pub fn dist(&self) -> PathBuf {
        self.root.join("dist")
    }
}

fn names_of_targets(metadata: &Value, is_meant: fn(&Value) -> bool) -> Vec<String> {
    let packages = list(metadata, "packages");
    let targets = packages
        .iter()
        // It is for the browser only.
        .filter(|package| {
            package
                .get("name")
                .is_none_or(|name| name != "motorlink-worker")
        })
        .flat_map(|package| list(package, "targets"));
    let names = targets
        .filter(is_meant)
        .filter_map(|target| Some(target.get("name")?.as_str()?.to_owned()));
    names.collect()
}

fn list(of: &Value, key: &str) -> Vec<Value> {
    let list = of.get(key).and_then(Value::as_array);
    list.cloned().unwrap_or_default()
}

fn is_native_test(target: &Value) -> bool {
    // The tests of the page in a browser need a feature.
    is(target, "test") && target.get("required-features").is_none()
}

fn is_tested_program(target: &Value) -> bool {
    is(target, "bin") && target.get("test") == Some(&Value::Bool(true))
}

fn is(target: &Value, kind: &str) -> bool {
    list(target, "kind").iter().any(|it| it == kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directories_come_from_cargo_metadata() {
        let json = r#"{"packages": [], "workspace_root": "/a", "target_directory": "/b"}"#;
        let workspace = Workspace::from_metadata(json).unwrap();
        assert_eq!(workspace.root(), Path::new("/a"));
        assert_eq!(workspace.target(), Path::new("/b"));
        assert_eq!(workspace.dist(), Path::new("/a/dist"));
        assert!(Workspace::from_metadata("{}").is_err());
    }

    #[test]
    fn programs_of_tests_are_those_that_need_no_browser() {
        let json = r#"{"workspace_root": "/a", "target_directory": "/b", "packages": [{"targets": [
            {"name": "lib", "kind": ["lib"]}, {"name": "bus", "kind": ["test"]},
            {"name": "page", "kind": ["test"], "required-features": ["page-tests"]},
            {"name": "page", "kind": ["bin"], "test": false},
            {"name": "wire", "kind": ["bin"], "test": true}]}]}"#;
        let workspace = Workspace::from_metadata(json).unwrap();
        assert_eq!(workspace.test_programs(), ["bus"]);
        assert_eq!(workspace.tested_programs(), ["wire"]);
    }
}
