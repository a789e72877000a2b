//! The style sheets of the page.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::bindgen::files_below;

/// The style sheets of a directory, without those of its subdirectories, as one, in the order of their names.
pub fn style(dir: &Path) -> Result<String> {
    let mut style = String::new();
    for (path, content) in files_below(dir)? {
        let is_sheet = path.extension().is_some_and(|extension| extension == "css");
        if is_sheet && path.components().count() == 1 {
            let text = String::from_utf8(content);
            style += &text.with_context(|| format!("{} is not text", path.display()))?;
            style.push('\n');
        }
    }
    if style.is_empty() {
        bail!("{} holds no style sheet", dir.display());
    }
    Ok(style)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::minify;
    use crate::workspace::Workspace;

    /// The parts of a text between these characters, outside all brackets.
    fn split<'a>(text: &'a str, at: &[char]) -> Vec<&'a str> {
        let mut open = 0;
        let is_end = |character: char| {
            let is_end = open == 0 && at.contains(&character);
            open += i32::from(matches!(character, '(' | '['));
            open -= i32::from(matches!(character, ')' | ']'));
            is_end
        };
        text.split(is_end).collect()
    }

    /// What is wrong with one selector, without commas.
    ///
    /// A text change makes Chromium check every rule with `:has(... :empty)`. Where the answer of a `:has()` may have
    /// changed, Chromium restyles all elements that match the end of the rule: without a class, ID, attribute or tag there,
    /// all elements of the page. Where `:has()` is the end, it is one element.
    fn fault(selector: &str) -> Option<&'static str> {
        let mut asked = selector.split(":has(").skip(1).peekable();
        asked.peek()?;
        let argument = |rest| split(rest, &[')']).first().copied().unwrap_or_default();
        if asked.map(argument).any(|asked| asked.contains(":empty")) {
            return Some("asks for an empty element");
        }
        let end = split(selector.trim(), &[' ', '>', '+', '~']).pop()?;
        let mut parts = split(end, &[':']).into_iter();
        let is_named = parts.next().is_some_and(|name| !matches!(name, "" | "*"));
        let is_list = |part: &str| part.starts_with("is(") && part.contains(['.', '#', '[']);
        let names = |part: &str| part.starts_with("has(") || is_list(part);
        (!is_named && !parts.any(names)).then_some("has no name at its end")
    }

    #[test]
    fn a_costly_selector_is_found() {
        for costly in [
            ".a:has(.b:empty)",
            ".a:has(.b:not(:empty)) .c",
            ":is(.a, .b:has(.c)) > *",
            ":root:has(.a) > * + *",
            ".a:has(.b)>:first-child",
            ".a:has(.b) > :not(.c)",
            ".a:has(.b) :is(:hover, :focus)",
        ] {
            assert!(fault(costly).is_some(), "{costly}");
        }
        for cheap in [
            ".a:empty",
            ".a > *",
            ".a:has(.b)",
            ".a :has(+ .b)",
            ":root:has(.a)",
            ".a:has(.b) > :is(.c, .d):not(:last-child)",
            ".a:has(> :nth-child(2n + 1)) [data-b=\"c d\"]",
            ".a:has(.b) li:empty",
        ] {
            assert_eq!(fault(cheap), None, "{cheap}");
        }
    }

    #[test]
    fn no_selector_of_the_page_is_costly() {
        let dir = Workspace::find().unwrap().root().join("style");
        let sheets = style(&dir).unwrap() + &style(&dir.join("later")).unwrap();
        let sheets = minify::css(&sheets);
        let before_blocks = sheets.split('{');
        let lists = before_blocks.filter_map(|text| text.rsplit(['}', ';']).next());
        let selectors = lists.flat_map(|list| split(list, &[',']));
        let mut with_has = 0;
        for selector in selectors.filter(|selector| selector.contains(":has(")) {
            assert_eq!(fault(selector), None, "{selector}");
            with_has += 1;
        }
        assert!(with_has > 50, "{with_has}");
    }
}
