//! Which part of the workspace may use which. The tables here are the rule; ARCHITECTURE.md explains it.
//!
//! The page's folders and the crates are layers. An arrow may only point to a layer further down. No feature
//! of the page uses another, and no two files use each other.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use anyhow::{Context, Result, anyhow, bail};
use petgraph::{algo::tarjan_scc, graphmap::DiGraphMap};
use proc_macro2::{TokenStream, TokenTree};
use serde_json::Value;

use crate::bindgen::files_below;
use crate::cargo;
use crate::lines::{is_product, product};
use crate::process;
use crate::workspace::Workspace;

/// The folders of `src/`, from the top down.
const PAGE: [&str; 5] = ["app", "features", "model", "link", "ui"];

/// The crates, from the top down. Those of one row do not use each other.
const CRATES: [&[&str]; 12] = [
    &["motorlink-fuzz-checks", "end-to-end", "xtask"],
    &["motorlink"],
    &["motorlink-python"],
    &[
        "motorlink-worker",
        "motorlink-command",
        "motorlink-fault-simulation",
    ],
    &["motorlink-remote-server"],
    &["motorlink-driver"],
    &["motorlink-session", "motorlink-port"],
    &[
        "motorlink-recorder",
        "motorlink-runs",
        "motorlink-kept-runs",
        "motorlink-remote",
    ],
    &["motorlink-messages", "motorlink-diagnosis"],
    &[
        "motorlink-bus",
        "motorlink-experiments",
        "motorlink-simulator",
        "motorlink-i18n",
        "motorlink-controller-messages",
    ],
    &["motorlink-protocol"],
    // What needs nothing of ours.
    &["motorlink-markup", "motorlink-web-server", "udev-shim"],
];

/// The modules of a crate, and which of them each one uses.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// Fails on an arrow that points up, and on files that use each other.
pub fn check(workspace: &Workspace) -> Result<()> {
    let mut wrong = Vec::new();
    for source in sources(workspace)? {
        let uses = uses_in(&workspace.root().join(&source))?;
        for cycle in cycles(&uses) {
            wrong.push(format!(
                "{source}: files that use each other: {}",
                cycle.join(", ")
            ));
        }
        if source == "src" {
            wrong.extend(upward_in_page(&uses));
        }
    }
    wrong.extend(upward_in_crates(&dependencies(workspace)?));
    if wrong.is_empty() {
        return Ok(());
    }
    bail!("{}", wrong.join("\n"))
}

/// Every folder with the sources of a crate.
fn sources(workspace: &Workspace) -> Result<Vec<String>> {
    let mut sources = vec!["src".to_owned(), "tests/end-to-end/src".to_owned()];
    let crates = workspace.root().join("crates");
    for entry in fs::read_dir(&crates).context("cannot read crates/")? {
        let name = entry?.file_name();
        sources.push(format!("crates/{}/src", name.to_string_lossy()));
    }
    sources.sort();
    Ok(sources)
}

/// Reads every module in a folder, without its tests.
fn uses_in(source: &Path) -> Result<Uses> {
    let mut texts = BTreeMap::<String, String>::new();
    for (path, content) in files_below(source)? {
        if is_product(&path) {
            let path = path.with_extension("");
            let names = path.iter().map(|name| name.to_string_lossy());
            let names = names.filter(|name| !matches!(name.as_ref(), "mod" | "lib" | "main"));
            let module = names.collect::<Vec<_>>().join("::");
            let text = String::from_utf8_lossy(&content);
            let lines = product(&text).flat_map(|line| [line, "\n"]);
            texts.entry(module).or_default().extend(lines);
        }
    }
    let mut uses = Uses::new();
    for (module, text) in &texts {
        let tokens = text.parse::<TokenStream>();
        let tokens = tokens.map_err(|error| anyhow!("{module}: {error}"))?;
        let mut paths = Vec::new();
        paths_in(tokens, module, &mut paths);
        let others = paths.iter().filter_map(|path| module_of(path, &texts));
        let others = others.filter(|other| other != module).collect();
        uses.insert(module.clone(), others);
    }
    Ok(uses)
}

