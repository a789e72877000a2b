//! The view in a link: what the page shows, without what it would change.
//!
//! `&motor=2&tab=velocity&traces=speed.current&compared=speed&span_ms=60000`, behind the setup. Each field may be
//! missing, and what a field says that this version does not know is skipped.

use motorlink_messages::protocol::{Mode, MotorId};

use crate::model::{
    graph_view::GraphView,
    tab::{TABS, key},
};

/// The longest view in a link that is read.
const CHARACTERS_MAX: usize = 512;

/// What the page shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct View {
    pub(super) motor: Option<MotorId>,
    pub(super) tab: Option<Mode>,
    pub(super) graph: Option<GraphView>,
}

impl View {
    /// The view as the end of a link.
    pub(super) fn to_link(&self) -> String {
        let mut text = String::new();
        let mut field = |name: &str, value: &str| text.extend(["&", name, "=", value]);
        if let Some(id) = self.motor {
            field("motor", &id.get().to_string());
        }
        if let Some(mode) = self.tab {
            field("tab", key(mode));
        }
        if let Some(graph) = &self.graph {
            field("traces", &graph.traces.join("."));
            if let Some(compared) = &graph.compared {
                field("compared", compared);
            }
            field("span_ms", &graph.span_ms.to_string());
        }
        text
    }

    /// Reads the end of a link, without its first `&`.
    pub(super) fn from_link(text: &str) -> Self {
        let mut view = Self::default();
        if text.len() > CHARACTERS_MAX {
            return view;
        }
        let (mut traces, mut compared, mut span_ms) = (None, None, None);
        for (name, value) in text.split('&').filter_map(|field| field.split_once('=')) {
            match name {
                "motor" => view.motor = value.parse().ok().and_then(|id| MotorId::new(id).ok()),
                "tab" => view.tab = TABS.into_iter().find(|mode| key(*mode) == value),
                "traces" => traces = Some(value.split('.').map(str::to_owned).collect()),
                "compared" => compared = Some(value.to_owned()),
                "span_ms" => span_ms = value.parse().ok(),
                _ => {}
            }
        }
        view.graph = traces.zip(span_ms).map(|(traces, span_ms)| GraphView {
            traces,
            compared,
            span_ms,
        });
        view
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View {
            motor: MotorId::new(2).ok(),
            tab: Some(Mode::OpenLoop),
            graph: Some(GraphView {
                traces: vec!["speed".to_owned(), "goal".to_owned()],
                compared: Some("current".to_owned()),
                span_ms: 60_000,
            }),
        }
    }

    #[test]
    fn a_view_comes_back_from_a_link() {
        let link = "&motor=2&tab=open-loop&traces=speed.goal&compared=current&span_ms=60000";
        assert_eq!(view().to_link(), link);
        assert_eq!(View::from_link(&link[1..]), view());
        assert_eq!(View::default().to_link(), "");
        assert_eq!(View::from_link(""), View::default());
    }

    #[test]
    fn what_is_unknown_is_skipped() {
        let read = View::from_link("motor=0&tab=oven&colour=red&&=&motor&span_ms=-5&traces=speed");
        assert_eq!(read, View::default());
        let long = format!("motor=2&x={}", "y".repeat(CHARACTERS_MAX));
        assert_eq!(View::from_link(&long), View::default());
    }
}
