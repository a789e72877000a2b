//! Two npm packages of fixed versions, each fetched once.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::process;
use crate::tools::cache_dir;

/// A package of npm.
#[derive(Debug)]
pub struct Package {
    name: &'static str,
    version: &'static str,
    /// The file in it that is used.
    file: &'static str,
}

/// Checks the accessibility of a page, as a script in the page.
pub const AXE: Package = Package {
    name: "axe-core",
    version: "4.14.1",
    file: "axe.min.js",
};

/// Checks the loading of a page and its best practices. The last version that runs on Node 20.
pub const LIGHTHOUSE: Package = Package {
    name: "lighthouse",
    version: "12.8.2",
    file: "cli/index.js",
};

impl Package {
    /// The path of the file; fetches the package if it is missing.
    pub fn ensure(&self) -> Result<PathBuf> {
        let Self {
            name,
            version,
            file,
        } = self;
        let tools = cache_dir()?.join("tools");
        let dir = tools.join(format!("{name}-{version}"));
        let found = dir.join("node_modules").join(name).join(file);
        if found.is_file() {
            return Ok(found);
        }
        if process::output_of("npm", &["--version"]).is_none() {
            bail!(
                "npm is missing: install Node.js 20 or newer (Debian: apt-get install nodejs npm)"
            );
        }
        println!("fetching {name} {version} into {} (once)", dir.display());
        // Installed elsewhere and then moved: an incomplete package is never used.
        let half = tools.join(format!("{name}-{version}.part"));
        let _ = fs::remove_dir_all(&half);
        fs::create_dir_all(&half).with_context(|| format!("making {}", half.display()))?;
        let mut npm = Command::new("npm");
        npm.args(["install", "--no-audit", "--no-fund", "--no-save"])
            // Neither package needs its install scripts.
            .args(["--ignore-scripts", "--loglevel", "error", "--prefix"])
            .arg(&half)
            .arg(format!("{name}@{version}"));
        process::run(&mut npm)?;
        fs::rename(&half, &dir).with_context(|| format!("making {}", dir.display()))?;
        if !found.is_file() {
            bail!("{name} {version} has no {file}");
        }
        Ok(found)
    }
}
