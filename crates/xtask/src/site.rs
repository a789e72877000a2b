//! The site: every file it consists of, and its directory.
//!
//! A file is generated before the files that load it, because they contain its name, and the name contains
//! a hash of its content: wasm and glue, then the boot script, then `index.html`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use motorlink_i18n::Language;
use motorlink_web_server::compression;

use crate::bindgen::{self, PAGE, Programs, TASKS, files_below};
use crate::content_hash::{hashed_name, short_hash};
use crate::minify;
use crate::service_worker::{self, is_for_installing};
use crate::site_file::{Profile, SiteFile};
use crate::size::{self, Weight};
use crate::style::style;
use crate::template::fill;
use crate::workspace::Workspace;

/// The input of the site.
#[derive(Debug, Clone, Default)]
struct Parts {
    programs: Programs,
    page_boot: String,
    worker_boot: String,
    adapters: String,
    runs_loader: String,
    installed: String,
    style: String,
    later_style: String,
    index: String,
    public: Vec<(PathBuf, Vec<u8>)>,
}

/// Builds the site, prints its size, and returns its directory.
pub fn build(workspace: &Workspace, profile: Profile) -> Result<PathBuf> {
    let programs = bindgen::build(workspace, profile)?;
    let boot = workspace.root().join("boot");
    let parts = Parts {
        programs,
        page_boot: read(&boot.join("page.js"))?,
        worker_boot: read(&boot.join("worker.js"))?,
        adapters: read(&boot.join("adapters.js"))?,
        runs_loader: read(&boot.join("runs.js"))?,
        installed: service_worker::page_part(profile)?,
        style: style(&workspace.root().join("style"))?,
        later_style: style(&workspace.root().join("style/later"))?,
        index: read(&workspace.root().join("index.html"))?,
        public: files_below(&workspace.root().join("public"))?,
    };
    let mut files = assemble(&parts)?;
    // Last: it lists all others.
    files.push(service_worker::of(&files, profile)?);
    let dir = profile.site_dir(workspace);
    write(&dir, &files)?;
    if profile == Profile::Release {
        write_compressed(&dir, &files)?;
        print!("{}", size_report(&dir)?);
    }
    Ok(dir)
}

/// The files of a site built before.
pub fn files_of(dir: &Path) -> Result<Vec<SiteFile>> {
    let files = files_below(dir)?;
    Ok(files
        .into_iter()
        .filter(|(path, _)| {
            let ending = path.extension().unwrap_or_default();
            ending != GZIP && ending != BROTLI
        })
        .map(|(path, content)| SiteFile { path, content })
        .collect())
}

/// The size of a site built before.
pub fn size_report(dir: &Path) -> Result<size::Report> {
    let files = files_of(dir)?.into_iter();
    let weights: Result<Vec<Weight>> = files
        .filter(|file| !is_for_installing(&file.path))
        .map(|file| {
            let bytes_as = |ending: &str| -> Result<usize> {
                let path = compressed_path(dir, &file.path, ending);
                let found = fs::metadata(&path);
                let found = found.with_context(|| format!("no {}", path.display()))?;
                Ok(usize::try_from(found.len())?)
            };
            let bytes = [file.content.len(), bytes_as(GZIP)?, bytes_as(BROTLI)?];
            let path = file.path;
            Ok(Weight { path, bytes })
        })
        .collect();
    size::Report::new(&weights?)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))
}

fn assemble(parts: &Parts) -> Result<Vec<SiteFile>> {
    let mut files = Files::default();
    let later_style = minify::css(&parts.later_style);
    let later_style = files.add_hashed("later-style", "css", later_style.as_bytes());
    let page = files.add_program(&parts.programs, PAGE)?;
    let later_style = [("later_style", later_style.as_str())];
    let page_boot = files.add_boot("page", &parts.page_boot, &page, &later_style)?;
    let tasks = files.add_program(&parts.programs, TASKS)?;
    let tasks_boot = files.add_boot(TASKS, &parts.worker_boot, &tasks, &[])?;
    let worker = files.add_program(&parts.programs, "worker")?;
    let worker_boot = files.add_boot(
        "worker",
        &[
            parts.adapters.as_str(),
            &parts.runs_loader,
            &parts.worker_boot,
        ]
        .concat(),
        &worker,
        &[("tasks_wasm", &tasks.wasm), ("tasks_glue", &tasks.glue)],
    )?;
    let remote = files.add_program(&parts.programs, "remote")?;
    let remote_boot = files.add_boot("remote", &parts.worker_boot, &remote, &[])?;
    let [german, chinese] = [Language::German, Language::Chinese].map(|language| {
        let stem = format!("texts-{}", language.key());
        files.add_hashed(&stem, "txt", motorlink_i18n::file(language).as_bytes())
    });
    let style = files.add_hashed("style", "css", minify::css(&parts.style).as_bytes());
    let installed = files.add_hashed("installed", "js", parts.installed.as_bytes());
    let index = fill(
        &minify::html(&parts.index),
        &[
            ("worker", &worker_boot),
            ("tasks", &tasks_boot),
            ("remote", &remote_boot),
            ("german", &german),
            ("chinese", &chinese),
            ("style", &style),
            ("boot", &page_boot),
            ("installed", &installed),
        ],
    )?;
    files.add(PathBuf::from("index.html"), index.as_bytes());
    for (path, content) in &parts.public {
        files.add(path.clone(), content);
    }
    Ok(files.0)
}

