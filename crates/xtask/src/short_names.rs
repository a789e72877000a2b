//! Shorter names between the wasm file and its glue.
//!
//! wasm-bindgen ends the name of each import with a hash of 16 digits. Nothing compresses them, and each stands
//! in both files: 8 KB of a first visit. Here a number takes their place.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use wasm_encoder::{
    ImportSection, Module, RawSection,
    reencode::{Reencode, RoundtripReencoder},
};
use wasmparser::{Parser, Payload};

/// Digits of a hash.
const HASH_LEN: usize = 16;

/// Gives both files with short names.
pub fn shorten(wasm: &[u8], glue: &str) -> Result<(Vec<u8>, String)> {
    let mut short = BTreeMap::new();
    let mut module = Module::new();
    for payload in Parser::new(0).parse_all(wasm) {
        let payload = payload.context("the wasm file cannot be read")?;
        if let Payload::ImportSection(imports) = payload {
            let mut section = ImportSection::new();
            for import in imports.into_imports() {
                let import = import.context("an import cannot be read")?;
                let name = short_name(import.name, &mut short);
                let kind = RoundtripReencoder.entity_type(import.ty)?;
                section.import(import.module, &name, kind);
            }
            module.section(&section);
        } else if let Some((id, range)) = payload.as_section() {
            let range = usize::try_from(range.start)?..usize::try_from(range.end)?;
            let data = wasm.get(range).context("a section ends behind the file")?;
            module.section(&RawSection { id, data });
        }
    }
    let mut glue = glue.to_owned();
    for (long, name) in &short {
        glue = glue.replace(long.as_str(), name);
    }
    Ok((module.finish(), glue))
}

/// The name without its hash, with a number that no other import has.
fn short_name(name: &str, short: &mut BTreeMap<String, String>) -> String {
    let is_hash = |end: &str| end.len() == HASH_LEN && end.bytes().all(|b| b.is_ascii_hexdigit());
    let Some((stem, _)) = name.rsplit_once('_').filter(|(_, end)| is_hash(end)) else {
        return name.to_owned();
    };
    let number = short.len();
    short
        .entry(name.to_owned())
        .or_insert_with(|| format!("{stem}_{number:x}"))
        .clone()
}

/// Before the commit of the compiler in the name of a file of its library, which a panic names.
const OF_COMPILER: &[u8] = b"/rustc/";
/// Digits of that commit.
const COMMIT_LEN: usize = 40;

/// Puts zeros in the place of the commit of the compiler: nothing compresses it, and each file has it.
pub fn without_commit(mut wasm: Vec<u8>) -> Vec<u8> {
    let mut at = 0;
    while let Some(found) = wasm.get(at..).and_then(|rest| {
        rest.windows(OF_COMPILER.len())
            .position(|it| it == OF_COMPILER)
    }) {
        at += found + OF_COMPILER.len();
        if let Some(commit) = wasm.get_mut(at..at + COMMIT_LEN)
            && commit.iter().all(u8::is_ascii_hexdigit)
        {
            commit.fill(b'0');
        }
    }
    wasm
}

#[cfg(test)]
mod tests {
    use wasm_encoder::{EntityType, TypeSection};

    use super::*;

    fn module(names: &[&str]) -> Vec<u8> {
        let mut types = TypeSection::new();
        types.ty().function([], []);
        let mut imports = ImportSection::new();
        for name in names {
            imports.import("./glue.js", name, EntityType::Function(0));
        }
        let mut module = Module::new();
        module.section(&types);
        module.section(&imports);
        module.finish()
    }

    #[test]
    fn a_hash_becomes_a_number_in_both_files() {
        let names = [
            "__wbg_focus_0123456789abcdef",
            "__wbg_focus_fedcba9876543210",
            "__wbindgen_throw",
        ];
        let glue = names.map(|name| format!("{name}: f,\n")).concat();
        let (wasm, glue) = shorten(&module(&names), &glue).unwrap();
        let short = ["__wbg_focus_0", "__wbg_focus_1", "__wbindgen_throw"];
        assert_eq!(wasm, module(&short));
        assert_eq!(glue, short.map(|name| format!("{name}: f,\n")).concat());
    }

    #[test]
    fn the_commit_of_the_compiler_becomes_zeros_of_the_same_length() {
        let commit = "59807616e1fa2540724bfbac14d7976d7e4a3860";
        let text = format!("a/rustc/{commit}/library/b/rustc/c");
        let expected = format!("a/rustc/{}/library/b/rustc/c", "0".repeat(COMMIT_LEN));
        assert_eq!(without_commit(text.into_bytes()), expected.into_bytes());
    }

    #[test]
    fn a_file_that_is_no_wasm_is_an_error() {
        assert!(shorten(b"no wasm", "").is_err());
    }
}
