//! Stores the texts of messages apart, because all entries have the same size. `row_words` says what a row reads.

use crate::charset::Charset;

/// Bytes of one text. Messages are a sentence or two.
const LINE_MAX: usize = 1_000;

/// The text, truncated to the maximal length.
pub(crate) fn cut(text: &str) -> &str {
    let ends = text
        .char_indices()
        .map(|(start, one)| start + one.len_utf8());
    let end = ends.take_while(|end| *end <= LINE_MAX).last();
    text.get(..end.unwrap_or(0)).unwrap_or_default()
}

/// A reference to one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TextRef(u32);

/// All texts of the log.
#[derive(Debug, Default)]
pub(crate) struct Texts {
    slots: Vec<Option<Box<str>>>,
    free: Vec<u32>,
    bytes: usize,
}

impl Texts {
    /// Stores a text, truncated to the maximal length.
    pub(crate) fn keep(&mut self, text: &str) -> TextRef {
        let text: Box<str> = cut(text).into();
        self.bytes += text.len();
        let free = self.free.pop();
        let slot = free.and_then(|number| {
            let slot = self.slots.get_mut(usize::try_from(number).ok()?)?;
            Some((number, slot))
        });
        if let Some((number, slot)) = slot {
            *slot = Some(text);
            return TextRef(number);
        }
        // The log holds fewer entries than a u32 counts.
        let number = u32::try_from(self.slots.len()).unwrap_or(u32::MAX);
        self.slots.push(Some(text));
        TextRef(number)
    }

    pub(crate) fn get(&self, TextRef(number): TextRef) -> &str {
        let slot = usize::try_from(number).ok().and_then(|n| self.slots.get(n));
        slot.and_then(Option::as_deref).unwrap_or_default()
    }

    /// The character set of a file with all texts.
    pub(crate) fn charset(&self) -> Charset {
        let mut charset = Charset::default();
        for text in self.slots.iter().flatten() {
            charset.add(text);
        }
        charset
    }

    pub(crate) fn forget(&mut self, TextRef(number): TextRef) {
        let slot = usize::try_from(number).ok();
        let slot = slot.and_then(|number| self.slots.get_mut(number));
        if let Some(text) = slot.and_then(Option::take) {
            self.bytes -= text.len();
            self.free.push(number);
        }
    }

    /// Bytes of all texts.
    pub(crate) const fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_used_again() {
        let mut texts = Texts::default();
        let one = texts.keep("one");
        let two = texts.keep("two");
        texts.forget(one);
        assert_eq!((texts.get(one), texts.bytes()), ("", 3));
        assert_eq!(texts.keep("three"), one);
        assert_eq!((texts.get(one), texts.get(two)), ("three", "two"));
        assert_eq!(texts.slots.len(), 2);
    }

    #[test]
    fn a_long_text_is_cut_between_letters() {
        let mut texts = Texts::default();
        let long = texts.keep(&format!("{}°°", "x".repeat(LINE_MAX - 1)));
        assert_eq!(texts.get(long), "x".repeat(LINE_MAX - 1));
    }
}
