//! npm packages of fixed versions, each fetched once.

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
    /// Packages that are installed beside it, with their versions.
    with: &'static [&'static str],
    /// The file in it that is used.
    file: &'static str,
}

/// Checks the accessibility of a page, as a script in the page.
pub const AXE: Package = Package {
    name: "axe-core",
    version: "4.14.1",
    with: &[],
    file: "axe.min.js",
};

/// Reads MCAP files for Foxglove, with its decompression, and a validator of JSON schemas.
pub const MCAP_OF_FOXGLOVE: Package = Package {
    name: "@mcap/core",
    version: "2.2.2",
    with: &["@mcap/support@1.1.0", "ajv@8.20.0"],
    file: "package.json",
};

/// Watches a server as Foxglove and Lichtblick do, with a WebSocket for Node.js, a validator of JSON schemas, and Foxglove's
/// reader of ROS 2 messages.
pub const FOXGLOVE_CLIENT: Package = Package {
    name: "@foxglove/ws-protocol",
    version: "0.8.0",
    with: &[
        "ws@8.18.3",
        "ajv@8.20.0",
        "@foxglove/rosmsg@5.0.5",
        "@foxglove/rosmsg2-serialization@3.1.0",
    ],
    file: "package.json",
};

impl Package {
    /// The folder in which the package and those beside it are found; fetches them if they are missing.
    pub fn folder(&self) -> Result<PathBuf> {
        self.ensure()?;
        self.dir()
    }

    fn dir(&self) -> Result<PathBuf> {
        // A scope would be a folder of its own.
        let name = self.name.replace('/', "-");
        let version = self.version;
        Ok(cache_dir()?.join("tools").join(format!("{name}-{version}")))
    }

    /// The path of the file; fetches the package if it is missing.
    pub fn ensure(&self) -> Result<PathBuf> {
        let Self {
            name,
            version,
            with,
            file,
        } = self;
        let dir = self.dir()?;
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
        let half = dir.with_extension("part");
        let _ = fs::remove_dir_all(&half);
        fs::create_dir_all(&half).with_context(|| format!("making {}", half.display()))?;
        let mut npm = Command::new("npm");
        npm.args(["install", "--no-audit", "--no-fund", "--no-save"])
            // No package needs its install scripts.
            .args(["--ignore-scripts", "--loglevel", "error", "--prefix"])
            .arg(&half)
            .arg(format!("{name}@{version}"))
            .args(*with);
        process::run(&mut npm)?;
        fs::rename(&half, &dir).with_context(|| format!("making {}", dir.display()))?;
        if !found.is_file() {
            bail!("{name} {version} has no {file}");
        }
        Ok(found)
    }
}
