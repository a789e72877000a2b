//! A queue that grows and shrinks without moving its values.
//!
//! A single buffer that doubles would copy 24 MB at once, and delay frames. This queue allocates one chunk
//! at a time and reuses an emptied one: a queue of constant length allocates no more memory.

use std::{collections::VecDeque, ops::Range};

use motorlink_protocol::Instant;

/// Entries in a chunk: 24 kB of log.
pub(crate) const CHUNK: usize = 1024;
const CHUNK_U64: u64 = 1024;

/// Values in the order in which they were pushed. They are numbered consecutively; a number is never
/// reused.
#[derive(Debug)]
pub(crate) struct Chunks<T> {
    buffers: VecDeque<Vec<T>>,
    /// The number at the start of the first chunk.
    base: u64,
    first: u64,
    end: u64,
    /// An emptied chunk, to be reused.
    spare: Option<Vec<T>>,
}

impl<T: Copy> Chunks<T> {
    pub(crate) const fn new() -> Self {
        Self {
            buffers: VecDeque::new(),
            base: 0,
            first: 0,
            end: 0,
            spare: None,
        }
    }

    /// The number of the oldest value; [`Self::end`] if there is none.
    pub(crate) const fn first(&self) -> u64 {
        self.first
    }

    /// The number after the newest value.
    pub(crate) const fn end(&self) -> u64 {
        self.end
    }

    pub(crate) const fn len(&self) -> u64 {
        self.end - self.first
    }

    /// Number of values that memory is allocated for.
    pub(crate) fn reserved(&self) -> usize {
        let buffers = self.buffers.iter().chain(&self.spare);
        buffers.map(Vec::capacity).sum()
    }

    pub(crate) fn get(&self, number: u64) -> Option<T> {
        let (chunk, place) = self.place(number)?;
        self.buffers.get(chunk)?.get(place).copied()
    }

    pub(crate) fn get_mut(&mut self, number: u64) -> Option<&mut T> {
        let (chunk, place) = self.place(number)?;
        self.buffers.get_mut(chunk)?.get_mut(place)
    }

    pub(crate) fn oldest(&self) -> Option<T> {
        self.get(self.first)
    }

    fn place(&self, number: u64) -> Option<(usize, usize)> {
        if number < self.first || number >= self.end {
            return None;
        }
        // No memory holds more than 2^32 chunks.
        let offset = number - self.base;
        let chunk = usize::try_from(offset / CHUNK_U64).ok()?;
        let place = usize::try_from(offset % CHUNK_U64).ok()?;
        Some((chunk, place))
    }

    /// Adds a value and returns its number.
    pub(crate) fn push(&mut self, value: T) -> u64 {
        match self.buffers.back_mut() {
            Some(last) if last.len() < CHUNK => last.push(value),
            _ => {
                let spare = self.spare.take();
                let mut chunk = spare.unwrap_or_else(|| Vec::with_capacity(CHUNK));
                chunk.push(value);
                self.buffers.push_back(chunk);
            }
        }
        let number = self.end;
        self.end += 1;
        number
    }

    /// Removes the oldest value.
    pub(crate) fn pop(&mut self) -> Option<T> {
        let oldest = self.oldest()?;
        self.first += 1;
        if self.first - self.base == CHUNK_U64
            && let Some(mut emptied) = self.buffers.pop_front()
        {
            emptied.clear();
            self.spare = Some(emptied);
            self.base = self.first;
        }
        Some(oldest)
    }

    /// An empty queue whose numbers continue those of this one.
    pub(crate) const fn continued(&self) -> Self {
        let number = self.end.next_multiple_of(CHUNK_U64);
        Self {
            base: number,
            first: number,
            end: number,
            buffers: VecDeque::new(),
            spare: None,
        }
    }
}

/// The part of a range in this time. The values are in order of time.
pub(crate) fn within(
    span: &Range<Instant>,
    range: Range<u64>,
    at: impl Fn(u64) -> Option<Instant>,
) -> Range<u64> {
    let range = not_before(span.start, range, &at);
    range.start..not_before(span.end, range, &at).start
}

/// The part of a range that begins at this time.
fn not_before(
    since: Instant,
    range: Range<u64>,
    at: impl Fn(u64) -> Option<Instant>,
) -> Range<u64> {
    let (mut start, mut end) = (range.start, range.end);
    while start < end {
        let middle = start.midpoint(end);
        if at(middle).is_some_and(|at| at < since) {
            start = middle + 1;
        } else {
            end = middle;
        }
    }
    start..range.end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_their_numbers_while_old_ones_give_way() {
        let mut chunks = Chunks::new();
        for number in 0..10_000_u64 {
            assert_eq!(chunks.push(number * 7), number);
            if number >= 3_000 {
                assert_eq!(chunks.pop(), Some((number - 3_000) * 7));
            }
        }
        assert_eq!((chunks.first(), chunks.len()), (7_000, 3_000));
        assert_eq!(chunks.get(6_999), None);
        assert_eq!(chunks.get(7_000), Some(49_000));
        assert_eq!(chunks.get(9_999), Some(69_993));
        assert_eq!(chunks.get(10_000), None);
        *chunks.get_mut(8_191).unwrap() = 1;
        assert_eq!(chunks.get(8_191), Some(1));
    }

    #[test]
    fn memory_stays_the_same_while_the_length_does() {
        let mut chunks = Chunks::new();
        let mut most = 0;
        for number in 0..50_000 {
            chunks.push(number);
            if number >= 5_000 {
                chunks.pop();
                most = most.max(chunks.reserved());
            }
        }
        assert!(most <= 7 * CHUNK, "{most} places for 5,000 values");
    }

    #[test]
    fn numbers_go_on_after_everything_was_taken_away() {
        let mut chunks = Chunks::new();
        for value in 0..1_500 {
            chunks.push(value);
        }
        let mut chunks = chunks.continued();
        assert_eq!((chunks.len(), chunks.get(1_499)), (0, None));
        assert_eq!((chunks.pop(), chunks.oldest()), (None, None));
        let number = chunks.push(5);
        assert!(number >= 1_500);
        assert_eq!(chunks.get(number), Some(5));
        assert_eq!(chunks.pop(), Some(5));
        assert_eq!(chunks.len(), 0);
        assert_eq!(chunks.push(6), number + 1);
    }
}
