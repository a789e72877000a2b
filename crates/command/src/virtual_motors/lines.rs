//! Lines out of whatever pieces standard input comes in.

/// Longest line taken; every command is far shorter.
const LINE_MAX: usize = 256;

/// Gathers bytes until a line is whole.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    pending: Vec<u8>,
}

impl Lines {
    /// The lines that these bytes complete. A line that is too long is cut, and so names no command.
    pub(crate) fn feed(&mut self, bytes: &[u8]) -> Vec<String> {
        let mut lines = Vec::new();
        for byte in bytes {
            if *byte == b'\n' {
                lines.push(String::from_utf8_lossy(&self.pending).into_owned());
                self.pending.clear();
            } else if self.pending.len() < LINE_MAX {
                self.pending.push(*byte);
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_whole_however_they_are_cut() {
        let mut lines = Lines::default();
        assert!(lines.feed(b"blo").is_empty());
        assert_eq!(
            lines.feed(b"ck 1 on\nstate 1\npo"),
            ["block 1 on", "state 1"]
        );
        assert_eq!(lines.feed(b"wer 1 off\n"), ["power 1 off"]);
    }

    #[test]
    fn an_endless_line_takes_no_endless_memory() {
        let mut lines = Lines::default();
        assert!(lines.feed(&vec![b'x'; 100_000]).is_empty());
        assert!(lines.pending.len() <= LINE_MAX);
    }
}
