//! The bookmarks of the open session, as long as it is open.

use motorlink_messages::sessions::{Bookmark, SessionInfo};

/// Letters of a note, as the writer of the copy keeps them.
pub(super) const NOTE_MAX: usize = 1_000;

/// Bookmarks of a file, as the writer of the copy keeps them.
pub(super) const BOOKMARKS_MAX: usize = 1_000;

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
    /// Identifies it: no other one of the page has this number.
    pub(super) number: u32,
    /// `None` for a new one.
    pub(super) key: Option<u32>,
    /// With the text of the field.
    pub(super) bookmark: Bookmark,
}

/// What would discard the bookmarks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Closing {
    AnotherFile,
    CloseFile,
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
    drafts: u32,
    draft: Option<Draft>,
    /// The action at which the user was warned that they are not saved. The same action again discards them.
    warned_at: Option<Closing>,
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

    /// The file is open again after its worker had ended: those of the page stay.
    pub(super) fn reopened(&mut self, info: &SessionInfo) {
        self.saved = Self::of(info).saved;
        self.posted = Vec::new();
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn plain(&self) -> Vec<Bookmark> {
        let entries = self.entries.iter();
        entries.map(|entry| entry.bookmark.clone()).collect()
    }

    pub(super) const fn draft(&self) -> Option<&Draft> {
        self.draft.as_ref()
    }

    /// Whether a copy has no room for another one.
    pub(super) const fn are_full(&self) -> bool {
        self.entries.len() >= BOOKMARKS_MAX
    }

    /// Whether they, or the note in the form, differ from those in the file and its last copy.
    pub(super) fn are_changed(&self) -> bool {
        let entries = self.entries.iter().map(|entry| &entry.bookmark);
        self.has_written() || !entries.eq(self.saved.iter())
    }

    /// Whether the form has a note that is not kept. An empty one is nothing that can be lost.
    fn has_written(&self) -> bool {
        self.draft.as_ref().is_some_and(|draft| {
            let mut entries = self.entries.iter();
            let known = entries.find(|entry| Some(entry.key) == draft.key);
            let before = known.map_or("", |entry| &entry.bookmark.text);
            let note = draft.bookmark.text.trim();
            !note.is_empty() && note != before.trim()
        })
    }

    fn add(&mut self, bookmark: Bookmark) {
        self.keys += 1;
        let after_us = bookmark.after_us;
        let place = self
            .entries
            .partition_point(|entry| entry.bookmark.after_us <= after_us);
        let key = self.keys;
        self.entries.insert(place, Entry { key, bookmark });
        self.forget_warning();
    }

    /// Only the next press after the warning discards them.
    pub(super) const fn forget_warning(&mut self) {
        self.warned_at = None;
    }

    /// Begins a new bookmark at this place.
    pub(super) fn begin(&mut self, after_us: u64) {
        self.end_draft();
        if self.are_full() {
            return;
        }
        let text = String::new();
        self.write_to(None, Bookmark { after_us, text });
    }

    /// Begins to change the note of a bookmark.
    pub(super) fn edit(&mut self, key: u32) {
        self.end_draft();
        let found = self.entries.iter().find(|entry| entry.key == key);
        if let Some(bookmark) = found.map(|entry| entry.bookmark.clone()) {
            self.write_to(Some(key), bookmark);
        }
    }

    fn write_to(&mut self, key: Option<u32>, bookmark: Bookmark) {
        self.drafts += 1;
        self.draft = Some(Draft {
            number: self.drafts,
            key,
            bookmark,
        });
    }

    /// Takes the text of the field.
    pub(super) fn write(&mut self, note: String) {
        if let Some(draft) = &mut self.draft {
            draft.bookmark.text = note;
        }
    }

    /// The form closes. A note that would be lost is kept.
    pub(super) fn end_draft(&mut self) {
        if self.has_written() {
            self.keep();
        }
        self.cancel();
    }

    /// The form closes, and its note is discarded.
    pub(super) fn cancel(&mut self) {
        self.draft = None;
        self.forget_warning();
    }

    /// Keeps the draft.
    pub(super) fn keep(&mut self) {
        let Some(Draft {
            key, mut bookmark, ..
        }) = self.draft.take()
        else {
            return;
        };
        bookmark.text = bookmark.text.trim().chars().take(NOTE_MAX).collect();
        let known = self.entries.iter_mut();
        match known.into_iter().find(|entry| Some(entry.key) == key) {
            Some(entry) => {
                entry.bookmark = bookmark;
                self.forget_warning();
            }
            None => self.add(bookmark),
        }
    }

    pub(super) fn delete(&mut self, key: u32) {
        self.entries.retain(|entry| entry.key != key);
        self.draft.take_if(|draft| draft.key == Some(key));
        self.forget_warning();
    }

    /// Those to write. [`Self::copied`] follows when the copy is complete.
    pub(super) fn post(&mut self) -> Vec<Bookmark> {
        self.end_draft();
        self.posted = self.plain();
        self.posted.clone()
    }

    pub(super) fn copied(&mut self) {
        self.saved = std::mem::take(&mut self.posted);
    }

    /// Whether the file may close: only the second press of the same action discards what is not saved.
    pub(super) fn may_close(&mut self, at: Closing) -> bool {
        if self.has_written() {
            self.end_draft();
        }
        let may = self.warned_at == Some(at) || !self.are_changed();
        self.warned_at = (!may).then_some(at);
        may
    }
}

