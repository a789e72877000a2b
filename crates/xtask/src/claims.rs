//! Checks that no text says that a wheel coasts because frames cease.
//!
//! Many of these motors keep their last command for ever when frames cease (`docs/decisions/`). A sentence fails if it
//! has a word for coasting, a word for the end of the frames or for what ends them, and none that takes it back.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};

use crate::{bindgen::files_below, workspace::Workspace};

/// The folders that people read. The virtual motors are not among them: theirs coast where they are told to.
const FOLDERS: [&str; 6] = ["boot", "crates", "docs", "locales", "public", "src"];

/// The files that people read.
const FILES: [&str; 4] = [
    "README.md",
    "SECURITY.md",
    "CONTRIBUTING.md",
    "ARCHITECTURE.md",
];

/// Virtual motors, and this file.
const EXCEPT: [&str; 5] = [
    "crates/fault-simulation/",
    "crates/simulator/",
    "crates/command/src/virtual_motors/",
    "crates/bus/tests/",
    "crates/xtask/src/claims.rs",
];

const TEXTS: [&str; 9] = ["rs", "md", "html", "po", "js", "py", "ino", "txt", "json"];

/// Words for coasting in the languages of the page.
const COASTS: &str = "coast|only while it is repeated|gilt nur, solange|重复才有效|ausroll|auslauf|laufen die räder|\
    läuft das rad|läuft dann aus|滑行";

/// The end of the frames, and what ends them.
const CEASES: &str = "frame|latch|repeat|cable|unplug|pulled out|adapter|discard|crash|worker|fails|failed|aborted|\
    ends early|kabel|abgezogen|verw|wiederholt|帧|拔|适配器|丢弃|重复|standstill|stillstand|刹停|closed| port";

/// Words that take it back, and words that contain one for coasting but mean an experiment.
const NO_CLAIM: &str = "keep|not |never|no text|no_text|whether|behält|weiter|nicht |保持|继续|coast-down|coast_down|\
    coastdown|coast down|滑行试验|current loop|0 a|stromregelung|电流环|滑行减速";

/// Fails on a text that says that a wheel coasts because frames cease.
pub fn check(workspace: &Workspace) -> Result<()> {
    let root = workspace.root();
    let mut texts: Vec<PathBuf> = FILES.map(PathBuf::from).into();
    for folder in FOLDERS {
        let files = files_below(&root.join(folder))?.into_iter();
        texts.extend(files.map(|(path, _)| Path::new(folder).join(path)));
    }
    let mut wrong = Vec::new();
    for path in texts {
        let is_text = |end: &OsStr| TEXTS.iter().any(|text| end == *text);
        let is_except = EXCEPT.iter().any(|except| path.starts_with(except));
        if !is_except && path.extension().is_some_and(is_text) {
            let name = path.display();
            let text = fs::read_to_string(root.join(&path));
            let text = text.with_context(|| format!("cannot read {name}"))?;
            wrong.extend(claims(&text).map(|(line, claim)| format!("{name}:{line}: {claim}")));
        }
    }
    if wrong.is_empty() {
        return Ok(());
    }
    bail!(
        "a motor may keep its last command when frames cease, but these say that its wheel coasts:\n{}",
        wrong.join("\n")
    )
}

/// The sentences that say so, with their last lines.
fn claims(text: &str) -> impl Iterator<Item = (usize, String)> {
    sentences(text).into_iter().filter(|(_, sentence)| {
        let sentence = sentence.to_lowercase();
        let has = |words: &str| words.split('|').any(|word| sentence.contains(word));
        has(COASTS) && has(CEASES) && !has(NO_CLAIM)
    })
}

/// The sentences of prose and comments, each with its last line.
fn sentences(text: &str) -> Vec<(usize, String)> {
    let mut all = Vec::new();
    let mut sentence = String::new();
    for (index, line) in text.lines().enumerate() {
        let line = line
            .trim_start_matches([' ', '\t', '/', '!', '#', '*', '"', '|'])
            .trim_end();
        let mut end = |sentence: &mut String| all.push((index + 1, std::mem::take(sentence)));
        if line.is_empty() || line.starts_with("msg") {
            end(&mut sentence);
        }
        for word in line.split_inclusive([' ', '。', ';', '|', '>', '"']) {
            sentence.push_str(word);
            if word.contains("</")
                || word
                    .trim_end_matches([' ', '"', '<', '/'])
                    .ends_with(['.', '!', '?', '。', ';', '|', '{', '}'])
            {
                end(&mut sentence);
            }
        }
        sentence.push(' ');
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_says_that_a_wheel_coasts_because_frames_cease() {
        check(&Workspace::find().unwrap()).unwrap();
    }

    #[test]
    fn a_claim_is_found_in_every_language_and_across_lines() {
        for claim in [
            "The adapter was pulled out. What was driven coasts when frames\n/// cease.",
            "A drive command holds only while it is repeated at 50 Hz or more.",
            "msgstr \"Wird der Adapter abgezogen, laufen die Räder aus.\"",
            "msgstr \"电机 {id} 此前正在运行：帧中断后车轮会滑行至静止。\"",
            "<p>Brakes to a standstill, then coasts</p>",
        ] {
            assert_eq!(claims(&format!("{claim}\n\n")).count(), 1, "{claim}");
        }
    }

    #[test]
    fn physics_and_experiments_are_no_claim() {
        for text in [
            "Sets 0 A: the wheel coasts. A frame is ten bytes.",
            "The result is: keeps its last command, coasts or brakes when frames cease.",
            "The coast-down sends a frame of 0 A.",
            "No frame arrives; it coasts.",
        ] {
            assert_eq!(claims(&format!("{text}\n\n")).count(), 0, "{text}");
        }
    }
}
