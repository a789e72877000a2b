//! The bus of an adapter.

/// The motors on a bus, as arguments of `motorlink virtual`.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// The motors on the bus.
    pub ids: Vec<u8>,
    /// Time from the last bit of a request to the first bit of its reply.
    pub turnaround_us: u32,
    /// Further arguments, such as `["--echo", "whole"]` or `["--loss", "0.15", "--seed", "7"]`.
    pub extra: Vec<String>,
}

impl Default for Line {
    /// One motor with ID 1 that answers in 0.6 ms, the turnaround of the product's bounds.
    fn default() -> Self {
        Self {
            ids: vec![1],
            turnaround_us: 600,
            extra: Vec::new(),
        }
    }
}

impl Line {
    /// A bus with these motors.
    #[must_use]
    pub fn with_motors(ids: &[u8]) -> Self {
        Self {
            ids: ids.to_vec(),
            ..Self::default()
        }
    }

    /// The same bus with motors that `keep` their last command when frames cease, as by default, or that `coast` or
    /// `brake`.
    #[must_use]
    pub fn when_silent(self, behaviour: &str) -> Self {
        self.with(&["--when-silent", behaviour])
    }

    /// The same bus with further arguments.
    #[must_use]
    pub fn with(mut self, extra: &[&str]) -> Self {
        self.extra
            .extend(extra.iter().map(|argument| (*argument).to_owned()));
        self
    }
}
