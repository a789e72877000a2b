//! What the graph shows, for a link to it.

use leptos::prelude::*;

use crate::{
    features::graph::{
        plot::{trace::Trace, view::limited_span},
        state::Chart,
    },
    model::graph_view::GraphView,
};

impl Chart {
    /// What it shows. Read within an effect, it is followed.
    pub(crate) fn graph_view(self) -> GraphView {
        let traces = self.traces.get();
        let class = |trace: Trace| trace.class().to_owned();
        let visible = Trace::ALL.into_iter().filter(|trace| traces.has(*trace));
        GraphView {
            traces: visible.map(class).collect(),
            compared: traces.compared.map(class),
            span_ms: self.view.get().span_us / 1_000,
        }
    }

    /// Shows this instead. Names that it does not know are skipped.
    pub(crate) fn show_graph_view(self, linked: &GraphView) {
        let of = |class: &String| Trace::from_class(class);
        let visible: Vec<Trace> = linked.traces.iter().filter_map(of).collect();
        self.traces.update(|traces| {
            for trace in Trace::ALL {
                *traces = traces.with(trace, visible.contains(&trace));
            }
            traces.compared = linked
                .compared
                .as_ref()
                .and_then(of)
                .filter(|trace| *trace != Trace::Goal);
        });
        let span_us = limited_span(linked.span_ms.saturating_mul(1_000));
        self.show(self.view.get_untracked().with_span(span_us));
        self.wake();
    }
}
