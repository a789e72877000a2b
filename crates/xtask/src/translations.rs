//! Updates the translation files from the messages in the code.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, bail};
use polib::catalog::Catalog;
use polib::message::{Message, MessageMutView, MessageView};
use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::bindgen::files_below;
use crate::workspace::Workspace;

/// The files, one for each language but English.
const FILES: [&str; 2] = ["zh.po", "de.po"];

/// A message: its context, where it has one, and its English.
type Key = (Option<String>, String);

/// Each message of the code, and the files that contain it.
type Messages = BTreeMap<Key, Vec<String>>;

/// Adds new messages, removes those that the code no longer contains, and prints those without a
/// translation. With `check` no file is changed.
///
/// # Errors
///
/// With `check`, if a file is out of date or a translation is missing.
pub fn update(workspace: &Workspace, check: bool) -> Result<()> {
    let messages = messages_in_code(workspace.root())?;
    let mut open = 0;
    for file in FILES {
        let path = workspace.root().join("locales").join(file);
        let old = polib::po_file::parse(&path).map_err(|error| anyhow::anyhow!("{error}"));
        let old = old.with_context(|| format!("reading {}", path.display()))?;
        let new = merged(&old, &messages);
        let lacking: Vec<&str> = new
            .messages()
            .filter(|message| !message.is_translated())
            .map(MessageView::msgid)
            .collect();
        println!(
            "{file}: {} messages, {} to translate",
            new.count(),
            lacking.len()
        );
        for msgid in &lacking {
            println!("    {msgid}");
        }
        open += lacking.len();
        if check {
            let keys = |catalogue: &Catalog| catalogue.messages().map(key).collect::<Vec<_>>();
            let (mut old, mut new) = (keys(&old), keys(&new));
            old.sort();
            new.sort();
            if old != new {
                bail!(
                    "{} is not up to date: run `cargo xtask translations`",
                    path.display()
                );
            }
        } else {
            polib::po_file::write_to_file(&new, &path)
                .with_context(|| format!("writing {}", path.display()))?;
        }
    }
    if check && open > 0 {
        bail!("{open} translations are missing");
    }
    Ok(())
}

fn key(message: &dyn MessageView) -> Key {
    (
        message.msgctxt().map(str::to_owned),
        message.msgid().to_owned(),
    )
}

/// The messages of the code with the translations of the old catalogue.
fn merged(old: &Catalog, messages: &Messages) -> Catalog {
    let mut new = Catalog::new(old.metadata.clone());
    for ((context, msgid), files) in messages {
        let mut message = Message::build_singular();
        message
            .with_msgid(msgid.clone())
            .with_source(files.join(" "));
        if let Some(context) = context {
            message.with_msgctxt(context.clone());
        }
        let mut message = message.done();
        let before = old.find_message(context.as_deref(), msgid, None);
        if let Some(text) = before.and_then(|before| before.msgstr().ok()) {
            // A message without plural takes any text.
            let _ = message.set_msgstr(text.to_owned());
        }
        new.append_or_update(message);
    }
    new
}

/// The messages in the code.
fn messages_in_code(root: &Path) -> Result<Messages> {
    let mut messages = Messages::new();
    for top in ["src", "crates"] {
        for (path, content) in files_below(&root.join(top))? {
            if path.extension().is_none_or(|extension| extension != "rs") {
                continue;
            }
            let path = Path::new(top).join(path).display().to_string();
            let text = String::from_utf8(content).with_context(|| format!("{path} is not text"))?;
            // Most files contain no message, and parsing takes time.
            if !text.contains("tr!(") {
                continue;
            }
            let tokens = text.parse::<TokenStream>();
            let tokens = tokens.map_err(|error| anyhow::anyhow!("{path}: {error}"))?;
            collect(tokens, &path, &mut messages);
        }
    }
    Ok(messages)
}

/// Collects each `tr!("...")` and `tr!("..." as "...")`, also inside other macros.
fn collect(tokens: TokenStream, path: &str, messages: &mut Messages) {
    let mut before: [Option<String>; 2] = [None, None];
    for token in tokens {
        let [name, bang] = &before;
        let is_call = name.as_deref() == Some("tr") && bang.as_deref() == Some("!");
        let text = token.to_string();
        if let TokenTree::Group(group) = token {
            if is_call && group.delimiter() == Delimiter::Parenthesis {
                let files = messages.entry(message(group.stream())).or_default();
                if files.iter().all(|known| known != path) {
                    files.push(path.to_owned());
                }
            }
            collect(group.stream(), path, messages);
        }
        before.rotate_left(1);
        before[1] = Some(text);
    }
    messages.remove(&(None, String::new()));
}

fn message(arguments: TokenStream) -> Key {
    let mut tokens = arguments.into_iter();
    let english = tokens
        .next()
        .map(|token| literal(&token))
        .unwrap_or_default();
    let has_context = tokens.next().is_some_and(|token| token.to_string() == "as");
    let context = tokens.next().filter(|_| has_context);
    (context.map(|token| literal(&token)), english)
}

/// The text of a string literal; empty for other tokens, such as the pattern of a macro.
fn literal(token: &TokenTree) -> String {
    let literal = syn::parse_str::<syn::LitStr>(&token.to_string());
    literal.map(|literal| literal.value()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(code: &str) -> Vec<Key> {
        let mut messages = Messages::new();
        collect(code.parse().unwrap(), "a.rs", &mut messages);
        messages.into_keys().collect()
    }

    #[test]
    fn messages_are_found_inside_other_macros() {
        let code = r#"
            fn f() { view! { <p title=tr!("One")>{move || tr!("Two {id}", id)}</p> } }
            const X: fn() -> &'static str = || tr!("A long \
                one");
            macro_rules! tr { ($text:literal) => {} }
            let other = format!("Three");
        "#;
        let plain = |text: &str| (None, text.to_owned());
        assert_eq!(
            found(code),
            [plain("A long one"), plain("One"), plain("Two {id}")]
        );
    }

    #[test]
    fn a_context_is_part_of_the_message() {
        let electric = (Some("electric".to_owned()), "Current".to_owned());
        assert_eq!(found(r#"tr!("Current" as "electric")"#), [electric]);
    }

    #[test]
    fn a_translation_stays_with_its_message() {
        let messages: Messages = ["Old", "New"]
            .map(|text| ((None, text.to_owned()), vec!["a.rs".to_owned()]))
            .into();
        let mut old = Catalog::new(polib::metadata::CatalogMetadata::new());
        for text in ["Old", "Gone"] {
            let mut message = Message::build_singular();
            message
                .with_msgid(text.to_owned())
                .with_msgstr(format!("{text}!"));
            old.append_or_update(message.done());
        }
        let new = merged(&old, &messages);
        let texts: Vec<(&str, &str)> = new
            .messages()
            .map(|message| (message.msgid(), message.msgstr().unwrap()))
            .collect();
        assert_eq!(texts, [("New", ""), ("Old", "Old!")]);
    }
}
