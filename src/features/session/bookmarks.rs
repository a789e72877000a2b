//! The bookmarks of the open session, as long as it is open.

use motorlink_messages::sessions::{Bookmark, SessionInfo};

/// Letters of a note, as the writer of the copy keeps them.
pub(super) const NOTE_MAX: usize = 1_000;

/// A bookmark of the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// Identifies it while its note changes.
    pub(super) key: u32,
    pub(super) bookmark: Bookmark,
}

/// The bookmark whose note is being written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Draft {
    /// `None` for a new one.
    pub(super) key: Option<u32>,
    pub(super) bookmark: Bookmark,
}

/// The bookmarks of the open session, in the order of time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Bookmarks {
    entries: Vec<Entry>,
    /// Those in the file, or in the last copy of it.
    saved: Vec<Bookmark>,
    /// Those in the copy that is being written.
    posted: Vec<Bookmark>,
    keys: u32,
    pub(super) draft: Option<Draft>,
    /// Whether the user was warned that they are not saved. The next press discards them.
    is_warned: bool,
}

impl Bookmarks {
    /// Those of a file.
    pub(super) fn of(info: &SessionInfo) -> Self {
        let marks = info.marks.iter().filter(|mark| mark.is_bookmark);
        let mut bookmarks = Self::default();
        for mark in marks {
            bookmarks.add(Bookmark {
                after_us: mark.after_us,
                text: mark.text.clone(),
            });
        }
        bookmarks.saved = bookmarks.plain();
        bookmarks
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn plain(&self) -> Vec<Bookmark> {
        let entries = self.entries.iter();
        entries.map(|entry| entry.bookmark.clone()).collect()
    }

    /// Whether they differ from those in the file and its last copy.
    pub(super) fn are_changed(&self) -> bool {
        let entries = self.entries.iter().map(|entry| &entry.bookmark);
        !entries.eq(self.saved.iter())
    }

    fn add(&mut self, bookmark: Bookmark) {
        self.keys += 1;
        self.entries.push(Entry {
            key: self.keys,
            bookmark,
        });
        self.entries.sort_by_key(|entry| entry.bookmark.after_us);
        self.is_warned = false;
    }

    /// Begins a new bookmark at this place.
    pub(super) fn begin(&mut self, after_us: u64) {
        let text = String::new();
        self.draft = Some(Draft {
            key: None,
            bookmark: Bookmark { after_us, text },
        });
    }

    /// Begins to change the note of a bookmark.
    pub(super) fn edit(&mut self, key: u32) {
        let found = self.entries.iter().find(|entry| entry.key == key);
        self.draft = found.map(|entry| Draft {
            key: Some(key),
            bookmark: entry.bookmark.clone(),
        });
    }

    /// Keeps the draft with this note.
    pub(super) fn keep(&mut self, note: &str) {
        let Some(Draft { key, mut bookmark }) = self.draft.take() else {
            return;
        };
        bookmark.text = note.trim().chars().take(NOTE_MAX).collect();
        let known = self.entries.iter_mut();
        match known.into_iter().find(|entry| Some(entry.key) == key) {
            Some(entry) => {
                entry.bookmark = bookmark;
                self.is_warned = false;
            }
            None => self.add(bookmark),
        }
    }

    pub(super) fn delete(&mut self, key: u32) {
        self.entries.retain(|entry| entry.key != key);
        self.draft.take_if(|draft| draft.key == Some(key));
        self.is_warned = false;
    }

    /// Those to write. [`Self::copied`] follows when the copy is complete.
    pub(super) fn post(&mut self) -> Vec<Bookmark> {
        self.posted = self.plain();
        self.posted.clone()
    }

    pub(super) fn copied(&mut self) {
        self.saved = std::mem::take(&mut self.posted);
    }

    /// Whether the file may close: only the second press discards what is not saved.
    pub(super) fn may_close(&mut self) -> bool {
        let may = self.is_warned || !self.are_changed();
        self.is_warned = !may;
        may
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn notes(bookmarks: &Bookmarks) -> Vec<(u64, String)> {
        let plain = bookmarks.plain().into_iter();
        plain.map(|one| (one.after_us, one.text)).collect()
    }

    #[test]
    fn a_note_is_kept_in_the_order_of_time_changed_and_deleted() {
        let mut bookmarks = Bookmarks::default();
        bookmarks.begin(9);
        bookmarks.keep(" late ");
        bookmarks.begin(2);
        bookmarks.keep("early");
        assert_eq!(notes(&bookmarks), [(2, "early".into()), (9, "late".into())]);
        let key = bookmarks.entries()[1].key;
        bookmarks.edit(key);
        bookmarks.keep("later");
        assert_eq!(notes(&bookmarks)[1].1, "later");
        bookmarks.edit(key);
        bookmarks.delete(key);
        assert_eq!(notes(&bookmarks), [(2, "early".into())]);
        bookmarks.keep("of a deleted one");
        assert_eq!(bookmarks.entries().len(), 1, "its draft is gone with it");
    }

    #[test]
    fn only_the_second_press_discards_what_is_not_saved() {
        let mut bookmarks = Bookmarks::default();
        assert!(bookmarks.may_close());
        bookmarks.begin(1);
        assert!(!bookmarks.are_changed(), "a draft is no bookmark");
        bookmarks.keep("a");
        assert!(!bookmarks.may_close());
        bookmarks.begin(2);
        bookmarks.keep("b");
        assert!(!bookmarks.may_close(), "it was warned of another");
        assert!(bookmarks.may_close());
        bookmarks.post();
        bookmarks.begin(3);
        bookmarks.keep("while the copy is written");
        bookmarks.copied();
        assert!(bookmarks.are_changed());
        bookmarks.post();
        bookmarks.copied();
        assert!(bookmarks.may_close() && !bookmarks.are_changed());
    }
}
