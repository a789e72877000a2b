//! The keys of the focused graph. It ignores Space, Escape, letters and digits, because they stop and drive.

/// What a key does to the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GraphAction {
    /// Show a shorter time.
    ZoomIn,
    /// Show a longer time.
    ZoomOut,
    /// Move the view by this percentage of its length; positive is later.
    Pan(i8),
    /// Move the crosshair by this number of columns.
    Cross(i8),
    /// Show the oldest.
    Oldest,
    /// Show the newest.
    Newest,
    /// Show a part of the values of each pane, in per cent.
    Values(u8),
    /// Fit each pane to its values.
    Fit,
    /// Move the crosshair to a mark: the one behind it, or the one before it.
    Mark(bool),
}

/// Percentage of the view's length that an arrow key pans.
const PAN_PERCENT: i8 = 10;
/// Columns that an arrow key moves the crosshair with Shift.
const CROSS_FAR: i8 = 20;

/// The action of a key; `modified` means that Ctrl, Alt or Meta is down. While the view is paused, the arrows move
/// the crosshair.
pub(crate) fn graph_action(
    key: &str,
    modified: bool,
    shift: bool,
    paused: bool,
) -> Option<GraphAction> {
    // Ctrl and plus is the zoom of the browser.
    if modified {
        return None;
    }
    let arrow = |towards: i8| match (paused, shift) {
        (true, false) => GraphAction::Cross(towards),
        (true, true) => GraphAction::Cross(towards * CROSS_FAR),
        (false, _) => GraphAction::Pan(towards * PAN_PERCENT),
    };
    Some(match key {
        // On many keyboards plus is the equals sign with Shift.
        "+" | "=" => GraphAction::ZoomIn,
        "-" | "\u{2212}" => GraphAction::ZoomOut,
        "ArrowLeft" => arrow(-1),
        "ArrowRight" => arrow(1),
        "Home" => GraphAction::Oldest,
        "End" => GraphAction::Newest,
        "PageUp" => GraphAction::Values(80),
        "PageDown" => GraphAction::Values(125),
        "Backspace" => GraphAction::Fit,
        "," => GraphAction::Mark(false),
        "." => GraphAction::Mark(true),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::keys::{self, Focus};

    #[test]
    fn arrows_pan_and_while_paused_move_the_crosshair() {
        assert_eq!(
            graph_action("ArrowLeft", false, false, false),
            Some(GraphAction::Pan(-10))
        );
        assert_eq!(
            graph_action("ArrowRight", false, true, false),
            Some(GraphAction::Pan(10))
        );
        assert_eq!(
            graph_action("ArrowLeft", false, false, true),
            Some(GraphAction::Cross(-1))
        );
        assert_eq!(
            graph_action("ArrowRight", false, true, true),
            Some(GraphAction::Cross(20))
        );
    }

    #[test]
    fn plus_and_minus_zoom_and_the_browser_keeps_its_own_zoom() {
        assert_eq!(
            graph_action("+", false, true, false),
            Some(GraphAction::ZoomIn)
        );
        assert_eq!(
            graph_action("-", false, false, true),
            Some(GraphAction::ZoomOut)
        );
        assert_eq!(graph_action("+", true, false, false), None);
        assert_eq!(graph_action("ArrowLeft", true, false, false), None);
    }

    #[test]
    fn the_values_zoom_too_and_are_fitted_again() {
        let of = |key| graph_action(key, false, false, true);
        assert_eq!(of("PageUp"), Some(GraphAction::Values(80)));
        assert_eq!(of("PageDown"), Some(GraphAction::Values(125)));
        assert_eq!(of("Backspace"), Some(GraphAction::Fit));
        assert_eq!(of(","), Some(GraphAction::Mark(false)));
        assert_eq!(of("."), Some(GraphAction::Mark(true)));
    }

    /// The graph handles no key that drives or stops.
    #[test]
    fn keys_that_drive_and_stop_are_left_alone() {
        let keys = " |Escape|f|F|b|B|s|S|k|K|1|2|3|4|5|v|V|c|C|p|P|?|Tab|Enter";
        for key in keys.split('|') {
            for paused in [false, true] {
                assert_eq!(graph_action(key, false, false, paused), None, "{key}");
            }
        }
        for key in [
            "+",
            "=",
            "-",
            "ArrowLeft",
            "ArrowRight",
            "Home",
            "End",
            "PageUp",
            "PageDown",
            "Backspace",
            ",",
            ".",
        ] {
            assert!(keys::key_action(key, false, Focus::Free).is_none(), "{key}");
        }
    }
}
