//! Which entries match the filter.

use motorlink_bus::LineEventKind;
use motorlink_messages::recorder::{Filter, Kind};
use motorlink_protocol::MotorId;

use crate::{
    digits::push_hex,
    entry::{Entry, EntryContent, Visibility},
    row_words::{push_id, push_meaning},
    stored_texts::Texts,
    wall_clock::WallClock,
};

/// The maximal length of the page's search field.
const TEXT_MAX: usize = 200;

/// A filter in the form that checks many entries quickly.
#[derive(Debug, Default)]
pub(crate) struct RowFilter {
    /// In lower case. There are two if the text has a hyphen: the log writes numbers with a minus sign,
    /// which no keyboard has.
    needles: Vec<Vec<u8>>,
    id: Option<MotorId>,
    kind: Option<Kind>,
    collapse: bool,
    /// A reused buffer for the text of a row.
    row: String,
}

impl RowFilter {
    pub(crate) fn new(filter: &Filter) -> Self {
        let letters = filter.text.trim().chars().take(TEXT_MAX);
        let text: String = letters.map(|letter| letter.to_ascii_lowercase()).collect();
        let mut needles = Vec::new();
        if !text.is_empty() {
            if text.contains('-') {
                needles.push(text.replace('-', "\u{2212}").into_bytes());
            }
            needles.push(text.into_bytes());
        }
        Self {
            needles,
            id: filter.id,
            kind: filter.kind,
            collapse: filter.collapse,
            row: String::new(),
        }
    }

    pub(crate) fn classify(
        &mut self,
        entry: &Entry,
        texts: &Texts,
        clock: WallClock,
    ) -> Visibility {
        // Who presses Send looks for the frame, and may have forgotten the filter. Its repetitions could bury what
        // the filter is for.
        let by_hand = matches!(
            entry.content,
            EntryContent::Line(LineEventKind::SentByHand { .. })
        );
        let asked_for = by_hand
            || self.kind.is_none_or(|kind| kind == entry.kind())
                && self.id.is_none_or(|id| entry.id() == Some(id))
                && (self.needles.is_empty() || self.finds(entry, texts, clock));
        match asked_for {
            false => Visibility::Hidden,
            true if self.collapse && entry.routine => Visibility::Collapsed,
            true => Visibility::Shown,
        }
    }

    /// Whether the row contains the text: time, ID, hex and meaning, separated by spaces.
    fn finds(&mut self, entry: &Entry, texts: &Texts, clock: WallClock) -> bool {
        self.row.clear();
        clock.local(entry.at).push_time_of_day(&mut self.row);
        self.row.push(' ');
        push_id(&mut self.row, entry);
        self.row.push(' ');
        push_hex(&mut self.row, entry.bytes());
        self.row.push(' ');
        push_meaning(&mut self.row, entry, texts);
        self.row.make_ascii_lowercase();
        let row = self.row.as_bytes();
        self.needles.iter().any(|needle| contains(row, needle))
    }
}

fn contains(row: &[u8], needle: &[u8]) -> bool {
    let Some((first, rest)) = needle.split_first() else {
        return true;
    };
    let mut row = row;
    while let Some(place) = row.iter().position(|byte| byte == first) {
        let Some(behind) = row.get(place + 1..) else {
            return false;
        };
        if behind.starts_with(rest) {
            return true;
        }
        row = behind;
    }
    false
}

#[cfg(test)]
mod tests {
    use motorlink_bus::JunkBytes;
    use motorlink_protocol::{Frame, Instant, Layout, family::Model};

    use super::*;

    const CLOCK: WallClock = WallClock::new(1_795_266_936_962.0, 60);

    fn heard(routine: bool) -> Entry {
        Entry {
            at: Instant::ZERO,
            content: EntryContent::Line(LineEventKind::Received {
                frame: Frame::with_crc([1, 2, 0xFF, 0, 0xFF, 0x9C, 0x17, 0xCF, 0]),
                asked: Some(Layout::Drive),
            }),
            model: Model::Ddsm115,
            routine,
            visibility: Visibility::Hidden,
        }
    }

    fn finds(text: &str) -> bool {
        let filter = Filter {
            text: text.into(),
            ..Filter::default()
        };
        let texts = Texts::default();
        RowFilter::new(&filter).classify(&heard(true), &texts, CLOCK) == Visibility::Shown
    }

    #[test]
    fn text_is_found_in_every_column_in_any_case() {
        for text in [
            "",
            "14:15:36.962",
            "0X01",
            "ff 9c",
            "FF 9C",
            "RPM",
            "  rpm ",
            "9c 17 cf 00",
        ] {
            assert!(finds(text), "{text}");
        }
        for text in ["13:15", "0x02", "ff  9c", "drive", "rpm rpm"] {
            assert!(!finds(text), "{text}");
        }
    }

    #[test]
    fn a_typed_hyphen_finds_a_minus() {
        assert!(finds("-100 rpm"));
        assert!(finds("\u{2212}100 rpm"));
        assert!(!finds("-101"));
    }

    #[test]
    fn motor_and_kind_leave_the_others_out() {
        let texts = Texts::default();
        let shown = |filter: &Filter| {
            RowFilter::new(filter).classify(&heard(false), &texts, CLOCK) == Visibility::Shown
        };
        let of = |id| Filter {
            id: MotorId::new(id).ok(),
            ..Filter::default()
        };
        assert!(shown(&of(1)) && !shown(&of(2)));
        let of = |kind| Filter {
            kind: Some(kind),
            ..Filter::default()
        };
        assert!(shown(&of(Kind::Rx)) && !shown(&of(Kind::Tx)) && !shown(&of(Kind::Error)));
    }

    #[test]
    fn only_what_is_asked_for_counts_as_collapsed() {
        let texts = Texts::default();
        let visibility = |text: &str, routine| {
            let filter = Filter {
                text: text.into(),
                collapse: true,
                ..Filter::default()
            };
            RowFilter::new(&filter).classify(&heard(routine), &texts, CLOCK)
        };
        assert_eq!(visibility("rpm", true), Visibility::Collapsed);
        assert_eq!(visibility("rpm", false), Visibility::Shown);
        assert_eq!(visibility("drive", true), Visibility::Hidden);
    }

    #[test]
    fn a_row_without_id_and_bytes_is_looked_through_too() {
        let junk = Entry {
            content: EntryContent::Line(LineEventKind::Junk(JunkBytes::new(&[0xAB]))),
            ..heard(false)
        };
        let filter = Filter {
            text: "no valid".into(),
            ..Filter::default()
        };
        let visibility = RowFilter::new(&filter).classify(&junk, &Texts::default(), CLOCK);
        assert_eq!(visibility, Visibility::Shown);
    }

    #[test]
    fn a_needle_is_found_behind_false_starts() {
        assert!(contains(b"aab", b"ab"));
        assert!(contains(b"abababc", b"ababc"));
        assert!(!contains(b"ab", b"abc"));
        assert!(contains(b"", b""));
    }
}
