//! Makes one table of the translations: every message gets a number, and each language a text in which
//! the messages stand in the order of their numbers.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Between context and message, as gettext has it in its own files.
const CONTEXT_END: char = '\u{4}';

/// Between two messages; no message holds it.
const MESSAGE_END: &str = "\0";

/// The folders and files whose texts load with their part: behind the first paint, or when it is asked for. A text that
/// other files have too is not among them.
const LATER: [&str; 29] = [
    "crates/diagnosis/",
    "src/app/questions.rs",
    "src/features/drive/current.rs",
    "src/features/drive/open_loop.rs",
    "src/features/drive/position.rs",
    "src/features/experiments/",
    "src/features/graph/",
    "src/features/groups/pad_view.rs",
    "src/features/groups/panel.rs",
    "src/features/help/tour_texts.rs",
    "src/features/ids/state.rs",
    "src/features/ids/view.rs",
    "src/features/install/texts.rs",
    "src/features/link_doctor/figures.rs",
    "src/features/link_doctor/markup.rs",
    "src/features/link_doctor/texts.rs",
    // The log says the words of quality.rs, and its worker translates them.
    "src/features/notices/mod.rs",
    "src/features/packet_log/",
    "src/features/raw/texts.rs",
    "src/features/raw/view.rs",
    "src/features/recording/",
    "src/features/rover/",
    "src/features/saved_session/view.rs",
    "src/features/session_file/",
    "src/features/settings/panel.rs",
    "src/features/setup_link/",
    "src/features/wheel_setup/",
    "src/model/setup/",
    "src/model/setup_texts.rs",
];

/// Every message with its translation, sorted by message.
type Messages = BTreeMap<String, Message>;

struct Message {
    text: String,
    /// Whether it loads later: see [`LATER`].
    is_later: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let top = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../../locales");
    println!("cargo::rerun-if-changed={}", top.display());
    let is_released = env::var("PROFILE")? == "release";

    let chinese = read(&top.join("zh.po"), is_released)?;
    let german = read(&top.join("de.po"), is_released)?;
    if !chinese.keys().eq(german.keys()) {
        return Err("zh.po and de.po hold other messages: run `cargo xtask translations`".into());
    }

    // The messages of the first program, then those of parts that load when they are asked for.
    let keys = || {
        let of = |later| {
            chinese
                .iter()
                .filter(move |(_, message)| message.is_later == later)
        };
        of(false).chain(of(true)).map(|(key, _)| key.as_str())
    };
    let first = chinese.values().filter(|message| !message.is_later).count();
    let mut table = String::new();
    writeln!(table, "/// Number of the messages in the first program.")?;
    writeln!(table, "const FIRST: usize = {first};")?;
    writeln!(table, "static KEYS: [&str; {}] = [", chinese.len())?;
    for key in keys() {
        writeln!(table, "    {key:?},")?;
    }
    writeln!(table, "];")?;
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("keys.rs"), table)?;
    let translated = |messages: &Messages| -> Vec<String> {
        let texts = keys().filter_map(|key| messages.get(key));
        texts.map(|message| message.text.clone()).collect()
    };
    let all: Vec<String> = keys().map(|key| english(key).to_owned()).collect();
    let (now, later) = all.split_at(first);
    let texts: [(&str, &[String]); 5] = [
        ("en", &all),
        ("en-first", now),
        ("en-later", later),
        ("zh", &translated(&chinese)),
        ("de", &translated(&german)),
    ];
    for (name, texts) in texts {
        let file = out.join(format!("{name}.txt"));
        fs::write(file, texts.join(MESSAGE_END))?;
    }
    Ok(())
}

/// The messages of a file. Where one is not translated yet, the English stands for it, but not in what
/// is released.
fn read(path: &Path, is_released: bool) -> Result<Messages, Box<dyn Error>> {
    let catalogue =
        polib::po_file::parse(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut messages = Messages::new();
    for message in catalogue.messages() {
        let (msgid, translated) = (message.msgid(), message.msgstr()?);
        let text = if translated.is_empty() {
            let lacks = format!("{} lacks a translation of {msgid:?}", path.display());
            if is_released {
                return Err(lacks.into());
            }
            println!("cargo::warning={lacks}");
            msgid
        } else {
            translated
        };
        if placeholders(text) != placeholders(msgid) {
            let words = format!(
                "{}: the translation of {msgid:?} has other places to fill",
                path.display()
            );
            return Err(words.into());
        }
        // Some messages become a part of markup.
        let is_markup = |text: &str| text.contains(['<', '>', '&', '"']);
        if is_markup(text) && !is_markup(msgid) {
            let words = format!("{}: markup in the translation of {msgid:?}", path.display());
            return Err(words.into());
        }
        let key = message.msgctxt().map_or_else(
            || msgid.to_owned(),
            |context| format!("{context}{CONTEXT_END}{msgid}"),
        );
        let mut sources = message.source().split_whitespace();
        let is_later = sources.all(|source| LATER.iter().any(|folder| source.starts_with(folder)));
        let text = text.to_owned();
        messages.insert(key, Message { text, is_later });
    }
    Ok(messages)
}

/// The names in braces, sorted: languages differ in their order.
fn placeholders(text: &str) -> Vec<&str> {
    let opened = text.split('{').skip(1);
    let mut names: Vec<&str> = opened
        .filter_map(|rest| Some(rest.split_once('}')?.0))
        .collect();
    names.sort_unstable();
    names
}

fn english(key: &str) -> &str {
    key.split_once(CONTEXT_END).map_or(key, |(_, msgid)| msgid)
}
