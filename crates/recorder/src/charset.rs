//! The character set of files.
//!
//! Programs differ in how they find out that a file is UTF-8: Excel needs a byte order mark, which Python's `csv`
//! module takes for a part of the first column name, and `soffice --headless` ignores it. Every program reads
//! ASCII. So the few signs of our English texts are spelled out, and only a log with other letters is UTF-8.

/// Adds a text with its signs spelled out. Returns whether that is ASCII; what was added is useless otherwise.
#[inline(never)]
fn push_spelled(out: &mut String, text: &str) -> bool {
    let mut signs = text.chars().peekable();
    while let Some(sign) = signs.next() {
        let spelled = match sign {
            '\u{2212}' | '\u{2013}' => "-",
            '\u{202F}' | '\u{A0}' => " ",
            '\u{201C}' | '\u{201D}' => "\"",
            '\u{2026}' => "...",
            // `33 °C` is `33 C`.
            '°' if signs.peek() == Some(&'C') => "",
            '°' => " deg",
            ascii if ascii.is_ascii() => {
                out.push(ascii);
                continue;
            }
            _ => return false,
        };
        out.push_str(spelled);
    }
    true
}

/// Spells out the signs of a text, if that makes it ASCII: `66.96 deg`. A text with other letters stays as it is.
/// `spelled` is a buffer.
pub(crate) fn spell_out(text: &mut String, spelled: &mut String) {
    spelled.clear();
    if !text.is_ascii() && push_spelled(spelled, text) {
        std::mem::swap(text, spelled);
    }
}

/// A text as it is in a file.
#[must_use]
pub fn spelled_out(mut text: String) -> String {
    spell_out(&mut text, &mut String::new());
    text
}

/// Whether a file with these texts needs UTF-8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Charset {
    /// Every text is ASCII, where need be spelled out.
    #[default]
    Ascii,
    /// The file begins with a byte order mark.
    Utf8,
}

impl Charset {
    /// Takes in a text of the file.
    pub fn add(&mut self, text: &str) {
        if !text.is_ascii() && !push_spelled(&mut String::new(), text) {
            *self = Self::Utf8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signs_of_our_texts_are_spelled_out() {
        for (text, spelled) in [
            ("drive −100 rpm", "drive -100 rpm"),
            ("+100 rpm, 33 °C, 125.6°", "+100 rpm, 33 C, 125.6 deg"),
            (
                "motor “left” – 1\u{202F}000 frames…",
                "motor \"left\" - 1 000 frames...",
            ),
            ("Motor „links“ 66,96°", "Motor „links“ 66,96°"),
            ("电机", "电机"),
        ] {
            assert_eq!(spelled_out(text.to_owned()), spelled);
            let mut charset = Charset::Ascii;
            charset.add(text);
            assert_eq!(charset == Charset::Ascii, spelled.is_ascii(), "{text}");
        }
    }
}