#[cfg(test)]
mod tests {
    use super::{
        Closing::{AnotherFile, CloseFile},
        *,
    };

    fn add(bookmarks: &mut Bookmarks, after_us: u64, note: &str) {
        bookmarks.begin(after_us);
        bookmarks.write(note.to_owned());
        bookmarks.keep();
    }

    fn notes(bookmarks: &Bookmarks) -> Vec<(u64, String)> {
        let plain = bookmarks.plain().into_iter();
        plain.map(|one| (one.after_us, one.text)).collect()
    }

    #[test]
    fn a_note_is_kept_in_the_order_of_time_changed_and_deleted() {
        let mut bookmarks = Bookmarks::default();
        add(&mut bookmarks, 9, " late ");
        add(&mut bookmarks, 2, "early");
        assert_eq!(notes(&bookmarks), [(2, "early".into()), (9, "late".into())]);
        let key = bookmarks.entries()[1].key;
        bookmarks.edit(key);
        bookmarks.write("later".to_owned());
        bookmarks.keep();
        assert_eq!(notes(&bookmarks)[1].1, "later");
        bookmarks.edit(key);
        bookmarks.delete(key);
        assert_eq!(notes(&bookmarks), [(2, "early".into())]);
        bookmarks.keep();
        assert_eq!(bookmarks.entries().len(), 1, "its draft is gone with it");
    }

    #[test]
    fn only_the_second_press_discards_what_is_not_saved() {
        let mut bookmarks = Bookmarks::default();
        assert!(bookmarks.may_close(CloseFile));
        bookmarks.begin(1);
        assert!(!bookmarks.are_changed(), "a draft is no bookmark");
        bookmarks.keep();
        assert!(!bookmarks.may_close(CloseFile));
        add(&mut bookmarks, 2, "b");
        assert!(!bookmarks.may_close(CloseFile), "it was warned of another");
        assert!(!bookmarks.may_close(AnotherFile), "another action");
        assert!(bookmarks.may_close(AnotherFile));
        bookmarks.post();
        add(&mut bookmarks, 3, "while the copy is written");
        bookmarks.copied();
        assert!(bookmarks.are_changed());
        bookmarks.post();
        bookmarks.copied();
        assert!(bookmarks.may_close(CloseFile) && !bookmarks.are_changed());
    }

    #[test]
    fn a_warning_expires_with_the_next_thing_that_is_done_to_them() {
        let acts: [fn(&mut Bookmarks); 5] = [
            |bookmarks| bookmarks.begin(3),
            |bookmarks| bookmarks.edit(1),
            |bookmarks| bookmarks.delete(7),
            Bookmarks::forget_warning,
            |bookmarks| {
                bookmarks.post();
            },
        ];
        for act in acts {
            let mut bookmarks = Bookmarks::default();
            add(&mut bookmarks, 1, "a");
            assert!(!bookmarks.may_close(CloseFile));
            act(&mut bookmarks);
            assert!(!bookmarks.may_close(CloseFile));
            assert!(bookmarks.may_close(CloseFile));
        }
    }

    #[test]
    fn a_written_note_is_kept_by_everything_but_cancel() {
        let acts: [fn(&mut Bookmarks); 5] = [
            |bookmarks| bookmarks.begin(7),
            |bookmarks| bookmarks.edit(1),
            Bookmarks::end_draft,
            |bookmarks| {
                bookmarks.post();
            },
            |bookmarks| {
                bookmarks.may_close(CloseFile);
            },
        ];
        for act in acts {
            let mut bookmarks = Bookmarks::default();
            add(&mut bookmarks, 1, "a");
            bookmarks.begin(5);
            bookmarks.write("written".to_owned());
            assert!(bookmarks.are_changed());
            act(&mut bookmarks);
            assert_eq!(notes(&bookmarks), [(1, "a".into()), (5, "written".into())]);
        }
        let mut bookmarks = Bookmarks::default();
        add(&mut bookmarks, 1, "a");
        bookmarks.edit(1);
        bookmarks.write("b".to_owned());
        bookmarks.begin(5);
        assert_eq!(notes(&bookmarks), [(1, "b".into())], "and no other one");
        bookmarks.write("c".to_owned());
        bookmarks.cancel();
        bookmarks.end_draft();
        assert_eq!(notes(&bookmarks), [(1, "b".into())]);
    }

    #[test]
    fn there_are_no_more_than_a_copy_has_room_for() {
        let mut bookmarks = Bookmarks::default();
        for after_us in 0..=BOOKMARKS_MAX as u64 {
            assert_eq!(bookmarks.are_full(), after_us == BOOKMARKS_MAX as u64);
            add(&mut bookmarks, after_us, "x");
        }
        assert_eq!(bookmarks.entries().len(), BOOKMARKS_MAX);
        assert_eq!(bookmarks.draft(), None);
    }
}