fn join(prefix: &str, name: &str) -> String {
    if prefix.is_empty() {
        name.to_owned()
    } else {
        format!("{prefix}::{name}")
    }
}

/// The module of a crate that this path leads into.
fn module_of(path: &str, texts: &BTreeMap<String, String>) -> Option<String> {
    if texts.contains_key(path) && !path.is_empty() {
        return Some(path.to_owned());
    }
    module_of(path.rsplit_once("::")?.0, texts)
}

/// Every path in these tokens that begins with `crate`, `super` or `self`, from the crate's root. Macros are
/// read as well.
fn paths_in(tokens: TokenStream, module: &str, paths: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        at += 1;
        if let TokenTree::Group(group) = token {
            paths_in(group.stream(), module, paths);
        }
        let base = match token.to_string().as_str() {
            "crate" => "",
            "super" => parent(module),
            "self" => module,
            _ => continue,
        };
        if is_colons(&tokens, at) {
            at = path_from(&tokens, at + 2, base, paths);
        }
    }
}

fn is_colons(tokens: &[TokenTree], at: usize) -> bool {
    let colon =
        |at: usize| matches!(tokens.get(at), Some(TokenTree::Punct(p)) if p.as_char() == ':');
    colon(at) && colon(at + 1)
}

/// Reads a path, or a tree of them, and notes each from the crate's root. Gives the place behind it.
fn path_from(tokens: &[TokenTree], at: usize, base: &str, paths: &mut Vec<String>) -> usize {
    match tokens.get(at) {
        Some(TokenTree::Ident(ident)) => {
            let name = ident.to_string();
            let path = match name.as_str() {
                "super" => parent(base).to_owned(),
                "self" => base.to_owned(),
                _ => join(base, &name),
            };
            if is_colons(tokens, at + 1) {
                return path_from(tokens, at + 3, &path, paths);
            }
            paths.push(path);
            at + 1
        }
        Some(TokenTree::Group(group)) => {
            let inner: Vec<TokenTree> = group.stream().into_iter().collect();
            let is_comma =
                |token: &TokenTree| matches!(token, TokenTree::Punct(p) if p.as_char() == ',');
            for one in inner.split(is_comma).filter(|one| !one.is_empty()) {
                path_from(one, 0, base, paths);
            }
            at + 1
        }
        _ => {
            paths.push(base.to_owned());
            at
        }
    }
}

fn parent(module: &str) -> &str {
    module.rsplit_once("::").map_or("", |(parent, _)| parent)
}

/// Modules that use each other, directly or by others, each group once.
fn cycles(uses: &Uses) -> Vec<Vec<&str>> {
    let arrows = uses
        .iter()
        .flat_map(|(module, used)| used.iter().map(|used| (module.as_str(), used.as_str())));
    let mut groups = tarjan_scc(&DiGraphMap::<&str, ()>::from_edges(arrows));
    groups.retain(|group| group.len() > 1);
    groups
}

/// Arrows of the page that point up, or from one feature to another.
fn upward_in_page(uses: &Uses) -> Vec<String> {
    let place = |module: &str| {
        let mut names = module.split("::");
        let folder = names.next().unwrap_or_default();
        let layer = PAGE.iter().position(|layer| *layer == folder)?;
        let feature = names.next().filter(|_| folder == "features");
        Some((layer, feature.map(ToOwned::to_owned)))
    };
    let mut wrong = Vec::new();
    for (module, used) in uses {
        for used in used {
            let (Some((from, feature)), Some((to, other))) = (place(module), place(used)) else {
                continue;
            };
            if to < from || to == from && feature != other {
                wrong.push(format!("src: {module} may not use {used}"));
            }
        }
    }
    wrong
}