/// The names of the program's files, which other files contain.
struct Names {
    wasm: String,
    glue: String,
}

#[derive(Default)]
struct Files(Vec<SiteFile>);

impl Files {
    fn add(&mut self, path: PathBuf, content: &[u8]) {
        let content = content.to_vec();
        self.0.push(SiteFile { path, content });
    }

    fn add_hashed(&mut self, stem: &str, extension: &str, content: &[u8]) -> String {
        let name = hashed_name(stem, extension, content);
        self.add(PathBuf::from(&name), content);
        name
    }

    fn add_program(&mut self, programs: &Programs, name: &str) -> Result<Names> {
        let module = programs
            .get(name)
            .with_context(|| format!("{name} is not built"))?;
        let mut glue = module.glue.clone();
        if !module.snippets.is_empty() {
            let texts = module.snippets.iter().map(|(_, text)| text.as_slice());
            let dir = format!("{name}-snippets-{}", short_hash(texts));
            glue = glue.replace("./snippets/", &format!("./{dir}/"));
            for (path, text) in &module.snippets {
                self.add(Path::new(&dir).join(path), text);
            }
        }
        for (part, wasm) in &module.parts {
            let stem = part.trim_end_matches(".wasm").trim_start_matches("split_");
            let stem = match name {
                PAGE => stem.to_owned(),
                _ => format!("{name}_{stem}"),
            };
            let hashed = self.add_hashed(&stem, "wasm", wasm);
            glue = glue.replace(&format!("\"./{part}\""), &format!("\"./{hashed}\""));
        }
        let glue = minify::glue(&glue);
        Ok(Names {
            wasm: self.add_hashed(name, "wasm", &module.wasm),
            glue: self.add_hashed(&format!("{name}-glue"), "js", glue.as_bytes()),
        })
    }

    /// Adds the script that starts a program, which contains these other names too.
    fn add_boot(
        &mut self,
        stem: &str,
        boot: &str,
        program: &Names,
        others: &[(&str, &str)],
    ) -> Result<String> {
        let own = [("wasm", program.wasm.as_str()), ("glue", &program.glue)];
        let boot = fill(boot, &[&own, others].concat())?;
        let boot = minify::script(&boot);
        Ok(self.add_hashed(&format!("{stem}-boot"), "js", boot.as_bytes()))
    }
}

/// Endings of the compressed files.
const GZIP: &str = "gz";
const BROTLI: &str = "br";

/// Where a file lies once more, compressed.
fn compressed_path(dir: &Path, path: &Path, ending: &str) -> PathBuf {
    dir.join(format!("{}.{ending}", path.display()))
}

/// Writes each file once more, compressed, for hosts that serve such files. A browser fetches pictures for its
/// installation dialog only, so they stay as they are.
fn write_compressed(dir: &Path, files: &[SiteFile]) -> Result<()> {
    for file in files.iter().filter(|file| !is_for_installing(&file.path)) {
        let compressed = [
            (GZIP, compression::gzip(&file.content)?),
            (BROTLI, compression::brotli(&file.content)?),
        ];
        for (ending, content) in compressed {
            let path = compressed_path(dir, &file.path, ending);
            fs::write(&path, content).with_context(|| format!("writing {}", path.display()))?;
        }
    }
    Ok(())
}

