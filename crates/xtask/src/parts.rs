//! Splits the wasm file of a program into the main file and the parts that are fetched later.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use wasm_encoder::{Module, RawSection};
use wasm_split_cli_support::{Options, transform};
use wasmparser::{Parser, Payload};

use crate::used_types;

/// How the main wasm file names the splitter's script.
const LOADERS: &str = "./loaders.js";

/// Instantiates a part, on any server.
const INSTANTIATE: &str = include_str!("../../../boot/parts.js");

/// The files of a split program.
pub struct Split {
    /// The main file, for wasm-bindgen.
    pub main: PathBuf,
    /// Each part: its file as the loaders name it, and its wasm.
    pub parts: Vec<(String, Vec<u8>)>,
    /// The script that loads the parts.
    loaders: String,
}

/// Splits the wasm file of this program, which was linked with relocations.
pub fn split(program: &str, built: &Path, out: &Path) -> Result<Split> {
    fs::create_dir_all(out).with_context(|| format!("making {}", out.display()))?;
    let input = fs::read(built).with_context(|| format!("reading {}", built.display()))?;
    let main = out.join("main.wasm");
    let mut options = Options::new(&input);
    options.output_dir = out;
    options.main_out_path = &main;
    options.link_name = LOADERS;
    // The splitter's script imports it. `join` drops the import, because the script becomes a part of the glue.
    let glue = format!("./{program}.js");
    options.main_module = &glue;
    let split = transform(options).map_err(|error| anyhow!("splitting {program}: {error:#}"))?;
    let mut parts = Vec::new();
    for path in split.split_modules {
        let name = path.file_name().context("a part without a name")?;
        let wasm = fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
        let wasm = used_types::keep(&without_names(&wasm)?)?;
        parts.push((name.to_string_lossy().into_owned(), wasm));
    }
    let loaders = out.join(LOADERS);
    let loaders =
        fs::read_to_string(&loaders).with_context(|| format!("reading {}", loaders.display()))?;
    Ok(Split {
        main,
        parts,
        loaders,
    })
}

/// The file without its custom sections: names of functions, and what the linker left for the splitter.
pub fn without_names(wasm: &[u8]) -> Result<Vec<u8>> {
    let mut module = Module::new();
    for payload in Parser::new(0).parse_all(wasm) {
        let payload = payload.context("the wasm file cannot be read")?;
        if matches!(payload, Payload::CustomSection(_)) {
            continue;
        }
        if let Some((id, range)) = payload.as_section() {
            let range = usize::try_from(range.start)?..usize::try_from(range.end)?;
            let data = wasm.get(range).context("a section ends behind the file")?;
            module.section(&RawSection { id, data });
        }
    }
    Ok(module.finish())
}

impl Split {
    /// The glue with the loaders in it: two scripts that import each other cannot have hashes in their names.
    pub fn join(&self, glue: &str) -> Result<String> {
        join(glue, &self.loaders)
    }
}

fn join(glue: &str, loaders: &str) -> Result<String> {
    let mut joined = String::new();
    let mut imports = Vec::new();
    for line in glue.lines() {
        if line.starts_with("import * as ") && line.contains(LOADERS) {
            imports.extend(line.split(' ').nth(3));
        } else {
            joined += line;
            joined.push('\n');
        }
    }
    if imports.is_empty() {
        bail!("the glue does not import the loaders of the parts");
    }
    let mut names = Vec::new();
    for line in loaders.lines() {
        // It is in the same script.
        if line.starts_with("import ") {
            continue;
        }
        let line = match line.strip_prefix("export const ") {
            Some(rest) => {
                names.extend(rest.split(' ').next());
                format!("const {rest}")
            }
            None => line.to_owned(),
        };
        joined += &line.replace(
            "WebAssembly.instantiateStreaming(src, imports)",
            "instantiatePart(src, imports)",
        );
        joined.push('\n');
    }
    if names.is_empty() || !joined.contains("instantiatePart") {
        bail!("the splitter writes its loaders in another form");
    }
    joined += INSTANTIATE;
    for import in imports {
        joined += &["const ", import, " = { ", &names.join(", "), " };\n"].concat();
    }
    Ok(joined)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loaders_become_a_part_of_the_glue() {
        let glue =
            "import * as import1 from \"./loaders.js\"\nfunction init() { return import1; }\n";
        let loaders = "import { initSync } from \"./motorlink.js\";\n\
            export const load_graph = make(() => WebAssembly.instantiateStreaming(src, imports));\n";
        let joined = join(glue, loaders).unwrap();
        assert!(!joined.contains("import *") && !joined.contains("import {"));
        assert!(joined.contains("const load_graph = make(() => instantiatePart(src, imports));"));
        assert!(
            joined.ends_with("const import1 = { load_graph };\n"),
            "{joined}"
        );
    }

    #[test]
    fn another_form_is_an_error() {
        assert!(join("no import", "").is_err());
        assert!(join("import * as import1 from \"./loaders.js\"", "nothing").is_err());
    }
}
