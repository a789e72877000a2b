//! A file of the site, and how the site is built.

use std::path::PathBuf;

use crate::workspace::Workspace;

/// How the site is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Quickly, without optimisation.
    Dev,
    /// Optimised, as it is published.
    Release,
}

impl Profile {
    /// The name for cargo's `--profile`.
    pub fn cargo_name(self) -> &'static str {
        match self {
            Self::Dev => "dev",
            Self::Release => "release",
        }
    }

    /// Cargo's output directory of this profile.
    pub fn target_dir(self) -> &'static str {
        match self {
            Self::Dev => "debug",
            Self::Release => "release",
        }
    }

    pub fn site_dir(self, workspace: &Workspace) -> PathBuf {
        match self {
            Self::Dev => workspace.target().join("site-dev"),
            Self::Release => workspace.dist(),
        }
    }
}

/// A file of the site, its path relative to the site's top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SiteFile {
    /// Its path in the site.
    pub path: PathBuf,
    /// Its content.
    pub content: Vec<u8>,
}