/// Writes the files where those of an earlier build were.
fn write(dir: &Path, files: &[SiteFile]) -> Result<()> {
    if dir.exists() {
        fs::remove_dir_all(dir).with_context(|| format!("emptying {}", dir.display()))?;
    }
    for file in files {
        let path = dir.join(&file.path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(&path, &file.content).with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bindgen::{Module, PROGRAMS};

    fn parts() -> Parts {
        let page = Module {
            glue: "import './snippets/lib-1/inline0.js'; fetch(\"./split_graph.wasm\");".to_owned(),
            wasm: b"page".to_vec(),
            parts: vec![("split_graph.wasm".to_owned(), b"graph".to_vec())],
            snippets: vec![(PathBuf::from("lib-1/inline0.js"), b"export {}".to_vec())],
        };
        // Both programs have a part of this name.
        let tasks = Module {
            glue: "fetch(\"./split_graph.wasm\");".to_owned(),
            parts: vec![("split_graph.wasm".to_owned(), b"of tasks".to_vec())],
            ..Module::default()
        };
        let mut programs: Programs = PROGRAMS.map(|name| (name, Module::default())).into();
        programs.insert(PAGE, page);
        programs.insert(TASKS, tasks);
        Parts {
            programs,
            page_boot: "{{wasm}} {{glue}} {{later_style}}".to_owned(),
            worker_boot: "{{wasm}} {{glue}}".to_owned(),
            adapters: "adapters".to_owned(),
            runs_loader: "{{tasks_wasm}} {{tasks_glue}}".to_owned(),
            installed: "installed".to_owned(),
            style: "p {}".to_owned(),
            later_style: "q {}".to_owned(),
            index: include_str!("../../../index.html").to_owned(),
            public: vec![(PathBuf::from("icon.svg"), b"<svg/>".to_vec())],
        }
    }

    /// The file whose name starts with a stem and goes on with a hash.
    fn starting<'a>(files: &'a [SiteFile], stem: &str) -> (String, &'a str) {
        let file = files
            .iter()
            .find(|file| file.path.to_string_lossy().starts_with(stem))
            .unwrap();
        let text = std::str::from_utf8(&file.content).unwrap();
        (file.path.to_string_lossy().into_owned(), text)
    }

    #[test]
    fn each_file_names_those_it_loads() {
        let files = assemble(&parts()).unwrap();
        let (_, index) = starting(&files, "index.html");
        for stem in [
            "page-boot-",
            "worker-boot-",
            "tasks-boot-",
            "installed-",
            "style-",
        ] {
            let (name, _) = starting(&files, stem);
            assert!(
                index.contains(&format!("\"./{name}\"")),
                "{stem} in {index}"
            );
        }
        let (glue, glue_text) = starting(&files, "motorlink-glue-");
        let (later_style, _) = starting(&files, "later-style-");
        for name in [glue, later_style] {
            assert!(starting(&files, "page-boot-").1.contains(&name), "{name}");
        }
        for (boot, stem) in [
            ("page-boot-", "motorlink-"),
            ("worker-boot-", "worker-"),
            ("tasks-boot-", "tasks-"),
        ] {
            let text = starting(&files, boot).1;
            assert!(text.contains(".wasm") && text.contains(&format!("{stem}glue-")));
        }
        let (tasks, _) = starting(&files, "tasks-glue-");
        assert!(
            starting(&files, "worker-boot-").1.contains(&tasks),
            "{tasks}"
        );
        let tasks_glue = starting(&files, "tasks-glue-").1;
        for (glue, part) in [(glue_text, "graph-"), (tasks_glue, "tasks_graph-")] {
            let (part, _) = starting(&files, part);
            assert!(glue.contains(&format!("\"./{part}\"")), "{glue}");
        }
        let (snippet, _) = starting(&files, "motorlink-snippets-");
        assert!(glue_text.contains(&format!("'./{snippet}'")), "{glue_text}");
        starting(&files, "icon.svg");
    }

    #[test]
    fn a_changed_file_changes_every_name_on_the_way_to_it() {
        let before = assemble(&parts()).unwrap();
        let mut changed = parts();
        changed.worker_boot.push('!');
        let after = assemble(&changed).unwrap();
        assert_ne!(
            starting(&before, "worker-boot-"),
            starting(&after, "worker-boot-")
        );
        assert_ne!(
            starting(&before, "index.html"),
            starting(&after, "index.html")
        );
        assert_eq!(
            starting(&before, "page-boot-"),
            starting(&after, "page-boot-")
        );
        assert_eq!(
            starting(&before, "motorlink-glue-"),
            starting(&after, "motorlink-glue-")
        );
    }

    #[test]
    fn the_page_allows_no_inline_script_and_no_other_host() {
        let index = parts().index;
        assert!(index.contains("default-src 'self'; script-src 'self' 'wasm-unsafe-eval'"));
        assert!(!index.contains("unsafe-inline") && !index.contains("<style"));
        assert!(crate::other_hosts::named_in(&assemble(&parts()).unwrap()).is_empty());
    }

    #[test]
    fn the_boot_scripts_have_a_place_for_each_name() {
        let mut real = parts();
        real.page_boot = include_str!("../../../boot/page.js").to_owned();
        real.runs_loader = include_str!("../../../boot/runs.js").to_owned();
        real.worker_boot = include_str!("../../../boot/worker.js").to_owned();
        assemble(&real).unwrap();
    }
}
