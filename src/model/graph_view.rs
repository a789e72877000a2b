//! What the graph shows, for a link to it.

/// The traces and the length of the graph.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct GraphView {
    /// The classes of the visible traces.
    pub(crate) traces: Vec<String>,
    /// The class of the trace that is compared across motors.
    pub(crate) compared: Option<String>,
    /// The length of the shown period, in milliseconds.
    pub(crate) span_ms: u64,
}
