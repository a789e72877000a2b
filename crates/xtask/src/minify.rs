//! Removes comments and indentation from style sheets and scripts.

/// The style sheet without comments and indentation, which are a sixth of its weight.
pub fn css(sheet: &str) -> String {
    let mut minified = String::with_capacity(sheet.len());
    for line in without_comments(sheet).lines() {
        let line = line.trim();
        if !line.is_empty() {
            minified.push_str(&without_spaces(line));
            if !line.ends_with(['{', '}', ';', ',']) {
                minified.push('\n');
            }
        }
    }
    minified
}

/// The line of a style sheet without the spaces behind colons and commas, and around braces. A line with a string is not
/// changed.
fn without_spaces(line: &str) -> String {
    const SPACED: [(&str, &str); 5] = [
        (": ", ":"),
        (", ", ","),
        (" {", "{"),
        ("{ ", "{"),
        ("; }", "}"),
    ];
    if line.contains(['"', '\'']) {
        return line.to_owned();
    }
    let spaced = SPACED.iter();
    spaced.fold(line.to_owned(), |line, (spaced, close)| {
        line.replace(spaced, close)
    })
}

/// The page without its comments, each of which is a line of its own.
pub fn html(page: &str) -> String {
    let is_comment = |line: &str| line.starts_with("<!--") && line.ends_with("-->");
    let kept = page.lines().filter(|line| !is_comment(line));
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// The script without comment lines and indentation. The scripts of the page contain no string over several
/// lines.
pub fn script(script: &str) -> String {
    let lines = script.lines().map(str::trim);
    let kept = lines.filter(|line| !line.is_empty() && !line.starts_with("//"));
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// The glue of wasm-bindgen without its documentation and indentation, which are a third of it. A script
/// with a string over several lines is not changed: its lines could be part of the string.
pub fn glue(glue: &str) -> String {
    let is_text_open = |line: &str| !line.matches('`').count().is_multiple_of(2);
    if glue.lines().any(is_text_open) {
        return glue.to_owned();
    }
    let mut undocumented = String::with_capacity(glue.len());
    let mut in_comment = false;
    for line in glue.lines().map(str::trim) {
        in_comment |= line.starts_with("/*");
        if !in_comment {
            undocumented.push_str(line);
            undocumented.push('\n');
        }
        in_comment &= !line.ends_with("*/");
    }
    script(&undocumented)
}

/// Comments end at the first `*/` and do not nest; in a quoted string there are none.
fn without_comments(sheet: &str) -> String {
    let mut kept = String::with_capacity(sheet.len());
    let mut quote = None;
    let mut rest = sheet;
    while let Some(character) = rest.chars().next() {
        if quote.is_none()
            && let Some(comment) = rest.strip_prefix("/*")
        {
            rest = comment.split_once("*/").map_or("", |(_, after)| after);
            continue;
        }
        match quote {
            None if matches!(character, '"' | '\'') => quote = Some(character),
            Some(open) if open == character => quote = None,
            _ => {}
        }
        kept.push(character);
        rest = rest.get(character.len_utf8()..).unwrap_or_default();
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::{css, glue, html, script};

    #[test]
    fn a_page_loses_its_comments() {
        let page = "<!doctype html>\n<!-- why -->\n<p>a <!-- kept --> b</p>\n";
        assert_eq!(html(page), "<!doctype html>\n<p>a <!-- kept --> b</p>\n");
    }

    #[test]
    fn a_script_keeps_what_runs() {
        let text = "// why\nconst a = {\n  // what\n  b: 1, // c\n};\n\na();\n";
        assert_eq!(script(text), "const a = {\nb: 1, // c\n};\na();\n");
    }

    #[test]
    fn comments_and_indentation_go_and_strings_stay() {
        let sheet = "/* head\n of it */\n.a {\n    color: red; /* why */\n}\n\n.b::after { content: \"/* kept */\"; }\n";
        assert_eq!(
            css(sheet),
            ".a{color:red;}.b::after { content: \"/* kept */\"; }"
        );
    }

    #[test]
    fn spaces_go_that_a_browser_does_not_need() {
        let sheet = ":is(.a, .b) > .c { top: calc(1px + 2px); }\n";
        assert_eq!(css(sheet), ":is(.a,.b) > .c{top:calc(1px + 2px)}");
    }

    #[test]
    fn documentation_goes_from_a_script_and_texts_stay() {
        let script = "/**\n * @param {number} a\n */\nfunction f(a) {\n    // why\n    return `${a} // b`;\n}\n/* c */\n";
        assert_eq!(glue(script), "function f(a) {\nreturn `${a} // b`;\n}\n");
        let long = "const text = `\n    // in it\n`;\n";
        assert_eq!(glue(long), long);
    }

    #[test]
    fn a_comment_without_end_swallows_the_rest_as_in_a_browser() {
        assert_eq!(css(".a {}\n/* .b {}"), ".a{}");
    }
}