/// Each crate of ours with the crates of ours that it needs to run.
fn dependencies(workspace: &Workspace) -> Result<Uses> {
    let args = [
        "metadata",
        "--format-version",
        "1",
        "--no-deps",
        "--offline",
    ];
    let metadata = process::output(&mut cargo::command(workspace, &args))?;
    let metadata: Value = serde_json::from_str(&metadata)?;
    let list = |value: &Value, key| {
        let list = value.get(key).and_then(Value::as_array);
        list.cloned().unwrap_or_default()
    };
    let name = |value: &Value| value["name"].as_str().unwrap_or_default().to_owned();
    let packages = list(&metadata, "packages");
    let ours: BTreeSet<String> = packages.iter().map(name).collect();
    let needed = |package: &Value| {
        let needs = list(package, "dependencies");
        let to_run = needs.iter().filter(|need| need["kind"].is_null());
        to_run
            .map(name)
            .filter(|need| ours.contains(need))
            .collect()
    };
    let with_needs = packages
        .iter()
        .map(|package| (name(package), needed(package)));
    Ok(with_needs.collect())
}

fn upward_in_crates(needs: &Uses) -> Vec<String> {
    let row = |name: &str| CRATES.iter().position(|row| row.contains(&name));
    let mut wrong = Vec::new();
    for (name, needed) in needs {
        let Some(from) = row(name) else {
            wrong.push(format!("{name} has no place among the layers"));
            continue;
        };
        for need in needed {
            if row(need).is_none_or(|to| to <= from) {
                wrong.push(format!("{name} may not use {need}"));
            }
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(arrows: &[(&str, &str)]) -> Uses {
        let mut uses = Uses::new();
        for (from, to) in arrows {
            uses.entry((*from).to_owned())
                .or_default()
                .insert((*to).to_owned());
            uses.entry((*to).to_owned()).or_default();
        }
        uses
    }

    fn paths(text: &str) -> Vec<String> {
        let mut paths = Vec::new();
        paths_in(text.parse().unwrap(), "a::b", &mut paths);
        paths
    }

    #[test]
    fn the_workspace_keeps_its_layers() {
        check(&Workspace::find().unwrap()).unwrap();
    }

    #[test]
    fn paths_are_found_in_trees_macros_and_code() {
        assert_eq!(paths("use crate::{x::{self, Y}, z};"), ["x", "x::Y", "z"]);
        assert_eq!(paths("use super::{c, super::d};"), ["a::c", "d"]);
        assert_eq!(
            paths("fn f() { view! { <p>{crate::x::y()}</p> } }"),
            ["x::y"]
        );
        assert_eq!(paths("use self::c::D;"), ["a::b::c::D"]);
    }

    #[test]
    fn an_arrow_up_and_one_between_features_are_found() {
        let good = uses(&[
            ("app::x", "features::a::x"),
            ("features::a::x", "model::m"),
            ("features::a::x", "features::a::y"),
        ]);
        assert!(upward_in_page(&good).is_empty());
        assert_eq!(
            upward_in_page(&uses(&[("model::m", "features::a::x")])).len(),
            1
        );
        assert_eq!(
            upward_in_page(&uses(&[("features::a::x", "features::b::y")])).len(),
            1
        );
    }

    #[test]
    fn files_that_use_each_other_are_found_once() {
        let found = uses(&[("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")]);
        let mut group = cycles(&found).concat();
        group.sort_unstable();
        assert_eq!(group, ["a", "b", "c"]);
        assert!(cycles(&uses(&[("a", "b"), ("a", "c"), ("b", "c")])).is_empty());
    }

    #[test]
    fn a_crate_may_not_use_one_above_it_or_beside_it() {
        assert!(upward_in_crates(&uses(&[("motorlink-bus", "motorlink-protocol")])).is_empty());
        assert_eq!(
            upward_in_crates(&uses(&[("motorlink-bus", "motorlink-simulator")])).len(),
            1
        );
        assert_eq!(
            upward_in_crates(&uses(&[("motorlink-protocol", "motorlink-bus")])).len(),
            1
        );
    }
}
