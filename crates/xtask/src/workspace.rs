//! Directories of the workspace.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::process;

/// The top directory and cargo's output directory.
#[derive(Debug)]
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
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
        })
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
}
